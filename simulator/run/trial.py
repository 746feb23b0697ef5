"""A scenario as a test: a run, and the comparison of its end with expect.lp and with the questions of trial.lp."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

from utak.kb.language.diagnostics import BadInputError, CannotOpenError, Problem, SourceSpan
from utak.kb.language.terms import Fact
from utak.simulator.episode.episode import EpisodeLine, EpisodeLog
from utak.simulator.episode.record import facts_of_line
from utak.simulator.run.robots import make_robot
from utak.simulator.run.session import Result, RobotMaker, Session
from utak.simulator.scenario.expectation import expects_verdict, read_expectations, weights_of
from utak.simulator.scenario.points import ExpectationOutcome, PointScore, score
from utak.simulator.scenario.scenario import Scenario, collect_problems, read_scenario
from utak.simulator.scenario.settings import Settings, kb_files_named
from utak.simulator.scenario.trialfile import TRIAL_FILE, TrialPlan, answers_as_wanted, query_of, read_trial_plan
from utak.simulator.scenario.untrusted import refuse_outside_links

LAST_STEPS = 5  # the number of steps before the end that a trial keeps, for reports; a convention
NO_PLAN = TrialPlan({}, (), {})  # what holds without trial.lp


class ScenarioTrial(NamedTuple):
    """The outcome of a scenario's test."""

    passed: bool  # whether the test passed
    result: Result  # the end of the run
    settings: Settings  # the options of the run
    faults: tuple[str, ...]  # the reasons why it failed, in words; () when it passed
    outcomes: tuple[ExpectationOutcome, ...]  # what came of each expectation and each question, with their points
    weighed: bool  # whether the scenario's author weighed them
    last_steps: tuple[EpisodeLine, ...]  # the last lines of the episode: at most `LAST_STEPS` of them, without step 0

    @property
    def score(self) -> PointScore:
        """The points earned, and those that could be."""
        return score(self.outcomes)


def run_trial(
    folder: Path | str,
    given: Mapping[str, Any] | None = None,
    kb_files: Sequence[str] = (),
    make: RobotMaker = make_robot,
    listeners: Sequence[Callable[[EpisodeLine], None]] = (),
) -> ScenarioTrial:
    """Run a scenario and judge the end by its expect.lp and trial.lp; listeners are told each line of the episode."""
    # A scenario passes when all that is tested is met, and its end is the one expected: with `fails`, Utak does not
    # believe that the task is done, and gives a reason; with `verdict(V)`, the verdict is V; otherwise Utak believes
    # that the task is done.
    scenario, plan = _read(Path(folder))
    rules = kb_files_named([*kb_files, *plan.rules])
    settings = replace(Settings(kb_files=rules), **{**plan.options, **(given or {})})
    session = Session(scenario, settings, make, EpisodeLog(None, listeners=listeners))
    last_steps: list[EpisodeLine] = []

    def keep(at: Session) -> None:
        if at.line["action"] is not None and at.line not in last_steps[-1:]:
            last_steps[:] = [*last_steps, at.line][-LAST_STEPS:]

    result = session.run(keep)
    outcomes = (*result.outcomes, *_answers(plan, facts_of_line(session.line), rules))
    assert scenario.expectations is not None
    faults = tuple(faults_of(result, outcomes, expects_verdict(scenario.expectations)))
    weighed = _is_weighed(scenario.expectations, plan)
    return ScenarioTrial(not faults, result, settings, faults, outcomes, weighed, tuple(last_steps))


def promised_points(folder: Path | str, root: Path | str | None = None) -> dict[str, Any]:
    """Return `points` and `weighed` for the record of a scenario that was not run; {} where they cannot be read."""
    # root : the folder that links must not lead out of; None to follow them.
    expect, trial = Path(folder) / "expect.lp", Path(folder) / TRIAL_FILE
    try:
        for file in (expect, trial) if root is not None else ():
            refuse_outside_links(file, root)
        facts = read_expectations(expect, None)
        plan = read_trial_plan(trial) if trial.exists() else NO_PLAN
    except (BadInputError, CannotOpenError):
        return {}
    possible = sum(weights_of(facts).values()) + sum(plan.asks.values())
    return {"points": PointScore(0, possible)._asdict(), "weighed": _is_weighed(facts, plan)}


def _is_weighed(expectations: Sequence[Fact], plan: TrialPlan) -> bool:
    """Return whether an author weighed some expectations or questions."""
    return any(fact.name == "weight" for fact in expectations) or any(n != 1 for n in plan.asks.values())


def _read(folder: Path) -> tuple[Scenario, TrialPlan]:
    """Return a scenario that has an expect.lp, and what its trial.lp says; raise the errors of all files at once."""
    problems: list[Problem] = []
    scenario = collect_problems(problems, lambda: read_scenario(folder))
    if scenario is not None and scenario.expectations is None:
        what = "a test needs expect.lp, which is missing"
        problems.append(Problem(str(folder / "expect.lp"), SourceSpan(1, 1, 1), what))
    trial = folder / TRIAL_FILE
    plan = collect_problems(problems, lambda: read_trial_plan(trial)) if trial.exists() else NO_PLAN
    if problems or scenario is None or plan is None:
        raise BadInputError(problems)
    return scenario, plan


def _answers(plan: TrialPlan, facts: Sequence[str], rules: Sequence[str]) -> Iterator[ExpectationOutcome]:
    """Yield the outcome of each question of trial.lp, asked of the world model at the end."""
    if not plan.asks:
        return
    from utak.kb.reasoning.query import QueryEngine, QueryLimitError  # only where something is asked: it takes time

    with QueryEngine(rules=rules) as engine:
        for asked, points in plan.asks.items():
            try:
                found = engine.ask(facts, query_of(asked))
                came = answers_as_wanted(asked, found.kind, found.rows, found.more)
            except QueryLimitError as limit:
                came = str(limit)
            except BadInputError as bad:
                came = f"the question cannot be answered: {bad.problems[0].what}"
            yield ExpectationOutcome(str(asked), came, points)


def faults_of(result: Result, outcomes: Sequence[ExpectationOutcome], verdict_expected: bool) -> Iterator[str]:
    """Yield the reasons why the test fails."""
    for one in outcomes:
        if not one.met:
            yield one.came if one.expected == "fails" else f"not met: {one.expected}: {one.came}"
    if not verdict_expected and not result.believed:
        yield "Utak does not believe that the task is done"


def scenarios_in(folder: Path | str) -> list[Path]:
    """Return the scenarios in a folder and below it: all folders with an expect.lp, in the order of their names."""
    folder = Path(folder)
    if not folder.is_dir():
        raise CannotOpenError(str(folder), "no such folder")
    found = sorted({path.parent for path in folder.rglob("expect.lp")})
    if not found and any((folder / name).exists() for name in ("world.lp", "world.txt")):
        return [folder]
    if not found:
        raise CannotOpenError(str(folder), "there is no scenario with an expect.lp in it")
    return found
