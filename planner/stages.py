"""The task in stages: what must be attained, one after the other, and which of it only the way there can fulfil.

Goals without first(...) or then(...) hold together at the end. What a track fulfils (circled, through) comes first,
then what a place fulfils (at, in, beside), all at once.
"""

from dataclasses import dataclass, replace

from kb.language.terms import Fact, Symbol
from kb.task.task import Task

BY_THE_WAY = ("circled",)
CONSTRAINTS = ("not_through",)
FROM_THE_START = ("in", "through", "around")  # what is about where a thing lay at first


@dataclass(frozen=True)
class Stage:
    """Goals that shall hold at one time; those of the way (`circled`) stand alone in their stage.

    followed : another stage comes after it.
    """

    goals: tuple[Fact, ...]
    followed: bool = False

    @property
    def own(self) -> tuple[Fact, ...]:
        """What shall hold for Utak himself."""
        return tuple(goal for goal in self.goals if str(goal.args[0]) == "utak")

    @property
    def carried(self) -> tuple[Fact, ...]:
        """What shall hold for things, which he must carry."""
        return tuple(goal for goal in self.goals if str(goal.args[0]) != "utak")

    @property
    def goes_on(self) -> bool:
        """Is there more to do for Utak when things are where they shall be?"""
        return self.followed or len(self.own) > 0

    def __str__(self) -> str:
        return " and ".join(str(goal) for goal in self.goals)


def stages(task: Task) -> tuple[Stage, ...]:
    """The stages of a task, in order; constraints are not among them."""
    steps: list[list[Fact]] = [[]]
    for fact in task.goals:
        if fact.name == "then":
            steps.append([])
        if fact.name not in CONSTRAINTS:
            steps[-1].append(_inner(fact))
    found = [stage for goals in steps for stage in _ordered(goals)]
    return tuple(replace(stage, followed=stage is not found[-1]) for stage in found)


def constraints(task: Task) -> tuple[Fact, ...]:
    """The constraints of a task, such as not_through(utak, d)."""
    return tuple(fact for fact in task.goals if fact.name in CONSTRAINTS)


def _inner(fact: Fact) -> Fact:
    inner = fact.args[0] if fact.name in ("first", "then") else fact
    assert isinstance(inner, Symbol)
    return inner


def _ordered(goals: list[Fact]) -> list[Stage]:
    by_the_way = [Stage((goal,)) for goal in goals if goal.name in BY_THE_WAY]
    at_the_end = tuple(goal for goal in goals if goal.name not in BY_THE_WAY)
    return by_the_way + ([Stage(at_the_end)] if at_the_end else [])
