"""Queries about one layer of a screen: routes, the shortest path of all; and the scratch that they share."""

from collections.abc import Callable
from itertools import pairwise
from math import hypot, inf, nan
from typing import cast

import numpy as np

from geometry.homotopy.funnel import Ends
from geometry.homotopy.landmarks import compute_landmarks
from geometry.homotopy.portals import crossings_of, join_words, word_of_cells, word_of_line
from geometry.homotopy.strips import find_strips
from geometry.kernels.arrays import XY, Ints
from geometry.passages.necks import Passage
from geometry.pathfinders.polyanya import NO_PATH, SEARCH_OVERFLOW, PolyanyaSearch, new_polyanya_search, shortest_line
from geometry.raster.exact_clearance import disc_stays_clear
from geometry.routes.barrier import Barrier, build_barrier, path_over_cells, path_to_skeleton
from geometry.routes.layer import Layer
from geometry.routes.lifting import Lifted, Trail, lift_to_skeleton, lift_word, new_trail
from geometry.routes.route import Route, polyline_length, routes_of_answers
from geometry.routes.router import (
    ROUTER_OVERFLOW,
    RouterBuffers,
    RoutingData,
    itineraries,
    new_router_buffers,
    routing_data,
)
from geometry.routes.tighten import tight_route
from geometry.skeleton.chains import Chains

# Paths tried beyond those wanted, since their order changes when they are pulled tight; see docs/geometry.md.
EXTRA_PATHS = 8  # on pathgraphs of at most SMALL_PATHGRAPH chains
EXTRA_PATHS_IF_LARGE = 1  # on larger pathgraphs
SMALL_PATHGRAPH = 128  # chains
LENGTH_TOLERANCE = 1e-9  # squares; lengths that differ by less are equal but for rounding
NO_CLOSED_STEPS: Ints = np.zeros((0, 2), np.int32)


