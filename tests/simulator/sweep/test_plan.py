"""The plan of a sweep: ranges of seeds, names of scenarios, the order of runs, shards, and what names a run."""

from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from utak.simulator.scenario.settings import Settings
from utak.simulator.sweep.contents import ScenarioContents, names_of, read_contents, written
from utak.simulator.sweep.plan import SweepPlan, SweepRun, parse_seeds

ONE = ScenarioContents("one", (("world.txt", "U"), ("goal.lp", "x")))
TWO = ScenarioContents("two", (("world.txt", "U."), ("goal.lp", "x")))
PLAN = SweepPlan((ONE, TWO), ((3, 5), (9, 10)), (0.1, 0.0))


@given(st.lists(st.integers(0, 2**63 - 1), min_size=1, max_size=6, unique=True))
def test_seeds_are_read_in_their_order(seeds: list[int]) -> None:
    ranges = parse_seeds(",".join(map(str, seeds)))
    assert [seed for first, end in ranges for seed in range(first, end)] == seeds


@pytest.mark.parametrize(
    "text", ["", ":", "1:", ":2", "1:1", "2:1", "-1:2", "1:2:3", "a", "1,,2", "1.5", "\u0661", "0:5,4", "1" * 30]
)
def test_other_seeds_are_refused_with_a_reason(text: str) -> None:
    with pytest.raises(ValueError, match="seed"):
        parse_seeds(text)


def test_the_greatest_seed_is_one_that_a_run_takes() -> None:
    assert parse_seeds(f"{2**63 - 1}") == ((2**63 - 1, 2**63),)
    with pytest.raises(ValueError, match="below"):
        parse_seeds(f"0:{2**63 + 1}")


def test_runs_are_ordered_by_scenario_noise_and_seed() -> None:
    assert len(PLAN.runs) == PLAN.size == 12
    assert PLAN.runs[:4] == tuple(SweepRun("one", *rest) for rest in [(0.1, 3), (0.1, 4), (0.1, 9), (0.0, 3)])
    assert PLAN.runs[6] == SweepRun("two", 0.1, 3)


def test_a_task_carries_the_texts_of_its_scenario() -> None:
    plan = replace(PLAN, settings=Settings(paths="grid", pull=False), rules=(("r.lp", "a."),), seconds=7.0)
    task = plan.task(SweepRun("two", 0.1, 9))
    assert task.argument["files"] == [["world.txt", "U."], ["goal.lp", "x"]]
    assert task.argument["rules"] == [["r.lp", "a."]]
    options = task.argument["options"]
    assert (options["paths"], options["pull"], options["seed"], task.seconds) == ("grid", False, 9, 7)


RUN = SweepRun("one", 0.1, 3)


@pytest.mark.parametrize(
    "change",
    [
        {"scenarios": (ONE._replace(files=(("world.txt", "U"), ("goal.lp", "y"))), TWO)},
        {"settings": Settings(max_steps=3)},
        {"settings": Settings(paths="grid")},
        {"settings": Settings(pull=False)},
        {"rules": (("r.lp", "a."),)},
        {"seconds": 1.0},
    ],
)
def test_the_name_of_a_run_tells_what_decides_its_result(change: dict[str, object]) -> None:
    assert replace(PLAN, **change).run_id(RUN) != PLAN.run_id(RUN)  # type: ignore[arg-type]


def test_the_name_of_a_run_depends_on_nothing_else() -> None:
    assert len({PLAN.run_id(run) for run in PLAN.runs}) == PLAN.size
    assert PLAN.run_id(RUN) == PLAN.run_id(RUN)
    changes = {"settings": Settings(seed=5, noise=0.5, kb_files=("x",)), "seeds": ((3, 4),), "shard": (2, 7)}
    assert replace(PLAN, scenarios=(ONE,), **changes).run_id(RUN) == PLAN.run_id(RUN)  # type: ignore[arg-type]
    moved = replace(PLAN, scenarios=(ONE._replace(name="moved"),))
    assert moved.run_id(RUN._replace(scenario="moved")) == PLAN.run_id(RUN)


@pytest.mark.parametrize("number", [1, 2, 5, 50])
def test_shards_are_the_whole(number: int) -> None:
    shards = [replace(PLAN, shard=(which, number)).runs for which in range(1, number + 1)]
    assert sorted(run for shard in shards for run in shard) == sorted(PLAN.runs)
    assert max(map(len, shards)) - min(map(len, shards)) <= 1


def test_names_are_as_short_as_they_can_be() -> None:
    paths = ["/a/go", "/b/go", "/b/come", "/c/b/go"]
    assert names_of([Path(path) for path in paths]) == ["a/go", "/b/go", "come", "c/b/go"]


def test_contents_survive_their_journey(tmp_path: Path) -> None:
    (tmp_path / "goal.lp").write_bytes(b"at(utak, x).\r\n% \ttext\n")
    (tmp_path / "other.txt").write_text("not a file of a scenario")
    contents = read_contents(tmp_path, "name")
    assert [name for name, _ in contents.files] == ["goal.lp"]
    with written(contents.files) as folder:
        assert (folder / "goal.lp").read_bytes() == (tmp_path / "goal.lp").read_bytes()
        assert read_contents(folder, "name").digest == contents.digest
    assert not folder.exists()
