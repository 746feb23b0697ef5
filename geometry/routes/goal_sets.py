"""Goals that are sets of squares: a route may end anywhere in the set, and classes do not tell apart where.

Each connected part of the set has a representative, its square of greatest clearance. Routes to it end where they
first enter the set, and the end then moves from square to square as long as that shortens the route. Routes whose ends
can be moved into each other within the set are of one class. The nearest square of all is found by itself.
"""

from itertools import pairwise
from numbers import Integral
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from geometry.homotopy.strips import Strips, symbol_between
from geometry.kernels.arrays import Bools, Ints, Labels, SquaredDistances
from geometry.passages.partition import number_parts


class GoalRegion(NamedTuple):
    """One connected part of a goal set, in padded cells.

    A part may go round walls, and the end of a route may as well. So the part is folded: its rows of squares are
    vertices, and what leads through one portal to the same run is one vertex. Read backwards from its end, the word of
    a route is taken back as far as it runs within the part; what is left, and the vertex where that ends, name the
    class (Stallings 1983).
    """

    cell: int
    """Its representative, the cell of greatest clearance."""
    vertex: dict[int, int]
    """The vertex of each of its cells."""
    step: dict[tuple[int, int], int]
    """By vertex and signed portal, the vertex beyond."""

    def class_of(self, word: Ints, cell: int) -> tuple[int, ...]:
        """Return a name for the class of a reduced word to one of the cells, whose end may be moved in the part."""
        symbols, here = word.tolist(), self.vertex[cell]
        while symbols and (here, -symbols[-1]) in self.step:
            here = self.step[here, -symbols.pop()]
        return (here, *symbols)


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


def regions(square: SquaredDistances, level: int, runs: Strips, goal: Bools) -> list[GoalRegion]:
    """Return the connected parts of a goal set where a body may be."""
    inside = np.zeros(square.shape, np.bool_)
    inside[1:-1, 1:-1] = goal & (square[1:-1, 1:-1] >= level)
    label = np.zeros(square.shape, np.int32)
    shut = np.zeros((2, *square.shape), np.bool_)
    count = number_parts(inside, shut, label, np.empty(square.size, np.int32))
    return [region(square, runs, label, number) for number in range(1, count + 1)]


def region(square: SquaredDistances, runs: Strips, label: Labels, number: int) -> GoalRegion:
    """Return one part."""
    width = square.shape[1]
    cells = np.flatnonzero(label == number)
    heights = square.reshape(-1)[cells]
    best = int(cells[len(heights) - 1 - int(np.argmax(heights[::-1]))])
    rows = np.cumsum(np.diff(cells, prepend=cells[0] - 2) != 1)
    row_of = dict(zip(cells.tolist(), rows.tolist(), strict=True))
    edges: dict[tuple[int, int, int], None] = {}
    for cell, row in row_of.items():
        above = row_of.get(cell + width)
        if above is not None:
            symbol = symbol_between(runs.row, runs.up, runs.left, cell, cell + width, width)
            edges[row, int(symbol), above] = None
            edges[above, -int(symbol), row] = None
    vertex, step = folded(list(edges), int(rows[-1]) + 1)
    return GoalRegion(best, {cell: vertex[row] for cell, row in row_of.items()}, step)


def folded(edges: list[tuple[int, int, int]], count: int) -> tuple[list[int], dict[tuple[int, int], int]]:
    """Return the vertex that stands for each, and the steps, when two steps of one name never lead apart."""
    vertex = list(range(count))

    def standing_for(v: int) -> int:
        while vertex[v] != v:
            vertex[v] = vertex[vertex[v]]
            v = vertex[v]
        return v

    step: dict[tuple[int, int], int] = {}
    again = True
    while again:
        again = False
        step.clear()
        for one, symbol, other in edges:
            here, there = standing_for(one), standing_for(other)
            known = standing_for(step.setdefault((here, symbol), there))
            if known != there:
                vertex[max(known, there)] = min(known, there)
                again = True
    return [standing_for(v) for v in range(count)], step


def edge_cells(square: SquaredDistances, level: int, goal: Bools, start: int) -> list[int]:
    """Return the cells of a goal set one of which is the nearest: where a way comes in from outside, or starts.

    A way to the centre of another cell comes over a cell of the set whose centre is as near to where it goes on.
    """
    inside, free = np.pad(goal, 1), square >= level
    outside = free & ~inside
    edge = outside.copy()
    edge[1:] |= outside[:-1]
    edge[:-1] |= outside[1:]
    edge[:, 1:] |= outside[:, :-1]
    edge[:, :-1] |= outside[:, 1:]
    edge.reshape(-1)[start] = True
    return [int(cell) for cell in np.flatnonzero(edge & inside & free)]


def word_of_cells(runs: Strips, cells: list[int], width: int) -> Ints:
    """The portals crossed from cell to cell, not reduced."""
    symbols = [symbol_between(runs.row, runs.up, runs.left, a, b, width) for a, b in pairwise(cells)]
    return np.array([s for s in symbols if s], np.int32)
