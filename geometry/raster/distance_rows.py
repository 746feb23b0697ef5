"""The distance transform of rows near walls, by looking at every site within reach: loops that vectorise.

# Strategy: a site t squares off adds (2t - 1)^2 to a cell's squared distance, so only sites with (2t - 1)^2 below the
value found so far matter. Clearance grows by at most one square from row to row: in each stretch of columns the
maximum of the row before says how far to look. Near walls that is few steps of 16-bit arithmetic on many cells
at once, many times as fast as an envelope. Far from them the envelope of distance_transform takes over.
"""

from typing import NamedTuple

import numpy as np

from utak.geometry.kernels.arrays import Ints, SquaredDistances
from utak.geometry.kernels.jit import bare
from utak.geometry.raster.distance_transform import (
    ColumnSteps,
    Sites,
    count_steps_to_nearest,
    fill_run_distances,
    largest_value_of,
)

COLUMNS_PER_STRETCH = 128  # columns that share one reach; tuned for speed (benchmarks.screens)
MAX_SITE_STEPS = 60  # columns: how far sites are looked at one by one before the envelope takes over; tuned likewise
ROW_PADDING = MAX_SITE_STEPS + 4  # columns of walls on either side of a row of column distances; derived
MAX_COLUMN_STEPS = 67  # squares: column distances are capped here, lest 16 bits overflow; above MAX_SITE_STEPS + 1


class RowWindow(NamedTuple):
    """Scratch memory for measuring rows of a padded width, one after another from the north."""

    # (width,) int16, steps to the nearest blocked square in each column of the row last measured; 0 on blocked ones
    gap: ColumnSteps
    # (2 ROW_PADDING + width,) int16, squared distances to those, in half squares squared; it holds column j at
    # ROW_PADDING + j, and 0, as of walls, on both sides
    own: ColumnSteps
    # (width,) int16, squared distances of the row to the nearest blocked square at all, in half squares squared
    value: ColumnSteps
    # (width / COLUMNS_PER_STRETCH, rounded up) int32: for each stretch of 128 columns how many columns its values make
    # one look aside in the next row
    reach: Ints
    sites: Sites  # (width + 1,) int64, of an envelope of parabolas (see distance_transform.lower_envelope).
    heights: Sites


