"""How wide a passage is: the robot walks in it against one side and then against the other.

A wall lies anywhere in the squares in which it is seen. Where a walk along a row of floor ends in the last square of
it, although it was meant to lead on, the wall begins at the line behind that square: nothing else stops a robot, and no
wall is in a square that is free. So what is between two such ends is known exactly. Where the robot comes into a square
of the wall, this lies further back, and it is not known how far.
"""

from typing import NamedTuple

import numpy as np

from utak.geometry.cspace.bottleneck import Bottleneck
from utak.geometry.kernels.arrays import XY, Bools, Square
from utak.kb.world.model import WorldModel

BEYOND = 0.75  # squares behind the line at which the wall may begin, to which the robot is meant to walk; a convention
MIDDLE = 0.4  # squares from the middle of a row within which the robot walks along it; half a square is its side


class Gap(NamedTuple):
    """A row of floor from one side of a passage to the other. Squares (x, y) of the map frame."""

    squares: tuple[Square, ...]  # in their order, from west to east or from south to north

    @property
    def width(self) -> int:
        """Return how wide it is at least."""
        return len(self.squares)

    @property
    def step(self) -> Square:
        """Return the step (x, y) from one square to the next."""
        (x, y), (far_x, far_y) = self.squares[0], self.squares[-1]
        return (1, 0) if far_x > x else (0, 1) if far_y > y else (0, 0)


class GapMeasurer:
    """Says how gaps are measured, and remembers what was found."""

    def __init__(self) -> None:
        """Make one that measured nothing."""
        self._exact: dict[
            tuple[Square, int], bool
        ] = {}  # by the last square and the side: whether the wall begins there
        self._is_anew = False  # whether the map was begun anew since
        self._walk: tuple[int, Square, int] | None = None  # the look before the newest walk, the last square, the side

    def gap_of(self, passage: Bottleneck | None, model: WorldModel) -> Gap | None:
        """Return the row of floor across a passage, view frame; None for no row of whole squares from wall to wall."""
        if passage is None:
            return None
        axis = int(np.argmax(np.abs(np.subtract(*passage.sides))))
        low, high = sorted(side[axis] for side in passage.sides)
        if round(low) != low or round(high) != high or high - low < 2:
            return None
        gaps = []
        for across in dict.fromkeys(
            int(np.floor(side[1 - axis] + off)) for side in passage.sides for off in (0.0, -1.0)
        ):
            line = [(across, along) if axis else (along, across) for along in range(int(low) - 1, int(high) + 1)]
            if _is_from_wall_to_wall(line, model):
                gaps.append(Gap(tuple((x + model.view.west, y + model.view.south) for x, y in line[1:-1])))
        return next(iter(sorted(gaps, key=lambda gap: self.is_exact(gap) is not True)), None)

    def is_exact(self, gap: Gap) -> bool | None:
        """Return whether a gap is as wide as its squares; False where it is wider, None where that is not known."""
        sides = [self._exact.get((gap.squares[side], side)) for side in (0, -1)]
        return False if False in sides else None if None in sides else True

    def end_of_walk(self, gap: Gap, looks: int, model: WorldModel) -> XY | None:
        """Return where to the robot shall walk from within a gap, map frame; None while it is not there."""
        # looks : how many there were.
        here = (int(np.floor(model.place[0])), int(np.floor(model.place[1])))
        if here not in gap.squares:
            return None
        across = 1 if gap.step[0] else 0
        if abs(model.place[across] % 1 - 0.5) > MIDDLE:
            return None
        side = 0 if (gap.squares[0], 0) not in self._exact else -1
        (x, y), way = gap.squares[side], -1 if side == 0 else 1
        self._walk = looks, gap.squares[side], side
        end = x + 0.5 + way * gap.step[0] * (0.5 + BEYOND), y + 0.5 + way * gap.step[1] * (0.5 + BEYOND)
        return (end[0], model.place[1]) if gap.step[0] else (model.place[0], end[1])

    def note(self, looks: int, model: WorldModel) -> None:
        """Note whether the newest walk, when it was one of these, ended in the last square, with nothing in doubt."""
        if model.anew and not self._is_anew:
            self._is_anew, self._walk, self._exact = True, None, {}
        if self._walk is not None:
            before, square, side = self._walk
            here = int(np.floor(model.place[0])), int(np.floor(model.place[1]))
            self._exact[square, side] = before + 1 == looks and model.beyond_doubt and here == square
            self._walk = None


def _is_from_wall_to_wall(line: list[Square], model: WorldModel) -> bool:
    """Return whether a row of squares (column, row) of the view is floor between two squares of verge, beyond doubt."""
    rows, columns = model.labels.shape
    if not all(0 <= x < columns and 0 <= y < rows for x, y in line):
        return False
    xs, ys = np.array(line).T
    inner: Bools = model.space[ys, xs][1:-1] & model.certain[ys, xs][1:-1]
    return bool(inner.all() and model.verge[ys[[0, -1]], xs[[0, -1]]].all())
