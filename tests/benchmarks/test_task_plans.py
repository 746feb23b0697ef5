"""The benchmarks of task plans: their worlds, and strategies of clingo that agree on the best plan."""

import json
from pathlib import Path

import numpy as np
import pytest

from benchmarks.orders import meanings, planning, strategies
from benchmarks.worlds.drawn import drawn_problem, drawn_situation


@pytest.mark.long
def test_all_strategies_find_a_plan_of_the_same_cost() -> None:
    (*decisions,) = strategies._decisions(*planning.house(np.random.default_rng([0, 2, 6]), 2))
    (facts,) = decisions
    found = {name: strategies.solved(facts, options) for name, options in strategies.STRATEGIES.items()}
    assert all(one.proved for one in found.values())
    assert len({one.cost for one in found.values()}) == 1
    (first, *_) = found.values()
    assert strategies.heading([first]).startswith("1 decisions")
    assert strategies.row("bb,lin", [first], [first]).split()[:5] == ["bb,lin", "1", "0", "0", "0"]


def test_decisions_are_read_from_episodes(tmp_path: Path) -> None:
    solved = [["task", ["horizon(1)"], [], []], ["task", [0, 0]], ["rooms", ["neck(0,1,1,1,9)"], [], []]]
    lines = [{"utak": "episode"}, {"step": 0, "belief": {"solved": solved}}, {"result": {}}]
    path = tmp_path / "ep.jsonl"
    path.write_text("".join(json.dumps(line) + "\n" for line in lines))
    assert list(strategies.recorded([path])) == [("horizon(1)",)]


@pytest.mark.parametrize(("rooms", "things", "goals"), [(2, 2, 1), (4, 3, 2), (6, 6, 3), (8, 6, 3)])
def test_a_house_has_its_rooms_things_and_goals(rooms: int, things: int, goals: int) -> None:
    rows, ends = planning.house(np.random.default_rng([1, goals]), goals, rooms, things)
    situation = drawn_situation(rows)
    assert len(situation.model.objects) == things and len(ends) == goals
    assert len(drawn_problem(situation, ends).goals) == goals
    assert len(set(np.unique(situation.rooms.labels)) - {0}) == rooms


def test_the_small_worlds_have_two_things_at_least() -> None:
    numbers = list(planning._small_worlds(0, 5))
    assert numbers == [0, 1, 2, 4, 5]
    assert all(len(planning.small_world(np.random.default_rng([n, 5]))[1]) > 1 for n in numbers)


def test_a_plan_that_may_choose_attains_the_goals_with_each_thing_once(capsys: pytest.CaptureFixture[str]) -> None:
    world = meanings.equal_things(np.random.default_rng([6, 7]), 2)
    situation = drawn_situation(world.rows)
    made, _ = meanings.timed(meanings.problem_with_choice(world, situation), situation)
    assert not made.plan.unmet and sorted(name for _, name in made.plan.meanings) == ["g", "h"]
    assert meanings.main(["--seed", "3", "--count", "1"]) == 0
    assert capsys.readouterr().out.splitlines()[1].split()[0] == "3"
