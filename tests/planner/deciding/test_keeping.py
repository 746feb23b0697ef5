"""Constraints on the way, in whole runs: kept in truth, and named where they leave no way."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import shapely

from tests.planner.carrying.test_carrying import run, scene
from tests.planner.situations import known_situation
from tests.planner.test_constraints import ROWS, box, situation_for
from utak.kb.body import Move
from utak.kb.language.reader import facts_from_text
from utak.kb.task.task import Task
from utak.planner.deciding.keeping import ConstraintKeeper
from utak.planner.decision import Decision, TaskVerdict
from utak.simulator.episode.episode import EpisodeLog
from utak.simulator.run.robots import make_robot
from utak.simulator.run.session import Session
from utak.simulator.scenario.scenario import read_scenario
from utak.simulator.scenario.settings import Settings

EXAMPLES = Path(__file__).resolve().parents[3] / "examples"
TWO_ROOMS = """table(32, 16).
verge("POLYGON ((0 0, 0 16, 32 16, 32 0, 0 0), (15 2, 15 6, 17 6, 17 2, 30 2, 30 14, 17 14, 17 10, 15 10, 15 14, 2 14,
 2 2, 15 2))").
utak("POINT (10.5 8.5)", 0).
""".replace(",\n ", ", ")
SQUARE = 'object(t, g, "POLYGON ((5 7, 5 9, 7 9, 7 7, 5 7))").'


def keeper_of(text: str) -> ConstraintKeeper:
    return ConstraintKeeper(Task({}, (), facts_from_text(text)))


def true_tracks(folder: Path, name: str = "") -> tuple[Any, Any]:
    """Return the true track of the robot as a line, and what a thing covered at the steps of a run, table frame."""
    session = Session(read_scenario(folder), Settings(), make_robot, EpisodeLog(None))
    session.wake()
    places, outlines = [session.table.utak], []
    while not session.finished:
        session.step()
        places.append(session.table.utak)
        outlines += [session.table.polygons[name]] if name else []
    assert session.end().believed
    return shapely.LineString(places), shapely.union_all(outlines)


def test_the_true_track_of_the_robot_never_touches_its_region() -> None:
    line, _ = true_tracks(EXAMPLES / "go_northeast_avoiding")
    assert line.length > 20 and not line.intersects(shapely.box(8, 8, 18, 16))


@pytest.mark.long
def test_a_thing_never_touches_its_region_in_truth() -> None:
    _, covered = true_tracks(EXAMPLES / "push_square_avoiding", "g1")
    assert not covered.is_empty and not covered.intersects(shapely.box(15.5, 6.5, 19.5, 20.5))


@pytest.mark.long
@pytest.mark.parametrize(
    ("start", "goal", "named", "verdicts"),
    [
        (
            "",
            f'in(utak, room(next)). avoid(utak, "{box(3, -4, 8, 4)}").',
            "leaves no way",
            ("possible_if", "limit"),
        ),
        ("", f'in(utak, room(next)). avoid(utak, "{box(5.2, -9, 5.8, 9)}").', "leaves no way", ("limit",)),
        (
            "",
            f'at(utak, start). avoid(utak, "{box(-1, -1, 1, 1)}").',
            "the robot wakes in that region",
            ("impossible",),
        ),
    ],
)
def test_a_region_that_leaves_no_way_is_named(
    start: str, goal: str, named: str, verdicts: tuple[str, ...], tmp_path: Path
) -> None:
    result = run(scene(tmp_path, TWO_ROOMS, start, goal)).result
    assert result.verdict in verdicts and named in result.reason and "avoid(utak," in result.reason


@pytest.mark.long
def test_a_verdict_that_stands_without_the_constraint_does_not_name_it(tmp_path: Path) -> None:
    small = 'table(12, 12).\nverge("POLYGON ((0 0, 12 0, 12 12, 0 12, 0 0), (2 2, 2 10, 10 10, 10 2, 2 2))").\n'
    goal = f'in(utak, room(next)). avoid(utak, "{box(40, 40, 42, 42)}").'
    result = run(scene(tmp_path, small + 'utak("POINT (5.5 5.5)", 0).', "", goal)).result
    assert result.verdict in ("impossible", "possible_if") and "avoid" not in result.reason


@pytest.mark.long
def test_nothing_is_carried_through_a_door(tmp_path: Path) -> None:
    goal = "in(x, room(next)). carry_nothing_through(d)."
    found = run(scene(tmp_path, TWO_ROOMS + SQUARE, "object(x). shape(x, square). door(d).", goal))
    assert not found.result.believed and "carry_nothing_through(d) leaves no way" in found.result.reason
    assert found.session.table.polygons["t"].bounds[2] <= 15.0 + 1e-6


def test_a_command_into_the_region_is_not_given() -> None:
    text = f'at(utak, start). avoid(utak, "{box(1, -1, 3, 1)}").'
    found, keeper = situation_for(text), keeper_of(text)
    assert keeper.guarded(Decision(Move(0.0, 2.0), "north"), found).command == Move(0.0, 2.0)
    stopped = keeper.guarded(Decision(Move(2.0, 0.0), "east"), found)
    assert stopped.command is None and stopped.verdict == TaskVerdict.LIMIT


def test_a_track_through_the_region_is_not_done() -> None:
    text = f'at(utak, start). avoid(utak, "{box(1, -1, 3, 1)}").'
    found, keeper = situation_for(text), keeper_of(text)
    assert keeper.doubt_of_done(replace(found, track=((0.5, 0.5), (0.5, 4.5)))) == ""
    crossed = replace(found, track=((0.5, 0.5), (4.5, 0.5), (0.5, 4.5)))  # its ends are outside
    assert "touched that region" in keeper.doubt_of_done(crossed)


@pytest.mark.parametrize("west", [-9.2, -6.85, -6.4, -4.0, -2.3, -2.0, 0.1])
def test_a_thing_that_was_never_moved_is_held_against_its_region(west: float) -> None:
    """The thing lies from -5.5 to -2.5 east of the robot, which woke in the middle of a square."""
    text = f'at(utak, start). avoid(x, "{box(west, -3, west + 1.2, 0)}").'
    found, keeper = situation_for(text), keeper_of(text)
    keeper.note(found.model)
    lies = shapely.box(-5.5, -2.5, -2.5, 0.5)
    region = shapely.box(west, -3, west + 1.2, 0)
    expected = "touched" if lies.intersects(region) else "close" if lies.distance(region) <= 0.25 else ""
    assert expected in keeper.doubt_of_done(found) and bool(expected) == bool(keeper.doubt_of_done(found))


def test_a_parameter_that_means_nothing_known_cannot_be_told() -> None:
    text = f'at(utak, start). avoid(z, "{box(4, 4, 5, 5)}").'
    found = situation_for(text)
    assert "nothing seen so far is z" in keeper_of(text).doubt_of_done(found)
    lost = replace(found, model=replace(found.model, anew=True))
    assert "nothing seen since the map was begun anew is z" in keeper_of(text).doubt_of_done(lost)
    assert keeper_of("at(utak, start).").doubt_of_done(known_situation(ROWS)) == ""
