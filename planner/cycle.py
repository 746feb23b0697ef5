"""The action cycle of the paper (section 3.1), run by `Robot`.

Initialise and plan; then test, act, perceive and replan until the task is done.
"""

from collections.abc import Sequence
from copy import deepcopy
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from utak.kb.body import Body, Command, Impression, Release
from utak.kb.knowledge import Knowledge
from utak.kb.localisation.field_account import Accommodation
from utak.kb.reasoning.user_rules import rules_never_applied
from utak.kb.task.task import Task
from utak.kb.tracing.decisions import SolverCall, record_applied_rules, record_decisions
from utak.kb.world.facts import Places, belief
from utak.planner.agenda.decider import Decider
from utak.planner.decision import Decision, StepReport, TaskEnd, TaskVerdict
from utak.planner.journal import Journal
from utak.planner.steps import steps_of
from utak.planner.tasking.task_plan import RECOVERY, TaskPlan


@dataclass(frozen=True)
class Options:
    """Options of the robot."""

    paths: str = "skeleton"  # the path-finder: skeleton, visibility or grid
    kb_files: tuple[str, ...] = ()  # paths of the user's own encodings; none by default
    max_steps: int = 200  # the number of commands after which the robot gives up
    pull: bool = True  # whether a held object may be pulled; False when it may only be pushed


class _Before(NamedTuple):
    """The newest impression, and all that the mind consisted of before it."""

    command: Command | None  # the command, the impression after it, and the command's reason
    impression: Impression
    why: str
    options: Options  # copies of what the robot had then
    knowledge: Knowledge
    decider: Decider
    journal: Journal
    must_restart: bool  # whether all beliefs were to be given up, and whether they were
    has_restarted: bool


