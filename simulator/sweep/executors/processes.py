"""Tasks carried out by several worker processes on this machine."""

import queue
import threading
from collections.abc import Generator, Sequence
from typing import NamedTuple

from utak.simulator.sweep.executors.task_process import TaskProcess
from utak.simulator.sweep.executors.tasks import TaskOutcome, WorkerTask

MAX_JOINING_SECONDS = 10.0  # seconds until a thread whose process was killed has ended; a convention


class _Ended(NamedTuple):
    """Tells how a task ended in a thread: an outcome, or the exception that ended the thread."""

    number: int
    outcome: TaskOutcome | None
    error: BaseException | None = None


def run_in_processes(
    tasks: Sequence[WorkerTask], jobs: int, preparation: WorkerTask | None = None
) -> Generator[tuple[int, TaskOutcome], None, None]:
    """Carry tasks out in worker processes and yield (index, outcome) as they end."""
    waiting: queue.SimpleQueue[int] = queue.SimpleQueue()
    ended: queue.SimpleQueue[_Ended] = queue.SimpleQueue()
    for index in range(len(tasks)):
        waiting.put(index)
    processes = [TaskProcess(preparation) for _ in range(min(jobs, len(tasks)))]
    stopping = threading.Event()

    def work(process: TaskProcess) -> None:
        index = -1
        try:
            while not stopping.is_set():
                index = waiting.get_nowait()
                ended.put(_Ended(index, process.run(tasks[index])))
        except queue.Empty:
            process.close()
        except BaseException as error:
            ended.put(_Ended(index, None, error))

    threads = [threading.Thread(target=work, args=(process,), daemon=True) for process in processes]
    try:
        for thread in threads:
            thread.start()
        for _ in tasks:
            found = ended.get()
            if found.outcome is None:
                raise found.error or RuntimeError("a worker ended without an outcome")
            yield found.number, found.outcome
    finally:
        stopping.set()
        for process in processes:
            process.close()
        for thread in threads:
            if thread.ident is not None:
                thread.join(MAX_JOINING_SECONDS)
