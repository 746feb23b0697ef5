"""The campaign of kills notices a command that loses steps, ends otherwise, or leaves processes over."""

import random
import sys
from pathlib import Path

import pytest

from benchmarks.episodes import killing


def test_a_difference_after_a_kill_is_a_fault() -> None:
    reference = killing.Reference(0, b"all", 1.0)
    none = killing.Killed(-9, True, "", [])
    assert list(killing._differences(killing.Reference(0, b"all", 3.0), reference, none)) == []
    found = list(killing._differences(killing.Reference(1, b"al", 3.0), reference, none._replace(orphans=[7])))
    assert found == ["the exit code is 1, not 0", "the file has other contents", "the processes [7] are left over"]


def test_processes_that_a_killed_command_leaves_over_are_found() -> None:
    child = "import time; time.sleep(1)"
    parent = f"import subprocess, sys; subprocess.run([sys.executable, '-c', {child!r}])"
    killed = killing.kill_after([sys.executable, "-c", parent], 0.5, random.Random(0), max_orphan_seconds=0.0)
    assert killed.running and killed.code == -9
    assert len(killed.orphans) == 1
    assert killing.still_there(killed.orphans) == []


def test_steps_that_were_reported_and_are_lost_are_a_fault(tmp_path: Path) -> None:
    file = tmp_path / "run.jsonl"
    killed = killing.Killed(-9, True, "step 0: wakes: x\nstep 1: moves: y\n", [])
    assert list(killing.lost_steps(killed, file)) == ["2 steps were reported, 0 are in the file"]


def test_a_command_that_breaks_is_no_reference(tmp_path: Path) -> None:
    with pytest.raises(RuntimeError, match="exit code 66"):
        killing.finish(killing.run_command(tmp_path / "nowhere", tmp_path / "r.jsonl"), tmp_path / "r.jsonl")


@pytest.mark.campaign
def test_a_run_that_is_killed_once_has_no_fault(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    assert killing.main(["--count", "1", "--what", "run", "--keep", str(tmp_path)]) == 0
    assert "1 kills from 0 to" in capsys.readouterr().out
    with pytest.raises(SystemExit):
        killing.main(["--what", "nothing"])
