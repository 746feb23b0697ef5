"""The action cycle of the paper (section 3.1): initialise, plan, then test, act, perceive and replan until the task is done."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

from kb.body import Body, Command, Impression
from kb.belief import belief
from kb.knowledge import Knowledge
from kb.task import Task
from planner.deciding import Decider, Decision


@dataclass(frozen=True)
class Options:
    """paths: which path-finder (skeleton, visibility, grid). kb_files: the user's own encodings. max_steps: commands until he gives up."""

    paths: str = "skeleton"
    kb_files: tuple[str, ...] = ()
    max_steps: int = 200


class StepReport(NamedTuple):
    """One turn of the cycle. command: None on waking. belief: ready for JSON. why: the reason of the command, in words."""

    command: Command | None
    impression: Impression
    belief: dict[str, Any]
    why: str


class Verdict(NamedTuple):
    """How it ended: verdict is done, impossible, possible_if or limit; believed tells whether Utak holds the task for done."""

    believed: bool
    verdict: str
    reason: str


@dataclass
class Robot:
    """Utak's mind. The numbers in brackets are the steps of the paper."""

    body: Body
    task: Task
    options: Options = field(default_factory=Options)
    verdict: Verdict = Verdict(False, "limit", "not awake yet")

    def __post_init__(self) -> None:
        rules = tuple(Path(file) for file in self.options.kb_files)
        self.knowledge = Knowledge(rules)  # (1) the default world model
        self.decider = Decider(self.task, self.options.paths, rules)  # (6) the task
        self.steps = 0
        self.finished = False

    def wake(self) -> StepReport:
        """Steps 1 to 7: see for the first time, interpret, make the first plan."""
        impression = self.body.wake()  # (2)
        self.model, accommodated = self.knowledge.wake(impression)  # (3, 4, 5)
        self.decision = self.decider.decide(self.model)  # (6, 7)
        self._test()
        return StepReport(None, impression, belief(self.model, accommodated, self.decider.bound), "he wakes")

    def step(self) -> StepReport:
        """Steps 8 to 13: act, perceive, and see whether the plan still holds."""
        command, why = self.decision.command, self.decision.why  # (9)
        if command is None:
            raise ValueError("the run is finished")
        impression = self.body.act(command)  # (10)
        self.steps += 1
        self.model, accommodated = self.knowledge.perceive(command, impression)  # (11)
        self.decision = self.decider.decide(self.model)  # (12, 13)
        self._test()
        return StepReport(command, impression, belief(self.model, accommodated, self.decider.bound), why)

    def _test(self) -> None:
        """Step 8: stop when the task is complete, when it cannot be, or when the limit is reached."""
        decision: Decision = self.decision
        if decision.command is None:
            self.verdict = Verdict(decision.verdict == "done", decision.verdict, decision.why)
            self.finished = True
        elif self.steps >= self.options.max_steps:
            self.verdict = Verdict(False, "limit", f"not done after {self.steps} commands; next: {decision.why}")
            self.finished = True
