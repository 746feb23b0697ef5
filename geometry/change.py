"""A few squares change: what hangs on them is made anew, and the rest stands.

# Strategy: a changed square alters the column distances between the next blocked squares above and below it, and
through them the runs of those rows that cross its column. Those runs are measured anew beside the old clearances. Where
these really differ, and one cell about, the skeleton is grown again (regrowth.py) and the pathgraph joined again
(rejoining.py).
"""

import numpy as np

from geometry.bones import Bones, Ints
from geometry.compiled import compiled
from geometry.distance import Bools, Gaps, Sites, Squares, measure_run
from geometry.regrowth import regrow
from geometry.rejoining import rejoin
from geometry.skeleton import States

FREED = 1 << 30  # stands for a square that is to be free, and the negative of its clearance for one to be blocked


def change_squares(square: Squares, state: States, bones: Bones, rows: Ints, columns: Ints, free: Bools) -> Bones:
    """Change squares (unpadded rows and columns) in ``square`` and ``state``; returns the changed pathgraph.

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
    heights[cells] = np.where(free, FREED, -old)
    bounds = np.empty((square.shape[0], 4), np.int32)
    find_stretches(square, cells, bounds)
    fresh = np.empty(int((bounds[:, 1] - bounds[:, 0]).clip(0).sum()), np.int32)
    scratch = np.empty((4, width), np.int32)
    scratch[0] = -2
    measure_again(square, bounds, fresh, scratch, np.empty(width, np.int16), *np.empty((2, width + 1), np.int64))
    heights[cells] = old
    return rejoin(heights, width, bones, regrow(square, state, bounds, fresh))


@compiled
def find_stretches(square: Squares, cells: Ints, bounds: Ints) -> None:
    """Fill the first two columns of ``bounds`` with the blocked cells before and behind what is to be measured."""
    width = square.shape[1]
    for row in range(bounds.shape[0]):
        bounds[row, 0], bounds[row, 1], bounds[row, 2], bounds[row, 3] = width, -1, -1, -1
    for k in range(cells.shape[0]):
        middle, column = cells[k] // width, cells[k] % width
        low, high = middle, middle
        while square[low - 1, column] > 0:
            low -= 1
        while square[high + 1, column] > 0:
            high += 1
        for row in range(low, high + 1):
            if row != middle and bounds[row, 2] < column < bounds[row, 3]:
                continue
            first, last = column - 1, column + 1
            while square[row, first] > 0:
                first -= 1
            while square[row, last] > 0:
                last += 1
            if square[row, column] > 0:  # the run last seen in this row
                bounds[row, 2], bounds[row, 3] = first, last
            bounds[row, 0] = first if first < bounds[row, 0] else bounds[row, 0]
            bounds[row, 1] = last if last > bounds[row, 1] else bounds[row, 1]


@compiled
def measure_again(
    square: Squares, bounds: Ints, fresh: Squares, scratch: Ints, gap: Gaps, sites: Sites, heights: Sites
) -> None:
    """Write new values one after the other to ``fresh``, and narrow the bounds to those that differ.

    ``bounds`` gets, per row, the first and last column that differ and where in ``fresh`` the first stands.
    """
    seen, below, above, line = scratch[0], scratch[1], scratch[2], scratch[3]
    used = 0
    for row in range(bounds.shape[0]):
        first, last = bounds[row, 0], bounds[row, 1]
        if last < 0:
            continue
        begin = -1
        for j in range(first, last + 1):
            gap[j] = steps_at(square, row, j, seen, below, above)
            if gap[j] > 0 and begin < 0:
                begin = j
            elif gap[j] == 0:
                if begin >= 0:
                    measure_run(gap, line, begin, j, sites, heights)
                begin, line[j] = -1, 0
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
