"""A screen: free and blocked squares, and what a point or a round body can do among them."""

from collections.abc import Sequence
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geometry.chains import Chains, Ints
from geometry.distance import Bools, count_columns, measure
from geometry.itinerary import OVERFLOW, Desk, itineraries, new_desk
from geometry.layer import Layer, find_chains, find_layer, level_of, new_state
from geometry.route import Route, read_answers
from geometry.skeleton import States, Words

Point = Sequence[float]
SPARE = 8  # ways over the pathgraph tried beyond those wanted, since the order changes when ropes are pulled tight


class Screen:
    """Free space on a grid of squares; a point passes between squares that share an edge, never through a mere corner.

    Parameters
    ----------
    free : (rows, columns) array of bool
        True where a point may be. Everything outside is blocked.

    Raises
    ------
    ValueError
        When ``free`` is not a two-dimensional array of truth values with at least one free square.
    """

    def __init__(self, free: ArrayLike) -> None:
        grid = checked_grid(free)
        rows, columns = grid.shape
        self.shape = (rows, columns)
        self._gap = np.empty((rows + 2, columns + 2), np.int16)
        self._square = np.empty((rows + 2, columns + 2), np.int32)
        sites = np.empty((2, columns + 3), np.int64)
        count_columns(grid, self._gap)
        measure(self._gap, self._square, sites[0], sites[1])
        self._skeletons: dict[int, tuple[States, Words, Chains]] = {}
        self._layers: dict[tuple[int, bool], Layer] = {}
        self._desks: dict[tuple[int, bool, int], Desk] = {}
        self._skeleton_at(1)

    @property
    def free(self) -> Bools:
        """(rows, columns) bool, True where a point may be."""
        return self._square[1:-1, 1:-1] > 0

    @cached_property
    def clearance(self) -> NDArray[np.float64]:
        """(rows, columns): distance from each square's centre to the nearest square that is not free, 0 on those."""
        return 0.5 * np.sqrt(self._square[1:-1, 1:-1])

    def routes(self, start: Point, goal: Point, k: int = 3, radius: float = 0.0) -> list[Route]:
        """Up to ``k`` topologically distinct tight routes, shortest first; none when the goal cannot be reached."""
        level, body = level_of(radius), radius > 0.0
        x, y = self._square_of(start, "start")
        u, v = self._square_of(goal, "goal")
        if self._square[y + 1, x + 1] < level or self._square[v + 1, u + 1] < level:
            return []
        layer = self._layer(level, body)
        wanted = 1 if k == 1 else k + SPARE
        if body:
            ends = (x + 0.5, y + 0.5, u + 0.5, v + 0.5)
        else:
            ends = (float(start[0]), float(start[1]), float(goal[0]), float(goal[1]))
        found, desk = self._solve(layer, ends, wanted, (level, body))
        return read_answers(desk.answers, found)[:k]

    def _solve(
        self, layer: Layer, ends: tuple[float, float, float, float], wanted: int, key: tuple[int, bool]
    ) -> tuple[int, Desk]:
        """Run a query, with more room when it needs more."""
        room = 1024
        while True:
            desk = self._desks.get((*key, wanted))
            if desk is None:
                desk = new_desk(len(layer.chains.node), len(layer.chains.length), wanted, room, NO_BARS)
                self._desks[(*key, wanted)] = desk
            found = itineraries(layer, ends, wanted, desk)
            if found != OVERFLOW:
                return found, desk
            room = 4 * desk.start.shape[0]
            del self._desks[(*key, wanted)]

    def _square_of(self, point: Point, name: str) -> tuple[int, int]:
        """Column and row of the free square that holds a point."""
        x, y = float(point[0]), float(point[1])
        if not (0.0 <= x <= self.shape[1] and 0.0 <= y <= self.shape[0]):
            raise ValueError(f"{name} ({x}, {y}) lies outside the screen of {self.shape[1]} x {self.shape[0]} squares")
        i, j = int(x), int(y)
        if self._square[j + 1, i + 1] > 0:
            return i, j
        raise ValueError(f"{name} ({x}, {y}) lies in a blocked square")

    def _skeleton_at(self, level: int) -> tuple[States, Words, Chains]:
        """The skeleton and pathgraph of the squares of at least that level."""
        found = self._skeletons.get(level)
        if found is None:
            state, words = new_state((self.shape[0] + 2, self.shape[1] + 2))
            found = state, words, find_chains(self._square, level, state, words)
            self._skeletons[level] = found
        return found

    def _layer(self, level: int, body: bool) -> Layer:
        """The layer for a body, made when it is first asked for."""
        layer = self._layers.get((level, body))
        if layer is None:
            state, _, chains = self._skeleton_at(level)
            layer = find_layer(self._square, level, body, state, chains)
            self._layers[level, body] = layer
        return layer


NO_BARS: Ints = np.zeros((0, 2), np.int32)


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
