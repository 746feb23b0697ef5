"""Before the robot gives up it feels walls, and clears what it finds in them."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest

from benchmarks.worlds.filled.doorplugs import plugged_world
from benchmarks.worlds.scenes import write
from tests.kb.drawings import known_model
from tests.planner.situations import all_felt, situation_of, turn_of
from utak.kb.body import Move
from utak.kb.language.reader import facts_from_text
from utak.kb.language.terms import SourceSpan
from utak.kb.task.task import Parameter, Task
from utak.planner.carrying.open_facts import open_facts
from utak.planner.deciding.feeling import feel_walls, feeling_scope, halts
from utak.planner.decision import impossible
from utak.planner.navigation.subgoals import Chosen, Subgoal, choose
from utak.planner.question import Question
from utak.planner.sights.walls import FeelingPlace, WallKind, feeling_places
from utak.planner.situation import Situation
from utak.planner.stages import Stage
from utak.simulator.run.session import Result, Session
from utak.simulator.scenario.scenario import read_scenario
from utak.simulator.scenario.settings import Settings

UTAK = Stage(facts_from_text("in(utak, room(next))."))
CASES = Path("/work/shared/cases")
ROOM = ["b" * 12, *["b" + "." * 10 + "b"] * 4, "b...U......b", *["b" + "." * 10 + "b"] * 4, "b" * 12]


def ended(folder: Path, pull: bool = True) -> Result:
    """Return the result of a run in a scenario of at most 120 commands."""
    from utak.simulator.episode.episode import EpisodeLog
    from utak.simulator.run.robots import make_robot

    with EpisodeLog(folder / "episode.jsonl") as log:
        return Session(read_scenario(folder), Settings(max_steps=120, pull=pull), make_robot, log).run()


def halt_chosen(places: Sequence[FeelingPlace], situation: Situation) -> Subgoal | None:
    """Return the halt that is chosen; None where none is."""
    offered, question = halts(places, situation), Question(situation.rules)
    found = choose(offered, situation.cost_maps, frozenset(), question, situation.rooms)
    return found.subgoal if isinstance(found, Chosen) else None


def test_walls_are_felt_until_none_is_left() -> None:
    model = known_model(ROOM)
    assert isinstance(getattr(feel_walls(turn_of(UTAK, situation_of(model))), "command", None), Move)
    assert not feel_walls(turn_of(UTAK, situation_of(all_felt(model))))
    assert halt_chosen([], situation_of(model)) is None


def test_where_no_door_is_it_does_not_matter_how_many_things_there_are() -> None:
    """No thing makes a door: only walls and what was never seen may."""
    rows = [*ROOM[:2], *["b..ggg.....b"] * 2, *ROOM[4:]]
    situation, given_up = situation_of(all_felt(known_model(rows))), impossible("no way", "no way leads there")
    door, corner = (
        [*open_facts(given_up, situation, feeling_scope(turn_of(Stage(facts_from_text(goal)), situation)))]
        for goal in ("in(x, room(next)).", "at(x, corner(northeast)).")
    )
    assert door == []
    assert "is more than one thing" in corner[0].words


def test_whether_goals_for_one_thing_can_hold_at_once_depends_on_no_other_thing_and_on_no_wall_between_floors() -> None:
    stage = Stage(facts_from_text("at(x, corner(northeast)). at(x, corner(northwest))."))
    x, y = (Parameter(name, "object", SourceSpan(1, 1, 1)) for name in ("x", "y"))
    situation = replace(situation_of(known_model(ROOM)), task=Task({"x": x}, (), stage.goals))
    turn = turn_of(stage, situation)
    assert feeling_scope(turn)[::3] == (True, True)
    assert feeling_scope(replace(turn, agreeing=True))[::3] == (False, False)
    beside = replace(stage, goals=facts_from_text("at(x, corner(northeast)). beside(x, y)."))
    named = replace(situation, task=Task({"x": x, "y": y}, (), beside.goals))
    assert feeling_scope(replace(turn_of(beside, named), agreeing=True)).things


def test_rules_say_in_which_walls_things_are_supposed(tmp_path: Path) -> None:
    """Without the rule a thin wall is felt, behind which floor was seen; with it, one behind which nothing was."""
    rows = ["b" * 22, *["b" + "." * 10 + "b" + "." * 9 + "b"] * 5, "b..U" + "." * 7 + "b" + "." * 9 + "b", "b" * 22]
    situation, rules = situation_of(known_model(rows)), tmp_path / "rules.lp"
    rules.write_text("supposed(K, S, 0) :- counted_wall(K, S, _), K != unseen, not held(_).")
    places, told = feeling_places(situation.cost_maps), []
    for given in ((), (rules,)):
        halt = halt_chosen(places, replace(situation, rules=given))
        assert halt is not None
        told.append(next(set(place.squares) for place in places if place.square == halt.squares[0]))
    assert told == [{WallKind.THIN}, {WallKind.UNSEEN}]


def test_a_room_is_felt_with_few_halts() -> None:
    """A robot that halts where it is told, and feels verge there, has felt the 38 squares of the walls soon."""
    model, halts = known_model(ROOM), 0
    while True:
        situation = situation_of(model)
        scope = feeling_scope(turn_of(UTAK, situation))
        halt = halt_chosen(feeling_places(situation.cost_maps, scope), situation)
        if halt is None:
            break
        row, column = divmod(int(halt.squares[0]), model.labels.shape[1])
        here = (column + model.view.west, row + model.view.south)
        about = {(here[0] + i, here[1] + j): "b" for i in (-1, 0, 1) for j in (-1, 0, 1)}
        solid = {s: c for s, c in about.items() if not model.space[s[1] - model.view.south, s[0] - model.view.west]}
        place = (here[0] + 0.5, here[1] + 0.5)
        model = replace(
            model, place=place, felt={**model.felt, **solid}, looked_from=model.looked_from | frozenset([here])
        )
        halts += 1
    assert not np.any(np.array(halts > 16))


@pytest.mark.long
@pytest.mark.parametrize(
    ("kind", "task", "seed", "pull"),
    [
        ("flush", "next", 0, True),
        ("recessed", "next", 1, False),
        ("out", "next", 0, False),
        ("two", "next", 0, True),
        ("half", "next", 8013, True),
        ("flush", "carry_next", 0, True),
    ],
)
def test_what_fills_a_doorway_is_felt_and_cleared(kind: str, task: str, seed: int, pull: bool, tmp_path: Path) -> None:
    result = ended(write(plugged_world(kind, task, seed), tmp_path / "scenario"), pull)
    assert (result.verdict, result.achieved) == ("done", True), result.reason


@pytest.mark.long
@pytest.mark.parametrize("seed", range(2))
def test_a_room_without_a_door_is_impossible_to_leave_once_its_walls_were_felt(seed: int, tmp_path: Path) -> None:
    result = ended(write(plugged_world("closed", "next", seed), tmp_path / "scenario"))
    assert result.verdict == "impossible", result.reason
    assert result.steps < 60


@pytest.mark.long
@pytest.mark.parametrize(("name", "pull"), [*product(["plugged-door-flush", "plugged-door-recessed"], [True, False])])
def test_known_doorways_that_a_thing_fills_are_passed(name: str, pull: bool, tmp_path: Path) -> None:
    if not (CASES / name).is_dir():
        pytest.skip("the cases are not here")
    for path in (CASES / name).iterdir():
        (tmp_path / path.name).write_bytes(path.read_bytes())
    assert ended(tmp_path, pull).achieved
