"""Where a straight move leads: the squares to which a unit square can slide, over free squares alone.

Utak moves between centres of squares, and where in his square he stands he hardly knows: so all squares must be free
that a whole one sweeps on the way.
"""

import math

import numpy as np

from geometry.kernels.arrays import Bools
from geometry.kernels.jit import compiled

MEETING = 1e-9  # squares of overlap from which on two squares meet


def straight(free: Bools, column: int, row: int, longest: int, among: Bools | None = None) -> Bools:
    """(rows, columns) bool: the squares to which a straight move leads from a square, itself among them.

    Parameters
    ----------
    free : (rows, columns) bool. column, row : the start, a square of the raster; where it is not free no move leads.
    longest : rows and columns of a move, at most.
    among : (rows, columns) bool, the squares that are asked about; None for all.

    Raises ValueError when the start lies outside the raster.

    >>> straight(np.array([[True, True, True], [True, False, True]]), 0, 0, 9).tolist()
    [[True, True, True], [True, False, False]]
    """
    rows, columns = free.shape
    if not (0 <= row < rows and 0 <= column < columns):
        raise ValueError(f"the start ({column}, {row}) lies outside the raster")
    reached: Bools = np.zeros(free.shape, np.bool_)
    asked = free if among is None else free & among
    _mark(np.ascontiguousarray(free), np.ascontiguousarray(asked), column, row, longest, reached)
    return reached


@compiled
def _mark(free: Bools, asked: Bools, column: int, row: int, longest: int, reached: Bools) -> None:
    rows, columns = free.shape
    for r in range(max(row - longest, 0), min(row + longest + 1, rows)):
        for c in range(max(column - longest, 0), min(column + longest + 1, columns)):
            reached[r, c] = asked[r, c] and _open(free, column, row, c - column, r - row)


@compiled
def _open(free: Bools, column: int, row: int, dx: int, dy: int) -> bool:
    """Is every square free that a unit square sweeps on its way by (dx, dy)?"""
    for j in range(min(0, dy), max(0, dy) + 1):
        first, last = 0.0, 1.0  # the part of the way on which it meets this row
        if dy != 0:
            a, b = (j - 1) / dy, (j + 1) / dy
            first, last = max(0.0, min(a, b)), min(1.0, max(a, b))
        if last - first <= MEETING:
            continue
        west, east = min(first * dx, last * dx), max(first * dx, last * dx)
        low = max(math.floor(west - 1 + MEETING) + 1, min(0, dx))
        high = min(math.ceil(east + 1 - MEETING) - 1, max(0, dx))
        for i in range(low, high + 1):
            if not free[row + j, column + i]:
                return False
    return True
