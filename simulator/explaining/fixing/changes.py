"""The changes of a scenario: what each is, and the scenario with it.

A change is small and alone; several together are a tuple of changes. Places are (x, y) in squares, table frame.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

from utak.geometry.kernels.arrays import XY
from utak.kb.language.diagnostics import BadInputError
from utak.kb.language.goal_words import CONSTRAINT_GOALS, ROBOT
from utak.kb.language.reader import facts_from_text
from utak.kb.language.terms import Fact
from utak.kb.task.task import Task, inner_goal, start_facts_of, task_from_texts
from utak.simulator.episode.record import fact_lines
from utak.simulator.explaining.fixing.gaps import WIDTH_STEP, Gap, GapSide, widened
from utak.simulator.scenario.expectation import about_things, should_fail
from utak.simulator.scenario.scenario import Scenario
from utak.simulator.scenario.settings import Settings
from utak.simulator.world.world import World

PLACE_EXPECTATIONS = ("inside", "near", "visits", "circles")  # what a thing or Utak must attain


@dataclass(frozen=True)
class Away:
    """A thing is not there."""

    name: str  # its name in the world


@dataclass(frozen=True)
class Wider:
    """A gap is wider, or a new door is made."""

    gap: Gap  # the gap as it is
    side: GapSide  # which of its walls gives way
    steps: int  # by how many steps of `WIDTH_STEP` it is wider; at least 1

    @property
    def by(self) -> float:
        """Return by how many squares it is wider."""
        return self.steps * WIDTH_STEP

    @property
    def width(self) -> float:
        """Return how wide it is then, in squares."""
        return self.gap.width + self.by


@dataclass(frozen=True)
class Dropped:
    """A goal or a constraint is not asked for."""

    index: int  # its number in goal.lp, from 0.
    goal: str  # the fact as text
    is_constraint: bool  # whether it is a constraint (such as not_through) or a wish: nothing that must be attained


@dataclass(frozen=True)
class Led:
    """The robot is led to a place first, by commands that are given to it, and then acts by itself."""

    place: XY  # the place, on free floor
    what: str  # what is to be seen from there, in words


@dataclass(frozen=True)
class MoreCommands:
    """The robot may give more commands."""

    max_steps: int  # how many


WorldChange = Away | Wider | Dropped | Led | MoreCommands


@dataclass(frozen=True)
class Variant:
    """A scenario with changes, ready to be run."""

    scenario: Scenario  # what is run. Its expectations are those that can be asked of it; None when none can.
    settings: Settings
    led: tuple[XY, ...] = ()  # the places to which the robot is led first


def variant_of(scenario: Scenario, settings: Settings, changes: Iterable[WorldChange]) -> Variant | None:
    """Return a scenario with all of some changes; None when they cannot be made."""
    made = tuple(changes)
    if not made:
        return Variant(scenario, settings)
    task: Task | None = scenario.task
    away = {change.name for change in made if isinstance(change, Away)}
    dropped = [change for change in made if isinstance(change, Dropped)]
    left: dict[str, Any] = {
        kind: tuple(thing for thing in getattr(scenario.world, kind) if thing.name not in away)
        for kind in ("movable", "fixed")
    }
    world: World | None = replace(scenario.world, **left)
    for change in made:
        if isinstance(change, Wider) and world is not None:
            world = widened(world, change.gap, change.side, change.by)
        elif isinstance(change, MoreCommands):
            settings = replace(settings, max_steps=change.max_steps)
    if dropped:
        task = without_goals(scenario.task, {change.index for change in dropped})
    if world is None or task is None or _is_wanted(scenario.expectations, away):
        return None
    slow = any(isinstance(change, Led | MoreCommands) for change in made)
    conditions = _conditions(scenario, dropped, away, slow)
    places = tuple(change.place for change in made if isinstance(change, Led))
    return Variant(Scenario(world, task, conditions), settings, places)


def without_goals(task: Task, indices: set[int]) -> Task | None:
    """Return a task without some of its goals (numbers from 0); None when nothing is left to attain."""
    left = [goal for index, goal in enumerate(task.goals) if index not in indices]
    texts = [str(goal) for goal in left]
    if texts and all(goal.name != "first" for goal in left):
        for index, goal in enumerate(left):
            if goal.name == "then" and all(_is_constraint(one) for one in left[:index]):
                texts[index] = f"first({goal.args[0]})"
    try:
        return task_from_texts(fact_lines(start_facts_of(task)), fact_lines(texts))
    except BadInputError:
        return None


def dropped_goals(task: Task) -> list[Dropped]:
    """Return the change that drops each goal and each constraint, where something is left to attain then."""
    changes = [Dropped(index, str(goal), _is_constraint(goal)) for index, goal in enumerate(task.goals)]
    return [change for change in changes if without_goals(task, {change.index}) is not None]


def _is_constraint(goal: Fact) -> bool:
    """Return whether a goal is a constraint on the way, or a wish: the robot need not attain it."""
    return goal.name in CONSTRAINT_GOALS or goal.name == "prefer"


def _is_wanted(expectations: tuple[Fact, ...] | None, away: set[str]) -> bool:
    return any(
        named.name in PLACE_EXPECTATIONS and str(thing) in away
        for fact in expectations or ()
        if fact.name != "weight"
        for named, thing in about_things(fact)
    )


def _conditions(scenario: Scenario, dropped: list[Dropped], away: set[str], slow: bool) -> tuple[Fact, ...] | None:
    """Return what expect.lp asks of a changed scenario; None when nothing."""
    # `within` when commands are added; and, when a goal for Utak or for things is dropped, where Utak or things must
    # be, because expect.lp speaks of all goals together.
    if scenario.expectations is None:
        return None
    failing = should_fail(scenario.expectations)
    goals = (facts_from_text(f"{change.goal}.")[0] for change in dropped if not change.is_constraint)
    subjects = {str(inner_goal(goal).args[0]) == ROBOT for goal in goals}

    def is_asked(fact: Fact) -> bool:
        if fact.name == "fails" or (failing and fact.name in ("unmoved", "within")):
            return False
        if fact.name == "within":
            return not slow
        if fact.name == "unmoved":
            return str(fact.args[0]) not in away
        return (str(fact.args[0]) == ROBOT) not in subjects

    kept = tuple(fact for fact in scenario.expectations if is_asked(fact))
    return kept or None
