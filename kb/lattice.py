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
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kb.body import DIRECTIONS
from kb.retina import FIELDS, OWN

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
class Lattice:
    """How Utak's frame lies in the lattice.

    Angle, the degrees by which it is turned counter-clockwise, and woke, the lattice point of its origin.
    """

    angle: int = 0
    woke: tuple[float, float] = CENTRE

    def to_lattice(self, east: float, north: float) -> tuple[float, float]:
        """A vector of Utak's frame as a vector of the lattice."""
        return turned(east, north, self.angle)

    def to_utak(self, x: float, y: float) -> tuple[float, float]:
        """A vector of the lattice as a vector of Utak's frame."""
        return turned(x, y, -self.angle)

    def place_to_utak(self, x: float, y: float) -> tuple[float, float]:
        """A point of the lattice as a point of Utak's frame."""
        return self.to_utak(x - self.woke[0], y - self.woke[1])

    def place_from_utak(self, east: float, north: float) -> tuple[float, float]:
        """A point of Utak's frame as a point of the lattice."""
        x, y = self.to_lattice(east, north)
        return x + self.woke[0], y + self.woke[1]

    def beside(self, direction: str) -> tuple[int, int]:
        """The adjacent square, as (columns, rows), in one of the eight directions of Utak's frame."""
        column, row = self.to_lattice(*AROUND[DIRECTIONS.index(direction)])
        return round(column), round(row)

    def samples(self) -> Samples:
        """The squares that each field samples."""
        return _samples(self.angle)


def turned(x: float, y: float, degrees: float) -> tuple[float, float]:
    """A vector turned counter-clockwise; exact for quarter turns."""
    if degrees % 90 == 0:
        for _ in range(int(degrees // 90) % 4):
            x, y = -y, x
        return x, y
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return x * c - y * s, x * s + y * c


@cache
def _samples(angle: int) -> Samples:
    columns = np.zeros((len(FIELDS), MOST), np.int32)
    rows = np.zeros_like(columns)
    weight = np.zeros(columns.shape, np.int16)
    slack = np.zeros(len(FIELDS), np.int16)
    for number, (east, north, side) in enumerate(FIELDS):
        seen: dict[tuple[int, int], int] = {}
        for e in range(east, east + side):
            for n in range(north, north + side):
                x, y = turned(e, n, angle)
                if number == OWN:
                    continue
                if any(abs(abs(v - math.trunc(v)) - 0.5) < TIE for v in (x, y)):
                    slack[number] += 1
                else:
                    square = (round(x), round(y))
                    seen[square] = seen.get(square, 0) + 1
        for i, ((column, row), times) in enumerate(sorted(seen.items())):
            columns[number, i], rows[number, i], weight[number, i] = column, row, times
    return Samples(columns, rows, weight, slack)
