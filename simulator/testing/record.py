"""One scenario, tried: its outcome as JSON values, whatever is wrong with it."""

import shlex
from collections.abc import Mapping
from pathlib import Path
from time import perf_counter
from typing import Any, NamedTuple

from utak.simulator.certificates.keeping import keep, kept_texts
from utak.simulator.episode.episode import EpisodeLine
from utak.simulator.run.trial import ScenarioTrial, promised_points, run_trial
from utak.simulator.scenario.settings import USUAL_RISK
from utak.simulator.scenario.untrusted import refuse_outside_links
from utak.simulator.terminal import exits
from utak.simulator.terminal.action_in_words import describe
from utak.simulator.terminal.outcome import outcome_of

TrialRecord = dict[str, Any]  # one scenario of `utak test --json` (docs/testing.md)
# By exit code: the name of a scenario's outcome, the word on its line, and the word in the summary.
OUTCOMES = {
    exits.SUCCESS: ("passed", "ok", "passed"),
    exits.NOT_REACHED: ("failed", "FAILED", "failed"),
    exits.BAD_INPUT: ("bad", "BAD", "bad"),
    exits.CANNOT_OPEN: ("absent", "ABSENT", "cannot be opened"),
    exits.OUR_BUG: ("bug", "BUG", "ended by a bug of ours"),
}


class Wish(NamedTuple):
    """A scenario that is to be tried."""

    folder: str  # the scenario
    root: str  # the folder in which it was found
    given: Mapping[str, Any]  # fields of `Settings` by name that the user gave; they win over those of trial.lp.
    kb_files: tuple[str, ...] = ()  # files of rules, in addition to those of trial.lp.
    untrusted: bool = False  # whether links that lead out of the scenario are refused
    timed: bool = False  # whether the record says how long it took
    kept: tuple[str, str] | None = None  # the folder and the name under which the episode and its certificate are kept
    risk: float = USUAL_RISK  # of that certificate, with noise, percent
    force: bool = False  # whether files of other kinds are overwritten there


def try_scenario(wish: Wish) -> TrialRecord:
    """Return the record of a scenario that was tried; errors end up in it."""
    trials: list[ScenarioTrial] = []
    began = perf_counter()
    code, error = outcome_of(_run, wish, trials)
    seconds = perf_counter() - began
    record = broken_off(wish, code, error) if not trials else _record(wish, code, trials[0])
    return record | {"seconds": round(seconds, 3)} if wish.timed else record


def _run(wish: Wish, trials: list[ScenarioTrial]) -> int:
    """Run the scenario, append its trial to `trials` and return the exit code."""
    if wish.untrusted:
        refuse_outside_links(wish.folder, wish.root)
    lines: list[EpisodeLine] = []
    listeners = [] if wish.kept is None else [lines.append]
    trials.append(run_trial(Path(wish.folder), wish.given, wish.kb_files, listeners=listeners))
    if wish.kept is not None:
        keep(*wish.kept, kept_texts(lines, trials[0].result.verdict, wish.risk), wish.force)
    return exits.SUCCESS if trials[0].passed else exits.NOT_REACHED


def repeating_command(wish: Wish) -> str:
    """Return the command that tries a scenario again, as a POSIX shell reads it."""
    words = ["utak", "test", f"./{wish.folder}" if wish.folder.startswith("-") else wish.folder]
    for name, value in wish.given.items():
        words += ["--no-pull"] if name == "pull" else [f"--{name.replace('_', '-')}", str(value)]
    for path in wish.kb_files:
        words += ["--kb", path]
    return shlex.join(words + ["--untrusted"] * wish.untrusted)


def without_run(wish: Wish, code: int, error: str) -> TrialRecord:
    """Return the record of a scenario that was not run to its end, with the message that says why."""
    return {
        "scenario": wish.folder,
        "outcome": OUTCOMES[code][0],
        "exit_code": code,
        "error": error,
        **dict.fromkeys(("verdict", "believed", "achieved", "steps", "reason", "options")),
        "faults": [],
        "points": None,
        "weighed": False,
        "expectations": [],
        "last_steps": [],
        "command": repeating_command(wish),
    }


def broken_off(wish: Wish, code: int, error: str) -> TrialRecord:
    """Return the record of a scenario that is there and was not run to its end: it earned none of its points."""
    return without_run(wish, code, error) | promised_points(wish.folder, wish.root if wish.untrusted else None)


def _record(wish: Wish, code: int, trial: ScenarioTrial) -> TrialRecord:
    return without_run(wish, code, "") | {
        **{name: getattr(trial.result, name) for name in ("believed", "achieved", "steps", "reason")},
        "verdict": str(trial.result.verdict),
        "options": trial.settings.options | {"kb": list(trial.settings.kb_files)},
        "faults": list(trial.faults),
        "points": trial.score._asdict(),
        "weighed": trial.weighed,
        "expectations": [one.entry for one in trial.outcomes],
        "last_steps": [
            {"step": line["step"], "action": describe(line["action"]), "why": line["why"]} for line in trial.last_steps
        ],
    }