def compile_route_kernels() -> None:
    """Compile the routing kernels, which take longest, for the array types of screens, before there is a screen.

    Nothing is returned: the machine code is kept by numba.
    """
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
    """A layer with the scratch of its searches, which grows as needed.

    Points are (x, y) in squares from the screen's south-west corner. A body moves between centres of squares; its
    routes begin and end with straight lines from and to its true ends. A cell is a square given by its index in the
    flat padded grid, (row + 1) * width + column + 1. A word is an array of signed portals, negative when crossed
    southwards (see strips.py).

    Attributes
    ----------
    layer : the layer that is asked.
    level : the least squared clearance of a cell where the body may be, in squared half squares.
    radius : of the body, in squares; 0 for a point.
    """

    def __init__(self, layer: Layer, level: int, radius: float) -> None:
        """Take a layer, and make no scratch yet.

        Parameters
        ----------
        layer : the free space of a body of one radius: skeleton, pathgraph and strips.
        level : the least squared clearance of a cell where the body may be, in squared half squares; that of the layer.
        radius : of the body, in squares; 0 for a point.
        """
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
        """Return whether the body may be at a point, at the centre of its square, and on the line between them.

        The point is (x, y) in squares from the screen's south-west corner and must lie on the screen.
        """
        if self.layer.square.item(int(point[1]) + 1, int(point[0]) + 1) < self.level:
            return False
        return not self.layer.body or disc_stays_clear(self.layer.square, point, self.snap(point), self.radius)

    def to_point(self, start: XY, goal: XY, k: int, avoid: tuple[Passage, ...] = ()) -> list[Route]:
        """Return at most k routes between two points, shortest first; an empty list when they are not connected.

        A route holds its corners (x, y) in squares from the screen's south-west corner, both ends included, its length
        and clearance in squares, its signature (the crossing numbers that name its class), and the chains that it
        follows. Each is the shortest of its class.

        Parameters
        ----------
        start, goal : (x, y) in squares from the screen's south-west corner, where `admits` holds.
        k : how many routes at most.
        avoid : passages through which no route may lead.
        """
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
        """Find the best paths over the pathgraph, pulled tight; return the buffers that hold them, and their number.

        The routes stand in `answers` of the buffers, in the order of their paths over the pathgraph; the next search
        overwrites them. A chain is an edge of the pathgraph (whose nodes are the junctions and ends of the skeleton),
        with its cells.

        Parameters
        ----------
        ends : x and y of the start, x and y of the goal, in squares from the screen's south-west corner.
        wanted : how many paths at most; for one, up to three routes are found, of which the shortest is meant.
        closed_steps : (b, 2) chain and position of steps that may not be taken.
        """
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
        """Return at most k routes: those given, preceded by the shortest path of all if none of them is of its class.

        When one of them is, they are returned as they are, however many there are.

        Parameters
        ----------
        routes : routes from start to goal, shortest first; at least one.
        start, goal : (x, y) in squares from the screen's south-west corner.
        k : how many routes at most.
        """
        first = routes[0].length - LENGTH_TOLERANCE
        if first <= hypot(goal[0] - start[0], goal[1] - start[1]):
            return routes
        length = self.shortest_length(start, goal, first)
        return routes if length >= first else [self._polyanya_route(length, (*start, *goal)), *routes][:k]

    def barrier(self, avoid: tuple[Passage, ...]) -> Barrier:
        """Return the floor cut along some passages, so that no route leads through them.

        It holds the part of each padded cell, which steps between edge neighbours are cut, and which steps of chains.
        The last barrier is kept, and returned again when `avoid`, the passages, is the same.
        """
        if self._barrier is None or self._barrier[0] != avoid:
            self._barrier = avoid, build_barrier(self.layer, self.level, avoid)
        return self._barrier[1]

    def _avoiding(self, start: XY, goal: XY, k: int, barrier: Barrier) -> list[Route]:
        """Return at most k routes between two points that lead through no passage of a barrier, shortest first.

        The list is empty when the barrier separates the points. Points, lengths and clearances are in squares; each
        route is the shortest of its class.

        Parameters
        ----------
        start, goal : (x, y) in squares from the screen's south-west corner, where `admits` holds.
        k : how many routes at most.
        barrier : the floor cut along the passages: the part of each cell, and which steps between cells are cut.
        """
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
        """Return the tight route of a reduced word between two points, with its clearance and chains.

        Its points (from the screen's south-west corner), length and clearance are in squares; it is the shortest of its
        class, which the word names.
        A chain is an edge of the pathgraph (whose nodes are the junctions and ends of the skeleton), with its cells. A
        word is reduced when no symbol stands next to its negative. A portal is the overlap of two strips (rows of free
        squares) in neighbouring rows.

        Parameters
        ----------
        start, goal : (x, y) in squares from the screen's south-west corner, where `admits` holds.
        word : (n,) signed portals (index plus 1, negative when crossed southwards) from the start's strip to the
            goal's.
        """
        ends = (*self.snap(start), *self.snap(goal))
        found = self._lifted(ends, word)
        route = tight_route(self.layer, ends, word, 0.5 * found.lowest**0.5, found.chains)
        return self.with_ends(route, start, goal)

    def shortest_length(self, start: XY, goal: XY, limit: float = inf) -> float:
        """Return the length of the shortest path of all, in squares; infinite when none is shorter than the limit.

        The path is that of a point over the whole squares of the layer. It is left in the scratch. When both ends lie
        in one strip, its length is returned whatever the limit.

        Parameters
        ----------
        start, goal : (x, y) in squares from the screen's south-west corner, in free squares.
        limit : a length in squares from which on a path is of no interest; infinite for none.
        """
        strips = self.layer.runs
        if self._polyanya is None:
            self._polyanya = new_polyanya_search(1 << 14, strips)
        length = shortest_line(strips, (*start, *goal), limit, *self._polyanya)
        while self._polyanya.sizes[0] == SEARCH_OVERFLOW:
            self._polyanya = new_polyanya_search(4 * len(self._polyanya.nodes.key), strips)
            length = shortest_line(strips, (*start, *goal), limit, *self._polyanya)
        return inf if self._polyanya.sizes[0] == NO_PATH else float(length)

    def shortest(self, start: XY, goal: XY) -> Route | None:
        """Return the shortest route of all, at any angle; None when start and goal are not connected.

        Its points (x, y) and its length are in squares, its signature names its class.
        Its clearance is nan and its chains are empty: they are not known. `start` and `goal` are (x, y) in squares from
        the screen's south-west corner, in free squares. A chain is an edge of the pathgraph (whose nodes are the
        junctions and ends of the skeleton), with its cells.
        """
        length = self.shortest_length(start, goal)
        return None if length == inf else self._polyanya_route(length, None)

    def _polyanya_route(self, length: float, ends: Ends | None) -> Route:
        """Return the route left in the scratch by the last search for the shortest path, with its points in squares.

        It is lifted to the skeleton when its ends are given: it then has the clearance (squares) and the chains there.
        A chain is an edge of the pathgraph (whose nodes are the junctions and ends of the skeleton), with its cells.

        Parameters
        ----------
        length : of the route, in squares.
        ends : x and y of the start, x and y of the goal, in squares from the screen's south-west corner; with None the
            clearance is nan and there are no chains.
        """
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
        """Return the path over the skeleton of a reduced word: its least squared clearance and its chains.

        The clearance (`lowest`) is in squared half squares, the chains are numbers in the order of the path.
        A chain is an edge of the pathgraph (whose nodes are the junctions and ends of the skeleton), with its cells. A
        word is reduced when no symbol stands next to its negative. A portal is the overlap of two strips (rows of free
        squares) in neighbouring rows.

        Parameters
        ----------
        ends : x and y of the start, x and y of the goal, in squares from the screen's south-west corner.
        word : (n,) signed portals (index plus 1, negative when crossed southwards) from the start's strip to the
            goal's.
        """
        found, self._trail_scratch = lift_to_skeleton(self.layer, ends, word, self._trail_scratch)
        return found

    def _router_buffers(self, wanted: int, room: int) -> RouterBuffers:
        """Return scratch for `wanted` routes, with room for words of at least `room` symbols (signed portals).

        It holds the arcs that a query adds, scratch of the searches, and the routes found, as arrays.
        It is kept for each number of routes, and made anew when it has too little room. A signed portal is a portal's
        index plus 1, negative when it is crossed southwards. A portal is the overlap of two strips (rows of free
        squares) in neighbouring rows.
        """
        buffers = self._buffers_of.get(wanted)
        if buffers is None or len(buffers.start) < room:
            nodes, landmark_distances = self.layer.landmarks.sight.shape
            buffers = new_router_buffers(
                nodes, len(self.layer.landmarks.length), landmark_distances, wanted, max(room, 1024), NO_CLOSED_STEPS
            )
            self._buffers_of[wanted] = buffers
        return buffers

    def snap(self, point: XY) -> XY:
        """Return the point at which a tight path ends: for a body the centre of the point's square, else the point.

        Both are (x, y) in squares from the screen's south-west corner.
        """
        return (int(point[0]) + 0.5, int(point[1]) + 0.5) if self.layer.body else point

    def with_ends(self, route: Route, start: XY, goal: XY) -> Route:
        """Return a body's route extended to its true ends, if they are not centres of squares; else the route itself.

        Within one square it becomes the straight line if that leaves room for the body. The length is that of the whole
        line; clearance, signature and chains stay. A chain is an edge of the pathgraph (whose nodes are the junctions
        and ends of the skeleton), with its cells.

        Parameters
        ----------
        route : a route between the centres of the ends' squares; not changed.
        start, goal : the true ends, (x, y) in squares from the screen's south-west corner.
        """
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
        """Return the index, in the flat padded grid, of the cell of a point's square.

        The point is (x, y) in squares from the screen's south-west corner and must lie on the screen: this is not
        checked. A cell's index is (row + 1) * width + column + 1, with width = columns + 2.
        """
        return (int(point[1]) + 1) * self._width + int(point[0]) + 1

    def centre(self, cell: int) -> XY:
        """Return the centre (x, y), in squares, of a cell given by its index in the flat padded grid.

        A cell's index is (row + 1) * width + column + 1, with width = columns + 2.
        """
        return cell % self._width - 0.5, cell // self._width - 0.5
