"""Shortest ways over a raster with a prescribed crossing number: how often, with sign, they cross a ray from a given
point.

# Strategy: the raster is taken in several sheets, one for each crossing number so far; a step over the ray leads to
# the next sheet up or
# down. This is a piece of the universal cover of the plane without the point, and Dijkstra's algorithm runs on it as
# on any raster.
"""

import numpy as np
from numpy.typing import NDArray

from geometry.kernels.arrays import Square
from geometry.kernels.jit import compiled

MOST = 2  # crossings: sheets from -MOST to MOST
_SIDE, _DIAGONAL = 5, 7


def crossings(points: NDArray[np.float64], about: tuple[float, float]) -> int:
    """How often a polyline crosses the ray from a point towards +x: upwards counts +1, downwards -1.

    points: (n, 2). Of a closed polyline this is its winding number about the point. A point at the ray's own height
    counts as above it.

    >>> crossings(np.array([[1, -1], [1, 1], [-1, 1], [-1, -1], [1, -1]]), (0.0, 0.0))
    1
    """
    x, y = np.asarray(points, float).T - np.array(about)[:, None]
    above = y >= 0
    rise = above[1:].astype(int) - above[:-1].astype(int)
    change = np.where(rise != 0, y[1:] - y[:-1], 1.0)
    where = x[:-1] - y[:-1] * (x[1:] - x[:-1]) / change
    return int(rise[where > 0].sum())


def winding_way(
    free: NDArray[np.bool_], start: Square, goal: Square, about: tuple[float, float], number: int
) -> list[Square] | None:
    """The shortest way over free squares (eight neighbours, no corners cut) with a given crossing number.

    Parameters
    ----------
    free : (rows, columns) bool. start, goal : (column, row) of free squares; they may be the same.
    about : (x, y), the point from which the ray goes towards +x. number : the signed crossings wanted, -2 to 2.

    Returns
    -------
    The squares from start to goal, or None when no such way exists within crossing numbers -2 to 2 on all of it.

    Raises ValueError when an end is not free or the number is out of range.

    >>> free = np.ones((3, 3), bool); free[1, 1] = False
    >>> len(winding_way(free, (0, 0), (0, 0), (1.5, 1.5), 1))
    9
    """
    if abs(number) > MOST:
        raise ValueError(f"crossing numbers go from -{MOST} to {MOST}, not {number}")
    rows, columns = free.shape
    for column, row in (start, goal):
        if not (0 <= row < rows and 0 <= column < columns and free[row, column]):
            raise ValueError(f"({column}, {row}) is not a free square")
    before = np.full((2 * MOST + 1) * rows * columns, -1, np.int64)
    ray = np.arange(columns) + 0.5 > about[0]
    first = int(np.ceil(about[1] - 0.5))  # the lowest row whose centres count as above the ray
    origin = (MOST * rows + start[1]) * columns + start[0]
    end = ((MOST + number) * rows + goal[1]) * columns + goal[0]
    if not _search(np.ascontiguousarray(free), origin, end, first, ray, before):
        return None
    cells = [end]
    while cells[-1] != origin:
        cells.append(int(before[cells[-1]]))
    return [(cell % columns, cell // columns % rows) for cell in reversed(cells)]


@compiled
def _search(free, origin, end, first, ray, before):  # type: ignore[no-untyped-def]
    rows, columns = free.shape
    sheets = before.shape[0] // (rows * columns)
    ring = _DIAGONAL + 1
    bucket = np.full(ring, -1, np.int64)
    distance = np.full(before.shape[0], -1, np.int32)
    cell_of = np.empty(8 * before.shape[0] + 1, np.int64)
    under = np.empty(8 * before.shape[0] + 1, np.int64)
    cell_of[0], under[0], bucket[0], distance[origin] = origin, -1, 0, 0
    count, waiting, now = 1, 1, 0
    while waiting > 0:
        entry = bucket[now % ring]
        if entry < 0:
            now += 1
            continue
        bucket[now % ring] = under[entry]
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
                cost = _SIDE
                if dr != 0 and dc != 0:
                    if not free[r, q] or not free[p, c]:
                        continue
                    cost = _DIAGONAL
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
                    before[other] = cell
                    cell_of[count], under[count] = other, bucket[(now + cost) % ring]
                    bucket[(now + cost) % ring] = count
                    count += 1
                    waiting += 1
    return False
