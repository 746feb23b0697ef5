"""`utak test`: run scenarios and compare their ends with expect.lp."""

import argparse
import sys
from itertools import chain
from typing import TYPE_CHECKING, Any

from simulator.cli.commands.run import add_settings, given_settings
from simulator.terminal import exits
from simulator.terminal.numbers import parse_whole
from simulator.terminal.printing import as_json

if TYPE_CHECKING:
    from simulator.testing.record import TrialRecord

JUNIT_KIND = "JUnit XML"  # what messages call the file of --junit
MAX_JOBS = 256  # scenarios at once; a convention


def add(parts: Any) -> None:
    """Declare the subcommand."""
    part = parts.add_parser("test", help="run scenario folders as tests")
    part.add_argument("folders", nargs="+", metavar="FOLDER", help="a scenario, or a folder of scenarios")
    add_settings(part)
    part.add_argument("-k", dest="name", metavar="NAME", default="", help="only scenarios with NAME in their path")
    part.add_argument("--jobs", type=_jobs, metavar="N", default=1, help="run so many at once (default 1)")
    part.add_argument("--json", action="store_true", help="print all outcomes as one JSON object")
    part.add_argument("--junit", metavar="FILE", help="write all outcomes to this file as JUnit XML")
    part.add_argument("--times", action="store_true", help="say in --json and --junit how long each scenario took")
    part.add_argument("--force", action="store_true", help="let --junit overwrite a file that is no JUnit XML")
    part.set_defaults(execute=execute)


def execute(options: argparse.Namespace) -> int:
    """Run every scenario, print one line each and the number that passed; return the most severe exit code."""
    from simulator.scenario.settings import kb_files_named
    from simulator.testing.record import Wish
    from simulator.testing.suite import find_scenarios, try_all
    from simulator.testing.wording import as_object, outcome_line, summary_line

    kb_files = kb_files_named(options.kb)
    _open_junit(options)
    found, absent = find_scenarios(options.folders, options.name)
    given, untrusted, timed = given_settings(options), options.untrusted, options.times
    wishes = [Wish(str(one.folder), str(one.root), given, kb_files, untrusted, timed) for one in found]
    records = []
    for record in chain(absent, try_all(wishes, options.jobs)):
        records.append(record)
        if record["error"]:
            print(record["error"], file=sys.stderr, flush=True)
        if not options.json:
            print(outcome_line(record), flush=True)
    _write_junit(options, records)
    if options.json:
        print(as_json(as_object(records)))
    print(summary_line(records), file=sys.stderr)
    return exits.worst(record["exit_code"] for record in records)


def _open_junit(options: argparse.Namespace) -> None:
    """Make sure, before anything is run, that the file of `--junit` can be written."""
    from simulator.episode.output_files import check_path, is_junit

    if options.junit is not None:
        check_path(options.junit, is_junit, JUNIT_KIND, options.force)


def _write_junit(options: argparse.Namespace, records: "list[TrialRecord]") -> None:
    """Write the file of `--junit`."""
    from simulator.episode.output_files import is_junit, write_whole
    from simulator.testing.junit import as_junit

    if options.junit is not None:
        write_whole(options.junit, as_junit(records).encode("utf-8"), is_junit, JUNIT_KIND, options.force)


def _jobs(text: str) -> int:
    """Return the number for `--jobs`."""
    return parse_whole(text, 1, MAX_JOBS)
