"""A scenario as a test: a run, and the comparison of its end with expect.lp."""

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from kb.language.diagnostics import BadInputError, CannotOpenError, Problem, SourceSpan
from simulator.episode.episode import EpisodeLog
from simulator.run.robots import make_robot
from simulator.run.session import Result, Session
from simulator.scenario.expectation import should_fail
from simulator.scenario.scenario import read_scenario
from simulator.scenario.settings import Settings


class ScenarioTrial(NamedTuple):
    """The outcome of a scenario's test.

    Attributes
    ----------
    passed : whether the test passed.
    message : the reasons, and the verdict.
    result : the end of the run.
    """

    passed: bool
    message: str
    result: Result


def run_trial(folder: Path | str, settings: Settings | None = None) -> ScenarioTrial:
    """Run a scenario and judge the end by its expect.lp.

    A scenario with `fails` passes when Utak does not believe that the task is done, and gives a reason. Any other
    passes when all expectations are met and Utak believes that the task is done.

    Parameters
    ----------
    folder : the scenario.
    settings : the options of the run; None for the defaults.

    Returns
    -------
    The outcome.

    Raises
    ------
    CannotOpenError : a file cannot be read.
    BadInputError : a file has errors, or there is no expect.lp.
    """
    scenario = read_scenario(folder)
    if scenario.expectations is None:
        where = str(Path(folder) / "expect.lp")
        raise BadInputError([Problem(where, SourceSpan(1, 1, 1), "a test needs expect.lp, which is missing")])
    session = Session(scenario, settings or Settings(), make_robot, EpisodeLog(None))
    result = session.run()
    faults = list(faults_of(result, should_fail(scenario.expectations)))
    end = f"{result.verdict} in {result.steps} steps: {result.reason}"
    return ScenarioTrial(not faults, "; ".join([*faults, end]), result)


def faults_of(result: Result, to_fail: bool) -> Iterator[str]:
    """Yield the reasons why the test fails."""
    if to_fail:
        if result.believed:
            yield "Utak believes that an impossible task is done"
        if not result.reason:
            yield "Utak gives no reason"
        return
    yield from (f"not met: {fact}" for fact in result.unmet)
    if not result.believed:
        yield "Utak does not believe that the task is done"


def scenarios_in(folder: Path | str) -> list[Path]:
    """Return the scenarios in a folder and below it: all folders with an expect.lp, in the order of their names.

    Parameters
    ----------
    folder : the folder; a scenario without expect.lp is returned itself.

    Returns
    -------
    The folders.

    Raises
    ------
    CannotOpenError : there is no such folder, or no scenario in it.
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
