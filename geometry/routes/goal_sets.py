"""Goals that are sets of squares: a route may end anywhere in the set, and classes do not tell apart where.

Each connected part of the set has a representative, its square of greatest clearance. Routes to it end where they first
enter the set, and the end then moves from square to square as long as that shortens the route. Routes whose ends can be
moved into each other within the set are of one class. The nearest square of all is found separately.
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
    """One connected part of a goal set, in padded cells: indices in the flat padded grid.

    A part may go round walls, and the end of a route may move round them as well. So the part is folded: its rows of
    squares are vertices, and what leads through one portal to the same strip is one vertex. Read backwards from its
    end, the word of a route is taken back as far as it runs within the part. What is left, and the vertex where that
    ends, name the class (Stallings 1983). A cell's index is (row + 1) * width + column + 1, with width = columns + 2.

    Attributes
    ----------
    cell : its representative, the cell of greatest clearance; of several, the last.
    vertex : the number of the vertex of each of its cells.
    step : by vertex and signed portal (negative when crossed southwards), the vertex beyond.
    """

    cell: int
    vertex: dict[int, int]
    step: dict[tuple[int, int], int]

    def class_of(self, word: Ints, cell: int) -> tuple[int, ...]:
        """Return a name for the class of a reduced word to one of the cells, whose end may be moved within the part.

        Names are equal exactly when the classes are: first a vertex, then what is left of the word. They hold within
        one part. A word is reduced when no symbol stands next to its negative. A portal is the overlap of two strips
        (rows of free squares) in neighbouring rows.

        Parameters
        ----------
        word : (n,) signed portals (index plus 1, negative when crossed southwards) from the start's strip to that of
            the cell.
        cell : a cell of the part, an index in the flat padded grid, (row + 1) * width + column + 1; KeyError for any
            other.
        """
        symbols, here = word.tolist(), self.vertex[cell]
        while symbols and (here, -symbols[-1]) in self.step:
            here = self.step[here, -symbols.pop()]
        return (here, *symbols)


def checked_goal(goal: ArrayLike | set[tuple[int, int]], shape: tuple[int, int]) -> Bools | None:
    """Return the squares of a goal set, (rows, columns) bool, or None when the goal is a point.

    The values of a point are not checked. An array of bool is returned itself, not a copy.

    Parameters
    ----------
    goal : (x, y) in squares from the screen's south-west corner, or (rows, columns) array of bool, row 0 in the south,
        or set of squares (column, row).
    shape : (rows, columns) of the screen.

    Raises
    ------
    ValueError
        When it is neither a point nor an array of bool of the screen's shape nor a set of (column, row), or a square of
        the set lies outside the screen.
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
    """Return the parts of a goal set where a body may be, connected over edges; an empty list when there is none.

    They are ordered by their first cell, row by row from the south-west. Each holds its representative, the padded cell
    of greatest clearance, and its folded cells: the vertex of each, and the steps between vertices over portals.

    Parameters
    ----------
    square : (rows + 2, columns + 2) int, squared clearances in squared half squares.
    level : the least squared clearance of a cell where the body may be, in squared half squares.
    strips : the strips of free squares (maximal horizontal rows), and the portals between those of neighbouring rows.
    goal : (rows, columns) bool, the squares of the set; those where the body cannot be do not count.
    """
    inside = np.zeros(square.shape, np.bool_)
    inside[1:-1, 1:-1] = goal & (square[1:-1, 1:-1] >= level)
    label = np.zeros(square.shape, np.int32)
    shut = np.zeros((2, *square.shape), np.bool_)
    count = number_parts(inside, shut, label, np.empty(square.size, np.int32))
    return [goal_region(square, strips, label, number) for number in range(1, count + 1)]


def goal_region(square: SquaredDistances, strips: Strips, label: Labels, number: int) -> GoalRegion:
    """Return the part with a number in `label`, folded: cells that one word reaches are made one vertex.

    It holds the padded cell of greatest clearance (of several the last), by cell the number of its vertex, and by
    (vertex, signed portal) the vertex beyond. A signed portal is its index plus 1, negative when crossed southwards.
    A cell's index is (row + 1) * width + column + 1, with width = columns + 2.

    Parameters
    ----------
    square : (rows + 2, columns + 2) int, squared clearances in squared half squares.
    strips : the strips of free squares (maximal horizontal rows), and the portals between those of neighbouring rows.
    label : (rows + 2, columns + 2) int, the number of the part of each padded cell.
    number : one that occurs in `label`.
    """
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

    Where two steps from one vertex with the same signed portal lead to two vertices, these are made one. A signed
    portal is a portal's index plus 1, negative when it is crossed southwards. A portal is the overlap of two strips
    (rows of free squares) in neighbouring rows.

    Parameters
    ----------
    edges : (vertex, signed portal, vertex beyond), in both directions.
    count : the number of vertices, which are numbered from 0.

    Returns
    -------
    vertex : for each vertex the number of the one that stands for it, the least of those made one.
    step : by (vertex, signed portal) the vertex beyond; all of them vertices that stand for others.
    """
    vertex = list(range(count))

    def standing_for(v: int) -> int:
        """Return the vertex that stands for vertex v, and shorten the way to it in `vertex`."""
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

    The start is among them only when it lies in the set. A path to the centre of any other cell passes a cell of the
    set whose centre is as near to where it goes on. Cells are indices in the flat padded grid, (row + 1) * width +
    column + 1, ascending.

    Parameters
    ----------
    square : (rows + 2, columns + 2) int, squared clearances in squared half squares.
    level : the least squared clearance of a cell where the body may be, in squared half squares.
    goal : (rows, columns) bool, the squares of the set, row 0 in the south; those below the level do not count.
    start : the padded cell of the start; listed only when it lies in the set.
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
    """Return the signed portals crossed from cell to cell, (n,) int32, not reduced: inverses may follow each other.

    A step within a row crosses no portal. A signed portal is a portal's index plus 1, negative when it is crossed
    southwards.

    Parameters
    ----------
    strips : the strips of free squares (maximal horizontal rows), and the portals between those of neighbouring rows.
    cells : indices in the flat padded grid, (row + 1) * width + column + 1, each an edge neighbour of the one before.
    width : columns of the padded grid.
    """
    symbols = [symbol_between(strips.row, strips.up, strips.left, a, b, width) for a, b in pairwise(cells)]
    return np.array([s for s in symbols if s], np.int32)
