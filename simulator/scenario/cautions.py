"""Warnings of `utak check` about scenarios that can be run but are hardly meant so."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import shapely

from utak.kb.language.arguments import decimal_value
from utak.kb.language.diagnostics import BadInputError, Problem
from utak.kb.language.goal_words import ROBOT
from utak.kb.language.source_text import read_source
from utak.kb.language.terms import Fact, Text
from utak.simulator.scenario.expectation import EXPECTATION_TOLERANCE, region_of
from utak.simulator.scenario.scenario import Scenario
from utak.simulator.scenario.trialfile import TRIAL_FILE, query_of, read_trial_plan
from utak.simulator.world.world import World


def cautions(folder: Path, scenario: Scenario) -> Iterator[Problem]:
    """Yield what a scenario hardly means."""
    # Regions where nothing can be, steps without a next one, hopeless questions.
    goals = scenario.task.goals
    if goals and not any(goal.name == "then" for goal in goals):
        source = read_source(folder / "goal.lp")
        hint = "state the next step with then(G), or leave first( ) out"
        for goal in goals:
            if goal.name == "first":
                yield source.problem(goal.span, "a first step without a next one", hint)
    if scenario.expectations:
        source = read_source(folder / "expect.lp")
        for fact in scenario.expectations:
            if what := _unattainable(fact, scenario.world):
                yield source.problem(fact.span, what)
    if (folder / TRIAL_FILE).exists():
        yield from _hopeless_questions(folder / TRIAL_FILE)


def _unattainable(fact: Fact, world: World) -> str:
    """Return why an expectation about a region is hardly meant, in words; '' where it may be."""
    if fact.name not in ("inside", "near", "visits", "avoids") or not isinstance(fact.args[1], Text):
        return ""
    region, table = region_of(fact), shapely.box(0, 0, world.width, world.height)
    allowed = float(decimal_value(fact.args[2])) if fact.name == "near" else EXPECTATION_TOLERANCE
    if region.distance(table) > allowed:
        return "the region lies off the table"
    name = str(fact.args[0])
    if fact.name != "inside" or name == ROBOT:
        return ""
    thing = next((one.polygon for one in (*world.movable, *world.fixed) if one.name == name), None)
    room = region.intersection(table).buffer(2 * EXPECTATION_TOLERANCE)
    if thing is not None and (thing.area > room.area or _inner_radius(thing) > _inner_radius(room)):
        return f"the region is smaller than {name}"
    return ""


def _inner_radius(shape: Any) -> float:
    """Return the radius of the largest circle within a shape, to a thousandth; what fits into another has no larger."""
    parts = shapely.get_parts(shape)
    return max(float(shapely.maximum_inscribed_circle(part, tolerance=1e-4).length) for part in parts)


def _hopeless_questions(path: Path) -> Iterator[Problem]:
    """Yield the questions of trial.lp that no world model answers, with its rules: the predicate is unknown, say."""
    from utak.kb.reasoning.query import QueryEngine  # only where something is asked: it takes time

    plan, source = read_trial_plan(path), read_source(path)
    if not plan.asks:
        return
    with QueryEngine(rules=plan.rules) as engine:
        for asked in plan.asks:
            try:
                engine.ask([], query_of(asked))
            except BadInputError as bad:
                yield source.problem(asked.span, f"nothing answers this: {bad.problems[0].what}", bad.problems[0].hint)
