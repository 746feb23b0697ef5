"""All kinds of worlds with tasks about several things by name; the same kind and seed give the same world.

python -m benchmarks.worlds.several.kinds --kinds corners,closet --seed 0 --count 10 -o FOLDER
"""

import argparse
import zlib
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from benchmarks.worlds.scenes import write
from benchmarks.worlds.several import corners, narrow, rooms, sequences
from benchmarks.worlds.several.tasks import SeveralWorld

SeveralWorldMaker = Callable[[np.random.Generator, int], SeveralWorld | None]
SEVERAL_KINDS: dict[str, SeveralWorldMaker] = {
    corners.CORNERS_KIND: corners.corners_world,
    rooms.SWAP_KIND: rooms.swap_world,
    rooms.THREE_KIND: rooms.three_world,
    narrow.CLOSET_KIND: narrow.closet_world,
    narrow.DEAD_END_KIND: narrow.dead_end_world,
    narrow.PLUG_KIND: narrow.plug_world,
    narrow.ROW_KIND: narrow.row_world,
    sequences.SEQUENCE_KIND: sequences.sequence_world,
}
MAX_SEVERAL_TRIES = 5_000


def several_world(kind: str, seed: int) -> SeveralWorld:
    """Return the world of a kind and a seed from 0 on. Raises ValueError when there is no such kind or seed."""
    if kind not in SEVERAL_KINDS or seed < 0:
        raise ValueError(f"no kind {kind} with seed {seed}: kinds are {', '.join(SEVERAL_KINDS)}, seeds from 0")
    rng = np.random.default_rng([zlib.crc32(kind.encode()), seed])
    for _ in range(MAX_SEVERAL_TRIES):
        made = SEVERAL_KINDS[kind](rng, seed)
        if made is not None:
            return made
    raise RuntimeError(f"no world found of kind {kind}, seed {seed}")


def several_kinds(text: str) -> list[str]:
    """Return the kinds that a text names, with commas between. Raises argparse.ArgumentTypeError for an unknown one."""
    named = [part for part in text.split(",") if part]
    unknown = sorted(set(named) - set(SEVERAL_KINDS))
    if unknown:
        raise argparse.ArgumentTypeError(f"no kind {', '.join(unknown)}: kinds are {', '.join(SEVERAL_KINDS)}")
    return named


def main(arguments: Sequence[str] | None = None) -> None:
    """Write scenario folders and print their names."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.worlds.several.kinds", description="Write scenarios about several things."
    )
    parser.add_argument("--kinds", type=several_kinds, default=list(SEVERAL_KINDS), help="with commas between (all)")
    parser.add_argument("--seed", type=int, default=0, help="the first seed (%(default)s)")
    parser.add_argument("--count", type=int, default=1, help="how many of each kind (%(default)s)")
    parser.add_argument("-o", "--output", type=Path, default=Path("several"), help="folder (%(default)s)")
    given = parser.parse_args(arguments)
    for kind in given.kinds:
        for seed in range(given.seed, given.seed + given.count):
            made = several_world(kind, seed)
            print(write(made, given.output / made.name))


if __name__ == "__main__":
    main()
