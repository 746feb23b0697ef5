"""A sweep from its plan to its results."""

from collections.abc import Callable
from contextlib import closing
from typing import Any

from utak.simulator.episode.schema import complaints
from utak.simulator.sweep.contents import EXPECTATIONS_FILE
from utak.simulator.sweep.executors.tasks import Executor, TaskOutcome
from utak.simulator.sweep.plan import SweepPlan, SweepRun
from utak.simulator.sweep.results import ResultRow, ResultsProtocol, RowForm

ROW_NAMES = ("scenario", "noise", "seed")  # the values of a row that tell which run it is of
Watch = Callable[[SweepRun, TaskOutcome], None]  # called after each run


def form_of(plan: SweepPlan) -> RowForm:
    """Return the form of the results of a sweep."""
    return RowForm(plan.header, ROW_NAMES, plan.runs, problem_of)


def carry_out_sweep(plan: SweepPlan, results: ResultsProtocol, executor: Executor, watch: Watch) -> None:
    """Carry out those runs of a plan that the results do not have yet, and append each as it ends."""
    judged = {one.name: any(name == EXPECTATIONS_FILE for name, _ in one.files) for one in plan.scenarios}
    missing = [run for run in plan.runs if run not in results.known]
    with closing(executor([plan.task(run) for run in missing])) as ended:
        for index, outcome in ended:
            run = missing[index]
            results.append(row_of(run, outcome, judged[run.scenario]))
            watch(run, outcome)


def row_of(run: SweepRun, outcome: TaskOutcome, judged: bool) -> ResultRow:
    """Return the row of a run: the same for the same run, wherever and however fast it was carried out."""
    value: dict[str, Any] = outcome.value or {"result": None, "passed": False if judged else None}
    failed = {"how": outcome.failure, "reason": outcome.reason} if outcome.failure else None
    return {"scenario": run.scenario, "seed": run.seed, "noise": run.noise, **value, "failed": failed}


def problem_of(row: ResultRow) -> str:
    """Return what is wrong with a row of a file of results; "" when nothing is."""
    result, failed = row.get("result"), row.get("failed")
    if (result is None) == (failed is None):
        return "it has neither a result nor a failure" if result is None else "it has a result and a failure"
    for path, what in complaints("sweep_row", row):
        return f"{'.'.join(path)}: {what}" if path else what
    return ""
