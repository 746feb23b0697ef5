"""A* on the eight-connected grid of squares (Hart, Nilsson and Raphael 1968), for comparison.

Diagonal steps are allowed where both squares beside them are free. The path goes from centre to centre.
"""

from heapq import heappop, heappush
from math import sqrt

import numpy as np

from utak.geometry.kernels.arrays import Bools, Floats, Square

DIAGONAL = sqrt(2.0)
STRAIGHT_STEPS = ((1, 0, 1.0), (0, 1, 1.0), (-1, 0, 1.0), (0, -1, 1.0))
STEPS = (*STRAIGHT_STEPS, *((dx, dy, DIAGONAL) for dx, dy in ((1, 1), (-1, 1), (-1, -1), (1, -1))))


def grid_path(free: Bools, start: tuple[float, float], goal: tuple[float, float]) -> Floats | None:
    """Return the shortest path over squares from start to goal; None when there is none."""
    first, last = (int(start[0]), int(start[1])), (int(goal[0]), int(goal[1]))
    padded = np.pad(free, 1).tolist()
    if not (padded[first[1] + 1][first[0] + 1] and padded[last[1] + 1][last[0] + 1]):
        raise ValueError("start and goal must lie in free squares")
    done: dict[Square, float] = {first: 0.0}
    came_from: dict[Square, Square] = {}
    heap = [(octile_distance(first, last), 0.0, first)]
    while heap:
        _, length, square = heappop(heap)
        if square == last:
            return points_of_path(came_from, square, start, goal)
        if length > done[square]:
            continue
        x, y = square
        for dx, dy, step in STEPS:
            if padded[y + dy + 1][x + dx + 1] and padded[y + 1][x + dx + 1] and padded[y + dy + 1][x + 1]:
                other, total = (x + dx, y + dy), length + step
                if total < done.get(other, np.inf):
                    done[other] = total
                    came_from[other] = square
                    heappush(heap, (total + octile_distance(other, last), total, other))
    return None


def octile_distance(a: Square, b: Square) -> float:
    """Return the length of the shortest path between two squares on an empty grid, in squares."""
    dx, dy = abs(a[0] - b[0]), abs(a[1] - b[1])
    return max(dx, dy) + (DIAGONAL - 1.0) * min(dx, dy)


def points_of_path(
    came_from: dict[Square, Square], square: Square, start: tuple[float, float], goal: tuple[float, float]
) -> Floats:
    """Return the path to a square: start, centres of squares, goal, (n, 2) float64 of (x, y) in squares."""
    squares = [square]
    while square in came_from:
        square = came_from[square]
        squares.append(square)
    centres = [(x + 0.5, y + 0.5) for x, y in reversed(squares)]
    whole = [tuple(start), *[p for p in centres if p not in (tuple(start), tuple(goal))], tuple(goal)]
    return np.array(whole, np.float64)
