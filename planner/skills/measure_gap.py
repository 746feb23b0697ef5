"""Measuring a passage: the robot walks in it against one side, and then against the other.

A wall lies anywhere in the squares in which it is seen. The robot walks along a row of floor a little into the first
square of the wall, and less than that back. Where it is in the last square of floor then, it was stopped, so the wall
begins at most so far behind the line between the squares: nothing else stops a robot, and no wall is in a square that
is free. So what is between two such ends is known that well. Where it is still in the square of the wall, this lies
further back. It is not walked against: a robot takes what stops it for lying at a line, and would mistake its place.
"""

import math
from itertools import count, product
from typing import NamedTuple

import numpy as np

from utak.geometry.cspace.bottleneck import Bottleneck
from utak.geometry.kernels.arrays import XY, Bools, Square
from utak.kb.body import DIRECTIONS
from utak.kb.mapping.occupancy import FREE, OCCUPIED, OPEN
from utak.kb.world.model import WorldModel

STEP_BACK = 0.05  # squares back from a wall, within which the line is looked for where it begins; a convention
PAST_DOUBT = 0.05  # squares into the wall, besides the way back and what the place is unsure; a convention
MAX_LEEWAY = 0.2  # squares by which the place along the row may be unsure for such a walk; a convention
OFF_MIDDLE = 0.45  # squares from the middle of a row within which the robot surely walks; half a square is its side


class PassageRow(NamedTuple):
    """A row of floor from one side of a passage to the other. Squares (x, y) of the map frame."""

    squares: tuple[Square, ...]  # in their order, from west to east or from south to north

    @property
    def width(self) -> float:
        """Return how wide it is at most where it is measured, in squares."""
        return len(self.squares) + 2 * STEP_BACK

    @property
    def step(self) -> Square:
        """Return the step (x, y) from one square to the next."""
        (x, y), (far_x, far_y) = self.squares[0], self.squares[-1]
        return (1, 0) if far_x > x else (0, 1) if far_y > y else (0, 0)


class _Walk(NamedTuple):
    """A walk against a side of a gap, or a little back from it."""

    looks: int  # how many looks there were before it
    square: Square  # the last one of the row
    side: int  # 0 or -1: the index of that square in the row
    step: Square  # towards the wall
    back: bool = False  # whether it leads back


class GapMeasurer:
    """Says how gaps are measured, and remembers what was found."""

    def __init__(self) -> None:
        """Make one that measured nothing."""
        # By the last square of a row and the side: whether the wall begins there
        self._exact: dict[tuple[Square, int], bool] = {}
        self._is_anew = False  # whether the map was begun anew since
        self._walk: _Walk | None = None  # the newest walk of these

    def gap_of(self, passage: Bottleneck | None, model: WorldModel) -> PassageRow | None:
        """Return the row of floor across a passage, view frame; None for no row of whole squares from wall to wall."""
        if passage is None:
            return None
        axis = int(np.argmax(np.abs(np.subtract(*passage.sides))))
        low, high = sorted(side[axis] for side in passage.sides)
        if round(low) != low or round(high) != high or high - low < 2:
            return None
        gaps = dict[int, PassageRow]()  # by the place of the row along the passage, as far as its walls are in line
        begins = {math.floor(side[1 - axis] + off) for side in passage.sides for off in (0.0, -1.0)}
        for begin, way in product(sorted(begins), (1, -1)):
            for across in count(begin if way == 1 else begin - 1, way):
                line = [(across, along) if axis else (along, across) for along in range(int(low) - 1, int(high) + 1)]
                if not _is_from_wall_to_wall(line, model):
                    break
                gaps[across] = PassageRow(tuple((x + model.view.west, y + model.view.south) for x, y in line[1:-1]))
        return min(gaps.values(), key=lambda gap: (True, None, False).index(self.is_exact(gap)), default=None)

    def is_exact(self, gap: PassageRow) -> bool | None:
        """Return whether a gap is as wide as its squares and at most STEP_BACK on each side; None while not known."""
        sides = [self._exact.get((gap.squares[side], side)) for side in (0, -1)]
        return False if False in sides else None if None in sides else True

    def is_at_wall(self, looks: int) -> bool:
        """Return whether the newest command, after which there were so many looks, led against a side of a gap."""
        return self._walk is not None and not self._walk.back and self._walk.looks + 1 == looks

    def step_back(self, looks: int, model: WorldModel) -> XY:
        """Return where the robot, which stands against a side of a gap, shall walk to, map frame."""
        assert self._walk is not None
        (x, y), walk = model.place, self._walk
        self._walk = walk._replace(looks=looks, back=True)
        return x - STEP_BACK * walk.step[0], y - STEP_BACK * walk.step[1]

    def end_of_walk(self, gap: PassageRow, looks: int, model: WorldModel) -> XY | None:
        """Return where the robot shall walk to from within a gap, map frame; None while it is not there."""
        # looks : how many there were.
        x, y = model.place
        west, south, east, north = map(abs, model.leeway)
        leeway, across = max(west, east), max(south, north)
        if gap.step[1]:
            leeway, across = across, leeway
        astray = abs((y if gap.step[0] else x) % 1 - 0.5) + across > OFF_MIDDLE
        if _square(model.place) not in gap.squares or astray or leeway > MAX_LEEWAY:
            return None
        side = 0 if (gap.squares[0], 0) not in self._exact else -1
        step = gap.step if side else (-gap.step[0], -gap.step[1])
        self._walk = _Walk(looks, gap.squares[side], side, step)
        column, row = gap.squares[side]
        to_line = step[0] * (column + 0.5 - x) + step[1] * (row + 0.5 - y) + 0.5
        far = to_line + STEP_BACK + leeway + PAST_DOUBT
        return x + far * step[0], y + far * step[1]

    def note(self, looks: int, model: WorldModel) -> None:
        """Note whether the newest walk, when it was one back from a wall, ended in the last square of the row."""
        if model.anew and not self._is_anew:
            self._is_anew, self._walk, self._exact = True, None, {}
        if self.is_at_wall(looks):
            return
        walk, self._walk = self._walk, None
        if walk is None:
            return
        sure = walk.back and walk.looks + 1 == looks and model.view.sure and not (model.lost or model.contradicted)
        beyond = walk.square[0] + walk.step[0], walk.square[1] + walk.step[1]
        inside = _feels_from(walk.square, model) and not _feels_from(beyond, model)
        self._exact[walk.square, walk.side] = sure and inside


def _feels_from(square: Square, model: WorldModel) -> bool:
    """Return whether the squares that are settled about a square, map frame, are felt as if the robot stood in it."""
    row, column = model.view.locate(*square)
    offset = {name: way for way, name in model.frame.directions().items()}
    return all(
        int(model.view.state[row + offset[name][1], column + offset[name][0]]) in (OPEN, OCCUPIED if felt else FREE)
        for name, felt in zip(DIRECTIONS, model.touch, strict=True)
        if name in offset
    )


def _square(place: XY) -> Square:
    """Return the square (x, y) in which a point lies."""
    return math.floor(place[0]), math.floor(place[1])


def _is_from_wall_to_wall(line: list[Square], model: WorldModel) -> bool:
    """Return whether a row of squares (column, row) of the view is settled as floor, between two squares of verge."""
    rows, columns = model.labels.shape
    if not all(0 <= x < columns and 0 <= y < rows for x, y in line):
        return False
    xs, ys = np.array(line).T
    inner: Bools = model.space[ys, xs][1:-1] & (model.view.state[ys, xs][1:-1] == FREE)
    return bool(inner.all() and model.verge[ys[[0, -1]], xs[[0, -1]]].all())
