"""Exact Euclidean distance transform: from each square's centre to the nearest square that is not free, in integers.

All arrays are padded by one blocked square on each side: cell ``(row + 1) * width + column + 1`` with ``width =
columns + 2``. ``square`` is the squared distance, in *half squares*, from the centre of a square to the nearest edge or
corner of a blocked square; 0 on blocked squares. A blocked square at offset (dx, dy) is ``(max(2|dx| - 1, 0))^2 +
(max(2|dy| - 1, 0))^2`` away, so ``sqrt(square) / 2`` is the clearance in squares.

# Strategy: columns first, then along each run of free squares of a row the lower envelope of parabolas (Felzenszwalb
and Huttenlocher 2012). It is computed as the lower convex hull of (site, height + site^2), which needs no division.
Between squares j and j + 1 a column's edge stands at 2j + 1 half squares. So a run has a site between any two of its
squares, with the lower of their two column distances as its height. Where walls are near, distance_rows finds the same
faster. A row's ``gap`` is the number of steps to the nearest blocked square in each column.
"""

import numpy as np
from numpy.typing import NDArray

from utak.geometry.kernels.arrays import Bools, SquaredDistances
from utak.geometry.kernels.jit import bare

ColumnSteps = NDArray[np.int16]  # numbers of steps along columns to a blocked square
Sites = NDArray[np.int64]  # sites, or heights, of an envelope of parabolas, in half squares

TILE_SIDE = 16  # squares; derived: 7 x 7 whole tiles fit every window of 129 x 129 squares


def smallest_distance_type(free: Bools) -> type[np.int16] | type[np.int32]:
    """Return the smaller integer type, np.int16 or np.int32, that holds all squared distances of a raster."""
    if min(free.shape) < 129:
        return np.int16
    rows, columns = (n // TILE_SIDE * TILE_SIDE for n in free.shape)
    open_tiles = np.ones((rows // TILE_SIDE, columns // TILE_SIDE), np.bool_)
    for first in range(4):
        for k in range(first, TILE_SIDE, 4):
            open_tiles &= free[k:rows:TILE_SIDE, k:columns:TILE_SIDE]
        if not has_open_block(open_tiles):
            return np.int16
    return np.int32


def has_open_block(tiles: Bools) -> bool:
    """Return whether some 7 x 7 neighbouring tiles are all True."""
    for n in (1, 2, 3):  # whether 2, 4, 7 to the north and east are
        tiles = tiles[n:] & tiles[:-n]
        tiles = tiles[:, n:] & tiles[:, :-n]
    return bool(tiles.any())


@bare
def count_steps_south(free: Bools, steps: ColumnSteps) -> None:
    """Fill `steps` with the steps from each square south to the nearest blocked one in its column."""
    rows, columns = free.shape
    for j in range(columns + 2):
        steps[0, j] = 0
    for row in range(rows):
        here, below, out = free[row], steps[row], steps[row + 1]
        out[0] = 0
        out[columns + 1] = 0
        for column in range(columns):
            out[column + 1] = np.int16((below[column + 1] + np.int16(1)) * here[column])


@bare
def count_steps_to_nearest(steps: ColumnSteps, gap: ColumnSteps) -> None:
    """Update `gap` from the row to the north."""
    for j in range(gap.shape[0]):
        down, up = steps[j], np.int16(gap[j] + 1)
        gap[j] = down if down < up else up


@bare
def largest_value_of(square: SquaredDistances) -> int:
    """Return the greatest value that an array's signed integer type holds: 32767 (int16) or 2147483647 (int32)."""
    return int((1 << 8 * square.itemsize - 1) - 1)


@bare
def fill_run_distances(
    gap: ColumnSteps,
    square: SquaredDistances,
    first: int,
    last: int,
    begin: int,
    end: int,
    limit: int,
    sites: Sites,
    heights: Sites,
) -> None:
    """Fill the squared distances of columns `begin` to `end` (exclusive) within a run of free squares of one row."""
    top = lower_envelope(gap, first, last, sites, heights)
    best = 0
    for column in range(begin, end):
        x = 2 * (column - first)
        value = heights[best] - 2 * x * sites[best]
        while best < top:
            other = heights[best + 1] - 2 * x * sites[best + 1]
            if other > value:
                break
            value = other
            best += 1
        own = 2 * np.int64(gap[column]) - 1
        square[column] = min(own * own, value + x * x, limit)


@bare
def lower_envelope(gap: ColumnSteps, first: int, last: int, sites: Sites, heights: Sites) -> int:
    """Write the sites of a run of free squares whose parabolas are lowest somewhere."""
    top = -1
    before = np.int64(gap[first - 1])
    for column in range(first, last + 1):
        here = np.int64(gap[column])
        lower = before if before < here else here
        edge = 2 * lower - 1 if lower > 0 else 0
        before = here
        site = 2 * (column - first) - 1
        height = edge * edge + site * site
        while top > 0 and is_hidden(sites, heights, top, site, height):
            top -= 1
        top += 1
        sites[top] = site
        heights[top] = height
    return top


@bare
def is_hidden(sites: Sites, heights: Sites, top: int, site: int, height: np.int64 | int) -> bool:
    """Return whether the site on top of an envelope is lowest nowhere once a new site is added behind it."""
    rise = (heights[top] - heights[top - 1]) * (site - sites[top])
    return bool(rise >= (height - heights[top]) * (sites[top] - sites[top - 1]))
