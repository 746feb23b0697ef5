"""A path-finder to compare with: straight lines between extreme points, as Shakey's (Nilsson 1984).

The extreme points are the corners where blocked squares stick out into free space. A line between two points is
open when it stays in free space; it may touch walls but never passes between two blocked squares that touch at a
corner.
"""

from heapq import heappop, heappush

import numpy as np

from geometry.kernels.arrays import XY, Bools, Floats
from geometry.kernels.jit import bare


def extreme_points(free: Bools) -> Floats:
    """(n, 2) the corners with exactly one blocked square of four about them."""
    wall = ~np.pad(free, 1)
    about = wall[1:, 1:].astype(np.int8) + wall[1:, :-1] + wall[:-1, 1:] + wall[:-1, :-1]
    rows, columns = np.nonzero(about == 1)
    return np.stack([columns, rows], axis=1).astype(np.float64)


def visibility_way(free: Bools, start: XY, goal: XY) -> Floats | None:
    """(n, 2) the shortest way along open lines between start, extreme points and goal; None when there is none."""
    if not (free[int(start[1]), int(start[0])] and free[int(goal[1]), int(goal[0])]):
        raise ValueError("start and goal must lie in free squares")
    points = np.vstack([[start], extreme_points(free), [goal]])
    last = len(points) - 1
    best = np.full(len(points), np.inf)
    best[0] = 0.0
    came = np.zeros(len(points), np.int64)
    closed = np.zeros(len(points), np.bool_)
    padded = np.pad(free, 1)
    heap = [(0.0, 0)]
    while heap:
        _, at = heappop(heap)
        if at == last:
            return trail(points, came, at)
        if closed[at]:
            continue
        closed[at] = True
        steps = np.hypot(*(points - points[at]).T)
        nearer = ~closed & (best[at] + steps < best)
        for other in np.flatnonzero(nearer).tolist():
            if leaves_own_square(padded, points, at, other) and line_open(padded, *points[at], *points[other]):
                best[other] = best[at] + steps[other]
                came[other] = at
                ahead = float(np.hypot(*(points[other] - points[last])))
                heappush(heap, (float(best[other]) + ahead, other))
    return None


def leaves_own_square(padded: Bools, points: Floats, at: int, other: int) -> bool:
    """Return whether a line between two points keeps, at start or goal, to the side of the pinch on which they are.

    A point where two blocked squares touch at a corner belongs, as all points, to the square north-east of it. The
    corners between start and goal are no pinches.
    """
    last = len(points) - 1
    for end, far in ((at, other), (other, at)):
        x, y = points[end].tolist()
        if end in (0, last) and y == int(y) and pinched(padded, x, int(y)) and x == int(x):
            u, v = points[far].tolist()
            if u < x or v < y:
                return False
    return True


def trail(points: Floats, came: np.ndarray[tuple[int], np.dtype[np.int64]], at: int) -> Floats:
    """The points on the way to one of them."""
    order = [at]
    while at:
        at = int(came[at])
        order.append(at)
    return points[order[::-1]]


@bare
def line_open(padded: Bools, x0: float, y0: float, x1: float, y1: float) -> bool:
    """Whether a segment stays in free space: row by row, the squares that it enters."""
    if y0 > y1:
        x0, y0, x1, y1 = x1, y1, x0, y0
    if y0 == y1:
        return level_open(padded, min(x0, x1), max(x0, x1), y0)
    slope = (x1 - x0) / (y1 - y0)
    for row in range(int(np.floor(y0)), int(np.ceil(y1))):
        a = x0 + slope * (max(y0, float(row)) - y0)
        b = x0 + slope * (min(y1, row + 1.0) - y0)
        low, high = min(a, b), max(a, b)
        if row > y0 and pinched(padded, a, row):
            return False
        if high - low < 1e-9 and abs(low - np.floor(low + 0.5)) < 1e-9:  # along a vertical line: either side will do
            column = int(np.floor(low + 0.5))
            if not (padded[row + 1, column] or padded[row + 1, column + 1]):
                return False
            continue
        for column in range(int(np.floor(low + 1e-9)), int(np.ceil(high - 1e-9))):
            if not padded[row + 1, column + 1]:
                return False
    return True


@bare
def level_open(padded: Bools, low: float, high: float, y: float) -> bool:
    """Whether a horizontal segment stays in free space; along a line between rows either side will do."""
    row = int(np.floor(y))
    for column in range(int(np.floor(low)), int(np.ceil(high))):
        if y == row:
            if not (padded[row, column + 1] or padded[row + 1, column + 1]):
                return False
        elif not padded[row + 1, column + 1]:
            return False
    if y == row:
        for column in range(int(np.floor(low)) + 1, int(np.ceil(high))):
            if pinched(padded, float(column), row):
                return False
    return True


@bare
def pinched(padded: Bools, x: float, row: int) -> bool:
    """Whether a point on the line below a row is where two blocked squares touch at a corner."""
    column = int(np.floor(x + 0.5))
    if abs(x - column) > 1e-9:
        return False
    one, two = padded[row, column] and padded[row + 1, column + 1], padded[row, column + 1] and padded[row + 1, column]
    blocked = int(padded[row, column]) + int(padded[row + 1, column]) + int(padded[row, column + 1])
    return bool((one or two) and blocked + int(padded[row + 1, column + 1]) == 2)
