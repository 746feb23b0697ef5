"""Funnel tightening: the shortest way through a word of portals.

# Strategy: the funnel of Lee and Preparata (1984). The way to the two ends of the last portal is a funnel with two
chains of corners that bend outwards from a common apex; each new end pops what the rope no longer touches. The
corners are multiples of half a square, on which cross products of floats are exact, so only free ends of the rope
round at all.
"""

from typing import NamedTuple

import numpy as np

from geometry.kernels.arrays import Floats, Ints
from geometry.kernels.jit import bare

Ends = tuple[float, float, float, float]  # x and y of the start, x and y of the goal


class Funnel(NamedTuple):
    """Room for one tightening through at most (size - 4) / 4 portals."""

    x: Floats
    """(size,) corners, in squares."""
    y: Floats
    """(size,)"""
    via: Ints
    """(size,) the corner before, on the shortest way."""
    queue: Ints
    """(2 size,) the funnel, from its left end over the apex to its right end."""


def new_rope(portals: int) -> Funnel:
    """Room for that many portals."""
    size = 4 * portals + 8
    return Funnel(
        np.empty(size),
        np.empty(size),
        np.empty(size, np.int32),
        np.empty(2 * size, np.int32),
    )


@bare
def tighten_word(
    lefts: Ints, rights: Ints, lines: Ints, body: bool, word: Ints, size: int, ends: Ends, rope: Funnel, out: Floats
) -> int:
    """Write the corners of the tight rope to ``out`` (corners, 2), both ends included; returns their number.

    A point may use whole squares; a body moves on the lines between the centres of its squares and in the meshes of
    four, so each portal counts twice: where the rope leaves the lower line of centres and where it meets the upper.
    ``lefts``, ``rights`` and ``lines`` are those of the portals (see strips.py).
    """
    xs, ys, via = rope.x, rope.y, rope.via
    xs[0], ys[0] = ends[0], ends[1]
    inset, times = (0.5, 2) if body else (0.0, 1)
    used, kept, low, high = 1, 0, 0, 0
    for k in range(size):
        symbol, after = word[k], word[k + 1] if k + 1 < size else 0
        portal, other = abs(symbol) - 1, abs(after) - 1
        west, east = lefts[portal], rights[portal]
        straight = kept != 0 and after != 0 and (symbol > 0) == (kept > 0) == (after > 0)
        if straight and west <= low and east >= high and west <= lefts[other] and east >= rights[other]:
            continue  # whatever goes straight from the portal before to the one behind goes through this one
        kept, low, high = symbol, west, east
        left, right = west + inset, east + 1.0 - inset
        y = lines[portal] + 1.0
        if symbol < 0:
            left, right = right, left
        for n in range(times):
            ys[used] = ys[used + 1] = y + inset * (2 * n - 1) * (1 if symbol > 0 else -1)
            xs[used], xs[used + 1] = left, right
            used += 2
    xs[used], ys[used] = ends[2], ends[3]
    funnel(xs, ys, via, rope.queue, used)
    return unwind(xs, ys, via, used, out)


@bare
def funnel(xs: Floats, ys: Floats, via: Ints, queue: Ints, last: int) -> None:
    """For every corner (left and right ends of portals in turn, then the goal), the one before on the way to it.

    ``queue`` holds the funnel: from ``left`` to ``apex`` the left chain, from there to ``right`` the right one.
    """
    left = apex = right = queue.shape[0] // 2
    queue[apex] = 0
    for corner in range(1, last + 1):
        x, y = xs[corner], ys[corner]
        if corner & 1:
            while left < apex and turn(xs, ys, queue[left + 1], queue[left], x, y) <= 0.0:
                left += 1
            if left == apex:
                while apex < right and turn(xs, ys, queue[apex], queue[apex + 1], x, y) < 0.0:
                    apex += 1
                left = apex
            via[corner] = queue[left]
            left -= 1
            queue[left] = corner
        else:
            while right > apex and turn(xs, ys, queue[right - 1], queue[right], x, y) >= 0.0:
                right -= 1
            if right == apex:
                while apex > left and turn(xs, ys, queue[apex], queue[apex - 1], x, y) > 0.0:
                    apex -= 1
                right = apex
            via[corner] = queue[right]
            right += 1
            queue[right] = corner


@bare
def turn(xs: Floats, ys: Floats, a: int, b: int, x: float, y: float) -> float:
    """Positive when (x, y) lies left of the ray from corner a through corner b."""
    return float((xs[b] - xs[a]) * (y - ys[a]) - (ys[b] - ys[a]) * (x - xs[a]))


@bare
def unwind(xs: Floats, ys: Floats, via: Ints, last: int, out: Floats) -> int:
    """Write the way to a corner, without corners met twice in a row; returns their number."""
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
    """The length of a polyline's first ``size`` corners."""
    total = 0.0
    for k in range(1, size):
        total += reach(line[k, 0] - line[k - 1, 0], line[k, 1] - line[k - 1, 1])
    return total


@bare
def reach(run: float, rise: float) -> float:
    """The length of a step; many times as fast as hypot, and nothing here is near overflow."""
    return float(np.sqrt(run * run + rise * rise))
