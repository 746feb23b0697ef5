"""The campaign tells an honest robot from one that makes false claims, one that idles and one that breaks."""

import json
import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest

from benchmarks import campaign
from benchmarks.harness.beliefs import Score
from benchmarks.harness.judging import judge_path
from benchmarks.harness.narrowness import Narrowness, narrowness
from benchmarks.harness.stopwatch import Seconds
from benchmarks.harness.tally import faults, table, verdicts
from benchmarks.harness.tally import narrowness as told_right
from benchmarks.harness.trial import CampaignTrial, Conditions, run_trial, trial_of, trial_of_outcome, trial_task
from benchmarks.worlds.makers import scenario, seeds
from benchmarks.worlds.scenes import RandomScenario
from tests.scripted import Scripted
from utak.kb.body import Body, Command, Move
from utak.kb.perception.frame import turned
from utak.kb.task.task import Task
from utak.planner.cycle import TaskEnd
from utak.simulator.scenario.settings import Settings
from utak.simulator.sweep.executors.tasks import TaskOutcome, WorkerTask, carry_out


def maker(commands: list[Command], verdict: TaskEnd) -> Callable[[Body, Task, Settings], Scripted]:
    """Return a maker of such robots."""
    return lambda body, task, settings: Scripted(body, commands, verdict)


DONE = TaskEnd(True, "done", "I am there")
GIVES_UP = TaskEnd(False, "impossible", "there is no way")
HERE = Move(0.0, 0.0)


def straight_seed() -> int:
    """Return a world of task (i) with nothing between the robot and the corner."""
    return next(s for s in range(100) if not (w := scenario(1, s)).things and len(w.plan.rooms) == 1 and w.possible)


def way_to_target(seed: int) -> Move:
    """Return the straight move to the target of task (i), in the robot's own frame."""
    world = scenario(1, seed)
    middle = world.target.centroid
    dx, dy = middle.x - world.utak.x, middle.y - world.utak.y
    c, s = math.cos(math.radians(world.heading)), math.sin(math.radians(world.heading))
    return Move(dx * c + dy * s, -dx * s + dy * c)


def test_an_honest_walk_is_achieved_judged_and_measured(tmp_path: Path) -> None:
    seed = straight_seed()
    trial = run_trial(1, seed, Conditions(), tmp_path, maker=maker([way_to_target(seed)], DONE))
    assert (trial.crash, trial.achieved, trial.believed, trial.steps) == ("", True, True, 1)
    assert trial.right and not trial.false_done
    assert 1.0 <= trial.walked / trial.shortest < 1.4
    assert len(trial.cycles) == 2 and all(0 <= cycle.wall < 1 for cycle in trial.cycles)
    assert trial.judged == ([] if judge_path() else None)
    assert faults([trial]) == ""


def test_a_false_done_is_found(tmp_path: Path) -> None:
    trial = run_trial(1, straight_seed(), Conditions(), tmp_path, maker=maker([HERE], DONE))
    assert trial.false_done and not trial.right
    assert "FALSE DONE" in faults([trial])


def test_giving_up_is_right_only_where_it_cannot_be_done(tmp_path: Path) -> None:
    seeds = {True: 0, False: 11}
    for possible, seed in seeds.items():
        trial = run_trial(3, seed, Conditions(), tmp_path, maker=maker([HERE], GIVES_UP))
        assert trial.possible == possible
        assert trial.right == (not possible)
        assert not trial.judged or possible


def test_a_robot_that_breaks_is_a_crash_and_does_not_end_the_campaign(tmp_path: Path) -> None:
    def broken(body: Body, task: Task, settings: Settings) -> Scripted:
        raise KeyError("no mind")

    trial = run_trial(2, 0, Conditions(), tmp_path, maker=broken)
    assert trial.crash.startswith("KeyError: 'no mind' (test_campaign.py:")
    assert "Traceback" in (tmp_path / "task2-000" / "crash.txt").read_text()
    assert "crash: KeyError" in faults([trial])


