"""Fields of an observation without the squares that an object covers."""

import numpy as np
from numpy.typing import NDArray

from geometry.kernels.arrays import Bools
from geometry.kernels.jit import compiled


@compiled
def remove_covered_squares(
    columns: NDArray[np.int32],
    rows: NDArray[np.int32],
    weight: NDArray[np.int16],
    ranges: NDArray[np.int16],
    possible: Bools,
    certain: Bools,
    possible_x: int,
    possible_y: int,
    certain_x: int,
    certain_y: int,
) -> None:
    """Remove the squares that an object covers, or may cover, from the fields of an observation, in place.

    A field is a set of squares that the robot sees as one, with a least and a greatest count of occupied ones. Squares
    that the object may cover are not sampled any more; the counts are reduced by what it may, or must, contribute. They
    may fall below 0.

    Parameters
    ----------
    columns, rows, weight : (fields, entries), the squares that the fields sample, in columns and rows east and north of
        the square of the observation, and how often each counts, 0 for padding. `weight` is changed: 0 at squares that
        the object may cover.
    ranges : (fields, 2), least and greatest counts, by weight; changed.
    possible, certain : (rows, columns) bool, row 0 in the south, the squares that the object may cover, and those that
        it must cover; each an array of its own place and size, beyond whose edge nothing is covered.
    possible_x, possible_y, certain_x, certain_y : column and row of the observation's square in those arrays; may lie
        outside.
    """
    for i in range(weight.shape[0]):
        for k in range(weight.shape[1]):
            if weight[i, k] == 0:
                continue
            if _is_set(certain, rows[i, k] + certain_y, columns[i, k] + certain_x):
                ranges[i, 1] -= weight[i, k]
            if _is_set(possible, rows[i, k] + possible_y, columns[i, k] + possible_x):
                ranges[i, 0] -= weight[i, k]
                weight[i, k] = 0


@compiled
def _is_set(mask: Bools, row: int, column: int) -> bool:
    """Return whether a square, given by row and column of the mask, belongs to it; no square beyond its edge does."""
    return 0 <= row < mask.shape[0] and 0 <= column < mask.shape[1] and bool(mask[row, column])
