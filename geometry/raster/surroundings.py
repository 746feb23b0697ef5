"""The surroundings of a square: how many squares around it are marked, by groups, and what some of them hold."""

import numpy as np
import numpy.typing as npt

from geometry.kernels.arrays import Longs
from geometry.kernels.jit import bare

Codes = npt.NDArray[np.uint8]  # small numbers, one a square


@bare
def survey_square(
    raster: Codes, column: int, row: int, members: Longs, others: Longs, outside: int, counts: Codes, values: Codes
) -> None:
    """Count the marked squares around one square, group by group, and read some squares.

    A square is marked when its number is not 0. Squares off the raster hold `outside`.

    Parameters
    ----------
    raster : (rows, columns) uint8, row 0 in the south.
    column, row : the square; it may lie off the raster.
    members : (n, 3) int64: offsets to the east and to the north in squares, and the number of the group to which that
        square belongs, from 0.
    others : (m, 2) int64: offsets to the east and to the north of the squares that are read.
    outside : from 0 to 255.
    counts : uint8, one a group; output. A group has at most 255 squares.
    values : (m,) uint8; output: the numbers of the squares that are read.
    """
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
