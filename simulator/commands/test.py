"""`utak test`: run scenarios and compare their ends with what expect.lp expects."""

import argparse
import sys
from typing import Any

from kb.problems import BadInputError
from simulator import exits
from simulator.commands.run import add_settings, settings_of


def add(parts: Any) -> None:
    """Declare the subcommand."""
    part = parts.add_parser("test", help="run scenario folders as tests")
    part.add_argument("folders", nargs="+", metavar="FOLDER", help="a scenario, or a folder of scenarios")
    add_settings(part)
    part.set_defaults(execute=execute)


def execute(options: argparse.Namespace) -> int:
    """Run every scenario, print one line each, and say how many passed."""
    from simulator.trial import run_trial, scenarios_in

    settings = settings_of(options)
    folders = [scenario for folder in options.folders for scenario in scenarios_in(folder)]
    passed, bad = 0, False
    for folder in folders:
        try:
            trial = run_trial(folder, settings)
            word, message = "ok" if trial.passed else "FAILED", trial.message
            passed += trial.passed
        except BadInputError as problem:
            word, message, bad = "BAD", "its files are not as they must be", True
            print(problem, file=sys.stderr)
        print(f"{word} {folder}: {message}", flush=True)
    print(f"{passed} of {len(folders)} passed", file=sys.stderr)
    if bad:
        return exits.BAD_INPUT
    return exits.DONE if passed == len(folders) else exits.NOT_REACHED
