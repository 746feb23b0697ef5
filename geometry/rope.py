"""Rope tightening: the shortest way through a word of portals.

# Strategy: the funnel of Lee and Preparata (1984). The way to the two ends of the last portal is a funnel with two
chains of corners that bend outwards from a common apex; each new end pops what the rope no longer touches. The
corners are multiples of half a square, on which cross products of floats are exact, so only free ends of the rope
round at all.
"""

from typing import NamedTuple

import numpy as np

from geometry.chains import Floats, Ints
from geometry.compiled import compiled
from geometry.runs import Runs


class Rope(NamedTuple):
    """Room for one tightening through at most (size - 4) / 4 portals."""

    x: Floats
    """(size,) corners, in squares."""
    y: Floats
    """(size,)"""
    via: Ints
    """(size,) the corner before, on the shortest way."""
    queue: Ints
    """(2 size,) the funnel, from its left end over the apex to its right end."""
    ends: Ints
    """(3,) positions in ``queue`` of left end, apex and right end."""


def new_rope(portals: int) -> Rope:
    """Room for that many portals."""
    size = 4 * portals + 8
    return Rope(
        np.empty(size),
        np.empty(size),
        np.empty(size, np.int32),
        np.empty(2 * size, np.int32),
        np.empty(3, np.int64),
    )


@compiled
def tighten_word(
    runs: Runs, body: bool, word: Ints, size: int, ends: tuple[float, float, float, float], rope: Rope, out: Floats
) -> int:
    """Write the corners of the tight rope to ``out`` (corners, 2), both ends included; returns their number.

    A point may use whole squares; a body moves on the lines between the centres of its squares and in the meshes of
    four, so each portal counts twice: where the rope leaves the lower line of centres and where it meets the upper.
    """
    rope.x[0], rope.y[0] = ends[0], ends[1]
    middle = rope.queue.shape[0] // 2
    rope.queue[middle] = 0
    rope.ends[:] = middle
    used = 1
    for k in range(size):
        portal = abs(word[k]) - 1
        row = runs.line[portal]
        left, right = float(runs.left[portal]), float(runs.right[portal])
        up = word[k] > 0
        if not body:
            used = pull(rope, used, left, right + 1.0, row + 1.0, up)
        else:
            used = pull(rope, used, left + 0.5, right + 0.5, row + 0.5 if up else row + 1.5, up)
            used = pull(rope, used, left + 0.5, right + 0.5, row + 1.5 if up else row + 0.5, up)
    rope.x[used], rope.y[used] = ends[2], ends[3]
    add_left(rope, used)
    return unwind(rope, used, out)


@compiled
def pull(rope: Rope, used: int, low: float, high: float, y: float, up: bool) -> int:
    """Take both ends of a portal into the funnel."""
    rope.x[used] = low if up else high
    rope.x[used + 1] = high if up else low
    rope.y[used] = y
    rope.y[used + 1] = y
    add_left(rope, used)
    add_right(rope, used + 1)
    return used + 2


@compiled
def add_left(rope: Rope, corner: int) -> None:
    """Take a corner into the left end of the funnel."""
    queue, ends = rope.queue, rope.ends
    left, apex, right = ends[0], ends[1], ends[2]
    while left < apex and side(rope, queue[left + 1], queue[left], corner) <= 0.0:
        left += 1
    if left == apex:
        while apex < right and side(rope, queue[apex], queue[apex + 1], corner) < 0.0:
            apex += 1
        left = apex
    rope.via[corner] = queue[left]
    queue[left - 1] = corner
    ends[0], ends[1] = left - 1, apex


@compiled
def add_right(rope: Rope, corner: int) -> None:
    """Take a corner into the right end of the funnel."""
    queue, ends = rope.queue, rope.ends
    left, apex, right = ends[0], ends[1], ends[2]
    while right > apex and side(rope, queue[right - 1], queue[right], corner) >= 0.0:
        right -= 1
    if right == apex:
        while apex > left and side(rope, queue[apex], queue[apex - 1], corner) > 0.0:
            apex -= 1
        right = apex
    rope.via[corner] = queue[right]
    queue[right + 1] = corner
    ends[1], ends[2] = apex, right + 1


@compiled
def side(rope: Rope, a: int, b: int, c: int) -> float:
    """Positive when c lies left of the ray from a through b."""
    ax, ay = rope.x[a], rope.y[a]
    return float((rope.x[b] - ax) * (rope.y[c] - ay) - (rope.y[b] - ay) * (rope.x[c] - ax))


@compiled
def unwind(rope: Rope, last: int, out: Floats) -> int:
    """Write the way to a corner, without corners met twice in a row; returns their number."""
    size, corner = 1, last
    while corner != 0:
        corner = rope.via[corner]
        size += 1
    corner = last
    for k in range(size - 1, -1, -1):
        out[k, 0], out[k, 1] = rope.x[corner], rope.y[corner]
        corner = rope.via[corner]
    kept = 1
    for k in range(1, size):
        if out[k, 0] != out[kept - 1, 0] or out[k, 1] != out[kept - 1, 1]:
            out[kept, 0], out[kept, 1] = out[k, 0], out[k, 1]
            kept += 1
    return kept


@compiled
def measure_line(line: Floats, size: int) -> float:
    """The length of a polyline's first ``size`` corners."""
    total = 0.0
    for k in range(1, size):
        total += reach(line[k, 0] - line[k - 1, 0], line[k, 1] - line[k - 1, 1])
    return total


@compiled
def reach(run: float, rise: float) -> float:
    """The length of a step; many times as fast as hypot, and nothing here is near overflow."""
    return float(np.sqrt(run * run + rise * rise))
