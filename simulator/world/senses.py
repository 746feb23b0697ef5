"""The senses: 160 gray levels of the retina, and the colours of the 8 adjacent squares.

The retina covers 32 x 32 squares around Utak's own in three zones: a fovea of 8 x 8 fields of one square, around it 48
fields of 2 x 2 squares, around those 48 fields of 4 x 4 squares. A field of k x k squares with n occupied ones has the
gray level floor(7 n / k^2 + 1/2).
"""

import math

import numpy as np
import numpy.typing as npt

from utak.geometry.kernels.arrays import Longs
from utak.geometry.raster.surroundings import survey_square
from utak.simulator.world.table import COLOUR_OF_CODE, Table, colour_code
from utak.simulator.world.world import VERGE_COLOUR

SENSED_REACH = 16  # squares; the offsets of the retina's squares run from -16 to 15
VIEW_ZONES = ((4, 1), (8, 2), (16, 4))  # (reach, side of a field) of each zone, in squares, from the fovea outwards
SENSED_FIELDS = 160  # fields of the retina
SENSED_NUMBERS = 168  # of an impression in numbers: the fields and the 8 adjacent squares
MAX_FIELD_SQUARES = 16  # squares of the largest fields
VERGE_CODE = colour_code(VERGE_COLOUR)  # what is felt beyond the table
# (168,): the 160 gray levels, then the colours of the 8 adjacent squares as in `Table.colours`.
ImpressionCodes = npt.NDArray[np.uint8]
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
    """Return the 160 fields of the retina in their order."""
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
    """Utak's senses for one heading."""

    def __init__(self, heading: float) -> None:
        cosine, sine = math.cos(math.radians(heading)), math.sin(math.radians(heading))
        east, north = np.meshgrid(np.arange(-SENSED_REACH, SENSED_REACH), np.arange(-SENSED_REACH, SENSED_REACH))
        field, side = _fields_of_squares()
        i = np.rint(east * cosine - north * sine).astype(np.int64).ravel()
        j = np.rint(east * sine + north * cosine).astype(np.int64).ravel()
        squares = np.column_stack([i, j, field])
        own = SENSED_REACH * 2 * SENSED_REACH + SENSED_REACH  # in rows from the south
        self._own_field = int(field[own])
        self._squares = np.delete(squares, own, axis=0)  # Utak's own square is always occupied
        count = np.arange(MAX_FIELD_SQUARES + 1)
        area = side[:, None] ** 2
        self._levels = ((14 * count + area) // (2 * area)).astype(np.uint8)  # by field and count
        self._fields = np.arange(SENSED_FIELDS)
        self._adjacent = {
            name: (round(east * cosine - north * sine), round(east * sine + north * cosine))
            for name, (east, north) in NEIGHBOUR_OFFSETS.items()
        }
        self._neighbours = np.array(list(self._adjacent.values()), np.int64)

    def impression(
        self, table: Table, here: tuple[float, float], sensed: ImpressionCodes | None = None
    ) -> ImpressionCodes:
        """Return what is sensed at a point (x, y) of the table, as numbers."""
        if sensed is None:
            sensed = np.empty(SENSED_NUMBERS, np.uint8)
        counts, touched = sensed[:SENSED_FIELDS], sensed[SENSED_FIELDS:]
        i, j = math.floor(here[0]), math.floor(here[1])
        survey_square.call_unchecked(table.colours, i, j, self._squares, self._neighbours, VERGE_CODE, counts, touched)
        counts[self._own_field] += 1
        counts[:] = self._levels[self._fields, counts]
        return sensed

    def retina(self, table: Table, here: tuple[float, float]) -> tuple[int, ...]:
        """Return the 160 gray levels, 0 to 7, seen from a point (x, y) of the table."""
        return gray_levels(self.impression(table, here))

    def touch(self, table: Table, here: tuple[float, float]) -> tuple[str | None, ...]:
        """Return the colours of the 8 squares adjacent to the point's square; None for floor."""
        return felt_colours(self.impression(table, here))

    def adjacent(self, here: tuple[float, float], direction: str) -> tuple[int, int]:
        """Return the square (i, j) next to that of the point `here`, in a direction of `NEIGHBOUR_OFFSETS`."""
        i, j = self._adjacent[direction]
        return math.floor(here[0]) + i, math.floor(here[1]) + j


def gray_levels(sensed: ImpressionCodes) -> tuple[int, ...]:
    """Return the 160 gray levels, 0 to 7, of an impression in numbers."""
    return tuple(sensed[:SENSED_FIELDS].tolist())


def felt_colours(sensed: ImpressionCodes) -> tuple[str | None, ...]:
    """Return the colours felt in an impression in numbers: of 8 squares, clockwise from north; None for floor."""
    return tuple([COLOUR_OF_CODE[code] for code in sensed[SENSED_FIELDS:].tolist()])


def _fields_of_squares() -> tuple[Longs, Longs]:
    """Return the index of the field of each of the 32 x 32 squares, and the sides of the fields in squares."""
    fields = retina_fields()
    owner = np.zeros((2 * SENSED_REACH, 2 * SENSED_REACH), dtype=np.int64)
    for number, (east, north, side) in enumerate(fields):
        owner[north + SENSED_REACH : north + SENSED_REACH + side, east + SENSED_REACH : east + SENSED_REACH + side] = (
            number
        )
    return owner.ravel(), np.array([side for _, _, side in fields], dtype=np.int64)
