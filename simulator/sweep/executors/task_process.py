"""The handle of a worker process: it limits the time of tasks, and starts the process anew when it has ended."""

import json
import os
import signal
import subprocess
import threading
import time
from contextlib import suppress
from tempfile import TemporaryDirectory
from typing import Any

from utak.launcher import isolated_command
from utak.simulator.sweep.executors.tasks import DIED, TOO_LONG, TaskOutcome, WorkerTask
from utak.simulator.sweep.executors.worker import READY

MAX_WORKER_START_SECONDS = 60.0  # seconds of wall-clock time until a worker process must be ready; a convention
MAX_PREPARATION_SECONDS = 900.0  # seconds for its preparation, which may compile all kernels; a convention
MAX_ATTEMPTS = 2  # of a task whose process ends: the first end may have had another cause; a convention


class TaskProcess:
    """A worker process, started when the first task comes. One thread uses it; any other may close it."""

    def __init__(self, preparation: WorkerTask | None = None, idle_seconds: float = 0.0) -> None:
        self._preparation, self._idle_seconds = preparation, idle_seconds
        self._lock = threading.Lock()
        self._process: subprocess.Popen[bytes] | None = None
        self._closed = False
        # The place of all temporary files of the process: it goes, even when the process is killed before it cleans up.
        self._temporary = TemporaryDirectory(prefix="utak-sweep-", ignore_cleanup_errors=True)

    def run(self, task: WorkerTask) -> TaskOutcome:
        """Carry out a task in the process and return the outcome."""
        # Raises RuntimeError when no process can be started.
        for _ in range(MAX_ATTEMPTS):
            begun = time.monotonic()
            outcome = self._attempt(task)
            if outcome.failure in (DIED, TOO_LONG):  # the process did not tell how long it took
                outcome = outcome._replace(seconds=time.monotonic() - begun)
            if outcome.failure != DIED or self._closed:
                break
        return outcome

    def prepare(self) -> "subprocess.Popen[bytes] | None":
        """Return the process; start and prepare it, if it does not run. None when this handle was closed."""
        # Raises RuntimeError when it cannot be started.
        with self._lock:
            process = self._process
            if process is not None and process.poll() is not None:
                _end(process)
                self._process = process = None
        return process or self._start()

    def close(self) -> None:
        """End the process and whatever it does; later tasks fail."""
        with self._lock:
            self._closed = True
            process, self._process = self._process, None
        if process is not None:
            _end(process)
        self._temporary.cleanup()

    def _attempt(self, task: WorkerTask) -> TaskOutcome:
        """Carry out a task once."""
        process = self.prepare()
        if process is None:
            return TaskOutcome(None, DIED, "it was broken off")
        outcome = _exchange(process, task)
        if outcome.failure in (DIED, TOO_LONG):
            with self._lock:
                self._process = None
            _end(process)
        return outcome

    def _start(self) -> "subprocess.Popen[bytes] | None":
        """Return a new process that is ready and prepared; None when this handle was closed meanwhile."""
        process = subprocess.Popen(
            isolated_command("utak.simulator.sweep.executors.worker", f"{self._idle_seconds:g}"),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            env={**os.environ, **dict.fromkeys(("TMPDIR", "TEMP", "TMP"), self._temporary.name)},
            start_new_session=True,  # Ctrl-C must reach the parent only, which then ends the process
            creationflags=getattr(subprocess, "CREATE_NEW_PROCESS_GROUP", 0),  # the same on Windows
        )
        with self._lock:
            if self._closed:
                _end(process)
                return None
            self._process = process
        try:
            problem = _begin(process, self._preparation)
        except BaseException:
            _end(process)
            raise
        if problem and not self._closed:
            _end(process)
            raise RuntimeError(f"a worker process cannot begin: {problem}")
        return process


def _begin(process: "subprocess.Popen[bytes]", preparation: WorkerTask | None) -> str:
    """Wait until a new process is ready, prepare it, and return what went wrong; "" for nothing."""
    line, late = _next_line(process, MAX_WORKER_START_SECONDS)
    if line != READY:
        return f"it took more than {MAX_WORKER_START_SECONDS:g} seconds" if late else _how_it_ended(process)
    if preparation is None:
        return ""
    return _exchange(process, preparation._replace(seconds=MAX_PREPARATION_SECONDS)).reason


def _exchange(process: "subprocess.Popen[bytes]", task: WorkerTask) -> TaskOutcome:
    """Send a task to a process and return the outcome; a process that takes too long is killed."""
    assert process.stdin is not None
    request = {"function": task.function, "argument": task.argument}
    with suppress(OSError, ValueError):  # the process has ended, or was closed
        process.stdin.write(json.dumps(request).encode("ascii") + b"\n")
        process.stdin.flush()
        line, late = _next_line(process, task.seconds)
        if line.endswith(b"\n"):
            found: dict[str, Any] = json.loads(line)
            return TaskOutcome(**found)
        if late:
            return TaskOutcome(None, TOO_LONG, f"it took more than {task.seconds:g} seconds")
    return TaskOutcome(None, DIED, _how_it_ended(process))


def _next_line(process: "subprocess.Popen[bytes]", seconds: float | None) -> tuple[bytes, bool]:
    """Return the next line of a process, b"" at its end, and whether it was killed because it took too long."""
    assert process.stdout is not None
    late = threading.Event()

    def ring() -> None:
        late.set()
        process.kill()

    timer = threading.Timer(seconds, ring) if seconds is not None else None
    if timer is not None:
        timer.daemon = True
        timer.start()
    try:
        line = process.stdout.readline()
    finally:
        if timer is not None:
            timer.cancel()
    return line, late.is_set()


def _how_it_ended(process: "subprocess.Popen[bytes]") -> str:
    """Return how a process ended, in words; a process that still runs is ended first."""
    with suppress(subprocess.TimeoutExpired):
        process.wait(timeout=1.0)
    _end(process)
    code = process.returncode
    if code >= 0:
        return f"its process ended with exit code {code}"
    try:
        return f"its process was ended by {signal.Signals(-code).name}"
    except ValueError:
        return f"its process was ended by signal {-code}"


def _end(process: "subprocess.Popen[bytes]") -> None:
    """Kill a process, wait for its end, and close its streams."""
    process.kill()
    process.wait()
    for stream in (process.stdin, process.stdout):
        if stream is not None:
            with suppress(OSError, ValueError):
                stream.close()