def new_row_window(width: int) -> RowWindow:
    """Return scratch memory for rows of a padded width (columns + 2), in the state that it has north of all rows."""
    own, reach = np.zeros(width + 2 * ROW_PADDING, np.int16), np.zeros(-(-width // COLUMNS_PER_STRETCH), np.int32)
    sites, heights = np.empty((2, width + 1), np.int64)
    return RowWindow(np.zeros(width, np.int16), own, np.empty(width, np.int16), reach, sites, heights)


@bare
def fill_distance_rows(square: SquaredDistances, steps: ColumnSteps, south: int, north: int, window: RowWindow) -> bool:
    """Fill rows of squared distances from `north` down to `south`, inclusive."""
    # Return whether their type holds them all.
    width, roof, fits = square.shape[1], largest_value_of(square), True
    gap, own, value, reach, sites, heights = window
    for row in range(north, south - 1, -1):
        out = square[row]
        add_column_distances(steps[row], gap, own[ROW_PADDING : ROW_PADDING + width])
        for k in range(reach.shape[0]):
            first, last = k * COLUMNS_PER_STRETCH, (k + 1) * COLUMNS_PER_STRETCH
            last = last if last < width else width
            if reach[k] < MAX_SITE_STEPS:
                minimise_over_sites(own[first : last + 2 * ROW_PADDING], value[first:last], reach[k] + 1)
                reach[k] = steps_needed_for(copy_row(value[first:last], out[first:last]))
        done_up_to = 0
        for k in range(reach.shape[0]):
            if reach[k] >= MAX_SITE_STEPS:
                first, last = k * COLUMNS_PER_STRETCH, (k + 1) * COLUMNS_PER_STRETCH
                last = last if last < width else width
                done_up_to = fill_by_envelope(gap, out, first, last, done_up_to, roof, sites, heights)
                largest = largest_distance(out[first:last])
                reach[k] = steps_needed_for(largest)
                fits &= largest < roof  # which no square is: they are 1 or 2 beyond a multiple of 8
    return fits


@bare
def add_column_distances(steps: ColumnSteps, gap: ColumnSteps, own: ColumnSteps) -> None:
    """Update `gap` for the next row to the south, and write the squared distances along columns to `own`."""
    count_steps_to_nearest(steps, gap)
    for j in range(gap.shape[0]):
        nearest = gap[j]
        edge = np.int16(2 * (nearest if nearest < MAX_COLUMN_STEPS else MAX_COLUMN_STEPS) - 1)
        own[j] = np.int16(edge * edge) if nearest > 0 else np.int16(0)


@bare
def minimise_over_sites(own: ColumnSteps, value: ColumnSteps, steps: int) -> None:
    """Fill `value` with the least squared distance (half squares squared) over all sites up to `steps` columns off."""
    here = own[ROW_PADDING:]
    for j in range(value.shape[0]):
        value[j] = here[j]
    for t in range(1, steps + 1, 4):
        minimise_over_four(own[ROW_PADDING - t - 3 :], own[ROW_PADDING + t :], t, value)


@bare
def minimise_over_four(west: ColumnSteps, east: ColumnSteps, t: int, value: ColumnSteps) -> None:
    """Lower `value`, in place, by the sites (nearest blocked squares of columns) t to t + 3 columns on either side."""
    a, b = np.int16((2 * t - 1) ** 2), np.int16((2 * t + 1) ** 2)
    c, d = np.int16((2 * t + 3) ** 2), np.int16((2 * t + 5) ** 2)
    for j in range(value.shape[0]):
        one = np.int16((west[j + 3] if west[j + 3] < east[j] else east[j]) + a)
        two = np.int16((west[j + 2] if west[j + 2] < east[j + 1] else east[j + 1]) + b)
        one = one if one < two else two
        two = np.int16((west[j + 1] if west[j + 1] < east[j + 2] else east[j + 2]) + c)
        one = one if one < two else two
        two = np.int16((west[j] if west[j] < east[j + 3] else east[j + 3]) + d)
        one = one if one < two else two
        value[j] = one if one < value[j] else value[j]


@bare
def copy_row(value: ColumnSteps, out: SquaredDistances) -> int:
    """Copy `value` (n,) to `out` (n,), which may be of a wider type; return the largest, 0 if none is above 0."""
    largest = np.int16(0)
    for j in range(value.shape[0]):
        out[j] = value[j]
        largest = value[j] if value[j] > largest else largest
    return int(largest)


@bare
def largest_distance(out: SquaredDistances) -> int:
    """Return the largest of some squared distances (n,), one or more, in their own unit (half squares squared)."""
    largest = 0 * out[0]
    for j in range(out.shape[0]):
        largest = out[j] if out[j] > largest else largest
    return int(largest)


@bare
def steps_needed_for(largest: int) -> int:
    """Return how many columns to either side matter to squared distances up to `largest`, in half squares squared."""
    return int(np.ceil(0.5 * np.sqrt(float(largest)) - 0.5))


@bare
def fill_by_envelope(
    gap: ColumnSteps, out: SquaredDistances, first: int, last: int, done: int, roof: int, sites: Sites, heights: Sites
) -> int:
    """Measure by envelopes the runs of free squares of one row that meet columns `first` to `last` (exclusive)."""
    column = first if first > done else done
    while column < last:
        if gap[column] == 0:
            out[column] = 0
            column += 1
            continue
        begin = column
        while gap[begin - 1] != 0:
            begin -= 1
        while gap[column] != 0:
            column += 1
        fill_run_distances(gap, out, begin, column, begin, column, roof, sites, heights)
    return column if column > done else done
