"""A run that may take so much time ends between two steps or within one, and goes on from there when it is resumed."""

import itertools
import json
import signal
import sys
import time
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest
import scripted_robot
from random_scenes import write_scene

from utak.kb.task.task import Task
from utak.simulator.cli.main import main
from utak.simulator.episode.episode import EpisodeLog, read_episode
from utak.simulator.run.session import Session
from utak.simulator.run.time_limit import TimeLimit
from utak.simulator.scenario.scenario import read_scenario
from utak.simulator.scenario.settings import Settings

ALL_COMMANDS = 30  # of the scripted robot


def scripted(body: Any, task: Task, settings: Settings) -> Any:
    return scripted_robot.Robot(body, task, scripted_robot.Options(max_steps=settings.max_steps))


@pytest.fixture
def scene(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a scenario that the scripted robot will run."""
    monkeypatch.setitem(sys.modules, "utak.planner.cycle", sys.modules.get("utak.planner.cycle"))
    scripted_robot.install()
    return write_scene(tmp_path / "scene", 1)


def ticking(seconds: float) -> TimeLimit:
    """Return a limit whose clock is a second later whenever it is read."""
    return TimeLimit(seconds, itertools.count().__next__)


def with_limit(scene: Path, path: Path, seconds: float, resume: bool = False) -> Any:
    """Run with a limit, looked at once a step; return the result."""
    with EpisodeLog(path, resume) as log:
        return Session(read_scenario(scene), Settings(), scripted, log).run(limit=ticking(seconds))


@pytest.mark.parametrize("seconds", [1, 2, 7, ALL_COMMANDS])
def test_a_run_ends_at_the_first_step_after_the_time(scene: Path, tmp_path: Path, seconds: int) -> None:
    """The clock is read once before each command; the lines are the first ones of the whole run."""
    whole, cut = tmp_path / "whole.jsonl", tmp_path / "cut.jsonl"
    assert with_limit(scene, whole, 1000).seconds is None
    result = with_limit(scene, cut, seconds)
    assert (result.verdict, result.believed, result.steps, result.seconds) == ("limit", False, seconds - 1, seconds)
    assert result.reason == f"not done after {seconds} second{'s' * (seconds != 1)}"
    assert cut.read_bytes().splitlines()[:-1] == whole.read_bytes().splitlines()[: seconds + 1]
    assert read_episode(cut).result == result.line["result"]


def test_a_run_that_has_a_verdict_in_time_is_not_cut(scene: Path, tmp_path: Path) -> None:
    """A verdict counts even when the time is over after the last step."""
    result = with_limit(scene, tmp_path / "ep.jsonl", ALL_COMMANDS + 1)
    assert (result.steps, result.reason, result.seconds) == (ALL_COMMANDS, "the script has ended", None)
    assert "seconds" not in result.line["result"]


def test_a_run_that_was_cut_is_resumed_as_often_as_needed(scene: Path, tmp_path: Path) -> None:
    """Each time counts from the end of the repetition, so every resumption gets further; the end is that of the run."""
    whole, cut = tmp_path / "whole.jsonl", tmp_path / "cut.jsonl"
    with_limit(scene, whole, 1000)
    steps = [with_limit(scene, cut, 9).steps]
    while len(steps) < ALL_COMMANDS and steps[-1] < ALL_COMMANDS:
        steps.append(with_limit(scene, cut, 9, resume=True).steps)
    assert steps == sorted(set(steps))
    assert cut.read_bytes() == whole.read_bytes()


class Interrupted(scripted_robot.Robot):
    """A robot whose time is over within its third step, or, if sleepy, while it wakes and thinks for ever.

    It takes what interrupts it for an error at first.
    """

    taken, sleepy, ends = 0, False, 0.0

    def wake(self) -> Any:
        """Wake, or think for ever: for a minute of processor time, should nothing interrupt it."""
        while self.sleepy and time.process_time() < self.ends:
            with suppress(Exception):
                sum(range(1000))
        return super().wake()

    def step(self) -> Any:
        """Take a step."""
        report = super().step()
        self.taken += 1
        if self.taken == 3:
            with suppress(Exception):
                signal.raise_signal(signal.SIGALRM)
        return report


@pytest.mark.parametrize("sleepy", [False, True])
def test_a_step_is_cut_off_and_nothing_of_it_is_written(scene: Path, tmp_path: Path, sleepy: bool) -> None:
    """The file holds the whole steps before and the result, and the run can be resumed."""
    whole, cut = tmp_path / "whole.jsonl", tmp_path / "cut.jsonl"
    with_limit(scene, whole, 1000)
    before = signal.getsignal(signal.SIGALRM)

    def make(body: Any, task: Task, settings: Settings) -> Interrupted:
        robot = Interrupted(body, task, scripted_robot.Options(max_steps=30))
        robot.sleepy, robot.ends = sleepy, time.process_time() + 60
        return robot

    seconds = 0.2 if sleepy else 1000.0
    with EpisodeLog(cut) as log:
        result = Session(read_scenario(scene), Settings(), make, log).run(limit=TimeLimit(seconds))
    assert (result.verdict, result.seconds, result.steps) == ("limit", seconds, 0 if sleepy else 2)
    assert "within a step" in result.reason
    assert signal.getsignal(signal.SIGALRM) == before and signal.getitimer(signal.ITIMER_REAL)[0] == 0.0
    lines = cut.read_bytes().splitlines()
    assert lines[:-1] == whole.read_bytes().splitlines()[: 1 if sleepy else 4]
    assert read_episode(cut).result == result.line["result"]
    with_limit(scene, cut, 1000, resume=True)
    assert cut.read_bytes() == whole.read_bytes()


def test_the_command_takes_seconds(scene: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Too little time gives exit 75 and says so, also as JSON; without --seconds the run is resumed to its end."""
    path = tmp_path / "ep.jsonl"
    options = ["run", str(scene), "--log", str(path)]
    assert main([*options, "--seconds", "0.001", "--json"]) == 75
    printed = json.loads(capsys.readouterr().out)
    assert (printed["verdict"], printed["seconds"]) == ("limit", 0.001)
    assert printed["reason"].startswith("not done after 0.001 seconds")
    assert main([*options, "--seconds", "0.001", "--resume"]) == 75
    assert "limit in" in capsys.readouterr().out
    assert main([*options, "--seconds", "1e6", "--resume"]) == 75
    assert "the script has ended" in capsys.readouterr().out
    assert main(["run", str(scene), "--log", str(tmp_path / "whole.jsonl")]) == 75
    assert path.read_bytes() == (tmp_path / "whole.jsonl").read_bytes()


@pytest.mark.parametrize("seconds", ["0", "-1", "x", "nan", "inf", "1e7", "", "1,5"])
def test_what_is_no_time_is_an_error_of_usage(
    seconds: str, scene: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Times that are too short, too long or no numbers are refused, and nothing is written."""
    assert main(["run", str(scene), "--log", str(tmp_path / "ep.jsonl"), f"--seconds={seconds}"]) == 2
    assert "--seconds" in capsys.readouterr().err
    assert not (tmp_path / "ep.jsonl").exists()
