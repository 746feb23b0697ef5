"""What Utak senses: 160 gray levels of his retina and the colours of the 8 squares around him.

The retina covers 32 x 32 squares about Utak's own in three zones: a fovea of 8 x 8 fields of one square, around it 48
fields of 2 x 2 squares, around those 48 fields of 4 x 4. A field of k x k squares of which n are occupied shows
floor(7 n / k^2 + 1/2).
"""

import math

import numpy as np
import numpy.typing as npt

from simulator.world.table import Ints, Table

REACH = 16  # the retina's offsets run from -16 to 15
ZONES = ((4, 1), (8, 2), (16, 4))  # each zone's reach in squares, and its fields' side
NEIGHBOURS = {  # clockwise from north: the adjacent squares as offsets (east, north) in Utak's frame
    "north": (0, 1),
    "northeast": (1, 1),
    "east": (1, 0),
    "southeast": (1, -1),
    "south": (0, -1),
    "southwest": (-1, -1),
    "west": (-1, 0),
    "northwest": (-1, 1),
}


def retina_fields() -> list[tuple[int, int, int]]:
    """Return the 160 fields in order: offsets (east, north) of the south-west square, and the side in squares."""
    fields = []
    inner = 0
    for reach, side in ZONES:
        for north in range(reach - side, -reach - 1, -side):
            for east in range(-reach, reach, side):
                if not (-inner <= east < inner and -inner <= north < inner):
                    fields.append((east, north, side))
        inner = reach
    return fields


class Senses:
    """Utak's senses at one heading (degrees, counter-clockwise from the table's north)."""

    def __init__(self, heading: float) -> None:
        self._cosine, self._sine = math.cos(math.radians(heading)), math.sin(math.radians(heading))
        east, north = np.meshgrid(np.arange(-REACH, REACH), np.arange(-REACH, REACH))
        self._i = np.rint(east * self._cosine - north * self._sine).astype(np.intp)
        self._j = np.rint(east * self._sine + north * self._cosine).astype(np.intp)
        self._field, self._side = _fields_of_squares()

    def retina(self, table: Table, here: tuple[float, float]) -> tuple[int, ...]:
        """Return the 160 gray levels (0 to 7) seen from (x, y)."""
        i, j = math.floor(here[0]), math.floor(here[1])
        seen = table.occupied(self._i + i, self._j + j)
        seen[REACH, REACH] = True  # Utak himself
        count = np.bincount(self._field, seen.ravel(), len(self._side)).astype(int)
        area = self._side**2
        return tuple(((14 * count + area) // (2 * area)).tolist())

    def touch(self, table: Table, here: tuple[float, float]) -> tuple[str | None, ...]:
        """Return the colours of the 8 adjacent squares, clockwise from Utak's north; None for floor."""
        return tuple(table.colour(*self.adjacent(here, direction)) for direction in NEIGHBOURS)

    def adjacent(self, here: tuple[float, float], direction: str) -> tuple[int, int]:
        """Return the square (i, j) next to Utak's in one of the eight directions of his frame."""
        east, north = NEIGHBOURS[direction]
        i = math.floor(here[0]) + round(east * self._cosine - north * self._sine)
        j = math.floor(here[1]) + round(east * self._sine + north * self._cosine)
        return i, j


def _fields_of_squares() -> tuple[Ints, npt.NDArray[np.int_]]:
    """The field under which each of the 32 x 32 squares lies (row by row from the south), and the fields' sides."""
    fields = retina_fields()
    owner = np.zeros((2 * REACH, 2 * REACH), dtype=np.intp)
    for number, (east, north, side) in enumerate(fields):
        owner[north + REACH : north + REACH + side, east + REACH : east + REACH + side] = number
    return owner.ravel(), np.array([side for _, _, side in fields])
