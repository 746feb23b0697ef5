"""Tasks carried out by several worker processes on this machine."""

import queue
from collections.abc import Generator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed

from utak.simulator.sweep.executors.task_process import TaskProcess
from utak.simulator.sweep.executors.tasks import TaskOutcome, WorkerTask


def run_in_processes(
    tasks: Sequence[WorkerTask], jobs: int, preparation: WorkerTask | None = None, is_quiet: bool = True
) -> Generator[tuple[int, TaskOutcome], None, None]:
    """Carry tasks out in worker processes and yield (index, outcome) as they end."""
    processes = [TaskProcess(preparation, is_quiet=is_quiet) for _ in range(min(jobs, len(tasks)))]
    idle: queue.SimpleQueue[TaskProcess] = queue.SimpleQueue()

    def work(task: WorkerTask) -> TaskOutcome:
        process = idle.get()
        try:
            return process.run(task)
        finally:
            idle.put(process)

    for process in processes:
        idle.put(process)
    threads = ThreadPoolExecutor(max(1, len(processes)))
    try:
        numbers = {threads.submit(work, task): index for index, task in enumerate(tasks)}
        for ended in as_completed(numbers):
            yield numbers.pop(ended), ended.result()
    finally:
        threads.shutdown(wait=False, cancel_futures=True)
        for process in processes:
            process.close()
        threads.shutdown()
