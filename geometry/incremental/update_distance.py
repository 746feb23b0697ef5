"""Clearances measured anew in a part of a block: in an interval of columns for each row.

# Strategy: columns are counted in the whole block, which costs little. Along a row the sites (see
distance_transform.py) that count for an interval of cells are no further out than the site nearest to its first cell
and the one nearest to its last: of two sites on the same side of a cell, the one nearer to it is nearer to all cells on
its other side too.
"""

import numpy as np

from geometry.kernels.arrays import Bools, Ints, SquaredDistances
from geometry.kernels.jit import bare
from geometry.raster.distance_rows import largest_distance
from geometry.raster.distance_transform import (
    ColumnSteps,
    Sites,
    count_steps_south,
    count_steps_to_nearest,
    fill_run_distances,
    largest_value_of,
)

Span = tuple[int, int]
"""First and last column."""
ALL_SITES: Span = (1, 0)  # an empty interval of columns: sites are not restricted


def measure_within(
    free: Bools, bounds: Ints, low: int, west: int, square: SquaredDistances, sites: Span = ALL_SITES
) -> bool:
    """Measure squared clearances within bounds, and return whether the type of ``square`` holds them.

    Parameters
    ----------
    free : (rows, columns) bool
        Free squares of a block; everything outside counts as blocked.
    bounds : (all rows + 2, 2 or more) int32
        First and last column to be measured in each padded row of the screen; none lies outside the block. The last is
        less than the first where none is.
    low, west : int
        Padded row and column of the screen that are row 0 and column 0 of ``square``.
    square : (rows + 2, columns + 2) int16 or int32
        Filled within the bounds with squared clearances in squared half squares (capped when the type does not hold
        them), arbitrary elsewhere.
    sites : (int, int)
        First and last column of ``square`` between which walls count; ``ALL_SITES`` when all may count.
    """
    steps, width = square.view(np.int16), square.shape[1]
    count_steps_south(free, steps)
    scratch = np.empty((2, width + 1), np.int64)
    return measure_parts(steps, bounds, low, west, square, *sites, np.zeros(width, np.int16), *scratch)


@bare
def measure_parts(
    steps: ColumnSteps,
    bounds: Ints,
    low: int,
    west: int,
    square: SquaredDistances,
    first: int,
    last: int,
    gap: ColumnSteps,
    sites: Sites,
    heights: Sites,
) -> bool:
    """Measure squared clearances within bounds; return whether the type of ``square`` holds them.

    Parameters
    ----------
    steps : (rows + 2, columns + 2 or more) int16
        Steps from each cell of a block to the nearest blocked one to the south (count_steps_south); in the memory of
        ``square``, whose rows are read before they are written.
    bounds : (all rows + 2, 2 or more) int32
        First and last column to be measured in each padded row of the screen.
    low, west : int
        Padded row and column of the screen that are row 0 and column 0 of ``square``.
    square : (rows + 2, columns + 2) int16 or int32
        Filled within the bounds with squared clearances in squared half squares, capped at the greatest value of the
        type.
    first, last : int
        The columns of ``square`` between which walls count; when ``first`` is greater, all may count.
    gap : (width,) int16
        0, as it is north of the block; scratch from then on.
    sites, heights : (width + 1,) int64
        Scratch.
    """
    roof, fits, restricted = largest_value_of(square), True, first <= last
    for row in range(square.shape[0] - 2, 0, -1):
        count_steps_to_nearest(steps[row], gap)
        out, column, end = square[row], bounds[row + low, 0] - west, bounds[row + low, 1] - west + 1
        while column < end:
            if gap[column] == 0:
                out[column] = 0
                column += 1
                continue
            begin = column
            while column < end and gap[column] != 0:
                column += 1
            if not restricted:
                first, last = outermost(gap, begin, -1), outermost(gap, column - 1, 1)
            fill_run_distances(gap, out, first, last + 1, begin, column, roof, sites, heights)
            fits &= largest_distance(out[begin:column]) < roof
    return fits


@bare
def outermost(gap: ColumnSteps, column: int, step: int) -> int:
    """Return the furthest column whose site counts for a free column, or for columns on its other side.

    A site is the edge between two columns; that of a column is the one behind it, as seen in the direction of the
    search.

    Parameters
    ----------
    gap : (width,) int16, steps to the nearest blocked square in each column of the row; 0 on blocked ones.
    column : a free column, counted as in `gap`.
    step : the direction of the search: 1 to the east, -1 to the west.
    """
    found, off = column, 1
    least = 1 + site_of(gap, column, column - step)
    while off * off < least:
        here = site_of(gap, column, column + step)
        if off * off + here < least:
            least, found = off * off + here, column
        if here == 0:
            break
        column += step
        off += 2
    return found


@bare
def site_of(gap: ColumnSteps, one: int, other: int) -> int:
    """Return the squared distance along the edge between two columns to the nearest wall, in half squares squared.

    It is taken from the middle of the edge's part in the row, and 0 when a square beside that is blocked.

    Parameters
    ----------
    gap : (width,) int16, steps to the nearest blocked square in each column of the row; 0 on blocked ones.
    one, other : the two columns, in any order.
    """
    lower = gap[one] if gap[one] < gap[other] else gap[other]
    edge = 2 * np.int64(lower) - 1 if lower > 0 else np.int64(0)
    return int(edge * edge)
