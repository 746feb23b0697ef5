"""`utak test`: run scenarios and compare their ends with expect.lp."""

import argparse
import sys
from itertools import chain
from typing import TYPE_CHECKING, Any

from utak.simulator.cli.commands.run import add_settings, given_settings
from utak.simulator.terminal import exits
from utak.simulator.terminal.numbers import parse_whole
from utak.simulator.terminal.printing import as_json

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from utak.simulator.episode.output_files import Kind
    from utak.simulator.testing.record import TrialRecord

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
    part.add_argument("--csv", metavar="FILE", help="write the points of all scenarios to this file as a table")
    part.add_argument("--times", action="store_true", help="say in --json and --junit how long each scenario took")
    part.add_argument("--force", action="store_true", help="let --junit and --csv overwrite files of other kinds")
    part.set_defaults(execute=execute)


def execute(options: argparse.Namespace) -> int:
    """Run every scenario, print one line each and the number that passed; return the most severe exit code."""
    from utak.simulator.episode.output_files import check_path, write_whole
    from utak.simulator.scenario.settings import kb_files_named
    from utak.simulator.testing.record import Wish
    from utak.simulator.testing.suite import find_scenarios, try_all
    from utak.simulator.testing.wording import as_object, outcome_line, summary_line

    kb_files = kb_files_named(options.kb)
    for path, _, kind, name in _files(options):  # before anything is run
        check_path(path, kind, name, options.force)
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
    for path, text, kind, name in _files(options):
        write_whole(path, text(records).encode(), kind, name, options.force)
    if options.json:
        print(as_json(as_object(records)))
    print(summary_line(records), file=sys.stderr)
    return exits.worst(record["exit_code"] for record in records)


def _files(options: argparse.Namespace) -> "Iterator[tuple[str, Callable[[Sequence[TrialRecord]], str], Kind, str]]":
    """Yield each file that is to be written: its path, what makes its text, and which files it may overwrite."""
    from utak.simulator.episode.output_files import is_junit
    from utak.simulator.testing.grades import as_csv, is_csv
    from utak.simulator.testing.junit import as_junit

    if options.junit is not None:
        yield options.junit, as_junit, is_junit, "JUnit XML"
    if options.csv is not None:
        yield options.csv, as_csv, is_csv, "table of grades"


def _jobs(text: str) -> int:
    """Return the number for `--jobs`."""
    return parse_whole(text, 1, MAX_JOBS)
