"""Gibbs sampling of rasters that agree with counts: samples of a map of which only counts under fields are known.

A field is a set of squares that the robot sees as one; its count says how many of them are occupied. A raster costs
EDGE_COST for each edge between an occupied and a free square, CORNER_COST for each corner of their outline, and
COUNT_ERROR_COST for each square by which a field's count is wrong. Rasters are sampled with a probability that falls
with their cost: each is changed a little, many times over, and a change is kept with the probability that its cost
allows.

In the kernels a drawn square (one whose state is sampled) has a number k, from 0 by row and column, and a flat index,
row * columns + column, in the raster with a frame of one unseen square on each side. Neighbours are numbered as in
NEIGHBOUR_STEPS; a set of them is a number whose bit n stands for neighbour n.

Source: Geman and Geman (1984), simulated annealing and the Gibbs sampler on an Ising prior. Besides the flip of a
single square there are two more moves. Two squares of one field are exchanged, which leaves its count as it is. A
stretch of a straight outline is moved by one square, alone or with the outline opposite, so that a wall moves without
being taken down.
"""

from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from utak.geometry.counts.settle import FREE, OCCUPIED
from utak.geometry.kernels.jit import bare

# Values of the ground, besides FREE and OCCUPIED, which settle.py fixes for the squares that counts settle.
DRAWN = 2  # a square whose state is drawn
UNSEEN_SQUARE = 3  # a square that is no part of the raster; drawn as 0

# Costs are negative log probabilities at the inverse temperature 1. EDGE_COST and CORNER_COST: docs/results/tuning.md;
# of the other numbers no measurement is on record.
EDGE_COST = 0.3  # of an edge between an occupied and a free square
CORNER_COST = 1.5  # of a corner of their outline
COUNT_ERROR_COST = 4.0  # of each square by which a field's count is wrong
FINAL_INVERSE_TEMPERATURE = 2.5  # at which a sample is taken

# The moves of edges; no measurement on record.
MAX_MOVED_THICKNESS = 4  # squares, of a strip that is moved as a whole
MAX_MOVED_LENGTH = 60  # squares, of an edge that is moved at once
EDGE_MOVE_INTERVAL = 4  # a move of the edge is tried at one in so many squares at an outline

# Neighbours as steps (rows, columns); the numbers of opposite ones add to 7.
NEIGHBOUR_STEPS = ((-1, -1), (-1, 0), (-1, 1), (0, -1), (0, 1), (1, -1), (1, 0), (1, 1))
ACROSS = (1, 6, 3, 4)  # by side of a square: the neighbour beyond the edge there
ALONG_EDGE = (4, 4, 6, 6)  # by side of a square: the next neighbour on the same edge

LEHMER_MULTIPLIER, LEHMER_MODULUS = 48271, 2147483647  # of the random numbers; Park and Miller (1988)
THRESHOLD_COUNT = 1024  # random thresholds, a power of two; convention
RANK_FIXED, RANK_UNSEEN = -1, -2  # in `_Raster.rank`: squares that are not drawn
Bits = NDArray[np.integer[Any]]
__all__ = ["FREE", "OCCUPIED"]


class Counts(NamedTuple):
    """The counts of occupied squares under n fields; a field is a set of squares that the robot sees as one."""

    # (n, m) int32, flat indices (row * columns + column) of the squares of each field, in the ground without frame
    where: NDArray[np.int32]
    weight: NDArray[np.int16]  # (n, m) int16, how often each square counts; 0 is padding
    low: NDArray[np.int16]  # (n,) int16, the least and the greatest count, by weight
    high: NDArray[np.int16]

    def of(self, fields: NDArray[np.int64]) -> "Counts":
        """Return the counts of some of the fields, given by number (index), in the order of these; new arrays."""
        return Counts(self.where[fields], self.weight[fields], self.low[fields], self.high[fields])


class _Raster(NamedTuple):
    """A raster with a frame of one unseen square, and the n squares of it that are drawn."""

    squares: NDArray[np.int64]  # (n,) int64, their flat indices in the framed raster, ascending
    # (size,) int32, by flat index, which of them a square is; RANK_FIXED or RANK_UNSEEN if none
    rank: NDArray[np.int32]
    # (n,) int32, as bits, the corners of each square about which all four squares were seen: 1 north-east, 2
    # north-west, 4 south-east, 8 south-west
    shown_corners: NDArray[np.int32]
    around: NDArray[np.int64]  # (8,) int64, flat steps to the neighbours, in the order of NEIGHBOUR_STEPS
    near: NDArray[np.int32]  # (n, 8) int32, which of them the neighbours of each square are; n for one that is none
    # (n + 1,), (entries,) and (entries,) int32: the fields of square k are field[ends[k]:ends[k + 1]], and how often
    # each counts it
    ends: NDArray[np.int32]
    field: NDArray[np.int32]
    share: NDArray[np.int32]
    where: NDArray[np.int32]  # (fields, m) int32, flat indices of the squares of each field, in the framed raster
    members: NDArray[np.int32]  # (fields, m) int32, which of the n squares these are; negative for one that is none
    limits: NDArray[np.int32]  # (fields, 2) int32, the least and the greatest count


