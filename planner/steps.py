"""From a route to straight moves between centres of squares.

Utak does not know where in his square he stands. A move from centre to centre is safe wherever that is when every square is free that a whole square
sweeps on the way; so that is what is asked of each move. A route is first followed square by square, then its squares are joined by the longest
such moves.
"""

import math
from collections.abc import Sequence
from functools import cache

import numpy as np
from numpy.typing import NDArray

Square = tuple[int, int]  # (column, row)
Mask = NDArray[np.bool_]


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


def squares_along(free: Mask, points: Sequence[tuple[float, float]]) -> list[Square]:
    """The squares that a polyline through free squares enters, as an edge-connected path of free squares.

    points: (x, y) in the frame of the array. Where the line leaves a square by its corner, the free one of the two squares
    beside it is put in between. Raises ValueError when the line runs through squares that are not free.
    """
    path = [_square(points[0], points[1] if len(points) > 1 else points[0])]
    for a, b in zip(points, points[1:], strict=False):
        for square in _entered(a, b):
            _join(free, path, square)
    return path


def moves(free: Mask, path: Sequence[Square]) -> list[Square]:
    """The squares at which to halt: the fewest squares of the path that clear moves can join, greedily from its start."""
    halts, here = [path[0]], 0
    while here < len(path) - 1:
        ahead = here + 1
        for there in range(len(path) - 1, here + 1, -1):
            if clear(free, path[here], path[there]):
                ahead = there
                break
        halts.append(path[ahead])
        here = ahead
    return halts


def _square(point: tuple[float, float], towards: tuple[float, float]) -> Square:
    """The square of a point; of a point between squares, the one that lies towards another point."""
    return tuple(  # type: ignore[return-value]
        math.floor(p) - (p == math.floor(p) and t < p) for p, t in zip(point, towards, strict=True)
    )


def _entered(a: tuple[float, float], b: tuple[float, float]) -> list[Square]:
    """The squares whose interior the segment from a to b meets, in order; when it runs along a line of squares, none."""
    cuts = {0.0, 1.0}
    for p, q in zip(a, b, strict=True):
        if p != q:
            low, high = sorted((p, q))
            cuts |= {(line - p) / (q - p) for line in range(math.ceil(low), math.floor(high) + 1)}
    ordered = sorted(t for t in cuts if 0 <= t <= 1)
    squares = []
    for s, t in zip(ordered, ordered[1:], strict=False):
        if t - s < 1e-12:
            continue
        x, y = (p + (q - p) * (s + t) / 2 for p, q in zip(a, b, strict=True))
        if abs(x - round(x)) > 1e-9 and abs(y - round(y)) > 1e-9:
            squares.append((math.floor(x), math.floor(y)))
        else:
            squares.append(_beside(a, b, x, y))
    return squares


def _beside(a: tuple[float, float], b: tuple[float, float], x: float, y: float) -> Square:
    """For a segment along a grid line: marked by a square on its upper or right side; `_join` finds the free side."""
    return (round(x), math.floor(y)) if a[0] == b[0] else (math.floor(x), round(y))


def _join(free: Mask, path: list[Square], square: Square) -> None:
    """Append a square, and what is needed to reach it edge by edge over free squares."""
    last = path[-1]
    if square == last:
        return
    for candidate in (square, *_alternatives(last, square)):
        if not _is_free(free, candidate):
            continue
        if candidate == last:
            return
        step = (abs(candidate[0] - last[0]), abs(candidate[1] - last[1]))
        if step in ((1, 0), (0, 1)):
            path.append(candidate)
            return
        if step == (1, 1):
            for between in ((candidate[0], last[1]), (last[0], candidate[1])):
                if _is_free(free, between):
                    path += [between, candidate]
                    return
    raise ValueError(f"the line leaves the free squares between {last} and {square}")


def _alternatives(last: Square, square: Square) -> list[Square]:
    """Squares on the other side of the grid line along which a segment runs."""
    return [(square[0] - 1, square[1]), (square[0], square[1] - 1)]


def _is_free(free: Mask, square: Square) -> bool:
    column, row = square
    return 0 <= row < free.shape[0] and 0 <= column < free.shape[1] and bool(free[row, column])
