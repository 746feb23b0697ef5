"""A path-finder to compare with: A* on the eight-connected grid of squares (Hart, Nilsson and Raphael 1968).

Diagonal steps are allowed where both squares beside them are free. The way goes from centre to centre.
"""

from heapq import heappop, heappush
from math import sqrt

import numpy as np

from geometry.kernels.arrays import Bools, Floats, Square

DIAGONAL = sqrt(2.0)
STRAIGHT = ((1, 0, 1.0), (0, 1, 1.0), (-1, 0, 1.0), (0, -1, 1.0))
STEPS = (*STRAIGHT, *((dx, dy, DIAGONAL) for dx, dy in ((1, 1), (-1, 1), (-1, -1), (1, -1))))


def grid_way(free: Bools, start: tuple[float, float], goal: tuple[float, float]) -> Floats | None:
    """(n, 2) the shortest way over squares, from start to goal; None when there is none.

    Parameters
    ----------
    free : (rows, columns) bool
    start, goal : (x, y)
        In free squares.
    """
    first, last = (int(start[0]), int(start[1])), (int(goal[0]), int(goal[1]))
    padded = np.pad(free, 1).tolist()
    if not (padded[first[1] + 1][first[0] + 1] and padded[last[1] + 1][last[0] + 1]):
        raise ValueError("start and goal must lie in free squares")
    done: dict[Square, float] = {first: 0.0}
    came: dict[Square, Square] = {}
    heap = [(octile(first, last), 0.0, first)]
    while heap:
        _, length, square = heappop(heap)
        if square == last:
            return unroll(came, square, start, goal)
        if length > done[square]:
            continue
        x, y = square
        for dx, dy, step in STEPS:
            if padded[y + dy + 1][x + dx + 1] and padded[y + 1][x + dx + 1] and padded[y + dy + 1][x + 1]:
                other, total = (x + dx, y + dy), length + step
                if total < done.get(other, np.inf):
                    done[other] = total
                    came[other] = square
                    heappush(heap, (total + octile(other, last), total, other))
    return None


def octile(a: Square, b: Square) -> float:
    """The length of the way between two squares on an empty grid."""
    dx, dy = abs(a[0] - b[0]), abs(a[1] - b[1])
    return max(dx, dy) + (DIAGONAL - 1.0) * min(dx, dy)


def unroll(came: dict[Square, Square], square: Square, start: tuple[float, float], goal: tuple[float, float]) -> Floats:
    """The way back to the first square, turned round, with the true ends."""
    squares = [square]
    while square in came:
        square = came[square]
        squares.append(square)
    centres = [(x + 0.5, y + 0.5) for x, y in reversed(squares)]
    whole = [tuple(start), *[p for p in centres if p not in (tuple(start), tuple(goal))], tuple(goal)]
    return np.array(whole, np.float64)