def pictures(
    ground: NDArray[np.int8], counts: Counts, first: NDArray[np.int8], sweeps: int, hot: float, seed: int = 20031
) -> NDArray[np.int8]:
    """Return sampled rasters that agree with counts, (m, rows, columns) int8, 1 where a square is occupied, else 0."""
    framed = np.pad(ground, 1, constant_values=UNSEEN_SQUARE)
    raster = _raster(framed, counts)
    images_framed = np.where(framed == DRAWN, np.pad(first, ((0, 0), (1, 1), (1, 1))), framed == OCCUPIED).astype(
        np.int8
    )
    images = images_framed.reshape(len(first), -1)
    count = np.ascontiguousarray((images[:, raster.where] * counts.weight).sum(2, dtype=np.int32))
    codes = np.empty((len(first), len(raster.squares) + 1), np.int32)
    flipped = np.zeros(2 * MAX_MOVED_LENGTH + 2, np.int32)
    inverse_temperatures = np.linspace(hot, FINAL_INVERSE_TEMPERATURE, sweeps)
    sample_all(raster, _flip_costs(), _thresholds(), images, codes, count, flipped, inverse_temperatures, seed)
    return images_framed[:, 1:-1, 1:-1]


def costs(
    images: NDArray[np.int8], ground: NDArray[np.int8], counts: Counts, edge_cost: float = EDGE_COST
) -> NDArray[np.float64]:
    """Return the cost of each raster, (m,) float64."""
    # Its edges, its corners, and the squares by which counts are wrong.
    seen = ground != UNSEEN_SQUARE
    all_seen = seen[:-1, :-1] & seen[1:, :-1] & seen[:-1, 1:] & seen[1:, 1:]
    points = (
        _corner_cost(images[:, :-1, :-1], images[:, :-1, 1:], images[:, 1:, :-1], images[:, 1:, 1:], edge_cost)
        * all_seen
    )
    count = (images.reshape(len(images), -1)[:, counts.where] * counts.weight).sum(2)
    count_error = np.maximum(counts.low - count, 0) + np.maximum(count - counts.high, 0)
    result: NDArray[np.float64] = points.sum((1, 2)) + COUNT_ERROR_COST * count_error.sum(1)
    return result


def _raster(framed: NDArray[np.int8], counts: Counts) -> _Raster:
    """Return the squares of a framed ground that are drawn (sampled), with their neighbours and fields, as arrays."""
    columns = framed.shape[1]
    row, column = np.divmod(counts.where, columns - 2)
    where = (row + 1) * columns + column + 1
    flat = framed.ravel()
    used = (counts.weight > 0) & (flat[where] == DRAWN)
    field, entry = np.nonzero(used)
    order = np.argsort(where[field, entry], kind="stable")
    field, entry = field[order], entry[order]
    squares = np.flatnonzero(flat == DRAWN)
    ends = np.searchsorted(where[field, entry], np.append(squares, len(flat)))
    rank = np.where(flat == UNSEEN_SQUARE, np.int32(RANK_UNSEEN), np.int32(RANK_FIXED))
    rank[squares] = np.arange(len(squares))
    around = np.array([rows * columns + across for rows, across in NEIGHBOUR_STEPS])
    near = rank[squares[:, None] + around]
    return _Raster(
        squares,
        rank,
        _shown_corners(flat != UNSEEN_SQUARE, squares, columns),
        around,
        np.where(near < 0, np.int32(len(squares)), near),
        ends.astype(np.int32),
        field.astype(np.int32),
        counts.weight[field, entry].astype(np.int32),
        where.astype(np.int32),
        np.where(used, rank[where], np.int32(RANK_FIXED)),
        np.stack([counts.low, counts.high], axis=1).astype(np.int32),
    )


def _shown_corners(seen: NDArray[np.bool_], squares: NDArray[np.int64], columns: int) -> NDArray[np.int32]:
    """Return as bits, (n,) int32, the corners of each square about which all four squares were seen."""
    shown = np.zeros(len(squares), np.int32)
    for point in range(4):
        corner = squares - point % 2 - point // 2 * columns  # the lower left of the four squares about it
        all_seen = seen[corner] & seen[corner + 1] & seen[corner + columns] & seen[corner + columns + 1]
        shown |= all_seen.astype(np.int32) << point
    return shown


