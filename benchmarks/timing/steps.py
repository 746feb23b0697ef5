"""The processor time of each command of a run, in scenarios and in random worlds.

    python -m benchmarks.timing.steps FOLDER ... [--noise S] [--seed N]         (scenarios)
    python -m benchmarks.timing.steps --kind wide --task 5,6,7 --count 20 [--first N]     (random worlds)

It prints for each run how many commands it took, the greatest processor time of one, and that of 95 in 100; then the
same for all. Each run is made twice where a command took longer than MAX_STEP_SECONDS: kernels that are loaded or
compiled at their first use do not count. The processor time of this process alone is read, so other work on the machine
counts little.
"""

import argparse
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from benchmarks.worlds.makers import scenario
from benchmarks.worlds.scenes import write
from utak import Run, Scenario

MAX_STEP_SECONDS = 2.0  # of processor time that a command should take; the aim


def cycles(folder: Path, noise: float, seed: int, max_steps: int) -> tuple[list[float], str]:
    """Return the seconds of processor time of waking and of each command, and how the run ended."""
    begun = time.process_time()
    run = Run(Scenario.read(folder), seed, noise, max_steps=max_steps)
    found = [time.process_time() - begun]
    while not run.finished:
        begun = time.process_time()
        run.step()
        found.append(time.process_time() - begun)
    return found, f"{run.verdict}: {run.reason}"


def _folders(given: argparse.Namespace, root: Path) -> Iterator[Path]:
    """Yield the scenarios that were named, then those of random worlds."""
    yield from given.folders
    for task in given.task:
        for number in range(given.first, given.first + given.count):
            folder = root / f"{given.kind}-{task}-{number}"
            write(scenario(task, number, given.kind), folder)
            yield folder


def main() -> None:
    """Run all worlds and print the times."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.timing.steps", description="Time each command.")
    parser.add_argument("folders", type=Path, nargs="*", help="scenarios")
    parser.add_argument("--kind", default="wide", help="of random worlds (%(default)s)")
    parser.add_argument("--task", type=lambda text: [int(part) for part in text.split(",")], default=[5])
    parser.add_argument("--first", type=int, default=0, help="the first world's seed (%(default)s)")
    parser.add_argument("--count", type=int, default=0, help="random worlds a task (%(default)s)")
    parser.add_argument("--noise", type=float, default=0.0)
    parser.add_argument("--seed", type=int, default=1, help="of the noise (%(default)s)")
    parser.add_argument("--max-steps", type=int, default=200)
    given = parser.parse_args()
    everything: list[float] = []
    with tempfile.TemporaryDirectory(prefix="utak-steps-") as root:
        for folder in _folders(given, Path(root)):
            found, end = cycles(folder, given.noise, given.seed, given.max_steps)
            if max(found) > MAX_STEP_SECONDS:
                again, _ = cycles(folder, given.noise, given.seed, given.max_steps)
                found = [min(pair) for pair in zip(found, again, strict=True)]
            everything += found
            print(f"{folder.name}: {_told(found)}; {end}", flush=True)
    print(f"all: {_told(everything)}" if everything else "nothing to run", file=sys.stdout)


def _told(seconds: list[float]) -> str:
    """Return the figures of some times in words."""
    over = sum(one > MAX_STEP_SECONDS for one in seconds)
    most, usual = max(seconds), np.percentile(seconds, 95)
    return f"{len(seconds)} cycles, most {most:.2f} s, 95 % {usual:.2f} s, {over} over {MAX_STEP_SECONDS:g} s"


if __name__ == "__main__":
    main()
