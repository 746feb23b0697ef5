"""The time of a single command: scenarios under noise, each command timed by the processor's clock.

    python -m benchmarks.bounded [SCENARIO ...] [--noise 0,0.02,0.05] [--seeds 1,2,3,4,5] [--judge] [-o rows.jsonl]
    python -m benchmarks.bounded --campaign 5,6,7 --count 10 --noise 0,0.02
        (random worlds, see benchmarks.worlds.makers)

Scenarios are folders; all of examples/ when none is named. Each run is made in a process of its own that ends when its
processor time is used up, so that a slow run does not hold up the others; what it did until then is reported.
"""

import argparse
import json
import multiprocessing
import resource
import sys
import tempfile
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import product
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from benchmarks.harness.judging import findings
from benchmarks.harness.stopwatch import TimedBody, TimedRobot
from benchmarks.worlds.makers import scenario
from benchmarks.worlds.scenes import write
from utak.kb.body import Body
from utak.kb.task.task import Task
from utak.simulator.episode.episode import EpisodeLog
from utak.simulator.run.robots import make_robot
from utak.simulator.run.session import Session
from utak.simulator.run.trial import scenarios_in
from utak.simulator.run.warming import warm_all
from utak.simulator.scenario.expectation import should_fail
from utak.simulator.scenario.scenario import read_scenario
from utak.simulator.scenario.settings import Settings

EXAMPLES_FOLDER = Path(__file__).resolve().parent.parent / "examples"
WARMING_WORLDS = (
    "go_round_square",
    "push_l_tight_door",
    "push_square_corner",
    "push_brick_regrasp",
)  # these call every kernel
BOUND = 2.0  # processor seconds that no command may take
LISTED_COMMANDS = 10  # of the longest commands are listed


class TimedRun(NamedTuple):
    """A run to be made: a scenario's folder, the noise, its seed, the limit of commands, and whether it is judged."""

    folder: Path
    noise: float
    seed: int
    max_steps: int
    judged: bool


RunMaker = Callable[[TimedRun, Callable[[Any], None]], None]
"""Makes a run; calls its second argument with what came of each command, and with the result."""


class BoundedRow(NamedTuple):
    """The result of a run.

    Attributes
    ----------
    seconds : processor seconds of waking and of each command.
    actions : the commands, None for waking.
    verdict : the robot's verdict, or `ended` when its process ended before it gave one.
    false : whether the truth refutes what the robot claims.
    """

    name: str
    noise: float
    seed: int
    verdict: str
    achieved: bool | None
    false: bool
    seconds: list[float]
    actions: list[Any]
    reason: str = ""
    judged: list[str] | None = None


def main(arguments: Sequence[str] | None = None) -> int:
    """Run everything that is asked for and print the results.

    Returns 0 when no command took too long and no claim was false, else 1.
    """
    given = _parser().parse_args(arguments)
    with tempfile.TemporaryDirectory(prefix="utak-bounded-") as scratch:
        folders = list(_worlds(given, Path(scratch))) if given.campaign else _folders(given.scenarios)
        runs = [TimedRun(*which, given.max_steps, given.judge) for which in product(folders, given.noise, given.seeds)]
        runs = list(dict.fromkeys(run if run.noise else run._replace(seed=given.seeds[0]) for run in runs))
        warm()
        rows = list(_told((bounded(run, given.seconds) for run in runs), given.output))
    print("\n".join(report(rows)))
    return int(any(row.false or max(row.seconds, default=0.0) > BOUND for row in rows))


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.bounded", description="Time each command.")
    parser.add_argument("scenarios", nargs="*", type=Path, help="folders (all of examples/)")
    parser.add_argument("--noise", type=_floats, default=[0.0, 0.02, 0.05], help="with commas between (0,0.02,0.05)")
    parser.add_argument("--seeds", type=_integers, default=[1, 2, 3, 4, 5], help="with commas between (1,2,3,4,5)")
    parser.add_argument("--campaign", type=_integers, help="random worlds of these tasks instead of scenarios")
    parser.add_argument("--count", type=int, default=10, help="worlds a task (%(default)s)")
    parser.add_argument("--first", type=int, default=0, help="the first world's seed (%(default)s)")
    parser.add_argument("--kind", default="wide", help="of the worlds (%(default)s)")
    parser.add_argument("--seconds", type=int, default=120, help="most processor seconds a run (%(default)s)")
    parser.add_argument("--max-steps", type=int, default=200, help="most commands a run (%(default)s)")
    parser.add_argument("--judge", action="store_true", help="have episodes without noise judged, if a judge is there")
    parser.add_argument("-o", "--output", type=Path, help="a JSON line for each run")
    return parser


