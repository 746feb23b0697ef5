"""Worker processes: outcomes of tasks that return, raise, never end or end their process; nothing of a user's runs."""

import os
import signal
import threading
import time
from pathlib import Path

import pytest

from benchmarks.episodes.killing import descendants_of, still_there
from utak.simulator.sweep.executors.processes import run_in_processes
from utak.simulator.sweep.executors.task_process import TaskProcess
from utak.simulator.sweep.executors.tasks import DIED, RAISED, TOO_LONG, WorkerTask, carry_out

SEGFAULT = WorkerTask("ctypes:string_at", 0)  # reads memory at address 0
EXIT = WorkerTask("os:_exit", 3)


def test_tasks_are_carried_out_whatever_others_do() -> None:
    tasks = [
        WorkerTask("operator:neg", 5),
        SEGFAULT,
        WorkerTask("operator:neg", "text"),
        WorkerTask("time:sleep", 10_000, 0.3),
        WorkerTask("operator:truth", []),
        EXIT,
        WorkerTask("builtins:print", "printed", 600.0),
        WorkerTask("builtins:float", "nan"),
        WorkerTask("os:getcwd", None),
    ]
    found = dict(run_in_processes(tasks, 2))
    assert sorted(found) == list(range(9))
    assert [found[n].value for n in (0, 4, 6)] == [-5, False, None]
    assert not any(found[n].failure for n in (0, 4, 6, 7))
    assert (found[1].failure, found[1].reason) == (DIED, "its process was ended by SIGSEGV")
    assert found[2].failure == RAISED and found[2].reason.startswith("TypeError: bad operand type")
    assert (found[3].failure, found[3].reason) == (TOO_LONG, "it took more than 0.3 seconds")
    assert (found[5].failure, found[5].reason) == (DIED, "its process ended with exit code 3")
    assert found[8].failure == RAISED


SLEEPS_ONCE = """
import pathlib, time
begun = pathlib.Path({!r})
if not begun.exists():
    begun.touch()
    time.sleep(1000)
"""


def test_a_task_whose_process_is_killed_once_is_carried_out_again(tmp_path: Path) -> None:
    begun = tmp_path / "begun"
    ended = run_in_processes([WorkerTask("builtins:exec", SLEEPS_ONCE.format(str(begun)))], 1)

    def kill() -> None:
        while not begun.exists():
            time.sleep(0.05)
        for pid in descendants_of(os.getpid()):
            if "worker" in _command(pid):
                os.kill(pid, signal.SIGKILL)

    thread = threading.Thread(target=kill)
    thread.start()
    (found,) = list(ended)
    thread.join()
    assert (found[0], found[1].failure) == (0, "")


def _command(pid: int) -> str:
    """Return the command line of a process; "" when it has ended."""
    try:
        return Path(f"/proc/{pid}/cmdline").read_text()
    except OSError:
        return ""


def test_closing_ends_the_processes_at_once() -> None:
    tasks = [WorkerTask("operator:neg", 1), *[WorkerTask("time:sleep", 10_000)] * 3]
    ended = run_in_processes(tasks, 2)
    assert next(ended)[1].value == -1
    started = [pid for pid in descendants_of(os.getpid()) if "worker" in _command(pid)]
    ended.close()
    assert still_there(started) == []


def test_a_worker_that_cannot_be_prepared_is_an_error_and_no_endless_loop() -> None:
    with pytest.raises(RuntimeError, match="cannot begin: ValueError"):
        list(run_in_processes([WorkerTask("operator:neg", 1)], 1, WorkerTask("builtins:int", "x")))


def test_an_idle_worker_ends_and_the_next_task_starts_another(tmp_path: Path) -> None:
    process = TaskProcess(idle_seconds=0.2)
    first = process.run(WorkerTask("operator:neg", 1))
    (pid,) = [pid for pid in descendants_of(os.getpid()) if "worker" in _command(pid)]
    assert still_there([pid]) == []
    second = process.run(WorkerTask("operator:neg", 2))
    process.close()
    assert (first.value, second.value) == (-1, -2)
    assert process.run(WorkerTask("operator:neg", 3)).failure == DIED, "a closed handle starts no process"


def test_nothing_in_the_working_directory_is_executed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("json", "operator", "numpy", "planner", "simulator", "sitecustomize", "utak"):
        (tmp_path / f"{name}.py").write_text(f"open({str(tmp_path / 'executed')!r}, 'w')")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    tasks = [WorkerTask("operator:neg", 1), WorkerTask("utak.simulator.scenario.scenario:read_scenario", "nowhere")]
    found = dict(run_in_processes(tasks, 1))
    assert found[0].value == -1 and found[1].reason == "nowhere: cannot open: no such folder"
    assert not (tmp_path / "executed").exists()


def test_in_this_process_tasks_have_the_same_outcomes() -> None:
    tasks = [WorkerTask("operator:neg", 5), WorkerTask("operator:neg", "text"), WorkerTask("no.such:thing", 1)]
    found = [carry_out(task) for task in tasks]
    assert found[0].value == -5
    assert found[1].reason.startswith("TypeError")
    assert found[2].reason.startswith("ModuleNotFoundError")
    assert carry_out(WorkerTask("builtins:set", [1])).failure == RAISED, "a set is no JSON"
