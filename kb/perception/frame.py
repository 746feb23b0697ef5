"""The frame: how the grid of table squares lies in the robot frame, and which squares each field of the retina samples.

Two frames occur. The *robot frame* has its origin where the robot woke; its north is the way the robot faced then.
Commands, and all that the robot states, are in it. The *map frame* has its axes along the rows of table squares, and
square (0, 0) is the one in which the robot woke. The map is kept in it, for there every impression samples the same
squares. The map frame is turned by -44 to 45 degrees against the robot frame; whole quarter turns make no difference
to anything that the robot sees.

Where in square (0, 0) the robot woke cannot be felt. The centre is assumed as long as nothing contradicts it.
"""

import math
from dataclasses import dataclass
from functools import cache
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from utak.geometry.counts.retina import FIELDS, OWN_FIELD
from utak.geometry.kernels.arrays import XY, Floats, Ints, Square
from utak.kb.body import DIRECTIONS

Coordinate = TypeVar("Coordinate", float, Floats)
CENTRE = (0.5, 0.5)  # the centre of square (0, 0), map frame
SAMPLING_TIE_TOLERANCE = 1e-9  # squares: an offset so near to the line between two squares may be sampled from either
MAX_SAMPLED_SQUARES = 16  # squares under the largest field: derived, 4 x 4
# (east, north) of each of DIRECTIONS
ADJACENT_OFFSETS = ((0, 1), (1, 1), (1, 0), (1, -1), (0, -1), (-1, -1), (-1, 0), (-1, 1))


class Samples(NamedTuple):
    """The squares that the 160 fields sample at one orientation of the frame, relative to the robot's own square."""

    # Offsets of the sampled squares from the robot's own square, in squares, map frame: to the east and to the north,
    # negative to the west and south; 0 where padded
    columns: Ints
    rows: Ints
    # How often a field samples that square; 0 is padding. The field of the robot's own square has padding alone.
    weight: NDArray[np.int16]
    slack: NDArray[np.int16]  # How many samples of a field fall between two squares, and count for neither


@dataclass(frozen=True)
class Frame:
    """The orientation and the origin of the robot frame in the map frame."""

    # Degrees by which the robot frame is turned against the map frame, counter-clockwise positive, -44 to 45; 0 when
    # both have the same axes
    angle: int = 0
    # The origin of the robot frame, in squares, map frame: a point of square (0, 0); its centre (0.5, 0.5) by default.
    origin: XY = CENTRE

    def to_map(self, east: Coordinate, north: Coordinate) -> tuple[Coordinate, Coordinate]:
        """Return a vector (east, north) of the robot frame as a vector (x, y) of the map frame, in squares."""
        return turned(east, north, self.angle)

    def to_utak(self, x: float, y: float) -> XY:
        """Return a vector (x, y) of the map frame as a vector (east, north) of the robot frame, in squares."""
        return turned(x, y, -self.angle)

    def place_to_utak(self, x: float, y: float) -> XY:
        """Return a point (x, y) of the map frame as a point (east, north) of the robot frame, in squares."""
        return self.to_utak(x - self.origin[0], y - self.origin[1])

    def place_from_utak(self, east: Coordinate, north: Coordinate) -> tuple[Coordinate, Coordinate]:
        """Return a point (east, north) of the robot frame as a point (x, y) of the map frame, in squares."""
        x, y = self.to_map(east, north)
        return x + self.origin[0], y + self.origin[1]

    def beside(self, direction: str) -> Square | None:
        """Return the offset (columns, rows) of the adjacent square in a direction, map frame."""
        # None where the direction points between two squares, so that it may name either.
        named = self.adjacent_squares(direction)
        return named[0] if len(named) == 1 else None

    def adjacent_squares(self, direction: str) -> list[Square]:
        """Return the offsets (columns, rows) of the adjacent squares that a direction of the robot frame may name."""
        column, row = self.to_map(*ADJACENT_OFFSETS[DIRECTIONS.index(direction)])
        return [(x, y) for x in _nearest_squares(column) for y in _nearest_squares(row)]

    def directions(self) -> dict[Square, str]:
        """Return for each adjacent square a direction that surely names it."""
        named = ((self.beside(direction), direction) for direction in reversed(DIRECTIONS))
        return {square: direction for square, direction in named if square is not None}

    def samples(self) -> Samples:
        """Return the squares that each field of the retina samples: offsets from the robot's own square, map frame."""
        return _samples(self.angle)


def _nearest_squares(offset: float) -> list[int]:
    """Return the square into which an offset falls along one axis."""
    # Both, lower one first, where it falls between two.
    return sorted({math.ceil(offset - 0.5 - SAMPLING_TIE_TOLERANCE), math.floor(offset + 0.5 + SAMPLING_TIE_TOLERANCE)})


def turned(x: Coordinate, y: Coordinate, degrees: float) -> tuple[Coordinate, Coordinate]:
    """Return a vector, or an array of vectors, rotated about the origin; exact for quarter turns."""
    if degrees % 90 == 0:
        for _ in range(int(degrees // 90) % 4):
            x, y = -y, x
        return x, y
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return x * c - y * s, x * s + y * c


@cache
def _samples(angle: int) -> Samples:
    """Return the squares that each field samples when the robot frame is turned by `angle` degrees."""
    owner, east, north = _field_offsets()
    c, s = turned(1.0, 0.0, angle)
    x, y = east * c - north * s, east * s + north * c
    tied = np.zeros(len(owner), np.bool_)
    for v in (x, y):
        tied |= np.abs(np.abs(v - np.trunc(v)) - 0.5) < SAMPLING_TIE_TOLERANCE
    slack = np.bincount(owner[tied], minlength=len(FIELDS)).astype(np.int16)
    under = np.stack([owner, np.rint(x).astype(np.int32), np.rint(y).astype(np.int32)])[:, ~tied]
    (number, column, row), times = np.unique(under, axis=1, return_counts=True)
    place = np.arange(len(number)) - np.searchsorted(number, number)
    columns, rows = np.zeros((2, len(FIELDS), MAX_SAMPLED_SQUARES), np.int32)
    weight = np.zeros(columns.shape, np.int16)
    columns[number, place], rows[number, place], weight[number, place] = column, row, times
    return Samples(columns, rows, weight, slack)


@cache
def _field_offsets() -> Ints:
    """Return the offsets under the retina, but the robot's own square: (3, 1023) int32."""
    offsets = [
        (number, east, north)
        for number, field in enumerate(FIELDS)
        for east in range(field.east, field.east + field.side)
        for north in range(field.north, field.north + field.side)
        if number != OWN_FIELD
    ]
    return np.array(offsets, np.int32).T
