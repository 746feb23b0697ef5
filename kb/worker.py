"""A process beside ours in which clingo reads what users wrote (kb.query_worker): it can be killed, and dies alone."""

import json
import os
import select
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path
from typing import Any


class Worker:
    """Starts when it is first asked; one that dies or takes too long is replaced for the next request."""

    def __init__(self) -> None:
        self._process: subprocess.Popen[bytes] | None = None

    def close(self) -> None:
        """End the process."""
        worker, self._process = self._process, None
        if worker is None:
            return
        worker.kill()
        worker.wait()
        for stream in (worker.stdin, worker.stdout):
            if stream is not None:
                with suppress(OSError):  # what it has not read is lost
                    stream.close()

    def exchange(self, request: dict[str, Any], seconds: float) -> dict[str, Any]:
        """What the worker answers; {"limit": why} when it does not within so many seconds."""
        worker = self._process = self._process or _started()
        assert worker.stdin is not None
        line: bytes | None = b""
        with suppress(BrokenPipeError):
            worker.stdin.write(json.dumps(request, allow_nan=False).encode("ascii") + b"\n")
            worker.stdin.flush()
            line = _line(worker, seconds)
        if not line:
            self.close()
            late = f"it took more than {seconds:g} seconds"
            return {"limit": late if line is None else "it ended the process that works on it"}
        found: dict[str, Any] = json.loads(line)
        return found


def _started() -> "subprocess.Popen[bytes]":
    """A fresh worker, ready."""
    home = str(Path(__file__).resolve().parent.parent)
    path = os.pathsep.join(filter(None, [home, os.environ.get("PYTHONPATH")]))
    command = [sys.executable, "-m", "kb.query_worker"]
    worker = subprocess.Popen(
        command,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        env=os.environ | {"PYTHONPATH": path},
        start_new_session=True,  # Ctrl-C is for the prompt, which ends the worker itself
    )
    if _line(worker, 30.0) != b"ready\n":
        worker.kill()
        raise RuntimeError("the process beside ours does not start")
    return worker


def _line(worker: "subprocess.Popen[bytes]", seconds: float) -> bytes | None:
    """The next line that a worker writes; empty when it ends, None when it does not write one in time."""
    assert worker.stdout is not None
    handle, found, end = worker.stdout.fileno(), b"", time.monotonic() + seconds
    while not found.endswith(b"\n"):
        ready, _, _ = select.select([handle], [], [], max(0.0, end - time.monotonic()))
        if not ready:
            return None
        piece = os.read(handle, 1 << 20)
        if not piece:
            return b""
        found += piece
    return found
