"""The campaign: the robot in many random worlds, judged and measured.

    python -m benchmarks.campaign --task 1,2,3,4 --count 50 --seed 0 --jobs 2 [--noise S] [-o results.jsonl]
    python -m benchmarks.campaign --only 3:17 --keep FOLDER      (one world, drawn at each step)
    python -m benchmarks.campaign --again results.jsonl          (the worlds that went wrong)
    python -m benchmarks.campaign --unable --task 5,6,7,8,9 --count 4    (only such as cannot be done)

The table goes to stdout, progress to stderr. docs/results/worlds.md explains the columns.
"""

import argparse
import json
import sys
import tempfile
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import ExitStack, closing
from itertools import product
from pathlib import Path

from shapely import Polygon

from benchmarks.harness.beliefs import beliefs
from benchmarks.harness.drawing import drawing
from benchmarks.harness.judging import judge_path
from benchmarks.harness.tally import faults, narrowness, table, verdicts
from benchmarks.harness.trial import CampaignTrial, Conditions, run_trial, trial_of_outcome, trial_task
from benchmarks.worlds.makers import add_kinds, scenario, seeds
from utak.simulator.run.session import Session
from utak.simulator.sweep.executors.processes import run_in_processes
from utak.simulator.sweep.results import Results

TrialRunner = Callable[..., CampaignTrial]


def main(arguments: Sequence[str] | None = None, runner: TrialRunner = run_trial) -> int:
    """Run a campaign; return 0 when every world came out right, else 1.

    runner : runs the robot in a world, as `run_trial` does.
    """
    given = _parser().parse_args(arguments)
    if judge_path() is None:
        print("campaign: NO JUDGE: set UTAK_JUDGE to judge.py; the episodes are not judged", file=sys.stderr)
    conditions = Conditions(
        noise=given.noise,
        seed=given.noise_seed,
        paths=given.paths,
        max_steps=given.max_steps,
        seconds=given.seconds,
        knowing=given.knowing,
        kind=given.kind,
    )
    with ExitStack() as stack:
        folder = given.keep or Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="utak-campaign-")))
        _warm_up(folder, runner)
        if given.only:
            task, seed = (int(part) for part in given.only.split(":"))
            trials = [_watched(task, seed, conditions, folder, runner)]
        else:
            numbers = seeds(given.seed, given.count, given.unable)
            worlds = _unclean(given.again) if given.again else list(product(given.task, numbers))
            results = stack.enter_context(closing(Results(given.output, ("task", "seed"), force=True)))
            trials = list(_reported(_run_all(worlds, conditions, folder, given.jobs, runner), results, len(worlds)))
            trials.sort(key=lambda trial: worlds.index((trial.task, trial.seed)))
    print(table(trials), verdicts(trials), narrowness(trials), faults(trials), sep="\n", end="")
    return 0 if all(trial.clean for trial in trials) else 1


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.campaign", description="Measure the robot.")
    parser.add_argument("--task", type=_numbers, default=[1, 2, 3, 4], help="tasks with commas between (1,2,3,4)")
    parser.add_argument("--count", type=int, default=50, help="worlds a task (%(default)s)")
    parser.add_argument("--seed", type=int, default=0, help="the first world's seed (%(default)s)")
    parser.add_argument("--jobs", type=int, default=1, help="processes (%(default)s)")
    parser.add_argument("--noise", type=float, default=0.0, help="noise of motions and grasps (%(default)s)")
    parser.add_argument("--noise-seed", type=int, default=0, help="seed of the noise (%(default)s)")
    parser.add_argument("--paths", default="skeleton", help="path-finder: skeleton, visibility or grid")
    parser.add_argument("--max-steps", type=int, default=200, help="most commands (%(default)s)")
    parser.add_argument("--seconds", type=int, default=120, help="most processor seconds, 0 for any (%(default)s)")
    parser.add_argument("-o", "--output", type=Path, help="a JSON line for each world")
    parser.add_argument("--only", metavar="TASK:SEED", help="one world, drawn at each step on stderr")
    add_kinds(parser)
    parser.add_argument("--knowing", action="store_true", help="also run the same planner knowing everything")
    parser.add_argument("--unable", action="store_true", help="only worlds in which the task cannot be done")
    parser.add_argument("--again", type=Path, metavar="RESULTS", help="the worlds that went wrong in earlier results")
    parser.add_argument("--keep", type=Path, help="folder in which scenarios and episodes stay")
    return parser


def _numbers(text: str) -> list[int]:
    return [int(part) for part in text.split(",")]


def _unclean(results: Path) -> list[tuple[int, int]]:
    """Return the worlds of earlier results in which something went wrong."""
    rows = [json.loads(line) for line in results.read_text().splitlines()]
    return [(row["task"], row["seed"]) for row in rows if not row["clean"]]


def _warm_up(folder: Path, runner: TrialRunner) -> None:
    """Run one trial that does not count, so that kernels are compiled and cached before any clock runs."""
    runner(4, 0, Conditions(max_steps=30, seconds=0), folder / "warming-up")


def _run_all(
    worlds: list[tuple[int, int]], conditions: Conditions, folder: Path, jobs: int, runner: TrialRunner
) -> Iterator[CampaignTrial]:
    """Yield the trials as they end: in order in this process, or in any order from several worker processes."""
    if jobs <= 1:
        yield from (runner(*world, conditions, folder) for world in worlds)
        return
    tasks = [trial_task(*world, conditions, folder) for world in worlds]
    with closing(run_in_processes(tasks, jobs)) as ended:
        for index, outcome in ended:
            yield trial_of_outcome(*worlds[index], conditions, outcome)


def _reported(trials: Iterable[CampaignTrial], results: Results, count: int) -> Iterator[CampaignTrial]:
    """Yield the trials as they come; report each on stderr and add it to the results."""
    for number, trial in enumerate(trials, 1):
        results.append(trial.row())
        mark = "" if trial.clean else "  <--"
        said = trial.crash or trial.verdict
        print(f"{number}/{count} {trial.task}:{trial.seed} {trial.steps} commands, {said}{mark}", file=sys.stderr)
        yield trial


def _watched(task: int, seed: int, conditions: Conditions, folder: Path, runner: TrialRunner) -> CampaignTrial:
    """Run one world and draw it on stderr at each step."""
    world = scenario(task, seed, conditions.kind)
    print(f"{world.name}, heading {world.heading}: {world.texts.goal}{world.texts.expect}", file=sys.stderr)

    def draw(at: Session) -> None:
        moved = {name: Polygon(shape) for name, shape in at.table.polygons.items()}
        picture = drawing(world, at.table.utak, moved, {"+": world.target})
        line = at.line
        origin, mind = (world.utak.x, world.utak.y), getattr(at.robot, "robot", None)
        drift = beliefs(mind, origin, at.table.utak, world.heading).drift
        print(
            f"step {line['step']}: {line['action']} why: {line['why']}; slipped by {drift}\n{picture}", file=sys.stderr
        )

    trial = runner(task, seed, conditions, folder, draw)
    crash = folder / world.name / "crash.txt"
    if trial.crash and crash.exists():
        print(crash.read_text(), file=sys.stderr)
    return trial


if __name__ == "__main__":
    sys.exit(main())
