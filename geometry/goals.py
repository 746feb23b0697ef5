"""Goals that are sets of squares: a route may end anywhere in the set, and classes do not tell apart where.

Each connected part of the set has a representative, its square of greatest clearance. Routes to it are cut where
they enter the part, and their class is the word up to there and on to the representative over squares of the part.
The end then moves from square to square of the part as long as that shortens the route.
"""

from itertools import pairwise
from numbers import Integral
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from geometry.bones import Floats, Ints
from geometry.distance import Bools, Squares
from geometry.parts import Labels, number_parts
from geometry.runs import Runs, symbol_between

XY = tuple[float, float]


class Region(NamedTuple):
    """One connected part of a goal set, in padded cells."""

    cell: int
    """Its representative."""
    parent: dict[int, int]
    """The next cell towards the representative, for every cell of the part but that."""


def checked_goal(goal: ArrayLike | set[tuple[int, int]], shape: tuple[int, int]) -> Bools | None:
    """The squares of a goal set, or None when the goal is a point.

    Raises
    ------
    ValueError
        When it is neither a point nor an array of bool of the screen's shape nor a set of (column, row).
    """
    if isinstance(goal, set | frozenset):
        squares = np.zeros(shape, np.bool_)
        for i, j in sorted(goal):
            if not (isinstance(i, Integral) and isinstance(j, Integral)):
                raise ValueError(f"goal square ({i}, {j}) must be whole numbers (column, row)")
            if not (0 <= i < shape[1] and 0 <= j < shape[0]):
                raise ValueError(f"goal square ({i}, {j}) lies outside the screen")
            squares[j, i] = True
        return squares
    grid = np.asarray(goal)
    if grid.dtype == np.bool_ and grid.shape == shape:
        return grid
    if grid.shape == (2,) and grid.dtype != np.bool_:
        return None
    raise ValueError(f"goal must be a point (x, y), a bool array of shape {shape} or a set of squares (column, row)")


def regions(square: Squares, level: int, goal: Bools) -> list[Region]:
    """The connected parts of a goal set where a body may be."""
    inside = np.zeros(square.shape, np.bool_)
    inside[1:-1, 1:-1] = goal & (square[1:-1, 1:-1] >= level)
    label = np.zeros(square.shape, np.int32)
    shut = np.zeros((2, *square.shape), np.bool_)
    count = number_parts(inside, shut, label, np.empty(square.size, np.int32))
    return [region(square, label, number) for number in range(1, count + 1)]


def region(square: Squares, label: Labels, number: int) -> Region:
    """One part, with its way from every cell to the representative."""
    cells = np.flatnonzero(label == number)
    heights = square.reshape(-1)[cells]
    best = int(cells[len(heights) - 1 - int(np.argmax(heights[::-1]))])
    inside, width = set(cells.tolist()), square.shape[1]
    parent: dict[int, int] = {}
    queue = [best]
    for cell in queue:
        for other in (cell + 1, cell + width, cell - 1, cell - width):
            if other in inside and other not in parent and other != best:
                parent[other] = cell
                queue.append(other)
    return Region(best, parent)


def way_in(place: Region, cell: int) -> list[int]:
    """The cells from one of a part to its representative."""
    cells = [cell]
    while cell != place.cell:
        cell = place.parent[cell]
        cells.append(cell)
    return cells


def word_of_cells(runs: Runs, cells: list[int], width: int) -> Ints:
    """The portals crossed from cell to cell, not reduced."""
    symbols = [symbol_between(runs.row, runs.up, runs.left, a, b, width) for a, b in pairwise(cells)]
    return np.array([s for s in symbols if s], np.int32)


def entry(points: Floats, inside: Bools) -> tuple[Floats, tuple[int, int]]:
    """A polyline up to the first square of the set that it enters, and that square's (column, row)."""
    for k, (p, q) in enumerate(pairwise(points)):
        for t in crossings_of_lines(p, q):
            x, y = p + t * (q - p)
            i, j = int(np.floor(x)), int(np.floor(y))
            if 0 <= i < inside.shape[1] and 0 <= j < inside.shape[0] and inside[j, i]:
                return np.vstack([points[: k + 1], [[x, y]]]), (i, j)
    i, j = (int(v) for v in points[-1])
    return points, (i, j)


def crossings_of_lines(p: Floats, q: Floats) -> list[float]:
    """Parameters inside each square that the segment from p to q passes."""
    cuts = {0.0, 1.0}
    for a, b in zip(p.tolist(), q.tolist(), strict=True):
        low, high = sorted((a, b))
        for line in range(int(np.floor(low)) + 1, int(np.ceil(high))):
            cuts.add((line - a) / (b - a))
    ordered = sorted(cuts)
    return [0.5 * (s + t) for s, t in pairwise(ordered)]
