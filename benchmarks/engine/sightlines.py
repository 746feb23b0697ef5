"""An exact visibility graph of a raster map, searched no further than a length that it is to confirm.

It shares with geometry the definition of extreme points and of open lines (visibility_graph.py, which is tested against
shapely), and nothing with the search that it checks.
"""

import numpy as np

from utak.geometry.kernels.arrays import XY
from utak.geometry.kernels.heap import pop, push
from utak.geometry.kernels.jit import compiled
from utak.geometry.pathfinders.visibility_graph import extreme_points, line_open


class Sightlines:
    """Shortest paths along straight lines between the extreme points of a map.

    Parameters
    ----------
    free : (rows, columns) bool
        Free squares.
    """

    def __init__(self, free: np.ndarray) -> None:
        self._padded = np.pad(free, 1)
        self._corners = extreme_points(free)
        column, row = self._corners.astype(np.int64).T
        west = ~self._padded[row, column] | ~self._padded[row + 1, column]
        south = ~self._padded[row, column] | ~self._padded[row, column + 1]
        self._sides = np.stack([np.where(west, -1.0, 1.0), np.where(south, -1.0, 1.0)], axis=1)

    def length(self, start: XY, goal: XY, limit: float) -> float:
        """Return the length of the shortest path in squares; inf when there is none of at most ``limit``."""
        offsets = [np.hypot(*(self._corners - end).T) for end in (start, goal)]
        near = offsets[0] + offsets[1] <= limit
        points = np.vstack([[start], self._corners[near], [goal]])
        sides = np.vstack([[0.0, 0.0], self._sides[near], [0.0, 0.0]])
        best, done = np.full(len(points), np.inf), np.zeros(len(points), np.bool_)
        key, item = np.empty(64 * len(points) + 4096), np.empty(64 * len(points) + 4096, np.int32)
        return float(shortest_length(self._padded, points, sides, limit, best, done, key, item))


@compiled
def shortest_length(
    padded: np.ndarray,
    points: np.ndarray,
    sides: np.ndarray,
    limit: float,
    best: np.ndarray,
    done: np.ndarray,
    key: np.ndarray,
    item: np.ndarray,
) -> float:
    """Return the length of the shortest path from the first to the last point, by A*; inf when none is within a limit.

    A line is tested only where it would shorten a path. A tight path bends only around a blocked square: ``sides``
    (n, 2) says on which side of a corner that square lies, and lines over it or over the opposite square are skipped.
    ``best``, ``done``, ``key`` and ``item`` are scratch.
    """
    last = points.shape[0] - 1
    best[0] = 0.0
    size = push(key, item, 0, 0.0, 0)
    while size > 0:
        at, size = pop(key, item, size)
        if at == last:
            return best[last]
        if done[at]:
            continue
        done[at] = True
        x, y = points[at, 0], points[at, 1]
        for other in range(1, last + 1):
            dx, dy = points[other, 0] - x, points[other, 1] - y
            if dx * dy * sides[at, 0] * sides[at, 1] > 0.0 or dx * dy * sides[other, 0] * sides[other, 1] > 0.0:
                continue
            total = best[at] + np.sqrt(dx * dx + dy * dy)
            if done[other] or total >= best[other]:
                continue
            ahead = np.sqrt((points[other, 0] - points[last, 0]) ** 2 + (points[other, 1] - points[last, 1]) ** 2)
            if total + ahead <= limit and line_open(padded, x, y, points[other, 0], points[other, 1]):
                best[other] = total
                if size < key.shape[0]:
                    size = push(key, item, size, total + ahead, other)
    return np.inf
