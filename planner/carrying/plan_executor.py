"""The plan executor: it follows a manipulation plan, checks it after every impression, and makes another when it fails.

A plan is a sequence of legs: walk to a place, grasp, push and turn, release. It is kept while the object and the robot
are where it says, and while the squares that it needs are still believed free.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

from utak.geometry.counts.retina import RETINA_ZONES
from utak.geometry.kernels.arrays import XY, Bools
from utak.geometry.manipulation.goals import End
from utak.geometry.manipulation.plan_carrying import At
from utak.geometry.motion.se2 import Pose, Rotate, Translate
from utak.kb.body import Grasp, Move, Push, Release
from utak.kb.mapping.patch import Patch
from utak.kb.objects.held_object import is_grid_aligned
from utak.kb.objects.movability import square_ways, way_of
from utak.kb.perception.frame import CENTRE
from utak.kb.world.model import Node, WorldModel
from utak.planner.advice import Act, Go, See, command_of, unplanned_act
from utak.planner.carrying.infeasibility import Infeasibility
from utak.planner.carrying.manipulation_oracle import EndsFunction, ManipulationOracle, ManipulationPlan, Request
from utak.planner.carrying.preconditions import (
    PLACE_SLACK,
    doubts_of_barriers,
    doubts_of_obstacles,
    doubts_of_way,
    resistance,
    sensed_first,
    turn_cost,
)
from utak.planner.carrying.remaining_plan import (
    PlanOperations,
    RemainingPlan,
    grasp_direction,
)
from utak.planner.goals.placement import end_away_from, pull_out_end
from utak.planner.question import Question
from utak.planner.screen.moves import is_at
from utak.planner.screen.projection import SquareIndices, square_index
from utak.planner.situation import Situation
from utak.planner.skills.failed_grasps import FailedGrasps, rotated_grasps
from utak.planner.skills.take_along import detour_push, escape_push, region_near, shortest_push
from utak.planner.skills.unjam import retreat_push
from utak.planner.steps import grasp, release

NO_PROGRESS = 0.1  # squares: less than the shortest useful motion, more than rounding; a convention
VIEWPOINT_TARGET = "viewpoint"  # the end of a plan that brings an object near to where the robot wants to look
# Squares by which an object is tried another way, if there is room: as wide as the widest field of the retina, so that
# each field shows something else if it moved (derived).
TOLD_DISTANCE = max(side for _, side in RETINA_ZONES)
AWAY_TARGET = "away"  # the end of a plan that moves an object out of the way of another

Advice = Act | Go | See | Infeasibility


class PlanExecutor:
    """Carries objects, one plan after the other."""

    def __init__(
        self,
        pull: bool = True,
        oracle: ManipulationOracle | None = None,
        plan: RemainingPlan | None = None,
        operations: PlanOperations | None = None,
    ) -> None:
        """Make an executor."""
        self.pull = pull
        self.failed = FailedGrasps()
        self.missed = 0
        self.unwanted: Mapping[str, tuple[float, tuple[XY, ...]]] = {}
        self._oracle = oracle or ManipulationOracle(pull)
        # Asked for ways to a viewpoint: one that finds nothing there shall not change the order of questions elsewhere.
        self._viewpoint_oracle = ManipulationOracle(pull)
        self._plan = plan
        self._asked = ""  # the object for which the plan under way was made: the one it carries, or whose way it clears
        self._viewpoint_plan: RemainingPlan | None = None  # to bring an object near to where the robot wants to look
        self._operations = operations or PlanOperations()
        self._contacts: dict[str, int] = {}  # how often an object stood against something unexpectedly
        self._pushed: Translate | None = None  # the last motion with a held object, if a push, and not a retreat
        self._is_anew = False  # whether the held object was grasped since a plan moved it last
        self._went_on: XY | None = None  # where a plan was last made that goes on with the present grasp

    @property
    def turns(self) -> bool:
        """Return whether what is left of the plan under way turns its object; False when there is no plan."""
        legs = () if self._plan is None else self._plan.legs
        return any(isinstance(motion, Rotate) for leg in legs for motion in leg.motions)

    def plan_of(self, name: str) -> RemainingPlan | None:
        """Return what is left of the plan under way with an object; None for no such plan."""
        return self._plan if self._plan is not None and self._plan.name == name else None

    def advise(self, node: Node, ends: Mapping[str, End], situation: Situation, hoped: EndsFunction = dict) -> Advice:
        """Return what to do to carry an object to one of several ends, or why nothing can be done."""
        # What did not move is first moved another way, where one is left that was not tried.
        others = _ends_other_ways(node, ends, situation)
        advice = self._advise(node, others, situation, dict, True) if others else Infeasibility(False)
        if isinstance(advice, Infeasibility):
            return self._advise(node, ends, situation, hoped)
        why = f"{node.name} did not move, and may move another way"
        return replace(advice, why=f"{why}: {advice.why}") if isinstance(advice, Act | Go) else advice

    def _advise(
        self, node: Node, ends: Mapping[str, End], situation: Situation, hoped: EndsFunction, other_way: bool = False
    ) -> Advice:
        """Return the same; other_way: whether the ends are those another way, for which it may stay in hand."""
        before, self._plan = self._plan, None
        plan = None
        if before is not None and node.name not in (before.name, self._asked):
            before = None  # it brought another object somewhere, and cleared no way for this one
        self._asked = node.name
        if before is not None:
            plan = self._operations.revalidate(before, ends if before.name == node.name else None, situation)
        if plan is None:
            self.missed += before is not None and before.grasped and not before.ended
            reaction = self._react(before, situation, other_way)
            if isinstance(reaction, Act):
                return reaction
        last = before.target if before is not None else ""
        while True:
            found = plan or self._make_plan(self._request(node, ends, last, situation.model), situation, hoped)
            if isinstance(found, See | Infeasibility):
                return found
            advice = self._next_step(found, ends if found.name == node.name else {}, situation)
            if not isinstance(advice, Infeasibility):
                return advice
            self.failed.record(situation.model.object(found.name), situation.model)
            plan, self._plan = None, None

    def try_through(self, node: Node, ends: Mapping[str, End], opened: Bools, situation: Situation) -> Advice:
        """Return what to do to carry an object to one of several ends as if some squares of wall were free."""
        request = self._request(node, ends, "", situation.model)
        found = self._oracle.through(request, opened, situation)
        if found is None:
            return Infeasibility(False, "no plan leads through")
        return self._next_step(self._operations.begin_plan(found, node, situation.model), ends, situation)

    def infeasibility(self, node: Node, ends: Mapping[str, End], situation: Situation) -> Infeasibility | None:
        """Return why an object cannot be carried to any of several ends; None when a plan is found."""
        found = self._oracle.find(self._request(node, ends, "", situation.model), situation)
        return found if isinstance(found, Infeasibility) else None

    def forget_misses(self) -> None:
        """Set `missed` to 0: the number of plans that ended with the object in hand before they led to their end."""
        self.missed = 0

    def release_looping(self, model: WorldModel) -> Act:
        """Return the release of a held object that was carried in a loop, and mark its grasp as failed."""
        assert model.held is not None
        self._plan = None
        self.failed.record(model.object(model.held), model)
        return Act(Release(), f"{model.held} is released, because it was carried round in circles")

    def continue_plan(self, node: Node, situation: Situation) -> Advice:
        """Return the next command of the plan under way for the held object, if there is such a plan."""
        begun = self.plan_of(node.name) if situation.model.held == node.name else None
        plan = None if begun is None else self._operations.revalidate(begun, None, situation)
        if plan is None:
            return Infeasibility(False, f"no plan is under way for {node.name}")
        return self._next_step(plan, {}, situation)

    def take_along(self, node: Node, squares: SquareIndices, situation: Situation) -> Advice:
        """Return the push that takes the object in hand along to where the robot wants to look."""
        push = shortest_push(node, squares, situation) if self.pull else None
        if push is None:
            return Infeasibility(False, f"no push takes {node.name} along")
        return unplanned_act(push, f"{node.name} is taken along", situation.model)

    def detour(
        self, node: Node, looks: Sequence[SquareIndices], ends: Mapping[str, End], situation: Situation
    ) -> Advice:
        """Return a push with the held object, in place of the one advised last, that halts where something is seen."""
        # There may be none (see `detour_push`), as when what is left of the plan is not one leg of pushes with the
        # object in hand.
        none = Infeasibility(False, "no push halts where it is seen")
        plan = self.plan_of(node.name)
        if not self.pull or node.stuck or plan is None:
            return none
        if len(plan.legs) != 1 or not plan.grasped or self._pushed is None:
            return none
        pushes = [self._pushed, *(motion for motion in plan.legs[0].motions if isinstance(motion, Translate))]
        if len(pushes) <= len(plan.legs[0].motions):
            return none
        push = detour_push(node, looks, ends, pushes, situation)
        return none if push is None else unplanned_act(push, f"{node.name} is taken along", situation.model)

    def lead_out(self, node: Node, situation: Situation) -> Advice:
        """Return the push after which the held object no longer shuts the robot in, and mark the grasp as failed."""
        push = escape_push(node, situation) if self.pull else None
        if push is None:
            return Infeasibility(False, "no push leads it out")
        self.failed.record(node, situation.model)
        return unplanned_act(push, f"{node.name} is led out of the nook, to be grasped from elsewhere", situation.model)

    def serves(self, name: str) -> bool:
        """Return whether the plan under way carries the object `name`, or clears its way."""
        return self._plan is not None and name in (self._plan.name, self._asked)

    def depart(self, act: Act) -> None:
        """Note that a command is given. A push that no plan asks for ends the plan under way."""
        if act.unplanned_push is not None:
            self._plan, self._pushed = None, act.unplanned_push
            self._is_anew = False

    def bring_near(self, node: Node, squares: SquareIndices, situation: Situation) -> Advice:
        """Return the next command to bring an object near to some squares by one grasp and one or two pushes."""
        # Only over squares that are surely free.
        no_way = Infeasibility(False, f"no simple way brings {node.name} there")
        plan, self._viewpoint_plan = self._viewpoint_plan, None
        end = region_near(squares, situation)
        if end is None:
            return no_way
        ends = {VIEWPOINT_TARGET: end}
        if plan is not None:
            plan = self._operations.revalidate(plan, ends, situation) if plan.name == node.name else None
        if plan is None:
            found = self._viewpoint_oracle.find(self._request(node, ends, "", situation.model), situation)
            if isinstance(found, Infeasibility) or found.level or found.aside or not found.is_simple:
                return no_way
            plan = self._operations.begin_plan(found, node, situation.model)
        advice = self._next_step(plan, ends, situation)
        self._viewpoint_plan = self._plan
        return advice

    # -- when a plan fails -----------------------------------------------------------------------

    def _react(self, plan: RemainingPlan | None, situation: Situation, other_way: bool) -> Advice:
        """Return what to do when a motion did not move the held object, as planner/asp/deciding/hand.lp chooses."""
        # An object that touches something can hardly be pushed along it after a slip, or where the frame is believed a
        # degree off, for it is pushed against it as well. Nothing is to be done when nothing failed, or when nothing is
        # held: then a grasp that the plan, which no longer holds, relied on is marked as failed.
        model = situation.model
        held = model.object(model.held) if model.held else None
        if held is None and plan is not None and plan.grasped:
            self.failed.record(model.object(plan.name), model)
        if held is None or not held.stuck or self._is_anew:
            return Infeasibility(False, "no motion failed")
        name = held.name
        if held.moved:
            self._contacts[name] = self._contacts.get(name, 0) + 1
        pushed, self._pushed = self._pushed, None
        drawable = held.moved and pushed is not None and self.pull
        facts = [*resistance(held), f"contacts({name},{self._contacts.get(name, 0)})"]
        given = {"drawable": drawable, "other_way": other_way}
        facts += [f"{fact}({name})" for fact, is_so in given.items() if is_so]

        def draw_back(question: Question) -> Act | None:
            """Return the push back from what stopped it."""
            if pushed is None:
                return None
            doubted = self._contacts[name] > 1 or not is_grid_aligned(held.polygon)
            retreat = retreat_push(held, pushed, model, doubted)
            return Act(command_of(retreat, model), f"{name} is drawn back from what stopped it", question=question)

        def let_go(question: Question) -> Act:
            """Return the release."""
            return Act(Release(), f"{name} is released, because it did not move", question=question)

        def regrasp(question: Question) -> Act:
            """Return the same, after the grasp is marked as failed."""
            self.failed.record(held, model)
            return let_go(question)

        reflexes = {"draw_back": draw_back, "let_go": let_go, "regrasp": regrasp}
        found = situation.question.adding(facts).first_of("hand", "react", reflexes)
        return found or Infeasibility(False, "nothing is done about what did not move")

    # -- making a plan ---------------------------------------------------------------------------

    def _make_plan(
        self, request: Request, situation: Situation, hoped: EndsFunction
    ) -> RemainingPlan | See | Infeasibility:
        """Return a new plan (map frame); or what must be seen before it is begun, or why there is none."""
        node, asked = request.node, request
        found = self._oracle.find(request, situation, hoped)
        if isinstance(found, Infeasibility) and situation.model.held == node.name and not request.held:
            request = replace(request, held=True)  # to release the object and grasp it otherwise does not help either
            found = self._oracle.find(request, situation, hoped)
        if isinstance(found, Infeasibility):
            if found.proved or not self.failed.forgive(node):
                return found
            return self._make_plan(replace(asked, avoid=self.failed.grasps(node)), situation, hoped)
        if found.aside:
            cleared = self._clear_way(found, node, situation)
            if isinstance(cleared, See | Infeasibility):
                return cleared
            node, found = cleared
        sense = sensed_first(doubts_of_way(found, node, situation), situation)
        if sense is not None:
            prefix = self._operations.safe_prefix(found, node, situation)
            if prefix is None:
                then = self._operations.begin_plan(found, node, situation.model).steps(situation.model)
                return See(sense.doubt.look, sense.question, then)
            found = prefix
        if not found.plan.legs:
            return Infeasibility(False, f"{node.name} seems to lie there already")
        self._went_on = situation.model.place if request.held else None
        return self._operations.begin_plan(found, node, situation.model)

    def _clear_way(
        self, found: ManipulationPlan, node: Node, situation: Situation
    ) -> tuple[Node, ManipulationPlan] | See | Infeasibility:
        """Return an object that a plan needs moved aside, with a plan for that; or a look at it, or why not."""
        sense = sensed_first(doubts_of_obstacles(found, situation), situation)
        if sense is not None:
            return See(sense.doubt.look, sense.question)
        asked = [self._plan_aside(other, found, situation) for other in situation.model.objects]
        cleared = [one for one in asked if one is not None]
        if cleared:
            return min(cleared, key=lambda one: one[1].plan.commands)
        sense = sensed_first(doubts_of_barriers(found, situation), situation)
        if sense is not None:
            return See(sense.doubt.look, sense.question)
        return Infeasibility(False, f"{found.aside[0]} is in the way of {node.name}, and cannot be moved aside")

    def _request(self, node: Node, ends: Mapping[str, End], last: str, model: WorldModel) -> Request:
        """Return the question to the oracle. The present grasp may be kept, but not where it has led to no progress."""
        stalled = self._went_on is not None and math.dist(self._went_on, model.place) < NO_PROGRESS
        held = model.held == node.name and not stalled
        contacts = self._contacts.get(node.name, 0)
        contacts += model.frame.origin != CENTRE and max(model.leeway) > PLACE_SLACK
        turned, unwanted = self.unwanted.get(node.name, (0.0, ()))
        avoid = (*self.failed.grasps(node), *rotated_grasps(unwanted, node.turned - turned))
        return Request(node, ends, avoid, last, contacts, held, turn_cost(model))

    def _plan_aside(
        self, other: Node, found: ManipulationPlan, situation: Situation
    ) -> tuple[Node, ManipulationPlan] | None:
        """Return an object and a plan that carries it off the squares that another plan needs; None for no such."""
        if other.name not in found.aside or other.polygon is None or other.movable == 0:
            return None
        end = pull_out_end(other, found.swept, situation) or end_away_from(found.swept, other, situation)
        for ends in (_ends_other_ways(other, {AWAY_TARGET: end}, situation), {AWAY_TARGET: end}):
            plan = self._oracle.find(self._request(other, ends, "", situation.model), situation) if ends else None
            if isinstance(plan, ManipulationPlan) and plan.plan.legs and not plan.aside:
                return other, plan
        return None

    # -- following a plan ------------------------------------------------------------------------

    def _next_step(self, plan: RemainingPlan, ends: Mapping[str, End], situation: Situation) -> Advice:
        """Return the next step of a plan, unless the object is not felt where it should be grasped."""
        self._plan = plan
        leg, model = plan.legs[0], situation.model
        if not plan.grasped:
            return self._take(plan, ends, situation)
        if not leg.motions:
            self._plan = replace(plan, legs=plan.legs[1:], grasped=False, place=None)
            return Act(Release(), f"{plan.name} is where it shall be released", steps=plan.steps(model))
        motion = leg.motions[0]
        polygon = motion.carry(plan.polygon)
        x, y = model.place
        place = (x + motion.dx, y + motion.dy) if isinstance(motion, Translate) else (x, y)
        self._pushed, self._is_anew = motion if isinstance(motion, Translate) else None, False
        rest = replace(leg, motions=leg.motions[1:])
        self._plan = replace(plan, legs=(rest, *plan.legs[1:]), polygon=polygon, place=place)
        moved = "pushed" if isinstance(motion, Translate) else "turned"
        why = f"{plan.name} is {moved} on the way to its place ({plan.target})"
        return Act(command_of(motion, model), why, steps=plan.steps(model))

    def _take(self, plan: RemainingPlan, ends: Mapping[str, End], situation: Situation) -> Advice:
        """Return the step to where the object is grasped, or the grasp; from the present place if that does as well."""
        # A held object that must be grasped otherwise is released first.
        model, leg = situation.model, plan.legs[0]
        there = model.view.locate(*model.place) == model.view.locate(*leg.place)
        begun = plan if is_at(model, leg.place) else None
        if begun is None and there and self.pull:  # where pulling is not allowed, only the planned place was verified
            begun = self._operations.start_from_robot(plan, ends, situation)
        if begun is not None and model.held == plan.name:
            self._plan = replace(begun, grasped=True, place=begun.legs[0].place)
            return self._next_step(self._plan, ends, situation)
        if model.held is not None:
            next_ = "to be grasped from elsewhere" if model.held == plan.name else f"because {plan.name} is moved next"
            return Act(Release(), f"{model.held} is released, {next_}", steps=(release(model.held), *plan.steps(model)))
        if not there:
            x, y = leg.place
            from_there = model.point_in_words((x - model.view.west, y - model.view.south))
            why = f"{plan.name} can be grasped from {from_there}"
            return Go(square_index(leg.place, model), leg.place, why, plan.steps(model))
        if begun is None:
            dx, dy = leg.place[0] - model.place[0], leg.place[1] - model.place[1]
            why = "the robot moves to the middle of its square"
            return Act(Move(*model.frame.to_utak(dx, dy)), why, steps=plan.steps(model))
        direction = grasp_direction(plan, model)
        if direction is None:
            return Infeasibility(False, f"{plan.name} is not felt where it should be grasped: it lies otherwise")
        self._plan, self._pushed = replace(begun, grasped=True, place=begun.legs[0].place), None
        self._is_anew = True
        why = f"{plan.name} is grasped, to be carried to its place ({plan.target})"
        return Act(Grasp(direction), why, steps=(grasp(plan.name, direction), *self._plan.steps(model)))


def _ends_other_ways(node: Node, ends: Mapping[str, End], situation: Situation) -> dict[str, End]:
    """Return the ends of an object in each of the ways in which it is tried next: a given one, or as far as is told."""
    if not node.untried:
        return {}
    model, free = situation.model, situation.cost_maps.free(0) | situation.model.mask(node.patch)

    def far(x: int, y: int) -> int:
        """Return for how many steps of (x, y) the squares of the object are free, 1 to TOLD_DISTANCE."""
        (west, south, mask), steps = node.patch, range(1, TOLD_DISTANCE + 1)
        places = (Patch(west + n * x, south + n * y, mask) for n in steps)
        return max(1, next((n for n, there in enumerate(places) if not free[model.mask(there)].all()), TOLD_DISTANCE))

    found: dict[str, End] = {
        way: At(Pose(float(far(x, y) * x), float(far(x, y) * y), 0.0))
        for way, (x, y) in square_ways(model.frame).items()
    }
    for end in ends.values():
        if isinstance(end, At) and not end.pose.degrees:
            found[way_of(Push(*model.frame.to_utak(end.pose.x, end.pose.y)))] = end
    return {way: end for way, end in found.items() if way in node.untried}
