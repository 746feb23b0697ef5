"""The array types of the engine, each named once: the type of its elements, and what they stand for.

Rasters are indexed [row, column], row 0 in the south. Flat indices are row * columns + column.
"""

import numpy as np
from numpy.typing import NDArray

Bools = NDArray[np.bool_]  # masks of squares
Ints = NDArray[np.int32]  # flat indices of cells, counts, labels of parts
Longs = NDArray[np.int64]  # indices and sums that may be large
Floats = NDArray[np.float64]  # coordinates and lengths, in squares
Labels = NDArray[np.int32]  # the number of the component to which each square belongs, 0 for none
SquaredDistances = NDArray[np.int16] | NDArray[np.int32]  # to the nearest blocked square, in half squares squared

XY = tuple[float, float]  # a point (x, y), in squares
Square = tuple[int, int]  # a square, as (column, row)
