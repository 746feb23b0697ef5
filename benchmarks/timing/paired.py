"""Processor time of runs in this checkout beside another one, by turns: python -m benchmarks.timing.paired OTHER ...

    python -m benchmarks.timing.paired OTHER [--count N] [--seed S] [--noise S] [--turns T]

OTHER is the folder of another checkout, whatever its layout: it is run by its command line alone. Examples and random
worlds are run in both by turns, each in a process of its own, and the least of some turns counts. Printed are the sums
of processor seconds and their ratio, this checkout's by the other's: above 1 this one is slower. Starting Python is
part of both.
"""

import argparse
import os
import resource
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path

from benchmarks.worlds.makers import scenario
from benchmarks.worlds.scenes import write

ROOT = Path(__file__).resolve().parents[2]
START = "import sys; sys.path.insert(0, sys.argv.pop(1)); from utak.launcher import main; sys.exit(main())"


def scenarios(count: int, seed: int, folder: Path) -> Iterator[Path]:
    """Yield scenario folders: `count` wide worlds of each of the nine tasks, then the examples."""
    for task in range(1, 10):
        for number in range(seed, seed + count):
            made = scenario(task, number)
            yield write(made, folder / made.name)
    yield from sorted(path.parent for path in (ROOT / "examples").glob("*/goal.lp"))


def processor_seconds(checkout: Path, folder: Path, noise: float) -> float:
    """Return the processor seconds of one run in a checkout, with those of the processes that it starts."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    command = [
        sys.executable,
        "-P",
        "-c",
        START,
        str(checkout),
        "run",
        str(folder),
        "--noise",
        str(noise),
        "--seed",
        "1",
    ]
    given = os.environ | {"PYTHONHASHSEED": "0"}  # which -P, unlike -I, heeds
    subprocess.run(command, cwd=folder, env=given, capture_output=True, check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table and the ratio."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.timing.paired", description="Compare two checkouts.")
    parser.add_argument("other", type=Path, help="folder of the other checkout")
    parser.add_argument("--count", type=int, default=2, help="random worlds of each task (default %(default)s)")
    parser.add_argument("--seed", type=int, default=0, help="their first seed (default %(default)s)")
    parser.add_argument("--noise", type=float, default=0.0, help="noise of the motions (default %(default)s)")
    parser.add_argument("--turns", type=int, default=2, help="runs in each checkout (default %(default)s)")
    given = parser.parse_args(arguments)
    sums, ratios = [0.0, 0.0], []
    with tempfile.TemporaryDirectory() as made:
        for folder in scenarios(given.count, given.seed, Path(made)):
            turns = [
                [processor_seconds(place, folder, given.noise) for place in (ROOT, given.other.resolve())]
                for _ in range(given.turns)
            ]
            ours, theirs = (min(column) for column in zip(*turns, strict=True))
            sums[0] += ours
            sums[1] += theirs
            ratios.append(ours / theirs)
            print(f"{folder.name:36} {ours:7.2f} {theirs:7.2f} {ours / theirs:6.3f}", flush=True)
    print(f"{'all':36} {sums[0]:7.2f} {sums[1]:7.2f} {sums[0] / sums[1]:6.3f}; median {statistics.median(ratios):.3f}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
