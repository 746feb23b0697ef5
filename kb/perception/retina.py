"""The retina's plan: which squares each of the 160 fields covers, which touch which, and what a gray level says.

Offsets are whole squares east and north of Utak in his own frame; arrays of fields follow the order of an impression.
"""

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

REACH = 16  # squares from Utak to the retina's edge
GRAY = 7  # the gray level of a field that is occupied throughout
ZONES = ((4, 1), (8, 2), (16, 4))  # (reach, side of a field), from the fovea outwards


class Field(NamedTuple):
    """One retinal field: its south-west square (east, north) and its side, in squares."""

    east: int
    north: int
    side: int


def _fields() -> tuple[Field, ...]:
    fields, inner = [], 0
    for reach, side in ZONES:
        for north in range(reach - side, -reach - 1, -side):
            for east in range(-reach, reach, side):
                if not (-inner <= east < inner and -inner <= north < inner):
                    fields.append(Field(east, north, side))
        inner = reach
    return tuple(fields)


FIELDS = _fields()
OWN = FIELDS.index(Field(0, 0, 1))  # the field of Utak's own square, which he always fills himself


@cache
def counts(side: int, level: int) -> tuple[int, int]:
    """The least and the greatest number of occupied squares that a field of this side shows as this gray level.

    Raises ValueError when no number of squares shows it.
    """
    area = side * side
    fitting = [n for n in range(area + 1) if (2 * GRAY * n + area) // (2 * area) == level]
    if not fitting:
        raise ValueError(f"a field of side {side} never shows gray level {level}")
    return fitting[0], fitting[-1]


def count_ranges(levels: tuple[int, ...]) -> NDArray[np.int16]:
    """(160, 2): the least and greatest count of occupied squares under each field; Utak's own field says nothing."""
    ranges = np.array([counts(field.side, level) for field, level in zip(FIELDS, levels, strict=True)], np.int16)
    ranges[OWN] = (0, 1)
    return ranges


@cache
def plan() -> NDArray[np.int16]:
    """(32, 32) [north + 16, east + 16]: the number of the field that covers each offset."""
    numbers = np.empty((2 * REACH, 2 * REACH), np.int16)
    for number, (east, north, side) in enumerate(FIELDS):
        numbers[north + REACH : north + REACH + side, east + REACH : east + REACH + side] = number
    return numbers


@cache
def neighbours() -> tuple[frozenset[int], ...]:
    """For each field the fields that share an edge, or part of one, with it."""
    numbers = plan()
    touching: list[set[int]] = [set() for _ in FIELDS]
    for a, b in ((numbers[:, :-1], numbers[:, 1:]), (numbers[:-1], numbers[1:])):
        for p, q in zip(a.ravel().tolist(), b.ravel().tolist(), strict=True):
            if p != q:
                touching[p].add(q)
                touching[q].add(p)
    return tuple(frozenset(t) for t in touching)


@cache
def rim() -> frozenset[int]:
    """The fields that lie at the retina's edge."""
    numbers = plan()
    return frozenset(np.concatenate([numbers[0], numbers[-1], numbers[:, 0], numbers[:, -1]]).tolist())
