"""LayerQueries put to one layer of a screen, and the scratch they share."""

from collections.abc import Callable
from itertools import pairwise
from math import hypot, inf, nan
from typing import cast

import numpy as np

from geometry.homotopy.funnel import Ends
from geometry.homotopy.landmarks import ascend, find_ways, locate
from geometry.homotopy.portals import crossings_of, join_words, word_of_line
from geometry.homotopy.strips import find_runs
from geometry.kernels.arrays import XY, Bools, Ints
from geometry.passages.necks import Passage
from geometry.pathfinders.polyanya import FULL, NONE, PolyanyaSearch, new_scout, shortest_line
from geometry.raster.exact_clearance import keeps_clear
from geometry.routes.barrier import Barrier, raise_barrier, way_over_cells, way_to_skeleton
from geometry.routes.goal_sets import word_of_cells
from geometry.routes.layer import Layer
from geometry.routes.lifting import Lifted, Trail, lift, lift_word, new_trail
from geometry.routes.loops import Arc, cells_of_way, closed_ways
from geometry.routes.route import Route, length_of, read_answers
from geometry.routes.router import OVERFLOW, RouterBuffers, RoutingData, ground_of, itineraries, new_desk
from geometry.routes.tighten import tight_route
from geometry.skeleton.chains import Chains

SPARE, FEWER = 8, 1  # ways tried beyond those wanted, since their order changes when ropes are pulled tight
SMALL = 128  # chains of a pathgraph up to which SPARE ways are tried, else FEWER
CLOSE = 1e-9  # squares by which lengths may differ for rounding
NO_BARS: Ints = np.zeros((0, 2), np.int32)


def rehearse() -> None:
    """Compile the longest, the searches for routes, before there is a screen, for arrays of the types they meet."""
    ints, ends_of, none = np.zeros(1, np.int32), np.full((1, 4), -1, np.int32), np.full((1, 4), -1, np.int16)
    chains = Chains(ints, ends_of, np.empty((0, 2), np.int32), ints, ints, ints[:0])  # one node, no chain
    runs = find_runs(none, 1)
    ground = RoutingData(none[0], np.zeros(1, np.uint8), 1, chains, runs, find_ways(none, chains, runs, False), False)
    ends = 0.0, 0.0, 0.0, 0.0
    itineraries.entry(ground, ends, 1, new_desk(1, 1, 1, 1, 8, NO_BARS))
    shortest_line.entry(runs, ends, inf, *new_scout(8, runs))
    lift_word.entry(none[0], ground.states, 1, chains, runs, ends, ints, new_trail(1))


