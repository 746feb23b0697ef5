"""The outcome of each expectation of a test: met or not, what came instead, and the points."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from utak.kb.language.terms import Fact
from utak.simulator.scenario.expectation import weights_of


class ExpectationOutcome(NamedTuple):
    """One expectation and what came of it."""

    expected: str  # the fact as text
    came: str  # what came instead, in words; '' when the expectation is met
    points: int  # the points that it is worth

    @property
    def met(self) -> bool:
        """Whether the expectation is met."""
        return not self.came

    @property
    def entry(self) -> dict[str, str | int | bool]:
        """The outcome as values of JSON."""
        return {"expected": self.expected, "met": self.met, "came": self.came, "points": self.points}


class PointScore(NamedTuple):
    """Points: those earned and those that could be."""

    earned: int  # the points of the expectations that are met
    possible: int  # the points of all expectations

    def __str__(self) -> str:
        """Return the points in words."""
        return f"{self.earned} of {self.possible} point{'s' * (self.possible != 1)}"


def judge_expectations(
    expectations: Sequence[Fact], missed: Mapping[Fact, str], believed: bool, reason: str
) -> tuple[ExpectationOutcome, ...]:
    """Return the outcome of each tested expectation of expect.lp, in the order of the file."""
    told = dict(missed)
    for fact in expectations:
        if fact.name == "fails" and believed:
            told[fact] = "Utak believes that an impossible task is done"
        elif fact.name == "fails" and not reason:
            told[fact] = "Utak gives no reason"
    return tuple(
        ExpectationOutcome(str(fact), told.get(fact, ""), points) for fact, points in weights_of(expectations).items()
    )


def score(outcomes: Sequence[ExpectationOutcome]) -> PointScore:
    """Return the points of some outcomes."""
    return PointScore(sum(one.points for one in outcomes if one.met), sum(one.points for one in outcomes))
