"""Queries about one layer of a screen: routes, the shortest path of all; and the scratch that they share."""

from collections.abc import Callable
from itertools import pairwise
from math import hypot, inf, nan
from typing import cast

import numpy as np

from utak.geometry.homotopy.funnel import Ends
from utak.geometry.homotopy.landmarks import compute_landmarks
from utak.geometry.homotopy.portals import crossings_of, join_words, word_of_cells, word_of_line
from utak.geometry.homotopy.strips import find_strips
from utak.geometry.kernels.arrays import XY, Ints
from utak.geometry.passages.necks import Passage
from utak.geometry.pathfinders.polyanya import (
    NO_PATH,
    SEARCH_OVERFLOW,
    PolyanyaSearch,
    new_polyanya_search,
    shortest_line,
)
from utak.geometry.raster.exact_clearance import disc_stays_clear
from utak.geometry.routes.barrier import Barrier, build_barrier, path_over_cells, path_to_skeleton
from utak.geometry.routes.layer import Layer
from utak.geometry.routes.lifting import Lifted, Trail, lift_to_skeleton, lift_word, new_trail
from utak.geometry.routes.route import Route, polyline_length, routes_of_answers
from utak.geometry.routes.router import (
    ROUTER_OVERFLOW,
    RouterBuffers,
    RoutingData,
    itineraries,
    new_router_buffers,
    routing_data,
)
from utak.geometry.routes.tighten import tight_route
from utak.geometry.skeleton.chains import Chains

# Paths tried beyond those wanted, since their order changes when they are pulled tight; see docs/geometry.md.
EXTRA_PATHS = 8  # on pathgraphs of at most SMALL_PATHGRAPH chains
EXTRA_PATHS_IF_LARGE = 1  # on larger pathgraphs
SMALL_PATHGRAPH = 128  # chains
LENGTH_TOLERANCE = 1e-9  # squares; lengths that differ by less are equal but for rounding
NO_CLOSED_STEPS: Ints = np.zeros((0, 2), np.int32)


def compile_route_kernels() -> None:
    """Compile the routing kernels, which take longest, for the array types of screens, before there is a screen."""
    ints, ends_of, none = np.zeros(1, np.int32), np.full((1, 4), -1, np.int32), np.full((1, 4), -1, np.int16)
    chains = Chains(ints, ends_of, np.empty((0, 2), np.int32), ints, ints, ints[:0])  # one node, no chain
    strips = find_strips(none, 1)
    data = RoutingData(
        none[0], np.zeros(1, np.uint8), 1, chains, strips, compute_landmarks(none, chains, strips, False), False
    )
    ends = 0.0, 0.0, 0.0, 0.0
    itineraries.entry(data, ends, 1, new_router_buffers(1, 1, 1, 1, 8, NO_CLOSED_STEPS))
    shortest_line.entry(strips, ends, inf, *new_polyanya_search(8, strips))
    lift_word.entry(none[0], data.states, 1, chains, strips, ends, ints, new_trail(1))