@cache
def _flip_costs() -> NDArray[np.float64]:
    """Return the change of the cost, counts left out, when a square flips: (16, 256, 2) float64, flat."""
    shown_corners, around, was = np.ogrid[:16, :256, :2]
    change = np.zeros((16, 256, 2))
    for point in range(4):
        across, rows = 1 - 2 * (point % 2), 1 - 2 * (point // 2)
        horizontal, vertical, diagonal = (
            around >> NEIGHBOUR_STEPS.index(at) & 1 for at in ((0, across), (rows, 0), (rows, across))
        )
        change += (shown_corners >> point & 1) * (
            _corner_cost(1 - was, horizontal, vertical, diagonal) - _corner_cost(was, horizontal, vertical, diagonal)
        )
    return change.ravel()


def _corner_cost(
    square: Bits, horizontal: Bits, vertical: Bits, diagonal: Bits, edge_cost: float = EDGE_COST
) -> NDArray[np.float64]:
    """Return the cost of four squares about a point: half of each edge between two of them, and each corner."""
    edges = (square ^ horizontal) + (vertical ^ diagonal) + (square ^ vertical) + (horizontal ^ diagonal)
    corners = np.where(edges == 4, 2, (square + horizontal + vertical + diagonal) % 2)
    result: NDArray[np.float64] = edge_cost * edges / 2 + CORNER_COST * corners
    return result


@cache
def _thresholds() -> NDArray[np.float64]:
    """Return equally likely thresholds (THRESHOLD_COUNT,) float64."""
    # Rises of the cost allowed at inverse temperature 1.
    result: NDArray[np.float64] = -np.log((np.arange(THRESHOLD_COUNT) + 0.5) / THRESHOLD_COUNT)
    return result


@bare
def sample_all(raster, flip_costs, thresholds, images, codes, counts, flipped, inverse_temperatures, seed) -> None:  # type: ignore[no-untyped-def]
    """Change rasters, in place, until they are simple and agree with the counts; nothing is returned."""
    for number in range(images.shape[0]):
        random = seed * (number + 1) % LEHMER_MODULUS
        sample(
            raster,
            flip_costs,
            thresholds,
            images[number],
            codes[number],
            counts[number],
            flipped,
            inverse_temperatures,
            random,
        )


@bare
def sample(raster, flip_costs, thresholds, image, codes, counts, flipped, inverse_temperatures, random) -> None:  # type: ignore[no-untyped-def]
    """Change one raster, in place, square by square, in one sweep for each inverse temperature; nothing is returned."""
    squares, rank, shown_corners, around, near, ends, field, share, _, members, limits = raster
    count_error = 0
    for f in range(limits.shape[0]):
        count_error += max(limits[f, 0] - counts[f], counts[f] - limits[f, 1], 0)
    for k in range(squares.shape[0]):
        codes[k] = (shown_corners[k] << 9) + image[squares[k]]
        for n in range(8):
            codes[k] |= (image[squares[k] + around[n]] == 1) << (n + 1)
    for sweep in range(inverse_temperatures.shape[0]):
        temperature = 1 / inverse_temperatures[sweep]
        for k in range(squares.shape[0]):
            # flip the square alone
            random = random * LEHMER_MULTIPLIER % LEHMER_MODULUS
            threshold = thresholds[random & THRESHOLD_COUNT - 1] * temperature
            cost = flip_costs[codes[k]]
            if cost <= threshold + COUNT_ERROR_COST * count_error:
                more = 1 - 2 * (codes[k] & 1)
                worse = count_error_change(k, more, ends, field, share, limits, counts)
                if cost + COUNT_ERROR_COST * worse <= threshold:
                    update_counts(k, more, ends, field, share, counts)
                    flip(k, near, codes)
                    image[squares[k]] ^= 1
                    count_error += worse
            # exchange it with another square of the same field
            if ends[k] < ends[k + 1]:
                f = field[ends[k] + ((random >> 15) * (ends[k + 1] - ends[k]) >> 16)]
                random = random * LEHMER_MULTIPLIER % LEHMER_MODULUS
                other = members[f, (random & 65535) * members.shape[1] >> 16]
                if other >= 0 and (codes[other] ^ codes[k]) & 1:
                    threshold = thresholds[random >> 17 & THRESHOLD_COUNT - 1] * temperature
                    if (
                        cost_of_two_flips(near, flip_costs, codes, k, other)
                        <= threshold + COUNT_ERROR_COST * count_error
                    ):
                        flipped[0], flipped[1] = k, other
                        count_error += try_flips(
                            raster, flip_costs, image, codes, counts, count_error, threshold, flipped, 2
                        )
            # move the edge on which it lies
            outline = codes[k] >> 1 & 255
            if outline != 0 and outline != 255 and (random >> 27) % EDGE_MOVE_INTERVAL == 0:
                random = random * LEHMER_MULTIPLIER % LEHMER_MODULUS
                number = collect_edge_move(squares, rank, around, image, k, random, flipped)
                threshold = thresholds[random >> 12 & THRESHOLD_COUNT - 1] * temperature
                count_error += try_flips(
                    raster, flip_costs, image, codes, counts, count_error, threshold, flipped, number
                )


@bare
def cost_of_two_flips(near, flip_costs, codes, k, other) -> float:  # type: ignore[no-untyped-def]
    """Return the change of the cost, counts left out, when two squares flip; nothing is changed."""
    code = codes[other]  # once k is changed
    for n in range(8):
        code ^= (near[k, n] == other) << (8 - n)
    return flip_costs[codes[k]] + flip_costs[code]  # type: ignore[no-any-return]


@bare
def try_flips(raster, flip_costs, image, codes, counts, count_error, threshold, flipped, number) -> int:  # type: ignore[no-untyped-def]
    """Flip the first `number` squares of `flipped` together, if the cost does not rise above the threshold."""
    squares, _, _, _, near, ends, field, share, _, _, limits = raster
    cost, worse = 0.0, 0
    for m in range(number):
        cost += flip_costs[codes[flipped[m]]]
        flip(flipped[m], near, codes)
    if cost <= threshold + COUNT_ERROR_COST * count_error:
        for m in range(number):
            k = flipped[m]
            more = 2 * (codes[k] & 1) - 1
            worse += count_error_change(k, more, ends, field, share, limits, counts)
            update_counts(k, more, ends, field, share, counts)
        if cost + COUNT_ERROR_COST * worse <= threshold:
            for m in range(number):
                image[squares[flipped[m]]] ^= 1
            return worse
        for m in range(number):
            update_counts(flipped[m], 1 - 2 * (codes[flipped[m]] & 1), ends, field, share, counts)
    for m in range(number):
        flip(flipped[m], near, codes)
    return 0


@bare
def collect_edge_move(squares, rank, around, image, k, random, flipped) -> int:  # type: ignore[no-untyped-def]
    """List the squares that flip when the edge on one side of square k is moved beyond it; return how many they are."""
    side, here = random & 3, squares[k]
    across, along, look = around[ACROSS[side]], around[ALONG_EDGE[side]], image[here]
    if image[here + across] == look:
        return 0
    flipped[0], number = k, 1
    for way in range(2):
        step, bits = along * (1 - 2 * way), random >> (2 + 4 * way)
        most = MAX_MOVED_LENGTH if bits & 1 else bits >> 1 & 7
        square = here + step
        while (
            most > 0
            and number <= MAX_MOVED_LENGTH
            and rank[square] >= 0
            and image[square] == look != image[square + across]
        ):
            flipped[number] = rank[square]
            number, most, square = number + 1, most - 1, square + step
    if random >> 10 & 1:
        for m in range(number):
            square, thick = squares[flipped[m]] - across, 1
            while thick < MAX_MOVED_THICKNESS and image[square] == look and rank[square] != RANK_UNSEEN:
                square, thick = square - across, thick + 1
            if image[square] != look and rank[square] >= 0:
                flipped[number] = rank[square]
                number += 1
    return number


@bare
def flip(k, near, codes) -> None:  # type: ignore[no-untyped-def]
    """Flip a square in its code and in its neighbours' codes, but not in the raster, nor in the counts."""
    codes[k] ^= 1
    for n in range(8):
        codes[near[k, n]] ^= 1 << (8 - n)


@bare
def count_error_change(k, more, ends, field, share, limits, counts) -> int:  # type: ignore[no-untyped-def]
    """Return by how many squares more the counts are wrong when a square is counted once more, or once less."""
    worse = 0
    for i in range(ends[k], ends[k + 1]):
        f = field[i]
        before = counts[f]
        after = before + share[i] * more
        low, high = limits[f, 0], limits[f, 1]
        worse += max(low - after, after - high, 0) - max(low - before, before - high, 0)
    return worse


@bare
def update_counts(k, more, ends, field, share, counts) -> None:  # type: ignore[no-untyped-def]
    """Count a square once more, or once less, under each of its fields: as often as the field samples it."""
    for i in range(ends[k], ends[k + 1]):
        counts[field[i]] += share[i] * more
