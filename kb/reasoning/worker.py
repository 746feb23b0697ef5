"""A separate process in which clingo reads what users wrote (kb.reasoning.query_worker); it can be killed.

The process is isolated: nothing in the working directory or on PYTHONPATH is executed. It ends when this process ends.
"""

import json
import queue
import subprocess
import threading
from contextlib import suppress
from typing import IO, Any

from utak.launcher import isolated_command

MAX_START_SECONDS = 30.0  # seconds of wall-clock time until a worker must be ready; a convention
LineQueue = queue.SimpleQueue[bytes]  # the lines that a worker has written


class Worker:
    """A handle of the process, which starts with the first request (see `exchange`)."""

    def __init__(self) -> None:
        self._process: subprocess.Popen[bytes] | None = None
        self._lines: LineQueue = queue.SimpleQueue()

    @property
    def process_id(self) -> int | None:
        """The number of the process; None while none runs."""
        return None if self._process is None else self._process.pid

    def close(self) -> None:
        """End the process, if one runs; the next request starts another one."""
        worker, self._process = self._process, None
        if worker is not None:
            _end(worker)

    def exchange(self, request: dict[str, Any], seconds: float) -> dict[str, Any]:
        """Return the response of the process to a request."""
        if self._process is not None and self._process.poll() is not None:
            self.close()  # it ended between two requests: it ends with the thread that started it
        if self._process is None:
            self._process, self._lines = _start()
        worker, self._process = self._process, None
        line: bytes | None = b""
        try:
            assert worker.stdin is not None
            with suppress(OSError):  # the process has ended
                worker.stdin.write(json.dumps(request, allow_nan=False).encode("ascii") + b"\n")
                worker.stdin.flush()
                line = _next_line(self._lines, seconds)
        except BaseException:
            _end(worker)
            raise
        if not line:
            _end(worker)
            late = f"it took more than {seconds:g} seconds"
            return {"limit": late if line is None else "it ended the process that works on it"}
        self._process = worker
        found: dict[str, Any] = json.loads(line)
        return found


def _start() -> "tuple[subprocess.Popen[bytes], LineQueue]":
    """Return a new process that is ready, and the queue of the lines that it writes."""
    # Raises RuntimeError when it is not ready within MAX_START_SECONDS.
    worker = subprocess.Popen(
        isolated_command("utak.kb.reasoning.query_worker"),
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        start_new_session=True,  # Ctrl-C must reach the parent only, which then ends the worker
        creationflags=getattr(subprocess, "CREATE_NEW_PROCESS_GROUP", 0),  # the same on Windows
    )
    lines: LineQueue = queue.SimpleQueue()
    try:
        threading.Thread(target=_forward_lines, args=(worker.stdout, lines), daemon=True).start()
        if (_next_line(lines, MAX_START_SECONDS) or b"").rstrip() != b"ready":
            raise RuntimeError("the worker process for queries and rules does not start")
    except BaseException:
        _end(worker)
        raise
    return worker, lines


def _forward_lines(stream: IO[bytes], lines: LineQueue) -> None:
    """Put the lines of a stream into a queue, with their line ends, and b"" at its end; close the stream."""
    with suppress(OSError, ValueError):
        for line in stream:
            lines.put(line)
    lines.put(b"")
    with suppress(OSError):
        stream.close()


def _next_line(lines: LineQueue, seconds: float) -> bytes | None:
    """Return the next line with its line end; b"" when the stream has ended, None after `seconds` seconds."""
    try:
        return lines.get(timeout=max(0.0, seconds))
    except queue.Empty:
        return None


def _end(worker: "subprocess.Popen[bytes]") -> None:
    """Kill a process, wait for its end, and close its input."""
    worker.kill()
    worker.wait()
    if worker.stdin is not None:
        with suppress(OSError):
            worker.stdin.close()
