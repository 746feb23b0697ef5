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

    Squares that it may cover are not sampled any more; the counts are reduced by what it may, or must, contribute.

    Parameters
    ----------
    columns, rows, weight : (fields, entries), the squares that the fields sample, relative to the square of the
        observation, and how often each counts. `weight` is changed.
    ranges : (fields, 2), least and greatest counts; changed.
    possible, certain : (rows, columns) bool, the squares that the object may cover, and those that it must cover.
    possible_x, possible_y, certain_x, certain_y : column and row of the observation's square in those arrays.
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
    """Return whether a square belongs to a mask; no square beyond its edge does."""
    return 0 <= row < mask.shape[0] and 0 <= column < mask.shape[1] and bool(mask[row, column])
