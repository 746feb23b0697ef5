"""Carrying something somewhere: the plan that is being followed, checked after every look, and made anew when it fails.

A plan is a sequence of legs: walk to a place, grasp, push and turn, let go. It is kept while the object and Utak are
where it says and while the squares that it needs are still believed free.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from geometry.carrying import Inside, Leg
from geometry.ends import End
from geometry.legs import verified
from geometry.rigid import Motion, Rotate, Translate
from geometry.yard import Yard
from kb.body import DIRECTIONS, Command, Grasp, Move, Push, Release, Turn
from kb.lattice import CENTRE
from kb.worldmodel import Node, Patch, WorldModel
from planner.destinations import Situation
from planner.exploring import Lookout, inspection, sight_of
from planner.haulage import Haul, Hauler, Refusal, Request, swept_squares
from planner.landing import in_view, lands, region_of
from planner.screen import Squares

Mask = NDArray[np.bool_]
Place = tuple[float, float]
NEAR = 1e-6  # squares: within which Utak is where a plan says
STILL = 2  # level of certainty of squares over which a plan is not made, but kept
ALIKE = 1e-3  # squares^2 by which an object may lie otherwise than a plan says
TIGHTEST = 2  # times that a thing stood against something unawares before he takes it elsewhere
MOST_PLANS = 40  # in one task
LOOSE = 0.02  # squares by which he may stand elsewhere in his square before a turn needs more room
FARTHER = 4.0  # squares that a plan must bring a thing on to be begun before all of its way is seen
NOWHERE = 0.1  # squares: who comes no further is where he was


@dataclass(frozen=True)
class Act:
    """A command to give now."""

    command: Command
    why: str


@dataclass(frozen=True)
class Go:
    """A square to walk to (a flat index on the view's arrays). place : its middle, on the lattice, where to halt."""

    square: Squares
    place: Place
    why: str


@dataclass(frozen=True)
class See:
    """Squares that must be seen before the way over them is relied upon."""

    lookout: Lookout


Advice = Act | Go | See | Refusal


@dataclass(frozen=True)
class Course:
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


@dataclass
class Carrier:
    """Carries things, one plan after the other.

    began : where each thing's middle lay when it was first spoken of. failed : holds by which a thing did not move, in
    its own frame. missed : plans that did not lead where they should, with the thing in hand, since this was last set.
    """

    pull: bool = True
    began: dict[str, Place] = field(default_factory=dict)
    failed: dict[str, tuple[Place, ...]] = field(default_factory=dict)
    missed: int = 0

    def __post_init__(self) -> None:
        self._hauler = Hauler(self.pull)
        self._course: Course | None = None
        self._plans = 0
        self._tight: dict[str, int] = {}  # how often a thing stood against something unawares
        self._went_on: Place | None = None  # where a plan was last made that goes on with the hold he has

    @property
    def begun(self) -> bool:
        """Has he begun to carry anything?"""
        return self._plans > 0

    def began_at(self, node: Node) -> Place:
        """The point of the lattice where the middle of an object lay at first."""
        middle = node.polygon.centroid
        return self.began.setdefault(node.name, (middle.x, middle.y))

    def advise(self, node: Node, ends: Mapping[str, End], situation: Situation) -> Advice:
        """What to do to carry an object to one of several ends."""
        model = situation.model
        course = self._kept(ends if self._course is None or self._course.name == node.name else None, situation)
        if course is None:
            self.missed += self._course is not None and self._course.grasped and not self._course.ended
            last = self._course.target if self._course is not None else ""
            failure = self._failure(model)
            if failure is not None:
                return failure
            found = self._planned(node, ends, last, situation)
            if isinstance(found, See | Refusal):
                return found
            course = found
        self._course = course
        return self._next(course, model)

    def gone_on(self, node: Node, situation: Situation) -> Act | None:
        """The next command of the plan under way for what he holds, if the world is still as it says."""
        if self._course is None or self._course.name != node.name or situation.model.held != node.name:
            return None
        course = self._kept(None, situation)
        if course is None:
            return None
        advice = self._next(course, situation.model)
        return advice if isinstance(advice, Act) else None

    # -- keeping a plan --------------------------------------------------------------------------

    def _kept(self, ends: Mapping[str, End] | None, situation: Situation) -> Course | None:
        """The plan under way, if the world is still as it says.

        ends : where it must lead; None where the plan is to clear the way for another thing.
        """
        course, model = self._course, situation.model
        node = None if course is None else model.object(course.name)
        if course is None or node is None or course.ended:
            return None
        if node.polygon is None or (course.place is not None and not _stands(model, course.place)):
            return None
        if course.grasped and model.held != course.name:
            return None
        if not course.grasped and situation.screens.nearest(_square(course.legs[0].place, model)) is None:
            return None
        free = situation.screens.free(max(course.level, STILL)) | model.mask(node.patch)
        if not free[model.mask_within(course.needed)].all():
            return None
        if shapely.symmetric_difference(node.polygon, course.polygon).area < ALIKE:
            if ends is None or course.target in ends:
                return course
            end = in_view(_carried(course), situation)
        else:
            end = None if node.stuck else _led(course, node, free, situation)
        if end is None or (ends is not None and not any(lands(goal, end) for goal in ends.values())):
            return None
        return replace(course, polygon=node.polygon)

    def _failure(self, model: WorldModel) -> Advice | None:
        """What to do when a motion with something in hand did not move it: try once more, then from elsewhere."""
        held = model.object(model.held) if model.held else None
        course, self._course = self._course, None
        if held is None and course is not None and course.grasped:
            self._blame(model.object(course.name), model)
        if held is None or not held.stuck:
            return None
        if held.moved:
            self._tight[held.name] = self._tight.get(held.name, 0) + 1
        if held.stuck > 1 or self._tight.get(held.name, 0) > TIGHTEST:
            self._blame(held, model)
        return Act(Release(), f"{held.name} did not move")

    def _blame(self, node: Node | None, model: WorldModel) -> None:
        """Do not take a thing again from where Utak stands now."""
        if node is None or node.polygon is None:
            return
        middle = node.polygon.centroid
        away = np.array([[model.place[0] - middle.x, model.place[1] - middle.y]])
        x, y = Rotate(-node.turned, (0.0, 0.0)).points(away)[0]
        self.failed[node.name] = (*self.failed.get(node.name, ()), (float(x), float(y)))

    # -- making one ------------------------------------------------------------------------------

    def _planned(self, node: Node, ends: Mapping[str, End], last: str, situation: Situation) -> Course | See | Refusal:
        request = self._request(node, ends, last, situation.model)
        haul = self._hauler.find(request, situation)
        if isinstance(haul, Refusal):
            return haul
        if haul.aside:
            cleared = (self._clearing(other, haul, situation) for other in situation.model.objects)
            first = next((found for found in cleared if found is not None), None)
            if first is None:
                unclear = (situation.model.object(name) for name in haul.aside)
                looks = (
                    inspection(situation.screens, o, touch=False, chance=1.0, arrive=False)
                    for o in unclear
                    if o is not None and o.open
                )
                look = next((look for look in looks if len(look.squares)), None)
                if look is not None:
                    return See(look)
                why = f"{haul.aside[0]} is in the way of {node.name}, and cannot be cleared"
                return Refusal(False, lambda: why)
            node, haul = first
        seen = self._seen(haul, node, situation)
        if seen is not None:
            clear = _clear_part(haul, node, situation)
            if clear is None:
                return seen
            haul = clear
        self._went_on = situation.model.place if request.held else None
        self._plans += 1
        if self._plans > MOST_PLANS:
            return Refusal(False, lambda: f"gave up after {MOST_PLANS} plans")
        return _course(haul, node, situation.model)

    def _request(self, node: Node, ends: Mapping[str, End], last: str, model: WorldModel) -> Request:
        """What to ask for. He goes on with the hold he has, but not where doing so has brought him nowhere."""
        nowhere = self._went_on is not None and math.dist(self._went_on, model.place) < NOWHERE
        held = model.held == node.name and not nowhere
        tight = self._tight.get(node.name, 0) + (model.lattice.woke != CENTRE and max(model.leeway) > LOOSE)
        return Request(node, ends, self._avoided(node), last, tight, held)

    def _clearing(self, other: Node, haul: Haul, situation: Situation) -> tuple[Node, Haul] | None:
        """A way to carry a thing off the squares that a plan needs, if it stands there and there is one."""
        if other.name not in haul.aside or other.polygon is None or other.movable == 0:
            return None
        room = situation.screens.free(0) | situation.model.mask(other.patch)
        request = self._request(other, {"away": Inside(region_of(room & ~haul.swept))}, "", situation.model)
        found = self._hauler.find(request, situation)
        return (other, found) if isinstance(found, Haul) and found.plan.legs and not found.aside else None

    def _avoided(self, node: Node) -> tuple[Place, ...]:
        """The holds that failed, as the object lies now."""
        turn = Rotate(node.turned, (0.0, 0.0))
        holds = turn.points(np.array(self.failed.get(node.name, ())).reshape(-1, 2))
        return tuple((float(x), float(y)) for x, y in holds)

    def _seen(self, haul: Haul, node: Node, situation: Situation) -> See | None:
        """What must be looked at before a plan is begun, if a look may tell more.

        What a turn meets leaves the thing at an angle that is hard to tell; a push is just shorter.
        """
        model = situation.model
        risky = haul.turned if haul.level == 0 else haul.swept
        unsure = risky & ~situation.screens.safe & ~model.mask(node.patch)
        if not unsure.any():
            return None
        lookout = sight_of(situation.screens, unsure, f"the way for {node.name} is not clear")
        return See(lookout) if len(lookout.squares) else None

    # -- following it ----------------------------------------------------------------------------

    def _next(self, course: Course, model: WorldModel) -> Act | Go:
        """The next command of a plan."""
        leg = course.legs[0]
        if not course.grasped:
            return self._taking(course, leg, model)
        if not leg.motions:
            self._course = replace(course, legs=course.legs[1:], grasped=False, place=None)
            return Act(Release(), f"{course.name} is where it shall be let go")
        motion = leg.motions[0]
        polygon = motion.carry(course.polygon)
        x, y = model.place
        place = (x + motion.dx, y + motion.dy) if isinstance(motion, Translate) else (x, y)
        rest = replace(leg, motions=leg.motions[1:])
        self._course = replace(course, legs=(rest, *course.legs[1:]), polygon=polygon, place=place)
        return Act(_command(motion, model), f"{course.name} is brought to {course.target}")

    def _taking(self, course: Course, leg: Leg, model: WorldModel) -> Act | Go:
        """Walk to where the object is taken, and take it."""
        here = _stands(model, leg.place)
        if here and model.held == course.name:
            self._course = replace(course, grasped=True, place=leg.place)
            return self._next(self._course, model)
        if model.held is not None:
            return Act(Release(), f"{model.held} is let go, to be taken elsewhere")
        if here:
            self._course = replace(course, grasped=True, place=leg.place)
            return Act(
                Grasp(_direction(leg, course, model)), f"{course.name} is taken to be carried to {course.target}"
            )
        if model.view.locate(*model.place) == model.view.locate(*leg.place):
            dx, dy = leg.place[0] - model.place[0], leg.place[1] - model.place[1]
            return Act(Move(*model.lattice.to_utak(dx, dy)), "to the middle of the square")
        return Go(_square(leg.place, model), leg.place, f"{course.name} can be taken from there")


def _clear_part(haul: Haul, node: Node, situation: Situation) -> Haul | None:
    """As much of a plan as needs no look first, when that brings the thing on; else None.

    From there he sees what he could only have seen after a walk there and back.
    """
    first, *others = haul.plan.legs
    pushes = [motion for motion in first.motions if isinstance(motion, Translate)]
    if others or len(pushes) < len(first.motions):  # turns and new holds depend on what is not seen
        return None
    yard = Yard(situation.screens.safe | situation.model.mask(node.patch))
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
    swept, _ = swept_squares(plan, start, situation.model.labels.shape)
    return replace(haul, plan=plan, swept=swept)


def _longest_push(yard: Yard, shape: Any, place: Place, push: Translate) -> Translate | None:
    """The longest part of a push by whole squares, or nearly the same way, that is free."""
    steps = math.floor(math.hypot(push.dx, push.dy))
    parts = ((round(push.dx * n / steps), round(push.dy * n / steps)) for n in range(steps - 1, 0, -1))
    pushes = (Translate(float(dx), float(dy)) for dx, dy in parts)
    return next((part for part in pushes if yard.lets(shape, place, part)), None)


def _course(haul: Haul, node: Node, model: WorldModel) -> Course:
    """A plan in the frame of the lattice."""
    west, south = model.view.west, model.view.south
    legs = tuple(replace(leg, place=(leg.place[0] + west, leg.place[1] + south)) for leg in haul.plan.legs)
    needed = Patch(west, south, haul.swept)
    return Course(node.name, haul.target, node.polygon, legs, needed, haul.level)


def _carried(course: Course) -> Any:
    """Where what is left of a plan leads when all is as it says."""
    polygon = course.polygon
    for motion in (motion for leg in course.legs for motion in leg.motions):
        polygon = motion.carry(polygon)
    return polygon


def _led(course: Course, node: Node, free: Mask, situation: Situation) -> Any:
    """Where what is left of a plan leads from where the object really lies, or None when something is in the way."""
    west, south = situation.model.view.west, situation.model.view.south
    first, *others = course.legs
    legs = [first if course.place is None else replace(first, place=course.place), *others]
    placed = [replace(leg, place=(leg.place[0] - west, leg.place[1] - south)) for leg in legs]
    return verified(Yard(free), in_view(node.polygon, situation), placed)


def _square(place: Place, model: WorldModel) -> Squares:
    """The square in which a point of the lattice lies, as the one flat index."""
    row, column = model.view.locate(*place)
    return np.array([row * model.labels.shape[1] + column])


def _stands(model: WorldModel, place: Place) -> bool:
    return math.dist(model.place, place) < NEAR


def _direction(leg: Leg, course: Course, model: WorldModel) -> str:
    """The compass point of the square by which the object is taken, or of another one that it covers."""
    node = model.object(course.name)
    assert node is not None
    x, y = math.floor(leg.place[0]), math.floor(leg.place[1])
    ways, covered = model.lattice.directions(), node.patch.squares()
    other = [direction for (dx, dy), direction in ways.items() if (x + dx, y + dy) in covered]
    return ways.get(leg.direction_square) or next(iter(other), DIRECTIONS[0])


def _command(motion: Motion, model: WorldModel) -> Command:
    if isinstance(motion, Rotate):
        return Turn(motion.degrees)
    return Push(*model.lattice.to_utak(motion.dx, motion.dy))
