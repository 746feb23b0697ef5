"""The action cycle of the paper (section 3.1).

Initialise, plan, then test, act, perceive and replan until the task is done.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from kb.body import Body, Command, Impression, Release
from kb.knowledge import Knowledge
from kb.localisation.hypotheses.explanation import Accommodated
from kb.task.task import Task
from kb.world.facts import Places, belief
from planner.deciding.decider import Decider
from planner.decision import Decision


@dataclass(frozen=True)
class Options:
    """paths: which path-finder (skeleton, visibility, grid). kb_files: the user's own encodings. max_steps.

    Commands until he gives up. pull: may what is held be pulled, or only pushed?
    """

    paths: str = "skeleton"
    kb_files: tuple[str, ...] = ()
    max_steps: int = 200
    pull: bool = True


class StepReport(NamedTuple):
    """One turn of the cycle. command: None on waking. belief: ready for JSON. why.

    The reason of the command, in words.
    """

    command: Command | None
    impression: Impression
    belief: dict[str, Any]
    why: str


class Verdict(NamedTuple):
    """How it ended: verdict is done, impossible, possible_if or limit.

    Believed tells whether Utak holds the task for done.
    """

    believed: bool
    verdict: str
    reason: str


class Robot:
    """Utak's mind. The numbers in brackets are the steps of the paper.

    Attributes
    ----------
    model : what is believed now. finished, verdict : whether and how it ended. steps : commands given.
    """

    def __init__(self, body: Body, task: Task, options: Options | None = None) -> None:
        self.body = body
        self.options = options or Options()
        rules = tuple(Path(file) for file in self.options.kb_files)
        self.knowledge = Knowledge(rules)  # (1) the default world model
        self.decider = Decider(task, self.options.paths, rules, self.options.pull)  # (6) the task
        self.verdict = Verdict(False, "limit", "not awake yet")
        self.finished = False
        self.steps = 0
        self._gives_up = False  # does he give up what he believes, as soon as his hand is empty?
        self._gave_up = False

    def wake(self) -> StepReport:
        """Steps 1 to 7: see for the first time, interpret, make the first plan."""
        impression = self.body.wake()  # (2)
        self.model, accommodated = self.knowledge.wake(impression)  # (3, 4, 5)
        self._decide()  # (6, 7)
        self._test()
        return self._report(None, impression, accommodated, "he wakes")

    def step(self) -> StepReport:
        """Steps 8 to 13: act, perceive, and see whether the plan still holds."""
        command, why = self.decision.command, self.decision.why  # (9)
        if command is None:
            raise ValueError("the run is finished")
        impression = self.body.act(command)  # (10)
        self.steps += 1
        self.model, accommodated = self.knowledge.perceive(command, impression)  # (11)
        if not self._gives_up:
            self._decide()  # (12, 13)
            at_a_loss = self.decision.verdict == "limit"
            self._gives_up = at_a_loss and self.model.shaken and not self._gave_up
        if self._gives_up:
            accommodated = self._give_up(impression) or accommodated
        self._test()
        return self._report(command, impression, accommodated, why)

    def _decide(self) -> None:
        self.decision: Decision = self.decider.decide(self.model, self.knowledge.memory.track)

    def _give_up(self, impression: Impression) -> Accommodated | None:
        """Begin anew, who is at a loss with what looks contradicted; None while he has to let go of something first."""
        held = self.model.held
        if held is not None:
            self.decision = Decision(Release(), f"{held} is let go, to begin anew; {self.decision.why}")
            return None
        self._gives_up, self._gave_up = False, True
        self.model, accommodated = self.knowledge.begin_anew(impression)
        self._decide()
        return accommodated

    def _report(
        self, command: Command | None, impression: Impression, accommodated: Accommodated, why: str
    ) -> StepReport:
        places = Places(self.decider.rooms, self.decider.corners)
        believed = belief(self.model, places, accommodated, self.decider.bound)
        return StepReport(command, impression, believed, why)

    def _test(self) -> None:
        """Step 8: stop when the task is complete, when it cannot be, or when the limit is reached."""
        decision = self.decision
        if decision.command is None:
            self.verdict = Verdict(decision.verdict == "done", decision.verdict, decision.why)
            self.finished = True
        elif self.steps >= self.options.max_steps:
            self.verdict = Verdict(False, "limit", f"not done after {self.steps} commands; next: {decision.why}")
            self.finished = True
