"""The program of a worker process: a task arrives as a line of JSON, its outcome leaves as one.

The process is isolated: nothing in the working directory or on PYTHONPATH is executed. It ends when its parent ends.
What a task prints goes to the standard error.
"""

import json
import os
import sys
import threading
from typing import Any

from utak.kb.language.operating_system import end_with_parent, read_lines_from_parent
from utak.kb.reasoning.worker import READY_LINE
from utak.simulator.sweep.executors.tasks import WorkerTask, carry_out


def main(idle_seconds: str = "0") -> None:
    """Carry out tasks until the standard input ends, or until none has come for `idle_seconds` (0: for ever)."""
    end_with_parent()
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    lines = read_lines_from_parent()
    answers.write(READY_LINE)
    answers.flush()
    limit = _IdleLimit(float(idle_seconds))
    while True:
        limit.start()
        line = next(lines)
        limit.stop()
        request: dict[str, Any] = json.loads(line)
        outcome = carry_out(WorkerTask(request["function"], request["argument"]))
        answers.write(json.dumps(outcome._asdict()).encode("ascii") + b"\n")
        answers.flush()


class _IdleLimit:
    """Ends this process when no task arrives for some seconds. seconds : 0 for no limit."""

    def __init__(self, seconds: float) -> None:
        self._seconds = seconds
        self._timer: threading.Timer | None = None

    def start(self) -> None:
        """Begin to wait for a task."""
        if self._seconds:
            self._timer = threading.Timer(self._seconds, os._exit, (0,))
            self._timer.daemon = True
            self._timer.start()

    def stop(self) -> None:
        """Wait no longer: a task has arrived."""
        if self._timer is not None:
            self._timer.cancel()


if __name__ == "__main__":
    main(*sys.argv[1:])
