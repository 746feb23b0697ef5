"""Errands: the next step of the task plan, carried out by what carries objects.

A thing that is brought to a place of its own goal is led by planner.deciding.transport, which knows how exactly it must
end. A thing that is moved aside, or to a spot that the plan chose, is brought there by the plan executor.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from kb.language.terms import Fact
from kb.task.binding import Reconciliation
from planner.carrying.preconditions import turn_cost
from planner.deciding.bringing import bring_to_end
from planner.deciding.tools import Tools
from planner.deciding.transport import Transporter
from planner.decision import Decision, TaskVerdict, nothing_to_do
from planner.situation import Situation
from planner.stages import Stage
from planner.tasking.intention import Intention, NextErrand
from planner.tasking.setting import DestinationFunction
from planner.tasking.task_plan import Errand, TaskPlan

MAX_FAILURES = 3  # errands that fail one after the other within one decision; a bound on rounds


class ErrandRunner:
    """Carries out the errands of the task plan, and owns the plan.

    Attributes
    ----------
    forbidden : the steps that users' rules forbade where something was open, and no step was left to settle it.
    """

    def __init__(self, where: DestinationFunction, pull: bool = True) -> None:
        """Make a runner without a plan.

        where : returns the squares on which a goal holds for the robot, from the goal and the situation.
        pull : whether a held object may be pulled.
        """
        self._intention = Intention(where, pull)
        self.forbidden: tuple[str, ...] = ()

    @property
    def plan(self) -> TaskPlan | None:
        """The plan under way, from its present errand on; None for none."""
        return self._intention.plan

    @property
    def settling(self) -> TaskPlan | None:
        """The plan that settles what is open, from its present step on; None where nothing is open."""
        return self._intention.settling

    @property
    def meanings(self) -> Mapping[str, str]:
        """The object that each parameter of the task means in the plan under way, where it chose among several."""
        return self._intention.meanings

    @property
    def attempt(self) -> TaskPlan | None:
        """The best that was found in place of a plan: it leaves goals unmet; None while there is a plan."""
        return self._intention.attempt

    def next(
        self, stage: Stage, situation: Situation, reconciled: Reconciliation, transporter: Transporter, tools: Tools
    ) -> Decision:
        """Return the next command for the task plan; nothing where it has no errand for an object next.

        The plan is made anew first where it no longer holds. The verdict `impossible`, for good, where users' rules
        leave no plan. Where an errand cannot be done, the plan is made anew without it.

        Parameters
        ----------
        stage : of the task: the goals that shall hold now.
        situation : what is believed (world model, rooms, doors, corners, track).
        reconciled : what the parameters of the task mean.
        transporter : brings objects where goals hold.
        tools : executor, pursuer and verifier, with which the decision is worked out.
        """
        self.forbidden = ()
        situation = self._update(stage, situation, transporter, tools)
        if self.is_shut_out:
            return Decision(None, f"{stage} cannot be attained: {self.blamed}", TaskVerdict.IMPOSSIBLE, unless=None)
        ruled = self.within_rules(situation)
        for attempt in range(MAX_FAILURES):
            if attempt:
                ruled = self._update(stage, ruled, transporter, tools)
            found = self._intention.next_errand(stage, ruled, transporter.place, transporter.origin_of)
            if found is None:
                break
            tools.executor.unwanted = {found.node.name: (found.turned, found.errand.avoid)}
            along = self.along_plan(ruled)
            decision = self._follow(found, stage, along, reconciled, transporter, tools)
            if decision.command is not None:
                return decision
            self._intention.failed(found.errand, ruled)
        tools.executor.unwanted = {}
        return nothing_to_do("the task plan has no errand" if self.plan is None else "the next step is the robot's own")

    def settle(self, stage: Stage, situation: Situation, transporter: Transporter, given: Sequence[str]) -> str:
        """Return the first step of the task plan where something is open, as planner/asp/task writes it; "" for none.

        Parameters
        ----------
        stage, situation, transporter : as for `next`.
        given : what is not known, what activities came to, and what the robot is stuck with, as facts without full
            stops.
        """
        place, origin = transporter.place, transporter.origin_of
        step, self.forbidden = self._intention.settle(stage, situation, place, origin, given)
        return step

    def within_rules(self, situation: Situation) -> Situation:
        """Return a situation with the doors closed that users' rules leave to no plan.

        Parameters
        ----------
        situation : what is believed (world model, rooms, doors, corners, track).
        """
        closed = self._intention.rules.names_of_closed(situation)
        return situation if closed == situation.closed else replace(situation, closed=closed)

    def _update(self, stage: Stage, situation: Situation, transporter: Transporter, tools: Tools) -> Situation:
        """Make the plan anew where it no longer holds; return the situation with what it means by parameters."""
        avoid = {node.name: tools.executor.failed.grasps(node) for node in situation.model.objects if node.polygon}
        turn = turn_cost(situation.model)
        return self._intention.update(stage, situation, transporter.place, transporter.origin_of, avoid, turn)

    @property
    def blamed(self) -> str:
        """The users' rules because of which there is no plan for all goals, in words; "" for none."""
        blamed = self._intention.rules.blamed
        rules = "the rule" if len(blamed) == 1 else "the rules"
        return f"{rules} at {' and '.join(blamed)} leave{'s' * (len(blamed) == 1)} no plan" if blamed else ""

    @property
    def is_shut_out(self) -> bool:
        """Whether users' rules leave no plan, and not because they close doors: no other way can be looked for.

        False while it is open where exactly a goal holds.
        """
        rules = self._intention.rules
        return bool(rules.blamed and not rules.closed and not self._intention.is_open)

    @property
    def blamed_so_far(self) -> str:
        """The users' rules because of which there is no plan as far as is known, in words; "" for none.

        "" where a plan is under way, too, and where the rules close doors: then no way through these is taken.
        """
        return self.blamed if self.plan is None and not self._intention.rules.closed else ""

    def along_plan(self, situation: Situation) -> Situation:
        """Return the situation with the doors closed that the present errand does not pass, where users' rules count.

        Parameters
        ----------
        situation : what is believed (world model, rooms, doors, corners, track).
        """
        return self._intention.along_plan(situation)

    @property
    def own_wish(self) -> tuple[Errand, Fact] | None:
        """The next step of the plan and its wish, when the robot goes somewhere for a wish; None otherwise."""
        return self._intention.own_wish()

    def drop(self, errand: Errand, situation: Situation) -> None:
        """Drop the wish of a step for good: it cannot be attained.

        Parameters
        ----------
        errand : the present step of the plan.
        situation : what is believed (world model, rooms, doors, corners, track).
        """
        self._intention.failed(errand, situation)

    @property
    def wishes_that_hold(self) -> tuple[str, ...]:
        """The wishes that hold now, as the task states them."""
        return self._intention.wishes_that_hold()

    def _follow(
        self,
        found: NextErrand,
        stage: Stage,
        situation: Situation,
        reconciled: Reconciliation,
        transporter: Transporter,
        tools: Tools,
    ) -> Decision:
        """Return the next command of an errand; a verdict or nothing when it cannot be done."""
        if found.goal is None:
            brought = bring_to_end(found.node, found.errand.place, found.end, stage, situation, tools)
            return brought or nothing_to_do(f"{found.node.name} cannot be brought to {found.errand.place}")
        goal = found.goal
        stage = stage if goal in stage.goals else replace(stage, goals=(*stage.goals, goal))
        decision = transporter.towards(goal, stage, situation, reconciled, tools, found.end_name)
        return transporter.freed(decision, goal, stage, situation, tools)