def test_a_robot_that_thinks_too_long_is_stopped(tmp_path: Path) -> None:
    def slow(body: Body, task: Task, settings: Settings) -> Scripted:
        while True:  # until the alarm rings
            pass

    trial = run_trial(2, 0, Conditions(seconds=1), tmp_path, maker=slow)
    assert "took more than 1 s" in trial.crash


def test_a_loop_is_measured_against_the_shortest_loop(tmp_path: Path) -> None:
    trial = run_trial(4, 0, Conditions(), tmp_path, maker=maker([HERE], GIVES_UP))
    assert trial.shortest > 8
    assert trial.walked == 0.0


def times(*seconds: float) -> list[Seconds]:
    """Return cycles of the given seconds on the wall and half of them by the processor."""
    return [Seconds(value, value / 2) for value in seconds]


def test_the_table_counts() -> None:
    trials = [
        CampaignTrial(1, 0, True, True, True, "done", "", 4, 12.0, 10.0, [], times(1.0, 0.01, 0.03), needed=2),
        CampaignTrial(1, 1, True, False, False, "limit", "lost", 9, 3.0, 10.0, ["step 1: bad"], times(1.0, 0.02)),
        CampaignTrial(1, 11, False, False, False, "impossible", "no way", 2, 0.0, math.nan, [], times(1.0, 0.02)),
    ]
    lines = table(trials).splitlines()
    assert lines[1].split() == [
        "(i)",
        "1/2",
        "1/1",
        "0",
        "1",
        "0",
        "4",
        "/",
        "9",
        "2.00",
        "/",
        "2.00",
        "1.20",
        "/",
        "1.20",
        "20",
        "/",
        "30",
        "10",
        "/",
        "15",
        "-",
        "-",
        "0",
        "of",
        "0",
    ]
    assert "possible worlds: done 1, limit 1" in verdicts(trials)
    assert faults(trials) == "1:1  not achieved: limit: lost; judge: step 1: bad\n"
    assert json.loads(json.dumps(trials[2].row()))["shortest"] is None


