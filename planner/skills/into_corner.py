"""The robot in a corner: where in its square it halts, and how it makes sure of walls that lie askew.

A wall lies anywhere in the squares in which it was seen. From right beside the lines behind which these squares begin,
it is within a square all the same. Walls that lie askew may meet further away: then the robot presses on towards the
point where they do, until they stop it.
"""

import math
from dataclasses import replace

import numpy as np

from utak.geometry.kernels.arrays import XY
from utak.kb.body import Move
from utak.kb.world.corners import Corner, known_floor
from utak.planner.decision import Decision, nothing_to_do
from utak.planner.goals.robot_goals import corner_side, wall_sides
from utak.planner.screen.moves import halt_exactly_at, move_to, orientation_is_uncertain
from utak.planner.screen.projection import CostMaps
from utak.planner.screen.sweeps import Square, squares_met
from utak.planner.situation import Situation
from utak.planner.stages import Stage

HALT_DISTANCE = 0.01  # squares from both lines of the corner's square at which the robot halts; a convention
STRAIGHT_LENGTH = 3  # squares beside a corner along which a wall is straight if it stays in its row; derived for 1 in 3
PRESS_LENGTH = 1.5  # squares: a wall in the next square may be so far away, from anywhere in the robot's own square


class IntoCorner:
    """Leads the robot into a corner in whose square it stands, and remembers the moves made there for that."""

    def __init__(self) -> None:
        """Remember no move yet."""
        self._done: set[tuple[Square, int, int]] = set()  # the square, map frame, and the signs of a move made there
        self._pressing: Square | None = None  # the square, map frame, of the corner into which the robot presses

    def is_pressing(self, stage: Stage, situation: Situation) -> bool:
        """Return whether the robot pressed on from the square of a corner of a stage, and is still there."""
        asked = [situation.corners[side] for side in map(corner_side, stage.own) if side in situation.corners]
        squares = [_map_square(corner, situation) for corner in asked]
        if self._pressing is None or self._pressing not in squares:
            return False
        here = _square_at(situation.model.place)
        return max(abs(there - at) for there, at in zip(self._pressing, here, strict=True)) <= math.ceil(PRESS_LENGTH)

    def next(self, stage: Stage, situation: Situation) -> Decision:
        """Return the next move into the corners of a stage, and remember it; nothing when it is as near as can be."""
        model, here = situation.model, _square_at(situation.model.place)
        for side in () if orientation_is_uncertain(model) else [side for side in map(corner_side, stage.own) if side]:
            corner = situation.corners[side]
            sx, sy = wall_sides(corner)
            x, y = halting_place(corner, situation)
            there = here == _map_square(corner, situation)
            if there and math.dist((x, y), model.place) > 2 * HALT_DISTANCE and self._note_first(here, 0, 0):
                return _into((x, y), stage, situation)
            if there and lies_straight(corner, situation):
                continue
            for dx, dy in (sx, sy), (sx, 0), (0, sy):
                if self._note_first(here, dx, dy):
                    self._pressing = _map_square(corner, situation)
                    end = model.place[0] + PRESS_LENGTH * dx, model.place[1] + PRESS_LENGTH * dy
                    return _into(end, stage, situation)
        return nothing_to_do("the robot is as near as it can be")

    def _note_first(self, square: Square, dx: int, dy: int) -> bool:
        """Note a move from a square, and return whether it is the first such move there."""
        known = (square, dx, dy) in self._done
        self._done.add((square, dx, dy))
        return not known


def _into(place: XY, stage: Stage, situation: Situation) -> Decision:
    """Return the move to a place in the square of a corner."""
    why = f"the walls of the corner may lie further away; {stage}"
    return Decision(move_to(place, situation.model), why)


def halting_place(corner: Corner, situation: Situation) -> XY:
    """Return where in the square of a corner the robot halts: the point right beside its outer lines."""
    view, (column, row), (sx, sy) = situation.model.view, corner.square, wall_sides(corner)
    return view.west + column + 0.5 + sx * (0.5 - HALT_DISTANCE), view.south + row + 0.5 + sy * (0.5 - HALT_DISTANCE)


def halt_beside_walls(decision: Decision, stage: Stage, situation: Situation) -> Decision:
    """Return a move that ends in the square of a stage's corner, changed to end right beside the walls."""
    # All other decisions are returned as they are, and so are moves that would then lead over squares that are not
    # safe.
    side = next((side for side in map(corner_side, stage.own) if side), "")
    if side not in situation.corners or orientation_is_uncertain(situation.model):
        return decision
    place = halting_place(situation.corners[side], situation)
    if not isinstance(decision.command, Move) or not _is_safe_line(place, situation.cost_maps):
        return decision
    return replace(decision, command=halt_exactly_at(decision.command, place, situation.model))


def lies_straight(corner: Corner, situation: Situation) -> bool:
    """Return whether both walls of a corner lie along the grid, as far as their squares tell."""
    floor = np.pad(known_floor(situation.model), STRAIGHT_LENGTH + 1)
    column, row = (number + STRAIGHT_LENGTH + 1 for number in corner.square)
    sx, sy = wall_sides(corner)
    inward = np.arange(STRAIGHT_LENGTH)
    along, up = (row, column - sx * inward), (row - sy * inward, column)
    behind, beside = (row + sy, column - sx * inward), (row - sy * inward, column + sx)
    return bool(floor[along].all() and floor[up].all() and not floor[behind].any() and not floor[beside].any())


def _square_at(place: XY) -> Square:
    """Return the square (x, y) of the map frame in which a point (x, y) of it lies."""
    return math.floor(place[0]), math.floor(place[1])


def _map_square(corner: Corner, situation: Situation) -> Square:
    """Return the square (x, y) of the map frame in which a corner of the floor lies: the one of floor."""
    return corner.square[0] + situation.model.view.west, corner.square[1] + situation.model.view.south


def _is_safe_line(place: XY, cost_maps: CostMaps) -> bool:
    """Return whether the straight line from the robot to a place (x, y) stays on safe squares."""
    view, here = cost_maps.model.view, cost_maps.model.place_on_view
    there = (place[0] - view.west, place[1] - view.south)
    return all(cost_maps.safe[row, column] for column, row in squares_met(here, there))