def _floats(text: str) -> list[float]:
    return [float(part) for part in text.split(",")]


def _integers(text: str) -> list[int]:
    return [int(part) for part in text.split(",")]


def _folders(named: Sequence[Path]) -> list[Path]:
    return [folder for place in named or [EXAMPLES_FOLDER] for folder in scenarios_in(place)]


def _worlds(given: argparse.Namespace, scratch: Path) -> Iterator[Path]:
    for task, seed in product(given.campaign, range(given.first, given.first + given.count)):
        world = scenario(task, seed, given.kind)
        yield write(world, scratch / world.name)


def run_here(run: TimedRun, tell: Callable[[Any], None]) -> None:
    """Make a run in this process. tell : called with (seconds, action) after each command, and with the result."""
    robots: list[TimedRobot] = []

    def make(body: Body, task: Task, settings: Settings) -> TimedRobot:
        timed = TimedBody(body)
        robots.append(TimedRobot(make_robot(timed, task, settings), timed))
        return robots[0]

    with tempfile.TemporaryDirectory(prefix="utak-run-") as place:
        episode = Path(place) / "episode.jsonl"
        settings = Settings(run.seed, run.noise, "skeleton", run.max_steps)
        with EpisodeLog(episode) as log:
            session = Session(read_scenario(run.folder), settings, make, log)
            result = session.run(lambda at: tell((robots[0].cycles[-1].processor, at.line.get("action"))))
        wanted = should_fail(session.scenario.expectations or ())
        false = (result.believed and result.achieved is False) or (result.verdict == "impossible" and not wanted)
        judged = findings(run.folder, episode) if run.judged and not run.noise else None
    tell(
        {
            "verdict": result.verdict,
            "achieved": result.achieved,
            "false": false,
            "reason": result.reason,
            "judged": judged,
        }
    )


def warm() -> None:
    """Compile or load the kernels; the processes of the runs are forked from this one and find them."""
    warm_all()
    for name, noise in product(WARMING_WORLDS, (0.0, 0.02)):
        run_here(TimedRun(EXAMPLES_FOLDER / name, noise, 1, 20, False), lambda _: None)


def bounded(run: TimedRun, seconds: int, make_run: RunMaker = run_here) -> BoundedRow:
    """Make a run in a process of its own, which ends after `seconds` processor seconds.

    make_run : makes it there, as `run_here` does.
    """
    context = multiprocessing.get_context("fork")
    ours, theirs = context.Pipe(duplex=False)
    process = context.Process(target=_child, args=(run, seconds, theirs, make_run))
    process.start()
    theirs.close()
    told = list(_received(ours))
    process.join()
    last = told.pop() if told and isinstance(told[-1], dict) else {"verdict": "ended"}
    if last["verdict"] == "ended":  # what is left went into the command that was not done
        told.append((seconds - sum(second for second, _ in told), "not done"))
    return BoundedRow(
        run.folder.name,
        run.noise,
        run.seed,
        last["verdict"],
        last.get("achieved"),
        bool(last.get("false")),
        [second for second, _ in told],
        [action for _, action in told],
        last.get("reason", ""),
        last.get("judged"),
    )


