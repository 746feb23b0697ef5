"""The lattice of the table's squares, as Utak's eye samples it.

Utak's north need not lie along the rows of squares. The lattice is turned by `angle` degrees (-44..45) against his
own frame; the
quarter turn that is left makes no difference to anything he sees. The map in his head is kept on the lattice, where
every look
samples the same squares; his own frame (east, north, origin the point where he woke) is for commands and for what he
says.

The square in which he woke is square (0, 0) of the lattice; the point where he woke is (0, 0) of his own frame. Where
in that square it lies he cannot feel; the centre is assumed as long as nothing contradicts it.
"""

import math
from dataclasses import dataclass
from functools import cache
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from kb.body import DIRECTIONS
from kb.perception.retina import FIELDS, OWN

Floats = NDArray[np.float64]
Coordinate = TypeVar("Coordinate", float, NDArray[np.float64])
CENTRE = (0.5, 0.5)
TIE = 1e-9  # an offset that falls this near to the middle between two squares may be sampled from either
MOST = 16  # squares under the largest field
AROUND = ((0, 1), (1, 1), (1, 0), (1, -1), (0, -1), (-1, -1), (-1, 0), (-1, 1))  # clockwise from his north


class Samples(NamedTuple):
    """What the 160 fields sample at one angle, relative to Utak's own square.

    columns, rows: (160, 16) offsets on the lattice; weight: (160, 16) how often a field samples that square (0:
    padding); slack: (160,) samples of a field that fall between two squares, and so count for nothing.
    """

    columns: NDArray[np.int32]
    rows: NDArray[np.int32]
    weight: NDArray[np.int16]
    slack: NDArray[np.int16]


@dataclass(frozen=True)
class Frame:
    """How Utak's frame lies in the lattice.

    Angle, the degrees by which it is turned counter-clockwise, and woke, the lattice point of its origin.
    """

    angle: int = 0
    origin: tuple[float, float] = CENTRE

    def to_lattice(self, east: float, north: float) -> tuple[float, float]:
        """A vector of Utak's frame as a vector of the lattice."""
        return turned(east, north, self.angle)

    def to_utak(self, x: float, y: float) -> tuple[float, float]:
        """A vector of the lattice as a vector of Utak's frame."""
        return turned(x, y, -self.angle)

    def place_to_utak(self, x: float, y: float) -> tuple[float, float]:
        """A point of the lattice as a point of Utak's frame."""
        return self.to_utak(x - self.origin[0], y - self.origin[1])

    def place_from_utak(self, east: float, north: float) -> tuple[float, float]:
        """A point of Utak's frame as a point of the lattice."""
        x, y = self.to_lattice(east, north)
        return x + self.origin[0], y + self.origin[1]

    def places_from_utak(self, east: Floats, north: Floats) -> tuple[Floats, Floats]:
        """Points of Utak's frame as points of the lattice."""
        x, y = turned(east, north, self.angle)
        return x + self.origin[0], y + self.origin[1]

    def beside(self, direction: str) -> tuple[int, int] | None:
        """The adjacent square, as (columns, rows), in one of the eight directions of Utak's frame.

        None where the direction points between two squares, and either may be the one.
        """
        named = self.may_name(direction)
        return named[0] if len(named) == 1 else None

    def may_name(self, direction: str) -> list[tuple[int, int]]:
        """The adjacent squares, as (columns, rows), that a direction may name: several where it points between them."""
        column, row = self.to_lattice(*AROUND[DIRECTIONS.index(direction)])
        return [(x, y) for x in _nearest(column) for y in _nearest(row)]

    def directions(self) -> dict[tuple[int, int], str]:
        """For each adjacent square, as (columns, rows), that some direction of Utak's frame surely names: that one."""
        named = ((self.beside(direction), direction) for direction in reversed(DIRECTIONS))
        return {square: direction for square, direction in named if square is not None}

    def samples(self) -> Samples:
        """The squares that each field samples."""
        return _samples(self.angle)


def _nearest(offset: float) -> list[int]:
    """The square that an offset falls in; both where it falls between two."""
    return sorted({math.ceil(offset - 0.5 - TIE), math.floor(offset + 0.5 + TIE)})


def turned(x: Coordinate, y: Coordinate, degrees: float) -> tuple[Coordinate, Coordinate]:
    """A vector, or vectors, turned counter-clockwise; exact for quarter turns."""
    if degrees % 90 == 0:
        for _ in range(int(degrees // 90) % 4):
            x, y = -y, x
        return x, y
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return x * c - y * s, x * s + y * c


@cache
def _samples(angle: int) -> Samples:
    owner, east, north = _offsets()
    c, s = turned(1.0, 0.0, angle)
    x, y = east * c - north * s, east * s + north * c
    tied = np.zeros(len(owner), np.bool_)
    for v in (x, y):
        tied |= np.abs(np.abs(v - np.trunc(v)) - 0.5) < TIE
    slack = np.bincount(owner[tied], minlength=len(FIELDS)).astype(np.int16)
    under = np.stack([owner, np.rint(x).astype(np.int32), np.rint(y).astype(np.int32)])[:, ~tied]
    (number, column, row), times = np.unique(under, axis=1, return_counts=True)
    place = np.arange(len(number)) - np.searchsorted(number, number)
    columns, rows = np.zeros((2, len(FIELDS), MOST), np.int32)
    weight = np.zeros(columns.shape, np.int16)
    columns[number, place], rows[number, place], weight[number, place] = column, row, times
    return Samples(columns, rows, weight, slack)


@cache
def _offsets() -> NDArray[np.int32]:
    """(3, 1023): field, east and north of every offset under the retina but Utak's own."""
    offsets = [
        (number, east, north)
        for number, field in enumerate(FIELDS)
        for east in range(field.east, field.east + field.side)
        for north in range(field.north, field.north + field.side)
        if number != OWN
    ]
    return np.array(offsets, np.int32).T
