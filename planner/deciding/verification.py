"""Goal verification and active perception: looks that make sure before the robot commits itself or claims something.

They make sure of a passage that is said to be too narrow, of beliefs that the last impression contradicts, and of what
bounds the floor by which something is elsewhere than it began. What of that is told first, senses.lp chooses.
"""

import math
from collections.abc import Iterable, Iterator
from dataclasses import replace
from itertools import chain

import numpy as np

from utak.geometry.kernels.arrays import XY, Bools
from utak.kb.language.terms import Fact
from utak.kb.world.model import Node, WorldModel
from utak.kb.world.rooms import MIN_DOOR_CONFIDENCE, rooms_of
from utak.planner.carrying.infeasibility import Infeasibility
from utak.planner.carrying.preconditions import Doubt
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


def doubts_of_belief(nodes: Iterable[Node], situation: Situation) -> Iterator[Doubt]:
    """Yield what is open of all that is believed, and of some things, before goals about these count as attained."""
    # What contradicts was withdrawn, so the new impression agrees with the rest if that is right.
    model = situation.model
    if model.contradicted:
        what = "what is seen differs from what is believed"
        yield _claimed("differs", frontiers.viewpoint_of(situation.cost_maps, robot_square(model), what), situation)
    for node in nodes:
        squares = model.mask(node.patch)
        if node.looked_at_again:
            what = f"others may have moved {node.name} since it was seen"
        elif node.moved and not _is_looked_at(squares, model):
            what = f"{node.name} was not seen closely since looks differed"
        else:
            continue
        yield _claimed(f"again({node.name})", frontiers.viewpoint_of(situation.cost_maps, squares, what), situation)


def _claimed(name: str, look: frontiers.Viewpoint, situation: Situation) -> Doubt:
    """Return what is open of what goals rest on that are about to count as attained."""
    # What is in hand may shut the robot in: then it is let go.
    must = name == "differs" or situation.model.held is not None
    return Doubt(name, look, (f"claimed({name})",), must)


def _is_looked_at(squares: Bools, model: WorldModel) -> bool:
    """Return whether squares were looked at from close by since an impression contradicted the map, if any did."""
    # What was seen before may lie on squares of a map that has changed since.
    near: Bools = dilate(squares, frontiers.FOVEA_RANGE) & model.squares(model.looked_since)
    return model.looked_since == model.looked_from or bool(near.any())


def robot_square(model: WorldModel) -> Bools:
    """Return the mask of the square in which the robot stands, (rows, columns) bool on the arrays of the view."""
    return model.squares([(math.floor(model.place[0]), math.floor(model.place[1]))])


def doubts_of_bounds(
    goals: Iterable[Fact], name: str, began: XY, covered: Bools, situation: Situation
) -> Iterator[Doubt]:
    """Yield what is open of the bounds by which something is elsewhere than it began, as some goals have it."""
    for goal in goals:
        looks = chain(
            unseen_beyond_door(goal, began, covered, situation), unfelt_bounds(goal, began, covered, situation)
        )
        if (nearest := next(looks, None)) is not None:
            yield _claimed(f"bounds({name})", nearest, situation)
            return


def unseen_beyond_door(goal: Fact, began: XY, covered: Bools, situation: Situation) -> Iterator[frontiers.Viewpoint]:
    """Yield where to see how wide the floor is beyond a door, before something is said to be there; nothing if sure."""
    model, view = situation.model, situation.model.view
    if goal.name == "around":
        return
    closed = view._replace(probability=np.where(view.seen, view.probability, 1.0).astype(np.float32))
    rooms = rooms_of(replace(model, view=closed), situation.rules, model.verge | ~view.seen)
    if (situation.goal_rooms(goal, began, rooms, MIN_DOOR_CONFIDENCE) & covered).any():
        return
    rows, columns = np.nonzero(covered)

    def distance(look: frontiers.Viewpoint) -> float:
        """Return how far the nearest square of a viewpoint is from the mean of the covered squares, in squares."""
        there = np.unravel_index(look.squares, covered.shape)
        return float(np.hypot(there[0] - rows.mean(), there[1] - columns.mean()).min())

    seen_from = frontiers.find_frontiers(situation.cost_maps, frontiers.VIEW_SPACING)
    yield from [min(seen_from, key=distance)] if seen_from else []
