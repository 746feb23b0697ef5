"""`utak test`: run scenarios and compare their ends with expect.lp."""

import argparse
import sys
from itertools import chain

from utak.simulator.certificates.keeping import make_folder
from utak.simulator.cli.commands.given import given_settings
from utak.simulator.episode.output_files import check_path, is_junit, write_whole
from utak.simulator.scenario.settings import kb_files_named
from utak.simulator.sweep.contents import names_of
from utak.simulator.terminal import exits
from utak.simulator.terminal.printing import as_json
from utak.simulator.testing.grades import as_csv, is_csv
from utak.simulator.testing.junit import as_junit
from utak.simulator.testing.record import Wish
from utak.simulator.testing.suite import find_scenarios, try_all
from utak.simulator.testing.wording import as_object, outcome_line, summary_line


def execute(options: argparse.Namespace) -> int:
    """Run every scenario, print one line each and the number that passed; return the most severe exit code."""
    kb_files = kb_files_named(options.kb)
    tables = (options.junit, as_junit, is_junit, "JUnit XML"), (options.csv, as_csv, is_csv, "table of grades")
    files = [table for table in tables if table[0] is not None]
    for path, _, kind, name in files:  # before anything is run
        check_path(path, kind, name, options.force)
    found, absent = find_scenarios(options.folders, options.name)
    given, untrusted, timed = given_settings(options), options.untrusted, options.times
    kept: list[tuple[str, str] | None] = [None] * len(found)
    if options.certificate is not None:
        make_folder(options.certificate)
        kept = [(options.certificate, name) for name in names_of([folder.resolve() for folder in found])]
    wishes = [
        Wish(str(folder), root, given, kb_files, untrusted, timed, where, options.risk, options.force)
        for (folder, root), where in zip(found.items(), kept, strict=True)
    ]
    records = []
    for record in chain(absent, try_all(wishes, options.jobs)):
        records.append(record)
        if record["error"]:
            print(record["error"], file=sys.stderr, flush=True)
        if not options.json:
            print(outcome_line(record), flush=True)
    for path, text, kind, name in files:
        write_whole(path, text(records).encode(), kind, name, options.force)
    if options.json:
        print(as_json(as_object(records)))
    print(summary_line(records), file=sys.stderr)
    return exits.worst(record["exit_code"] for record in records)
