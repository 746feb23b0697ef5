"""Passages that fill no whole square: they look like wall, and are found by walking against it.

All floor is connected. So where floor is seen beyond walls, and no wall is left that may be a thing, one of them has an
opening. A straight walk on the right line leads through it.
"""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from utak.geometry.kernels.arrays import XY, Bools
from utak.kb.task.stretches import MAX_THICK_WALL
from utak.planner.screen.moves import EDGE_OFFSET
from utak.planner.screen.projection import CostMaps
from utak.planner.sights.walls import EDGE_STEPS, floor_apart

LINES = (0.0, -EDGE_OFFSET, EDGE_OFFSET)  # squares from the middle of a row: at most EDGE_OFFSET apart, rows together
SAME_LINE = 1.0 - 2 * EDGE_OFFSET  # squares between the last line of a row and the first one of the next

WallLine = tuple[
    int, float
]  # the number of the direction in EDGE_STEPS, and the place across it, in squares, map frame


class WalkThroughWall(NamedTuple):
    """A straight walk from floor that is reached through wall to floor that is not; points (x, y) of the map frame."""

    line: WallLine
    square: int
    start: XY
    end: XY

    @property
    def is_middle(self) -> bool:
        """Whether it leads along the middle of a row: such walks find every opening of a square."""
        return abs(self.line[1] % 1 - 0.5) < SAME_LINE


def passages(cost_maps: CostMaps, things: bool = True) -> Iterator[WalkThroughWall]:
    """Yield the walks that lead through at most MAX_THICK_WALL squares of wall, by direction and row."""
    reached, view = cost_maps.floor, cost_maps.model.view
    apart = floor_apart(cost_maps.model, reached, things)
    for number, (dx, dy) in enumerate(EDGE_STEPS):
        for row, column in np.argwhere(reached).tolist() if apart.any() else ():
            depth = _depth(row, column, (dx, dy), reached, apart)
            for line in LINES if depth else ():
                x, y = view.west + column + 0.5 + abs(dy) * line, view.south + row + 0.5 + abs(dx) * line
                end = x + dx * (depth + 1), y + dy * (depth + 1)
                yield WalkThroughWall((number, y if dx else x), row * reached.shape[1] + column, (x, y), end)


def _depth(row: int, column: int, step: Sequence[int], reached: Bools, apart: Bools) -> int:
    """Return how many squares of wall lie between a square and floor apart in a direction; 0 for none, or too many."""
    for depth in range(MAX_THICK_WALL + 1):
        column, row = column + step[0], row + step[1]
        if not (0 <= row < apart.shape[0] and 0 <= column < apart.shape[1]) or reached[row, column]:
            return 0
        if apart[row, column]:
            return depth
    return 0
