"""The search finds just the smallest changes that work: held against brute force in a world of exact physics.

The robot here is a plain machine: it grasps what is east of it, pushes it east by a fixed way, and says that it is
done. Whether it is, the table itself decides, by expect.lp. So a run takes milliseconds, and all changes can be run.
"""

from itertools import chain, combinations, product
from typing import Any

import pytest
import shapely

from utak.kb.body import Body, Command, Grasp, Push
from utak.kb.language.reader import facts_from_text
from utak.kb.task.task import Task, task_from_texts
from utak.planner.cycle import StepReport, TaskEnd
from utak.simulator.episode.episode import Episode
from utak.simulator.episode.record import fact_lines
from utak.simulator.explaining.fixing.changes import (
    Away,
    Dropped,
    MoreCommands,
    Wider,
    WorldChange,
    variant_of,
    without_goals,
)
from utak.simulator.explaining.fixing.gaps import Gap, GapSide, passages_of
from utak.simulator.explaining.fixing.proving import Budget
from utak.simulator.explaining.fixing.recorded import RecordedRun
from utak.simulator.explaining.fixing.search import FixReport, find_fixes
from utak.simulator.run.embodiment import Embodiment
from utak.simulator.scenario.scenario import Scenario
from utak.simulator.scenario.settings import Settings
from utak.simulator.world.physics import Tabletop
from utak.simulator.world.world import Thing, World

WAY = 9.0  # squares that the machine pushes
START = {"objects": {}, "held": "t", "utak": [3.5, 4.5]}


class Machine:
    """A robot that grasps, pushes east in a number of commands, and says that it is done."""

    def __init__(self, body: Body, task: Task, settings: Settings) -> None:
        self._body, self._left = body, [Grasp("east"), *[Push(WAY / 3, 0.0)] * 3]
        self._allowed = settings.max_steps
        self._given = 0

    def wake(self) -> StepReport:
        return StepReport(None, self._body.wake(), {"facts": []}, "wakes")

    def step(self) -> StepReport:
        return self.follow(self._left.pop(0), "")

    def follow(self, command: Command, why: str) -> StepReport:
        self._given += 1
        return StepReport(command, self._body.act(command), {"facts": []}, "as it was built")

    @property
    def finished(self) -> bool:
        return not self._left or self._given >= self._allowed

    @property
    def verdict(self) -> TaskEnd:
        return TaskEnd(not self._left, "limit" if self._left else "done", "as it was built")


def corridor(*things: Thing, doors: tuple[tuple[float, float], ...] = ((3.75, 5.25),), posts: Any = ()) -> World:
    """Return rooms in a row, divided by walls of thickness 1 with doors from y to y; thing t is pushed east."""
    table = shapely.box(0, 0, 20, 9)
    floor = [shapely.box(1, 1, 19, 8)]
    walls = [
        shapely.box(7 + 3 * k, 1, 8 + 3 * k, 8).difference(shapely.box(7 + 3 * k, low, 8 + 3 * k, high))
        for k, (low, high) in enumerate(doors)
    ]
    verge = table.difference(shapely.union_all(floor).difference(shapely.union_all(walls)))
    t = Thing("t", "t", shapely.box(4, 3.5, 6, 5.5))
    return World(20, 9, verge, (*things, t), tuple(posts), (3.5, 4.5), 0)


def scenario_of(world: World, expect: str = 'visits(t, "POLYGON ((13 1, 19 1, 19 8, 13 8, 13 1))")') -> Scenario:
    """Return the scenario in which t must come to the east."""
    task = task_from_texts("object(x). shape(x,square).", "in(x,room(next)).")
    return Scenario(world, task, facts_from_text(fact_lines([expect])) if expect else None)


def found_in(scenario: Scenario, runs: int = 400, max_steps: int = 50) -> FixReport:
    """Return what the search finds."""
    run = RecordedRun(scenario, Settings(max_steps=max_steps), Episode({}, (START,), None))
    return find_fixes(run, Budget(runs), make=Machine)


def works(scenario: Scenario, changes: tuple[WorldChange, ...]) -> bool:
    """Return whether t is in the east after the pushes: by the physics alone, without the code under test."""
    variant = variant_of(scenario, Settings(), changes)
    if variant is None:
        return False
    table = Tabletop(variant.scenario.world)
    body = Embodiment(table)
    body.act(Grasp("east"))
    for _ in range(3):
        body.act(Push(WAY / 3, 0.0))
    return bool(table.polygons["t"].bounds[0] >= 12)


