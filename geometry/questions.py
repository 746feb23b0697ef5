"""Questions put to one layer of a screen, and the scratch they share."""

from collections.abc import Callable
from math import nan

import numpy as np

from geometry.anyangle import FULL, NONE, Scout, new_scout, shortest_line
from geometry.bones import Ints
from geometry.chains import Chains, crossings
from geometry.distance import Bools
from geometry.goals import Region, entry, regions, way_in, word_of_cells
from geometry.itinerary import OVERFLOW, Desk, Ground, ground_of, itineraries, new_desk
from geometry.layer import Layer
from geometry.loops import Arc, cells_of_way, closed_ways
from geometry.passages import Passage
from geometry.polyline import crossings_of, join_words, word_of_line
from geometry.rope import Ends
from geometry.route import Route, read_answers
from geometry.runs import find_runs
from geometry.tightening import tight_route
from geometry.ways import ascend, find_ways, locate

XY = tuple[float, float]
SPARE, FEWER = 8, 1  # ways tried beyond those wanted, since their order changes when ropes are pulled tight
SMALL = 128  # chains of a pathgraph up to which SPARE ways are tried, else FEWER
SLACK = 1.03  # how much more than any way found a way beyond them may shrink
NO_BARS: Ints = np.zeros((0, 2), np.int32)


def rehearse() -> None:
    """Compile the longest, the searches for routes, before there is a screen, for arrays of the types they meet."""
    ints, ends_of, none = np.zeros(1, np.int32), np.full((1, 4), -1, np.int32), np.full((1, 4), -1, np.int16)
    chains = Chains(ints, ends_of, np.empty((0, 2), np.int32), ints, ints, ints[:0], np.empty(0))  # one node, no chain
    runs = find_runs(none, 1)
    ground = Ground(none[0], np.zeros(1, np.uint8), 1, chains, runs, find_ways(none, chains, runs, False), False)
    ends = 0.0, 0.0, 0.0, 0.0
    itineraries.entry(ground, ends, 1, new_desk(1, 1, 1, 1, 8, NO_BARS))
    shortest_line.entry(runs, ends, *new_scout(8, runs))


def may_miss(desk: Desk, found: int) -> bool:
    """Whether a way beyond those found may be the shortest of all when tight, should it shrink a little more."""
    cost, length = desk.album.cost[:found].tolist(), desk.answers.length[:found].tolist()
    least: float = min(length)
    return least > 0.0 and bool(cost[-1] < SLACK * least * max(a / b for a, b in zip(cost, length, strict=True)))


