"""Where to look next by the fewest straight moves, for who counts commands and not squares: who carries things.

A way along walls bends at every corner of theirs. Often an aim can be met at a square that a single move leads to, or
by way of one that a second move leads on from, and little is lost by going further; least of all where something comes
into sight by that.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from geometry.raster.line_of_sight import straight
from planner.navigation.routes import PlannedRoute
from planner.navigation.subgoals import Subgoal
from planner.screen.moves import HURRY, one_move
from planner.screen.projection import CostMaps, Squares
from planner.screen.sweeps import Square

MOVE, WAY = 20.0, 0.3  # what a move, and a square of way, cost
SHOWN = 0.05  # squares of way that it is worth when a square never seen comes into sight where he turns
MANY_MOVES = 3  # that a way with more bends than one is taken for
TRIED = 8  # squares of an aim to which two moves are sought
Mask = NDArray[np.bool_]


class FewestMoves:
    """What straight moves lead to from where Utak stands, worked out when it is asked for."""

    def __init__(self, cost_maps: CostMaps) -> None:
        self._cost_maps = cost_maps
        self._reached: dict[tuple[int, bool], Mask] = {}  # by how far a move leads at most, and whether up to a thing
        self._by_way: dict[tuple[str, bytes], Square | None] = {}

    def priced(self, subgoals: Sequence[Subgoal]) -> list[Subgoal]:
        """The aims: met at a square that one move leads to, where there is such a one; others dearer."""
        return [self._priced(subgoal) for subgoal in subgoals]

    def way(self, subgoal: Subgoal) -> PlannedRoute | None:
        """The way to an aim that one or two moves lead to, as its first move; None for others.

        What clearance it has is not measured: 0.
        """
        here, near = self._cost_maps.here, self._met(subgoal)
        if len(near):
            there: Square | None = self._square(int(near[self._cost_maps.far(near).argmin()]))
        else:
            there = self._turning(subgoal)
        return None if there is None or there == here else PlannedRoute((here, there), math.dist(here, there), 0.0, 0)

    @property
    def _far(self) -> NDArray[np.int32]:
        """(squares,): the way to each square of the screen, in fifths of squares; -1 where none surely leads."""
        return self._cost_maps.distances[0].ravel()

    def _priced(self, subgoal: Subgoal) -> Subgoal:
        """An aim whose way and price come to what its moves cost."""
        reached = self._cost_maps.nearest(subgoal.squares) if len(subgoal.squares) else None
        if reached is None:
            return subgoal
        near = self._met(subgoal)
        if len(near):
            subgoal, reached, moves = subgoal._replace(squares=near), self._cost_maps.nearest(near) or reached, 1
        else:
            turning = reached.level == 0 and self._turning(subgoal) is not None
            moves = 2 if turning else MANY_MOVES
        return subgoal._replace(price=subgoal.price + MOVE * moves - (1 - WAY) * reached.cost)

    def _met(self, subgoal: Subgoal) -> Squares:
        """The squares of an aim to which one move leads."""
        near: Squares = subgoal.squares[self._first(subgoal.kind).ravel()[subgoal.squares]]
        return near

    def _first(self, kind: str) -> Mask:
        """(rows, columns): the squares to which one move leads, by the kind of its aim."""
        key = HURRY.most(kind, self._cost_maps.model), kind == "inspect"
        if key not in self._reached:
            self._reached[key] = one_move(self._cost_maps, kind)
        return self._reached[key]

    def _turning(self, subgoal: Subgoal) -> Square | None:
        """Where the first of two moves to an aim ends, if two will do: on a short way, and where he sees more."""
        key = (subgoal.kind, subgoal.squares.tobytes())
        if key not in self._by_way:
            self._by_way[key] = self._found(subgoal)
        return self._by_way[key]

    def _found(self, subgoal: Subgoal) -> Square | None:
        cost_maps, ground = self._cost_maps, HURRY.ground(self._cost_maps, subgoal.kind)
        sure = subgoal.squares[(self._far[subgoal.squares] >= 0) & ground.ravel()[subgoal.squares]]
        nearest = sure[np.argsort(self._far[sure], kind="stable")]
        some = nearest[np.unique(np.linspace(0, len(nearest) - 1, TRIED).astype(int))] if len(nearest) else nearest
        (x, y), best, found = cost_maps.here, np.inf, None
        first = self._first(subgoal.kind)
        for end in some.tolist():
            column, row = self._square(end)
            rows, columns = np.nonzero(straight(ground, column, row, HURRY.longest[subgoal.kind], first))
            if len(rows):
                lengths = np.hypot(rows - y, columns - x) + np.hypot(rows - row, columns - column)
                lengths = lengths - SHOWN * cost_maps.gain[rows, columns]
                if lengths.min() < best:
                    best, k = lengths.min(), lengths.argmin()
                    found = (int(columns[k]), int(rows[k]))
        return found

    def _square(self, flat: int) -> Square:
        row, column = divmod(flat, self._cost_maps.safe.shape[1])
        return column, row
