"""Queries about one layer of a screen: routes, the shortest path of all; and the scratch that they share."""

from collections.abc import Callable
from math import hypot, inf, nan
from typing import cast

import numpy as np

from utak.geometry.homotopy.funnel import Ends, measure_line, new_funnel, tighten_word
from utak.geometry.homotopy.portals import crossings_of
from utak.geometry.kernels.arrays import XY, Ints
from utak.geometry.pathfinders.polyanya import (
    NO_PATH,
    SEARCH_OVERFLOW,
    PolyanyaSearch,
    new_polyanya_search,
    shortest_line,
)
from utak.geometry.routes.layer import Layer, build_layer
from utak.geometry.routes.lifting import Lifted, Trail, lift_to_skeleton, lift_word, new_trail
from utak.geometry.routes.route import Route, routes_of_answers
from utak.geometry.routes.router import (
    ROUTER_OVERFLOW,
    RouterBuffers,
    itineraries,
    new_router_buffers,
)
from utak.geometry.skeleton.chains import Chains

# Paths tried beyond those wanted, since their order changes when they are pulled tight; see docs/geometry.md.
EXTRA_PATHS = 8  # on pathgraphs of at most SMALL_PATHGRAPH chains
EXTRA_PATHS_IF_LARGE = 1  # on larger pathgraphs
SMALL_PATHGRAPH = 128  # chains
LENGTH_TOLERANCE = 1e-9  # squares; lengths that differ by less are equal but for rounding


def compile_route_kernels() -> None:
    """Compile the routing kernels, which take longest, for the array types of screens, before there is a screen."""
    ints, ends_of, none = np.zeros(1, np.int32), np.full((1, 4), -1, np.int32), np.full((1, 4), -1, np.int16)
    chains = Chains(ints, ends_of, np.empty((0, 2), np.int32), ints, ints, ints[:0])  # one node, no chain
    layer, ends = build_layer(none, np.zeros((1, 4), np.uint8), chains), (0.0, 0.0, 0.0, 0.0)
    itineraries.entry(layer, ends, 1, new_router_buffers(1, 1, 1, 1, 8))
    shortest_line.entry(layer.strips, ends, inf, *new_polyanya_search(8, layer.strips))
    lift_word.entry(*layer[:5], ends, ints, new_trail(1))


