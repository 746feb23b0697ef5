"""The surroundings of a square: how many squares around it are marked, by groups, and what some of them hold."""

import numpy as np
import numpy.typing as npt

from utak.geometry.kernels.arrays import Longs
from utak.geometry.kernels.jit import bare

Codes = npt.NDArray[np.uint8]  # small numbers, one a square


@bare
def survey_square(
    raster: Codes, column: int, row: int, members: Longs, others: Longs, outside: int, counts: Codes, values: Codes
) -> None:
    """Count the marked squares around one square, group by group, and read some squares."""
    rows, columns = raster.shape
    counts[:] = 0
    for n in range(len(members)):
        i, j = column + members[n, 0], row + members[n, 1]
        value = outside if i < 0 or i >= columns or j < 0 or j >= rows else raster[j, i]
        if value != 0:
            counts[members[n, 2]] += 1
    for n in range(len(others)):
        i, j = column + others[n, 0], row + others[n, 1]
        values[n] = outside if i < 0 or i >= columns or j < 0 or j >= rows else raster[j, i]
