"""The action cycle of the paper (section 3.1), run by `Robot`.

Initialise and plan; then test, act, perceive and replan until the task is done.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from kb.body import Body, Command, Impression, Release
from kb.knowledge import Knowledge
from kb.localisation.field_account import Accommodation
from kb.task.task import Task
from kb.tracing.decisions import SolverCall, record_decisions
from kb.world.facts import Places, belief
from planner.deciding.decider import Decider
from planner.decision import Decision, TaskVerdict
from planner.journal import Journal


@dataclass(frozen=True)
class Options:
    """Options of the robot.

    Attributes
    ----------
    paths : the path-finder: skeleton, visibility or grid.
    kb_files : paths of the user's own encodings; none by default.
    max_steps : the number of commands after which the robot gives up.
    pull : whether a held object may be pulled; False when it may only be pushed.
    """

    paths: str = "skeleton"
    kb_files: tuple[str, ...] = ()
    max_steps: int = 200
    pull: bool = True


class StepReport(NamedTuple):
    """One turn of the cycle.

    Attributes
    ----------
    command : the command that was given; None on waking.
    impression : what the body returned after it.
    belief : what is believed since, ready for JSON, as `kb.world.facts.belief` returns it.
    why : the reason of the command, in words.
    """

    command: Command | None
    impression: Impression
    belief: dict[str, Any]
    why: str


class Verdict(NamedTuple):
    """The end of the task, as the robot judges it.

    Attributes
    ----------
    believed : whether the robot believes that the task is done.
    verdict : the kind of the end.
    reason : why, in words.
    """

    believed: bool
    verdict: TaskVerdict
    reason: str


class Robot:
    """The mind of Utak. The numbers in comments are the steps of the paper.

    Attributes
    ----------
    body : what senses and acts.
    options : how the robot works.
    knowledge : what the robot knows; model : what it believes now, set on waking. Only this class changes the two.
    decider : what chooses the commands.
    decision : what is done next, set on waking.
    finished, verdict : whether and how the task ended.
    steps : how many commands were given.
    """

    def __init__(self, body: Body, task: Task, options: Options | None = None, decider: Decider | None = None) -> None:
        """Make a robot that sleeps.

        Parameters
        ----------
        body : what senses and acts.
        task : the goals and what is said of their parameters.
        options : how the robot works; the defaults of Options if None.
        decider : what chooses the commands; a new Decider of this task if None. It belongs to this robot from now on.
        """
        self.body = body
        self.options = options or Options()
        rules = tuple(Path(file) for file in self.options.kb_files)
        self.knowledge = Knowledge(rules)  # (1) the default world model
        self.decider = decider or Decider(task, self.options.paths, rules, self.options.pull)  # (6) the task
        self.verdict = Verdict(False, TaskVerdict.LIMIT, "the robot has not been woken yet")
        self.finished = False
        self.steps = 0
        self._must_restart = False  # whether all beliefs are given up as soon as the hand is empty
        self._has_restarted = False
        self._journal = Journal()
        self._decided: list[SolverCall] = []  # what was decided between two steps, for the record of the next one

    def wake(self) -> StepReport:
        """Receive the first impression, interpret it and make the first plan (steps 1 to 7).

        A StepReport holds the command, the impression, what is believed after it, and the reason of the command in
        words.

        Returns
        -------
        StepReport
            The first impression and what is believed after it; its command is None.

        Raises
        ------
        BadInputError
            The user's encodings are wrong.
        """
        impression = self.body.wake()  # (2)
        with record_decisions() as decisions:
            self.model, accommodated = self.knowledge.wake(impression)  # (3, 4, 5)
            self._decide()  # (6, 7)
        self._test()
        return self._report(None, impression, accommodated, "the robot wakes", decisions)

    def step(self) -> StepReport:
        """Give the decided command, perceive, and decide anew (steps 8 to 13).

        A StepReport holds the command, the impression, what is believed after it, and the reason of the command in
        words.

        Returns
        -------
        StepReport
            The command that was given, and what is believed after it.

        Raises
        ------
        ValueError
            When the task has ended.
        BadInputError
            The user's encodings are wrong.
        """
        command, why = self.decision.command, self.decision.why  # (9)
        if command is None:
            raise ValueError("the run is finished")
        return self.follow(command, why)

    def follow(self, command: Command, why: str) -> StepReport:
        """Give a command, perceive, and decide anew (steps 10 to 13).

        The command may be another one than was decided: then the robot is led. A task that had ended goes on.

        Parameters
        ----------
        command : the command, in the robot's own frame.
        why : its reason, in words.

        Returns
        -------
        StepReport
            The command, and what is believed after it.

        Raises
        ------
        BadInputError
            The user's encodings are wrong.
        """
        self.finished = False
        impression = self.body.act(command)  # (10)
        self.steps += 1
        with record_decisions() as decisions:
            self.model, accommodated = self.knowledge.perceive(command, impression)  # (11)
            if not self._must_restart:
                self._decide()  # (12, 13)
                stuck = self.decision.verdict == TaskVerdict.LIMIT
                self._must_restart = stuck and self.model.shaken and not self._has_restarted
            if self._must_restart:
                accommodated = self._restart(impression) or accommodated
        self._test()
        earlier, self._decided = self._decided, []
        return self._report(command, impression, accommodated, why, [*earlier, *decisions])

    def adopt(self, kb_files: tuple[str, ...], task: Task | None = None) -> None:
        """Take other rules, and perhaps another task, for all that comes after the next impression.

        The command that is decided already is still given. What is believed stays, and is interpreted by the new rules
        with the next impression. With another task the robot decides afresh; parameters of the same name keep their
        binding until the next reconciliation.

        Parameters
        ----------
        kb_files : paths of the user's own encodings, all of them.
        task : the new task; None to keep the old one.
        """
        rules = tuple(Path(file) for file in kb_files)
        self.knowledge.rules = self.decider.rules = rules
        if task is not None:
            kept = {name: node for name, node in self.decider.bound.items() if name in task.parameters}
            self.decider = Decider(task, self.options.paths, rules, self.options.pull, bound=kept)

    def _decide(self) -> None:
        """Set `decision` to the next command, or the verdict, for what is believed now."""
        self.decision: Decision = self.decider.decide(self.model, self.knowledge.memory.track)

    def redirect(self, task: Task, options: Options) -> None:
        """Go on with another task or other options, from all that is known; decide anew where they ask for it.

        What was decided and tried for the task so far is forgotten when the task, the path-finder, the user's encodings
        or the leave to pull are others. A held object is released first then. Where things of the task began is where
        they are believed now. What was concluded before with the user's encodings and is remembered, such as the shape
        of a thing in hand, stays.

        Parameters
        ----------
        task : the goals from now on, and what is said of their parameters.
        options : how the robot works from now on. The limit of commands counts those already given, too.

        Raises
        ------
        BadInputError
            The user's encodings are wrong.
        """
        before, self.options = self.options, options
        decider = self.decider
        kept = (before.paths, before.kb_files, before.pull) == (options.paths, options.kb_files, options.pull)
        if not kept or task != decider.task:
            rules = tuple(Path(file) for file in options.kb_files)
            self.knowledge.rules = rules
            self.decider = Decider(task, options.paths, rules, options.pull)
            with record_decisions() as self._decided:
                self._decide()
            held = self.model.held
            if held is not None and self.decision.command is not None:
                self.decision = Decision(Release(), f"{held} is released, because the robot goes on with another task")
        self.finished = False
        self._test()

    def _restart(self, impression: Impression) -> Accommodation | None:
        """Forget all beliefs and begin anew from an impression; a held object is released first.

        Changes `model`, `decision` and what the robot knows. While an object is held, only `decision` changes, to its
        release: the restart follows after that.

        It holds the chosen explanation, and how each of the 160 fields of the retina is accounted for.

        Parameters
        ----------
        impression : what the body returned last.

        Returns
        -------
        Accommodation or None
            How the impression is explained in the new map; None when a held object must be released first.
        """
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
        """Return the report of one turn of the cycle.

        A StepReport holds the command, the impression, what is believed after it, and the reason of the command in
        words.

        Parameters
        ----------
        command : the command that was given; None on waking.
        impression : what the body returned after it.
        accommodated : how the impression was explained.
        why : the reason of the command, in words.
        decisions : the answers of encodings since the step before.
        """
        places = Places(self.decider.rooms, self.decider.corners)
        task = self.decider.task
        objects = (name for name, parameter in task.parameters.items() if parameter.kind == "object")
        planned = self._planned_facts()
        believed = belief(self.model, places, accommodated, self.decider.bound, objects, planned)
        believed |= self._journal.entry(decisions, self.knowledge.memory)
        return StepReport(command, impression, believed, why)

    def _planned_facts(self) -> tuple[str, ...]:
        """Return the task plan that is followed, as facts; or which goals none attains, and what was refuted."""
        plan, attempt = self.decider.plan, self.decider.attempt
        if plan is not None and self.decision.command is not None:
            return plan.facts
        return attempt.failure_facts if attempt is not None and self.decision.verdict != TaskVerdict.DONE else ()

    def _test(self) -> None:
        """Finish when the task is done, when it cannot be done, or when the limit of commands is reached (step 8).

        Sets `verdict` and `finished` then; else nothing changes.
        """
        decision = self.decision
        if decision.command is None:
            assert decision.verdict is not None
            self.verdict = Verdict(decision.verdict == TaskVerdict.DONE, decision.verdict, decision.why)
            self.finished = True
        elif self.steps >= self.options.max_steps:
            reason = f"not done after {self.steps} commands; the next one would be: {decision.why}"
            self.verdict = Verdict(False, TaskVerdict.LIMIT, reason)
            self.finished = True