class LayerQueries:
    """A layer with the scratch of its searches, which grows as needed."""

    def __init__(self, layer: Layer) -> None:
        """Take a layer, and make no scratch yet."""
        self.layer = layer
        self._winding = bool(layer.strips.crossing.any())
        self._buffers_of: dict[int, RouterBuffers] = {}
        self._polyanya: PolyanyaSearch | None = None
        self._kernel: Callable[[Layer, Ends, int, RouterBuffers], int] | None = None
        self._trail_scratch: Trail | None = None

    def to_point(self, start: XY, goal: XY, k: int) -> list[Route]:
        """Return at most k routes between two points, shortest first; an empty list when they are not connected."""
        buffers, found = self._search((*start, *goal), self._candidate_count(k))
        routes = routes_of_answers(buffers.answers, found, k)
        return self._with_shortest(routes, start, goal, k) if k > 1 and self._winding and routes else routes

    def _candidate_count(self, k: int) -> int:
        """Return how many paths over the pathgraph are pulled tight for k routes: 1 for one route, else some more."""
        small = len(self.layer.landmarks.length) <= SMALL_PATHGRAPH
        return 1 if k == 1 else k + (EXTRA_PATHS if small else EXTRA_PATHS_IF_LARGE)

    def _search(self, ends: Ends, wanted: int) -> tuple[RouterBuffers, int]:
        """Find the best paths over the pathgraph, pulled tight; return the buffers that hold them, and their number."""
        found, room = ROUTER_OVERFLOW, 0
        while found == ROUTER_OVERFLOW:
            buffers = self._router_buffers(wanted, room)
            if self._kernel is None:
                self._kernel = itineraries.entry(self.layer, ends, wanted, buffers)
            found = self._kernel(self.layer, ends, wanted, buffers)
            room = 4 * len(buffers.start)
        return buffers, found

    def _with_shortest(self, routes: list[Route], start: XY, goal: XY, k: int) -> list[Route]:
        """Return at most k routes: those given, after the shortest path of all if none of them is of its class."""
        first = routes[0].length - LENGTH_TOLERANCE
        if first <= hypot(goal[0] - start[0], goal[1] - start[1]):
            return routes
        length = self.shortest_length(start, goal, first)
        return routes if length >= first else [self._polyanya_route(length, (*start, *goal)), *routes][:k]

    def of_word(self, start: XY, goal: XY, word: Ints) -> Route:
        """Return the tight route of a reduced word between two points, with its clearance and chains."""
        ends = (*start, *goal)
        found = self._lifted(ends, word)
        strips, line = self.layer.strips, np.empty((4 * len(word) + 8, 2))
        portals, funnel = (strips.left, strips.right, strips.line), new_funnel(len(word))
        points = line[: tighten_word(*portals, word, len(word), ends, funnel, line)].copy()
        points.flags.writeable = False
        length, clearance = measure_line(points, len(points)), 0.5 * found.lowest**0.5
        return Route(points, length, clearance, crossings_of(strips, word), found.chains)

    def shortest_length(self, start: XY, goal: XY, limit: float = inf) -> float:
        """Return the length of the shortest path of all, in squares; infinite when none is shorter than the limit."""
        strips = self.layer.strips
        if self._polyanya is None:
            self._polyanya = new_polyanya_search(1 << 14, strips)
        length = shortest_line(strips, (*start, *goal), limit, *self._polyanya)
        while self._polyanya.sizes[0] == SEARCH_OVERFLOW:
            self._polyanya = new_polyanya_search(4 * len(self._polyanya.nodes.key), strips)
            length = shortest_line(strips, (*start, *goal), limit, *self._polyanya)
        return inf if self._polyanya.sizes[0] == NO_PATH else float(length)

    def shortest(self, start: XY, goal: XY) -> Route | None:
        """Return the shortest route of all, at any angle; None when start and goal are not connected."""
        length = self.shortest_length(start, goal)
        return None if length == inf else self._polyanya_route(length, None)

    def _polyanya_route(self, length: float, ends: Ends | None) -> Route:
        """Return the route left in the scratch by the last search for the shortest path, with its points in squares."""
        polyanya = cast(PolyanyaSearch, self._polyanya)
        size, corners = polyanya.sizes.tolist()
        points, word = polyanya.line[:corners].copy(), polyanya.word[:size]
        points.flags.writeable = False
        clearance, chains = nan, cast(tuple[int, ...], ())
        if ends is not None:
            found = self._lifted(ends, word)
            clearance, chains = 0.5 * found.lowest**0.5, found.chains
        return Route(points, length, clearance, crossings_of(self.layer.strips, word), chains)

    def _lifted(self, ends: Ends, word: Ints) -> Lifted:
        """Return the path over the skeleton of a reduced word: its least squared clearance and its chains."""
        found, self._trail_scratch = lift_to_skeleton(self.layer, ends, word, self._trail_scratch)
        return found

    def _router_buffers(self, wanted: int, room: int) -> RouterBuffers:
        """Return scratch for `wanted` routes, with room for words of at least `room` symbols (signed portals)."""
        buffers = self._buffers_of.get(wanted)
        if buffers is None or len(buffers.start) < room:
            nodes, landmark_distances = self.layer.landmarks.sight.shape
            chains = len(self.layer.landmarks.length)
            buffers = new_router_buffers(nodes, chains, landmark_distances, wanted, max(room, 1024))
            self._buffers_of[wanted] = buffers
        return buffers
