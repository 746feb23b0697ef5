"""Shortest paths over a raster with a given crossing number: how often, with sign, they cross a ray from a point.

# Strategy: the raster is taken in several sheets, one for each crossing number so far. A step over the ray leads to the
# next sheet up or down. This is a piece of the universal cover of the plane without the point, and Dijkstra's algorithm
# runs on it as on any raster.
"""

import numpy as np
from numpy.typing import NDArray

from utak.geometry.kernels.arrays import Square
from utak.geometry.kernels.jit import compiled

MAX_CROSSING_NUMBER = 2  # largest magnitude of a crossing number: one sheet for each number; a convention
WINDING_STEP, WINDING_DIAGONAL = 5, 7  # fifths of squares: lengths of steps; 7 / 5 is within 1.1 % of sqrt(2)


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
    if not _search_sheets(np.ascontiguousarray(free), origin, end, first, ray, parent):
        return None
    cells = [end]
    while cells[-1] != origin:
        cells.append(int(parent[cells[-1]]))
    return [(cell % columns, cell // columns % rows) for cell in reversed(cells)]


@compiled
def _search_sheets(
    free: NDArray[np.bool_], origin: int, end: int, first: int, ray: NDArray[np.bool_], parent: NDArray[np.int64]
) -> bool:
    """Fill `parent` along shortest paths from `origin` until `end` is reached; return whether it is."""
    rows, columns = free.shape
    sheets = parent.shape[0] // (rows * columns)
    ring = WINDING_DIAGONAL + 1
    first_entry = np.full(ring, -1, np.int64)
    distance = np.full(parent.shape[0], -1, np.int32)
    cell_of = np.empty(8 * parent.shape[0] + 1, np.int64)
    next_entry = np.empty(8 * parent.shape[0] + 1, np.int64)
    cell_of[0], next_entry[0], first_entry[0], distance[origin] = origin, -1, 0, 0
    count, waiting, now = 1, 1, 0
    while waiting > 0:
        entry = first_entry[now % ring]
        if entry < 0:
            now += 1
            continue
        first_entry[now % ring] = next_entry[entry]
        waiting -= 1
        cell = cell_of[entry]
        if distance[cell] != now:
            continue
        if cell == end:
            return True
        sheet, r, c = cell // (rows * columns), cell // columns % rows, cell % columns
        for dr in range(-1, 2):
            for dc in range(-1, 2):
                p, q = r + dr, c + dc
                if (dr == 0 and dc == 0) or p < 0 or q < 0 or p >= rows or q >= columns or not free[p, q]:
                    continue
                cost = WINDING_STEP
                if dr != 0 and dc != 0:
                    if not free[r, q] or not free[p, c]:
                        continue
                    cost = WINDING_DIAGONAL
                level = sheet
                if p >= first and r < first and ray[q] and ray[c]:
                    level += 1
                elif p < first and r >= first and ray[q] and ray[c]:
                    level -= 1
                if level < 0 or level >= sheets:
                    continue
                other = (level * rows + p) * columns + q
                if distance[other] < 0 or now + cost < distance[other]:
                    distance[other] = now + cost
                    parent[other] = cell
                    cell_of[count], next_entry[count] = other, first_entry[(now + cost) % ring]
                    first_entry[(now + cost) % ring] = count
                    count += 1
                    waiting += 1
    return False
