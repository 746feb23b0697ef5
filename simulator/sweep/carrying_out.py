"""A sweep from its plan to its results."""

from collections.abc import Callable
from contextlib import closing

from utak.simulator.certificates.keeping import keep
from utak.simulator.episode.schema import complaints
from utak.simulator.sweep.contents import EXPECTATIONS_FILE
from utak.simulator.sweep.executors.code_identity import code_identity
from utak.simulator.sweep.executors.tasks import Executor, TaskOutcome
from utak.simulator.sweep.plan import SweepPlan, SweepRun
from utak.simulator.sweep.results import ResultRow, Results

ROW_KEY = ("run",)  # the value of a row that tells which run it is of
TIME_DECIMALS = 3  # of the seconds in a row
Watch = Callable[[SweepRun, float], None]  # called after each run, with its seconds


def missing_runs(plan: SweepPlan, results: Results) -> dict[str, SweepRun]:
    """Return those runs of a plan that results do not have yet, by their names; the same run is there once."""
    return {name: run for run in plan.runs if ((name := plan.run_id(run)),) not in results.known}


def known_rows(plan: SweepPlan, results: Results) -> list[ResultRow]:
    """Return the rows of a plan's runs that results have, in the plan's order, under its names of scenarios."""
    found = ((run, results.known.get((plan.run_id(run),))) for run in plan.runs)
    return [{**row, "scenario": run.scenario} for run, row in found if row is not None]


def carry_out_sweep(plan: SweepPlan, results: Results, executor: Executor, watch: Watch) -> None:
    """Carry out those runs of a plan that the results do not have yet, and append each as it ends."""
    judged = {one.name: any(name == EXPECTATIONS_FILE for name, _ in one.files) for one in plan.scenarios}
    missing = list(missing_runs(plan, results).items())
    with closing(executor([plan.task(run) for _, run in missing])) as ended:
        for index, outcome in ended:
            name, run = missing[index]
            texts = (outcome.value or {}).pop("kept", None)
            if texts is not None and plan.certificates is not None:
                keep(plan.certificates, f"{run.scenario}-{run.noise:g}-{run.seed}", texts)
            results.append({"run": name, **row_of(plan, run, outcome, judged[run.scenario])})
            watch(run, outcome.seconds)


def row_of(plan: SweepPlan, run: SweepRun, outcome: TaskOutcome, judged: bool) -> ResultRow:
    """Return the row of a run, without its name; all but its seconds is the same wherever it was carried out."""
    value = outcome.value or {"result": None, "passed": False if judged else None}
    failed = {"how": outcome.failure, "reason": outcome.reason} if outcome.failure else None
    options = {name: getattr(plan.settings, name) for name in ("paths", "max_steps", "pull")}
    made_with = {name: code_identity()[name] for name in ("utak", "code")}
    seconds = round(outcome.seconds, TIME_DECIMALS)
    return {**run._asdict(), **options, **made_with, **value, "failed": failed, "seconds": seconds}


def problem_of(row: ResultRow) -> str:
    """Return what is wrong with a row of a file of results; "" when nothing is."""
    for path, what in complaints("sweep_row", row):
        return f"{'.'.join(path)}: {what}" if path else what
    return "it has a result and a failure, or neither" if (row["result"] is None) == (row["failed"] is None) else ""
