"""The plan of the retina: which squares each of the 160 fields covers, which fields touch, what a gray level says.

Offsets are whole squares east and north of the robot's own square, in the robot frame. Arrays of fields follow the
order of an impression: fovea, middle zone, outer zone; each from its north row to its south row, west to east.
"""

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

RETINA_REACH = 16  # squares from the robot to the retina's edge; convention (senses)
MAX_GRAY_LEVEL = 7  # the gray level of a field that is occupied throughout; convention (senses)
RETINA_ZONES = (
    (4, 1),
    (8, 2),
    (16, 4),
)  # (reach, side of a field) in squares, from the fovea outwards; convention (senses)


class Field(NamedTuple):
    """One field of the retina, a square of side x side table squares."""

    # The offset of its south-west square from the robot's own square, in squares, robot frame; negative for west, south
    east: int
    north: int
    side: int  # Its side, in squares: 1 in the fovea, 2 in the middle zone, 4 in the outer zone


def _fields() -> tuple[Field, ...]:
    """Return the 160 fields in the order of an impression: zones from the fovea, north row first, west to east."""
    fields, inner = [], 0
    for reach, side in RETINA_ZONES:
        for north in range(reach - side, -reach - 1, -side):
            for east in range(-reach, reach, side):
                if not (-inner <= east < inner and -inner <= north < inner):
                    fields.append(Field(east, north, side))
        inner = reach
    return tuple(fields)


FIELDS = _fields()
OWN_FIELD = FIELDS.index(Field(0, 0, 1))  # the field of the robot's own square, which the robot always fills itself


@cache
def level_counts(side: int, level: int) -> tuple[int, int]:
    """Return the least and the greatest number of occupied squares that a field shows as a gray level."""
    area = side * side
    fitting = [n for n in range(area + 1) if (2 * MAX_GRAY_LEVEL * n + area) // (2 * area) == level]
    if not fitting:
        raise ValueError(f"a field of {side} x {side} squares never shows gray level {level}")
    return fitting[0], fitting[-1]


def count_ranges(levels: tuple[int, ...]) -> NDArray[np.int16]:
    """Return the least and the greatest number of occupied squares under each field."""
    ranges = np.array([level_counts(field.side, level) for field, level in zip(FIELDS, levels, strict=True)], np.int16)
    ranges[OWN_FIELD] = (0, 1)
    return ranges


@cache
def field_plan() -> NDArray[np.int16]:
    """Return the number of the field that covers each offset: (32, 32) int16, [north + 16, east + 16]."""
    numbers = np.empty((2 * RETINA_REACH, 2 * RETINA_REACH), np.int16)
    for number, (east, north, side) in enumerate(FIELDS):
        row, column = north + RETINA_REACH, east + RETINA_REACH
        numbers[row : row + side, column : column + side] = number
    return numbers


@cache
def neighbours() -> tuple[frozenset[int], ...]:
    """Return for each field, by its number, the numbers of the fields that share an edge, or part of one, with it."""
    numbers = field_plan()
    touching: list[set[int]] = [set() for _ in FIELDS]
    for a, b in ((numbers[:, :-1], numbers[:, 1:]), (numbers[:-1], numbers[1:])):
        for p, q in zip(a.ravel().tolist(), b.ravel().tolist(), strict=True):
            if p != q:
                touching[p].add(q)
                touching[q].add(p)
    return tuple(frozenset(t) for t in touching)


@cache
def edge_fields() -> frozenset[int]:
    """Return the numbers (0 to 159, in the order of an impression) of the fields at the edge of the retina."""
    numbers = field_plan()
    return frozenset(np.concatenate([numbers[0], numbers[-1], numbers[:, 0], numbers[:, -1]]).tolist())