class LayerQueries:
    """A layer with the scratch of its searches, which grows as needed."""

    def __init__(self, layer: Layer, level: int, radius: float) -> None:
        """Take a layer, and make no scratch yet."""
        self.layer = layer
        self.level = level
        self.radius = radius
        self._width: int = layer.square.shape[1]
        self._winding = bool(layer.runs.crossing.any())
        self._buffers_of: dict[int, RouterBuffers] = {}
        self._polyanya: PolyanyaSearch | None = None
        self._data = routing_data(layer)
        self._kernel: Callable[[RoutingData, Ends, int, RouterBuffers], int] | None = None
        self._trail_scratch: Trail | None = None
        self._barrier: tuple[tuple[Passage, ...], Barrier] | None = None

    def admits(self, point: XY) -> bool:
        """Return whether the body may be at a point, at the centre of its square, and on the line between them."""
        if self.layer.square.item(int(point[1]) + 1, int(point[0]) + 1) < self.level:
            return False
        return not self.layer.body or disc_stays_clear(self.layer.square, point, self.snap(point), self.radius)

    def to_point(self, start: XY, goal: XY, k: int, avoid: tuple[Passage, ...] = ()) -> list[Route]:
        """Return at most k routes between two points, shortest first; an empty list when they are not connected."""
        if avoid:
            return self._avoiding(start, goal, k, self.barrier(avoid))
        buffers, found = self._search((*self.snap(start), *self.snap(goal)), self._candidate_count(k), NO_CLOSED_STEPS)
        routes = routes_of_answers(buffers.answers, found, k)
        if not self.layer.body:
            return self._with_shortest(routes, start, goal, k) if k > 1 and self._winding and routes else routes
        return [self.with_ends(route, start, goal) for route in routes]

    def _candidate_count(self, k: int) -> int:
        """Return how many paths over the pathgraph are pulled tight for k routes: 1 for one route, else some more."""
        return (
            1
            if k == 1
            else k + (EXTRA_PATHS if len(self.layer.landmarks.length) <= SMALL_PATHGRAPH else EXTRA_PATHS_IF_LARGE)
        )

    def _search(self, ends: Ends, wanted: int, closed_steps: Ints) -> tuple[RouterBuffers, int]:
        """Find the best paths over the pathgraph, pulled tight; return the buffers that hold them, and their number."""
        found, room = ROUTER_OVERFLOW, 0
        while found == ROUTER_OVERFLOW:
            buffers = self._router_buffers(wanted, room)
            if len(closed_steps):
                buffers.query.closed[closed_steps[:, 0]] |= 1
                buffers = buffers._replace(query=buffers.query._replace(closed_steps=closed_steps))
            if self._kernel is None:
                self._kernel = itineraries.entry(self._data, ends, wanted, buffers)
            found = self._kernel(self._data, ends, wanted, buffers)
            if len(closed_steps):
                buffers.query.closed[:] = 0
            room = 4 * len(buffers.start)
        return buffers, found

    def _with_shortest(self, routes: list[Route], start: XY, goal: XY, k: int) -> list[Route]:
        """Return at most k routes: those given, after the shortest path of all if none of them is of its class."""
        first = routes[0].length - LENGTH_TOLERANCE
        if first <= hypot(goal[0] - start[0], goal[1] - start[1]):
            return routes
        length = self.shortest_length(start, goal, first)
        return routes if length >= first else [self._polyanya_route(length, (*start, *goal)), *routes][:k]

    def barrier(self, avoid: tuple[Passage, ...]) -> Barrier:
        """Return the floor cut along some passages, so that no route leads through them."""
        if self._barrier is None or self._barrier[0] != avoid:
            self._barrier = avoid, build_barrier(self.layer, self.level, avoid)
        return self._barrier[1]

    def _avoiding(self, start: XY, goal: XY, k: int, barrier: Barrier) -> list[Route]:
        """Return at most k routes between two points that lead through no passage of a barrier, shortest first."""
        # The list is empty when the barrier separates the points.
        first, last = self.cell(start), self.cell(goal)
        if barrier.separates(first, last):
            return []
        up = path_to_skeleton(self.layer, self.level, barrier, first)
        down = path_to_skeleton(self.layer, self.level, barrier, last)
        words: list[Ints] = []
        if up and down:
            rise, fall = (
                word_of_cells(self.layer.runs, up, self._width),
                word_of_cells(self.layer.runs, down, self._width),
            )
            buffers, found = self._search(
                (*self.centre(up[-1]), *self.centre(down[-1])), self._candidate_count(k), barrier.closed_steps
            )
            for route in routes_of_answers(buffers.answers, found, found):
                between = word_of_line(self.layer.runs, route.points.tolist())
                words.append(join_words(rise, between, -fall[::-1]))
        if not words:
            goals = np.zeros(self.layer.square.size, np.bool_)
            goals[last] = True
            path = path_over_cells(self.layer, self.level, barrier, first, goals) or []
            words.append(join_words(word_of_cells(self.layer.runs, path, self._width)))
        routes = sorted((self.of_word(start, goal, word) for word in words), key=lambda route: route.length)
        return routes[:k]

    def of_word(self, start: XY, goal: XY, word: Ints) -> Route:
        """Return the tight route of a reduced word between two points, with its clearance and chains."""
        ends = (*self.snap(start), *self.snap(goal))
        found = self._lifted(ends, word)
        route = tight_route(self.layer, ends, word, 0.5 * found.lowest**0.5, found.chains)
        return self.with_ends(route, start, goal)

    def shortest_length(self, start: XY, goal: XY, limit: float = inf) -> float:
        """Return the length of the shortest path of all, in squares; infinite when none is shorter than the limit."""
        strips = self.layer.runs
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
        return Route(points, length, clearance, crossings_of(self.layer.runs, word), chains)

    def _lifted(self, ends: Ends, word: Ints) -> Lifted:
        """Return the path over the skeleton of a reduced word: its least squared clearance and its chains."""
        found, self._trail_scratch = lift_to_skeleton(self.layer, ends, word, self._trail_scratch)
        return found

    def _router_buffers(self, wanted: int, room: int) -> RouterBuffers:
        """Return scratch for `wanted` routes, with room for words of at least `room` symbols (signed portals)."""
        buffers = self._buffers_of.get(wanted)
        if buffers is None or len(buffers.start) < room:
            nodes, landmark_distances = self.layer.landmarks.sight.shape
            buffers = new_router_buffers(
                nodes, len(self.layer.landmarks.length), landmark_distances, wanted, max(room, 1024), NO_CLOSED_STEPS
            )
            self._buffers_of[wanted] = buffers
        return buffers

    def snap(self, point: XY) -> XY:
        """Return the point at which a tight path ends: for a body the centre of the point's square, else the point."""
        return (int(point[0]) + 0.5, int(point[1]) + 0.5) if self.layer.body else point

    def with_ends(self, route: Route, start: XY, goal: XY) -> Route:
        """Return a body's route extended to its true ends, if they are not centres of squares."""
        # Else the route itself.
        line = [(x, y) for x, y in route.points.tolist()]
        if len(line) == 1 and disc_stays_clear(self.layer.square, start, goal, self.radius):
            line = [start, goal]  # within one square
        line = [start, *line, goal]
        line = line[:1] + [q for p, q in pairwise(line) if p != q]
        points = np.array(line)
        if np.array_equal(points, route.points):
            return route
        points.flags.writeable = False
        return Route(points, polyline_length(points), route.clearance, route.signature, route.chains)

    def cell(self, point: XY) -> int:
        """Return the index, in the flat padded grid, of the cell of a point's square."""
        return (int(point[1]) + 1) * self._width + int(point[0]) + 1

    def centre(self, cell: int) -> XY:
        """Return the centre (x, y), in squares, of a cell given by its index in the flat padded grid."""
        return cell % self._width - 0.5, cell // self._width - 0.5
