"""A screen: free and blocked squares, and what a point or a round body can do among them."""

from collections.abc import Iterable, Sequence
from functools import cached_property
from numbers import Integral
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geometry.homotopy.portals import word_of_line
from geometry.incremental.update import change_squares
from geometry.kernels.arrays import Bools, Ints, Labels
from geometry.passages.narrow_stretches import narrow_squares
from geometry.passages.necks import DOOR, Passage, find_passages
from geometry.passages.partition import find_parts
from geometry.passages.walls import Walls, find_walls
from geometry.raster.distance_transform import type_of_squares
from geometry.routes.goal_routes import routes_to_area
from geometry.routes.goal_sets import checked_goal
from geometry.routes.layer import Layer, find_bones, find_layer, level_of, new_state
from geometry.routes.queries import LayerQueries
from geometry.routes.route import Route
from geometry.routes.tighten import word_of_crossings
from geometry.skeleton.buffers import Tenant, take_buffers
from geometry.skeleton.chains import Chains, find_chains
from geometry.skeleton.graph import SkeletonGraph, contract
from geometry.skeleton.pathgraph_arrays import PathgraphArrays, pathgraph_arrays
from geometry.skeleton.skeleton import States, Words
from geometry.skeleton.sweep import survey

if TYPE_CHECKING:
    import networkx

Point = Sequence[float]


