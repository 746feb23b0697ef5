"""Goals that are sets of squares: a route may end anywhere in the set, and classes do not tell apart where.

Each connected part of the set has a representative, its square of greatest clearance. Routes to it end where they
first enter the set, and the end then moves from square to square as long as that shortens the route. Routes whose ends
can be moved into each other within the set are of one class. The nearest square of all is found separately.
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

    A part may go round walls, and the end of a route may move round them as well. So the part is folded: its rows of
    squares are vertices, and what leads through one portal to the same strip is one vertex. Read backwards from its
    end, the word of a route is taken back as far as it runs within the part. What is left, and the vertex where that
    ends, name the class (Stallings 1983).

    Attributes
    ----------
    cell : its representative, the cell of greatest clearance.
    vertex : the vertex of each of its cells.
    step : by vertex and signed portal, the vertex beyond.
    """

    cell: int
    vertex: dict[int, int]
    step: dict[tuple[int, int], int]

    def class_of(self, word: Ints, cell: int) -> tuple[int, ...]:
        """Return a name for the class of a reduced word to one of the cells, whose end may be moved within the part."""
        symbols, here = word.tolist(), self.vertex[cell]
        while symbols and (here, -symbols[-1]) in self.step:
            here = self.step[here, -symbols.pop()]
        return (here, *symbols)


def checked_goal(goal: ArrayLike | set[tuple[int, int]], shape: tuple[int, int]) -> Bools | None:
    """Return the squares of a goal set, (rows, columns) bool, or None when the goal is a point.

    Parameters
    ----------
    goal : (x, y), or (rows, columns) array of bool, or set of squares (column, row).
    shape : (rows, columns) of the screen.

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


def goal_regions(square: SquaredDistances, level: int, strips: Strips, goal: Bools) -> list[GoalRegion]:
    """Return the connected parts of a goal set where a body may be.

    Parameters
    ----------
    square : (rows + 2, columns + 2) int, squared clearances in half squares.
    level : the least squared clearance of a cell where the body may be, in half squares.
    goal : (rows, columns) bool.
    """
    inside = np.zeros(square.shape, np.bool_)
    inside[1:-1, 1:-1] = goal & (square[1:-1, 1:-1] >= level)
    label = np.zeros(square.shape, np.int32)
    shut = np.zeros((2, *square.shape), np.bool_)
    count = number_parts(inside, shut, label, np.empty(square.size, np.int32))
    return [goal_region(square, strips, label, number) for number in range(1, count + 1)]


def goal_region(square: SquaredDistances, strips: Strips, label: Labels, number: int) -> GoalRegion:
    """Return the part with a number in `label`, (rows + 2, columns + 2)."""
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
            symbol = symbol_between(strips.row, strips.up, strips.left, cell, cell + width, width)
            edges[row, int(symbol), above] = None
            edges[above, -int(symbol), row] = None
    vertex, step = fold(list(edges), int(rows[-1]) + 1)
    return GoalRegion(best, {cell: vertex[row] for cell, row in row_of.items()}, step)


def fold(edges: list[tuple[int, int, int]], count: int) -> tuple[list[int], dict[tuple[int, int], int]]:
    """Return the vertex that stands for each one, and the steps, once no two steps of one name lead apart.

    Parameters
    ----------
    edges : (vertex, signed portal, vertex beyond), in both directions.
    count : the number of vertices.
    """
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


def candidate_cells(square: SquaredDistances, level: int, goal: Bools, start: int) -> list[int]:
    """Return the padded cells of a goal set among which the nearest is: those beside a cell outside it, and the start.

    A path to the centre of any other cell passes a cell of the set whose centre is as near to where it goes on.

    Parameters
    ----------
    goal : (rows, columns) bool.
    start : the padded cell of the start.
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


def word_of_cells(strips: Strips, cells: list[int], width: int) -> Ints:
    """Return the signed portals crossed from cell to cell, not reduced."""
    symbols = [symbol_between(strips.row, strips.up, strips.left, a, b, width) for a, b in pairwise(cells)]
    return np.array([s for s in symbols if s], np.int32)
