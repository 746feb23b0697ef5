"""Small changes of a screen: measure again only where a distance can have changed.

# Strategy: a changed square alters the column distances between the next blocked squares above and below it, and
through them the runs of those rows that cross its column. Those runs are measured anew, the cells about them
classified anew; the flags of all other cells stand. The ways up are then traced again from all saddles, which costs
little beside the rest.
"""

import numpy as np

from geometry.chains import Ints
from geometry.compiled import compiled
from geometry.distance import Bools, Gaps, Sites, Squares, measure_run
from geometry.skeleton import KINDS, SADDLE, SUMMIT, States, Words, classify_part

FLAGS = int.from_bytes(bytes([SADDLE | SUMMIT] * 8), "little")


def change_squares(
    gap: Gaps, square: Squares, state: States, words: Words, rows: Ints, columns: Ints, free: Bools
) -> None:
    """Change squares, measure and classify again; links are all dropped.

    Raises
    ------
    ValueError
        When no square would be left free (nothing changes then).
    """
    before = gap[rows + 1, columns + 1] > 0
    if not free.any() and np.count_nonzero(before) == np.count_nonzero(gap):
        raise ValueError("the change leaves no free square")
    stretch = np.empty((square.shape[0], 4), np.int32)
    sites = np.empty((2, square.shape[1] + 1), np.int64)
    turned = free != before
    rows, columns, free = rows[turned], columns[turned], free[turned]
    set_squares(gap, rows, columns, free)
    update_squares(gap, square, rows, columns, stretch, sites[0], sites[1])
    update_flags(square, state, words, FLAGS, stretch, np.zeros(square.shape[1], np.uint8), KINDS)


@compiled
def set_squares(gap: Gaps, rows: Ints, columns: Ints, free: Bools) -> None:
    """Block or free squares (unpadded) in ``gap``; distances are left to ``update_column``."""
    for k in range(rows.shape[0]):
        gap[rows[k] + 1, columns[k] + 1] = 1 if free[k] else 0


@compiled
def update_squares(
    gap: Gaps, square: Squares, rows: Ints, columns: Ints, stretch: Ints, sites: Sites, heights: Sites
) -> None:
    """Measure again after ``set_squares``; ``stretch`` (rows + 2, 4) gets, per row, the outermost
    columns measured and those measured last, or -1."""
    stretch[:] = -1
    for k in range(rows.shape[0]):
        update_column(gap, rows[k] + 1, columns[k] + 1)
    for k in range(rows.shape[0]):
        column = columns[k] + 1
        low = rows[k] + 1
        while low > 1 and gap[low - 1, column] > 0:
            low -= 1
        high = rows[k] + 1
        while high < gap.shape[0] - 2 and gap[high + 1, column] > 0:
            high += 1
        for row in range(low, high + 1):
            if not stretch[row, 2] < column < stretch[row, 3]:
                update_row(gap[row], square[row], column, stretch[row], sites, heights)


@compiled
def update_column(gap: Gaps, row: int, column: int) -> None:
    """Count again the steps between the blocked squares next above and below a square, itself perhaps blocked."""
    low = row - 1
    while gap[low, column] > 0:
        low -= 1
    high = row + 1
    while gap[high, column] > 0:
        high += 1
    middle = row if gap[row, column] == 0 else low
    for i in range(low + 1, high):
        if i < row and middle == row:
            gap[i, column] = min(i - low, row - i)
        elif i != row or middle != row:
            gap[i, column] = min(i - middle, high - i)


@compiled
def update_row(gap: Gaps, square: Squares, column: int, stretch: Ints, sites: Sites, heights: Sites) -> None:
    """Measure again the runs at or beside a column of one row, and note from where to where."""
    first = column - 1
    while gap[first] > 0:
        first -= 1
    last = column + 1
    while gap[last] > 0:
        last += 1
    if gap[column] == 0:
        square[column] = 0
        if column > first + 1:
            measure_run(gap, square, first + 1, column, sites, heights)
        if last > column + 1:
            measure_run(gap, square, column + 1, last, sites, heights)
    elif last > first + 1:
        measure_run(gap, square, first + 1, last, sites, heights)
    stretch[2], stretch[3] = first, last
    if stretch[0] < 0:
        stretch[0], stretch[1] = first, last
    else:
        stretch[0], stretch[1] = min(stretch[0], first), max(stretch[1], last)


@compiled
def update_flags(
    square: Squares, state: States, words: Words, flags: int, stretch: Ints, ring: States, kind: States
) -> None:
    """Drop all links and classify again the cells on and about the stretches measured."""
    for word in range(words.shape[0]):
        words[word] &= np.uint64(flags)
    rows, width = square.shape
    for row in range(1, rows - 1):
        first, last = width, -1
        for near in range(row - 1, row + 2):
            if stretch[near, 0] >= 0:
                first, last = min(first, stretch[near, 0] - 1), max(last, stretch[near, 1] + 1)
        if last >= 0:
            classify_part(square, 1, state, ring, kind, row, max(first, 1), min(last + 1, width - 1))
