"""Clearances measured anew in part of a block: only in some columns of each row.

# Strategy: columns are counted in the whole block, which costs little. Along a row the sites that count for some of its
cells are no further out than that which is nearest to the first of them and that which is nearest to the last: of two
sites on the same side of a cell the one that is nearer to it stays so for all cells on the other side.
"""

import numpy as np

from geometry.kernels.arrays import Bools, Ints, SquaredDistances
from geometry.kernels.jit import bare
from geometry.raster.distance_rows import greatest
from geometry.raster.distance_transform import Gaps, Sites, count_columns, count_steps, measure_run, roof_of

Span = tuple[int, int]
EVERYWHERE: Span = (1, 0)


def measure_within(
    free: Bools, bounds: Ints, low: int, west: int, square: SquaredDistances, sites: Span = EVERYWHERE
) -> bool:
    """Fill ``square`` (rows + 2, columns + 2) within the bounds; returns whether its type holds it.

    free : (rows, columns) of a block, outside of which everything counts as blocked.
    bounds : (all rows, 2 or more) first and last column per row; none lie outside the block. Row 0 and column 0 of
    ``square`` are row ``low`` and column ``west`` of these.
    sites : first and last of the columns of ``square`` outside of which walls need not count.
    """
    steps, width = square.view(np.int16), square.shape[1]
    count_columns(free, steps)
    scratch = np.empty((2, width + 1), np.int64)
    return measure_parts(steps, bounds, low, west, square, *sites, np.zeros(width, np.int16), *scratch)


@bare
def measure_parts(
    steps: Gaps,
    bounds: Ints,
    low: int,
    west: int,
    square: SquaredDistances,
    first: int,
    last: int,
    gap: Gaps,
    sites: Sites,
    heights: Sites,
) -> bool:
    """As ``measure_within``, from the steps to the nearest blocked square below; ``gap`` is 0 as it is north of all."""
    roof, fits, told = roof_of(square), True, first <= last
    for row in range(square.shape[0] - 2, 0, -1):
        count_steps(steps[row], gap)
        out, column, end = square[row], bounds[row + low, 0] - west, bounds[row + low, 1] - west + 1
        while column < end:
            if gap[column] == 0:
                out[column] = 0
                column += 1
                continue
            begin = column
            while column < end and gap[column] != 0:
                column += 1
            if not told:
                first, last = outermost(gap, begin, -1), outermost(gap, column - 1, 1)
            measure_run(gap, out, first, last + 1, begin, column, roof, sites, heights)
            fits &= greatest(out[begin:column]) < roof
    return fits


@bare
def outermost(gap: Gaps, column: int, step: int) -> int:
    """The furthest column in a direction, the edge behind which may count for a free column or those before it."""
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
def site_of(gap: Gaps, one: int, other: int) -> int:
    """The squared distance, in half squares, from the edge between two columns to the nearest wall beside it."""
    lower = gap[one] if gap[one] < gap[other] else gap[other]
    edge = 2 * np.int64(lower) - 1 if lower > 0 else np.int64(0)
    return int(edge * edge)
