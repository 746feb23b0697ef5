"""A change of a few squares: what depends on them is computed anew, and the rest stays.

# Strategy: the clearances that a change can alter (affected_region.py) are measured anew (update_distance.py), with the
walls of a block around them that is so large that none beyond it counts. Where they really differ, and one cell around,
the skeleton is grown again (update_skeleton.py) and the graph joined again (update_graph.py). When they are much of the
screen, it is quicker to compute everything anew.
"""

import numpy as np

from geometry.incremental.affected_region import boxes_of, find_affected
from geometry.incremental.update_distance import measure_within
from geometry.incremental.update_graph import rejoin
from geometry.incremental.update_skeleton import regrow
from geometry.kernels.arrays import Bools, Ints, SquaredDistances
from geometry.kernels.jit import bare
from geometry.skeleton.buffers import keep_scratch, take_scratch
from geometry.skeleton.graph import SkeletonGraph
from geometry.skeleton.skeleton import States

Block = tuple[int, int, int, int]
"""First and last row, first and last column, in padded cells."""

MAX_AFFECTED_SHARE = 0.5  # of the screen's cells: when a change may alter more, all is computed anew (a convention)


def change_squares(
    square: SquaredDistances,
    state: States,
    bones: SkeletonGraph,
    rows: Ints,
    columns: Ints,
    free: Bools,
    max_affected_share: float = MAX_AFFECTED_SHARE,
) -> SkeletonGraph | None:
    """Set squares free or blocked in the clearances and the skeleton of a screen, and return the changed graph.

    Parameters
    ----------
    square : (rows + 2, columns + 2) int16 or int32
        Squared clearances in squared half squares, (2 * clearance in squares)^2; changed in place.
    state : (rows + 2, columns + 2) uint8
        Links and flags of the skeleton: of each cell bits 1, 2, 4, 8 are links to the east, north, west, south; 16 says
        that an ascent passed it, 32 saddle, 64 summit, 128 that it was chosen as the node of a ring. Changed in place.
    bones : SkeletonGraph
        The graph before the change. Its arrays may become those of the result.
    rows, columns : (n,) int32
        The squares, without the padding; none twice.
    free : (n,) bool
        True where a square becomes free, False where it becomes blocked. Squares that are so already stay as they are.
    max_affected_share : float
        The largest share of the screen's cells that the change may alter.

    Returns
    -------
    SkeletonGraph or None
        The cells of the nodes, and the ends, lowest cells and numbers of steps of the chains. Equal to that of a new
        screen; ``bones`` itself when no square changes. None when the change may alter more of the screen, or
        ``square`` is of a type too small for it. Nothing is changed then, and all has to be computed anew.

    Raises
    ------
    ValueError
        When no square would be left free. Nothing is changed then.
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
    bounds = np.empty((square.shape[0], 3), np.int32)
    find_affected(square, boxes_of(cells, square.shape), bounds)
    if np.maximum(bounds[:, 1] - bounds[:, 0] + 1, 0).sum() > max_affected_share * len(heights):
        return None
    low, high, west, _ = block = block_about(square, bounds)
    fresh = clearances_in(square, block, bounds, cells, free)
    if fresh is None:
        return None
    narrow(square, fresh, low - 1, west - 1, bounds)
    scratch = take_scratch(len(heights))
    journal = regrow(square, state, bounds, fresh.reshape(-1), scratch)
    joined = rejoin(heights, width, bones, journal)
    scratch.mark[low * width : (high + 1) * width] = 0
    scratch.mark[journal.touched[: journal.size[0]]] = 0
    keep_scratch(scratch)
    return joined


def clearances_in(
    square: SquaredDistances, block: Block, bounds: Ints, cells: Ints, free: Bools
) -> SquaredDistances | None:
    """Return squared clearances of a block and one cell around it after a change, or None if their type is too small.

    They are right within the bounds and arbitrary elsewhere.

    Parameters
    ----------
    square : (rows + 2, columns + 2) int16 or int32
        Squared clearances in squared half squares before the change.
    block : (int, int, int, int)
        First and last row, first and last column, padded, included.
    bounds : (rows + 2, 2 or more) int32
        First and last column of each row whose clearance may change, padded; the last is less than the first for none.
    cells : (n,) int32
        Flat indices of the cells that change.
    free : (n,) bool
        Which of them become free; the others become blocked.

    Returns
    -------
    (block rows + 2, block columns + 2) array of the type of ``square``, or None
        Half squares squared; row 0 and column 0 are those before the first of the block.
    """
    (low, high, west, east), width = block, square.shape[1]
    rows, columns = cells // width - low, cells % width - west
    fresh = np.empty((high - low + 3, east - west + 3), square.dtype)
    if free.any():
        floor = square[low : high + 1, west : east + 1] > 0
        floor[rows, columns] = free
        return fresh if measure_within(floor, bounds, low - 1, west - 1, fresh) else None
    floor = np.ones((high - low + 1, east - west + 1), np.bool_)  # of walls only the new ones can count
    floor[rows, columns] = False
    measure_within(floor, bounds, low - 1, west - 1, fresh, (int(columns.min()) + 1, int(columns.max()) + 1))
    keep_lower(square, fresh, low - 1, west - 1, bounds)
    return fresh


@bare
def block_about(square: SquaredDistances, bounds: Ints) -> Block:
    """Return a block whose walls suffice to measure the cells within the bounds.

    It is the first and last row and the first and last column, included, padded. Next to the bounds clearances stay as
    they were. None between exceeds theirs by more than its distance from them.

    Parameters
    ----------
    square : (rows + 2, columns + 2) squared clearances in squared half squares before the change.
    bounds : (rows + 2, 2 or more) first and last column of each row whose clearance may change; last -1 for none, but
        some row must have one.
    """
    low, high, west, east = bounds.shape[0], -1, square.shape[1], -1
    for row in range(bounds.shape[0]):
        first, last = bounds[row, 0] - 1, bounds[row, 1] + 1
        if last > 0:
            before, behind = reach_of(square, row, first), reach_of(square, row, last)
            most = (before + behind + last - first) // 2 + 1
            low, high = row - most if row - most < low else low, row + most if row + most > high else high
            west = first - before if first - before < west else west
            east = last + behind if last + behind > east else east
    rows, columns = square.shape
    low, high = low if low > 0 else 0, high if high < rows - 1 else rows - 1
    return low, high, west if west > 0 else 0, east if east < columns - 1 else columns - 1


@bare
def reach_of(square: SquaredDistances, row: int, column: int) -> int:
    """Return a whole number of squares greater than a cell's clearance.

    `square` : (rows + 2, columns + 2) squared clearances in squared half squares; `row` and `column` are padded.
    """
    return int(0.5 * np.sqrt(float(square[row, column])) + 2.0)


@bare
def keep_lower(square: SquaredDistances, fresh: SquaredDistances, low: int, west: int, bounds: Ints) -> None:
    """Lower ``fresh``, in place, to the old clearances where these are less, within the bounds.

    Parameters
    ----------
    square : (rows + 2, columns + 2) squared clearances in squared half squares before the change.
    fresh : squared clearances of a part of the screen; its row 0 and column 0 are row ``low`` and column ``west``,
        padded.
    bounds : (rows + 2, 2 or more) first and last column of each padded row; last -1 for none.
    """
    for row in range(bounds.shape[0]):
        first, size = bounds[row, 0], bounds[row, 1] - bounds[row, 0] + 1
        if size > 0:
            old, new = square[row, first : first + size], fresh[row - low, first - west : first - west + size]
            for k in range(size):
                new[k] = old[k] if old[k] < new[k] else new[k]


@bare
def narrow(square: SquaredDistances, fresh: SquaredDistances, low: int, west: int, bounds: Ints) -> None:
    """Narrow the bounds, in place, to the cells that differ, and fill their third column.

    That is the flat index in ``fresh`` of the first such cell of a row. Flat indices are row * width + column in the
    screen padded by one blocked cell on each side.

    Parameters
    ----------
    square : (rows + 2, columns + 2) squared clearances in squared half squares before the change.
    fresh : those after it, of a part of the screen; its row 0 and column 0 are row ``low`` and column ``west``, padded.
    bounds : (rows + 2, 3) int32, first and last column of each padded row. Where no cell differs they become the width
        of the padded screen and -1.
    """
    width = fresh.shape[1]
    for row in range(bounds.shape[0]):
        first, last = bounds[row, 0], bounds[row, 1]
        while last >= first and fresh[row - low, last - west] == square[row, last]:
            last -= 1
        while first <= last and fresh[row - low, first - west] == square[row, first]:
            first += 1
        bounds[row, 0], bounds[row, 1], bounds[row, 2] = first, last, (row - low) * width + first - west
        if last < first:
            bounds[row, 0], bounds[row, 1] = square.shape[1], -1
