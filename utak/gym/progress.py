"""Which expectations of expect.lp are met, halt after halt.

`utak.simulator.scenario.expectation` judges each of them, over as much of the track as it needs.
"""

from collections.abc import Mapping, Sequence
from operator import is_
from typing import Any

from utak.kb.language.terms import Fact
from utak.simulator.scenario.expectation import (
    MIN_CIRCLING_DEGREES,
    Snapshot,
    about_things,
    number_of,
    unmet,
    weights_of,
    winding,
)
from utak.simulator.world.world import World

NOT_OF_THE_TABLE = ("fails", "verdict")  # expectations about what a mind says
TIME_LIMIT = "within"  # the expectation about the number of commands
DECIDED = {"visits": True, "avoids": False}  # expectations that one halt can decide for good, and whether as met
WHOLE_TRACK = ("before",)  # expectations that need all halts; the first and the newest suffice for the others


class ExpectationProgress:
    """The progress of one play towards what is expected."""

    def __init__(self, expectations: Sequence[Fact], world: World) -> None:
        points = {fact: n for fact, n in weights_of(expectations).items() if fact.name not in NOT_OF_THE_TABLE}
        self._watches = [_Watch(fact, world) for fact in points]
        self._points = [0 if fact.name == TIME_LIMIT else number for fact, number in points.items()]
        self._fixed = {thing.name: thing.polygon for thing in world.fixed}
        self._failing = any(fact.name == "fails" for fact in expectations)
        self.share, self.achieved = 0.0, False

    def see(self, step: int, utak: tuple[float, float], polygons: Mapping[str, Any]) -> None:
        """Take in a halt; step 0 is that of waking."""
        halt = Snapshot(step, utak, {**self._fixed, **polygons})
        met = [watch.see(halt) for watch in self._watches]
        most = sum(self._points)
        self.share = sum(n for n, is_met in zip(self._points, met, strict=True) if is_met) / most if most else 0.0
        self.achieved = bool(met) and not self._failing and all(met)


class _Watch:
    """One expectation, judged at each halt of a play."""

    def __init__(self, fact: Fact, world: World) -> None:
        self._fact, self._world = fact, world
        walker = ["utak"] if fact.name == "circles" else []
        self._names = [*walker, *(str(name) for _, name in about_things(fact))]  # those whose places decide it
        self._places: list[Any] = []  # theirs at the last halt
        self._track: list[Snapshot] = []
        self._met, self._degrees = False, 0.0  # so far; by how much the robot's track winds

    def see(self, halt: Snapshot) -> bool:
        """Take in a halt, and return whether the expectation is met now."""
        name, before, left = self._fact.name, self._track, self._places
        if before and self._met is DECIDED.get(name):
            return self._met
        places = (halt.utak if one == "utak" else halt.polygons[one] for one in self._names)
        self._places = [*places] if self._names else [halt.step]  # what is about no thing counts commands
        if before and all(map(is_, left, self._places)):  # nothing moved: no play has the time to judge each halt
            return self._met
        self._track = [*(before if name in WHOLE_TRACK else before[:1]), halt]
        if name == "circles":
            self._degrees += winding([*before, halt], str(self._fact.args[1]))
            self._track, self._met = [halt], abs(self._degrees) >= MIN_CIRCLING_DEGREES
        else:
            self._met = not unmet([self._fact], self._world, self._track)
        return self._met


def time_limit(expectations: Sequence[Fact]) -> int | None:
    """Return the least number of commands that `within` allows; None without one."""
    return min((number_of(fact) for fact in expectations if fact.name == TIME_LIMIT), default=None)
