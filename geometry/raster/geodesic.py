"""Geodesic distances: the length of the shortest path from a start to every square, over the eight neighbours.

Dijkstra's algorithm with a ring of buckets (Dial 1969): steps cost 5 along rows and columns and 7 diagonally, which is
within 1.1 % of the true ratio. A diagonal step needs both squares beside it free. The raster may be taken in several
sheets, one above the other: a step over a ray leads to the next sheet up or down (winding.py).
"""

import numpy as np
from numpy.typing import NDArray

from utak.geometry.kernels.arrays import Ints, Longs
from utak.geometry.kernels.bucket_queue import Queue, new_queue, put, take
from utak.geometry.kernels.jit import bare

GEODESIC_UNREACHED = -1  # the distance of a square that no path leads to
FIFTHS_PER_SQUARE = 5  # the unit of the distances is a fifth of a square
GEODESIC_STEP, GEODESIC_DIAGONAL = FIFTHS_PER_SQUARE, 7  # fifths of squares; 7 / 5 is within 1.1 % of sqrt(2)


def reach(free: NDArray[np.bool_], column: int, row: int) -> Ints:
    """Return the length of the shortest path from a start to every square, in fifths of squares.

    Examples
    --------
    >>> reach(np.array([[True, True, False], [True, True, True]]), 0, 0).tolist()
    [[0, 5, -1], [5, 7, 12]]
    """
    rows, columns = free.shape
    if not (0 <= row < rows and 0 <= column < columns and free[row, column]):
        raise ValueError(f"the start ({column}, {row}) is not a free square")
    distance = np.full(free.shape, GEODESIC_UNREACHED, np.int32)
    origin, ray, parent = row * columns + column, np.zeros(columns, np.bool_), np.empty(0, np.int64)
    queue = new_queue(8 * free.size + 1)
    search_sheets(np.ascontiguousarray(free), origin, -1, rows, ray, distance.reshape(-1), parent, queue)
    return distance


@bare
def search_sheets(
    free: NDArray[np.bool_],
    origin: int,
    end: int,
    first: int,
    ray: NDArray[np.bool_],
    distance: Ints,
    parent: Longs,
    queue: Queue,
) -> bool:
    """Fill `distance`, and `parent` if it has room, along shortest paths up to `end`; return whether it is reached."""
    # Cells are numbered sheet by sheet, each row by row. The ray runs below row `first`, over the columns of `ray`.
    rows, columns = free.shape
    put(queue, 0, origin)
    distance[origin], now = 0, 0
    while queue.used[1] > 0:
        cell = take(queue, now)
        if cell < 0:
            now += 1
            continue
        if distance[cell] != now:
            continue
        if cell == end:
            return True
        floor, c = cell // columns, cell % columns
        r = floor % rows
        for dr in range(-1, 2):
            for dc in range(-1, 2):
                p, q = r + dr, c + dc
                if (dr == 0 and dc == 0) or p < 0 or q < 0 or p >= rows or q >= columns or not free[p, q]:
                    continue
                cost = GEODESIC_STEP
                if dr != 0 and dc != 0:
                    if not free[r, q] or not free[p, c]:
                        continue
                    cost = GEODESIC_DIAGONAL
                other = (floor + dr) * columns + q
                if (p >= first) != (r >= first) and ray[q] and ray[c]:
                    other += rows * columns if p >= first else -rows * columns
                    if other < 0 or other >= len(distance):
                        continue
                if distance[other] < 0 or now + cost < distance[other]:
                    distance[other] = now + cost
                    if len(parent) > 0:
                        parent[other] = cell
                    put(queue, now + cost, other)
    return False