class Screen:
    """Free space on a grid of squares; a point passes between squares that share an edge, never through a mere corner.

    Points are (x, y) in squares; the centre of the square in column i and row j is (i + 0.5, j + 0.5).

    Parameters
    ----------
    free : (rows, columns) array of bool
        True where a point may be. Everything outside is blocked.

    Raises
    ------
    ValueError
        When ``free`` is not a two-dimensional array of truth values with at least one free square.

    Examples
    --------
    >>> import numpy as np
    >>> free = np.ones((3, 5), dtype=bool)
    >>> free[1, 2] = False
    >>> [route.points.tolist() for route in Screen(free).routes((0.5, 1.5), (4.5, 1.5), k=2)]
    [[[0.5, 1.5], [2.0, 2.0], [3.0, 2.0], [4.5, 1.5]], [[0.5, 1.5], [2.0, 1.0], [3.0, 1.0], [4.5, 1.5]]]
    """

    def __init__(self, free: ArrayLike) -> None:
        grid = checked_grid(free)
        rows, columns = grid.shape
        self.shape = (rows, columns)
        self._rent(type_of_squares(grid))
        self._skeletons: dict[int, tuple[States, Words, SkeletonGraph]] = {1: self._survey(grid)}
        self._chains: dict[int, Chains] = {}
        self._layers: dict[tuple[int, bool], Layer] = {}
        self._questions: dict[float, LayerQueries] = {}

    def changed(self, rows: ArrayLike, columns: ArrayLike, values: ArrayLike) -> "Screen":
        """Set some squares free (True) or blocked (False), in place, much faster than a new screen; returns itself.

        Everything asked of the screen afterwards is as of a new screen of the changed squares. Crossing numbers, chain
        numbers and passages given out before no longer hold.

        Raises
        ------
        ValueError
            When a square lies outside, the three do not match, or no square would be left free (nothing changes then).
        """
        where = checked_squares(rows, columns, values, self.shape)
        state, words, old = self._skeletons[1]
        bones = change_squares(self._square, state, old, *where)
        self._skeletons = {1: self._survey_changed(*where) if bones is None else (state, words, bones)}
        self._chains, self._layers, self._questions = {}, {}, {}
        for name in ("clearance", "skeleton", "pathgraph", "pathgraph_arrays", "_walls"):
            self.__dict__.pop(name, None)
        return self

    @property
    def free(self) -> Bools:
        """(rows, columns) bool, True where a point may be."""
        return self._square[1:-1, 1:-1] > 0

    @cached_property
    def clearance(self) -> NDArray[np.float64]:
        """(rows, columns): distance from each square's centre to the nearest square that is not free, 0 on those."""
        return 0.5 * np.sqrt(self._square[1:-1, 1:-1], dtype=np.float64)

    @cached_property
    def skeleton(self) -> Bools:
        """(rows, columns) bool: thin, with as many components and holes as the free space."""
        from geometry.skeleton.thinning import thin_skeleton

        return thin_skeleton(self._square, self._skeleton_at(1)[0])

    @cached_property
    def pathgraph(self) -> "networkx.MultiGraph[int]":
        """Junctions and ends as nodes, chains as edges (see networkx_export.py for what they carry)."""
        return self.pathgraph_for(0.0)

    def pathgraph_for(self, radius: float) -> "networkx.MultiGraph[int]":
        """The pathgraph of a body: that of the squares whose clearance is at least its radius."""
        from geometry.skeleton.networkx_export import networkx_graph

        return networkx_graph(self._new_arrays(radius))

    @cached_property
    def pathgraph_arrays(self) -> PathgraphArrays:
        """The same pathgraph in arrays."""
        return self.pathgraph_arrays_for(0.0)

    def pathgraph_arrays_for(self, radius: float) -> PathgraphArrays:
        """The pathgraph of a body in arrays."""
        arrays = self._new_arrays(radius)
        for array in arrays:
            array.flags.writeable = False
        return arrays

    def _new_arrays(self, radius: float) -> PathgraphArrays:
        """Return the pathgraph of a body in new arrays."""
        state, _, bones = self._skeleton_at(level_of(radius))
        return pathgraph_arrays(self._square, state, bones)

    def routes(
        self,
        start: Point,
        goal: ArrayLike | set[tuple[int, int]],
        k: int = 3,
        radius: float = 0.0,
        avoid: Iterable[Passage] = (),
        word: Sequence[int] | None = None,
    ) -> list[Route]:
        """Topologically distinct tight routes, shortest first; an empty list when there is none.

        Parameters
        ----------
        start : (x, y)
        goal : (x, y), or (rows, columns) array of bool, or set of squares (column, row)
            Of a set any square will do: a route ends where that makes it shortest.
        k : int
            How many at most. Routes pass no junction of the pathgraph twice, but for the shortest of all, which for
            a point and from 2 on comes first.
        radius : float
            Of a round body about the point, in squares. It moves from centre to centre of squares that are at least
            so far from all walls, and straight between its ends and the centres of theirs; there is no route where
            it has no room for that.
        avoid : passages
            Routes must not lead through these: there are some exactly within each of ``parts(avoid)``.
        word : crossing numbers
            Only the route of this signature (which may wind as it likes), whatever k and avoid.

        Raises
        ------
        ValueError
            When start or goal lie outside the screen or in a blocked square or are none, the word is not of this
            screen, k is no number of routes or radius none of squares.
        """
        check_count(k)
        questions = self._ask(radius)
        begin = self._checked(start, "start")
        if isinstance(goal, tuple) and len(goal) == 2 and isinstance(goal[0], float):  # by far the most frequent
            end = self._checked(goal, "goal")
        else:
            area = checked_goal(goal, self.shape)
            if area is not None:
                return routes_to_area(questions, begin, area, k, tuple(avoid))
            end = self._checked(np.asarray(goal, np.float64).tolist(), "goal")
        if not (questions.admits(begin) and questions.admits(end)):
            return []
        if word is None:
            return questions.to_point(begin, end, k, tuple(avoid))
        symbols = word_of_crossings(questions.layer.runs, (*begin, *end), word)
        return [] if symbols is None else [questions.of_word(begin, end, symbols)]

    def shortest(self, start: Point, goal: Point) -> Route | None:
        """The shortest route of all, at any angle; None when there is none. Its clearance and chains are not known."""
        begin, end = self._checked(start, "start"), self._checked(goal, "goal")
        return self._ask(0.0).shortest(begin, end)

    def loops(self, start: Point, around: ArrayLike, k: int = 1, radius: float = 0.0) -> list[Route]:
        """Closed tight routes that wind once, counter-clockwise, about blocked squares; shortest first.

        Parameters
        ----------
        start : (x, y)
            Where every loop begins and ends.
        around : (rows, columns) array of bool
            The blocked squares, of one object. No loops when it is part of the outer wall.
        k, radius
            As for ``routes``.
        """
        mask = np.asarray(around)
        if mask.shape != self.shape or mask.dtype != np.bool_ or not mask.any():
            raise ValueError(f"around must be a bool array of shape {self.shape} with a square in it")
        if (mask & self.free).any():
            raise ValueError("around must not hold free squares")
        check_count(k)
        questions = self._ask(radius)
        begin = self._checked(start, "start")
        return questions.loops(begin, mask, k) if questions.admits(begin) else []

    def tighten(self, route: Route, radius: float = 0.0) -> Route:
        """The locally shortest route of the same class, between the same ends.

        Raises
        ------
        ValueError
            When the route leaves free space.
        """
        questions = self._ask(radius)
        word = word_of_line(questions.layer.runs, route.points.tolist())
        start, goal = (self._checked(route.points[k].tolist(), "the route's end") for k in (0, -1))
        return questions.of_word(start, goal, word)

    def passages(self, pinch: float = DOOR) -> list[Passage]:
        """The necks of free space, by place (see necks.py).

        pinch : only those on both sides of which the floor is at least so many times as wide.
        """
        return find_passages(self._walls, pinch)

    def narrows(self, passage: Passage, spare: float) -> set[tuple[int, int]]:
        """The squares (column, row) about a passage where lines from wall to wall are at most so much longer than it.

        spare : in squares (see narrow_stretches.py).
        """
        return narrow_squares(self._walls, passage, spare)

    @cached_property
    def _walls(self) -> Walls:
        """The floor between the corners of its walls."""
        return find_walls(self.free)

    def parts(self, passages: Iterable[Passage]) -> Labels:
        """(rows, columns) int: the number of the part of the floor, cut along the passages' mouths, or 0.

        0 on blocked squares, on those whose centres lie on a mouth, and between two mouths (see partition.py).
        """
        return find_parts(self.free, passages)

    def _checked(self, point: Point, name: str) -> tuple[float, float]:
        """A point in a free square."""
        try:
            x, y = map(float, point)
        except (TypeError, ValueError):
            raise ValueError(f"{name} must be a point (x, y), not {point!r}") from None
        if not (0.0 <= x <= self.shape[1] and 0.0 <= y <= self.shape[0]):
            raise ValueError(f"{name} ({x}, {y}) lies outside the screen of {self.shape[1]} x {self.shape[0]} squares")
        if self._square.item(int(y) + 1, int(x) + 1) == 0:
            raise ValueError(f"{name} ({x}, {y}) lies in a blocked square")
        return x, y

    def _rent(self, kind: type[np.int16] | type[np.int32]) -> None:
        """Have memory for squared clearances of that kind."""
        self._tenant = Tenant()
        self._square, self._words = take_buffers(self._tenant, (self.shape[0] + 2, self.shape[1] + 2), kind)

    def _survey(self, grid: Bools) -> tuple[States, Words, SkeletonGraph]:
        """Measure all clearances and find the skeleton and pathgraph of free squares."""
        state, words = new_state(self._square.shape, self._words)
        survey(grid, self._square, state, words)
        return state, words, contract(self._square, state, words)

    def _survey_changed(self, rows: Ints, columns: Ints, values: Bools) -> tuple[States, Words, SkeletonGraph]:
        """The same with some squares changed."""
        grid = self.free
        grid[rows, columns] = values
        kind = type_of_squares(grid)
        if self._square.dtype < kind:
            self._rent(kind)
        return self._survey(grid)

    def _skeleton_at(self, level: int) -> tuple[States, Words, SkeletonGraph]:
        """The skeleton and pathgraph of the squares of at least that level."""
        found = self._skeletons.get(level)
        if found is None:
            state, words = new_state(self._square.shape)
            found = state, words, find_bones(self._square, level, state, words)
            self._skeletons[level] = found
        return found

    def _chains_at(self, level: int) -> Chains:
        """The same pathgraph with the cells of its chains."""
        found = self._chains.get(level)
        if found is None:
            state, _, bones = self._skeleton_at(level)
            found = self._chains[level] = find_chains(bones, state)
        return found

    def _ask(self, radius: float) -> LayerQueries:
        """What answers questions for a body of that radius."""
        found = self._questions.get(radius)
        if found is None:
            key = level_of(radius), radius > 0.0
            if key not in self._layers:
                state, chains = self._skeleton_at(key[0])[0], self._chains_at(key[0])
                self._layers[key] = find_layer(self._square, key[0], key[1], state, chains)
            found = self._questions[radius] = LayerQueries(self._layers[key], key[0], radius)
        return found