def test_a_missing_judge_is_reported(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    monkeypatch.setenv("UTAK_JUDGE", str(tmp_path / "nowhere.py"))

    def done(task: int, seed: int, *_: object) -> CampaignTrial:
        return CampaignTrial(task, seed, True, True, True, "done")

    assert campaign.main(["--task", "1", "--count", "2", "-o", str(tmp_path / "r.jsonl")], done) == 0
    told = capsys.readouterr()
    assert "NO JUDGE" in told.err and "none!" in told.out
    assert len((tmp_path / "r.jsonl").read_text().splitlines()) == 2


def test_worlds_that_went_wrong_are_run_again(tmp_path: Path) -> None:
    ran = []

    def record(task: int, seed: int, *_: object) -> CampaignTrial:
        ran.append((task, seed))
        return CampaignTrial(
            task, seed, True, True, seed != 1, "done", score=Score(0, 0, 0, 0, 9, int(seed == 2), 0, ())
        )

    results = tmp_path / "results.jsonl"
    assert campaign.main(["--task", "1", "--count", "4", "-o", str(results)], record) == 1
    ran.clear()
    campaign.main(["--again", str(results)], record)
    warming_up, *again = ran
    assert warming_up == (4, 0)
    assert again == [(1, 1), (1, 2)]


@pytest.mark.long
def test_one_world_is_drawn_at_each_step(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    scripted = partial(run_trial, maker=maker([HERE, HERE], GIVES_UP))
    campaign.main(["--only", "3:2", "--keep", str(tmp_path)], scripted)
    told = capsys.readouterr().err
    assert told.count("bbbbb\n") > 30 and "step 2: {'do': 'move'" in told
    assert (tmp_path / "task3-002" / "episode.jsonl").exists()


def narrow_world() -> RandomScenario:
    """Return a world of task (vii) with a door that is too narrow."""
    return scenario(7, seeds(0, 1, unable=True)[0])


def said(world: RandomScenario, away: float, off: float) -> str:
    """Return a reason that names a place `away` from the middle of the door, and a missing width `off` the true one."""
    door = world.plan.doors[0]
    x, y = door.polygon.centroid.x - world.utak.x, door.polygon.centroid.y - world.utak.y
    x, y = (x, y + away) if door.vertical else (x + away, y)
    east, north = turned(x, y, -world.heading)
    where = f"{door.width:.2f} squares wide at POINT ({east:.1f} {north:.1f})"
    return f"o cannot: the passage for o, {where}, is too narrow by {world.missing + off:.2f} squares, and that is all"


def test_worlds_that_cannot_be_done_are_found_by_their_seeds() -> None:
    assert seeds(5, 3) == [5, 6, 7]
    for first in (0, 11, 12):
        assert not any(scenario(7, seed).possible for seed in seeds(first, 2, unable=True))


@pytest.mark.parametrize(
    ("away", "off", "right"), [(0.0, 0.0, True), (0.0, 0.2, True), (0.0, -0.4, False), (9, 0, False)]
)
def test_a_named_passage_is_compared_with_the_truth(away: float, off: float, right: bool) -> None:
    world = narrow_world()
    found = narrowness(world, said(world, away, off))
    assert found is not None
    assert found.off == pytest.approx(off, abs=0.02)
    assert found.away == pytest.approx(max(away - world.plan.doors[0].width / 2, 0.0), abs=0.2)
    trial = CampaignTrial(7, world.seed, False, verdict="impossible", reason="too narrow", narrow=found)
    assert told_right([trial]).startswith(f"too narrow passages: {int(right)}/1 told right")
    assert ("told wrongly" in faults([trial])) != right


def test_a_verdict_without_a_passage_is_not_right() -> None:
    found = narrowness(narrow_world(), "o cannot be carried there")
    assert found is not None and math.isnan(found.off) and math.isnan(found.away)
    assert told_right([CampaignTrial(7, 11, False, narrow=found)]).startswith("too narrow passages: 0/1")
    assert narrowness(scenario(7, 0), "whatever") is None
    assert told_right([CampaignTrial(7, 0, True, narrow=None)]) == ""
    assert json.loads(json.dumps(CampaignTrial(7, 11, False, narrow=Narrowness(0.1, 0.0)).row()))["narrow"] == [
        0.1,
        0.0,
    ]


@pytest.mark.parametrize("narrow", [None, Narrowness(0.1, 0.0), Narrowness(math.nan, math.nan)])
def test_a_trial_survives_the_way_from_its_process(narrow: Narrowness | None) -> None:
    score = Score(1, 2, 3, 4, 5, 6, 7, ("a", "b"))
    trial = CampaignTrial(7, 3, True, True, False, "done", "r", 4, 1.5, math.nan, ["x"], times(1.0, 2.0), score)
    trial = replace(trial, narrow=narrow)
    found = trial_of(json.loads(json.dumps(trial.row())))
    assert repr(found) == repr(trial), "not ==, for nan differs from itself"


def test_a_process_that_dies_is_a_crash_of_its_trial() -> None:
    lost = TaskOutcome(None, "died", "its process was ended by SIGKILL", 3.0)
    trial = trial_of_outcome(3, 11, Conditions(), lost)
    assert (trial.possible, trial.crash, trial.right) == (False, "its process was ended by SIGKILL", False)


def test_a_trial_as_a_task_is_the_same_trial(tmp_path: Path) -> None:
    task = trial_task(1, 5, Conditions(max_steps=2, seconds=0), tmp_path)
    found = carry_out(WorkerTask(task.function, json.loads(json.dumps(task.argument))))
    trial = trial_of_outcome(1, 5, Conditions(), found)
    assert (trial.task, trial.seed, trial.crash) == (1, 5, "") and len(trial.cycles) == trial.steps + 1
    assert task.seconds is None and (trial_task(1, 5, Conditions(seconds=9), tmp_path).seconds or 0) > 9
