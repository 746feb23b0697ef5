"""The part of a Dask worker: it passes a task to a worker process of its own, one for each of its threads.

So a run that crashes, takes too long or needs too much memory ends that process alone, and not the Dask worker. The
state of this module lives in the Dask worker; each sweep has its own processes there, by the sweep's name.
"""

import threading
from typing import Any

from utak.simulator.sweep.executors.code_identity import code_identity, difference
from utak.simulator.sweep.executors.task_process import TaskProcess
from utak.simulator.sweep.executors.tasks import WorkerTask

IDLE_SECONDS = 60.0  # after which a worker process ends that gets no more tasks, as when the client died; a convention
MISMATCH = "mismatch"  # the key of an answer that refuses the task


class _Crews:
    """The worker processes in this Dask worker, by the name of the sweep and the thread."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._processes: dict[tuple[str, int], TaskProcess] = {}
        self.preparing = threading.Lock()  # so that processes of one machine do not compile the same kernels at once

    def process(self, sweep: str, preparation: WorkerTask | None) -> TaskProcess:
        """Return the process of the current thread for a sweep."""
        key = (sweep, threading.get_ident())
        with self._lock:
            return self._processes.setdefault(key, TaskProcess(preparation, IDLE_SECONDS))

    def end(self, sweep: str) -> None:
        """End all processes of a sweep."""
        with self._lock:
            ended = [self._processes.pop(key) for key in list(self._processes) if key[0] == sweep]
        for process in ended:
            process.close()


_CREWS = _Crews()


def run_task(sweep: str, identity: dict[str, str], preparation: list[Any] | None, task: list[Any]) -> dict[str, Any]:
    """Carry out a task on this Dask worker and return the outcome as a JSON value, or why it is refused."""
    here = code_identity()
    ours, theirs = ({name: one[name] for name in ("utak", "code")} for one in (here, identity))
    if ours != theirs:
        return {MISMATCH: difference(ours, theirs)}
    process = _CREWS.process(sweep, None if preparation is None else WorkerTask(*preparation))
    with _CREWS.preparing:
        process.prepare()
    outcome = process.run(WorkerTask(*task))
    return {**outcome._asdict(), "differs": difference(here, identity)}


def end_processes(sweep: str) -> None:
    """End the worker processes of a sweep on this Dask worker."""
    _CREWS.end(sweep)