def checked_grid(free: ArrayLike) -> Bools:
    """The free squares as an array, or an error that says what is wrong with them."""
    grid = np.asarray(free)
    if grid.ndim != 2:
        raise ValueError(f"free must have two dimensions (rows, columns), not {grid.ndim}")
    if grid.dtype != np.bool_:
        raise ValueError(f"free must be an array of bool, not of {grid.dtype}")
    if max(grid.shape) > 32766:
        raise ValueError(f"free must not be larger than 32766 squares a side, not {grid.shape}")
    if not grid.any():
        raise ValueError("free has no free square")
    return grid


def check_count(k: int) -> None:
    """An error unless k is a number of routes."""
    if not isinstance(k, Integral) or k < 1:
        raise ValueError(f"k must be a whole number and at least 1, but is {k!r}")


def checked_squares(
    rows: ArrayLike, columns: ArrayLike, values: ArrayLike, shape: tuple[int, int]
) -> tuple[Ints, Ints, Bools]:
    """Rows, columns and values as arrays of one length, each square once (the last value counts)."""
    i, j = (np.atleast_1d(np.asarray(v)).ravel() for v in (rows, columns))
    value = np.asarray(values)
    if len(i) == len(j) == value.size == 0:
        return np.zeros(0, np.int32), np.zeros(0, np.int32), np.zeros(0, np.bool_)
    if value.dtype != np.bool_ or len(i) != len(j) or value.size not in (1, len(i)):
        raise ValueError("rows, columns and values must have one length, and values be True or False")
    if i.dtype.kind not in "iu" or j.dtype.kind not in "iu":
        raise ValueError("rows and columns must be whole numbers")
    if len(i) and not (i.min() >= 0 and i.max() < shape[0] and j.min() >= 0 and j.max() < shape[1]):
        raise ValueError(f"a changed square lies outside the screen of {shape[0]} rows and {shape[1]} columns")
    values = np.full(len(i), value.item()) if value.size == 1 else value.ravel()
    order = np.sort(i.astype(np.int64) * shape[1] + j)
    if (order[1:] == order[:-1]).any():
        last = {(a, b): v for a, b, v in zip(i.tolist(), j.tolist(), values.tolist(), strict=True)}
        i, j = np.array(list(last)).T
        values = np.array(list(last.values()))
    return i.astype(np.int32), j.astype(np.int32), values
