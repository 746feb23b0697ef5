"""The benchmark of tasks with several things, in which order and places matter.

    python -m benchmarks.orders --count 5 --seed 0 [--kinds corners,closet] [--no-pull] [--jobs J] -o results.jsonl
    python -m benchmarks.orders --count 0 --pushworld FOLDER -o results.jsonl     (puzzles in scenario folders)
    python -m benchmarks.orders --kinds swap --seed 7 --count 1 --keep FOLDER     (one world; its episode stays)

With -o runs that the file already has under the same conditions are not run again, and the table is of all that the
file has. The table goes to stdout, progress to stderr. The exit code is 0 when no claim was false, nothing broke and
the judge found nothing of the physics. docs/results/worlds.md explains the columns.
"""

import argparse
import sys
import tempfile
from collections.abc import Sequence
from contextlib import ExitStack, closing
from functools import partial
from pathlib import Path

from benchmarks.harness.judging import judge_path
from benchmarks.orders.asked import AskedRun, puzzles, random_tasks
from benchmarks.orders.row import KEY_NAMES, OrderRow, RunBounds, key_of_run, problem_of, row_of_entry
from benchmarks.orders.run import row_of_outcome, run_task
from benchmarks.orders.table import failures, table
from benchmarks.worlds.several.kinds import SEVERAL_KINDS, several_kinds
from utak.kb.language.diagnostics import BadInputError, CannotOpenError
from utak.simulator.sweep.executors.processes import run_in_processes
from utak.simulator.sweep.executors.tasks import Executor, WorkerTask
from utak.simulator.sweep.results import Results

DEFAULTS = RunBounds()
PREPARATION = WorkerTask("utak.simulator.sweep.one_run:prepare", {"carrying": True, "paths": "skeleton"})


def main(arguments: Sequence[str] | None = None, executor: Executor | None = None) -> int:
    """Run the benchmark; return 0 when nothing was wrong, 1 otherwise, 2 when an input cannot be used.

    executor : carries the runs out; None for worker processes.
    """
    given = _parser().parse_args(arguments)
    if judge_path() is None:
        print("orders: no judge: set UTAK_JUDGE; episodes are not judged", file=sys.stderr)
    bounds = RunBounds(given.pull, given.max_steps, given.seconds, given.search)
    try:
        asked = random_tasks(given.kinds, given.seed, given.count)
        if given.pushworld:
            asked += puzzles(given.pushworld)
        workers = executor or partial(run_in_processes, jobs=given.jobs, preparation=PREPARATION)
        rows = _run_all(asked, bounds, given.output, given.keep, workers)
    except (OSError, BadInputError, CannotOpenError) as error:
        print(f"orders: {error}", file=sys.stderr)
        return 2
    print(table(rows), failures(rows), sep="\n", end="")
    return 1 if any(row.faulty for row in rows) else 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.orders", description="Measure tasks of several things.")
    kinds = ",".join(SEVERAL_KINDS)
    parser.add_argument("--kinds", type=several_kinds, default=list(SEVERAL_KINDS), help=f"of {kinds} (all)")
    parser.add_argument("--count", type=partial(_at_least, 0), default=5, help="worlds of each kind (%(default)s)")
    parser.add_argument("--seed", type=partial(_at_least, 0), default=0, help="the first world's seed (%(default)s)")
    parser.add_argument("--jobs", type=partial(_at_least, 1), default=1, help="processes (%(default)s)")
    parser.add_argument("--no-pull", dest="pull", action="store_false", help="the robot may push things, never pull")
    parser.add_argument("--pushworld", type=Path, metavar="FOLDER", help="puzzles: a folder of scenarios")
    parser.add_argument(
        "--max-steps", type=partial(_at_least, 1), default=DEFAULTS.max_steps, help="most commands (%(default)s)"
    )
    parser.add_argument(
        "--seconds", type=partial(_at_least, 1), default=DEFAULTS.seconds, help="processor seconds a run (%(default)s)"
    )
    parser.add_argument(
        "--search", type=partial(_at_least, 0), default=DEFAULTS.search, help="seconds to look for a way (%(default)s)"
    )
    parser.add_argument("-o", "--output", type=Path, help="a JSON line for each run; gone on with when it is there")
    parser.add_argument("--keep", type=Path, help="folder in which scenarios and episodes stay")
    return parser


def _at_least(least: int, text: str) -> int:
    """Return the whole number in a text; raise argparse.ArgumentTypeError when it is none, or too small."""
    if not text.isascii() or not text.isdigit() or int(text) < least:
        raise argparse.ArgumentTypeError(f"{text} is no whole number from {least} on")
    return int(text)


def _run_all(
    asked: list[AskedRun], bounds: RunBounds, output: Path | None, keep: Path | None, executor: Executor
) -> list[OrderRow]:
    """Run what the results do not have yet and return all rows, those of the file included."""
    with ExitStack() as stack:
        folder = keep or Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="utak-orders-")))
        folder = folder.resolve()
        results = stack.enter_context(closing(Results(output, KEY_NAMES, check=problem_of)))
        missing = [one for one in asked if key_of_run(one, bounds) not in results.known]
        with closing(executor([run_task(one, bounds, folder) for one in missing])) as ended:
            for number, (index, outcome) in enumerate(ended, 1):
                row = row_of_outcome(missing[index], bounds, folder, outcome)
                results.append(row.entry())
                print(f"{number}/{len(missing)} {_told(row)}", file=sys.stderr, flush=True)
        return [row_of_entry(entry) for entry in results.known.values()]


def _told(row: OrderRow) -> str:
    marks = ["FALSE DONE" * row.false_done, "FALSE IMPOSSIBLE" * row.false_impossible, "judge" * bool(row.broken_laws)]
    mark = ", ".join(mark for mark in marks if mark)
    said = f"{row.kind} {row.name} (possible: {row.possible}) {row.verdict} in {row.commands} commands, {row.took} s"
    return said + (f"  <-- {mark}" if mark else "")


if __name__ == "__main__":
    sys.exit(main())
