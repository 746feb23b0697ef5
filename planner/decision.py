"""A decision: the next command, or the verdict with which the task ends. Every part of planning returns one."""

from dataclasses import dataclass
from enum import StrEnum
from typing import Any, NamedTuple

from utak.kb.body import Command, Impression
from utak.planner.question import Question


class TaskVerdict(StrEnum):
    """The end of a task, as episodes write it."""

    DONE = "done"  # every goal is believed to hold
    IMPOSSIBLE = "impossible"  # no plan exists, whatever is still unknown
    POSSIBLE_IF = "possible_if"  # no plan is left, but a named open fact would allow one
    LIMIT = "limit"  # the robot gave up, and nothing is proved


class RobotStep(NamedTuple):
    """A step of the robot itself, as kb/asp/belief.lp declares step/2."""

    name: str
    args: tuple[str | int, ...]  # lengths in hundredths of squares

    def __str__(self) -> str:
        """Return the step as the facts write it."""
        return f"{self.name}({','.join(map(str, self.args))})"


class StepReport(NamedTuple):
    """One turn of the cycle."""

    command: Command | None  # the command that was given; None on waking
    impression: Impression  # what the body returned after it
    belief: dict[str, Any]  # what is believed since, ready for JSON, as `utak.kb.world.facts.belief` returns it.
    why: str  # the reason of the command, in words


class TaskEnd(NamedTuple):
    """The end of the task, as the robot judges it."""

    believed: bool  # whether the robot believes that the task is done
    verdict: TaskVerdict  # the kind of the end
    reason: str  # why, in words


@dataclass(frozen=True)
class Decision:
    """The next command and its reason; or no command, and the verdict; or neither, when nothing is to be done."""

    command: Command | None  # what the body does next, in the robot's own frame; None for none
    why: str  # the reason in words
    # How the task ended, or how it ends as far as one part of it is concerned; None while it goes on
    verdict: TaskVerdict | None = None
    # The open fact that would overturn the verdict, in words; "" when none is known yet, None when there can be none
    unless: str | None = ""
    # The place (x, y) that the verdict is about, in squares, view frame (that of the arrays of the view, x = column, y
    # = row); None for no such place
    near: tuple[float, float] | None = None
    # The steps of the robot with which the plan goes on, the command's own first (planner.steps); () for that one alone
    steps: tuple[RobotStep, ...] = ()
    # What was given to planner/asp/deciding for it; None where it was not chosen among subgoals or ways
    question: Question | None = None
    # What proves the verdict `impossible`, in words, a clause each; that verdict is never given without
    proof: tuple[str, ...] = ()
    # What is proved of these (parameter, node) pairs together, while parameters may mean something else; else nothing
    refuses: frozenset[tuple[str, str]] = frozenset()

    def __post_init__(self) -> None:
        """Refuse a verdict that nothing proves."""
        if self.verdict == TaskVerdict.IMPOSSIBLE and not self.proof:
            raise ValueError(f"nothing proves that this is impossible: {self.why}")

    def __bool__(self) -> bool:
        """Return whether something is decided: a command, or a verdict."""
        return self.command is not None or self.verdict is not None

    @property
    def result(self) -> str:
        """Return the result in the words of planner/asp/deciding: command, idle, settled, or the verdict."""
        if self.command is not None:
            return "command"
        if self.verdict is None:
            return "idle"
        settled = self.verdict == TaskVerdict.IMPOSSIBLE and self.unless is None
        return "settled" if settled else str(self.verdict)


def nothing_to_do(why: str) -> Decision:
    """Return the decision that nothing is to be done."""
    return Decision(None, why)


def impossible(
    why: str, *proof: str, unless: str | None = "", refuses: frozenset[tuple[str, str]] = frozenset()
) -> Decision:
    """Return the verdict `impossible`."""
    return Decision(None, why, TaskVerdict.IMPOSSIBLE, unless, proof=proof, refuses=refuses)


def done(why: str) -> Decision:
    """Return the decision that what was asked for holds."""
    return Decision(None, why, TaskVerdict.DONE)


def command_or_nothing(decision: Decision, why: str = "") -> Decision:
    """Return a decision that has a command; that nothing is to be done, for the same reason or another, for others."""
    return decision if decision.command is not None else nothing_to_do(why or decision.why)
