"""A few squares change: what hangs on them is made anew, and the rest stands.

# Strategy: the clearances that a change can alter (affected.py) are measured anew beside the old ones, from the columns
as far to either side as a wall may count. Where they really differ, and one cell about, the skeleton is grown again
(regrowth.py) and the pathgraph joined again (rejoining.py). When much of the screen is affected, all is made anew.
"""

import numpy as np

from geometry.affected import boxes_of, find_affected
from geometry.bones import Bones, Ints, contract
from geometry.compiled import compiled
from geometry.distance import Bools, Gaps, Sites, Squares, measure_run
from geometry.regrowth import regrow
from geometry.rejoining import rejoin
from geometry.skeleton import States, Words
from geometry.sweep import survey

FREED = 1 << 30  # stands for a square that is to be free, and the negative of its clearance for one to be blocked
ALL = 0.2  # share of the cells; a change costs up to five times as much a cell as a build


def change_squares(
    square: Squares, state: States, words: Words, bones: Bones, rows: Ints, columns: Ints, free: Bools
) -> Bones:
    """Change squares (unpadded rows and columns) in ``square`` and ``state``; returns the changed pathgraph.

    ``words`` is ``state`` by eights.

    Raises
    ------
    ValueError
        When no square would be left free (nothing changes then).
    """
    heights, width = square.reshape(-1), square.shape[1]
    cells = (rows + 1) * width + columns + 1
    old = heights[cells]
    if not free.any() and len(bones.node) <= len(cells) and np.count_nonzero(old) == np.count_nonzero(heights):
        raise ValueError("the change leaves no free square")
    turned = free != (old > 0)
    if not turned.any():
        return bones
    cells, old, free = cells[turned], old[turned], free[turned]
    bounds = np.empty((square.shape[0], 4), np.int32)
    find_affected(square, boxes_of(cells, width), bounds)
    size = int((bounds[:, 1] - bounds[:, 0] + 1).clip(0).sum())
    if size > ALL * len(heights):
        grid = square[1:-1, 1:-1] > 0
        grid[cells // width - 1, cells % width - 1] = free
        survey(grid, square, state, words)
        return contract(square, state, words)
    find_stretches(square, bounds)
    heights[cells] = np.where(free, FREED, -old)
    fresh, scratch = np.empty(size, np.int32), np.empty((4, width), np.int32)
    scratch[0] = -2
    measure_again(square, bounds, fresh, scratch, np.empty(width, np.int16), *np.empty((2, width + 1), np.int64))
    heights[cells] = old
    return rejoin(heights, width, bones, regrow(square, state, bounds, fresh))


@compiled
def find_stretches(square: Squares, bounds: Ints) -> None:
    """Fill the last two columns of ``bounds``: as far as walls may count for what is to be measured in a row."""
    for row in range(bounds.shape[0]):
        first, last = bounds[row, 0] - 1, bounds[row, 1] + 1
        if last > 0:
            west, east = first - 1 - reach_of(square, row, first), last + 1 + reach_of(square, row, last)
            bounds[row, 2] = west if west > 0 else 0
            bounds[row, 3] = east if east < square.shape[1] - 1 else square.shape[1] - 1


@compiled
def reach_of(square: Squares, row: int, column: int) -> int:
    """A whole number of squares that is not below a clearance, which does not change."""
    return int(0.5 * np.sqrt(float(square[row, column])) + 1.0) if square[row, column] > 0 else -1


@compiled
def measure_again(
    square: Squares, bounds: Ints, fresh: Squares, scratch: Ints, gap: Gaps, sites: Sites, heights: Sites
) -> None:
    """Write new values one after the other to ``fresh``, and narrow the bounds to those that differ.

    ``bounds``: first and last column to be measured, and first and last that count. Its third column gets where in
    ``fresh`` the first new value stands.
    """
    seen, below, above, line = scratch[0], scratch[1], scratch[2], scratch[3]
    used = 0
    for row in range(bounds.shape[0]):
        first, last, west, east = bounds[row, 0], bounds[row, 1], bounds[row, 2], bounds[row, 3]
        if last < 0:
            continue
        begin = west + 1
        for j in range(west, east + 1):
            gap[j] = steps_at(square, row, j, seen, below, above)
            if j > west and (gap[j] == 0 or j == east):
                if begin < j:
                    measure_run(gap, line, begin, j, sites, heights)
                begin = j + 1
            if gap[j] == 0:
                line[j] = 0
        while last >= first and line[last] == square[row, last]:
            last -= 1
        while first <= last and line[first] == square[row, first]:
            first += 1
        bounds[row, 0], bounds[row, 1], bounds[row, 2] = first, last, used
        if last < first:
            bounds[row, 0], bounds[row, 1] = square.shape[1], -1
        for j in range(first, last + 1):
            fresh[used] = line[j]
            used += 1


@compiled
def steps_at(square: Squares, row: int, column: int, seen: Ints, below: Ints, above: Ints) -> int:
    """The steps to the nearest blocked square in a column, from those of the row before if it was ``seen``."""
    known = seen[column] == row - 1
    seen[column] = row
    if square[row, column] <= 0:
        below[column], above[column] = 0, 0
        return 0
    if known:
        below[column] += 1
    else:
        other = row
        while square[other, column] > 0:
            other -= 1
        below[column] = row - other
    if known and above[column] > 1:
        above[column] -= 1
    else:
        other = row
        while square[other, column] > 0:
            other += 1
        above[column] = other - row
    return int(below[column] if below[column] < above[column] else above[column])
