"""A worker process that carries out tasks: it is prepared, and a task whose process ends is tried once more."""

import os
import subprocess
import time
from tempfile import TemporaryDirectory

from utak.kb.reasoning.worker import WorkerEndedError, WorkerProcess
from utak.simulator.sweep.executors.tasks import DIED, TOO_LONG, TaskOutcome, WorkerTask

MAX_PREPARATION_SECONDS = 900.0  # seconds for its preparation, which may compile all kernels; a convention
MAX_ATTEMPTS = 2  # of a task whose process ends: the first end may have had another cause; a convention


class TaskProcess:
    """A worker process, started when the first task comes. One thread uses it; any other may close it."""

    def __init__(
        self,
        preparation: WorkerTask | None = None,
        idle_seconds: float = 0.0,
        folder: str | None = None,
        is_quiet: bool = True,
    ) -> None:
        self._preparation = preparation
        # The place of all temporary files of the process: it goes, even when the process is killed before it cleans up.
        self._temporary = TemporaryDirectory(prefix="utak-sweep-", ignore_cleanup_errors=True)
        self._worker = WorkerProcess(
            "utak.simulator.sweep.executors.worker",
            f"{idle_seconds:g}",
            stderr=subprocess.DEVNULL if is_quiet else None,
            cwd=folder,
            env={**os.environ, **dict.fromkeys(("TMPDIR", "TEMP", "TMP"), self._temporary.name)},
        )

    def run(self, task: WorkerTask) -> TaskOutcome:
        """Carry out a task in the process and return the outcome."""
        # Raises RuntimeError when no process can be started.
        for _ in range(MAX_ATTEMPTS):
            begun = time.monotonic()
            try:
                self.prepare()
                return self._carried_out(task)
            except WorkerEndedError as ended:
                failure = TOO_LONG if ended.is_late else DIED
                outcome = TaskOutcome(None, failure, str(ended), time.monotonic() - begun)
            if outcome.failure != DIED or self._worker.is_closed:
                break
        return outcome

    def prepare(self) -> None:
        """Start and prepare the process, unless it runs or this handle was closed."""
        # Raises RuntimeError when that cannot be done.
        if self._worker.is_closed or self._worker.start() is None or self._preparation is None:
            return
        try:
            problem = self._carried_out(self._preparation._replace(seconds=MAX_PREPARATION_SECONDS)).reason
        except WorkerEndedError as ended:
            problem = str(ended)
        if problem and not self._worker.is_closed:
            self._worker.end()
            raise RuntimeError(f"a worker process cannot begin: {problem}")

    def close(self) -> None:
        """End the process and whatever it does; later tasks fail."""
        self._worker.close()
        self._temporary.cleanup()

    def _carried_out(self, task: WorkerTask) -> TaskOutcome:
        request = {"function": task.function, "argument": task.argument}
        return TaskOutcome(**self._worker.exchange(request, task.seconds))
