"""The occupancy map: the counts of overlapping fields of all impressions, solved as far as they settle squares.

A field that shows a gray level says: of these squares at least `low` and at most `high` are occupied. Three rules
settle squares, and each is sound. A field that can take no more occupied squares leaves its other squares free. A
field that needs all its squares occupied fills them. The squares that two overlapping fields do not share are bounded
by the difference of their counts. Squares that stay open get a probability from the counts alone: that of the
maximum-entropy distribution with the mean counts of the fields (kb.mapping.occupancy_odds).
"""

import math
from collections.abc import Iterable
from copy import copy
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from utak.geometry.counts.gibbs import Counts
from utak.geometry.counts.settle import FREE, OCCUPIED, OPEN, misfits, remaining_counts, settle
from utak.geometry.kernels.arrays import XY, Bools, Ints, Square
from utak.geometry.raster.components import with_edge_neighbours
from utak.kb.mapping.occupancy_odds import Fields, Forgotten, Grown, Logits, Odds
from utak.kb.perception.frame import MAX_SAMPLED_SQUARES, Samples

__all__ = ["FREE", "OCCUPIED", "OPEN"]
SIGHT_RANGE = 24  # squares: what is seen from a place lies within so many columns and rows, at any orientation; derived
GROWTH_MARGIN = 40  # squares by which the map grows beyond what is needed; convention

MapPatch = tuple[int, int, Bools]  # west and south of a mask, map frame, and the mask: a Patch (kb.mapping.patch)
ObservationKey = tuple[int | bytes, ...]  # all that an impression says, and where it was received


NO_COUNTS = Counts(
    np.zeros((0, MAX_SAMPLED_SQUARES), np.int32),
    np.zeros((0, MAX_SAMPLED_SQUARES), np.int16),
    np.zeros(0, np.int16),
    np.zeros(0, np.int16),
)


