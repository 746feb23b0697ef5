"""Visibility graph of extreme points: A* along straight open lines, as Shakey's (Nilsson 1984), for comparison.

The extreme points are the corners where blocked squares stick out into free space. A line between two points is open
when it stays in free space. It may touch walls but never passes between two blocked squares that touch at a corner.
"""

from heapq import heappop, heappush

import numpy as np

from utak.geometry.kernels.arrays import XY, Bools, Floats
from utak.geometry.kernels.jit import bare


def extreme_points(free: Bools) -> Floats:
    """Return the extreme points: corners with exactly one blocked square about them."""
    wall = ~np.pad(free, 1)
    blocked_count = wall[1:, 1:].astype(np.int8) + wall[1:, :-1] + wall[:-1, 1:] + wall[:-1, :-1]
    rows, columns = np.nonzero(blocked_count == 1)
    return np.stack([columns, rows], axis=1).astype(np.float64)


def visibility_path(free: Bools, start: XY, goal: XY) -> Floats | None:
    """Return the shortest path along open lines between start, extreme points and goal; None when there is none."""
    if not (free[int(start[1]), int(start[0])] and free[int(goal[1]), int(goal[0])]):
        raise ValueError("start and goal must lie in free squares")
    points = np.vstack([[start], extreme_points(free), [goal]])
    last = len(points) - 1
    best = np.full(len(points), np.inf)
    best[0] = 0.0
    came_from = np.zeros(len(points), np.int64)
    closed = np.zeros(len(points), np.bool_)
    padded = np.pad(free, 1)
    heap = [(0.0, 0)]
    while heap:
        _, here = heappop(heap)
        if here == last:
            return points_of_path(points, came_from, here)
        if closed[here]:
            continue
        closed[here] = True
        steps = np.hypot(*(points - points[here]).T)
        nearer = ~closed & (best[here] + steps < best)
        for other in np.flatnonzero(nearer).tolist():
            if leaves_own_square(padded, points, here, other) and line_open(padded, *points[here], *points[other]):
                best[other] = best[here] + steps[other]
                came_from[other] = here
                to_goal = float(np.hypot(*(points[other] - points[last])))
                heappush(heap, (float(best[other]) + to_goal, other))
    return None


def leaves_own_square(padded: Bools, points: Floats, here: int, other: int) -> bool:
    """Return whether a line leaves a start or goal that is a pinch on the side where its square lies."""
    last = len(points) - 1
    for end, far in ((here, other), (other, here)):
        x, y = points[end].tolist()
        if end in (0, last) and y == int(y) and is_pinch(padded, x, int(y)) and x == int(x):
            u, v = points[far].tolist()
            if u < x or v < y:
                return False
    return True


def points_of_path(points: Floats, came_from: np.ndarray[tuple[int], np.dtype[np.int64]], here: int) -> Floats:
    """Return the points on the path to one of them, from the start on, (n, 2) float64 of (x, y) in squares."""
    order = [here]
    while here:
        here = int(came_from[here])
        order.append(here)
    return points[order[::-1]]


@bare
def line_open(padded: Bools, x0: float, y0: float, x1: float, y1: float) -> bool:
    """Return whether a segment stays in free space. It may touch walls but passes no pinch."""
    if y0 > y1:
        x0, y0, x1, y1 = x1, y1, x0, y0
    if y0 == y1:
        return horizontal_open(padded, min(x0, x1), max(x0, x1), y0)
    slope = (x1 - x0) / (y1 - y0)
    for row in range(int(np.floor(y0)), int(np.ceil(y1))):
        a = x0 + slope * (max(y0, float(row)) - y0)
        b = x0 + slope * (min(y1, row + 1.0) - y0)
        low, high = min(a, b), max(a, b)
        if row > y0 and is_pinch(padded, a, row):
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
def horizontal_open(padded: Bools, low: float, high: float, y: float) -> bool:
    """Return whether a horizontal segment from x `low` to `high` stays in free space, and passes no pinch between."""
    row = int(np.floor(y))
    for column in range(int(np.floor(low)), int(np.ceil(high))):
        if y == row:
            if not (padded[row, column + 1] or padded[row + 1, column + 1]):
                return False
        elif not padded[row + 1, column + 1]:
            return False
    if y == row:
        for column in range(int(np.floor(low)) + 1, int(np.ceil(high))):
            if is_pinch(padded, float(column), row):
                return False
    return True


@bare
def is_pinch(padded: Bools, x: float, row: int) -> bool:
    """Return whether the point (x, row) is a pinch: two of the squares about it are blocked, and touch there alone."""
    column = int(np.floor(x + 0.5))
    if abs(x - column) > 1e-9:
        return False
    one, two = padded[row, column] and padded[row + 1, column + 1], padded[row, column + 1] and padded[row + 1, column]
    blocked = int(padded[row, column]) + int(padded[row + 1, column]) + int(padded[row, column + 1])
    return bool((one or two) and blocked + int(padded[row + 1, column + 1]) == 2)
