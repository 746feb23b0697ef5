"""Episodes: the same seed gives the same bytes, a killed run can be read and resumed, the judge finds no violation."""

import importlib.util
import json
import os
import random
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
import scripted_robot
from random_scenes import write_scene

from utak.kb.language.diagnostics import BadInputError, CannotOpenError
from utak.simulator.cli.main import main
from utak.simulator.episode.episode import Episode, EpisodeLog, encode, read_episode

ROOT = Path(__file__).resolve().parents[3]
JUDGE = Path(os.environ.get("UTAK_JUDGE", ROOT.parent / "shared" / "judge" / "judge.py"))


@pytest.fixture(autouse=True)
def scripted(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Let the scripted robot do every run in this module."""
    monkeypatch.setitem(sys.modules, "utak.planner.cycle", sys.modules.get("utak.planner.cycle"))
    scripted_robot.install()
    yield


def process(*arguments: str, **environment: str) -> "subprocess.Popen[bytes]":
    """Run `utak` with the scripted robot in a process of its own."""
    command = [sys.executable, scripted_robot.__file__, *arguments]
    environment = os.environ | {"PYTHONPATH": str(ROOT)} | environment
    return subprocess.Popen(command, cwd=ROOT, env=environment, stdout=subprocess.DEVNULL)


def test_an_episode_records_what_happened(tmp_path: Path) -> None:
    folder, path = write_scene(tmp_path / "s", 3), tmp_path / "ep.jsonl"
    assert main(["run", str(folder), "--log", str(path), "--seed", "5", "--noise", "0.1", "--max-steps", "7"]) == 75
    episode = read_episode(path)
    assert episode.header["options"] == {
        "seed": 5,
        "noise": 0.1,
        "paths": "skeleton",
        "max_steps": 7,
        "pull": True,
        "kb": [],
    }
    assert len(episode.steps) == 8
    keys = ["step", "action", "motion", "utak", "held", "objects", "retina", "touch", "belief", "why"]
    assert all(list(step) == keys for step in episode.steps)
    assert episode.steps[0]["action"] is None
    assert episode.result is not None
    assert list(episode.result) == ["believed", "achieved", "verdict", "reason", "steps"]
    assert str(tmp_path) not in path.read_text()


@pytest.mark.long
def test_the_same_seed_gives_the_same_bytes_under_any_hash_seed(tmp_path: Path) -> None:
    folder = write_scene(tmp_path / "s", 1)
    runs = [
        process("run", str(folder), "--log", str(tmp_path / f"{n}.jsonl"), "--noise", "0.05", PYTHONHASHSEED=str(n))
        for n in (0, 1, 4242)
    ]
    assert [run.wait() for run in runs] == [75] * 3
    assert len({(tmp_path / f"{n}.jsonl").read_bytes() for n in (0, 1, 4242)}) == 1


@pytest.mark.parametrize("keep", [0, 5000, -40, -1])
def test_a_run_cut_anywhere_resumes_to_the_same_file(keep: int, tmp_path: Path) -> None:
    folder, path = write_scene(tmp_path / "s", 2), tmp_path / "ep.jsonl"
    options = ["run", str(folder), "--log", str(path), "--noise", "0.05"]
    main([*options, "--seed", "9"])
    whole = path.read_bytes()
    path.write_bytes(whole[:keep])
    assert main([*options, "--resume", *([] if keep > 4000 or keep < 0 else ["--seed", "9"])]) == 75
    assert path.read_bytes() == whole


@pytest.mark.parametrize("keep", [1, 30, 400])
@pytest.mark.parametrize("options", [[], ["--seed", "9"]])
def test_a_log_that_is_cut_within_its_header_is_not_resumed(keep: int, options: list[str], tmp_path: Path) -> None:
    folder, path = write_scene(tmp_path / "s", 2), tmp_path / "ep.jsonl"
    main(["run", str(folder), "--log", str(path), "--noise", "0.05", "--seed", "9"])
    cut = path.read_bytes()[:keep]
    path.write_bytes(cut)
    assert main(["run", str(folder), "--log", str(path), "--resume", *options]) == 65
    assert path.read_bytes() == cut


def test_a_last_line_counts_when_only_its_line_end_is_missing(tmp_path: Path) -> None:
    folder, path = write_scene(tmp_path / "s", 2), tmp_path / "ep.jsonl"
    main(["run", str(folder), "--log", str(path)])
    whole, episode = path.read_bytes(), read_episode(path)
    assert episode.result is not None
    path.write_bytes(whole[:-1])
    assert read_episode(path) == episode
    for cut in (2, 3, 30):
        path.write_bytes(whole[:-cut])
        assert read_episode(path) == Episode(episode.header, episode.steps, None)


def test_a_killed_run_leaves_a_readable_episode_and_resumes(tmp_path: Path) -> None:
    folder = write_scene(tmp_path / "s", 4)
    whole, path = tmp_path / "whole.jsonl", tmp_path / "ep.jsonl"
    main(["run", str(folder), "--log", str(whole)])
    for _ in range(3):
        path.unlink(missing_ok=True)
        run = process("run", str(folder), "--log", str(path), SCRIPTED_PAUSE="0.02")
        while run.poll() is None and (not path.exists() or path.stat().st_size == 0):
            time.sleep(0.01)
        time.sleep(random.Random(path.stat().st_size).uniform(0, 0.4))
        run.send_signal(signal.SIGKILL)
        run.wait()
        assert read_episode(path).result is None
        assert main(["run", str(folder), "--log", str(path), "--resume"]) == 75
        assert path.read_bytes() == whole.read_bytes()


def test_resuming_something_else_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, options = tmp_path / "ep.jsonl", ["--log", str(tmp_path / "ep.jsonl"), "--resume"]
    main(["run", str(write_scene(tmp_path / "one", 1)), *options[:2]])
    before = path.read_bytes()
    other = str(write_scene(tmp_path / "other", 2))
    assert main(["run", other, *options]) == 65
    assert f"{path}:1:1-1: error: the run does not repeat this line" in capsys.readouterr().err
    assert main(["run", str(tmp_path / "one"), *options, "--seed", "3"]) == 65
    assert path.read_bytes() == before
    path.write_text("my diary\n")
    assert main(["run", other, *options]) == 65
    assert path.read_text() == "my diary\n"


def test_other_files_are_refused_as_episodes(tmp_path: Path) -> None:
    path = tmp_path / "ep.jsonl"
    head = encode({"utak": "episode", "version": 1})
    for text, what in {
        "": "no episode",
        "{}\n": "no episode",
        "[1]\n": "JSON object",
        "x\n": "no JSON",
        encode({"utak": "episode", "version": 2}): "version 2",
        head + encode({"step": 1}): "step 0 is missing",
        head + "{\n" + encode({"step": 0}): "damaged",
        head + "[" * 100_000 + "\n": "damaged",
    }.items():
        path.write_text(text)
        with pytest.raises(BadInputError, match=what):
            read_episode(path)
    with pytest.raises(CannotOpenError):
        EpisodeLog(tmp_path / "no" / "ep.jsonl")


def load_judge() -> Any:
    """Return the independent judge as a module."""
    spec = importlib.util.spec_from_file_location("judge", JUDGE)
    assert spec is not None
    assert spec.loader is not None
    judge = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(judge)
    return judge


def judged(tmp_path: Path, seed: int, noise: float) -> tuple[list[str], bool]:
    """Return what the judge finds in a run on a random scene, and whether something was carried."""
    folder, path, judge = write_scene(tmp_path / f"s{seed}", seed), tmp_path / "ep.jsonl", load_judge()
    main(["run", str(folder), "--log", str(path), "--seed", str(seed), "--noise", str(noise)])
    rows = [json.loads(row) for row in path.read_text().splitlines()]
    steps = [row for row in rows if "step" in row]
    watcher = judge.Judge(judge.World(folder))
    for before, after in pairwise(steps):
        watcher.physics(before, after)
    for step in steps:
        watcher.senses(step)
    watcher.ends(folder, steps, rows[-1]["result"])
    unmet = [finding for finding in watcher.findings if "expected" in finding]
    assert bool(unmet) != rows[-1]["result"]["achieved"]
    carried = any(step["held"] and step["motion"] for step in steps)
    return [finding for finding in watcher.findings if "expected" not in finding], carried


@pytest.mark.skipif(not JUDGE.exists(), reason=f"no judge at {JUDGE} (set UTAK_JUDGE)")
@pytest.mark.parametrize("noise", [0.0, 0.05])
def test_the_judge_finds_nothing(noise: float, tmp_path: Path) -> None:
    results = [judged(tmp_path, seed, noise) for seed in range(100, 112)]
    assert [finding for found, _ in results for finding in found] == []
    assert sum(carried for _, carried in results) >= 3


@pytest.mark.campaign
@pytest.mark.skipif(not JUDGE.exists(), reason=f"no judge at {JUDGE} (set UTAK_JUDGE)")
@pytest.mark.parametrize("noise", [0.0, 0.05, 0.3])
def test_the_judge_finds_nothing_in_many_worlds(noise: float, tmp_path: Path) -> None:
    assert [finding for seed in range(1000, 1300) for finding in judged(tmp_path, seed, noise)[0]] == []