class Questions:
    """A layer with the scratch of its searches, which grows as needed."""

    def __init__(self, layer: Layer, level: int) -> None:
        self.layer = layer
        self.level = level
        self._width: int = layer.square.shape[1]
        self._desks: dict[int, Desk] = {}
        self._scout: Scout | None = None
        self._ground = ground_of(layer)
        self._solve: Callable[[Ground, Ends, int, Desk], int] | None = None

    def admits(self, point: XY) -> bool:
        """Whether the body may be in the square of a point."""
        return bool(self.layer.square.item(int(point[1]) + 1, int(point[0]) + 1) >= self.level)

    def to_point(self, start: XY, goal: XY, k: int, avoid: tuple[Passage, ...]) -> list[Route]:
        """Routes between two points."""
        wanted = 1 if k == 1 else k + (SPARE if len(self.layer.ways.length) <= SMALL else FEWER)
        ends = (*self._snap(start), *self._snap(goal))
        desk = self._desk(wanted, 0)
        if avoid:
            desk = self._forbid(desk, avoid)
        if self._solve is None:
            self._solve = itineraries.entry(self._ground, ends, wanted, desk)
        found = self._solve(self._ground, ends, wanted, desk)
        while found == OVERFLOW:
            desk = self._desk(wanted, 4 * len(desk.start))
            desk = self._forbid(desk, avoid) if avoid else desk
            found = self._solve(self._ground, ends, wanted, desk)
        if avoid:
            desk.query.shut[:] = 0
            desk.query.closed[:] = False
        if 1 < found == wanted and not avoid and not self.layer.body and may_miss(desk, found):
            routes = self._with_shortest(read_answers(desk.answers, found, found), start, goal)[:k]
        else:
            routes = read_answers(desk.answers, found, k)
        return [self._with_ends(route, start, goal) for route in routes] if self.layer.body else routes

    def _with_shortest(self, routes: list[Route], start: XY, goal: XY) -> list[Route]:
        """The routes with the shortest of all before them, should none of them be of its class."""
        best = self.shortest(start, goal)
        if best is None or any(route.signature == best.signature for route in routes):
            return routes
        return [best, *routes]

    def of_word(self, start: XY, goal: XY, word: Ints) -> Route:
        """The route of a reduced word."""
        clearance = 0.5 * min(self._height(start), self._height(goal)) ** 0.5
        route = tight_route(self.layer, (*self._snap(start), *self._snap(goal)), word, clearance, ())
        return self._with_ends(route, start, goal)

    def shortest(self, start: XY, goal: XY) -> Route | None:
        """The shortest way of all, or None."""
        runs = self.layer.runs
        if self._scout is None:
            self._scout = new_scout(1 << 14, runs)
        length = shortest_line(runs, (*start, *goal), *self._scout)
        while self._scout.sizes[0] == FULL:
            self._scout = new_scout(4 * len(self._scout.nodes.key), runs)
            length = shortest_line(runs, (*start, *goal), *self._scout)
        size, corners = self._scout.sizes.tolist()
        if size == NONE:
            return None
        points = self._scout.line[:corners].copy()
        points.flags.writeable = False
        return Route(points, length, nan, crossings_of(runs, self._scout.word[:size]), ())

    def to_area(self, start: XY, goal: Bools, k: int, avoid: tuple[Passage, ...]) -> list[Route]:
        """Routes to any square of a set."""
        if not self.admits(start):
            return []
        best: dict[tuple[int, Ints | tuple[int, ...]], Route] = {}
        for number, place in enumerate(regions(self.layer.square, self.level, goal)):
            centre = self._centre(place.cell)
            for route in self.to_point(start, centre, k + SPARE, avoid):
                cut = self._cut(route, goal, place, start)
                if cut is None:
                    continue
                tight, key = cut
                if (number, key) not in best or tight.length < best[number, key].length:
                    best[number, key] = tight
        return sorted(best.values(), key=lambda route: route.length)[:k]

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
        at = self._snap(start)
        chains = tuple(arc.chain for arc in way)
        route = tight_route(self.layer, (*at, *at), word, 0.5 * lowest**0.5, chains)
        return self._with_ends(route, start, start)

    def _cut(self, route: Route, goal: Bools, place: Region, start: XY) -> tuple[Route, tuple[int, ...]] | None:
        """A route up to where it enters a part of a goal set, and its class there; None if another part comes first."""
        points, (i, j) = entry(route.points, goal)
        cell = (j + 1) * self._width + i + 1
        if cell not in place.parent and cell != place.cell:
            return None
        word = word_of_line(self.layer.runs, points.tolist())
        key = join_words(word, word_of_cells(self.layer.runs, way_in(place, cell), self._width))
        tight = self._to_cell(route, start, word, cell)
        while True:
            nearer = [self._beside(route, start, word, cell, step, place) for step in (1, self._width)]
            nearer += [self._beside(route, start, word, cell, -step, place) for step in (1, self._width)]
            better = min((n for n in nearer if n is not None), key=lambda n: n[0].length, default=None)
            if better is None or better[0].length >= tight.length - 1e-9:
                return tight, tuple(key.tolist())
            tight, word, cell = better

    def _beside(
        self, route: Route, start: XY, word: Ints, cell: int, step: int, place: Region
    ) -> tuple[Route, Ints, int] | None:
        """The route to the next square of a part instead."""
        other = cell + step
        if other not in place.parent and other != place.cell:
            return None
        longer = join_words(word, word_of_cells(self.layer.runs, [cell, other], self._width))
        return self._to_cell(route, start, longer, other), longer, other

    def _to_cell(self, route: Route, start: XY, word: Ints, cell: int) -> Route:
        """The tight route of a word to the centre of a cell."""
        ends = (*self._snap(start), *self._centre(cell))
        tight = tight_route(self.layer, ends, word, route.clearance, route.chains)
        return self._with_ends(tight, start, ends[2:])

    def _forbid(self, desk: Desk, avoid: tuple[Passage, ...]) -> Desk:
        """The desk with the chains through some passages shut."""
        bars = np.concatenate([crossings(self.layer.chains, self._width, *passage.mouths[0]) for passage in avoid])
        desk.query.shut[bars[:, 0]] |= 1
        return desk._replace(query=desk.query._replace(bars=bars))

    def _desk(self, wanted: int, room: int) -> Desk:
        """Scratch for that many routes, with at least that much room for words."""
        desk = self._desks.get(wanted)
        if desk is None or len(desk.start) < room:
            nodes, sights = self.layer.ways.sight.shape
            desk = new_desk(nodes, len(self.layer.ways.length), sights, wanted, max(room, 1024), NO_BARS)
            self._desks[wanted] = desk
        return desk

    def _snap(self, point: XY) -> XY:
        """Where a rope ends: a body's at the centre of its square."""
        return (int(point[0]) + 0.5, int(point[1]) + 0.5) if self.layer.body else point

    def _with_ends(self, route: Route, start: XY, goal: XY) -> Route:
        """A body's route with its true ends, if they are not at centres."""
        points = route.points
        if tuple(points[0]) != start:
            points = np.vstack([[start], points])
        if tuple(points[-1]) != goal:
            points = np.vstack([points, [goal]])
        if points is route.points:
            return route
        points.flags.writeable = False
        length = float(np.hypot(*np.diff(points, axis=0).T).sum())
        return Route(points, length, route.clearance, route.signature, route.chains)

    def _cell(self, point: XY) -> int:
        return (int(point[1]) + 1) * self._width + int(point[0]) + 1

    def _centre(self, cell: int) -> XY:
        return cell % self._width - 0.5, cell // self._width - 0.5

    def _height(self, point: XY) -> int:
        height: int = self.layer.square.reshape(-1)[self._cell(point)].item()
        return height
