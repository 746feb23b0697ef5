"""Utak at a corner: where in its square he halts, and how he makes sure of walls that lie askew.

A wall lies anywhere in the squares in which it was seen. From right beside the lines behind which these begin it is
within a square all the same. Walls that lie askew may meet further away: then Utak presses on towards where they do
until they stop him.
"""

import math

import numpy as np

from kb.body import Command, Move
from kb.world.corners import Corner, known_floor
from planner.goals.robot_goals import corner_side
from planner.screen.moves import halting, is_open, move_by
from planner.screen.projection import CostMaps
from planner.screen.sweeps import Square, squares_met
from planner.situation import Situation
from planner.stages import Stage

Place = tuple[float, float]
NEAR = 0.01  # squares from both lines of the corner's square at which Utak halts
STRAIGHT = 3  # squares beside a corner along which a wall is straight that does not lead out of the squares behind them
PRESS = 1.5  # squares: so far away may a wall be that lies in the next square, from wherever in his own he stands


class IntoCorner:
    """Leads Utak into a corner in whose square he stands, and remembers what was done there for that."""

    def __init__(self) -> None:
        self._done: set[tuple[Square, int, int]] = set()  # squares of the lattice, and the way of a move there
        self._pressing: Square | None = None  # square of the lattice of the corner into which he presses

    def pressing(self, stage: Stage, situation: Situation) -> bool:
        """Return whether Utak was pressed from the square of a corner of a stage towards its walls, and is there still.

        Where walls lie askew he then stands in a square of which these fill a part.
        """
        asked = [situation.corners[side] for side in map(corner_side, stage.own) if side in situation.corners]
        squares = [_on_lattice(corner, situation) for corner in asked]
        return self._pressing in squares and _near(self._pressing, _square(situation.model.place))

    def next(self, stage: Stage, situation: Situation) -> Command | None:
        """Return the next move into the corners that a stage is about; None when Utak is as near as can be."""
        model, here = situation.model, _square(situation.model.place)
        for side in () if is_open(model) else [side for side in map(corner_side, stage.own) if side]:
            corner = situation.corners[side]
            sx, sy = _ways(corner)
            x, y = halting_place(corner, situation)
            there = here == _on_lattice(corner, situation)
            if there and math.dist((x, y), model.place) > 2 * NEAR and self._first(here, 0, 0):
                return move_by(model, x - model.place[0], y - model.place[1])
            if there and lies_straight(corner, situation):
                continue
            for dx, dy in (sx, sy), (sx, 0), (0, sy):
                if self._first(here, dx, dy):
                    self._pressing = _on_lattice(corner, situation)
                    return move_by(model, PRESS * dx, PRESS * dy)
        return None

    def _first(self, square: Square, dx: int, dy: int) -> bool:
        """Return whether such a move was not made from a square yet, and note it."""
        known = (square, dx, dy) in self._done
        self._done.add((square, dx, dy))
        return not known


def _square(place: Place) -> Square:
    """Return the square of the lattice in which a point lies."""
    return math.floor(place[0]), math.floor(place[1])


def _on_lattice(corner: Corner, situation: Situation) -> Square:
    """Return the square of the lattice that has a corner."""
    return corner.square[0] + situation.model.view.west, corner.square[1] + situation.model.view.south


def _near(one: Square | None, other: Square) -> bool:
    """Return whether two squares are at most as far from each other as a press leads."""
    return one is not None and max(abs(one[0] - other[0]), abs(one[1] - other[1])) <= math.ceil(PRESS)


def halting_place(corner: Corner, situation: Situation) -> Place:
    """Return where in the square of a corner Utak halts: the point of the lattice right beside its outer lines."""
    view, (column, row), (sx, sy) = situation.model.view, corner.square, _ways(corner)
    return view.west + column + 0.5 + sx * (0.5 - NEAR), view.south + row + 0.5 + sy * (0.5 - NEAR)


def halted(command: Command | None, stage: Stage, situation: Situation) -> Command | None:
    """Return a move that ends in the square of a corner that a stage is about so that it ends right beside its walls.

    Moves that would lead over other squares then, and all other commands, stay as they are.
    """
    side = next((side for side in map(corner_side, stage.own) if side), "")
    if not isinstance(command, Move) or not side or side not in situation.corners or is_open(situation.model):
        return command
    place = halting_place(situation.corners[side], situation)
    return halting(command, place, situation.model) if _leads_to(place, situation.cost_maps) else command


def lies_straight(corner: Corner, situation: Situation) -> bool:
    """Return whether both walls of a corner lie along the lattice, as far as their squares tell."""
    floor = np.pad(known_floor(situation.model), STRAIGHT + 1)
    column, row = (number + STRAIGHT + 1 for number in corner.square)
    sx, sy = _ways(corner)
    inward = np.arange(STRAIGHT)
    along, up = (row, column - sx * inward), (row - sy * inward, column)
    behind, beside = (row + sy, column - sx * inward), (row - sy * inward, column + sx)
    return bool(floor[along].all() and floor[up].all() and not floor[behind].any() and not floor[beside].any())


def _ways(corner: Corner) -> tuple[int, int]:
    """Return on which sides of its square the walls of a corner are: 1 for the greater x or y, -1 for the lesser."""
    return (1 if corner.point[0] > corner.square[0] else -1), (1 if corner.point[1] > corner.square[1] else -1)


def _leads_to(place: Place, cost_maps: CostMaps) -> bool:
    """Return whether the straight line from Utak to a point of the lattice stays on squares that are safe."""
    view, here = cost_maps.model.view, cost_maps.model.place_on_view
    there = (place[0] - view.west, place[1] - view.south)
    return all(cost_maps.safe[row, column] for column, row in squares_met(here, there))
