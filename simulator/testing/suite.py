"""All scenarios of a command line: finding, choosing and trying them, in one process or in several."""

from collections import deque
from collections.abc import Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from threading import Lock
from typing import NamedTuple

from utak.kb.language.diagnostics import CannotOpenError
from utak.simulator.run.trial import scenarios_in
from utak.simulator.terminal import exits
from utak.simulator.terminal.outcome import outcome_of
from utak.simulator.testing.handle import WorkerEndedError, WorkerHandle
from utak.simulator.testing.record import TrialRecord, Wish, broken_off, try_scenario, without_run


class FoundScenario(NamedTuple):
    """A scenario folder, and the folder of the command line in which it was found."""

    folder: Path  # the scenario
    root: Path  # the folder that the user named


def find_scenarios(folders: Sequence[str], name: str = "") -> tuple[list[FoundScenario], list[TrialRecord]]:
    """Return the scenarios in some folders, each once, and records of the folders in which there are none."""
    found: dict[Path, FoundScenario] = {}
    absent = []

    def look(root: str) -> int:
        for folder in scenarios_in(root):
            found.setdefault(folder.absolute(), FoundScenario(folder, Path(root)))
        return exits.SUCCESS

    for folder in folders:
        code, error = outcome_of(look, folder)
        if code:
            absent.append(without_run(Wish(folder, folder, {}), code, error))
    chosen = [one for one in found.values() if name.lower() in one.folder.as_posix().lower()]
    if found and not chosen:
        raise CannotOpenError(name, f"none of the {len(found)} scenarios has that in its name")
    return chosen, absent


def try_all(wishes: Sequence[Wish], jobs: int = 1) -> Iterator[TrialRecord]:
    """Yield the record of each wish, in order, each as soon as it and those before it are known."""
    if jobs <= 1 or len(wishes) <= 1:
        yield from map(try_scenario, wishes)
        return
    handles = [WorkerHandle() for _ in range(min(jobs, len(wishes)))]
    free, taking = deque(handles), Lock()

    def ask(wish: Wish) -> TrialRecord:
        with taking:
            handle = free.popleft()  # there are as many handles as threads
        try:
            record = handle.ask(wish._asdict())
            del record["report"]
            return record
        except WorkerEndedError as ended:
            return broken_off(wish, exits.OUR_BUG, f"utak: this is a bug of ours: {ended}")
        finally:
            with taking:
                free.append(handle)

    pool = ThreadPoolExecutor(len(handles))
    try:
        answers: list[Future[TrialRecord]] = [pool.submit(ask, wish) for wish in wishes]
        for answer in answers:
            yield answer.result()
    finally:
        pool.shutdown(wait=False, cancel_futures=True)
        for handle in handles:
            handle.close()
        pool.shutdown(wait=True)
