"""Errands: the next step of the task plan, carried out by what carries objects.

A thing that is brought to a place of its own goal is led by planner.deciding.transport, which knows how exactly it must
end. A thing that is moved aside, or to a spot that the plan chose, is brought there by the plan executor.
"""

from collections.abc import Sequence
from dataclasses import replace

from utak.planner.carrying.preconditions import turn_cost
from utak.planner.deciding.bringing import bring_to_end
from utak.planner.deciding.stage_turn import StageTurn
from utak.planner.deciding.transport import Transporter
from utak.planner.decision import Decision, impossible, nothing_to_do
from utak.planner.situation import Situation
from utak.planner.tasking.intention import Intention, NextErrand
from utak.planner.tasking.setting import DestinationFunction, WhereGoalsHold

MAX_FAILURES = 3  # errands that fail one after the other within one decision; a bound on rounds


class ErrandRunner:
    """Carries out the errands of the task plan."""

    def __init__(self, transporter: Transporter, where: DestinationFunction, pull: bool = True) -> None:
        """Make a runner without a plan."""
        self._transporter = transporter
        self.intention = Intention(WhereGoalsHold(transporter.place, transporter.origin_of, where), pull)
        self.forbidden = ""

    def next(self, turn: StageTurn) -> Decision:
        """Return the next command for the task plan; nothing where it has no errand for an object next."""
        # The verdict `impossible`, for good, where users' rules leave no plan.
        self.forbidden = ""
        turn = self._updated(turn)
        if self.is_shut_out:
            why = f"{turn.stage} cannot be attained: {self.blamed}"
            return impossible(why, f"rules leave no plan: {self.blamed}", unless=None)
        for attempt in range(MAX_FAILURES):
            if attempt:
                turn = self._updated(turn)
            found = self.intention.next_errand(turn.stage, turn.situation)
            if found is None:
                break
            turn.executor.unwanted = {found.node.name: (found.turned, found.errand.avoid)}
            decision = self._follow(found, turn.within(self.intention.along_plan(turn.situation)))
            if decision.command is not None:
                return decision
            self.intention.failed(found.errand, turn.situation, decision.why)
        turn.executor.unwanted = {}
        planned = self.intention.plan is not None
        return nothing_to_do("the next step is the robot's own" if planned else "no verified task plan has an errand")

    def settle(self, turn: StageTurn, given: Sequence[str]) -> str:
        """Return the first step of the task plan where something is open, as planner/asp/task writes it."""
        step, self.forbidden = self.intention.settle(turn.stage, turn.situation, given)
        return step

    @property
    def blamed(self) -> str:
        """The users' rules because of which there is no plan for all goals, in words; "" for none."""
        blamed = self.intention.blamed
        rules = "the rule" if len(blamed) == 1 else "the rules"
        return f"{rules} at {' and '.join(blamed)} leave{'s' * (len(blamed) == 1)} no plan" if blamed else ""

    @property
    def is_shut_out(self) -> bool:
        """Whether users' rules leave no plan for good: no other way can be looked for."""
        return self.intention.shut_out and not self.intention.is_open

    def blamed_so_far(self, situation: Situation) -> str:
        """Return the users' rules because of which there is no plan as far as is known, in words; "" for none."""
        return self.blamed if self.intention.plan is None and not situation.closed else ""

    def _updated(self, turn: StageTurn) -> StageTurn:
        """Make the plan anew where it no longer holds; return the turn with what it means by parameters."""
        model = turn.situation.model
        avoid = {node.name: turn.executor.failed.grasps(node) for node in model.objects if node.polygon}
        return turn.within(self.intention.update(turn.stage, turn.situation, avoid, turn_cost(model)))

    def _follow(self, found: NextErrand, turn: StageTurn) -> Decision:
        """Return the next command of an errand; a verdict or nothing when it cannot be done."""
        goal = found.goal
        if goal is None:
            brought = bring_to_end(found.node, {found.errand.place: found.end}, turn)
            return brought or nothing_to_do(f"{found.node.name} cannot be brought to {found.errand.place}")
        if goal not in turn.stage.goals:
            turn = replace(turn, stage=replace(turn.stage, goals=(*turn.stage.goals, goal)))
        return self._transporter.towards(goal, turn, found.end_name)
