"""Line of sight for a unit square: the squares to which it can slide straight, over free squares alone.

The robot moves between centres of squares and hardly knows where in its square it stands. So all squares that a whole
unit square sweeps on the way must be free.
"""

import math

import numpy as np

from utak.geometry.kernels.arrays import Bools
from utak.geometry.kernels.jit import compiled

MIN_OVERLAP = 1e-9  # squares: two squares that overlap by less only touch; bounds rounding


def straight(free: Bools, column: int, row: int, longest: int, among: Bools | None = None) -> Bools:
    """Return the squares to which one straight move of a unit square leads from a start, the start among them.

    Examples
    --------
    >>> straight(np.array([[True, True, True], [True, False, True]]), 0, 0, 9).tolist()
    [[True, True, True], [True, False, False]]
    """
    rows, columns = free.shape
    if not (0 <= row < rows and 0 <= column < columns):
        raise ValueError(f"the start ({column}, {row}) lies outside the raster")
    reached: Bools = np.zeros(free.shape, np.bool_)
    candidates = free if among is None else free & among
    _mark_reached(np.ascontiguousarray(free), np.ascontiguousarray(candidates), column, row, longest, reached)
    return reached


@compiled
def _mark_reached(free: Bools, candidates: Bools, column: int, row: int, longest: int, reached: Bools) -> None:
    """Mark the candidates that one straight move of a unit square leads to from the start (column, row)."""
    rows, columns = free.shape
    for r in range(max(row - longest, 0), min(row + longest + 1, rows)):
        for c in range(max(column - longest, 0), min(column + longest + 1, columns)):
            reached[r, c] = candidates[r, c] and _sweep_is_free(free, column, row, c - column, r - row)


@compiled
def _sweep_is_free(free: Bools, column: int, row: int, dx: int, dy: int) -> bool:
    """Return whether every square is free that a unit square sweeps from (column, row) by (dx, dy) squares."""
    for j in range(min(0, dy), max(0, dy) + 1):
        first, last = 0.0, 1.0  # the part of the way on which it meets this row
        if dy != 0:
            a, b = (j - 1) / dy, (j + 1) / dy
            first, last = max(0.0, min(a, b)), min(1.0, max(a, b))
        if last - first <= MIN_OVERLAP:
            continue
        west, east = min(first * dx, last * dx), max(first * dx, last * dx)
        low = max(math.floor(west - 1 + MIN_OVERLAP) + 1, min(0, dx))
        high = min(math.ceil(east + 1 - MIN_OVERLAP) - 1, max(0, dx))
        for i in range(low, high + 1):
            if not free[row + j, column + i]:
                return False
    return True
