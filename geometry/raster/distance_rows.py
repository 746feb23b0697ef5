"""Distances along one row where walls are near, by looking at every site within reach: loops that vectorise.

# Strategy: a site t squares off adds (2t - 1)^2 to a cell's squared distance, so only sites with (2t - 1)^2 below the
value found so far matter. Clearance grows by at most one square from row to row: in each stretch of columns the
greatest value of the row before says how far to look. Near walls that is few steps of 16-bit arithmetic on many cells
at once, many times as fast as an envelope; far from them the envelope of distance_transform.py takes over.
"""

from typing import NamedTuple

import numpy as np

from geometry.kernels.arrays import Ints, SquaredDistances
from geometry.kernels.jit import bare
from geometry.raster.distance_transform import Gaps, Sites, count_steps, measure_run, roof_of

STRETCH = 128  # columns that share one reach
FARTHEST = 60
ROOM = FARTHEST + 4  # room on either side of a row of own distances, where there are walls
TALLEST = 67  # squares; own distances beyond count as so much, lest 16 bits overflow; more than FARTHEST + 1


class RowWindow(NamedTuple):
    """Scratch of measuring rows of a padded width, from the north."""

    gap: Gaps
    """(width,) the steps to the nearest blocked square in each column of the row last measured."""
    own: Gaps
    """(2 ROOM + width) the squared distances to those, between walls."""
    value: Gaps
    """(width,)"""
    reach: Ints
    """(width / STRETCH, rounded up) how far each stretch of the row last measured made one look."""
    sites: Sites
    """(width + 1,) of an envelope."""
    heights: Sites
    """(width + 1,)"""


def new_window(width: int) -> RowWindow:
    """Scratch as it is north of all rows."""
    own, reach = np.zeros(width + 2 * ROOM, np.int16), np.zeros(-(-width // STRETCH), np.int32)
    sites, heights = np.empty((2, width + 1), np.int64)
    return RowWindow(np.zeros(width, np.int16), own, np.empty(width, np.int16), reach, sites, heights)


@bare
def measure_rows(square: SquaredDistances, steps: Gaps, south: int, north: int, window: RowWindow) -> bool:
    """Fill rows of ``square`` (rows + 2, columns + 2) from ``north`` down to ``south``, after those further north.

    ``steps`` (rows + 2, columns + 2 or more) has the steps to the nearest blocked square below; it may lie in the same
    memory, row by row. Returns False when clearances are found that the type of ``square`` does not hold.
    """
    width, roof, fits = square.shape[1], roof_of(square), True
    gap, own, value, reach, sites, heights = window
    for row in range(north, south - 1, -1):
        out = square[row]
        complete(steps[row], gap, own[ROOM : ROOM + width])
        for k in range(reach.shape[0]):
            first, last = k * STRETCH, (k + 1) * STRETCH if (k + 1) * STRETCH < width else width
            if reach[k] < FARTHEST:
                look_about(own[first : last + 2 * ROOM], value[first:last], reach[k] + 1)
                reach[k] = steps_for(publish(value[first:last], out[first:last]))
        far = 0
        for k in range(reach.shape[0]):
            if reach[k] >= FARTHEST:
                first, last = k * STRETCH, (k + 1) * STRETCH if (k + 1) * STRETCH < width else width
                far = measure_far(gap, out, first, last, far, roof, sites, heights)
                most = greatest(out[first:last])
                reach[k] = steps_for(most)
                fits &= most < roof  # which no square is: they are 1 or 2 beyond a multiple of 8
    return fits


@bare
def complete(steps: Gaps, gap: Gaps, own: Gaps) -> None:
    """From the steps down, and those of the row above in ``gap``, the steps to the nearest blocked square in the
    column, and the squared distance to it in half squares."""
    count_steps(steps, gap)
    for j in range(gap.shape[0]):
        nearest = gap[j]
        edge = np.int16(2 * (nearest if nearest < TALLEST else TALLEST) - 1)
        own[j] = np.int16(edge * edge) if nearest > 0 else np.int16(0)


@bare
def look_about(own: Gaps, value: Gaps, steps: int) -> None:
    """Fill ``value`` with the least over the sites up to so many columns off; ``own`` starts ROOM columns before."""
    here = own[ROOM:]
    for j in range(value.shape[0]):
        value[j] = here[j]
    for t in range(1, steps + 1, 4):
        four_sites(own[ROOM - t - 3 :], own[ROOM + t :], t, value)


@bare
def four_sites(west: Gaps, east: Gaps, t: int, value: Gaps) -> None:
    """Compare with the sites t to t + 3 columns off; ``west`` starts t + 3 columns before, ``east`` t behind."""
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
def publish(value: Gaps, out: SquaredDistances) -> int:
    """Copy, and return the greatest."""
    most = np.int16(0)
    for j in range(value.shape[0]):
        out[j] = value[j]
        most = value[j] if value[j] > most else most
    return int(most)


@bare
def greatest(out: SquaredDistances) -> int:
    """The greatest of some values."""
    most = 0 * out[0]
    for j in range(out.shape[0]):
        most = out[j] if out[j] > most else most
    return int(most)


@bare
def steps_for(most: int) -> int:
    """How many columns one must look to either side for values up to the given one."""
    return int(np.ceil(0.5 * np.sqrt(float(most)) - 0.5))


@bare
def measure_far(
    gap: Gaps, out: SquaredDistances, first: int, last: int, done: int, roof: int, sites: Sites, heights: Sites
) -> int:
    """Measure the runs that meet a stretch, but for columns up to ``done``; returns how far these runs go."""
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
        measure_run(gap, out, begin, column, begin, column, roof, sites, heights)
    return column if column > done else done
