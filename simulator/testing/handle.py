"""The handle of a process that tries scenarios (simulator.testing.worker).

The process is isolated: nothing in the working directory or on PYTHONPATH is executed. The plugin of pytest loads this
module alone, so it imports little.
"""

import json
import subprocess
from contextlib import suppress
from typing import Any

from utak.launcher import isolated_command

MAX_ENDING_SECONDS = 2.0  # seconds of wall-clock time in which a process ends after its input; a convention


class WorkerEndedError(Exception):
    """The process ended before it answered; the message says how."""


class WorkerHandle:
    """A process that tries scenarios, one after the other. It starts with the first wish."""

    def __init__(self, folder: str | None = None) -> None:
        self._folder = folder
        self._process: subprocess.Popen[bytes] | None = None
        self._busy: subprocess.Popen[bytes] | None = None  # the process that a thread waits for
        self._closed = False

    def ask(self, wish: dict[str, Any]) -> dict[str, Any]:
        """Return the record of a scenario, and its report as `report`."""
        if self._process is None:
            self._process = _start(self._folder)
        worker, self._process = self._process, None
        self._busy = worker
        assert worker.stdin is not None
        assert worker.stdout is not None
        if self._closed:
            worker.kill()
        try:
            with suppress(OSError):  # the process has ended, which the empty answer tells, too
                worker.stdin.write(json.dumps(wish).encode("ascii") + b"\n")
                worker.stdin.flush()
            line = worker.stdout.readline()
        except BaseException:
            _end(worker)
            raise
        finally:
            self._busy = None
        if not line.endswith(b"\n"):
            code = _end(worker)
            raise WorkerEndedError(f"the process that runs the scenario ended with exit code {code}")
        self._process = worker
        record: dict[str, Any] = json.loads(line)
        return record

    def close(self) -> None:
        """End the process, if one runs; a thread that waits for its answer gets WorkerEndedError."""
        self._closed = True
        busy, worker, self._process = self._busy, self._process, None
        if busy is not None:
            busy.kill()  # the thread that waits for it closes its streams
        if worker is not None:
            _end(worker)


def _start(folder: str | None) -> "subprocess.Popen[bytes]":
    """Return a new process in a folder that is ready; raise WorkerEndedError when it does not start."""
    worker = subprocess.Popen(
        isolated_command("utak.simulator.testing.worker"),
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        cwd=folder,
        start_new_session=True,  # Ctrl-C must reach the parent only, which then ends the worker
        creationflags=getattr(subprocess, "CREATE_NEW_PROCESS_GROUP", 0),  # the same on Windows
    )
    assert worker.stdout is not None
    try:
        first = worker.stdout.readline()
    except BaseException:
        _end(worker)
        raise
    if first.strip() != b"ready":
        raise WorkerEndedError(f"the process that runs scenarios does not start: exit code {_end(worker)}")
    return worker


def _end(worker: "subprocess.Popen[bytes]") -> int:
    """End a process by closing its input, kill it when that is not enough, and return its exit code."""
    assert worker.stdin is not None
    assert worker.stdout is not None
    with suppress(OSError):
        worker.stdin.close()
    try:
        code = worker.wait(MAX_ENDING_SECONDS)
    except subprocess.TimeoutExpired:
        worker.kill()
        code = worker.wait()
    worker.stdout.close()
    return code
