"""The senses: the gray levels of the retina, and the colours of the 8 adjacent squares (geometry.counts.retina)."""

import math

import numpy as np
import numpy.typing as npt

from utak.geometry.counts.retina import FIELD_COUNT, FIELDS, RETINA_REACH, field_plan, gray_level
from utak.geometry.raster.surroundings import survey_square
from utak.simulator.world.table import COLOUR_OF_CODE, Table, colour_code
from utak.simulator.world.world import VERGE_COLOUR

SENSED_NUMBERS = FIELD_COUNT + 8  # of an impression in numbers: the fields and the 8 adjacent squares
MAX_FIELD_SQUARES = max(field.side for field in FIELDS) ** 2  # squares of the largest fields
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


class Senses:
    """Utak's senses for one heading."""

    def __init__(self, heading: float) -> None:
        cosine, sine = math.cos(math.radians(heading)), math.sin(math.radians(heading))
        east, north = np.meshgrid(np.arange(-RETINA_REACH, RETINA_REACH), np.arange(-RETINA_REACH, RETINA_REACH))
        field = field_plan().ravel().astype(np.int64)
        i = np.rint(east * cosine - north * sine).astype(np.int64).ravel()
        j = np.rint(east * sine + north * cosine).astype(np.int64).ravel()
        squares = np.column_stack([i, j, field])
        own = RETINA_REACH * 2 * RETINA_REACH + RETINA_REACH  # in rows from the south
        self._own_field = int(field[own])
        self._squares = np.delete(squares, own, axis=0)  # Utak's own square is always occupied
        self._levels = np.array(  # by field and count
            [[gray_level(count, field.side) for count in range(MAX_FIELD_SQUARES + 1)] for field in FIELDS]
        ).astype(np.uint8)
        self._fields = np.arange(FIELD_COUNT)
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
        counts, touched = sensed[:FIELD_COUNT], sensed[FIELD_COUNT:]
        i, j = math.floor(here[0]), math.floor(here[1])
        survey_square.call_unchecked(table.colours, i, j, self._squares, self._neighbours, VERGE_CODE, counts, touched)
        counts[self._own_field] += 1
        counts[:] = self._levels[self._fields, counts]
        return sensed

    def adjacent(self, here: tuple[float, float], direction: str) -> tuple[int, int]:
        """Return the square (i, j) next to that of the point `here`, in a direction of `NEIGHBOUR_OFFSETS`."""
        i, j = self._adjacent[direction]
        return math.floor(here[0]) + i, math.floor(here[1]) + j


def gray_levels(sensed: ImpressionCodes) -> tuple[int, ...]:
    """Return the 160 gray levels, 0 to 7, of an impression in numbers."""
    return tuple(sensed[:FIELD_COUNT].tolist())


def felt_colours(sensed: ImpressionCodes) -> tuple[str | None, ...]:
    """Return the colours felt in an impression in numbers: of 8 squares, clockwise from north; None for floor."""
    return tuple([COLOUR_OF_CODE[code] for code in sensed[FIELD_COUNT:].tolist()])
