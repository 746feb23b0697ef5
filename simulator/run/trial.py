"""A scenario as a test: run it and compare the end with expect.lp."""

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from kb.language.diagnostics import BadInputError, CannotOpenError, Problem, Span
from simulator.episode.episode import EpisodeLog
from simulator.run.robots import make_robot
from simulator.run.session import Result, Session
from simulator.scenario.expectation import should_fail
from simulator.scenario.scenario import read_scenario
from simulator.scenario.settings import Settings


class ScenarioTrial(NamedTuple):
    """How a scenario's test went: whether it passed, what to say of it, and how the run ended."""

    passed: bool
    message: str
    result: Result


def run_trial(folder: Path | str, settings: Settings | None = None) -> ScenarioTrial:
    """Run a scenario and judge it by its expect.lp; raises CannotOpenError or BadInputError.

    A scenario that `fails` passes when Utak does not believe that he is done and gives a reason; any other passes when
    everything expected holds and Utak believes it.
    """
    scenario = read_scenario(folder)
    if scenario.expectations is None:
        where = str(Path(folder) / "expect.lp")
        raise BadInputError([Problem(where, Span(1, 1, 1), "a test needs expect.lp, which is missing")])
    session = Session(scenario, settings or Settings(), make_robot, EpisodeLog(None))
    result = session.run()
    faults = list(_faults(result, should_fail(scenario.expectations)))
    told = f"{result.verdict} in {result.steps} steps: {result.reason}"
    return ScenarioTrial(not faults, "; ".join([*faults, told]), result)


def _faults(result: Result, to_fail: bool) -> Iterator[str]:
    if to_fail:
        if result.believed:
            yield "Utak believes that he did what cannot be done"
        if not result.reason:
            yield "Utak gives no reason"
        return
    yield from (f"not met: {fact}" for fact in result.unmet)
    if not result.believed:
        yield "Utak does not believe that he is done"


def scenarios_in(folder: Path | str) -> list[Path]:
    """Return the scenario folders (those with an expect.lp) in a folder and below it, in the order of their names.

    The folder itself is returned when it is a scenario. Raises CannotOpenError when there is none.
    """
    folder = Path(folder)
    if not folder.is_dir():
        raise CannotOpenError(str(folder), "no such folder")
    found = sorted({path.parent for path in folder.rglob("expect.lp")})
    if not found and any((folder / name).exists() for name in ("world.lp", "world.txt")):
        return [folder]
    if not found:
        raise CannotOpenError(str(folder), "there is no scenario with an expect.lp in it")
    return found