def minimal_by_brute_force(scenario: Scenario, names: list[str], gaps: list[Gap], most: int) -> set[tuple[Any, ...]]:
    """Return all changes of at most two parts that work while nothing smaller does; a gap on each side alone.

    A change is smaller when a part is left out, or when a gap on the same side is wider by fewer steps.
    """
    options = [[None, Away(name)] for name in names]
    options += [[None, *(Wider(gap, side, steps) for side in GapSide for steps in range(1, most + 1))] for gap in gaps]
    working = []
    for chosen in product(*options):
        changes = tuple(change for change in chosen if change is not None)
        if 0 < len(changes) <= 2 and works(scenario, changes):
            working.append(frozenset(changes))

    def is_smaller(one: frozenset[WorldChange], other: frozenset[WorldChange]) -> bool:
        return one != other and all(
            any(
                part == whole
                or (
                    isinstance(part, Wider)
                    and isinstance(whole, Wider)
                    and (part.gap, part.side) == (whole.gap, whole.side)
                    and part.steps <= whole.steps
                )
                for whole in other
            )
            for part in one
        )

    return {one for one in working if not any(is_smaller(other, one) for other in working)}


BLOCK = Thing("k", "k", shapely.box(13, 3, 14, 6))  # in the way beyond the door: t would stop at x = 11
BESIDE = Thing("m", "m", shapely.box(2, 1, 3, 2))  # in nobody's way
POST = Thing("p", "p", shapely.box(8.5, 4, 9, 5))  # fixed, in the way before x = 12


@pytest.mark.long
@pytest.mark.parametrize(
    ("world", "names"),
    [
        (corridor(BESIDE), ["m"]),
        (corridor(BESIDE, doors=((3.5, 5.5),), posts=[POST]), ["m", "p"]),
        (corridor(BESIDE, posts=[POST]), ["m", "p"]),
        (corridor(doors=((3.75, 5.25), (3.5, 5.25))), []),
        (corridor(BLOCK, doors=((3.75, 5.5),)), ["k"]),
        (corridor(BESIDE, doors=((3.0, 4.5),)), ["m"]),
    ],
    ids=["door", "post", "door-and-post", "two-doors", "block", "door-aside"],
)
def test_what_is_found_is_minimal_and_a_smallest_is_found(world: World, names: list[str]) -> None:
    scenario = scenario_of(world)
    assert not works(scenario, ())
    gaps = [gap for gap in passages_of(world) if gap.width < 3]
    report = found_in(scenario)
    assert report.ended == ""
    expected = minimal_by_brute_force(scenario, names, gaps, most=8 if len(gaps) == 1 else 3)
    assert expected
    found = {frozenset(fix.changes) for fix in report.fixes}
    assert found
    assert found <= expected
    assert all(fix.is_smallest and fix.is_least for fix in report.fixes)

    def kinds(changes: frozenset[WorldChange]) -> frozenset[Any]:
        """Return which things and gaps are changed, whatever the side and the width."""
        return frozenset(change.gap if isinstance(change, Wider) else change for change in changes)

    def width(changes: frozenset[WorldChange]) -> float:
        """Return by how much gaps are wider, in all."""
        return sum(change.by for change in changes if isinstance(change, Wider))

    assert {kinds(one) for one in found} == {kinds(one) for one in expected}
    singles = [one for one in found if len(one) == 1]
    for one in singles:  # of a single gap the side is taken on which the fewest steps suffice
        assert width(one) == min(width(other) for other in expected if kinds(other) == kinds(one))


def test_geometry_refutes_what_need_not_be_run() -> None:
    world = corridor(BESIDE, doors=((3.75, 5.25), (3.75, 5.25)))
    plain = found_in(scenario_of(world))
    proved = found_in(scenario_of(world, 'inside(t, "POLYGON ((12 1, 19 1, 19 8, 12 8, 12 1))")'))
    assert [fix.changes for fix in proved.fixes] == [fix.changes for fix in plain.fixes]
    assert proved.runs < plain.runs
    assert all(not works(proved.run.scenario, changes) for changes, outcome in proved.tried if outcome.refuted)


