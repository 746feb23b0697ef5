"""From a route to straight moves between centres of squares.

Utak does not know where in his square he stands. A move from centre to centre is safe wherever that is when every
square is free that a whole square
sweeps on the way; so that is what is asked of each move. A route is first followed square by square, then its squares
are joined by the longest such moves.
"""

import math
from collections import deque
from collections.abc import Sequence
from functools import cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

Square = tuple[int, int]  # (column, row)
Point = tuple[float, float]  # (x, y)
Mask = NDArray[np.bool_]
TOUCH = 1e-9  # squares


@cache
def swept(columns: int, rows: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The squares, as (columns, rows) offsets, whose interior a unit square meets on its way by (columns, rows)."""
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


def clear(free: Mask, a: Square, b: Square) -> bool:
    """Is every square free that a unit square sweeps from a to b? free: (rows, columns)."""
    columns, rows = swept(b[0] - a[0], b[1] - a[1])
    return bool(free[rows + a[1], columns + a[0]].all())


def clear_line(free: Mask, a: Point, b: Point) -> bool:
    """Is every square free that a unit square sweeps whose middle goes straight from a to b?

    free: (rows, columns); a, b: (x, y) in the frame of the array, anywhere within squares. Outside of it nothing is.
    """
    reach = [np.arange(math.floor(min(p, q) - 0.5), math.ceil(max(p, q) + 0.5)) for p, q in zip(a, b, strict=True)]
    columns, rows = np.meshgrid(*reach, indexing="xy")
    first, last = np.zeros(columns.shape), np.ones(columns.shape)
    for square, p, q in ((columns, a[0], b[0]), (rows, a[1], b[1])):
        if abs(q - p) > TOUCH:
            ends = np.stack([(square + 0.5 - p + side) / (q - p) for side in (-1, 1)])
            first, last = np.maximum(first, ends.min(0)), np.minimum(last, ends.max(0))
        else:
            last = np.where(np.abs(square + 0.5 - p) < 1 - TOUCH, last, -1.0)
    met = first < last - TOUCH
    columns, rows = columns[met], rows[met]
    height, width = free.shape
    inside = (columns >= 0) & (columns < width) & (rows >= 0) & (rows < height)
    return bool(inside.all() and free[rows, columns].all())


def squares_along(free: Mask, points: Sequence[Sequence[float]]) -> list[Square]:
    """The shortest edge-connected path of free squares that a polyline touches, from its first point to its last.

    points: (x, y) in the frame of the array; the ends lie within free squares. Where the line runs between squares,
    on their edges or corners, those on both sides are touched. Raises ValueError when the touched free squares do
    not connect the ends.
    """
    start, goal = ((math.floor(x), math.floor(y)) for x, y in (points[0], points[-1]))
    rows, columns = free.shape
    touched = {
        (column, row)
        for a, b in pairwise(points)
        for column, row in squares_met(a, b)
        if 0 <= row < rows and 0 <= column < columns and free[row, column]
    } | {start, goal}
    before = {start: start}
    edge = deque([start])
    while edge and goal not in before:
        column, row = edge.popleft()
        for square in ((column + 1, row), (column, row + 1), (column - 1, row), (column, row - 1)):
            if square in touched and square not in before:
                before[square] = (column, row)
                edge.append(square)
    if goal not in before:
        raise ValueError(f"the line leaves the free squares between {start} and {goal}")
    path = [goal]
    while path[-1] != start:
        path.append(before[path[-1]])
    return path[::-1]


def squares_met(a: Sequence[float], b: Sequence[float]) -> set[Square]:
    """Return the squares (column, row) that a segment meets, also those whose edge or corner it only touches."""
    cuts = {0.0, 1.0}
    for p, q in zip(a, b, strict=True):
        if p != q:
            low, high = sorted((p, q))
            cuts |= {(line - p) / (q - p) for line in range(math.ceil(low), math.floor(high) + 1)}
    ordered = sorted(cuts)
    parts = ordered + [(s + t) / 2 for s, t in pairwise(ordered)]
    return {square for t in parts for square in _around(*(p + (q - p) * t for p, q in zip(a, b, strict=True)))}


def _around(x: float, y: float) -> list[Square]:
    """The square that holds a point; all those that share an edge or corner on which it lies."""
    columns, rows = ({math.floor(v - TOUCH), math.floor(v + TOUCH)} for v in (x, y))
    return [(column, row) for column in columns for row in rows]
