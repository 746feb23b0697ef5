"""A process beside ours in which clingo reads what users wrote (kb.reasoning.query_worker): it can be killed, and
dies alone.

It is isolated: nothing in the working directory or on PYTHONPATH is executed. It ends when this process ends.
"""

import json
import queue
import subprocess
import threading
from contextlib import suppress
from typing import IO, Any

from utak_command import beside

START = 30.0  # seconds in which a worker must be ready
Lines = queue.SimpleQueue[bytes]


class Worker:
    """Starts when it is first asked; one that dies or takes too long is replaced for the next request."""

    def __init__(self) -> None:
        self._process: subprocess.Popen[bytes] | None = None
        self._lines: Lines = queue.SimpleQueue()

    def close(self) -> None:
        """End the process."""
        worker, self._process = self._process, None
        if worker is not None:
            _end(worker)

    def exchange(self, request: dict[str, Any], seconds: float) -> dict[str, Any]:
        """What the worker answers; {"limit": why} when it does not within so many seconds.

        One that is interrupted while it works is ended, for its answer would be taken for that of the next request.
        """
        if self._process is None:
            self._process, self._lines = _started()
        worker, self._process = self._process, None
        line: bytes | None = b""
        try:
            assert worker.stdin is not None
            with suppress(OSError):  # it has ended
                worker.stdin.write(json.dumps(request, allow_nan=False).encode("ascii") + b"\n")
                worker.stdin.flush()
                line = _line(self._lines, seconds)
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


def _started() -> "tuple[subprocess.Popen[bytes], Lines]":
    """A fresh worker, ready, and the lines that it writes."""
    worker = subprocess.Popen(
        beside("kb.reasoning.query_worker"),
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        start_new_session=True,  # Ctrl-C is for the prompt, which ends the worker itself
        creationflags=getattr(subprocess, "CREATE_NEW_PROCESS_GROUP", 0),  # the same on Windows
    )
    lines: Lines = queue.SimpleQueue()
    try:
        threading.Thread(target=_collect, args=(worker.stdout, lines), daemon=True).start()
        if (_line(lines, START) or b"").rstrip() != b"ready":
            raise RuntimeError("the process beside ours does not start")
    except BaseException:
        _end(worker)
        raise
    return worker, lines


def _collect(stream: IO[bytes], lines: Lines) -> None:
    """Put the lines of a stream into a queue, and an empty one at its end."""
    with suppress(OSError, ValueError):
        for line in stream:
            lines.put(line)
    lines.put(b"")
    with suppress(OSError):
        stream.close()


def _line(lines: Lines, seconds: float) -> bytes | None:
    """The next line; empty when they have ended, None when it does not come in time."""
    try:
        return lines.get(timeout=max(0.0, seconds))
    except queue.Empty:
        return None


def _end(worker: "subprocess.Popen[bytes]") -> None:
    """End a process, and forget what it has not read."""
    worker.kill()
    worker.wait()
    if worker.stdin is not None:
        with suppress(OSError):
            worker.stdin.close()
