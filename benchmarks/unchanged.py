"""Episodes before and after a change that must alter no decision: written by each checkout, then compared.

    python -m benchmarks.unchanged write FOLDER [--count N] [--seed S] [--noises S,S] [--jobs J]    in each checkout
    python -m benchmarks.unchanged compare BEFORE AFTER [--commands]

`write` runs all examples, and random worlds of every kind of benchmarks.worlds.odd and of the plain and the wide kind
of benchmarks.worlds.makers, each with each of the noises. `compare` reads the files as JSON. It leaves out `why`
of the steps and `reason` of the result, which are sentences for people; with --commands `belief`, too, for a change of
the facts alone. It exits with 1 when anything else differs.
"""

import argparse
import json
import multiprocessing
import os
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path

from benchmarks.claims.asked import Asked, all_kinds, worlds_of, written
from utak.simulator.episode.episode import EpisodeLog
from utak.simulator.run.robots import make_robot
from utak.simulator.run.session import Session
from utak.simulator.scenario.scenario import read_scenario
from utak.simulator.scenario.settings import Settings

SCENARIOS_FOLDER = Path(__file__).resolve().parent.parent / "examples"
NOISES = (0.0, 0.02)
COMPARED_KINDS = [kind for kind in all_kinds() if kind not in ("own_snug", "own_loose")]
Job = tuple[str | Asked, float, Path]


def jobs_of(count: int, seed: int, folder: Path, noises: Sequence[float] = NOISES) -> Iterator[Job]:
    """Yield each scenario and noise with the file of its episode. count : random worlds, shared among the kinds."""
    examples: list[str | Asked] = sorted(path.parent.name for path in SCENARIOS_FOLDER.glob("*/goal.lp"))
    shares = sum(9 if kind.startswith("own_") else 1 for kind in COMPARED_KINDS)
    worlds = worlds_of(COMPARED_KINDS, seed, -(-count // shares)) if count else []
    worlds += worlds_of([kind for kind in COMPARED_KINDS if not kind.startswith("own_")], seed + 500, count // 30)
    for asked in [*examples, *worlds]:
        name = asked if isinstance(asked, str) else asked.name.replace(":", "-")
        for noise in noises:
            yield asked, noise, folder / f"{name}-{noise}.jsonl"


def run(job: Job) -> str:
    """Write the episode of one job, unless it is there, and return its name."""
    asked, noise, file = job
    if file.exists():
        return file.name
    with tempfile.TemporaryDirectory() as made:
        folder = SCENARIOS_FOLDER / asked if isinstance(asked, str) else Path(made)
        if isinstance(asked, Asked):
            written(asked, folder)
        unfinished = file.with_suffix(".part")
        unfinished.unlink(missing_ok=True)
        with EpisodeLog(unfinished) as log:
            Session(read_scenario(folder), Settings(seed=1, noise=noise), make_robot, log).run()
        unfinished.rename(file)
    return file.name


def compared_lines(file: Path, facts: bool = True) -> list[str]:
    """Return the lines of an episode without `why` and `reason`, and without `belief` unless `facts` are compared."""
    lines = []
    for text in file.read_text().splitlines():
        line = json.loads(text)
        line.pop("why", None)
        if not facts:
            line.pop("belief", None)
        if "result" in line:
            line["result"].pop("reason", None)
        lines.append(json.dumps(line))
    return lines


def differences(before: Path, after: Path, facts: bool = True) -> Iterator[str]:
    """Yield a sentence for each episode that differs between the two folders."""
    names = {file.name for folder in (before, after) for file in folder.glob("*.jsonl")}
    for name in sorted(names):
        if not (before / name).exists() or not (after / name).exists():
            yield f"{name}: in one folder only"
            continue
        old, new = compared_lines(before / name, facts), compared_lines(after / name, facts)
        if old != new:
            first = next((i for i, (a, b) in enumerate(zip(old, new, strict=False)) if a != b), min(len(old), len(new)))
            yield f"{name}: differs from line {first + 1} on, of {len(old)} and {len(new)}"


def write(given: argparse.Namespace) -> int:
    """Run all jobs in parallel processes."""
    given.folder.mkdir(parents=True, exist_ok=True)
    todo = list(jobs_of(given.count, given.seed, given.folder, given.noises))
    os.environ["PYTHONSAFEPATH"] = "1"  # the pool's processes get this one's path, and no other folder on it
    with multiprocessing.get_context("spawn").Pool(given.jobs) as pool:
        for number, name in enumerate(pool.imap(run, todo), 1):
            print(f"{number} of {len(todo)}: {name}", file=sys.stderr)
    return 0


def compare(given: argparse.Namespace) -> int:
    """Print what differs and how many episodes were compared."""
    found = list(differences(given.before, given.after, not given.commands))
    for sentence in found:
        print(sentence)
    total = len(list(given.before.glob("*.jsonl")))
    print(f"{total} episodes, {len(found)} not the same")
    return 1 if found or not total else 0


def noises_named(text: str) -> tuple[float, ...]:
    """Return the noises that a text names; raise ArgumentTypeError for what is no number from 0 to 1."""
    try:
        noises = tuple(float(part) for part in text.split(","))
    except ValueError:
        noises = ()
    if not noises or not all(0.0 <= noise <= 1.0 for noise in noises):
        raise argparse.ArgumentTypeError(f"{text!r}: numbers from 0 to 1 with commas between them are wanted")
    return tuple(dict.fromkeys(noises))


def main(arguments: Sequence[str] | None = None) -> int:
    """Execute the command line and return the exit code."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.unchanged", description=(__doc__ or "").split("\n")[0])
    parts = parser.add_subparsers(required=True)
    writing = parts.add_parser("write", help="run scenarios and keep their episodes")
    writing.add_argument("folder", type=Path)
    writing.add_argument("--count", type=int, default=300, help="random worlds (default %(default)s)")
    writing.add_argument("--seed", type=int, default=7000, help="the first seed (default %(default)s)")
    default = ",".join(f"{noise:g}" for noise in NOISES)
    writing.add_argument(
        "--noises", type=noises_named, default=NOISES, help=f"noises, from 0 to 1, with commas (default {default})"
    )
    writing.add_argument("--jobs", type=int, default=2, help="processes (default %(default)s)")
    writing.set_defaults(do=write)
    comparing = parts.add_parser("compare", help="compare the episodes of two folders")
    comparing.add_argument("before", type=Path)
    comparing.add_argument("after", type=Path)
    comparing.add_argument(
        "--commands", action="store_true", help="leave out what is believed: commands and truth alone"
    )
    comparing.set_defaults(do=compare)
    given = parser.parse_args(arguments)
    return int(given.do(given))


if __name__ == "__main__":
    sys.exit(main())
