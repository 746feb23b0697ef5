"""Carrying by whole squares and quarter turns: all stays on the lattice on which it began, so beliefs stay certain."""

import math
from dataclasses import replace
from functools import lru_cache
from itertools import groupby, pairwise
from typing import Any

import numpy as np
import shapely

from geometry.board import AWKWARD, Costs, Grid, new_board, new_grid
from geometry.ends import At, placed, prices
from geometry.errand import Errand
from geometry.guess import NEVER, STILL, guess
from geometry.hauling import CALM, first_walk, haul
from geometry.legs import Leg, Point, grip_square, may_push, rounded, straight
from geometry.rigid import Motion, Rotate, Translate
from geometry.stencil import DIRECTIONS, Floats, Ints, Mask, Stencil, new_stencil, quarter
from geometry.yard import padded

EXACT = 8  # digits of places: what is off by less, after motions whose numbers were rounded, is not off
SEARCHES = ((CALM, 60_000), (2 * CALM, 400_000))  # haste, and nodes looked at before giving up
Step = tuple[int, int, int, int]  # hold, quarter, direction, place


def _stencils(shape: Any, margin: float) -> tuple[Stencil, Stencil]:
    """The stencils of a shape and of the shape with its margin."""
    home = (math.floor(shape.centroid.x), math.floor(shape.centroid.y))
    near = shapely.transform(shape, lambda p: np.round(p - np.array(home), EXACT))
    body, wide = _stencils_near(shapely.to_wkb(near), margin)
    return replace(body, home=home), body if wide is body else replace(wide, home=home)


@lru_cache(maxsize=32)
def _stencils_near(wkb: bytes, margin: float) -> tuple[Stencil, Stencil]:
    """The stencils of a shape whose centroid lies in the square (0, 0)."""
    shape = shapely.from_wkb(wkb)
    body = new_stencil(shape)
    return body, new_stencil(padded(shape, margin), body.holds) if margin > 0.0 else body


def carry_squarewise(errand: Errand) -> list[Leg] | None:
    """The cheapest legs by whole squares, or some in haste where that takes long; None when none are found."""
    body, wide = _stencils(errand.shape, errand.margin)
    rows, columns = errand.walk.shape
    if not (0 <= body.home[0] < columns and 0 <= body.home[1] < rows):
        return None
    grid, free = new_grid(errand.walk, body, wide), errand.yard.free
    board = new_board(grid, free, errand.walk, body, wide, _grips(errand, body), _allowed(errand, body))
    place = grid.number(*body.home)
    ends = prices(errand.goal, errand.shape, body, board, grid)
    left = guess(board, ends)
    if not 0 <= left[0, STILL, place] < NEVER:
        return None
    begin = first_walk(board, place, grid.number(*errand.square))
    count = 36 * len(begin) * len(board.solid)
    for haste, most in SEARCHES:
        cost, parent = np.zeros(count, np.int32), np.empty(count, np.int32)
        nodes = haul(board, left, ends, begin, place, haste, most, cost, parent)
        if len(nodes):
            return _Retelling(errand, body, grid).legs(nodes)
    return None


def _grips(errand: Errand, body: Stencil) -> Costs:
    """The price of a grasp at each hold, -1 where it is to be avoided."""
    middle = np.array([errand.shape.centroid.x, errand.shape.centroid.y])
    lying = {(int(x), int(y)) for x, y in body.lying}
    grips = []
    for x, y in body.holds.tolist():
        beside = any((x + dx, y + dy) in lying for dx, dy in DIRECTIONS[::2])
        away = np.array([x, y]) + body.home + 0.5 - middle
        grips.append(-1 if errand.avoids(float(away[0]), float(away[1])) else 0 if beside else AWKWARD)
    return np.array(grips, np.int32)


def _allowed(errand: Errand, body: Stencil) -> Mask:
    """In which directions one may push from each hold, in each quarter turn: (4, holds, 8)."""
    allowed = np.ones((4, len(body.holds), 8), np.bool_)
    if errand.pull:
        return allowed
    for n, (x, y) in enumerate(body.holds.tolist()):
        utak = (x + body.home[0] + 0.5, y + body.home[1] + 0.5)
        for d, (dx, dy) in enumerate(DIRECTIONS):
            fine = may_push(errand.shape, utak, dx, dy)
            for k in range(4):
                allowed[k, n, (d + 2 * k) % 8] = fine
    return allowed