def test_without_expectations_the_verdict_counts() -> None:
    report = found_in(scenario_of(corridor(), ""))
    assert report.is_needless
    assert report.fixes == ()


def test_the_same_budget_gives_the_same_answer_and_says_that_it_ended() -> None:
    scenario = scenario_of(corridor(BESIDE))
    full = found_in(scenario)
    assert full.ended == ""
    for runs in (1, 3, full.runs - 1):
        report = found_in(scenario, runs)
        assert report.runs == runs
        assert report.ended == (f"the budget of {runs} runs ended" if runs < full.runs else "")
        again = found_in(scenario, runs)
        assert [fix.changes for fix in again.fixes] == [fix.changes for fix in report.fixes]
        assert all(works(scenario, fix.changes) for fix in report.fixes)
        if runs < full.runs:
            assert (
                not all(fix.is_least for fix in report.fixes if isinstance(fix.changes[0], Wider)) or not report.fixes
            )


def test_no_time_ends_at_once() -> None:
    run = RecordedRun(scenario_of(corridor()), Settings(), Episode({}, (START,), None))
    report = find_fixes(run, Budget(10, 0.0), make=Machine)
    assert report.before is None
    assert "0 seconds" in report.ended


def test_more_commands_are_exactly_those_that_are_needed() -> None:
    scenario = scenario_of(corridor(doors=()), 'inside(t, "POLYGON ((12 1, 19 1, 19 8, 12 8, 12 1))")')
    report = found_in(scenario, max_steps=2)
    (more,) = [fix for fix in report.fixes if isinstance(fix.changes[0], MoreCommands)]
    assert more.changes == (MoreCommands(4),)
    for allowed, enough in ((3, False), (4, True)):
        unchanged = found_in(scenario, 1, allowed)
        assert unchanged.is_needless == enough


def test_a_thing_that_is_wanted_somewhere_stays() -> None:
    scenario = scenario_of(corridor(BLOCK))
    assert variant_of(scenario, Settings(), [Away("t")]) is None
    assert variant_of(scenario, Settings(), [Away("k")]) is not None


def test_expectations_of_a_failure_do_not_bind_the_changed_scenario() -> None:
    scenario = scenario_of(corridor(BLOCK), "fails")
    facts = facts_from_text(
        fact_lines(["fails", "unmoved(k)", "within(9)", 'inside(t,"POLYGON ((12 1, 19 1, 19 8, 12 8, 12 1))")'])
    )
    variant = variant_of(Scenario(scenario.world, scenario.task, facts), Settings(), [Away("k")])
    assert variant is not None
    assert variant.scenario.expectations == facts[3:]
    kept = variant_of(Scenario(scenario.world, scenario.task, facts[1:]), Settings(), [Away("k")])
    assert kept is not None
    assert kept.scenario.expectations == facts[2:]


def test_goals_are_dropped_so_that_a_task_is_left() -> None:
    start = "object(x). door(d)."
    task = task_from_texts(start, "first(at(utak,x)). then(at(utak,start)). not_through(utak,d).")
    first, second, constraint = (without_goals(task, {index}) for index in range(3))
    assert first is not None and [str(goal) for goal in first.goals] == [
        "first(at(utak,start))",
        "not_through(utak,d)",
    ]
    assert second is not None and [str(goal) for goal in second.goals] == ["first(at(utak,x))", "not_through(utak,d)"]
    assert constraint is not None and [str(goal) for goal in constraint.goals] == [
        "first(at(utak,x))",
        "then(at(utak,start))",
    ]
    for indices in chain.from_iterable(combinations(range(3), size) for size in (2, 3)):
        left = without_goals(task, set(indices))
        assert (left is None) == ({0, 1} <= set(indices))


def test_a_dropped_goal_takes_its_expectations_with_it() -> None:
    task = task_from_texts("object(x).", "at(x,corner(northeast)). at(utak,start).")
    facts = facts_from_text(
        fact_lines(['near(utak,"POINT (3 4)",1)', 'inside(t,"POLYGON ((12 1, 19 1, 19 8, 12 8, 12 1))")'])
    )
    scenario = Scenario(corridor(), task, facts)
    for index, kept in ((0, facts[:1]), (1, facts[1:])):
        variant = variant_of(scenario, Settings(), [Dropped(index, str(task.goals[index]), False)])
        assert variant is not None
        assert variant.scenario.expectations == kept
