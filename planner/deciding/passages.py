"""Passages that fill no whole square: they look like wall, and are found by walking against it.

All floor is connected. So where floor is seen beyond walls, and no wall is left that may be a thing, one of them has an
opening. A straight walk on the right line leads through it.
"""

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from geometry.kernels.arrays import XY, Bools
from kb.world.model import WorldModel
from planner.advice import Go
from planner.deciding.stage_turn import StageTurn
from planner.decision import Decision, with_command
from planner.screen.moves import EDGE_OFFSET, move_to
from planner.screen.projection import CostMaps
from planner.sights.walls import EDGE_STEPS, MAX_THICK_WALL, floor_apart

LINES = (0.0, -EDGE_OFFSET, EDGE_OFFSET)  # squares from the middle of a row: at most EDGE_OFFSET apart, rows together
SAME_LINE = 1.0 - 2 * EDGE_OFFSET  # squares between the last line of a row and the first one of the next
PASSAGE_REASON = "floor is seen beyond the wall, so an opening that fills no whole square may be here"

Line = tuple[int, float]  # the number of the direction in EDGE_STEPS, and the place across it, in squares, map frame


class Passage(NamedTuple):
    """A straight walk from floor that is reached through wall to floor that is not; points (x, y) of the map frame."""

    line: Line
    square: int
    start: XY
    end: XY


class Passages:
    """Walks against walls behind which floor is seen, and remembers the lines on which it did."""

    def __init__(self) -> None:
        """Make one that tried nothing."""
        self._tried: set[Line] = set()

    def next(self, turn: StageTurn) -> Decision | None:
        """Return the next command to walk through wall to floor beyond it; None when no line is left.

        turn : the stage, what is believed, and the tools.
        """
        situation = turn.situation
        model, far = situation.model, situation.cost_maps.distances[0].ravel()
        left = [one for one in _passages(model, situation.cost_maps) if not self._is_tried(one.line)]
        for passage in sorted(left, key=lambda one: (int(far[one.square]), math.dist(one.start, model.place))):
            if math.dist(passage.start, model.place) < SAME_LINE / 2:
                self._tried.add(passage.line)
                return Decision(move_to(passage.end, model), f"{PASSAGE_REASON}; {turn.stage}")
            go = Go(np.array([passage.square]), passage.start, PASSAGE_REASON)
            walk = with_command(turn.pursuer.go(go, turn.stage, situation))
            if walk is not None:
                return walk
        return None

    def _is_tried(self, line: Line) -> bool:
        """Return whether a walk on a line, or right beside it, was tried."""
        return any(line[0] == number and abs(line[1] - across) <= SAME_LINE for number, across in self._tried)


def _passages(model: WorldModel, cost_maps: CostMaps) -> Iterator[Passage]:
    """Yield the walks that lead through at most MAX_THICK_WALL squares of wall, by direction and row."""
    reached, apart, view = cost_maps.floor, floor_apart(model, cost_maps.floor), model.view
    for number, (dx, dy) in enumerate(EDGE_STEPS):
        for row, column in np.argwhere(reached).tolist() if apart.any() else ():
            depth = _depth(row, column, (dx, dy), reached, apart)
            for line in LINES if depth else ():
                x, y = view.west + column + 0.5 + abs(dy) * line, view.south + row + 0.5 + abs(dx) * line
                end = x + dx * (depth + 1), y + dy * (depth + 1)
                yield Passage((number, y if dx else x), row * reached.shape[1] + column, (x, y), end)


def _depth(row: int, column: int, step: Sequence[int], reached: Bools, apart: Bools) -> int:
    """Return how many squares of wall lie between a square and floor apart in a direction; 0 for none, or too many."""
    for depth in range(MAX_THICK_WALL + 1):
        column, row = column + step[0], row + step[1]
        if not (0 <= row < apart.shape[0] and 0 <= column < apart.shape[1]) or reached[row, column]:
            return 0
        if apart[row, column]:
            return depth
    return 0
