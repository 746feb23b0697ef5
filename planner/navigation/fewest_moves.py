"""Routes of the fewest straight moves, for a robot that carries objects and counts commands, not squares of way.

A route along walls bends at every corner of theirs. Often one straight move reaches some square of the subgoal, or two
moves do, and the detour costs little. It costs least where unseen squares come into sight at the turn.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from utak.geometry.kernels.arrays import Bools, Square
from utak.geometry.raster.line_of_sight import straight
from utak.planner.navigation.subgoals import Subgoal
from utak.planner.navigation.walks import PlannedRoute
from utak.planner.screen.moves import CARRYING_PACE, one_move_squares
from utak.planner.screen.projection import CostMaps, SquareIndices
from utak.planner.subgoal_kind import SubgoalKind

MOVE_COST, SQUARE_COST = 20.0, 0.3  # the cost of a move, and of each square of its way, in squares (tuned)
SEEN_SQUARE_VALUE = 0.05  # squares of way that an unseen square in sight from the turn is worth (tuned)
ASSUMED_MOVES = 3  # the number of moves that is assumed for a route of more than two
MAX_TRIED_SQUARES = 8  # squares of a subgoal to which two moves are sought (tuned: more take time and gain little)


class FewestMoves:
    """The squares that one or two straight moves reach from where the robot stands; computed at first use."""

    def __init__(self, cost_maps: CostMaps, telling: Bools | None = None) -> None:
        """Make an empty store for these cost maps and where the robot stands in them."""
        # telling : (rows, columns) bool, where a halt feels what must be felt sooner or later; None for none.
        self._cost_maps = cost_maps
        self._bonus = (np.zeros(cost_maps.safe.shape) if telling is None else MOVE_COST * telling).ravel()
        self._reached: dict[tuple[int, bool], Bools] = {}  # by the greatest length, and whether to inspect an object
        self._turns: dict[tuple[str, bytes], Square | None] = {}  # by the kind and the squares of the subgoal

    def priced(self, subgoals: Sequence[Subgoal]) -> list[Subgoal]:
        """Return the subgoals, in order, with prices by their number of moves, in squares of way."""
        return [self._priced(subgoal) for subgoal in subgoals]

    def way(self, subgoal: Subgoal) -> PlannedRoute | None:
        """Return the first move to a subgoal that one or two moves reach, as a route of two squares."""
        # These are the robot's square and where the move ends, (column, row) on the arrays of the view; they need not
        # be neighbours. Returns None for all other subgoals, and when the robot is there.
        here, near = self._cost_maps.here, self._met(subgoal)
        if len(near):
            there: Square | None = self._square(int(near[(self._cost_maps.far(near) - self._bonus[near]).argmin()]))
        else:
            there = self._turning(subgoal)
        return None if there is None or there == here else PlannedRoute((here, there), math.dist(here, there), 0.0, 0)

    @property
    def _far(self) -> NDArray[np.int32]:
        """The distance of each square from the robot, in fifths of squares; -1 where no way is sure."""
        return self._cost_maps.distances[0].ravel()

    def _priced(self, subgoal: Subgoal) -> Subgoal:
        """Return a subgoal whose price, with its way, comes to the cost of its moves, in squares (see `priced`)."""
        reached = self._cost_maps.nearest(subgoal.squares) if len(subgoal.squares) else None
        if reached is None or subgoal.felt:  # halts have the number of their moves
            return subgoal
        near = self._met(subgoal)
        if len(near):
            subgoal, reached, moves = subgoal._replace(squares=near), self._cost_maps.nearest(near) or reached, 1
        else:
            turning = reached.level == 0 and self._turning(subgoal) is not None
            moves = 2 if turning else ASSUMED_MOVES
        return subgoal._replace(price=subgoal.price + MOVE_COST * moves - (1 - SQUARE_COST) * reached.cost)

    def _met(self, subgoal: Subgoal) -> SquareIndices:
        """Return the squares of a subgoal that one move reaches, in their order."""
        near: SquareIndices = subgoal.squares[self._first(subgoal.kind).ravel()[subgoal.squares]]
        return near

    def _first(self, kind: str) -> Bools:
        """Return all squares that one move reaches, (rows, columns) bool, by the kind of the subgoal."""
        key = CARRYING_PACE.most(kind, self._cost_maps.model), kind == SubgoalKind.INSPECT
        if key not in self._reached:
            self._reached[key] = one_move_squares(self._cost_maps, kind)
        return self._reached[key]

    def _turning(self, subgoal: Subgoal) -> Square | None:
        """Return the square where the first of two moves to a subgoal ends; None when two moves do not reach it."""
        key = (subgoal.kind, subgoal.squares.tobytes())
        if key not in self._turns:
            self._turns[key] = self._best_turn(subgoal)
        return self._turns[key]

    def _best_turn(self, subgoal: Subgoal) -> Square | None:
        """Search the turn of least way, less the worth of the unseen squares in sight from it."""
        # None when two moves do not reach any of at most MAX_TRIED_SQUARES squares of the subgoal that a sure way leads
        # to.
        cost_maps, passable = self._cost_maps, CARRYING_PACE.passable(self._cost_maps, subgoal.kind)
        sure = subgoal.squares[(self._far[subgoal.squares] >= 0) & passable.ravel()[subgoal.squares]]
        nearest = sure[np.argsort(self._far[sure], kind="stable")]
        if len(nearest):
            nearest = nearest[np.unique(np.linspace(0, len(nearest) - 1, MAX_TRIED_SQUARES).astype(int))]
        (x, y), best, found = cost_maps.here, np.inf, None
        first, longest = self._first(subgoal.kind), CARRYING_PACE.longest_by_kind[subgoal.kind]
        for end in nearest.tolist():
            column, row = self._square(end)
            rows, columns = np.nonzero(straight(passable, column, row, longest, first))
            if len(rows):
                lengths = np.hypot(rows - y, columns - x) + np.hypot(rows - row, columns - column)
                lengths = lengths - SEEN_SQUARE_VALUE * cost_maps.information_gain[rows, columns]
                lengths -= self._bonus.reshape(first.shape)[rows, columns]
                if lengths.min() < best:
                    best, k = lengths.min(), lengths.argmin()
                    found = (int(columns[k]), int(rows[k]))
        return found

    def _square(self, flat: int) -> Square:
        """Return the square (column, row) of a flat index (row * columns + column) on the arrays of the view."""
        row, column = divmod(flat, self._cost_maps.safe.shape[1])
        return column, row
