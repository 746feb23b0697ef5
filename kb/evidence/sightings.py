"""Which cells of which impressions show a square, as believed at some step."""

from collections.abc import Iterable, Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from utak.geometry.counts.retina import FIELDS
from utak.geometry.kernels.arrays import Ints, Square
from utak.kb.evidence.record import Record
from utak.kb.perception.frame import Frame

REACH = 25  # squares from the robot's own square within which fields lie, at any angle of the frame: derived, 16 sqrt 2


class Sighting(NamedTuple):
    """A cell that shows a square."""

    impression: int  # the number of the impression
    cell: int  # the number of the cell, 0 to 159, in the order of an impression
    level: int  # the gray level that it shows, 0 to 7
    side: int  # the side of the cell, in squares
    square: Square  # the square (column, row), map frame

    def __str__(self) -> str:
        size = "one square" if self.side == 1 else f"{self.side} x {self.side} squares"
        return f"cell {self.cell} of impression {self.impression} ({size}) shows level {self.level} of 7"


@lru_cache(maxsize=128)
def cells_by_offset(angle: int) -> Ints:
    """Return the number of the cell over each offset from the robot's own square: (51, 51) int32, -1 for none."""
    plan = np.full((2 * REACH + 1, 2 * REACH + 1), -1, np.int32)
    samples = Frame(angle).samples()
    for cell in sorted(range(len(FIELDS)), key=lambda number: -FIELDS[number].side):
        under = samples.weight[cell] > 0
        plan[samples.rows[cell, under] + REACH, samples.columns[cell, under] + REACH] = cell
    plan.setflags(write=False)
    return plan


def sightings(record: Record, step: int, squares: Iterable[Square]) -> list[Sighting]:
    """Return all cells that show one of some squares, by the beliefs of a step."""
    now = record.steps[step]
    plan = cells_by_offset(now.frame.angle)
    stands = [(number, now.square_of(now.places[number])) for number in range(now.first_impression, step + 1)]
    found = []
    for column, row in squares:
        for number, (x, y) in stands:
            east, north = column - x + REACH, row - y + REACH
            if 0 <= east <= 2 * REACH and 0 <= north <= 2 * REACH and plan[north, east] >= 0:
                cell = int(plan[north, east])
                level = record.steps[number].retina[cell]
                found.append(Sighting(number, cell, level, FIELDS[cell].side, (column, row)))
    return found


def most_telling(found: Sequence[Sighting], occupied: bool, count: int) -> list[Sighting]:
    """Return the sightings that say most clearly that their squares are occupied, or that they are free."""
    fitting = [one for one in found if (one.level > 0) == occupied]
    order = sorted(fitting, key=lambda s: (s.side, -s.level if occupied else s.level, -s.impression, s.cell))
    first: dict[tuple[int, int], Sighting] = {}
    for one in order:
        first.setdefault((one.impression, one.cell), one)
    return list(first.values())[:count]
