"""Funnel algorithm (string pulling): the shortest path through a word of portals.

# Strategy: the funnel of Lee and Preparata (1984). The shortest paths to the two ends of the last portal form a funnel:
two chains of corners that bend outwards from a common apex. Each new end removes the corners that its shortest path no
longer touches. The corners are multiples of half a square, on which cross products of floats are exact, so only the
free ends of the path round at all.
"""

from typing import NamedTuple

import numpy as np

from utak.geometry.kernels.arrays import Floats, Ints
from utak.geometry.kernels.jit import bare

Ends = tuple[float, float, float, float]  # x and y of the start, x and y of the goal


class Funnel(NamedTuple):
    """Scratch for one tightening through at most (size - 8) / 4 portals."""

    x: Floats  # (size,) x of the corners, in squares from the screen's south-west corner
    y: Floats  # (size,) y of the corners, likewise
    via: Ints  # (size,) the number of the corner before each, on the shortest path to it
    queue: Ints  # (2 size,) the funnel: numbers of corners, from its left end over the apex to its right end


def new_funnel(portals: int) -> Funnel:
    """Return scratch, not initialised, for words of at most `portals` signed portals."""
    size = 4 * portals + 8
    return Funnel(
        np.empty(size),
        np.empty(size),
        np.empty(size, np.int32),
        np.empty(2 * size, np.int32),
    )


@bare
def tighten_word(
    lefts: Ints, rights: Ints, lines: Ints, word: Ints, size: int, ends: Ends, buffers: Funnel, out: Floats
) -> int:
    """Write the corners of the shortest path through a word's portals to `out`, and return their number."""
    xs, ys, via = buffers.x, buffers.y, buffers.via
    xs[0], ys[0] = ends[0], ends[1]
    used, kept, low, high = 1, 0, 0, 0
    for k in range(size):
        symbol, after = word[k], word[k + 1] if k + 1 < size else 0
        portal, other = abs(symbol) - 1, abs(after) - 1
        west, east = lefts[portal], rights[portal]
        straight = kept != 0 and after != 0 and (symbol > 0) == (kept > 0) == (after > 0)
        if straight and west <= low and east >= high and west <= lefts[other] and east >= rights[other]:
            continue  # whatever goes straight from the portal before to the one behind goes through this one
        kept, low, high = symbol, west, east
        ys[used] = ys[used + 1] = lines[portal] + 1.0
        xs[used], xs[used + 1] = (west, east + 1.0) if symbol > 0 else (east + 1.0, west)
        used += 2
    xs[used], ys[used] = ends[2], ends[3]
    pull_tight(xs, ys, via, buffers.queue, used)
    return write_corners(xs, ys, via, used, out)


@bare
def pull_tight(xs: Floats, ys: Floats, via: Ints, queue: Ints, last: int) -> None:
    """Fill `via` with the number of the corner before each one on the shortest path to it."""
    left = apex = right = queue.shape[0] // 2
    queue[apex] = 0
    for corner in range(1, last + 1):
        x, y = xs[corner], ys[corner]
        if corner & 1:
            while left < apex and side_of_ray(xs, ys, queue[left + 1], queue[left], x, y) <= 0.0:
                left += 1
            if left == apex:
                while apex < right and side_of_ray(xs, ys, queue[apex], queue[apex + 1], x, y) < 0.0:
                    apex += 1
                left = apex
            via[corner] = queue[left]
            left -= 1
            queue[left] = corner
        else:
            while right > apex and side_of_ray(xs, ys, queue[right - 1], queue[right], x, y) >= 0.0:
                right -= 1
            if right == apex:
                while apex > left and side_of_ray(xs, ys, queue[apex], queue[apex - 1], x, y) > 0.0:
                    apex -= 1
                right = apex
            via[corner] = queue[right]
            right += 1
            queue[right] = corner


@bare
def side_of_ray(xs: Floats, ys: Floats, a: int, b: int, x: float, y: float) -> float:
    """Return a positive number when (x, y) lies left of the ray from corner a through corner b, negative when right."""
    return float((xs[b] - xs[a]) * (y - ys[a]) - (ys[b] - ys[a]) * (x - xs[a]))


@bare
def write_corners(xs: Floats, ys: Floats, via: Ints, last: int, out: Floats) -> int:
    """Write the path to corner `last`, without equal corners in a row, and return the number of corners."""
    size, corner = 1, last
    while corner != 0:
        corner = 0 + via[corner]
        size += 1
    corner = last
    for k in range(size - 1, -1, -1):
        out[k, 0], out[k, 1] = xs[corner], ys[corner]
        corner = 0 + via[corner]
    kept = 1
    for k in range(1, size):
        if out[k, 0] != out[kept - 1, 0] or out[k, 1] != out[kept - 1, 1]:
            out[kept, 0], out[kept, 1] = out[k, 0], out[k, 1]
            kept += 1
    return kept


@bare
def measure_line(line: Floats, size: int) -> float:
    """Return the length of a polyline's first `size` corners, in the unit of its coordinates; 0 for one corner."""
    total = 0.0
    for k in range(1, size):
        total += step_length(line[k, 0] - line[k - 1, 0], line[k, 1] - line[k - 1, 1])
    return total


@bare
def step_length(run: float, rise: float) -> float:
    """Return the Euclidean length of a step of `run` to the east and `rise` to the north, in their unit."""
    return float(np.sqrt(run * run + rise * rise))
