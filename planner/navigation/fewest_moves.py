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

    def __init__(self, screens: CostMaps) -> None:
        self._screens = screens
        self._reached: dict[tuple[int, bool], Mask] = {}  # by how far a move leads at most, and whether up to a thing
        self._by_way: dict[tuple[str, bytes], Square | None] = {}

    def priced(self, aims: Sequence[Subgoal]) -> list[Subgoal]:
        """The aims: met at a square that one move leads to, where there is such a one; others dearer."""
        return [self._priced(aim) for aim in aims]

    def way(self, aim: Subgoal) -> PlannedRoute | None:
        """The way to an aim that one or two moves lead to, as its first move; None for others.

        What clearance it has is not measured: 0.
        """
        here, near = self._screens.here, self._met(aim)
        if len(near):
            there: Square | None = self._square(int(near[self._screens.far(near).argmin()]))
        else:
            there = self._turning(aim)
        return None if there is None or there == here else PlannedRoute((here, there), math.dist(here, there), 0.0, 0)

    @property
    def _far(self) -> NDArray[np.int32]:
        """(squares,): the way to each square of the screen, in fifths of squares; -1 where none surely leads."""
        return self._screens.distances[0].ravel()

    def _priced(self, aim: Subgoal) -> Subgoal:
        """An aim whose way and price come to what its moves cost."""
        reached = self._screens.nearest(aim.squares) if len(aim.squares) else None
        if reached is None:
            return aim
        near = self._met(aim)
        if len(near):
            aim, reached, moves = aim._replace(squares=near), self._screens.nearest(near) or reached, 1
        else:
            turning = reached.level == 0 and self._turning(aim) is not None
            moves = 2 if turning else MANY_MOVES
        return aim._replace(price=aim.price + MOVE * moves - (1 - WAY) * reached.cost)

    def _met(self, aim: Subgoal) -> Squares:
        """The squares of an aim to which one move leads."""
        near: Squares = aim.squares[self._first(aim.kind).ravel()[aim.squares]]
        return near

    def _first(self, kind: str) -> Mask:
        """(rows, columns): the squares to which one move leads, by the kind of its aim."""
        key = HURRY.most(kind, self._screens.model), kind == "inspect"
        if key not in self._reached:
            self._reached[key] = one_move(self._screens, kind)
        return self._reached[key]

    def _turning(self, aim: Subgoal) -> Square | None:
        """Where the first of two moves to an aim ends, if two will do: on a short way, and where he sees more."""
        key = (aim.kind, aim.squares.tobytes())
        if key not in self._by_way:
            self._by_way[key] = self._found(aim)
        return self._by_way[key]

    def _found(self, aim: Subgoal) -> Square | None:
        screens, ground = self._screens, HURRY.ground(self._screens, aim.kind)
        sure = aim.squares[(self._far[aim.squares] >= 0) & ground.ravel()[aim.squares]]
        nearest = sure[np.argsort(self._far[sure], kind="stable")]
        some = nearest[np.unique(np.linspace(0, len(nearest) - 1, TRIED).astype(int))] if len(nearest) else nearest
        (x, y), best, found = screens.here, np.inf, None
        first = self._first(aim.kind)
        for end in some.tolist():
            column, row = self._square(end)
            rows, columns = np.nonzero(straight(ground, column, row, HURRY.longest[aim.kind], first))
            if len(rows):
                lengths = np.hypot(rows - y, columns - x) + np.hypot(rows - row, columns - column)
                lengths = lengths - SHOWN * screens.gain[rows, columns]
                if lengths.min() < best:
                    best, k = lengths.min(), lengths.argmin()
                    found = (int(columns[k]), int(rows[k]))
        return found

    def _square(self, flat: int) -> Square:
        row, column = divmod(flat, self._screens.safe.shape[1])
        return column, row
