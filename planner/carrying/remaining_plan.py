"""A course: what is left of a plan to carry something, in the frame of the lattice, and what may be done of it."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from geometry.manipulation.goals import End
from geometry.manipulation.legs import shifted, verified
from geometry.manipulation.plan_carrying import Leg
from geometry.manipulation.workspace import Workspace
from geometry.motion.se2 import Motion, Translate
from kb.body import DIRECTIONS
from kb.mapping.patch import Patch
from kb.world.model import Node, WorldModel
from planner.carrying.manipulation_oracle import ManipulationPlan, swept_squares
from planner.goals.placement import barred, in_view, lands_in_one
from planner.screen.projection import Squares
from planner.situation import Situation

Mask = NDArray[np.bool_]
Place = tuple[float, float]
NEAR = 1e-6  # squares: within which Utak is where a plan says
STILL = 2  # level of certainty of squares over which a plan is not made, but kept
ALIKE = 1e-3  # squares^2 by which an object may lie otherwise than a plan says
FARTHER = 4.0  # squares that a plan must bring a thing on to be begun before all of its way is seen


@dataclass(frozen=True)
class RemainingPlan:
    """What is left of a plan, in the frame of the lattice.

    name : of the object. polygon, place : where it and Utak must be now for the plan to hold; place None while he
    walks. legs : the first is under way; grasped tells whether he should hold the object.
    needed : squares that must stay free, level : of certainty at which they were.
    """

    name: str
    target: str
    polygon: Any
    legs: tuple[Leg, ...]
    needed: Patch
    level: int
    place: Place | None = None
    grasped: bool = False

    @property
    def ended(self) -> bool:
        """Is nothing left of it but to let go? That is done only when something else is wanted of his hand."""
        return not self.legs or (self.grasped and len(self.legs) == 1 and not self.legs[0].motions)

    @property
    def end(self) -> Any:
        """Where it leads when all is as it says."""
        polygon = self.polygon
        for motion in (motion for leg in self.legs for motion in leg.motions):
            polygon = motion.carry(polygon)
        return polygon


def course_of(haul: ManipulationPlan, node: Node, model: WorldModel) -> RemainingPlan:
    """The course of a plan that was just made."""
    west, south = model.view.west, model.view.south
    legs = tuple(shifted(leg, west, south) for leg in haul.plan.legs)
    needed = Patch(west, south, haul.swept)
    return RemainingPlan(node.name, haul.target, node.polygon, legs, needed, haul.level)


def followed(course: RemainingPlan, ends: Mapping[str, End] | None, situation: Situation) -> RemainingPlan | None:
    """A course, if the world is still as it says; None if it is not.

    ends : where it must lead; None where it only clears the way for another thing.
    """
    model = situation.model
    node = model.object(course.name)
    if node is None or node.polygon is None or course.ended:
        return None
    if course.place is not None and not stands(model, course.place):
        return None
    if course.grasped and model.held != course.name:
        return None
    if not course.grasped and situation.cost_maps.nearest(square_of(course.legs[0].place, model)) is None:
        return None
    free = _room(course, node, situation)
    if not free[model.mask_within(course.needed)].all():
        return None
    if shapely.symmetric_difference(node.polygon, course.polygon).area < ALIKE:
        if ends is None or course.target in ends:
            return course
        end = in_view(course.end, situation)
    else:
        end = None if node.stuck else _led(course, node, free, situation)
    if end is None or (ends is not None and not lands_in_one(ends, end)):
        return None
    return replace(course, polygon=node.polygon)


def from_here(course: RemainingPlan, ends: Mapping[str, End], situation: Situation) -> RemainingPlan | None:
    """A course, begun where he stands and not in the middle of that square; None when it does not lead there so."""
    model = situation.model
    node = model.object(course.name)
    assert node is not None
    first, *others = course.legs
    here = shifted(first, model.place[0] - first.place[0], model.place[1] - first.place[1])
    near = replace(course, legs=(here, *others))
    end = _led(near, node, _room(course, node, situation), situation)
    return near if end is not None and lands_in_one(ends, end) else None


def clear_part(haul: ManipulationPlan, node: Node, situation: Situation) -> ManipulationPlan | None:
    """As much of a plan as needs no look first, when that brings the thing on; else None.

    From there he sees what he could only have seen after a walk there and back.
    """
    first, *others = haul.plan.legs
    pushes = [motion for motion in first.motions if isinstance(motion, Translate)]
    if others or len(pushes) < len(first.motions):  # turns and new holds depend on what is not seen
        return None
    yard = Workspace(situation.cost_maps.safe | situation.model.mask(node.patch))
    start = in_view(node.polygon, situation)
    shape, place = start, first.place
    clear: list[Motion] = []
    for push in pushes:
        part = push if yard.lets(shape, place, push) else _longest_push(yard, shape, place, push)
        if part is None:
            break
        clear.append(part)
        shape = part.carry(shape)
        place = place[0] + part.dx, place[1] + part.dy
        if part is not push:
            break
    if math.dist(first.place, place) < FARTHER:
        return None
    plan = replace(haul.plan, legs=(replace(first, motions=tuple(clear)),))
    return replace(haul, plan=plan, swept=swept_squares(plan, start, situation.model.labels.shape))


def square_of(place: Place, model: WorldModel) -> Squares:
    """The square in which a point of the lattice lies, as the one flat index."""
    row, column = model.view.locate(*place)
    return np.array([row * model.labels.shape[1] + column])


def stands(model: WorldModel, place: Place) -> bool:
    """Does Utak stand just there, on the lattice?"""
    return math.dist(model.place, place) < NEAR


def _longest_push(yard: Workspace, shape: Any, place: Place, push: Translate) -> Translate | None:
    """The longest part of a push by whole squares, or nearly the same way, that is free."""
    steps = math.floor(math.hypot(push.dx, push.dy))
    parts = ((round(push.dx * n / steps), round(push.dy * n / steps)) for n in range(steps - 1, 0, -1))
    pushes = (Translate(float(dx), float(dy)) for dx, dy in parts)
    return next((part for part in pushes if yard.lets(shape, place, part)), None)


def _room(course: RemainingPlan, node: Node, situation: Situation) -> Mask:
    """(rows, columns): the squares over which a course may lead that was made before."""
    free = situation.cost_maps.free(max(course.level, STILL)) | situation.model.mask(node.patch)
    return free & ~barred(node, situation)


def _led(course: RemainingPlan, node: Node, free: Mask, situation: Situation) -> Any:
    """Where a course leads from where the object really lies, in the frame of the view; None when something is in the
    way."""
    west, south = situation.model.view.west, situation.model.view.south
    first, *others = course.legs
    legs = [first if course.place is None else replace(first, place=course.place), *others]
    return verified(Workspace(free), in_view(node.polygon, situation), [shifted(leg, -west, -south) for leg in legs])


def grasp_direction(leg: Leg, course: RemainingPlan, model: WorldModel) -> str | None:
    """The compass point by which the object is taken: that of the plan, or another by which it is felt; else None."""
    node = model.object(course.name)
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
