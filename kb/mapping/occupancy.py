"""What all looks together say of every square: the counts of overlapping fields, solved as far as they settle anything.

A field that shows a gray level says: of these squares at least `low` and at most `high` are occupied. Three rules
settle squares, and
each is sound: a field that can take no more occupied squares leaves its others free; one that needs them all fills
them; and what two
overlapping fields have not in common is bounded by the difference of their counts. Squares that stay open get the
probability of
the maximum-entropy distribution with the fields' mean counts (iterative proportional fitting): confidence comes from
the sets of counts alone.
"""

import math
from collections.abc import Iterable
from copy import copy
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from geometry.counts.gibbs import Counts
from geometry.counts.settle import FREE, FULL, OPEN, misfits, residue, settle
from kb.mapping.occupancy_odds import Fields, Forgotten, Grown, Logits, Odds
from kb.perception.frame import MOST, Samples

__all__ = ["FREE", "FULL", "OPEN"]
SIGHT = 24  # squares that can be seen from a place, at any angle
MARGIN = 40  # squares by which the map grows beyond what is needed

Squares = NDArray[np.int32]
Mask = NDArray[np.bool_]
Told = tuple[int | bytes, ...]


NO_COUNTS = Counts(
    np.zeros((0, MOST), np.int32), np.zeros((0, MOST), np.int16), np.zeros(0, np.int16), np.zeros(0, np.int16)
)


class MapView(NamedTuple):
    """A snapshot of the part of the map that was seen, with a margin of unseen squares.

    west, south : the lattice square at [0, 0].
    probability : (rows, columns) float32, that a square is occupied; 0.5 where nothing is known.
    state : (rows, columns) int8, OPEN, FREE or FULL.
    seen : (rows, columns) bool.
    settled_by : (rows, columns) int16, the impression that settled a square, or -1.
    counts : the fields that still tell something, with flat indices of this view.
    sure : is what is settled beyond doubt? Not while the lattice may lie in several ways, or looks contradicted.
    """

    west: int
    south: int
    probability: NDArray[np.float32]
    state: NDArray[np.int8]
    seen: Mask
    settled_by: NDArray[np.int16]
    counts: Counts = NO_COUNTS
    sure: bool = True
    by_counts: NDArray[np.float32] | None = None

    def locate(self, x: float, y: float) -> tuple[int, int]:
        """[row, column] of the square in which a point of the lattice lies."""
        return math.floor(y) - self.south, math.floor(x) - self.west

    def part(self, rows: slice, columns: slice) -> "MapView":
        """What it says of some rows and columns, but for the counts."""
        return self._replace(
            west=self.west + columns.start,
            south=self.south + rows.start,
            probability=self.probability[rows, columns],
            state=self.state[rows, columns],
            seen=self.seen[rows, columns],
            settled_by=self.settled_by[rows, columns],
            counts=NO_COUNTS,
        )


