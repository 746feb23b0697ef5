"""Bounds: pieces of what bounds the floor on which a goal rests, and which may be things.

What bounds a room, or hides a place, is taken for verge as it was seen. A thing that stands against the verge looks the
same; only its colour tells. So a goal that would not hold if such a piece were a thing is not settled until that is
felt.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from utak.geometry.kernels.arrays import XY, Bools
from utak.kb.language.terms import Fact
from utak.kb.world.model import WorldModel
from utak.kb.world.rooms import MIN_DOOR_CONFIDENCE, rooms_of
from utak.planner.goals.robot_goals import hidden_from
from utak.planner.screen.projection import shift_mask
from utak.planner.sights.frontiers import WHAT_IS_FELT, Viewpoint, viewpoint_of, with_place
from utak.planner.situation import Situation


@dataclass(frozen=True, eq=False)
class BoundsByTheWay:
    """Deferred viewpoints: where it is felt, on the way, whether a goal holds."""

    goal: Fact  # as for `unfelt_bounds`
    began: XY
    covered: Bools  # the squares where the thing may end
    situation: Situation

    def viewpoints(self) -> tuple[Viewpoint, ...]:
        """Compute where the pieces are felt that the goal rests on; () for none."""
        return tuple(unfelt_bounds(self.goal, self.began, self.covered, self.situation))


def unfelt_bounds(goal: Fact, began: XY, covered: Bools, situation: Situation) -> Iterator[Viewpoint]:
    """Yield where to feel each piece of the bounds on which a goal rests, or to see it better, the nearest first."""
    # Nothing when it is settled.
    # If such a piece were a thing, alone or together with all others that may be one, the goal would not hold. To tell
    # this of a piece takes long, so it is told of the next one when that is asked for.
    pieces = [(mask, _felt_from(mask, situation)) for mask in situation.model.unfelt_pieces]
    if not pieces:
        return
    fails_without, none = _failure(goal, began, covered, situation), True
    for mask, look in sorted(pieces, key=lambda piece: _cost(piece[1], situation)):
        if fails_without(mask):
            none = False
            yield from [look] * bool(len(look.squares))
    if none and fails_without(np.any([mask for mask, _ in pieces], axis=0)):
        yield from (look for _, look in pieces if len(look.squares))


def _cost(look: Viewpoint, situation: Situation) -> float:
    """Return what the way to a viewpoint costs, in squares; infinite where none is known."""
    found = situation.cost_maps.nearest(look.squares)
    return math.inf if found is None else found.cost


def telling_squares(situation: Situation) -> Bools:
    """Return the squares from which pieces beside doors are felt that may be things: (rows, columns) bool."""
    # What is carried goes through some door, and its goal rests on what bounds that.
    model, ends = situation.model, np.zeros(situation.model.labels.shape, np.bool_)
    for x, y in (end for door in situation.rooms.doors for end in (door.a, door.b)):
        ends[max(math.floor(y) - 1, 0) : math.floor(y) + 2, max(math.floor(x) - 1, 0) : math.floor(x) + 2] = True
    pieces = [mask for mask in model.unfelt_pieces if (mask & ends).any()] if ends.any() else []
    return _touching(np.any(pieces, axis=0), model) if pieces else np.zeros_like(ends)


def _touching(mask: Bools, model: WorldModel) -> Bools:
    """Return the squares from which a square of a mask is felt: (rows, columns) bool."""
    touching = np.zeros_like(mask)
    for columns, rows in model.frame.directions():
        touching |= shift_mask(mask, -columns, -rows)
    return touching


def _felt_from(mask: Bools, situation: Situation) -> Viewpoint:
    """Return the floor where the robot did not look yet, and from which it feels some squares; else sees them best."""
    model, cost_maps = situation.model, situation.cost_maps
    floor = cost_maps.floor if model.held is None else model.space
    squares = np.flatnonzero(_touching(mask, model) & floor & ~cost_maps.looked_from)
    if len(squares) or model.told[mask].all():
        return Viewpoint(squares, with_place(cost_maps, np.flatnonzero(mask), WHAT_IS_FELT))
    return viewpoint_of(cost_maps, mask, WHAT_IS_FELT)


def _failure(goal: Fact, began: XY, covered: Bools, situation: Situation) -> Callable[[Bools], bool]:
    """Return a function that tells whether a goal fails if the squares of a mask are no verge."""
    model = situation.model
    if goal.name == "around":
        hidden = covered & hidden_from(model.verge, model, began)
        return lambda mask: bool((hidden & ~hidden_from(model.verge & ~mask, model, began)).any())

    def is_in_no_next_room(mask: Bools) -> bool:
        """Return whether none of the covered squares is in a next room without the verge of a mask."""
        rooms = rooms_of(model, situation.rules, model.verge & ~mask)
        return not (situation.goal_rooms(goal, began, rooms, MIN_DOOR_CONFIDENCE) & covered).any()

    return is_in_no_next_room
