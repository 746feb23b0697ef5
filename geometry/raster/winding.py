"""Shortest paths over a raster with a given crossing number: how often, with sign, they cross a ray from a point.

# Strategy: the raster is taken in several sheets, one for each crossing number so far. A step over the ray leads to the
# next sheet up or down. This is a piece of the universal cover of the plane without the point, and Dijkstra's algorithm
# runs on it as on any raster.
"""

import numpy as np
from numpy.typing import NDArray

from utak.geometry.kernels.arrays import Square
from utak.geometry.kernels.bucket_queue import new_queue
from utak.geometry.raster.geodesic import GEODESIC_UNREACHED, search_sheets

MAX_CROSSING_NUMBER = 2  # largest magnitude of a crossing number: one sheet for each number; a convention


def crossing_number(points: NDArray[np.float64], about: tuple[float, float]) -> int:
    """Return how often a polyline crosses the ray from a point towards +x: upwards (to +y) counts +1, downwards -1.

    Examples
    --------
    >>> crossing_number(np.array([[1, -1], [1, 1], [-1, 1], [-1, -1], [1, -1]]), (0.0, 0.0))
    1
    """
    return int(crossings_by_step(points, np.array([about], float)).sum())


def crossings_by_step(points: NDArray[np.float64], about: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return the crossing number of each of the n - 1 steps of a polyline about each of m points, (m, n - 1)."""
    x, y = np.asarray(points, float).T[:, None, :] - about.T[:, :, None]
    above = y >= 0
    rise = above[:, 1:].astype(int) - above[:, :-1].astype(int)
    change = np.where(rise != 0, y[:, 1:] - y[:, :-1], 1.0)
    where = x[:, :-1] - y[:, :-1] * (x[:, 1:] - x[:, :-1]) / change
    return np.where(where > 0, rise, 0)


def shortest_path_with_crossing_number(
    free: NDArray[np.bool_], start: Square, goal: Square, about: tuple[float, float], number: int
) -> list[Square] | None:
    """Return the shortest path over free squares (eight neighbours, no corners cut) with a given crossing number.

    Examples
    --------
    >>> free = np.ones((3, 3), bool); free[1, 1] = False
    >>> len(shortest_path_with_crossing_number(free, (0, 0), (0, 0), (1.5, 1.5), 1))
    9
    """
    if abs(number) > MAX_CROSSING_NUMBER:
        raise ValueError(f"crossing numbers go from -{MAX_CROSSING_NUMBER} to {MAX_CROSSING_NUMBER}, not {number}")
    rows, columns = free.shape
    for column, row in (start, goal):
        if not (0 <= row < rows and 0 <= column < columns and free[row, column]):
            raise ValueError(f"({column}, {row}) is not a free square")
    parent = np.full((2 * MAX_CROSSING_NUMBER + 1) * rows * columns, -1, np.int64)
    ray = np.arange(columns) + 0.5 > about[0]
    first = int(np.ceil(about[1] - 0.5))  # the lowest row whose centres count as above the ray
    origin = (MAX_CROSSING_NUMBER * rows + start[1]) * columns + start[0]
    end = ((MAX_CROSSING_NUMBER + number) * rows + goal[1]) * columns + goal[0]
    distance = np.full(len(parent), GEODESIC_UNREACHED, np.int32)
    queue = new_queue(8 * len(parent) + 1)
    if not search_sheets(np.ascontiguousarray(free), origin, end, first, ray, distance, parent, queue):
        return None
    cells = [end]
    while cells[-1] != origin:
        cells.append(int(parent[cells[-1]]))
    return [(cell % columns, cell // columns % rows) for cell in reversed(cells)]
