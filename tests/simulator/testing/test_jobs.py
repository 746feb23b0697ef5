"""Several scenarios at once, each process with the real robot: the same outcomes as one after the other."""

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from utak.simulator.cli.main import main
from utak.simulator.sweep.executors.task_process import TaskProcess
from utak.simulator.sweep.executors.tasks import TRYING_FUNCTION, WorkerTask, bug_of

EXERCISES = Path(__file__).resolve().parents[3] / "docs" / "exercises"


@pytest.mark.long
def test_several_jobs_give_the_outcomes_of_one(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name in ("01_change_the_goal", "02_say_what_you_mean"):
        shutil.copytree(EXERCISES / name, tmp_path / "class" / name)
    (shutil.copytree(EXERCISES / "01_change_the_goal", tmp_path / "class" / "bad") / "goal.lp").write_text("at(utak")
    found = []
    for jobs in ("1", "3"):
        assert main(["test", str(tmp_path / "class"), "--json", "--jobs", jobs]) == 65
        seen = capsys.readouterr()
        assert "goal.lp:1:7-7: error" in seen.err
        found.append(json.loads(seen.out))
    assert found[0] == found[1]
    assert [one["outcome"] for one in found[0]["scenarios"]] == ["failed", "failed", "bad"]


def test_a_process_that_ends_is_reported_and_another_one_is_started() -> None:
    process = TaskProcess()
    try:
        ended = bug_of(process.run(WorkerTask("os:_exit", 3)))
        assert ended == "this is a bug of ours: the process that runs the scenario ended with exit code 3"
        record = process.run(WorkerTask(TRYING_FUNCTION, {"folder": "no/where", "root": "no/where", "given": {}})).value
        assert (record["outcome"], record["exit_code"]) == ("absent", 66)
        assert "no such folder" in record["report"]
        assert "repeat it: utak test no/where" in record["report"]
    finally:
        process.close()


@pytest.mark.skipif(os.name == "nt", reason="signals are those of POSIX systems")
def test_ctrl_c_ends_all_jobs_at_once(tmp_path: Path) -> None:
    for number in range(4):
        shutil.copytree(EXERCISES / "12_noise", tmp_path / "class" / str(number))
    hear = "import signal, sys; signal.signal(signal.SIGINT, signal.default_int_handler)"  # a parent may ignore it
    code = f"{hear}; from utak.simulator.cli.main import main; sys.exit(main())"
    command = [sys.executable, "-c", code, "test", str(tmp_path / "class"), "--jobs", "2", "--seed", "5"]
    process = subprocess.Popen(
        command, cwd=EXERCISES.parents[1], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    while len(children(process.pid)) < 2 and process.poll() is None:
        time.sleep(0.05)
    workers = children(process.pid)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate()
    assert process.returncode == 130
    assert "Traceback" not in err
    assert len(workers) == 2
    assert not [worker for worker in workers if Path(f"/proc/{worker}").exists()]


def children(parent: int) -> list[int]:
    """Return the processes that a process has started; a test is skipped where the system does not tell."""
    place = Path(f"/proc/{parent}/task/{parent}/children")
    if not place.exists():
        pytest.skip("this system does not list the children of a process")
    found = [int(word) for path in place.parents[1].glob("*/children") for word in path.read_text().split()]
    return [child for child in found if is_worker(child)]


def is_worker(process: int) -> bool:
    """Return whether a process tries scenarios; False when it has ended."""
    try:
        return b"executors.worker" in Path(f"/proc/{process}/cmdline").read_bytes()
    except OSError:
        return False
