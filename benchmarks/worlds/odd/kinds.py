"""All kinds of odd worlds by name; the same kind and seed give the same world.

python -m benchmarks.worlds.odd.kinds --kind plugged,round --seed 0 --count 10 -o FOLDER
"""

import argparse
import zlib
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np

from benchmarks.worlds.odd import circular, constraints, fixtures, offgrid, openings, plugged, slanted, touching
from benchmarks.worlds.odd.tasks import OddWorld
from benchmarks.worlds.scenes import write

OddWorldMaker = Callable[[np.random.Generator, int], OddWorld | None]
ODD_KINDS: dict[str, OddWorldMaker] = {
    offgrid.OFFGRID_KIND: offgrid.world,
    slanted.SLANTED_KIND: slanted.world,
    circular.ROUND_KIND: circular.world,
    plugged.PLUGGED_KIND: plugged.world,
    touching.TOUCHING_KIND: touching.world,
    openings.WIDE_OPENING_KIND: openings.world,
    fixtures.FIXED_KIND: fixtures.world,
    constraints.CONSTRAINT_KIND: constraints.world,
}
MAX_ODD_TRIES = 2_000


def odd_world(kind: str, seed: int, kinds: Mapping[str, OddWorldMaker] = ODD_KINDS) -> OddWorld:
    """Return the world of a kind and a seed from 0 on. Raises ValueError when there is no such kind or seed."""
    if kind not in kinds or seed < 0:
        raise ValueError(f"no kind {kind} with seed {seed}: kinds are {', '.join(kinds)}, seeds from 0")
    rng = np.random.default_rng([zlib.crc32(kind.encode()), seed])
    for _ in range(MAX_ODD_TRIES):
        made = kinds[kind](rng, seed)
        if made is not None:
            return made
    raise RuntimeError(f"no world found of kind {kind}, seed {seed}")


def main(arguments: Sequence[str] | None = None) -> None:
    """Write scenario folders and print their names."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.worlds.odd.kinds", description="Write odd scenario folders."
    )
    parser.add_argument("--kind", default=",".join(ODD_KINDS), help="kinds with commas between (all)")
    parser.add_argument("--seed", type=int, default=0, help="the first seed (%(default)s)")
    parser.add_argument("--count", type=int, default=1, help="how many of each kind (%(default)s)")
    parser.add_argument("-o", "--output", type=Path, default=Path("odd"), help="folder (%(default)s)")
    given = parser.parse_args(arguments)
    for kind in given.kind.split(","):
        for seed in range(given.seed, given.seed + given.count):
            made = odd_world(kind, seed)
            print(write(made, given.output / made.name))


if __name__ == "__main__":
    main()