def _received(pipe: Connection) -> Iterator[Any]:
    while True:
        try:
            yield pipe.recv()
        except EOFError:
            return


def _child(run: TimedRun, seconds: int, pipe: Connection, make_run: RunMaker) -> None:
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))
    try:
        make_run(run, pipe.send)
    except Exception as error:  # a crash is a result, too
        pipe.send({"verdict": "crash", "reason": f"{type(error).__name__}: {error}"})


def _told(rows: Iterable[BoundedRow], output: Path | None) -> Iterator[BoundedRow]:
    """Yield the rows as they come; report each on stderr and write it to the output."""
    if output is not None:
        output.write_text("")
    for row in rows:
        print(_line(row), file=sys.stderr, flush=True)
        if output is not None:
            with output.open("a") as file:
                file.write(json.dumps(row._asdict()) + "\n")
        yield row


def _line(row: BoundedRow) -> str:
    worst, high = max(row.seconds, default=0.0), percentile(row.seconds)
    marks = " FALSE" * row.false + " LONG" * (worst > BOUND) + " JUDGE" * bool(row.judged)
    told = f"{row.name:28} {row.noise:<5} {row.seed:3} {row.verdict:12} {row.achieved!s:6}"
    return f"{told} {len(row.seconds) - 1:4} commands, longest {worst:6.2f} s, 95% {high:5.2f} s{marks}"


def percentile(seconds: Sequence[float]) -> float:
    """Return the 95th percentile of some seconds, 0 of none."""
    return float(np.percentile(seconds, 95)) if seconds else 0.0


def report(rows: Sequence[BoundedRow]) -> Iterator[str]:
    """Return the lines of the report: a table by scenario and noise, worst first, the longest commands, and totals."""
    yield f"{'scenario':28} noise  longest   95%    all s  verdicts"
    groups: dict[tuple[str, float], list[BoundedRow]] = {}
    for row in rows:
        groups.setdefault((row.name, row.noise), []).append(row)
    for (name, noise), group in sorted(groups.items(), key=lambda item: -_worst(item[1])):
        seconds = [second for row in group for second in row.seconds]
        verdicts = " ".join(f"{row.verdict}{'!' * row.false}{'(not)' * (row.achieved is False)}" for row in group)
        yield f"{name:28} {noise:<5} {_worst(group):8.2f} {percentile(seconds):6.2f} {sum(seconds):7.1f}  {verdicts}"
    commands = [(s, row, number) for row in rows for number, s in enumerate(row.seconds)]
    yield "the longest commands:"
    for second, row, number in sorted(commands, key=lambda one: -one[0])[:LISTED_COMMANDS]:
        run = f"{row.name} --noise {row.noise} --seed {row.seed}"
        yield f"  {second:6.2f} s  {run}, step {number}: {row.actions[number]}"
    for row in rows:
        if row.false or row.judged or row.verdict == "crash":
            yield f"{row.name} --noise {row.noise} --seed {row.seed}: {row.verdict}: {row.reason} {row.judged or ''}"
    yield from _totals(rows)


def _totals(rows: Sequence[BoundedRow]) -> Iterator[str]:
    for noise in sorted({row.noise for row in rows}):
        group = [row for row in rows if row.noise == noise]
        seconds = [second for row in group for second in row.seconds]
        long = sum(second > BOUND for second in seconds)
        yield (
            f"noise {noise}: {len(group)} runs, {sum(row.verdict == 'done' for row in group)} done, "
            f"{sum(row.false for row in group)} false claims, {len(seconds)} commands, {long} over {BOUND} s, "
            f"longest {max(seconds, default=0.0):.2f} s, 95% {percentile(seconds):.2f} s, "
            f"{sum(row.verdict == 'ended' for row in group)} ended"
        )


def _worst(group: Iterable[BoundedRow]) -> float:
    return max((second for row in group for second in row.seconds), default=0.0)


if __name__ == "__main__":
    sys.exit(main())
