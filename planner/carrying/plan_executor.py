"""Carrying something somewhere: the plan that is being followed, checked after every look, and made anew when it fails.

A plan is a sequence of legs: walk to a place, grasp, push and turn, let go. It is kept while the object and Utak are
where it says and while the squares that it needs are still believed free.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace

from geometry.manipulation.goals import End
from geometry.manipulation.plan_carrying import Inside, Leg
from geometry.motion.se2 import Motion, Rotate, Translate
from kb.body import Command, Grasp, Move, Push, Release, Turn
from kb.mapping.occupancy import OPEN
from kb.objects.held_object import is_whole
from kb.perception.frame import CENTRE
from kb.world.model import SPACE, Node, WorldModel
from planner.advice import Act, Go, See
from planner.carrying.infeasibility import Infeasibility
from planner.carrying.manipulation_oracle import ManipulationOracle, ManipulationPlan, Request
from planner.carrying.remaining_plan import (
    Place,
    RemainingPlan,
    clear_part,
    course_of,
    followed,
    from_here,
    grasp_direction,
    square_of,
    stands,
)
from planner.goals.placement import SURELY, Ends, drawn_out, region_of
from planner.screen.moves import is_open
from planner.screen.projection import Squares, grown
from planner.sights.frontiers import Viewpoint, by_touch, sight_of
from planner.sights.viewpoints import TAKE, inspection
from planner.situation import Situation
from planner.skills.failed_grasps import FailedGrasps
from planner.skills.take_along import by_way, lead, near, out
from planner.skills.unjam import drawn_back

TIGHTEST, SLIPPERY = 2, 4  # times that a thing stood against something unawares before he takes it elsewhere; who slips
MOST_PLANS = 40  # in one task
LOOSE = 0.02  # squares by which he may stand elsewhere in his square before a turn needs more room
OPEN_TURN, LOOSE_TURN = 2.5, 1.5  # commands that a turn counts for while it is open how the lattice, or he, lies
NOWHERE = 0.1  # squares: who comes no further is where he was
TEDIOUS = 8  # commands of a plan above which what is not clear about its way is looked at first
SIGHT = "sight"  # the target of a plan that brings a thing near to where he wants to look
ABOUT = 2  # squares beside the way of a plan within which more room would help


Advice = Act | Go | See | Infeasibility


@dataclass
class PlanExecutor:
    """Carries things, one plan after the other.

    failed : holds by which a thing did not move. missed : plans that did not lead where they should, with the thing in
    hand, since this was last set.
    """

    pull: bool = True
    failed: FailedGrasps = field(default_factory=FailedGrasps)
    missed: int = 0

    def __post_init__(self) -> None:
        self._oracle = ManipulationOracle(self.pull)
        self._leader = ManipulationOracle(
            self.pull
        )  # asks for ways to look: that there is none tells nothing of the goal
        self._course: RemainingPlan | None = None
        self._led: RemainingPlan | None = None  # the plan to bring a thing near to where he wants to look
        self._plans = 0
        self._tight: dict[str, int] = {}  # how often a thing stood against something unawares
        self._pushed: Translate | None = None  # the last motion with what he holds, if it was a push, and not back
        self._went_on: Place | None = None  # where a plan was last made that goes on with the hold he has

    @property
    def begun(self) -> bool:
        """Has he begun to carry anything?"""
        return self._plans > 0

    @property
    def turns(self) -> bool:
        """Does the plan under way turn what it carries?"""
        legs = () if self._course is None else self._course.legs
        return any(isinstance(motion, Rotate) for leg in legs for motion in leg.motions)

    def advise(self, node: Node, ends: Mapping[str, End], situation: Situation, hoped: Ends = dict) -> Advice:
        """What to do to carry an object to one of several ends. hoped : where they are if the floor goes on unseen."""
        before, self._course = self._course, None
        course = None
        if before is not None:
            course = followed(before, ends if before.name == node.name else None, situation)
        if course is None:
            self.missed += before is not None and before.grasped and not before.ended
            failure = self._failure(before, situation.model)
            if failure is not None:
                return failure
        last = before.target if before is not None else ""
        while True:
            found = course or self._planned(self._request(node, ends, last, situation.model, hoped), situation)
            if isinstance(found, See | Infeasibility):
                return found
            advice = self._next(found, ends if found.name == node.name else {}, situation)
            if advice is not None:
                return advice
            self.failed.blame(situation.model.object(found.name), situation.model)
            course, self._course = None, None

    def refused(self, node: Node, ends: Mapping[str, End], situation: Situation) -> Infeasibility | None:
        """Why an object cannot be carried to any of several ends, if it cannot."""
        found = self._oracle.find(self._request(node, ends, "", situation.model), situation)
        return found if isinstance(found, Infeasibility) else None

    def given_up(self, model: WorldModel) -> Act:
        """What to do when that which he holds went round in circles: let go of it, and do not take it so again."""
        assert model.held is not None
        self._course = None
        self.failed.blame(model.object(model.held), model)
        return Act(Release(), f"{model.held} goes round in circles")

    def gone_on(self, node: Node, situation: Situation) -> Act | None:
        """The next command of the plan under way for what he holds, if the world is still as it says."""
        if self._course is None or self._course.name != node.name or situation.model.held != node.name:
            return None
        course = followed(self._course, None, situation)
        if course is None:
            return None
        advice = self._next(course, {}, situation)
        return advice if isinstance(advice, Act) else None

    def taken_along(self, node: Node, squares: Squares, fetched: bool, situation: Situation) -> Act | Go | None:
        """Take an object along to where he wants to look; None when he had better walk there.

        What he holds by one straight push, if that leads there. fetched : else, or when he has not got hold of it, near
        there by one hold and a push or two.
        """
        model = situation.model
        if node.stuck or self._plans >= MOST_PLANS or model.held not in (None, node.name):
            return None
        push = lead(node, squares, situation) if self.pull and model.held is not None else None
        if push is not None:
            return _departing(push, f"{node.name} is taken along", model)
        return self._led_near(node, squares, situation) if fetched else None

    def by_way_of(self, node: Node, squares: Squares, situation: Situation) -> Act | None:
        """The push with what he holds after which he sees something and then needs one more to where the plan leads.

        It takes the place of the command that was advised; None when there is none.
        """
        course = self._course
        if not self.pull or self._plans >= MOST_PLANS or course is None or course.name != node.name:
            return None
        if len(course.legs) != 1 or not course.grasped:
            return None
        if self._pushed is None or not all(isinstance(motion, Translate) for motion in course.legs[0].motions):
            return None
        end, middle = course.end.centroid, node.polygon.centroid
        push = by_way(node, squares, (end.x - middle.x, end.y - middle.y), situation)
        return None if push is None else _departing(push, f"{node.name} is taken along", situation.model)

    def led_out(self, node: Node, situation: Situation) -> Act | None:
        """Lead what he holds to where it does not shut him in, to take it otherwise; None where that cannot be."""
        push = out(node, situation) if self.pull and not node.stuck and self._plans < MOST_PLANS else None
        if push is None:
            return None
        self.failed.blame(node, situation.model)
        return _departing(push, f"{node.name} is led out, to be taken otherwise", situation.model)

    def keep_to(self, name: str) -> None:
        """Give up the plan under way, but for one to carry that thing."""
        if self._course is not None and self._course.name != name:
            self._course = None

    def depart(self, act: Act) -> None:
        """Know that a command is given: one that no plan asks for ends the plan under way."""
        if act.departs is not None:
            self._course, self._plans, self._pushed = None, self._plans + 1, act.departs

    def _led_near(self, node: Node, squares: Squares, situation: Situation) -> Act | Go | None:
        """Bring an object near to where he wants to look, by one hold and a push or two, as was begun if it was."""
        course, self._led = self._led, None
        end = near(squares, situation)
        if end is None:
            return None
        ends = {SIGHT: end}
        if course is not None:
            course = followed(course, ends, situation) if course.name == node.name else None
        if course is None:
            haul = self._leader.find(self._request(node, ends, "", situation.model), situation)
            if isinstance(haul, Infeasibility) or haul.level or haul.aside or not haul.short:
                return None
            self._plans += 1
            course = course_of(haul, node, situation.model)
        advice = self._next(course, ends, situation)
        self._led = self._course
        return advice

    # -- when it fails ---------------------------------------------------------------------------

    def _failure(self, course: RemainingPlan | None, model: WorldModel) -> Advice | None:
        """What to do when a motion with something in hand did not move it: try once more, then from elsewhere.

        A thing can hardly be pushed along what it touches by who slips, or believes the lattice a degree beside, for it
        is pushed against that as well: what has moved before is first drawn back.
        """
        held = model.object(model.held) if model.held else None
        if held is None and course is not None and course.grasped:
            self.failed.blame(model.object(course.name), model)
        if held is None or not held.stuck:
            return None
        if held.moved:
            self._tight[held.name] = self._tight.get(held.name, 0) + 1
        pushed, self._pushed = self._pushed, None
        if held.stuck > 1 or self._tight.get(held.name, 0) > (SLIPPERY if held.inexact else TIGHTEST):
            self.failed.blame(held, model)
        elif held.moved and pushed is not None and self.pull:
            doubted = self._tight[held.name] > 1 or not is_whole(held.polygon)
            drawn = drawn_back(held, pushed, model, doubted)
            return Act(_command(drawn, model), f"{held.name} is drawn back from what it stands against")
        return Act(Release(), f"{held.name} did not move")

    # -- making one ------------------------------------------------------------------------------

    def _planned(self, request: Request, situation: Situation) -> RemainingPlan | See | Infeasibility:
        node, asked = request.node, request
        haul = self._oracle.find(request, situation)
        if isinstance(haul, Infeasibility) and situation.model.held == node.name and not request.held:
            request = replace(request, held=True)  # to let go and take it otherwise does not help either
            haul = self._oracle.find(request, situation)
        if isinstance(haul, Infeasibility):
            again = not haul.proved and self.failed.forgiven(node)
            return self._planned(replace(asked, avoid=self.failed.of(node)), situation) if again else haul
        if haul.aside:
            things = (thing for thing in situation.model.objects if thing.name in haul.aside)
            touch = _first(by_touch(situation.cost_maps, thing) for thing in things if thing.confidence < SURELY)
            if touch is not None:
                return touch
            cleared = (self._clearing(other, haul, situation) for other in situation.model.objects)
            first = next((found for found in cleared if found is not None), None)
            if first is None:
                unclear = (situation.model.object(name) for name in haul.aside)
                looks = (
                    inspection(situation.cost_maps, o, chance=1.0, to=TAKE) for o in unclear if o is not None and o.open
                )
                look = _first(looks)
                if look is not None:
                    return look
                why = f"{haul.aside[0]} is in the way of {node.name}, and cannot be cleared"
                return Infeasibility(False, lambda: why)
            node, haul = first
        seen = self._seen(haul, node, situation)
        if seen is not None:
            clear = clear_part(haul, node, situation)
            if clear is None:
                return seen
            haul = clear
        if not haul.plan.legs:
            return Infeasibility(False, lambda: f"{node.name} seems to lie there already")
        self._went_on = situation.model.place if request.held else None
        self._plans += 1
        if self._plans > MOST_PLANS:
            return Infeasibility(False, lambda: f"gave up after {MOST_PLANS} plans")
        return course_of(haul, node, situation.model)

    def _request(
        self, node: Node, ends: Mapping[str, End], last: str, model: WorldModel, hoped: Ends = dict
    ) -> Request:
        """What to ask for. He goes on with the hold he has, but not where doing so has brought him nowhere."""
        nowhere = self._went_on is not None and math.dist(self._went_on, model.place) < NOWHERE
        held = model.held == node.name and not nowhere
        tight = self._tight.get(node.name, 0) + (model.frame.origin != CENTRE and max(model.leeway) > LOOSE)
        return Request(node, ends, self.failed.of(node), last, tight, held, _price_of_a_turn(model), hoped)

    def _clearing(
        self, other: Node, haul: ManipulationPlan, situation: Situation
    ) -> tuple[Node, ManipulationPlan] | None:
        """A way to carry a thing off the squares that a plan needs, if it stands there and there is one."""
        if other.name not in haul.aside or other.polygon is None or other.movable == 0:
            return None
        room = situation.cost_maps.free(0) | situation.model.mask(other.patch)
        end = drawn_out(other, haul.swept, situation) or Inside(region_of(room & ~haul.swept))
        found = self._oracle.find(self._request(other, {"away": end}, "", situation.model), situation)
        return (other, found) if isinstance(found, ManipulationPlan) and found.plan.legs and not found.aside else None

    def _seen(self, haul: ManipulationPlan, node: Node, situation: Situation) -> See | None:
        """What of the way of a plan must be looked at before it is begun, if a look may tell more of it.

        All that is believed floor is trusted: to be stopped now and then costs less than to look each time. And to let
        go, walk, come back and take it again costs more than to be stopped by what is not floor. So is what is hoped to
        be free. But when a plan takes many commands, then what takes away the room for fewer, and may be none, is
        looked at too.
        """
        model, tedious = situation.model, haul.plan.commands > TEDIOUS
        if haul.hopes or (haul.plan.goes_on and not tedious):
            return None
        unsure = haul.swept & ~situation.cost_maps.free(0)
        if tedious:
            unsure |= grown(haul.swept, ABOUT) & (model.view.state == OPEN) & (model.view.probability > SPACE)
        unsure &= ~model.mask(node.patch)
        if not unsure.any():
            return None
        viewpoint = sight_of(situation.cost_maps, unsure, f"the way for {node.name} is not clear")
        return See(viewpoint) if len(viewpoint.squares) else None

    # -- following it ----------------------------------------------------------------------------

    def _next(self, course: RemainingPlan, ends: Mapping[str, End], situation: Situation) -> Act | Go | None:
        """The next command of a plan, None when the thing is not felt there. ends : where it may lead, if known."""
        self._course = course
        leg, model = course.legs[0], situation.model
        if not course.grasped:
            return self._taking(course, leg, ends, situation)
        if not leg.motions:
            self._course = replace(course, legs=course.legs[1:], grasped=False, place=None)
            return Act(Release(), f"{course.name} is where it shall be let go")
        motion = leg.motions[0]
        polygon = motion.carry(course.polygon)
        x, y = model.place
        place = (x + motion.dx, y + motion.dy) if isinstance(motion, Translate) else (x, y)
        self._pushed = motion if isinstance(motion, Translate) else None
        rest = replace(leg, motions=leg.motions[1:])
        self._course = replace(course, legs=(rest, *course.legs[1:]), polygon=polygon, place=place)
        return Act(_command(motion, model), f"{course.name} is brought to {course.target}")

    def _taking(
        self, course: RemainingPlan, leg: Leg, ends: Mapping[str, End], situation: Situation
    ) -> Act | Go | None:
        """Walk to where the object is taken, and take it: from where he stands, if that does as well.

        None where nothing is felt that could be it: it lies otherwise than he believes, and he would grasp at air.
        """
        model = situation.model
        there = model.view.locate(*model.place) == model.view.locate(*leg.place)
        begun = course if stands(model, leg.place) else None
        if begun is None and there and self.pull:  # who may only push stands where that was made sure of
            begun = from_here(course, ends, situation)
        if begun is not None and model.held == course.name:
            self._course = replace(begun, grasped=True, place=begun.legs[0].place)
            return self._next(self._course, ends, situation)
        if model.held is not None:
            return Act(Release(), f"{model.held} is let go, to be taken elsewhere")
        if not there:
            return Go(square_of(leg.place, model), leg.place, f"{course.name} can be taken from there")
        if begun is None:
            dx, dy = leg.place[0] - model.place[0], leg.place[1] - model.place[1]
            return Act(Move(*model.frame.to_utak(dx, dy)), "to the middle of the square")
        direction = grasp_direction(leg, course, model)
        if direction is None:
            return None
        self._course, self._pushed = replace(begun, grasped=True, place=begun.legs[0].place), None
        return Act(Grasp(direction), f"{course.name} is taken to be carried to {course.target}")


def _first(looks: Iterable[Viewpoint]) -> See | None:
    """To see what the first of some looks shows for which there is a place."""
    return next((See(look) for look in looks if len(look.squares)), None)


def _price_of_a_turn(model: WorldModel) -> float:
    """How many commands a turn counts for: it leaves a thing askew when it is open how the lattice lies, and elsewhere
    when it is open where in his square he stands.
    """
    if is_open(model):
        return OPEN_TURN
    return LOOSE_TURN if max(model.leeway) > LOOSE else 1.0


def _departing(push: Translate, why: str, model: WorldModel) -> Act:
    """A push that no plan asks for."""
    return Act(_command(push, model), why, push)


def _command(motion: Motion, model: WorldModel) -> Command:
    if isinstance(motion, Rotate):
        return Turn(motion.degrees)
    return Push(*model.frame.to_utak(motion.dx, motion.dy))
