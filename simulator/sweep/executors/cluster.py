"""Tasks carried out by the workers of a Dask scheduler (the extra `dask`).

The tasks carry all that they need; no file of this machine is read by a worker. A Dask worker passes a task to a worker
process of its own, one for each of its threads: a run that crashes, or takes too long, ends that process alone.
Everybody who can reach a scheduler can run programs on its workers: a scheduler belongs into a network that is trusted.
"""

import logging
import queue
import threading
import time
from collections.abc import Generator, Sequence
from contextlib import suppress
from itertools import islice
from typing import Any
from uuid import uuid4

from utak.kb.language.diagnostics import CannotOpenError
from utak.simulator.sweep.executors.code_identity import code_identity, difference
from utak.simulator.sweep.executors.task_process import TaskProcess
from utak.simulator.sweep.executors.tasks import DIED, TaskOutcome, WorkerTask

MAX_CONNECTING_SECONDS = 10.0  # seconds until a scheduler must answer; a convention
MAX_WORKERLESS_SECONDS = 60.0  # seconds without any worker after which a sweep stops; a convention
POLL_SECONDS = 0.5  # between two looks at whether scheduler and workers are still there; a convention
MAX_SENT_TASKS = 1000  # tasks that are with the scheduler at once; a convention
MAX_CLOSING_SECONDS = 5.0  # seconds for telling the workers that the sweep has ended; a convention
IDLE_SECONDS = 60.0  # after which a worker process ends that gets no more tasks, as when the client died; a convention
INSTALL_HINT = "the library distributed is not installed: pip install distributed"
# The worker processes in this Dask worker, by the name of the sweep and the thread that uses them.
_PROCESSES: dict[tuple[str, int], TaskProcess] = {}
_PREPARING = threading.Lock()  # so that processes of one machine do not compile the same kernels at once


def run_on_dask(
    tasks: Sequence[WorkerTask],
    address: str,
    preparation: WorkerTask | None = None,
    max_connecting_seconds: float = MAX_CONNECTING_SECONDS,
    max_workerless_seconds: float = MAX_WORKERLESS_SECONDS,
) -> Generator[tuple[int, TaskOutcome], None, None]:
    """Carry tasks out on the workers of a Dask scheduler and yield (index, outcome) as they end."""
    client = _connect(address, max_connecting_seconds)
    sweep, identity, left = uuid4().hex, code_identity(), iter(enumerate(tasks))
    under_way: dict[str, tuple[int, Any]] = {}
    finished: queue.SimpleQueue[Any] = queue.SimpleQueue()
    seen_at = time.monotonic()
    try:
        while True:
            for index, task in islice(left, MAX_SENT_TASKS - len(under_way)):
                key = f"utak-{sweep}-{index}"
                future = client.submit(run_task, sweep, identity, preparation, task, key=key, pure=False)
                under_way[key] = index, future
                future.add_done_callback(finished.put)
            if not under_way:
                return
            try:
                future = finished.get(timeout=POLL_SECONDS)
            except queue.Empty:
                seen_at = time.monotonic() if _has_workers(client, address) else seen_at
                if time.monotonic() - seen_at > max_workerless_seconds:
                    why = f"the scheduler had no workers for {max_workerless_seconds:g} s"
                    raise CannotOpenError(address, why) from None
                continue
            yield under_way.pop(future.key)[0], _outcome(future, address)
    finally:
        _close(client, sweep, [future for _, future in under_way.values()])


def run_task(sweep: str, identity: dict[str, str], preparation: Any, task: Any) -> TaskOutcome:
    """Carry out a task on this Dask worker. Raises RuntimeError when its code or libraries are others."""
    differs = difference(code_identity(), identity)
    if differs:
        raise RuntimeError(f"it has another state of utak: {differs}")
    key = sweep, threading.get_ident()
    if key not in _PROCESSES:
        _PROCESSES[key] = TaskProcess(preparation, IDLE_SECONDS)
    process = _PROCESSES[key]
    with _PREPARING:
        process.prepare()
    return process.run(task)


def end_processes(sweep: str) -> None:
    """End the worker processes of a sweep on this Dask worker."""
    for key in [key for key in list(_PROCESSES) if key[0] == sweep]:
        _PROCESSES.pop(key).close()


def _outcome(future: Any, address: str) -> TaskOutcome:
    if future.status in ("cancelled", "lost"):
        raise CannotOpenError(address, "the scheduler was lost")
    error = future.exception() if future.status == "error" else None
    if type(error).__name__ == "KilledWorker":
        return TaskOutcome(None, DIED, "the Dask workers that had it ended")
    if error is not None:
        raise CannotOpenError(address, f"a worker cannot run utak: {type(error).__name__}: {error}")
    outcome: TaskOutcome = future.result()
    return outcome


def _has_workers(client: Any, address: str) -> bool:
    """Return whether a scheduler has workers. Raises CannotOpenError when it is lost."""
    try:
        return bool(client.nthreads())
    except Exception as error:  # of many classes: connections end in many ways
        raise CannotOpenError(address, f"the scheduler was lost: {type(error).__name__}") from None


def _connect(address: str, seconds: float) -> Any:
    """Return a client of the scheduler. Raises CannotOpenError when there is none within some seconds."""
    try:
        import distributed
    except ImportError:
        raise CannotOpenError(f"--dask {address}", INSTALL_HINT) from None
    for name in ("distributed", "distributed.client"):
        logging.getLogger(name).setLevel(logging.CRITICAL + 1)  # what matters is reported as an error
    make_client: Any = distributed.Client
    try:
        comm: Any = distributed.comm
        comm.get_address_host_port(address)
        return make_client(address, timeout=seconds, set_as_default=False)
    except (OSError, TimeoutError):
        raise CannotOpenError(address, f"no Dask scheduler answers within {seconds:g} s") from None
    except (ValueError, TypeError, RuntimeError, ImportError) as error:
        raise CannotOpenError(address, f"this is no address of a Dask scheduler: {error}") from None


def _close(client: Any, sweep: str, under_way: list[Any]) -> None:
    """Cancel what is under way, end the processes on the workers, and close the client, within some seconds."""

    def close() -> None:
        with suppress(Exception):  # the scheduler may be lost
            if under_way:
                client.cancel(under_way, force=True)
            client.run(end_processes, sweep, on_error="ignore")
        with suppress(Exception):
            client.close(timeout=MAX_CLOSING_SECONDS)

    thread = threading.Thread(target=close, daemon=True)
    thread.start()
    thread.join(2 * MAX_CLOSING_SECONDS)
