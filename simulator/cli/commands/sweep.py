"""`utak sweep`: run scenarios with many seeds and noises, in parallel, and sum up what came out."""

import argparse
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from utak.simulator.cli.commands.run import add_robot_settings
from utak.simulator.scenario.untrusted import refuse_links
from utak.simulator.terminal import exits
from utak.simulator.terminal.numbers import MAX_SECONDS, MIN_SECONDS, parse_decimal, parse_whole
from utak.simulator.terminal.printing import as_json

if TYPE_CHECKING:
    from utak.simulator.sweep.executors.tasks import Executor, TaskOutcome
    from utak.simulator.sweep.plan import SweepPlan, SweepRun
    from utak.simulator.sweep.results import ResultRow

MAX_SWEEP_JOBS = 1024  # the greatest --jobs; a convention
# The end of the help text.
RESULTS_HELP = (
    "A file of results that is there already is gone on with when it is of the same sweep, and refused when it is of "
    "another one. The same sweep gives the same file byte for byte, with any --jobs and on Dask, unless a run fails."
)


def add(parts: Any) -> None:
    """Declare the subcommand."""
    part = parts.add_parser(
        "sweep",
        help="run scenarios with many seeds and noises, in parallel",
        description="Run scenarios with many seeds and noises, in parallel, and sum up what came out.",
        epilog=RESULTS_HELP,
    )
    part.add_argument("scenarios", nargs="+", metavar="SCENARIO", help="a scenario, or a folder of scenarios")
    part.add_argument(
        "--seeds", type=_seeds, default=((0, 1),), metavar="A:B", help="seeds A to B-1; also A,C:D,... (default 0)"
    )
    part.add_argument("--noise", type=_noises, default=(0.0,), metavar="S,...", help="noises, each 0 to 1 (default 0)")
    where = part.add_mutually_exclusive_group()
    where.add_argument(
        "--jobs", type=_jobs, default=1, metavar="N", help="runs at once; 0 for one a processor (default 1)"
    )
    where.add_argument("--dask", metavar="ADDRESS", help="run on the workers of this Dask scheduler, tcp://HOST:PORT")
    part.add_argument("-o", "--output", metavar="FILE", help="a JSON line for each run; - is the standard output")
    part.add_argument("--force", action="store_true", help="begin anew, and overwrite whatever the files hold")
    part.add_argument("--seconds", type=_seconds, metavar="S", help="end a run that takes longer than S seconds")
    add_robot_settings(part)
    part.add_argument("--times", metavar="FILE", help="a JSON line for each run carried out now, with its seconds")
    part.add_argument("--svg", metavar="FILE", help="draw success rates and numbers of commands")
    part.add_argument("--json", action="store_true", help="print the summary as one JSON object")
    part.set_defaults(execute=execute)


def execute(options: argparse.Namespace) -> int:
    """Carry out the sweep, print the summary and return the exit code."""
    from utak.simulator.run.interrupts import end_at_request
    from utak.simulator.sweep.carrying_out import carry_out_sweep, form_of
    from utak.simulator.sweep.plan import MAX_RUNS
    from utak.simulator.sweep.results import STDOUT_NAME, open_results

    if options.json and options.output == STDOUT_NAME:
        return _usage("--json and -o - both want the standard output")
    plan, carrying = _plan(options)
    if plan.size > MAX_RUNS:
        return _usage(f"{plan.size} runs are more than {MAX_RUNS}")
    _check_picture(options)
    with end_at_request(), _Times(options.times, options.force) as times:
        results = open_results(options.output, form_of(plan), options.force)
        code = exits.SUCCESS
        try:
            left = [run for run in plan.runs if run not in results.known]
            watch = _Watch(left, len(results.known), times)
            if left:
                carry_out_sweep(plan, results, _executor(options, plan.settings.paths, carrying), watch.note)
        except KeyboardInterrupt:
            code = exits.INTERRUPTED
        finally:
            results.finish()
    _report(options, plan, [results.known[run] for run in plan.runs if run in results.known])
    if code == exits.INTERRUPTED:
        again = "" if options.output in (None, STDOUT_NAME) else "; the same command goes on from there"
        print(f"utak: interrupted: {len(results.known)} of {plan.size} runs are done{again}", file=sys.stderr)
        return code
    return _exit_code(list(results.known.values()))


def _plan(options: argparse.Namespace) -> "tuple[SweepPlan, bool]":
    """Return the plan of the command line, and whether a task moves objects; read and check all files."""
    from utak.kb.language.source_text import read_source
    from utak.planner.stages import stages
    from utak.simulator.run.trial import scenarios_in
    from utak.simulator.scenario.scenario import read_scenario
    from utak.simulator.scenario.settings import Settings, kb_files_named
    from utak.simulator.sweep.contents import names_of, read_contents
    from utak.simulator.sweep.plan import SweepPlan

    folders, carrying = {}, False
    for named in options.scenarios:
        for folder in scenarios_in(named):
            refuse_links(options, folder, named)
            scenario = read_scenario(folder)  # reports errors before anything is run
            carrying |= any(stage.carried for stage in stages(scenario.task))
            folders[folder.resolve()] = folder
    contents = [read_contents(*found) for found in zip(folders.values(), names_of(list(folders)), strict=True)]
    given = {name: getattr(options, name) for name in ("paths", "max_steps", "pull")}
    settings = Settings(**{name: value for name, value in given.items() if value is not None})
    rules = [(Path(path).name, read_source(path).text) for path in kb_files_named(options.kb)]
    plan = SweepPlan(tuple(contents), options.seeds, options.noise, settings, tuple(rules), options.seconds)
    return plan, carrying


