"""An exact visibility graph of a raster map, searched no further than a length that it is to confirm.

It shares with geometry/ the definition of extreme points and open lines (visibility.py, tested against shapely), and
nothing with the search that it checks.
"""

import numpy as np

from geometry.kernels.heap import pop, push
from geometry.kernels.jit import compiled
from geometry.pathfinders.visibility_graph import extreme_points, line_open

XY = tuple[float, float]


class Sightlines:
    """Shortest ways over straight lines between the extreme points of a map."""

    def __init__(self, free: np.ndarray) -> None:
        self._padded = np.pad(free, 1)
        self._corners = extreme_points(free)
        column, row = self._corners.astype(np.int64).T
        west = ~self._padded[row, column] | ~self._padded[row + 1, column]
        south = ~self._padded[row, column] | ~self._padded[row, column + 1]
        self._sides = np.stack([np.where(west, -1.0, 1.0), np.where(south, -1.0, 1.0)], axis=1)

    def length(self, start: XY, goal: XY, limit: float) -> float:
        """The length of the shortest way; infinite when there is none up to the limit."""
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
    """A* over the points, first to last; lines are looked along only where they would make a way shorter.

    A rope bends only about a blocked square: its line passes beside the square on which ``sides`` (n, 2) the corner
    has it, neither over that square nor over the one opposite.
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
