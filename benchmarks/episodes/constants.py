"""Compare constants of the planner's programs: whole runs with each of them at its half and at its double.

    python -m benchmarks.episodes.constants --task 5,6,7,8,9 --count 4 --seed 0 --noise 0.05 --jobs 2

The first row is the programs as they are. Commands are counted in the worlds that are achieved on both sides.
"""

import argparse
import re
import sys
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from contextlib import closing, contextmanager
from functools import partial
from itertools import product
from pathlib import Path
from typing import Any, NamedTuple
from unittest.mock import patch

import clingo

from benchmarks.harness.trial import Conditions, run_trial
from utak.kb.reasoning import solver
from utak.kb.reasoning.encodings import encoding_constant
from utak.planner.question import PLANNER_ASP
from utak.simulator.sweep.executors.processes import run_in_processes
from utak.simulator.sweep.executors.tasks import WorkerTask

DEFINITION = re.compile(r"^#const (\w+) = (\d+)\.", re.MULTILINE)


class WithConstant(NamedTuple):
    """The outcome of some worlds with a constant replaced."""

    commands: dict[str, int]  # of the worlds that were achieved, by task and seed
    claimed: int  # worlds that were believed done, and were not


def main(arguments: Sequence[str] | None = None) -> int:
    """Print a row for each value of each constant; return 0."""
    given = _parser().parse_args(arguments)
    known = constants()
    names = given.names.split(",") if given.names else list(known)
    replaced = [f"{name}={value}" for name in names for value in neighbours(known[name])]
    worlds = list(product(map(int, given.task.split(",")), range(given.seed, given.seed + given.count)))
    conditions = {"seconds": given.seconds, "noise": given.noise}
    asked = ({"replaced": one, "worlds": worlds, "conditions": conditions} for one in ["", *replaced])
    tasks = [WorkerTask("benchmarks.episodes.constants:tried", argument, None) for argument in asked]
    found: dict[str, WithConstant] = {}
    with closing(run_in_processes(tasks, given.jobs)) as ended:
        for index, outcome in ended:
            if outcome.failure:
                raise RuntimeError(outcome.reason)
            found[["", *replaced][index]] = WithConstant(**outcome.value)
            print(f"{len(found)}/{len(tasks)}", file=sys.stderr)
    print(table(found, known, len(worlds)))
    return 0


def constants() -> dict[str, int]:
    """Return the whole numbers that the planner's programs define, by name."""
    files = sorted(PLANNER_ASP.glob("*/*.lp"))
    named = [(path, name) for path in files for name, _ in DEFINITION.findall(path.read_text(encoding="utf-8"))]
    return {name: encoding_constant(path, name) for path, name in named}


def neighbours(value: int) -> tuple[int, int]:
    """Return the half and the double of a value; for 1, 0 and 2."""
    return value // 2, 2 * value


def tried(argument: dict[str, Any]) -> dict[str, Any]:
    """Run some worlds in a worker process with a constant replaced, as `most_misses=3`, or with none for ""."""
    conditions = Conditions(**argument["conditions"])
    with tempfile.TemporaryDirectory(prefix="utak-constants-") as folder, replacing(argument["replaced"]):
        run = partial(run_trial, conditions=conditions, folder=Path(folder))
        trials = [run(task, seed) for task, seed in argument["worlds"]]
    commands = {f"{one.task}:{one.seed}": one.steps for one in trials if one.achieved}
    return WithConstant(commands, sum(one.false_done for one in trials))._asdict()


@contextmanager
def replacing(constant: str) -> Iterator[None]:
    """Solve all programs with a constant replaced, as `most_misses=3`, or with none for ""."""
    made, options = clingo.Control, ["-c", constant] if constant else []

    def control(arguments: Iterable[str] = (), **others: Any) -> clingo.Control:
        """Return a solver with the constant replaced."""
        return made([*arguments, *options], **others)

    with patch.object(clingo, "Control", control):
        solver._answer.cache_clear()  # it holds what was answered with another constant
        try:
            yield
        finally:
            solver._answer.cache_clear()


def table(found: dict[str, WithConstant], known: dict[str, int], worlds: int) -> str:
    """Return the rows as text."""
    as_is = found[""].commands
    rows = [f"{'':28} of {worlds}  false  commands  as they are"]
    for replaced, one in sorted(found.items(), key=lambda item: item[0] != ""):
        both = as_is.keys() & one.commands.keys()
        name, _, value = replaced.partition("=")
        what = f"{name} {known[name]} -> {value}" if replaced else "as they are"
        ours, theirs = (sum(commands[world] for world in both) for commands in (one.commands, as_is))
        rows.append(f"{what:28} {len(one.commands):>5} {one.claimed:>6} {ours:>9} {theirs:>12}")
    return "\n".join(rows)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.episodes.constants", description="Try other constants.")
    parser.add_argument("--task", default="5,6,7,8,9", help="tasks with commas between (%(default)s)")
    parser.add_argument("--count", type=int, default=4, help="worlds a task (%(default)s)")
    parser.add_argument("--seed", type=int, default=0, help="the first world's seed (%(default)s)")
    parser.add_argument("--noise", type=float, default=0.0, help="as for `utak run` (%(default)s)")
    parser.add_argument("--jobs", type=int, default=1, help="processes (%(default)s)")
    parser.add_argument("--seconds", type=int, default=60, help="most processor seconds of a world (%(default)s)")
    parser.add_argument("--names", default="", help="constants with commas between (all)")
    return parser


if __name__ == "__main__":
    sys.exit(main())
