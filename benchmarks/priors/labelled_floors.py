"""Rooms of labelled floors: how many are cut as their labels say, by kb/asp/rooms.lp on a map that is known.

    python -m benchmarks.priors.labelled_floors FOLDER [--kb FILE] [--greatest SQUARES]

FOLDER holds .npz files with `wall` (rows, columns) bool and `room` (rows, columns), the label of each square, else 0.
A room is an edge-connected part of one label. It is cut right when intersection over union with a part is 0.8 or more.
"""

import argparse
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from utak.geometry import Passage, Screen
from utak.geometry.kernels.arrays import Bools, Labels
from utak.geometry.raster.components import components
from utak.kb.reasoning.encodings import KB_ENCODINGS
from utak.kb.reasoning.solver import solve
from utak.kb.world.doors import necks_of
from utak.kb.world.model import hundredths

LEAST_OVERLAP = 0.8  # intersection over union from which a room counts as cut right (a convention)
LEAST_ROOM = 200  # squares: smaller labelled parts are no rooms (a convention)


def doors(screen: Screen, rules: Sequence[Path]) -> list[Passage]:
    """Return the necks of a known floor that kb/asp/rooms.lp, with rules of users, takes for doors."""
    necks = necks_of(screen)
    facts = []
    for number, neck in enumerate(necks):
        width, one, other = (hundredths(size) for size in (neck.width, *(2 * side for side in neck.sides)))
        facts.append(f"neck({number},{width},{one},{other},100)")
    answer = solve([KB_ENCODINGS / "rooms.lp", *rules], facts) or ()
    return [necks[number] for number in sorted({a.arguments[0].number for a in answer if a.match("door", 2)})]


def labelled_rooms(floor: Bools, room: Labels) -> Iterator[Bools]:
    """Yield the rooms of a labelled floor."""
    for label in np.unique(room[room > 0]):
        found = components((room == label) & floor)
        sizes = np.bincount(found.labels[found.labels > 0], minlength=found.number + 1)
        yield from (found.labels == number for number in range(1, found.number + 1) if sizes[number] >= LEAST_ROOM)


def is_cut_right(room: Bools, parts: Labels) -> bool:
    """Return whether a part of the floor is the same as a labelled room."""
    inside, sizes = np.bincount(parts[room], minlength=1), np.bincount(parts.ravel())
    numbers = np.flatnonzero(inside[1:]) + 1
    overlap = inside[numbers] / (room.sum() + sizes[numbers] - inside[numbers])
    return bool((overlap >= LEAST_OVERLAP).any())


def main(argv: Sequence[str] | None = None) -> int:
    """Print for each floor how many of its rooms are cut right, and the sum; return 0."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.priors.labelled_floors", description="Rooms of real floors."
    )
    parser.add_argument("folder", type=Path, help="the floors, .npz files")
    parser.add_argument("--kb", type=Path, action="append", default=[], help="rules of users")
    parser.add_argument("--greatest", type=int, default=700_000, help="squares of the greatest floor (%(default)s)")
    given = parser.parse_args(argv)
    right = number = 0
    for path in sorted(given.folder.glob("*.npz")):
        stored = np.load(path)
        if stored["wall"].size > given.greatest:
            continue
        screen = Screen(~stored["wall"])
        parts = screen.parts(doors(screen, given.kb))
        cut = [is_cut_right(room, parts) for room in labelled_rooms(screen.free, stored["room"])]
        print(f"{path.stem}: {sum(cut)} of {len(cut)}", flush=True)
        right, number = right + sum(cut), number + len(cut)
    print(f"all: {right} of {number}, {100 * right / max(number, 1):.0f} in 100")
    return 0


if __name__ == "__main__":
    sys.exit(main())