class Robot:
    """The mind of Utak. The numbers in comments are the steps of the paper."""

    # Whatever takes in an impression raises BadInputError when the user's encodings are wrong.

    def __init__(self, body: Body, task: Task, options: Options | None = None, decider: Decider | None = None) -> None:
        """Make a robot that sleeps."""
        self.body = body
        self.options = options or Options()
        rules = tuple(Path(file) for file in self.options.kb_files)
        self.knowledge = Knowledge(rules)  # (1) the default world model
        self.decider = decider or Decider(task, self.options.paths, rules, self.options.pull)  # (6) the task
        self.verdict = TaskEnd(False, TaskVerdict.LIMIT, "the robot has not been woken yet")
        self.finished = False
        self.decision: Decision  # set on waking
        self.steps = 0
        self._must_restart = False  # whether all beliefs are given up as soon as the hand is empty
        self._has_restarted = False
        self._applied: set[str] = set()  # the places of the users' rules that had an instance so far
        self._journal = Journal()
        self._before: _Before | None = None  # the mind before the newest impression; None until the robot wakes

    @property
    def idle_rules(self) -> tuple[str, ...]:
        """The users' rules that had no instance in any decision so far, in words with file and line."""
        return rules_never_applied(tuple(map(Path, self.options.kb_files)), self._applied)

    def wake(self) -> StepReport:
        """Receive the first impression, interpret it and make the first plan (steps 1 to 7); report it."""
        return self._receive(None, self.body.wake(), "the robot wakes")  # (2)

    def step(self) -> StepReport:
        """Give the decided command, perceive, and decide anew (steps 8 to 13); report what is believed after it."""
        command, why = self.decision.command, self.decision.why  # (9)
        if command is None:
            raise ValueError("the run is finished")
        return self.follow(command, why)

    def follow(self, command: Command, why: str) -> StepReport:
        """Give a command, perceive, and decide anew (steps 10 to 13); report what is believed after it."""
        self.finished = False
        impression = self.body.act(command)  # (10)
        self.steps += 1
        return self._receive(command, impression, why)

    def adopt(self, task: Task, options: Options) -> StepReport:
        """Take another task and other options from the newest impression on, and report it again, with its command."""
        if self._before is None:
            raise ValueError("the robot has not been woken yet")
        before, rules = deepcopy(self._before), tuple(Path(file) for file in options.kb_files)
        decider, old = before.decider, before.options
        decides_afresh = task != decider.task or (old.paths, old.pull) != (options.paths, options.pull)
        if decides_afresh:
            same = (task.parameters, task.claims) == (decider.task.parameters, decider.task.claims)
            attained = decider.attained if task == decider.task else 0
            decider = Decider(task, options.paths, rules, options.pull, bound=decider.bound if same else {})
            decider.attained, decider.place_names = attained, before.decider.place_names
        self.options, self.knowledge, self.decider = options, before.knowledge, decider
        self._journal = before.journal
        self._must_restart, self._has_restarted = before.must_restart, before.has_restarted
        self.knowledge.rules = self.decider.rules = rules
        self.finished = False
        return self._take_in(before.command, before.impression, before.why, decides_afresh)

    def _receive(self, command: Command | None, impression: Impression, why: str) -> StepReport:
        """Take in an impression after a copy of the mind is kept as it is before that, for `adopt`."""
        self._before = _Before(
            command,
            impression,
            why,
            self.options,
            *deepcopy((self.knowledge, self.decider)),
            self._journal.copy(),
            self._must_restart,
            self._has_restarted,
        )
        return self._take_in(command, impression, why)

    def _take_in(
        self, command: Command | None, impression: Impression, why: str, decides_afresh: bool = False
    ) -> StepReport:
        """Interpret an impression, decide what is done next, and return the report of the turn (steps 11 to 13, 8)."""
        with record_decisions() as decisions, record_applied_rules(self._applied):
            if command is None:
                self.model, accommodated = self.knowledge.wake(impression)  # (3, 4, 5)
                self._decide()  # (6, 7)
            else:
                self.model, accommodated = self.knowledge.perceive(command, impression)  # (11)
                if not self._must_restart:
                    self._decide()  # (12, 13)
                    stuck = self.decision.verdict == TaskVerdict.LIMIT
                    self._must_restart = stuck and self.model.shaken and not self._has_restarted
                if self._must_restart:
                    accommodated = self._restart(impression) or accommodated
        held = self.model.held
        if decides_afresh and held is not None and self.decision.command is not None:
            self.decision = Decision(Release(), f"{held} is released, because the robot goes on with another task")
        self._test()
        return self._report(command, impression, accommodated, why, decisions)

    def _decide(self) -> None:
        """Set `decision` to the next command, or the verdict, for what is believed now."""
        self.decision = self.decider.decide(self.model, self.knowledge.memory.track)

    def _restart(self, impression: Impression) -> Accommodation | None:
        """Forget all beliefs and begin anew from an impression; a held object is released first."""
        held = self.model.held
        if held is not None:
            why = f"{held} is released, because the robot forgets its map and begins anew; {self.decision.why}"
            self.decision = Decision(Release(), why)
            return None
        self._must_restart, self._has_restarted = False, True
        self.model, accommodated = self.knowledge.begin_anew(impression)
        self._decide()
        return accommodated

    def _report(
        self,
        command: Command | None,
        impression: Impression,
        accommodated: Accommodation,
        why: str,
        decisions: Sequence[SolverCall],
    ) -> StepReport:
        """Return the report of one turn; `decisions` are the answers of encodings since the step before."""
        places = Places(self.decider.rooms, self.decider.corners)
        task = self.decider.task
        objects = (name for name in task.parameters if task.is_object(name) or name in task.described)
        others = (*self.decider.alternatives, *self._planned_facts())
        believed = belief(self.model, places, accommodated, self.decider.bound, objects, others)
        believed |= self._journal.entry(decisions, self.knowledge.memory)
        return StepReport(command, impression, believed, why)

    def _planned_facts(self) -> tuple[str, ...]:
        """Return the task plan that is followed, as facts; or which goals none attains, and what was refuted."""
        attempt, command = self.decider.attempt, self.decision.command
        failed = attempt.failure_facts if attempt is not None and self.decision.verdict != TaskVerdict.DONE else ()
        if command is None:
            return failed
        steps = steps_of(self.decision, self.model)
        plan = TaskPlan((RECOVERY,)) if self._must_restart else self.decider.plan
        attained = {f"unmet({goal.name})" for goal in plan.goals if goal.name not in plan.unmet}
        facts = (*(() if plan.rounds else (fact for fact in failed if fact not in attained)), *plan.facts)
        return (*dict.fromkeys(facts), *(f"step({number},{step})" for number, step in enumerate(steps)))

    def _test(self) -> None:
        """Set `verdict` and `finished` when the task is done or cannot be done, or after the last command (step 8)."""
        decision = self.decision
        if decision.command is None:
            assert decision.verdict is not None
            self.verdict = TaskEnd(decision.verdict == TaskVerdict.DONE, decision.verdict, decision.why)
            self.finished = True
        elif self.steps >= self.options.max_steps:
            if self.decider.is_done_without_wishes(self.model, self.knowledge.memory.track):
                reason = f"all goals hold after {self.steps} commands, and wishes are left"
                self.verdict, self.finished = TaskEnd(True, TaskVerdict.DONE, reason), True
                return
            blamed = f"; {self.decider.blamed}" if self.decider.blamed else ""
            reason = f"not done after {self.steps} commands; the next one would be: {decision.why}{blamed}"
            self.verdict = TaskEnd(False, TaskVerdict.LIMIT, reason)
            self.finished = True
