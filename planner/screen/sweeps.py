"""The squares that a unit square sweeps on straight lines, and edge-connected paths along polylines.

The robot does not know where in its square it stands. A move between the centres of two squares is safe for every
position within the square if all squares are free that a whole unit square sweeps. So this is what is asked of a move.
A route becomes a path of edge-connected squares first. Then the longest safe moves join squares of that path.
"""

import math
from collections import deque
from collections.abc import Callable, Sequence
from functools import cache
from itertools import pairwise

import numpy as np

from utak.geometry.kernels.arrays import XY, Bools, Longs
from utak.geometry.kernels.arrays import Square as Square

SWEEP_TOLERANCE = 1e-9  # squares; smaller overlaps are rounding errors of floating point (convention)


@cache
def swept_offsets(columns: int, rows: int) -> tuple[Longs, Longs]:
    """Compute the squares that a unit square sweeps when it moves by (`columns`, `rows`) of either sign."""
    c, r = np.meshgrid(
        np.arange(min(0, columns), max(0, columns) + 1), np.arange(min(0, rows), max(0, rows) + 1), indexing="xy"
    )
    first, last = np.zeros(c.shape), np.ones(c.shape)
    for offset, whole in ((c, columns), (r, rows)):
        if whole:
            ends = np.stack([(offset - 1) / whole, (offset + 1) / whole])
            first, last = np.maximum(first, ends.min(0)), np.minimum(last, ends.max(0))
    met = first < last - 1e-12
    return c[met], r[met]


def sweep_is_free(free: Bools, a: Square, b: Square) -> bool:
    """Return whether a unit square that moves between two squares (column, row) sweeps free squares only."""
    columns, rows = swept_offsets(b[0] - a[0], b[1] - a[1])
    return bool(free[rows + a[1], columns + a[0]].all())


def line_sweep_is_free(free: Bools, a: XY, b: XY) -> bool:
    """Return whether a unit square sweeps free squares only while its centre moves from point `a` to point `b`."""
    reach = [np.arange(math.floor(min(p, q) - 0.5), math.ceil(max(p, q) + 0.5)) for p, q in zip(a, b, strict=True)]
    columns, rows = np.meshgrid(*reach, indexing="xy")
    first, last = np.zeros(columns.shape), np.ones(columns.shape)
    for square, p, q in ((columns, a[0], b[0]), (rows, a[1], b[1])):
        if abs(q - p) > SWEEP_TOLERANCE:
            ends = np.stack([(square + 0.5 - p + side) / (q - p) for side in (-1, 1)])
            first, last = np.maximum(first, ends.min(0)), np.minimum(last, ends.max(0))
        else:
            last = np.where(np.abs(square + 0.5 - p) < 1 - SWEEP_TOLERANCE, last, -1.0)
    met = first < last - SWEEP_TOLERANCE
    columns, rows = columns[met], rows[met]
    height, width = free.shape
    inside = (columns >= 0) & (columns < width) & (rows >= 0) & (rows < height)
    return bool(inside.all() and free[rows, columns].all())


def squares_along(free: Bools, points: Sequence[Sequence[float]]) -> list[Square]:
    """Find the shortest edge-connected path of free squares among those that a polyline touches."""
    start, goal = ((math.floor(x), math.floor(y)) for x, y in (points[0], points[-1]))
    rows, columns = free.shape
    touched = {
        (column, row)
        for a, b in pairwise(points)
        for column, row in squares_met(a, b)
        if 0 <= row < rows and 0 <= column < columns and free[row, column]
    } | {start, goal}
    return shortest_squares(touched.__contains__, start, goal.__eq__)


def shortest_squares(
    is_free: Callable[[Square], bool], start: Square, is_end: Callable[[Square], bool]
) -> list[Square]:
    """Search the shortest edge-connected path of free squares from a start to an end, both included, breadth first."""
    before, queue, here = {start: start}, deque[Square](), start
    while not is_end(here):
        column, row = here
        for square in ((column + 1, row), (column, row + 1), (column - 1, row), (column, row - 1)):
            if square not in before and is_free(square):
                before[square] = here
                queue.append(square)
        if not queue:
            raise ValueError(f"no free squares lead from {start} to an end")
        here = queue.popleft()
    path = [here]
    while path[-1] != start:
        path.append(before[path[-1]])
    return path[::-1]


def squares_met(a: Sequence[float], b: Sequence[float]) -> set[Square]:
    """Compute the squares (column, row) that the segment from `a` to `b` meets, even at an edge or corner only."""
    cuts = {0.0, 1.0}
    for p, q in zip(a, b, strict=True):
        if p != q:
            low, high = sorted((p, q))
            cuts |= {(line - p) / (q - p) for line in range(math.ceil(low), math.floor(high) + 1)}
    ordered = sorted(cuts)
    parts = ordered + [(s + t) / 2 for s, t in pairwise(ordered)]
    return {square for t in parts for square in _touched_by(*(p + (q - p) * t for p, q in zip(a, b, strict=True)))}


def _touched_by(x: float, y: float) -> list[Square]:
    """List the square (column, row) that holds a point (x, y), or all on whose shared edge or corner it lies."""
    columns, rows = ({math.floor(v - SWEEP_TOLERANCE), math.floor(v + SWEEP_TOLERANCE)} for v in (x, y))
    return [(column, row) for column in columns for row in rows]
