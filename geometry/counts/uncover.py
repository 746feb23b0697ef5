"""What fields of a look show beside something that lies on some of their squares."""

import numpy as np
from numpy.typing import NDArray

from geometry.kernels.arrays import Bools
from geometry.kernels.jit import compiled


@compiled
def uncover(
    columns: NDArray[np.int32],
    rows: NDArray[np.int32],
    weight: NDArray[np.int16],
    ranges: NDArray[np.int16],
    possible: Bools,
    sure: Bools,
    possible_x: int,
    possible_y: int,
    sure_x: int,
    sure_y: int,
) -> None:
    """Take the squares that something covers, or may cover, out of the fields of a look, in the arrays themselves.

    columns, rows, weight : (fields, most), what the fields sample, relative to the square of the look; what the thing
    may cover is not sampled any more. ranges : (fields, 2) least and greatest counts. possible, sure : (rows, columns)
    masks of the squares that it may cover, and surely does; possible_x and so on : the look's square in those masks.
    """
    for i in range(weight.shape[0]):
        for k in range(weight.shape[1]):
            if weight[i, k] == 0:
                continue
            if _holds(sure, rows[i, k] + sure_y, columns[i, k] + sure_x):
                ranges[i, 1] -= weight[i, k]
            if _holds(possible, rows[i, k] + possible_y, columns[i, k] + possible_x):
                ranges[i, 0] -= weight[i, k]
                weight[i, k] = 0


@compiled
def _holds(mask: Bools, row: int, column: int) -> bool:
    """Whether a square belongs to a mask; none beyond its edge does."""
    return 0 <= row < mask.shape[0] and 0 <= column < mask.shape[1] and bool(mask[row, column])