class LayerQueries:
    """A layer with the scratch of its searches, which grows as needed."""

    def __init__(self, layer: Layer, level: int, radius: float) -> None:
        self.layer = layer
        self.level = level
        self.radius = radius
        self._width: int = layer.square.shape[1]
        self._winding = bool(layer.runs.crossing.any())
        self._desks: dict[int, RouterBuffers] = {}
        self._scout: PolyanyaSearch | None = None
        self._ground = ground_of(layer)
        self._solve: Callable[[RoutingData, Ends, int, RouterBuffers], int] | None = None
        self._trail: Trail | None = None
        self._raised: tuple[tuple[Passage, ...], Barrier] | None = None

    def admits(self, point: XY) -> bool:
        """Whether the body may be at a point, in the middle of the point's square, and on the straight way there."""
        if self.layer.square.item(int(point[1]) + 1, int(point[0]) + 1) < self.level:
            return False
        return not self.layer.body or keeps_clear(self.layer.square, point, self.snap(point), self.radius)

    def to_point(self, start: XY, goal: XY, k: int, avoid: tuple[Passage, ...] = ()) -> list[Route]:
        """Routes between two points."""
        if avoid:
            return self._avoiding(start, goal, k, self.barrier(avoid))
        desk, found = self._search((*self.snap(start), *self.snap(goal)), self._tries(k), NO_BARS)
        routes = read_answers(desk.answers, found, k)
        if not self.layer.body:
            return self._with_shortest(routes, start, goal, k) if k > 1 and self._winding and routes else routes
        return [self.with_ends(route, start, goal) for route in routes]

    def _tries(self, k: int) -> int:
        """How many ways over the pathgraph are pulled tight for so many routes."""
        return 1 if k == 1 else k + (SPARE if len(self.layer.ways.length) <= SMALL else FEWER)

    def _search(self, ends: Ends, wanted: int, bars: Ints) -> tuple[RouterBuffers, int]:
        """The best ways over the pathgraph, pulled tight, and how many there are."""
        found, room = OVERFLOW, 0
        while found == OVERFLOW:
            desk = self._desk(wanted, room)
            if len(bars):
                desk.query.shut[bars[:, 0]] |= 1
                desk = desk._replace(query=desk.query._replace(bars=bars))
            if self._solve is None:
                self._solve = itineraries.entry(self._ground, ends, wanted, desk)
            found = self._solve(self._ground, ends, wanted, desk)
            if len(bars):
                desk.query.shut[:] = 0
            room = 4 * len(desk.start)
        return desk, found

    def _with_shortest(self, routes: list[Route], start: XY, goal: XY, k: int) -> list[Route]:
        """The routes with the shortest of all before them, should none of them be of its class."""
        first = routes[0].length - CLOSE
        if first <= hypot(goal[0] - start[0], goal[1] - start[1]):
            return routes
        length = self.measure(start, goal, first)
        return routes if length >= first else [self._scouted(length, (*start, *goal)), *routes][:k]

    def lifted(self, route: Route) -> Route:
        """The same route with what is known of its class over the skeleton."""
        ends = (*self.snap(route.points[0].tolist()), *self.snap(route.points[-1].tolist()))
        found = self._lift(ends, word_of_line(self.layer.runs, route.points.tolist()))
        return Route(route.points, route.length, 0.5 * found.lowest**0.5, route.signature, found.chains)

    def barrier(self, avoid: tuple[Passage, ...]) -> Barrier:
        """The floor cut along some passages; the last one is kept."""
        if self._raised is None or self._raised[0] != avoid:
            self._raised = avoid, raise_barrier(self.layer, self.level, avoid)
        return self._raised[1]

    def _avoiding(self, start: XY, goal: XY, k: int, barrier: Barrier) -> list[Route]:
        """Routes between two points that lead through no passage of a barrier."""
        first, last = self.cell(start), self.cell(goal)
        if barrier.parted(first, last):
            return []
        up = way_to_skeleton(self.layer, self.level, barrier, first)
        down = way_to_skeleton(self.layer, self.level, barrier, last)
        words: list[Ints] = []
        if up and down:
            rise, fall = (
                word_of_cells(self.layer.runs, up, self._width),
                word_of_cells(self.layer.runs, down, self._width),
            )
            desk, found = self._search((*self.centre(up[-1]), *self.centre(down[-1])), self._tries(k), barrier.bars)
            for route in read_answers(desk.answers, found, found):
                between = word_of_line(self.layer.runs, route.points.tolist())
                words.append(join_words(rise, between, -fall[::-1]))
        if not words:
            goals = np.zeros(self.layer.square.size, np.bool_)
            goals[last] = True
            way = way_over_cells(self.layer, self.level, barrier, first, goals) or []
            words.append(join_words(word_of_cells(self.layer.runs, way, self._width)))
        routes = sorted((self.of_word(start, goal, word) for word in words), key=lambda route: route.length)
        return routes[:k]

    def of_word(self, start: XY, goal: XY, word: Ints) -> Route:
        """The route of a reduced word."""
        ends = (*self.snap(start), *self.snap(goal))
        found = self._lift(ends, word)
        route = tight_route(self.layer, ends, word, 0.5 * found.lowest**0.5, found.chains)
        return self.with_ends(route, start, goal)

    def measure(self, start: XY, goal: XY, limit: float = inf) -> float:
        """The length of the shortest way of all, which is left in the scout; infinite when none is below the limit."""
        runs = self.layer.runs
        if self._scout is None:
            self._scout = new_scout(1 << 14, runs)
        length = shortest_line(runs, (*start, *goal), limit, *self._scout)
        while self._scout.sizes[0] == FULL:
            self._scout = new_scout(4 * len(self._scout.nodes.key), runs)
            length = shortest_line(runs, (*start, *goal), limit, *self._scout)
        return inf if self._scout.sizes[0] == NONE else float(length)

    def shortest(self, start: XY, goal: XY) -> Route | None:
        """The shortest way of all, or None."""
        length = self.measure(start, goal)
        return None if length == inf else self._scouted(length, None)

    def _scouted(self, length: float, ends: Ends | None) -> Route:
        """The way left in the scout; with its way over the skeleton when its ends are told."""
        scout = cast(PolyanyaSearch, self._scout)
        size, corners = scout.sizes.tolist()
        points, word = scout.line[:corners].copy(), scout.word[:size]
        points.flags.writeable = False
        clearance, chains = nan, cast(tuple[int, ...], ())
        if ends is not None:
            found = self._lift(ends, word)
            clearance, chains = 0.5 * found.lowest**0.5, found.chains
        return Route(points, length, clearance, crossings_of(self.layer.runs, word), chains)

    def _lift(self, ends: Ends, word: Ints) -> Lifted:
        """The way over the skeleton of a reduced word."""
        found, self._trail = lift(self.layer, ends, word, self._trail)
        return found

    def loops(self, start: XY, around: Bools, k: int) -> list[Route]:
        """Closed routes that wind once about blocked squares."""
        cell = (int(start[1]) + 1) * self._width + int(start[0]) + 1
        ground, runs, chains = self._ground, self.layer.runs, self.layer.chains
        rise = np.empty(self.layer.square.size, np.int32)
        cell, size = ascend(cell, ground.heights, ground.states, ground.width, runs.row, runs.up, runs.left, rise)
        tracks = chains.node, chains.leave, chains.start, chains.cells
        anchor = locate(cell, ground.states, ground.width, *tracks)
        ways = closed_ways(self.layer, anchor, around, k + SPARE)
        routes = [self._loop(start, rise[:size], way) for way in ways]
        return sorted(routes, key=lambda route: route.length)[:k]

    def _loop(self, start: XY, rise: Ints, way: list[Arc]) -> Route:
        """The tight loop of a closed way over the pathgraph."""
        cells = cells_of_way(self.layer.chains, way)
        word = join_words(rise, word_of_cells(self.layer.runs, cells, self._width), -rise[::-1])
        lowest = min(int(self.layer.square.reshape(-1)[cells].min()), self._height(start))
        at = self.snap(start)
        chains = tuple(arc.chain for arc in way)
        route = tight_route(self.layer, (*at, *at), word, 0.5 * lowest**0.5, chains)
        return self.with_ends(route, start, start)

    def _desk(self, wanted: int, room: int) -> RouterBuffers:
        """Scratch for that many routes, with at least that much room for words."""
        desk = self._desks.get(wanted)
        if desk is None or len(desk.start) < room:
            nodes, sights = self.layer.ways.sight.shape
            desk = new_desk(nodes, len(self.layer.ways.length), sights, wanted, max(room, 1024), NO_BARS)
            self._desks[wanted] = desk
        return desk

    def snap(self, point: XY) -> XY:
        """Where a rope ends: a body's at the centre of its square."""
        return (int(point[0]) + 0.5, int(point[1]) + 0.5) if self.layer.body else point

    def with_ends(self, route: Route, start: XY, goal: XY) -> Route:
        """A body's route with its true ends, if they are not at centres."""
        line = [(x, y) for x, y in route.points.tolist()]
        if len(line) == 1 and keeps_clear(self.layer.square, start, goal, self.radius):
            line = [start, goal]  # within one square
        line = [start, *line, goal]
        line = line[:1] + [q for p, q in pairwise(line) if p != q]
        points = np.array(line)
        if np.array_equal(points, route.points):
            return route
        points.flags.writeable = False
        return Route(points, length_of(points), route.clearance, route.signature, route.chains)

    def cell(self, point: XY) -> int:
        """The padded cell of a point's square."""
        return (int(point[1]) + 1) * self._width + int(point[0]) + 1

    def centre(self, cell: int) -> XY:
        """The centre of a padded cell."""
        return cell % self._width - 0.5, cell // self._width - 0.5

    def _height(self, point: XY) -> int:
        height: int = self.layer.square.reshape(-1)[self.cell(point)].item()
        return height
