"""A real Dask scheduler with two worker processes on this machine: same results, lost workers, clear refusals."""

import json
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from utak.kb.language.diagnostics import CannotOpenError
from utak.simulator.cli.main import main
from utak.simulator.sweep.executors.cluster import run_on_dask
from utak.simulator.sweep.executors.tasks import WorkerTask

ROOT = Path(__file__).resolve().parents[4]
TASK = WorkerTask("operator:neg", 1)

pytest.importorskip("distributed")


@contextmanager
def dask(folder: Path, program: str, *options: str, code: Path = ROOT) -> Iterator["subprocess.Popen[bytes]"]:
    """Run a program of Dask, with some checkout of ours on its path, until the end of the block."""
    command = [sys.executable, "-m", f"distributed.cli.dask_{program}", *options]
    quiet = subprocess.DEVNULL
    path = os.pathsep.join([str(code), os.environ.get("PYTHONPATH", "")])
    given = os.environ | {"PYTHONPATH": path, "PYTHONWARNINGS": "ignore"}
    with subprocess.Popen(command, cwd=folder, env=given, stdout=quiet, stderr=quiet) as process:
        try:
            yield process
        finally:
            process.kill()


@contextmanager
def scheduler(folder: Path, started: "list[subprocess.Popen[bytes]] | None" = None) -> Iterator[str]:
    """Run a scheduler until the end of the block, and yield its address; its process is appended to `started`."""
    file = folder / "scheduler.json"
    options = ("--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--scheduler-file", str(file))
    with dask(folder, "scheduler", *options) as process:
        end = time.monotonic() + 600
        while not file.exists() or not file.read_text():
            assert time.monotonic() < end, "the scheduler does not start"
            time.sleep(0.05)
        if started is not None:
            started.append(process)
        yield json.loads(file.read_text())["address"]


def worker(folder: Path, address: str, code: Path = ROOT) -> "contextmanager[subprocess.Popen[bytes]]":  # type: ignore[type-arg]
    """Run a worker of a scheduler until the end of the block."""
    options = ("--nthreads", "1", "--no-nanny", "--no-dashboard", "--local-directory", str(folder))
    return dask(folder, "worker", address, *options, code=code)  # type: ignore[return-value]


def sweep(folder: Path, *options: str) -> "subprocess.Popen[str]":
    """Start `utak sweep` on a short scenario; the workers run elsewhere and do not have its files."""
    code = f"import sys; sys.path.insert(0, {str(ROOT)!r}); from utak.simulator.cli.main import main; sys.exit(main())"
    command = [sys.executable, "-c", code, "sweep", "small", "--seeds", "0:3", "--max-steps", "2", *options]
    return subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def test_on_dask_results_are_the_same_also_when_a_worker_is_lost(tmp_path: Path) -> None:
    assert main(["new", str(tmp_path / "small")]) == 0
    here, there = tmp_path / "here.jsonl", tmp_path / "there.jsonl"
    place = tmp_path / "elsewhere"
    place.mkdir()
    with scheduler(place) as address, worker(place, address) as first, worker(place, address):
        at_home = sweep(tmp_path, "--jobs", "2", "-o", str(here))
        assert at_home.communicate(timeout=6000)[1] == "" and at_home.returncode == 0
        on_dask = sweep(tmp_path, "--dask", address, "-o", str(there))
        while on_dask.poll() is None and not (there.exists() and there.read_bytes().count(b"\n") > 0):
            time.sleep(0.02)
        first.kill()
        assert on_dask.communicate(timeout=6000)[1] == "" and on_dask.returncode == 0
    lines = [
        sorted(
            (json.loads(line) | {"seconds": 0} for line in path.read_text().splitlines()), key=lambda row: row["seed"]
        )
        for path in (here, there)
    ]
    assert lines[0] == lines[1] and len(lines[0]) == 3


def test_a_worker_with_other_code_is_refused_with_a_reason(tmp_path: Path) -> None:
    other = tmp_path / "other"
    for name in ("geometry", "kb", "planner", "simulator", "utak"):
        shutil.copytree(ROOT / name, other / name, ignore=shutil.ignore_patterns("*.pyc", "*.nbi", "*.nbc"))
    with (other / "kb" / "asp" / "corners.lp").open("a") as stream:
        stream.write("% another state\n")
    with (
        scheduler(tmp_path) as address,
        worker(tmp_path, address, other),
        pytest.raises(CannotOpenError, match=r"it has another state of utak: .*code \w+, not \w+"),
    ):
        list(run_on_dask([TASK], address))


def test_a_scheduler_without_workers_is_not_waited_for_for_ever(tmp_path: Path) -> None:
    with scheduler(tmp_path) as address:
        begun = time.monotonic()
        with pytest.raises(CannotOpenError, match=r"had no workers for 0\.5 s"):
            list(run_on_dask([TASK], address, max_workerless_seconds=0.5))
        assert time.monotonic() - begun < 600


def test_a_scheduler_that_is_lost_ends_the_sweep_with_a_reason(tmp_path: Path) -> None:
    tasks = [TASK, WorkerTask("time:sleep", 10_000)]
    started: list[subprocess.Popen[bytes]] = []
    with scheduler(tmp_path, started) as address, worker(tmp_path, address):
        begun = time.monotonic()
        ended = run_on_dask(tasks, address, max_connecting_seconds=3.0)
        assert next(ended)[1].value == -1
        started[0].kill()
        with pytest.raises(CannotOpenError, match="the scheduler was lost"):
            next(ended)
        assert time.monotonic() - begun < 600


@pytest.mark.parametrize(
    ("address", "reason"),
    [
        ("tcp://127.0.0.1:1", "no Dask scheduler answers within 0.5 s"),
        ("nonsense", "this is no address of a Dask scheduler"),
        ("tcp://127.0.0.1:port", "this is no address of a Dask scheduler"),
        ("", "this is no address of a Dask scheduler"),
    ],
)
def test_an_address_without_a_scheduler_is_refused_soon(address: str, reason: str) -> None:
    begun = time.monotonic()
    with pytest.raises(CannotOpenError) as caught:
        list(run_on_dask([TASK], address, max_connecting_seconds=0.5))
    assert reason in str(caught.value) and time.monotonic() - begun < 600


def test_without_the_library_it_is_said_how_to_install_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(CannotOpenError, match=r"pip install distributed"):
        list(run_on_dask([TASK], "tcp://127.0.0.1:1"))
