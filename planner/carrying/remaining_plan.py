"""The remaining plan: what is left of a manipulation plan, in the map frame.

It is checked against the world after every impression, may start where the robot stands, and may be cut to the part
that leads over squares known to be free.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import shapely

from utak.geometry.kernels.arrays import XY, Bools
from utak.geometry.manipulation.goals import End
from utak.geometry.manipulation.legs import shifted, verified
from utak.geometry.manipulation.plan_carrying import Leg
from utak.geometry.manipulation.workspace import Workspace
from utak.geometry.motion.se2 import Motion, Translate
from utak.kb.body import DIRECTIONS
from utak.kb.mapping.patch import Patch
from utak.kb.world.model import Node, WorldModel
from utak.planner.carrying.manipulation_oracle import ManipulationPlan, swept_squares
from utak.planner.decision import RobotStep
from utak.planner.goals.placement import forbidden_squares, meets_any_end, to_view_frame
from utak.planner.screen.moves import is_at
from utak.planner.screen.projection import square_index
from utak.planner.situation import Situation
from utak.planner.steps import of_legs

KEPT_LEVEL = 2  # certainty level of squares over which a plan is kept, though a surer one was asked for; a convention
AREA_TOLERANCE = 1e-3  # squares^2 by which an object may lie otherwise than a plan says: rounding of outlines
MIN_PREFIX = 4.0  # squares that a push must lead to be begun before all of its way is seen; tuned on random worlds


@dataclass(frozen=True)
class RemainingPlan:
    """The remaining part of a manipulation plan, in squares, map frame."""

    name: str  # of the object that is carried
    target: str  # the name of the end that it leads to
    polygon: Any  # the outline (shapely Polygon) that the object must have now for the plan to hold
    # What is left to do; the first one is under way. A leg is a walk, a grasp, pushes and turns, and a release.
    legs: tuple[Leg, ...]
    needed: Patch  # the squares that must stay free
    level: int  # the certainty level at which they were free, 0 the surest
    place: XY | None = None  # (x, y) where the robot must stand now for the plan to hold; None while it walks
    grasped: bool = False  # whether the robot should hold the object

    @property
    def ended(self) -> bool:
        """Return whether nothing is left but to release the object, or nothing at all."""
        return not self.legs or (self.grasped and len(self.legs) == 1 and not self.legs[0].motions)

    @property
    def end(self) -> Any:
        """Return the outline (shapely Polygon, squares, map frame) of the object after the plan."""
        polygon = self.polygon
        for motion in (motion for leg in self.legs for motion in leg.motions):
            polygon = motion.carry(polygon)
        return polygon

    def steps(self, model: WorldModel) -> tuple[RobotStep, ...]:
        """Return the steps of the robot that are left, in order."""
        return of_legs(self.name, self.legs, self.grasped, model)


def begin_plan(found: ManipulationPlan, node: Node, model: WorldModel) -> RemainingPlan:
    """Return all of a manipulation plan that was just made, as a remaining plan in the map frame."""
    west, south = model.view.west, model.view.south
    legs = tuple(shifted(leg, west, south) for leg in found.plan.legs)
    needed = Patch(west, south, found.swept)
    return RemainingPlan(node.name, found.target, node.polygon, legs, needed, found.level)


def revalidate(plan: RemainingPlan, ends: Mapping[str, End] | None, situation: Situation) -> RemainingPlan | None:
    """Return a plan, with the object where it is now believed to lie, if the plan still holds; else None."""
    # Where the object lies otherwise than it says, the motions are verified anew from there.
    # None when it only clears the way for another object.
    model = situation.model
    node = model.object(plan.name)
    if node is None or node.polygon is None or plan.ended:
        return None
    if plan.place is not None and not is_at(model, plan.place):
        return None
    if plan.grasped and model.held != plan.name:
        return None
    if not plan.grasped and situation.cost_maps.nearest(square_index(plan.legs[0].place, model)) is None:
        return None
    free = _kept_squares(plan, node, situation)
    if not free[model.mask(plan.needed)].all():
        return None
    if shapely.symmetric_difference(node.polygon, plan.polygon).area < AREA_TOLERANCE:
        if ends is None or plan.target in ends:
            return plan
        end = to_view_frame(plan.end, situation)
    else:
        end = None if node.stuck else _end_outline(plan, node, free, situation)
    if end is None or (ends is not None and not meets_any_end(ends, end)):
        return None
    return replace(plan, polygon=node.polygon)


def start_from_robot(plan: RemainingPlan, ends: Mapping[str, End], situation: Situation) -> RemainingPlan | None:
    """Return a plan whose first grasp is made where the robot stands, not in the middle of that square."""
    # Returns None when it would not lead to one of the ends so.
    # None is returned for {}.
    model = situation.model
    node = model.object(plan.name)
    assert node is not None
    first, *others = plan.legs
    here = shifted(first, model.place[0] - first.place[0], model.place[1] - first.place[1])
    near = replace(plan, legs=(here, *others))
    end = _end_outline(near, node, _kept_squares(plan, node, situation), situation)
    return near if end is not None and meets_any_end(ends, end) else None


def safe_prefix(found: ManipulationPlan, node: Node, situation: Situation) -> ManipulationPlan | None:
    """Return as much of a plan as leads over squares known to be free; None when that brings the object hardly on."""
    # From its end the robot sees what it could otherwise only see by a walk there and back. Plans with turns or several
    # grasps have no such part, for these depend on what is not seen. It is the pushes of the first leg, in order, up to
    # the first that is not free over safe squares; of that one the longest free part, if any.
    first, *others = found.plan.legs
    pushes = [motion for motion in first.motions if isinstance(motion, Translate)]
    if others or len(pushes) < len(first.motions):
        return None
    workspace = Workspace(situation.cost_maps.safe | situation.model.mask(node.patch))
    start = to_view_frame(node.polygon, situation)
    shape, place = start, first.place
    safe: list[Motion] = []
    for push in pushes:
        part = push if workspace.lets(shape, place, push) else _longest_part(workspace, shape, place, push)
        if part is None:
            break
        safe.append(part)
        shape = part.carry(shape)
        place = place[0] + part.dx, place[1] + part.dy
        if part is not push:
            break
    if math.dist(first.place, place) < MIN_PREFIX:
        return None
    plan = replace(found.plan, legs=(replace(first, motions=tuple(safe)),))
    return replace(found, plan=plan, swept=swept_squares(plan, start, situation.model.labels.shape))


@dataclass(frozen=True)
class PlanOperations:
    """The functions on remaining plans that the executor uses; tests pass their own."""

    # Makes a remaining plan of a manipulation plan
    begin_plan: Callable[[ManipulationPlan, Node, WorldModel], RemainingPlan] = begin_plan
    # Returns a plan if it still holds, else None
    revalidate: Callable[[RemainingPlan, Mapping[str, End] | None, Situation], RemainingPlan | None] = revalidate
    # Returns a plan with its first grasp where the robot stands, or None
    start_from_robot: Callable[[RemainingPlan, Mapping[str, End], Situation], RemainingPlan | None] = start_from_robot
    # Returns the part of a plan over squares known to be free, or None
    safe_prefix: Callable[[ManipulationPlan, Node, Situation], ManipulationPlan | None] = safe_prefix


def grasp_direction(plan: RemainingPlan, model: WorldModel) -> str | None:
    """Return the compass direction in which the first leg of a plan grasps its object; None where it is not felt."""
    node, leg = model.object(plan.name), plan.legs[0]
    assert node is not None
    x, y = math.floor(leg.place[0]), math.floor(leg.place[1])
    ways, covered = model.frame.directions(), node.patch.squares()
    planned = ways.get(leg.direction_square)
    others = [direction for (dx, dy), direction in ways.items() if (x + dx, y + dy) in covered]
    directions = [planned, *others] if planned is not None else others
    if not model.touch:
        return next(iter(directions), None)
    felt = [
        direction
        for direction, colour in zip(DIRECTIONS, model.touch, strict=True)
        if colour is not None and node.colour in (None, colour)
    ]
    there = [direction for direction in directions if direction in felt]
    return next(iter(there if node.colour is None else [*there, *felt]), None)


def _longest_part(workspace: Workspace, shape: Any, place: XY, push: Translate) -> Translate | None:
    """Return the longest part of a push, rounded to whole squares, that is free; None for none."""
    # Parts are tried from the longest on, in steps of one square, so it is at least about one square long.
    steps = math.floor(math.hypot(push.dx, push.dy))
    parts = ((round(push.dx * n / steps), round(push.dy * n / steps)) for n in range(steps - 1, 0, -1))
    pushes = (Translate(float(dx), float(dy)) for dx, dy in parts)
    return next((part for part in pushes if workspace.lets(shape, place, part)), None)


def _kept_squares(plan: RemainingPlan, node: Node, situation: Situation) -> Bools:
    """Return the squares that a plan made before may still cross, (rows, columns) bool on the arrays of the view."""
    free = situation.cost_maps.free(max(plan.level, KEPT_LEVEL)) | situation.model.mask(node.patch)
    return free & ~forbidden_squares(node, situation)


def _end_outline(plan: RemainingPlan, node: Node, free: Bools, situation: Situation) -> Any:
    """Return the outline after a plan from where the object really lies, view frame; None if it is blocked."""
    # Also None when a grasp would reach nothing.
    west, south = situation.model.view.west, situation.model.view.south
    first, *others = plan.legs
    legs = [first if plan.place is None else replace(first, place=plan.place), *others]
    return verified(
        Workspace(free), to_view_frame(node.polygon, situation), [shifted(leg, -west, -south) for leg in legs]
    )
