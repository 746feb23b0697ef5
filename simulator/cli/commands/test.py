"""`utak test`: run scenarios and compare their ends with expect.lp."""

import argparse
import sys
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Any

from simulator.cli.commands.run import add_settings, settings_of
from simulator.scenario.untrusted import refuse_links
from simulator.terminal import exits
from simulator.terminal.streams import escape_controls

if TYPE_CHECKING:
    from simulator.scenario.settings import Settings

TEST_OUTCOME_WORDS = {  # by exit code: the word on a scenario's line, and the word in the summary
    exits.SUCCESS: ("ok", "passed"),
    exits.NOT_REACHED: ("FAILED", "failed"),
    exits.BAD_INPUT: ("BAD", "bad"),
    exits.CANNOT_OPEN: ("ABSENT", "cannot be opened"),
    exits.OUR_BUG: ("BUG", "ended by a bug of ours"),
}


def add(parts: Any) -> None:
    """Declare the subcommand."""
    part = parts.add_parser("test", help="run scenario folders as tests")
    part.add_argument("folders", nargs="+", metavar="FOLDER", help="a scenario, or a folder of scenarios")
    add_settings(part)
    part.set_defaults(execute=execute)


def execute(options: argparse.Namespace) -> int:
    """Run every scenario, print one line each and the number that passed; return the most severe exit code."""
    from simulator.terminal.outcome import attempt

    settings = settings_of(options)
    found: list[tuple[Path, Path]] = []
    codes = []
    for folder in options.folders:
        absent = attempt(_find_scenarios, Path(folder), found)
        codes += [absent] if absent else []
    for root, scenario in found:
        code = attempt(_run_and_print, root, scenario, settings, options)
        codes.append(code)
        if code not in (exits.SUCCESS, exits.NOT_REACHED):
            print(f"{TEST_OUTCOME_WORDS[code][0]} {scenario}: see above", flush=True)
    counts = Counter(codes)
    others = "".join(
        f", {counts[code]} {TEST_OUTCOME_WORDS[code][1]}"
        for code in TEST_OUTCOME_WORDS
        if code != exits.SUCCESS and counts[code]
    )
    print(f"{counts[exits.SUCCESS]} of {len(codes)} passed{others}", file=sys.stderr)
    return exits.worst(codes)


def _find_scenarios(folder: Path, found: list[tuple[Path, Path]]) -> int:
    """Append the scenarios in a folder to `found`; return the exit code."""
    from simulator.run.trial import scenarios_in

    found += ((folder, scenario) for scenario in scenarios_in(folder))
    return exits.SUCCESS


def _run_and_print(root: Path, folder: Path, settings: "Settings", options: argparse.Namespace) -> int:
    """Run one scenario, print the outcome and return the exit code."""
    from simulator.run.trial import run_trial

    refuse_links(options, folder, root)
    trial = run_trial(folder, settings)
    code = exits.SUCCESS if trial.passed else exits.NOT_REACHED
    print(f"{TEST_OUTCOME_WORDS[code][0]} {folder}: {escape_controls(trial.message, lines=False)}", flush=True)
    return code