class MapView(NamedTuple):
    """A snapshot of the part of the map that was seen, with a margin of unseen squares."""

    west: int  # The square at [0, 0], map frame
    south: int
    probability: NDArray[np.float32]  # That a square is occupied, 0 to 1; 0.5 where nothing is known.
    state: NDArray[np.int8]  # OPEN, FREE or OCCUPIED: what the counts settle
    seen: Bools  # Squares that were ever under the retina
    settled_by: NDArray[np.int16]  # The number of the impression that settled a square, or -1
    # The fields that still say something, with flat indices of this view: row * columns + column
    counts: Counts = NO_COUNTS
    # Whether what is settled is beyond doubt: not while several frames may be right, or impressions contradict each
    # other
    sure: bool = True
    # That a square is occupied, by counts alone, where `probability` draws on completions, too; else None
    by_counts: NDArray[np.float32] | None = None

    def locate(self, x: float, y: float) -> tuple[int, int]:
        """Return the index [row, column] of the square in which a point (x, y) of the map frame lies."""
        # It is outside of the arrays, possibly negative, for a point outside of the view.
        return math.floor(y) - self.south, math.floor(x) - self.west

    def part(self, rows: slice, columns: slice) -> "MapView":
        """Return the view of some rows and columns alone, without the counts; its arrays are shared with this one."""
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
    """The map, which grows. Arrays are [row, column]; square (x, y) of the map frame lies at [y - south, x - west]."""

    def __init__(self) -> None:
        """Begin with an empty map about the square (0, 0) in which the robot woke: all is open and unseen."""
        self.west = self.south = -GROWTH_MARGIN
        shape = (2 * GROWTH_MARGIN, 2 * GROWTH_MARGIN)
        self.state = np.full(shape, OPEN, np.int8)
        self._odds = Odds(np.zeros(shape, np.float32))
        self.seen = np.zeros(shape, np.bool_)
        self.settled_by = np.full(shape, -1, np.int16)
        self._where = np.zeros((0, MAX_SAMPLED_SQUARES), np.int32)
        self._weight = np.zeros((0, MAX_SAMPLED_SQUARES), np.int16)
        self._low = np.zeros(0, np.int16)
        self._high = np.zeros(0, np.int16)
        self._fresh = np.zeros(0, np.bool_)
        self.overruled = 0
        self._observations: set[ObservationKey] = set()  # those since something was last withdrawn

    @property
    def logit(self) -> Logits:
        """The log odds (natural logarithm) that an open square is occupied, (rows, columns) float32."""
        return self._odds.logit

    def copy(self) -> "OccupancyMap":
        """Return an independent copy, to which more impressions can be added; neither changes the other."""
        other = copy(self)
        other.state, other.seen = self.state.copy(), self.seen.copy()
        other.settled_by, other._fresh = self.settled_by.copy(), self._fresh.copy()
        other._observations = self._observations.copy()
        return other

    def view(self, places: Iterable[XY] = (), margin: int = 2) -> MapView:
        """Return a snapshot of the part of the map that was seen, and of all that lies in sight of some places."""
        squares = [(math.floor(x), math.floor(y)) for x, y in places]
        for square in squares:
            self.make_room(*square)
        there = np.array([self.index(*square) for square in squares], np.int64).reshape(-1, 2)
        rows, columns = np.flatnonzero(self.seen.any(1)), np.flatnonzero(self.seen.any(0))
        top, left = np.vstack([there - SIGHT_RANGE, [rows[0], columns[0]]]).min(0).tolist()
        bottom, right = np.vstack([there + SIGHT_RANGE, [rows[-1], columns[-1]]]).max(0).tolist()
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
        """Return the fields that still say something, with flat indices of a part of the map."""
        rows, places = np.divmod(self._where, self.state.shape[1])
        where = np.where(self._weight > 0, (rows - top) * columns + places - left, 0).astype(np.int32)
        return Counts(where, self._weight, self._low, self._high)

    def index(self, x: int, y: int) -> tuple[int, int]:
        """Return the index [row, column] of a square (x, y) of the map frame."""
        # It is outside of the arrays, possibly negative, for a square outside of the map: see `make_room`.
        return y - self.south, x - self.west

    def squares(self, west: int, south: int, mask: Bools) -> Bools:
        """Return a small mask on the arrays of the map: (rows, columns) bool, like `state`."""
        whole = np.zeros(self.state.shape, np.bool_)
        row, column = self.index(west, south)
        whole[row : row + mask.shape[0], column : column + mask.shape[1]] = mask
        return whole

    # -- impressions ---------------------------------------------------------------------------------

    def misfits(self, samples: Samples, ranges: NDArray[np.int16], x: int, y: int) -> Bools:
        """Return which fields contradict the map if the robot stands on a square."""
        # The map grows to hold all in sight.
        self.make_room(x, y)
        low, wrong = ranges[:, 0] - samples.slack, np.zeros(len(ranges), np.bool_)
        misfits(self.state.ravel(), self._under(samples, x, y), samples.weight, low, ranges[:, 1].copy(), wrong)
        return wrong

    def clashes(self, samples: Samples, ranges: NDArray[np.int16], x: int, y: int, whether: bool = False) -> int:
        """Return how many fields, of an impression and all before, cannot be right if it was received on a square."""
        new = int(self.misfits(samples, ranges, x, y).sum())
        if new and whether:
            return new
        where = self._under(samples, x, y)
        single = (samples.weight.sum(1) == 1) & (samples.slack == 0) & ((ranges[:, 0] > 0) | (ranges[:, 1] <= 0))
        entry = samples.weight[single].argmax(1)  # all other squares of a larger field may lie under held objects
        state = self.state.ravel().copy()
        state[where[single, entry]] = np.where(ranges[single, 0] > 0, OCCUPIED, FREE)
        return new + misfits(state, *self._fields, np.zeros(len(self._low), np.bool_))

    def newly_occupied(self, samples: Samples, ranges: NDArray[np.int16], x: int, y: int) -> set[Square]:
        """Return the squares that an impression shows to be occupied, though counts of earlier ones forbid it."""
        self.make_room(x, y)
        where, state = self._under(samples, x, y), self.state.ravel().copy()
        single = (samples.weight.sum(1) == 1) & (samples.slack == 0) & (ranges[:, 0] > 0)
        shown = where[single, samples.weight[single].argmax(1)]
        state[shown] = OCCUPIED
        wrong = np.zeros(len(self._low), np.bool_)
        misfits(state, *self._fields, wrong)
        against = np.intersect1d(self._where[wrong][self._weight[wrong] > 0], shown)
        rows, columns = np.divmod(against, self.state.shape[1])
        return set(zip((columns + self.west).tolist(), (rows + self.south).tolist(), strict=True))

    def observe(self, samples: Samples, ranges: NDArray[np.int16], x: int, y: int, number: int) -> None:
        """Add one impression to the map."""
        arrays = (samples.columns, samples.rows, samples.weight, ranges)
        seen_here: ObservationKey = (x, y, *(array.tobytes() for array in arrays))
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

    def withdraw(self, squares: Ints) -> None:
        """Forget what was settled of some squares, and all fields that cover one of them; the squares are open then."""
        self._observations.clear()
        doubtful = np.zeros(self.state.size, np.bool_)
        doubtful[squares] = True
        self.state.ravel()[squares] = OPEN
        self._odds = self._odds.after(Forgotten(squares))
        self.settled_by.ravel()[squares] = -1
        touched = doubtful[self._where] & (self._weight > 0)
        self._keep(np.logical_not(np.logical_or.reduce(touched, axis=1)))

    def withdraw_patch(self, patch: MapPatch) -> None:
        """Forget what was settled of the squares of a patch; see `withdraw`."""
        self.withdraw(np.flatnonzero(self.squares(*patch)).astype(np.int32))

    def stand(self, x: int, y: int, number: int) -> None:
        """Settle the square on which the robot woke as free, unless it was settled before: its own image hides it."""
        row, column = self.index(x, y)
        if self.state[row, column] == OPEN:
            self.state[row, column], self.settled_by[row, column] = FREE, number
            self._fresh[:] = True  # the fields that cover it may settle more now
        self.seen[row, column] = True

    def declare(self, mask: Bools, value: int, number: int) -> None:
        """Settle squares by other knowledge than counts, for example the place of an object that was pushed."""
        self.withdraw(np.flatnonzero(mask).astype(np.int32))
        self.state[mask] = value
        self.settled_by[mask] = number

    def declare_patch(self, patch: MapPatch, value: int, number: int) -> None:
        """Settle the squares of a patch by other knowledge than counts; see `declare`."""
        self.declare(self.squares(*patch), value, number)

    def uncover(self, lay: MapPatch, now: MapPatch, number: int) -> None:
        """Open what was declared floor under a thing that was taken, where it has gone and another thing may reach in.

        lay, now : the squares where it was taken and those that it covers now. number : of the declaration.
        """
        # Things may share squares: what stands right beside where it lay may reach into the squares at that rim.
        own = self.squares(*lay)
        beside = with_edge_neighbours((self.state == OCCUPIED) & ~own)
        left = own & beside & (self.settled_by == number) & (self.state == FREE) & ~self.squares(*now)
        if left.any():
            self.withdraw(np.flatnonzero(left).astype(np.int32))

    # -- solving ---------------------------------------------------------------------------------

    def window(self, west: int, south: int, shape: tuple[int, ...]) -> NDArray[np.int8]:
        """Return the states of a part of the map, (rows, columns) int8, row 0 in the south; a copy."""
        row, column = self.index(west, south)
        part = np.full(shape, OPEN, np.int8)
        rows = slice(max(-row, 0), max(len(self.state) - row, 0))
        columns = slice(max(-column, 0), max(self.state.shape[1] - column, 0))
        there = part[rows, columns]
        there[:] = self.state[max(row, 0) :, max(column, 0) :][: there.shape[0], : there.shape[1]]
        return part

    def supposing(self, squares: Iterable[Square]) -> "OccupancyMap":
        """Return the map as if those of some squares that are more likely free than occupied were free."""
        other = copy(self)
        other.state = self.state.copy()
        for x, y in squares:
            row, column = self.index(x, y)
            inside = 0 <= row < self.state.shape[0] and 0 <= column < self.state.shape[1]
            if inside and self.state[row, column] == OPEN and self.logit[row, column] < 0:
                other.state[row, column] = FREE
        return other

    @property
    def _fields(self) -> tuple[Ints, NDArray[np.int16], NDArray[np.int16], NDArray[np.int16]]:
        """The fields that still say something, as the kernels take them: where, weight, low, high."""
        return self._where, self._weight, self._low, self._high

    def _informative(self) -> Bools:
        """Return which fields still say something of open squares, (n,) bool, in the order of the fields."""
        _, weight, low, high = remaining_counts(self.state.ravel(), *self._fields)
        return (weight > 0) & ((low > 0) | (high < weight))

    def _keep(self, rows: Bools) -> None:
        """Drop all fields but those of a mask; their order stays. rows : (n,) bool, one a field, True to keep it."""
        self._where, self._weight = self._where[rows], self._weight[rows]
        self._low, self._high, self._fresh = self._low[rows], self._high[rows], self._fresh[rows]

    # -- growth ----------------------------------------------------------------------------

    def _under(self, samples: Samples, x: int, y: int) -> Ints:
        """Return the flat indices on the map of the squares sampled from square (x, y), (160, 16) int32."""
        columns = self.state.shape[1]
        answer: Ints = (samples.rows + (y - self.south)) * columns + samples.columns + (x - self.west)
        return answer

    def make_room(self, x: int, y: int) -> None:
        """Grow the arrays until all that can be seen from square (x, y) of the map frame fits in."""
        row, column = self.index(x, y)
        rows, columns = self.state.shape
        south, west = max(0, SIGHT_RANGE - row), max(0, SIGHT_RANGE - column)
        north, east = max(0, row + SIGHT_RANGE + 1 - rows), max(0, column + SIGHT_RANGE + 1 - columns)
        if south or west or north or east:
            self._grow(*(n + GROWTH_MARGIN if n else 0 for n in (south, north, west, east)))

    def _grow(self, south: int, north: int, west: int, east: int) -> None:
        """Add so many rows (south, north) and columns (west, east) of open, unseen squares on each side."""
        rows, columns = np.divmod(self._where, self.state.shape[1])
        widths = ((south, north), (west, east))
        self.state = np.pad(self.state, widths, constant_values=OPEN)
        self._odds = self._odds.after(Grown(widths))
        self.seen = np.pad(self.seen, widths)
        self.settled_by = np.pad(self.settled_by, widths, constant_values=-1)
        self.south, self.west = self.south - south, self.west - west
        self._where = ((rows + south) * self.state.shape[1] + columns + west).astype(np.int32)


def _fill_gaps(probability: NDArray[np.float32], seen: Bools) -> None:
    """Mark squares that no field happened to sample, though three edge neighbours were seen, as seen; in place."""
    known = np.pad(seen, 1).astype(np.float32)
    likely = np.pad(np.where(seen, probability, 0), 1)
    count, total = (a[:-2, 1:-1] + a[2:, 1:-1] + a[1:-1, :-2] + a[1:-1, 2:] for a in (known, likely))
    gaps = ~seen & (count >= 3)
    probability[gaps] = total[gaps] / count[gaps]
    seen |= gaps