class OccupancyMap:
    """The growing map. Arrays are [row, column]; square (x, y) of the lattice lies at [y - south, x - west].

    Attributes
    ----------
    state : (rows, columns) int8
        OPEN (-1), FREE (0) or FULL (1): what the counts settle.
    seen : (rows, columns) bool
        Squares that were ever under the retina.
    settled_by : (rows, columns) int16
        The impression that settled a square, or -1.
    """

    def __init__(self) -> None:
        self.west = self.south = -MARGIN
        shape = (2 * MARGIN, 2 * MARGIN)
        self.state = np.full(shape, OPEN, np.int8)
        self._odds = Odds(np.zeros(shape, np.float32))
        self.seen = np.zeros(shape, np.bool_)
        self.settled_by = np.full(shape, -1, np.int16)
        self._where = np.zeros((0, MOST), np.int32)
        self._weight = np.zeros((0, MOST), np.int16)
        self._low = np.zeros(0, np.int16)
        self._high = np.zeros(0, np.int16)
        self._fresh = np.zeros(0, np.bool_)
        self.overruled = 0
        self._observations: set[Told] = set()  # after which nothing was withdrawn

    @property
    def logit(self) -> Logits:
        """(rows, columns): log odds that an open square is occupied; 0 where nothing was seen."""
        return self._odds.logit

    def copy(self) -> "OccupancyMap":
        """The same, to be told more."""
        other = copy(self)
        other.state, other.seen = self.state.copy(), self.seen.copy()
        other.settled_by, other._fresh = self.settled_by.copy(), self._fresh.copy()
        other._observations = self._observations.copy()
        return other

    def view(self, places: Iterable[tuple[float, float]] = (), margin: int = 2) -> MapView:
        """The part of the map that was seen, and what lies in sight of some places, with `margin` squares around it."""
        squares = [(math.floor(x), math.floor(y)) for x, y in places]
        for square in squares:
            self.make_room(*square)
        there = np.array([self.index(*square) for square in squares], np.int64).reshape(-1, 2)
        rows, columns = np.flatnonzero(self.seen.any(1)), np.flatnonzero(self.seen.any(0))
        top, left = np.vstack([there - SIGHT, [rows[0], columns[0]]]).min(0).tolist()
        bottom, right = np.vstack([there + SIGHT, [rows[-1], columns[-1]]]).max(0).tolist()
        top, left = max(0, top - margin), max(0, left - margin)
        part = (slice(top, bottom + margin + 1), slice(left, right + margin + 1))
        state = self.state[part].copy()
        soft = 1.0 / (1.0 + np.exp(-self.logit[part]))
        probability = np.where(state == OPEN, soft, state).astype(np.float32)
        seen = self.seen[part].copy()
        _fill_gaps(probability, seen)
        west, south = self.west + int(left), self.south + int(top)
        counts = self._counts(top, left, state.shape[1])
        return MapView(west, south, probability, state, seen, self.settled_by[part].copy(), counts)

    def _counts(self, top: int, left: int, columns: int) -> Counts:
        """The fields, with the flat indices of a part of the map that begins at [top, left]."""
        rows, places = np.divmod(self._where, self.state.shape[1])
        where = np.where(self._weight > 0, (rows - top) * columns + places - left, 0).astype(np.int32)
        return Counts(where, self._weight, self._low, self._high)

    def index(self, x: int, y: int) -> tuple[int, int]:
        """[row, column] of a square of the lattice."""
        return y - self.south, x - self.west

    def squares(self, west: int, south: int, mask: Mask) -> Mask:
        """The squares of a small mask, whose [0, 0] is the lattice square (west, south), on the arrays of the map."""
        whole = np.zeros(self.state.shape, np.bool_)
        row, column = self.index(west, south)
        whole[row : row + mask.shape[0], column : column + mask.shape[1]] = mask
        return whole

    # -- looking ---------------------------------------------------------------------------------

    def misfits(self, samples: Samples, ranges: NDArray[np.int16], x: int, y: int) -> Mask:
        """(160,).

        Fields that cannot show what they show if Utak stands on square (x, y) and all that is settled is right.
        """
        self.make_room(x, y)
        low, wrong = ranges[:, 0] - samples.slack, np.zeros(len(ranges), np.bool_)
        misfits(self.state.ravel(), self._under(samples, x, y), samples.weight, low, ranges[:, 1].copy(), wrong)
        return wrong

    def clashes(self, samples: Samples, ranges: NDArray[np.int16], x: int, y: int, whether: bool = False) -> int:
        """How many fields, of this look and of those before, cannot be right if it was received on square (x, y).

        whether : those before are not looked at if some of this look cannot.
        """
        new = int(self.misfits(samples, ranges, x, y).sum())
        if new and whether:
            return new
        where = self._under(samples, x, y)
        told = (samples.weight.sum(1) == 1) & (samples.slack == 0) & ((ranges[:, 0] > 0) | (ranges[:, 1] <= 0))
        left = samples.weight[told].argmax(1)  # of a field of several squares all others may lie under loads
        state = self.state.ravel().copy()
        state[where[told, left]] = np.where(ranges[told, 0] > 0, FULL, FREE)
        return new + misfits(state, *self._fields, np.zeros(len(self._low), np.bool_))

    def observe(self, samples: Samples, ranges: NDArray[np.int16], x: int, y: int, number: int) -> None:
        """Take in one impression, received on square (x, y), as impression `number`.

        Where it contradicts what was settled, what is seen now counts: older settlements under the contradicting
        fields, and the fields that led to them, are withdrawn. What was seen before, from there, tells nothing new.
        """
        seen_here: Told = (x, y, *(told.tobytes() for told in (samples.columns, samples.rows, samples.weight, ranges)))
        if seen_here in self._observations:
            return
        wrong = self.misfits(samples, ranges, x, y)
        where = self._under(samples, x, y)
        if wrong.any():
            self.withdraw(np.unique(where[wrong][samples.weight[wrong] > 0]))
            self.overruled += int(wrong.sum())
        self.seen.ravel()[where[samples.weight > 0]] = True
        self._where = np.concatenate([self._where, where])
        self._weight = np.concatenate([self._weight, samples.weight])
        self._low = np.concatenate([self._low, np.maximum(ranges[:, 0] - samples.slack, 0)])
        self._high = np.concatenate([self._high, ranges[:, 1]])
        self._fresh = np.concatenate([self._fresh, np.ones(len(where), np.bool_)])
        settle(self.state.ravel(), self.settled_by.ravel(), *self._fields, self._fresh, number)
        self._keep(self._informative())
        self._odds = self._odds.after(Fields(self.state.copy().ravel(), *self._fields))
        self._observations.add(seen_here)

    def withdraw(self, squares: Squares) -> None:
        """Forget what was settled of these squares (flat indices), and every field that covers one of them."""
        self._observations.clear()
        doubtful = np.zeros(self.state.size, np.bool_)
        doubtful[squares] = True
        self.state.ravel()[squares] = OPEN
        self._odds = self._odds.after(Forgotten(squares))
        self.settled_by.ravel()[squares] = -1
        touched = doubtful[self._where] & (self._weight > 0)
        self._keep(np.logical_not(np.logical_or.reduce(touched, axis=1)))

    def stand(self, x: int, y: int, number: int) -> None:
        """Utak wakes on this square, so it is floor, unless it was settled otherwise: his own image hides it.

        Where a motion ends proves as much of no square: it may have been stopped right on the line before a wall.
        """
        row, column = self.index(x, y)
        if self.state[row, column] == OPEN:
            self.state[row, column], self.settled_by[row, column] = FREE, number
            self._fresh[:] = True  # for what the fields that cover it tell now
        self.seen[row, column] = True

    def declare(self, mask: Mask, value: int, number: int) -> None:
        """Settle squares by other knowledge than counts (the place of an object that was pushed)."""
        self.withdraw(np.flatnonzero(mask).astype(np.int32))
        self.state[mask] = value
        self.settled_by[mask] = number

    # -- solving ---------------------------------------------------------------------------------

    def window(self, west: int, south: int, shape: tuple[int, ...]) -> NDArray[np.int8]:
        """The states of a (rows, columns) part of the lattice from the square (west, south) on; OPEN beyond the map."""
        row, column = self.index(west, south)
        part = np.full(shape, OPEN, np.int8)
        rows = slice(max(-row, 0), max(len(self.state) - row, 0))
        columns = slice(max(-column, 0), max(self.state.shape[1] - column, 0))
        there = part[rows, columns]
        there[:] = self.state[max(row, 0) :, max(column, 0) :][: there.shape[0], : there.shape[1]]
        return part

    def supposing(self, squares: Iterable[tuple[int, int]]) -> "OccupancyMap":
        """The same, were those of some squares free that rather are: to be asked, and to be told nothing."""
        other = copy(self)
        other.state = self.state.copy()
        for x, y in squares:
            row, column = self.index(x, y)
            inside = 0 <= row < self.state.shape[0] and 0 <= column < self.state.shape[1]
            if inside and self.state[row, column] == OPEN and self.logit[row, column] < 0:
                other.state[row, column] = FREE
        return other

    @property
    def _fields(self) -> tuple[Squares, NDArray[np.int16], NDArray[np.int16], NDArray[np.int16]]:
        """All fields that still tell something, as the kernels take them."""
        return self._where, self._weight, self._low, self._high

    def _informative(self) -> Mask:
        _, weight, low, high = residue(self.state.ravel(), *self._fields)
        return (weight > 0) & ((low > 0) | (high < weight))

    def _keep(self, rows: Mask) -> None:
        self._where, self._weight = self._where[rows], self._weight[rows]
        self._low, self._high, self._fresh = self._low[rows], self._high[rows], self._fresh[rows]

    # -- room to grow ----------------------------------------------------------------------------

    def _under(self, samples: Samples, x: int, y: int) -> Squares:
        """(160, 16) flat indices of the squares sampled from (x, y)."""
        columns = self.state.shape[1]
        answer: Squares = (samples.rows + (y - self.south)) * columns + samples.columns + (x - self.west)
        return answer

    def make_room(self, x: int, y: int) -> None:
        """Grow the arrays until a look from (x, y), at any angle, fits in."""
        row, column = self.index(x, y)
        rows, columns = self.state.shape
        south, west = max(0, SIGHT - row), max(0, SIGHT - column)
        north, east = max(0, row + SIGHT + 1 - rows), max(0, column + SIGHT + 1 - columns)
        if south or west or north or east:
            self._grow(*(n + MARGIN if n else 0 for n in (south, north, west, east)))

    def _grow(self, south: int, north: int, west: int, east: int) -> None:
        rows, columns = np.divmod(self._where, self.state.shape[1])
        widths = ((south, north), (west, east))
        self.state = np.pad(self.state, widths, constant_values=OPEN)
        self._odds = self._odds.after(Grown(widths))
        self.seen = np.pad(self.seen, widths)
        self.settled_by = np.pad(self.settled_by, widths, constant_values=-1)
        self.south, self.west = self.south - south, self.west - west
        self._where = ((rows + south) * self.state.shape[1] + columns + west).astype(np.int32)


def _fill_gaps(probability: NDArray[np.float32], seen: Mask) -> None:
    """Count a single square that no field happened to sample, amid squares that were seen, as seen: as likely
    occupied as those about it.

    On a turned lattice the eye skips some squares, though never two side by side.
    """
    known = np.pad(seen, 1).astype(np.float32)
    likely = np.pad(np.where(seen, probability, 0), 1)
    count, total = (a[:-2, 1:-1] + a[2:, 1:-1] + a[1:-1, :-2] + a[1:-1, 2:] for a in (known, likely))
    gaps = ~seen & (count >= 3)
    probability[gaps] = total[gaps] / count[gaps]
    seen |= gaps
