"""All scenarios of a command line: finding, choosing and trying them, in one process or in several."""

from collections.abc import Iterator, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

from utak.kb.language.diagnostics import CannotOpenError
from utak.simulator.run.trial import scenarios_in
from utak.simulator.sweep.executors.processes import run_in_processes
from utak.simulator.sweep.executors.tasks import TRYING_FUNCTION, WorkerTask, bug_of
from utak.simulator.terminal import exits
from utak.simulator.terminal.outcome import outcome_of
from utak.simulator.testing.record import TrialRecord, Wish, broken_off, try_scenario, without_run
from utak.simulator.testing.wording import failure_report


def find_scenarios(folders: Sequence[str], name: str = "") -> tuple[dict[Path, str], list[TrialRecord]]:
    """Return the scenarios in some folders, each once with the folder that was named, and records of empty folders."""
    found: dict[Path, tuple[Path, str]] = {}
    absent = []

    def look(root: str) -> int:
        for folder in scenarios_in(root):
            found.setdefault(folder.absolute(), (folder, root))
        return exits.SUCCESS

    for folder in folders:
        code, error = outcome_of(look, folder)
        if code:
            absent.append(without_run(Wish(folder, folder, {}), code, error))
    chosen = {folder: root for folder, root in found.values() if name.lower() in folder.as_posix().lower()}
    if found and not chosen:
        raise CannotOpenError(name, f"none of the {len(found)} scenarios has that in its name")
    return chosen, absent


def tried(wish: dict[str, Any]) -> TrialRecord:
    """Return the record of a wish and, as `report`, what is said when it failed: the work of a process."""
    record = try_scenario(Wish(**wish))
    return record | {"report": failure_report(record)}


def try_all(wishes: Sequence[Wish], jobs: int = 1) -> Iterator[TrialRecord]:
    """Yield the record of each wish, in order, each as soon as it and those before it are known."""
    if jobs <= 1 or len(wishes) <= 1:
        yield from map(try_scenario, wishes)
        return
    known: dict[int, TrialRecord] = {}
    due = 0
    tasks = [WorkerTask(TRYING_FUNCTION, wish._asdict()) for wish in wishes]
    with closing(run_in_processes(tasks, jobs, is_quiet=False)) as ended:
        for index, outcome in ended:
            known[index] = outcome.value or broken_off(wishes[index], exits.OUR_BUG, f"utak: {bug_of(outcome)}")
            known[index].pop("report", None)
            while due in known:
                yield known.pop(due)
                due += 1