def _executor(options: argparse.Namespace, paths: str, carrying: bool) -> "Executor":
    """Return what carries out the runs. Kernels are compiled here first, where worker processes run here."""
    from functools import partial

    from utak.simulator.run.warming import warm
    from utak.simulator.sweep.executors.tasks import WorkerTask
    from utak.simulator.sweep.plan import PREPARATION_FUNCTION

    preparation = WorkerTask(PREPARATION_FUNCTION, {"carrying": carrying, "paths": paths})
    if options.dask is not None:
        from utak.simulator.sweep.executors.cluster import run_on_dask

        return partial(run_on_dask, address=options.dask, preparation=preparation)
    from utak.simulator.sweep.executors.processes import run_in_processes

    warm(carrying, paths)
    return partial(run_in_processes, jobs=options.jobs or usable_processors(), preparation=preparation)


def _check_picture(options: argparse.Namespace) -> None:
    """Raise CannotOpenError when the picture could not be written at the end."""
    from utak.simulator.episode.output_files import check_path, is_svg

    if options.svg:
        check_path(options.svg, is_svg, "SVG picture", options.force)


def usable_processors() -> int:
    """Return the number of processors that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


class _Watch:
    """Follows the runs: reports progress on a terminal, and writes their times."""

    def __init__(self, left: "list[SweepRun]", known: int, times: "_Times") -> None:
        from collections import Counter

        from utak.simulator.terminal.progress import Progress

        self._times = times
        self._progress = Progress(Counter((run.scenario, run.noise) for run in left), "runs")
        if known and sys.stderr.isatty():
            print(f"{known} runs are known already", file=sys.stderr)

    def note(self, run: "SweepRun", outcome: "TaskOutcome") -> None:
        """Note that a run has ended."""
        self._times.write(run, outcome.seconds)
        self._progress.note((run.scenario, run.noise), outcome.seconds)


def is_times(head: bytes) -> bool:
    """Return whether a file with these first bytes is one of `--times`."""
    from utak.simulator.sweep.plan import SweepRun
    from utak.simulator.sweep.results import holds_rows

    return holds_rows(head, (*SweepRun._fields, "seconds"))


class _Times:
    """The file of `--times`: the wall-clock seconds of each run that is carried out now, in the order of their ends."""

    def __init__(self, path: str | None, force: bool) -> None:
        from utak.simulator.episode.output_files import GrowingFile

        self._stream = None if path is None else GrowingFile(path, is_times, "file of times", force)

    def __enter__(self) -> "_Times":
        return self

    def __exit__(self, *_: object) -> None:
        if self._stream is not None:
            self._stream.close()

    def write(self, run: "SweepRun", seconds: float) -> None:
        """Write the time of a run."""
        if self._stream is not None:
            line = as_json({**run._asdict(), "seconds": round(seconds, 3)})
            self._stream.write(line.encode("ascii") + b"\n")


def _report(options: argparse.Namespace, plan: "SweepPlan", rows: "list[ResultRow]") -> None:
    """Print the summary of the rows, and draw it."""
    from utak.simulator.episode.output_files import is_svg, write_whole
    from utak.simulator.sweep.results import STDOUT_NAME
    from utak.simulator.sweep.summary import counts_of, table_of, total_of

    counts = counts_of(rows)
    if options.svg:
        from utak.simulator.sweep.picture import sweep_picture

        write_whole(options.svg, sweep_picture(counts).encode("utf-8"), is_svg, "SVG picture", options.force)
    if options.json:
        every = total_of(counts)
        values = {
            "planned": plan.size,
            "groups": [count.as_values for count in counts],
            "all": every.as_values,
            "false_claims": [_named_run(row) for row in every.false_claims],
            "failed": [{**_named_run(row), **row["failed"]} for row in every.failed],
        }
        print(as_json(values))
    elif counts:
        print(table_of(counts), end="", file=sys.stderr if options.output == STDOUT_NAME else sys.stdout)


def _named_run(row: "ResultRow") -> "ResultRow":
    """Return scenario, noise and seed of a row."""
    return {name: row[name] for name in ("scenario", "noise", "seed")}


def _exit_code(rows: "list[ResultRow]") -> int:
    """Return the exit code: 0 when every run has a result, whatever it is."""
    from utak.simulator.sweep.executors.tasks import RAISED

    hows = {row["failed"]["how"] for row in rows if row["failed"] is not None}
    return exits.worst(exits.OUR_BUG if how == RAISED else exits.LIMIT for how in hows)


def _usage(problem: str) -> int:
    """Print what is wrong with the command line and return the exit code."""
    print(f"utak sweep: {problem}", file=sys.stderr)
    return exits.USAGE


def _seeds(text: str) -> tuple[tuple[int, int], ...]:
    """Return the ranges for `--seeds`."""
    from utak.simulator.sweep.plan import parse_seeds

    try:
        return parse_seeds(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def _noises(text: str) -> tuple[float, ...]:
    """Return the numbers for `--noise`, each once."""
    return tuple(dict.fromkeys(parse_decimal(part, 0, 1) for part in text.split(",")))


def _jobs(text: str) -> int:
    """Return the number for `--jobs`."""
    return parse_whole(text, 0, MAX_SWEEP_JOBS)


def _seconds(text: str) -> float:
    """Return the number for `--seconds`."""
    return parse_decimal(text, MIN_SECONDS, MAX_SECONDS)
