"""Goal verification and active perception: looks that make sure before the robot commits itself or claims something.

They make sure of an object before it is carried, of the orientation of the frame, of a passage that is said to be too
narrow, and of beliefs that the last impression contradicts. Each is a list of subgoals, one of which is gone to first;
[] where there is nothing to make sure of.
"""

import math
from dataclasses import replace
from itertools import islice

import numpy as np

from utak.geometry.kernels.arrays import XY, Bools
from utak.kb.language.terms import Fact
from utak.kb.world.model import Node, WorldModel
from utak.kb.world.rooms import MIN_DOOR_CONFIDENCE, rooms_of
from utak.planner.carrying.infeasibility import Infeasibility
from utak.planner.goals.bounds import unfelt_bounds
from utak.planner.goals.robot_goals import robot_stands_on
from utak.planner.navigation.subgoals import Subgoal
from utak.planner.screen.projection import dilate
from utak.planner.sights import frontiers
from utak.planner.situation import Situation
from utak.planner.subgoal_kind import SubgoalKind


class Verifier:
    """Remembers what the robot went to tell last, and which passages it has looked at again."""

    def __init__(self) -> None:
        """Remember nothing yet."""
        self.telling = ""  # what the robot went to tell last, in the words of senses.lp; "" for nothing
        self._rechecked: list[XY] = []  # passages that were looked at again, map frame

    def recheck_passage(self, refusal: Infeasibility, situation: Situation) -> list[Subgoal]:
        """Return a look from close by at a passage that is said to be too narrow, while the map is not sure."""
        # Returns [] when the map is sure, no passage is named, or it was looked at again already, within FOVEA_RANGE
        # squares.
        model = situation.model
        neck = None if model.view.sure else refusal.neck()
        if neck is None:
            return []
        where = (neck[0] + model.view.west, neck[1] + model.view.south)
        near = frontiers.fovea_squares(situation.cost_maps, *where)
        if robot_stands_on(near, model):
            self._rechecked.append(where)
        if any(math.dist(where, looked) <= frontiers.FOVEA_RANGE for looked in self._rechecked):
            return []
        return [Subgoal(SubgoalKind.INSPECT, near, "it is not sure that the passage is that narrow")]


def looks_at_contradiction(situation: Situation) -> list[Subgoal]:
    """Return a look from elsewhere when the last impression contradicts what is believed; [] when it does not."""
    # What contradicts was withdrawn, so the new impression agrees with the rest if that is right.
    model = situation.model
    if not model.contradicted:
        return []
    what = "what is seen differs from what is believed"
    return [Subgoal(SubgoalKind.INSPECT, *frontiers.viewpoint_of(situation.cost_maps, robot_square(model), what))]


def looks_again(node: Node, situation: Situation) -> list[Subgoal]:
    """Return a look at an object that may lie elsewhere, as others or contradictions have it; [] for no need."""
    model, squares = situation.model, situation.model.mask(node.patch)
    if node.looked_at_again:
        what = f"others may have moved {node.name} since it was seen"
    elif node.moved and not _is_looked_at(squares, model):
        what = f"{node.name} was not seen closely since looks differed"
    else:
        return []
    return _inspect(frontiers.viewpoint_of(situation.cost_maps, squares, what))


def _inspect(look: frontiers.Viewpoint) -> list[Subgoal]:
    """Return a look as a subgoal; [] where it cannot be had from any square."""
    return [Subgoal(SubgoalKind.INSPECT, *look)] if len(look.squares) else []


def _is_looked_at(squares: Bools, model: WorldModel) -> bool:
    """Return whether squares were looked at from close by since an impression contradicted the map, if any did."""
    # What was seen before may lie on squares of a map that has changed since.
    near: Bools = dilate(squares, frontiers.FOVEA_RANGE) & model.squares(model.looked_since)
    return model.looked_since == model.looked_from or bool(near.any())


def robot_square(model: WorldModel) -> Bools:
    """Return the mask of the square in which the robot stands, (rows, columns) bool on the arrays of the view."""
    return model.squares([(math.floor(model.place[0]), math.floor(model.place[1]))])


def check_elsewhere(goal: Fact, began: XY, covered: Bools, situation: Situation) -> list[Subgoal]:
    """Return what to see or feel next before something is said to be elsewhere than it began; [] when that is sure."""
    looks = unfelt_bounds(goal, began, covered, situation)
    # With something in hand, a push may show what is further away.
    nearest = islice(looks, 1 if situation.model.held is None else None)
    unseen = unseen_beyond_door(goal, began, covered, situation)
    return unseen or [Subgoal(SubgoalKind.INSPECT, *look) for look in nearest]


def unseen_beyond_door(goal: Fact, began: XY, covered: Bools, situation: Situation) -> list[Subgoal]:
    """Return where to see how wide the floor is beyond a door, before something is said to be there; [] if sure."""
    model, view = situation.model, situation.model.view
    if goal.name == "around":
        return []
    closed = view._replace(probability=np.where(view.seen, view.probability, 1.0).astype(np.float32))
    rooms = rooms_of(replace(model, view=closed), situation.rules, model.verge | ~view.seen)
    if (situation.goal_rooms(goal, began, rooms, MIN_DOOR_CONFIDENCE) & covered).any():
        return []
    rows, columns = np.nonzero(covered)

    def distance(look: frontiers.Viewpoint) -> float:
        """Return how far the nearest square of a viewpoint is from the mean of the covered squares, in squares."""
        there = np.unravel_index(look.squares, covered.shape)
        return float(np.hypot(there[0] - rows.mean(), there[1] - columns.mean()).min())

    nearest = min(frontiers.find_frontiers(situation.cost_maps, frontiers.VIEW_SPACING), key=distance, default=None)
    return [] if nearest is None else [Subgoal(SubgoalKind.INSPECT, *nearest)]
