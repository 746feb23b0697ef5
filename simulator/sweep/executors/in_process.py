"""Tasks carried out one after the other in this process: for tests, and where a debugger shall reach the function."""

from collections.abc import Generator, Sequence

from utak.simulator.sweep.executors.tasks import TaskOutcome, WorkerTask, carry_out


def run_in_this_process(tasks: Sequence[WorkerTask]) -> Generator[tuple[int, TaskOutcome], None, None]:
    """Carry tasks out in order and yield (index, outcome). Limits of time are not enforced."""
    for index, task in enumerate(tasks):
        yield index, carry_out(task)
