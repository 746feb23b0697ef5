"""`utak check`: check the files of scenarios."""

import argparse
import sys
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

from utak.kb.language.diagnostics import BadInputError, CannotOpenError
from utak.kb.reasoning.user_rules import read_tested_rules
from utak.kb.task.task import read_start, read_task
from utak.simulator.scenario.cautions import cautions
from utak.simulator.scenario.expectation import read_expectations
from utak.simulator.scenario.picture import read_picture
from utak.simulator.scenario.scenario import read_any_world, read_scenario
from utak.simulator.scenario.trialfile import read_trial_plan
from utak.simulator.scenario.untrusted import refuse_links
from utak.simulator.scenario.worldfile import read_world
from utak.simulator.terminal import exits
from utak.simulator.terminal.outcome import outcome_of

# The words of the summary, by exit code.
OUTCOME_WORDS = {
    exits.SUCCESS: "ok",
    exits.BAD_INPUT: "bad",
    exits.CANNOT_OPEN: "cannot be opened",
    exits.OUR_BUG: "a bug of ours",
}


def execute(options: argparse.Namespace) -> int:
    """Check every path, whatever is wrong with the others; return the most severe exit code."""
    codes = []
    for root, path in [(Path(given), part) for given in options.paths for part in _parts(Path(given))]:
        code, message = outcome_of(_check, path, root, options)
        codes.append(code)
        if code == exits.SUCCESS:
            print(f"{path}: ok")
        else:
            print(message, file=sys.stderr)
    if len(codes) > 1:
        counts = Counter(codes)
        print(
            ", ".join(f"{counts[code]} {words}" for code, words in OUTCOME_WORDS.items() if counts[code]),
            file=sys.stderr,
        )
    return exits.worst(codes)


def _parts(path: Path) -> list[Path]:
    """Return the scenarios in a folder that is no scenario itself; else a list of the path alone."""
    names = ("world.lp", "world.txt", "start.lp", "goal.lp")
    if not path.is_dir() or any((path / name).exists() for name in names):
        return [path]
    folders = sorted({goal.parent for goal in path.rglob("goal.lp")})
    others = ("world.lp", "world.txt", "expect.lp")
    return [folder for folder in folders if any((folder / name).exists() for name in others)] or [path]


def _check(path: Path, root: Path, options: argparse.Namespace) -> int:
    """Check a scenario folder or one file; the file's name tells what it must hold."""
    refuse_links(options, path, root)
    if path.is_dir():
        scenario = read_scenario(path)
        if (path / "trial.lp").exists():
            _plan(path / "trial.lp")
        for caution in cautions(path, scenario):
            print(str(caution).replace(": error: ", ": warning: ", 1), file=sys.stderr)
        return exits.SUCCESS
    if path.name in FILE_CHECKS:
        FILE_CHECKS[path.name](path)
    elif not path.exists():
        raise CannotOpenError(str(path), "no such file or folder")
    elif path.suffix == ".lp":
        read_tested_rules([path])
    else:
        what = f"{path.name} is neither a file of a scenario nor one of rules"
        hint = f"a scenario's files are {', '.join(sorted(FILE_CHECKS))}; files of rules end in .lp"
        raise BadInputError.at(str(path), what, hint)
    return exits.SUCCESS


def _plan(path: Path) -> None:
    """Check a trial.lp, and the files of rules that it names."""
    if rules := read_trial_plan(path).rules:
        read_tested_rules(list(rules))


# The check for each file of a scenario, by name.
FILE_CHECKS: dict[str, Callable[[Path], Any]] = {
    "world.lp": read_world,
    "world.txt": read_picture,
    "start.lp": read_start,
    "goal.lp": lambda path: read_task(path.parent / "start.lp", path),
    "expect.lp": lambda path: read_expectations(path, read_any_world(path.parent)),
    "trial.lp": _plan,
}
