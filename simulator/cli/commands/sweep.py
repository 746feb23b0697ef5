"""`utak sweep`: run scenarios with many seeds and noises, in parallel, and sum up what came out."""

import argparse
import os
import sys
from collections import Counter
from contextlib import closing
from functools import partial
from pathlib import Path

from utak.kb.language.source_text import read_source
from utak.planner.stages import stages
from utak.simulator.certificates.keeping import make_folder
from utak.simulator.cli.commands.given import given_settings
from utak.simulator.episode.output_files import check_path, is_svg, write_whole
from utak.simulator.run.interrupts import end_at_request
from utak.simulator.run.trial import scenarios_in
from utak.simulator.run.warming import warm
from utak.simulator.scenario.scenario import read_scenario
from utak.simulator.scenario.settings import Settings, kb_files_named
from utak.simulator.scenario.untrusted import refuse_links
from utak.simulator.sweep.carrying_out import ROW_KEY, carry_out_sweep, known_rows, missing_runs, problem_of
from utak.simulator.sweep.contents import names_of, read_contents
from utak.simulator.sweep.executors.processes import run_in_processes
from utak.simulator.sweep.executors.tasks import RAISED, Executor, WorkerTask
from utak.simulator.sweep.picture import sweep_picture
from utak.simulator.sweep.plan import MAX_RUNS, PREPARATION_FUNCTION, SweepPlan
from utak.simulator.sweep.results import STDOUT_NAME, ResultRow, Results
from utak.simulator.sweep.summary import counts_of, table_of, total_of
from utak.simulator.terminal import exits
from utak.simulator.terminal.outcome import UsageError
from utak.simulator.terminal.printing import as_json
from utak.simulator.terminal.progress import Progress


def execute(options: argparse.Namespace) -> int:
    """Carry out the sweep, print the summary and return the exit code."""
    if options.json and options.output == STDOUT_NAME:
        raise UsageError("--json and -o - both want the standard output")
    plan, carrying = _plan(options)
    if plan.size > MAX_RUNS:
        raise UsageError(f"{plan.size} runs are more than {MAX_RUNS}")
    if options.svg:  # before anything is run
        check_path(options.svg, is_svg, "SVG picture", options.force)
    if options.certificate is not None:
        make_folder(options.certificate)
    results = Results(options.output, ROW_KEY, options.force, problem_of)
    code = exits.SUCCESS
    with end_at_request(), closing(results):
        left = missing_runs(plan, results).values()
        progress = Progress(Counter((run.scenario, run.noise) for run in left), "runs")
        if len(left) < len(plan.runs) and sys.stderr.isatty():
            print(f"{len(plan.runs) - len(left)} runs are known already", file=sys.stderr)
        try:
            if left:
                executor = _executor(options, plan.settings.paths, carrying)
                carry_out_sweep(
                    plan, results, executor, lambda run, seconds: progress.note((run.scenario, run.noise), seconds)
                )
        except KeyboardInterrupt:
            code = exits.INTERRUPTED
    rows = known_rows(plan, results)
    _report(options, plan, rows)
    if code == exits.INTERRUPTED:
        again = "" if options.output in (None, STDOUT_NAME) else "; the same command goes on from there"
        print(f"utak: interrupted: {len(rows)} of {len(plan.runs)} runs are done{again}", file=sys.stderr)
        return code
    hows = {row["failed"]["how"] for row in rows if row["failed"] is not None}
    return exits.worst(exits.OUR_BUG if how == RAISED else exits.LIMIT for how in hows)


def _plan(options: argparse.Namespace) -> tuple[SweepPlan, bool]:
    """Return the plan of the command line, and whether a task moves objects; read and check all files."""
    folders, carrying = {}, False
    for named in options.scenarios:
        for folder in scenarios_in(named):
            refuse_links(options, folder, named)
            scenario = read_scenario(folder)  # reports errors before anything is run
            carrying |= any(stage.carried for stage in stages(scenario.task))
            folders[folder.resolve()] = folder
    contents = [read_contents(*found) for found in zip(folders.values(), names_of(list(folders)), strict=True)]
    settings = Settings(**{key: value for key, value in given_settings(options).items() if key != "noise"})
    rules = [(Path(path).name, read_source(path).text) for path in kb_files_named(options.kb)]
    plan = SweepPlan(
        tuple(contents),
        options.seeds,
        options.noise,
        settings,
        tuple(rules),
        options.seconds,
        options.certificate,
        options.risk,
        options.shard,
    )
    return plan, carrying


def _executor(options: argparse.Namespace, paths: str, carrying: bool) -> Executor:
    """Return what carries out the runs. Kernels are compiled here first, where worker processes run here."""
    preparation = WorkerTask(PREPARATION_FUNCTION, {"carrying": carrying, "paths": paths})
    if options.dask is not None:
        from utak.simulator.sweep.executors.cluster import run_on_dask

        return partial(run_on_dask, address=options.dask, preparation=preparation)
    warm(carrying, paths)
    return partial(run_in_processes, jobs=options.jobs or usable_processors(), preparation=preparation)


def usable_processors() -> int:
    """Return the number of processors that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _report(options: argparse.Namespace, plan: SweepPlan, rows: list[ResultRow]) -> None:
    counts = counts_of(rows)
    if options.svg:
        write_whole(options.svg, sweep_picture(counts).encode("utf-8"), is_svg, "SVG picture", options.force)
    if options.json:
        every = total_of(counts)
        values = {
            "planned": len(plan.runs),
            "groups": [count.as_values for count in counts],
            "all": every.as_values,
            "false_claims": [_named_run(row) for row in every.false_claims],
            "failed": [{**_named_run(row), **row["failed"]} for row in every.failed],
        }
        print(as_json(values))
    elif counts:
        print(table_of(counts), end="", file=sys.stderr if options.output == STDOUT_NAME else sys.stdout)


def _named_run(row: ResultRow) -> ResultRow:
    return {name: row[name] for name in ("scenario", "noise", "seed")}
