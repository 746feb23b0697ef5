"""Tasks carried out by the workers of a Dask scheduler (the extra `dask`).

The tasks carry all that they need; no file of this machine is read by a worker. Everybody who can reach a scheduler can
run programs on its workers: that is Dask's design, so a scheduler belongs into a network that is trusted.
"""

import logging
import queue
import sys
import threading
import time
from collections.abc import Generator, Sequence
from contextlib import suppress
from typing import Any
from uuid import uuid4

from utak.kb.language.diagnostics import CannotOpenError
from utak.simulator.sweep.executors.cluster_worker import MISMATCH, end_processes, run_task
from utak.simulator.sweep.executors.code_identity import code_identity
from utak.simulator.sweep.executors.tasks import DIED, TaskOutcome, WorkerTask

MAX_CONNECTING_SECONDS = 10.0  # seconds until a scheduler must answer; a convention
MAX_WORKERLESS_SECONDS = 60.0  # seconds without any worker after which a sweep stops; a convention
POLL_SECONDS = 0.5  # between two looks at whether scheduler and workers are still there; a convention
TASKS_PER_THREAD = 2  # sent ahead for each thread of the workers, so that none of them waits; a convention
MAX_CLOSING_SECONDS = 5.0  # seconds for telling the workers that the sweep has ended; a convention
INSTALL_HINT = "the library distributed is not installed: pip install distributed"


def run_on_dask(
    tasks: Sequence[WorkerTask],
    address: str,
    preparation: WorkerTask | None = None,
    max_connecting_seconds: float = MAX_CONNECTING_SECONDS,
    max_workerless_seconds: float = MAX_WORKERLESS_SECONDS,
) -> Generator[tuple[int, TaskOutcome], None, None]:
    """Carry tasks out on the workers of a Dask scheduler and yield (index, outcome) as they end."""
    client = _connect(address, max_connecting_seconds)
    sweep = uuid4().hex
    sent = _Sent(client, address, sweep, tasks, preparation)
    try:
        workers = _WorkerWatch(client, address, max_workerless_seconds)
        while not sent.all_ended:
            sent.fill(TASKS_PER_THREAD * workers.threads())
            found = sent.next_ended(POLL_SECONDS)
            if found is not None:
                yield found
    finally:
        _close(client, sweep, sent)


class _Sent:
    """The tasks that are with the scheduler; few more than the workers can do at once."""

    def __init__(
        self, client: Any, address: str, sweep: str, tasks: Sequence[WorkerTask], preparation: WorkerTask | None
    ) -> None:
        self._client, self._address, self._sweep = client, address, sweep
        self._tasks, self._preparation = tasks, None if preparation is None else list(preparation)
        self._identity = code_identity()
        self._next = self._ended = 0
        self._under_way: dict[str, tuple[int, Any]] = {}
        self._finished: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self._warned = False

    @property
    def all_ended(self) -> bool:
        """Whether the outcome of every task has been returned."""
        return self._ended == len(self._tasks)

    @property
    def under_way(self) -> list[Any]:
        """The futures of the tasks that have not ended."""
        return [future for _, future in self._under_way.values()]

    def fill(self, most: int) -> None:
        """Send more tasks, until `most` are under way."""
        while self._next < len(self._tasks) and len(self._under_way) < most:
            key = f"utak-{self._sweep}-{self._next}"
            arguments = (self._sweep, self._identity, self._preparation, list(self._tasks[self._next]))
            future = self._client.submit(run_task, *arguments, key=key, pure=False)
            self._under_way[key] = (self._next, future)
            self._next += 1
            future.add_done_callback(self._finished.put)

    def next_ended(self, seconds: float) -> tuple[int, TaskOutcome] | None:
        """Return the next (index, outcome); None when none ends within some seconds."""
        try:
            future = self._finished.get(timeout=seconds)
        except queue.Empty:
            return None
        index, _ = self._under_way.pop(future.key)
        outcome = self._outcome(future)
        self._ended += 1
        return index, outcome

    def _outcome(self, future: Any) -> TaskOutcome:
        """Return the outcome that a future holds."""
        if future.status == "cancelled" or future.status == "lost":
            raise CannotOpenError(self._address, "the scheduler was lost")
        error = future.exception() if future.status == "error" else None
        if type(error).__name__ == "KilledWorker":
            return TaskOutcome(None, DIED, "the Dask workers that had it ended")
        if error is not None:
            raise CannotOpenError(self._address, f"a worker cannot run utak: {type(error).__name__}: {error}")
        found: dict[str, Any] = future.result()
        if MISMATCH in found:
            raise CannotOpenError(self._address, f"a worker has another state of utak: {found[MISMATCH]}")
        differs = found.pop("differs")
        if differs and not self._warned:
            self._warn(differs)
        return TaskOutcome(**found)

    def _warn(self, how: str) -> None:
        """Print once that results may depend on the worker."""
        self._warned = True
        print(f"utak: a worker has other libraries, so results may differ from those here: {how}", file=sys.stderr)


class _WorkerWatch:
    """Sees whether the scheduler and at least one worker are there."""

    def __init__(self, client: Any, address: str, max_seconds: float) -> None:
        self._client, self._address, self._max_seconds = client, address, max_seconds
        self._seen_at = self._asked_at = time.monotonic()
        self._threads = self._count()

    def threads(self) -> int:
        """Return the number of threads of all workers, at least 1; ask for it now and then."""
        # Raises CannotOpenError when there has been no worker for too long, or the scheduler is lost.
        now = time.monotonic()
        if now - self._asked_at >= POLL_SECONDS:
            self._threads, self._asked_at = self._count(), now
        if self._threads:
            self._seen_at = now
        elif now - self._seen_at > self._max_seconds:
            raise CannotOpenError(self._address, f"the scheduler had no workers for {self._max_seconds:g} s")
        return max(1, self._threads)

    def _count(self) -> int:
        """Return the number of threads of all workers."""
        try:
            return sum(self._client.nthreads().values())
        except Exception as error:  # of many classes: connections end in many ways
            raise CannotOpenError(self._address, f"the scheduler was lost: {type(error).__name__}") from None


def _connect(address: str, seconds: float) -> Any:
    """Return a client of the scheduler. Raises CannotOpenError when there is none within some seconds."""
    try:
        import distributed
    except ImportError:
        raise CannotOpenError(f"--dask {address}", INSTALL_HINT) from None
    logging.getLogger("distributed").setLevel(logging.CRITICAL + 1)  # what matters is reported as an error
    make_client: Any = distributed.Client
    try:
        comm: Any = distributed.comm
        comm.get_address_host_port(address)
        return make_client(address, timeout=seconds, set_as_default=False)
    except (OSError, TimeoutError):
        why = f"no Dask scheduler answers within {seconds:g} s"
        raise CannotOpenError(address, why) from None
    except (ValueError, TypeError, RuntimeError, ImportError) as error:
        raise CannotOpenError(address, f"this is no address of a Dask scheduler: {error}") from None


def _close(client: Any, sweep: str, sent: _Sent) -> None:
    """Cancel what is under way, end the processes on the workers, and close the client, within some seconds."""

    def close() -> None:
        with suppress(Exception):  # the scheduler may be lost
            if sent.under_way:
                client.cancel(sent.under_way, force=True)
            client.run(end_processes, sweep, on_error="ignore")
        with suppress(Exception):
            client.close(timeout=MAX_CLOSING_SECONDS)

    thread = threading.Thread(target=close, daemon=True)
    thread.start()
    thread.join(2 * MAX_CLOSING_SECONDS)
