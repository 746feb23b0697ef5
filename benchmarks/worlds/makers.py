"""Random worlds for the nine tasks, the same for the same task and seed.

    python -m benchmarks.worlds --task 3 --seed 0 --count 10 -o FOLDER

Every twelfth seed (11, 23, ...) gives a world in which the task cannot be done; its expect.lp holds `fails`.
"""

import argparse
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from benchmarks.worlds.carrying import CARRYING, CARRYING_SNUG
from benchmarks.worlds.loose import LOOSE_MAKERS
from benchmarks.worlds.plain import PLAIN
from benchmarks.worlds.scenes import RandomScenario, write
from benchmarks.worlds.walking import WALKING

WORLD_MAKERS = {"wide": WALKING | CARRYING, "snug": WALKING | CARRYING_SNUG, "plain": PLAIN, "loose": LOOSE_MAKERS}
STREAMS = {"wide": (), "plain": (1,), "snug": (2,), "loose": (3,)}
UNABLE_EVERY = 12  # seeds
MAX_WORLD_TRIES = 20_000


def scenario(task: int, seed: int, kind: str = "wide") -> RandomScenario:
    """Return a random world with a task.

    Parameters
    ----------
    task : 1 to 9, as in the paper: (i) to (ix).
    seed : any integer from 0; when it is 11 modulo 12 the task cannot be done.
    kind : "wide"; "snug", in which the rooms of what is carried are no larger than people mostly draw them (two or
        three, of 18 to 24 squares); "loose", the same with objects off the grid, rotated, and Ls of two widths (tasks 5
        to 9); or "plain", a world of benchmarks.worlds.plain, in which every task can be done.

    Raises
    ------
    ValueError
        When there is no such task, seed or kind.
    """
    if kind not in WORLD_MAKERS:
        raise ValueError(f"no worlds are {kind}: they are {', '.join(WORLD_MAKERS)}")
    if task not in WORLD_MAKERS[kind] or seed < 0:
        raise ValueError(f"no task {task} with seed {seed}: tasks are 1 to 9, seeds from 0")
    rng = np.random.default_rng([task, seed, *STREAMS[kind]])
    unable = seed % UNABLE_EVERY == UNABLE_EVERY - 1
    for _ in range(MAX_WORLD_TRIES):
        made = WORLD_MAKERS[kind][task](rng, seed, unable)
        if made is not None:
            return made
    raise RuntimeError(f"no world found for task {task}, seed {seed}")


def seeds(first: int, count: int, unable: bool = False) -> list[int]:
    """Return `count` seeds from the first on. unable : whether only those of impossible tasks."""
    if not unable:
        return list(range(first, first + count))
    begin = first + (UNABLE_EVERY - 1 - first) % UNABLE_EVERY
    return list(range(begin, begin + UNABLE_EVERY * count, UNABLE_EVERY))


def add_kinds(parser: argparse.ArgumentParser) -> None:
    """Add the options that say of which kind worlds are."""
    kinds = parser.add_mutually_exclusive_group()
    said = {"plain": "one or two rooms, everything on whole squares", "snug": "smaller rooms to carry in"}
    said["loose"] = "the same, with things between the squares"
    for kind, what in said.items():
        kinds.add_argument(f"--{kind}", dest="kind", action="store_const", const=kind, default="wide", help=what)


def main(arguments: Sequence[str] | None = None) -> None:
    """Write scenario folders and print their names."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.worlds", description="Write random scenario folders.")
    parser.add_argument("--task", default="1,2,3,4", help="tasks, with commas between (default %(default)s)")
    parser.add_argument("--seed", type=int, default=0, help="the first seed (default %(default)s)")
    parser.add_argument("--count", type=int, default=1, help="how many of each task (default %(default)s)")
    add_kinds(parser)
    parser.add_argument("-o", "--output", type=Path, default=Path("worlds"), help="folder (default %(default)s)")
    given = parser.parse_args(arguments)
    for task in [int(part) for part in given.task.split(",")]:
        for seed in range(given.seed, given.seed + given.count):
            made = scenario(task, seed, given.kind)
            print(write(made, given.output / made.name))


if __name__ == "__main__":
    main()