class _Retelling:
    """The nodes of a search told as legs."""

    def __init__(self, errand: Errand, body: Stencil, grid: Grid) -> None:
        self.errand, self.body, self.grid = errand, body, grid
        self.holds = [quarter(body.holds, k) for k in range(4)]
        self.shape = errand.shape
        self.at = errand.square

    def legs(self, nodes: Ints) -> list[Leg]:
        """The legs, one for each run of nodes with the same hold."""
        count = (self.grid.rows + 2 * self.grid.pad) * self.grid.stride
        steps = [(n // count // 36, n // count // 9 % 4, n // count % 9, n % count) for n in nodes.tolist()]
        runs = [list(run) for _, run in groupby(steps, key=lambda step: step[0])]
        return [self._leg(run, run is runs[-1]) for run in runs]

    def _utak(self, step: Step) -> Point:
        """The middle of Utak's square at a step."""
        x, y = self.holds[step[1]][step[0]].tolist()
        column, row = self.grid.square(step[3])
        return column + x + 0.5, row + y + 0.5

    def _leg(self, run: list[Step], last: bool) -> Leg:
        place = self._utak(run[0])
        walk = abs(math.floor(place[0]) - self.at[0]) + abs(math.floor(place[1]) - self.at[1])
        square = grip_square(self.shape, place)
        assert square is not None
        motions: list[Motion] = []
        quarters = run[0][1]
        for k, group in groupby(run, key=lambda step: step[1]):
            steps = list(group)
            if k != quarters:
                motions.append(self._turned((k - quarters) % 4, self._utak(steps[0])))
            quarters = k
            motions += self._pushed(steps, last and steps[-1] is run[-1])
        x, y = self.body.holds[run[0][0]].tolist()
        middle = self.errand.shape.centroid
        hold = (x + self.body.home[0] + 0.5 - middle.x, y + self.body.home[1] + 0.5 - middle.y)
        self.at = self._square(run[-1])
        return Leg(place, square, tuple(motions), hold, walk)

    def _square(self, step: Step) -> tuple[int, int]:
        """Utak's square at a step."""
        x, y = self._utak(step)
        return math.floor(x), math.floor(y)

    def _turned(self, quarters: int, utak: Point) -> Motion:
        """Turn the shape; half a turn the way that has more room."""
        ways = [90.0] if quarters == 1 else [-90.0] if quarters == 3 else [180.0, -180.0]
        turns = [Rotate(degrees, utak) for degrees in ways]
        roomy = padded(self.shape, self.errand.margin)
        for shape in (roomy, self.shape):
            for turn in turns:
                if self.errand.yard.lets(shape, utak, turn):
                    self.shape = turn.carry(self.shape)
                    return turn
        self.shape = turns[0].carry(self.shape)
        return turns[0]

    def _pushed(self, steps: list[Step], last: bool) -> list[Motion]:
        """The pushes along the steps of one quarter turn, as few as can be; the last ones right to the goal."""
        stops, corners = self._stops(steps)
        goal = self.errand.goal
        if last and isinstance(goal, At):
            end, here = placed(self.errand.shape, goal.pose).centroid, self.shape.centroid
            final = stops[0] + np.array([end.x - here.x, end.y - here.y])
            if np.abs(final - stops[-1]).max() > 1e-9:
                corners = np.append(corners, len(stops))
                stops = np.vstack([stops, final])
        utak = (float(stops[0, 0]), float(stops[0, 1]))
        kept = straight(
            self.errand.yard, self.shape, utak, stops, corners, self.errand.margin, self.errand.pull
        )  # fmt: skip
        motions: list[Motion] = []
        for a, b in pairwise(kept):
            motions.append(rounded(Translate(float(stops[b, 0] - stops[a, 0]), float(stops[b, 1] - stops[a, 1]))))
            self.shape = motions[-1].carry(self.shape)
        return motions

    def _stops(self, steps: list[Step]) -> tuple[Floats, Ints]:
        """Where Utak is at each place on the way (n, 2), and at which of them the way turns, both ends among them."""
        stops = [self._utak(steps[0])]
        corners, heading = [0], 8
        for before, after in pairwise(steps):
            if after[3] == before[3]:
                continue
            if after[2] != heading and len(stops) > 1:
                corners.append(len(stops) - 1)
            heading = after[2]
            stops.append(self._utak(after))
        if len(stops) > 1:
            corners.append(len(stops) - 1)
        return np.array(stops), np.array(corners, dtype=np.int64)
