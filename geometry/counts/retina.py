"""The plan of the retina: which squares each of its fields covers, and which gray level stands for which count.

Offsets are whole squares east and north of the robot's own square, in the robot frame. Fields follow the order of an
impression: zone by zone from the fovea, each from its north row to its south row, west to east.
"""

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

# (reach, side of a field) of each zone, in squares, from the fovea outwards; a reach is a multiple of the next side
RETINA_ZONES = ((4, 1), (8, 2), (16, 4))
RETINA_REACH = RETINA_ZONES[-1][0]  # squares; the offsets of the retina's squares run from -RETINA_REACH to one less
MAX_GRAY_LEVEL = 7  # the gray level of a field that is occupied throughout; convention (senses)


class Field(NamedTuple):
    """One field of the retina, a square of side x side table squares."""

    # The offset of its south-west square from the robot's own square, in squares, robot frame; negative for west, south
    east: int
    north: int
    side: int


def _fields() -> tuple[Field, ...]:
    """Return the fields in the order of an impression."""
    fields, inner = [], 0
    for reach, side in RETINA_ZONES:
        for north in range(reach - side, -reach - 1, -side):
            for east in range(-reach, reach, side):
                if not (-inner <= east < inner and -inner <= north < inner):
                    fields.append(Field(east, north, side))
        inner = reach
    return tuple(fields)


FIELDS = _fields()
FIELD_COUNT = len(FIELDS)  # 160
OWN_FIELD = FIELDS.index(Field(0, 0, 1))  # the field of the robot's own square, which the robot always fills itself


def gray_level(count: int, side: int) -> int:
    """Return the gray level of a field of side x side squares of which `count` are occupied: rounded, halves up."""
    return (2 * MAX_GRAY_LEVEL * count + side * side) // (2 * side * side)


@cache
def field_plan() -> NDArray[np.int16]:
    """Return the number of the field that covers each offset: (32, 32) int16, [north + 16, east + 16]."""
    numbers = np.empty((2 * RETINA_REACH, 2 * RETINA_REACH), np.int16)
    for number, (east, north, side) in enumerate(FIELDS):
        row, column = north + RETINA_REACH, east + RETINA_REACH
        numbers[row : row + side, column : column + side] = number
    return numbers
