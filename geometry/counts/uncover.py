"""Fields of an observation without the squares that an object covers."""

import numpy as np
from numpy.typing import NDArray

from utak.geometry.kernels.arrays import Bools
from utak.geometry.kernels.jit import compiled


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
    """Remove the squares that an object covers, or may cover, from the fields of an observation, in place."""
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
