"""A separate process that can be killed: it answers requests, one after the other, each a line of JSON.

The process is isolated: nothing in the working directory or on PYTHONPATH is executed. It ends when this process ends.
What users wrote is read in such a process (kb.reasoning.query_worker).
"""

import json
import signal
import subprocess
import threading
from contextlib import suppress
from typing import Any

from utak.launcher import isolated_command

READY_LINE = b"ready\n"  # the first line of every such process
MAX_START_SECONDS = 60.0  # seconds of wall-clock time until a worker must be ready; a convention


class WorkerEndedError(Exception):
    """A process was ended, or ended, before it answered; the message says how."""

    def __init__(self, how: str, is_late: bool = False) -> None:
        self.is_late = is_late  # whether it was ended because it took too long
        super().__init__(how)


class WorkerProcess:
    """The handle of a process, which starts with the first request. One thread uses it; any other may close it."""

    def __init__(self, module: str, *arguments: str, **given: Any) -> None:
        self._module, self._arguments = module, arguments  # what it runs
        self._given = given  # more arguments of subprocess.Popen
        self._lock = threading.Lock()
        self._process: subprocess.Popen[bytes] | None = None
        self.is_closed = False

    @property
    def process_id(self) -> int | None:
        """The number of the process; None while none runs."""
        return None if self._process is None else self._process.pid

    def start(self) -> "subprocess.Popen[bytes] | None":
        """Start the process and return it; None when one runs already."""
        # Raises WorkerEndedError when this handle was closed, RuntimeError when the process is not ready in time.
        with self._lock:
            if self.is_closed:
                raise WorkerEndedError("it was broken off")
            if self._process is not None and self._process.poll() is None:
                return None
            if self._process is not None:
                _end(self._process)  # it ended between two requests
            process = self._process = subprocess.Popen(
                isolated_command(self._module, *self._arguments),
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                start_new_session=True,  # Ctrl-C must reach the parent only, which then ends the worker
                creationflags=getattr(subprocess, "CREATE_NEW_PROCESS_GROUP", 0),  # the same on Windows
                **self._given,
            )
        try:
            line, late = _next_line(process, MAX_START_SECONDS)
            if line.rstrip() != READY_LINE.rstrip() and not self.is_closed:
                how = f"it took more than {MAX_START_SECONDS:g} seconds" if late else _how_it_ended(process)
                raise RuntimeError(f"a worker process cannot begin: {how}")
        except BaseException:
            self.end()
            raise
        return process

    def exchange(self, request: dict[str, Any], seconds: float | None = None) -> dict[str, Any]:
        """Return the response of the process to a request; a process that takes longer than `seconds` is killed."""
        # Raises WorkerEndedError, RuntimeError as `start`.
        process = self.start() or self._process
        line, late = b"", False
        try:
            if process is None:
                raise WorkerEndedError("it was broken off")
            with suppress(OSError, ValueError):  # the process has ended, or was closed
                assert process.stdin is not None
                process.stdin.write(json.dumps(request, allow_nan=False).encode("ascii") + b"\n")
                process.stdin.flush()
                line, late = _next_line(process, seconds)
            if not line.endswith(b"\n"):
                how = f"it took more than {seconds:g} seconds" if late else _how_it_ended(process)
                raise WorkerEndedError(how, late)
        except BaseException:
            self.end()  # the answer must not come to another request
            raise
        found: dict[str, Any] = json.loads(line)
        return found

    def end(self) -> None:
        """End the process, if one runs; the next request starts another one."""
        with self._lock:
            process, self._process = self._process, None
        if process is not None:
            _end(process)

    def close(self) -> None:
        """End the process, and start no other one."""
        self.is_closed = True
        self.end()


class Worker:
    """The process for questions and users' rules."""

    def __init__(self) -> None:
        self._process = WorkerProcess("utak.kb.reasoning.query_worker", stderr=subprocess.DEVNULL)

    @property
    def process_id(self) -> int | None:
        """The number of the process; None while none runs."""
        return self._process.process_id

    def close(self) -> None:
        """End the process, if one runs; the next request starts another one."""
        self._process.end()

    def exchange(self, request: dict[str, Any], seconds: float) -> dict[str, Any]:
        """Return the response of the process to a request; its key `limit` says that there is none, and why."""
        try:
            return self._process.exchange(request, max(0.0, seconds))
        except WorkerEndedError as ended:
            return {"limit": str(ended) if ended.is_late else "it ended the process that works on it"}


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
