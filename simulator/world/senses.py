"""The senses: 160 gray levels of the retina, and the colours of the 8 adjacent squares.

The retina covers 32 x 32 squares around Utak's own in three zones: a fovea of 8 x 8 fields of one square, around it 48
fields of 2 x 2 squares, around those 48 fields of 4 x 4 squares. A field of k x k squares with n occupied ones has the
gray level floor(7 n / k^2 + 1/2).
"""

import math

import numpy as np
import numpy.typing as npt

from simulator.world.table import Table, TableIndices

SENSED_REACH = 16  # squares; the offsets of the retina's squares run from -16 to 15
VIEW_ZONES = ((4, 1), (8, 2), (16, 4))  # (reach, side of a field) of each zone, in squares, from the fovea outwards
NEIGHBOUR_OFFSETS = {  # offsets (east, north) of the adjacent squares in Utak's frame, clockwise from north
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
    """Return the 160 fields of the retina in their order.

    Returns
    -------
    For each field: the offsets east and north of its south-west square from Utak's square, and its side, all in
        squares.
    """
    fields = []
    inner = 0
    for reach, side in VIEW_ZONES:
        for north in range(reach - side, -reach - 1, -side):
            for east in range(-reach, reach, side):
                if not (-inner <= east < inner and -inner <= north < inner):
                    fields.append((east, north, side))
        inner = reach
    return fields


class Senses:
    """Utak's senses for one heading.

    Parameters
    ----------
    heading : degrees from the table's north, counter-clockwise positive.
    """

    def __init__(self, heading: float) -> None:
        self._cosine, self._sine = math.cos(math.radians(heading)), math.sin(math.radians(heading))
        east, north = np.meshgrid(np.arange(-SENSED_REACH, SENSED_REACH), np.arange(-SENSED_REACH, SENSED_REACH))
        self._i = np.rint(east * self._cosine - north * self._sine).astype(np.intp)
        self._j = np.rint(east * self._sine + north * self._cosine).astype(np.intp)
        self._field, self._side = _fields_of_squares()

    def retina(self, table: Table, here: tuple[float, float]) -> tuple[int, ...]:
        """Return the 160 gray levels, 0 to 7, seen from a point (x, y) of the table."""
        i, j = math.floor(here[0]), math.floor(here[1])
        seen = table.occupied(self._i + i, self._j + j)
        seen[SENSED_REACH, SENSED_REACH] = True  # Utak's own square
        count = np.bincount(self._field, seen.ravel(), len(self._side)).astype(int)
        area = self._side**2
        return tuple(((14 * count + area) // (2 * area)).tolist())

    def touch(self, table: Table, here: tuple[float, float]) -> tuple[str | None, ...]:
        """Return the colours of the 8 squares adjacent to the point's square; None for floor.

        The order is clockwise from Utak's north.
        """
        return tuple(table.colour(*self.adjacent(here, direction)) for direction in NEIGHBOUR_OFFSETS)

    def adjacent(self, here: tuple[float, float], direction: str) -> tuple[int, int]:
        """Return the square (i, j) next to that of the point `here`, in a direction of `NEIGHBOUR_OFFSETS`."""
        east, north = NEIGHBOUR_OFFSETS[direction]
        i = math.floor(here[0]) + round(east * self._cosine - north * self._sine)
        j = math.floor(here[1]) + round(east * self._sine + north * self._cosine)
        return i, j


def _fields_of_squares() -> tuple[TableIndices, npt.NDArray[np.int_]]:
    """Return the index of the field of each of the 32 x 32 squares, and the sides of the fields in squares.

    The squares are in rows from the south.
    """
    fields = retina_fields()
    owner = np.zeros((2 * SENSED_REACH, 2 * SENSED_REACH), dtype=np.intp)
    for number, (east, north, side) in enumerate(fields):
        owner[north + SENSED_REACH : north + SENSED_REACH + side, east + SENSED_REACH : east + SENSED_REACH + side] = (
            number
        )
    return owner.ravel(), np.array([side for _, _, side in fields])
