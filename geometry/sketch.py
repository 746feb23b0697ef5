"""Pictures that agree with counts: of a raster of which only the counts under fields are known, the simple ones.

A picture costs 1 for each edge between an occupied and a free square, and more for each square by which a field's count
is wrong. Pictures are drawn with a probability that falls with their cost.

Source: Geman and Geman (1984), simulated annealing and the Gibbs sampler on an Ising prior. Beside single squares two
squares of one field are exchanged, which leaves its count as it is.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from geometry.compiled import compiled

FREE, FULL, DRAWN, UNSEEN = 0, 1, 2, 3
EDGE, CORNER = 0.4, 0.8
WRONG = 4.0  # edges that a square too many or too few under a field is worth
COLD = 2.0
SWEEPS = 3  # between two pictures
NEVER = 9.0  # a change that is e to this power times less likely than its contrary is not tried


def _price(pattern: int) -> float:
    """What four squares about a point cost: half of each edge between two of them, and each corner."""
    a, b, c, d = (pattern >> k & 1 for k in range(4))
    edges = (a != b) + (c != d) + (a != c) + (b != d)
    return EDGE * edges / 2 + CORNER * (2 if edges == 4 else (a + b + c + d) % 2)


PRICES = np.array([_price(pattern) for pattern in range(16)])


class Counts(NamedTuple):
    """What is known of the squares under fields.

    where : (n, m) int32, flat indices of the squares of each field. weight : (n, m) int16, how often each counts; 0 is
    padding. low, high : (n,) int16, the least and the greatest count.
    """

    where: NDArray[np.int32]
    weight: NDArray[np.int16]
    low: NDArray[np.int16]
    high: NDArray[np.int16]

    def of(self, fields: NDArray[np.int64]) -> "Counts":
        """What is known under some of the fields, by number."""
        return Counts(self.where[fields], self.weight[fields], self.low[fields], self.high[fields])


def pictures(
    ground: NDArray[np.int8],
    counts: Counts,
    first: NDArray[np.int8],
    number: int,
    warming: int,
    hot: float = 0.5,
    seed: int = 20031,
) -> NDArray[np.int8]:
    """(number, rows, columns) int8, 1 where a square is occupied: so many pictures that agree with the counts.

    Parameters
    ----------
    ground : (rows, columns) int8. FREE, FULL, DRAWN (to be found) or UNSEEN (not part of the picture, drawn as 0).
    counts : of squares of the ground. first : the picture to begin with. warming : sweeps until the first one is taken,
    from the inverse temperature `hot` to COLD. seed : from 1 to 2^31 - 2. The same arguments give the same pictures.
    """
    image = np.where(ground == DRAWN, first, ground == FULL).astype(np.int8)
    used = (counts.weight > 0) & (ground.ravel()[counts.where] == DRAWN)
    field, entry = np.nonzero(used)
    order = np.argsort(counts.where[field, entry], kind="stable")
    field, entry = field[order].astype(np.int64), entry[order]
    squares, begins = np.unique(counts.where[field, entry], return_index=True)
    ends = np.append(begins, len(field))
    taken = np.empty((number, *ground.shape), np.int8)
    count = (counts.weight * image.ravel()[counts.where]).sum(1)
    slopes = np.append(np.linspace(hot, COLD, max(warming, 1)), np.full(SWEEPS * (number - 1), COLD))
    _draw(
        PRICES,
        np.array(ground, order="C").ravel(),  # a copy, for a kernel is compiled once more for arrays that are read only
        image.ravel(),
        squares.astype(np.int64),
        _ranks(squares, ground.size),
        ends.astype(np.int64),
        field,
        counts.weight[field, entry].astype(np.int64),
        counts.where.astype(np.int64),
        used,
        np.stack([counts.low, counts.high, count], axis=1).astype(np.int64),
        slopes,
        taken.reshape(number, -1),
        ground.shape[1],
        seed,
    )
    return taken


def _ranks(squares: NDArray[np.int32], size: int) -> NDArray[np.int64]:
    """For each flat index where among the squares it is."""
    ranks = np.zeros(size, np.int64)
    ranks[squares] = np.arange(len(squares))
    return ranks


@compiled
def _draw(price, ground, image, squares, ranks, ends, field, share, where, used, fields, slopes, taken, columns, seed):  # type: ignore[no-untyped-def]
    chance = seed
    first = len(slopes) - SWEEPS * (len(taken) - 1) - 1
    for sweep in range(len(slopes)):
        slope = slopes[sweep]
        for k in range(len(squares)):
            chance = (chance * 48271) % 2147483647
            change = _change(price, ground, image, squares, ends, field, share, fields, columns, k)
            if change <= 0 or (slope * change <= NEVER and chance <= 2147483647 * np.exp(-slope * change)):
                _flip(image, squares, ends, field, share, fields, k)
            chance = (chance * 48271) % 2147483647
            one = field[ends[k] + chance % (ends[k + 1] - ends[k])]
            chance = (chance * 48271) % 2147483647
            entry = chance % where.shape[1]
            if not used[one, entry] or image[where[one, entry]] == image[squares[k]]:
                continue
            other = ranks[where[one, entry]]
            change = _change(price, ground, image, squares, ends, field, share, fields, columns, k)
            _flip(image, squares, ends, field, share, fields, k)
            change += _change(price, ground, image, squares, ends, field, share, fields, columns, other)
            chance = (chance * 48271) % 2147483647
            if change <= 0 or (slope * change <= NEVER and chance <= 2147483647 * np.exp(-slope * change)):
                _flip(image, squares, ends, field, share, fields, other)
            else:
                _flip(image, squares, ends, field, share, fields, k)
        if sweep >= first and (sweep - first) % SWEEPS == 0:
            for k in range(len(image)):  # an assignment in one would compile three seconds longer
                taken[(sweep - first) // SWEEPS, k] = image[k]


@compiled
def _change(price, ground, image, squares, ends, field, share, fields, columns, k):  # type: ignore[no-untyped-def]
    """By how much the picture becomes dearer when square k changes."""
    square = squares[k]
    more = 1 - 2 * image[square]
    change = 0.0
    for one in range(4):
        corner = square - (one % 2) - (one // 2) * columns  # the lower left of four squares about one of its corners
        if corner < 0 or corner % columns == columns - 1 or corner + columns + 1 >= len(image):
            continue
        if square % columns == 0 and one % 2 == 1:
            continue
        pattern, hidden = 0, False
        for other in range(4):
            beside = corner + other % 2 + (other // 2) * columns
            hidden |= ground[beside] == UNSEEN
            pattern += image[beside] << other
        if not hidden:
            change += price[pattern ^ (1 << one)] - price[pattern]
    for i in range(ends[k], ends[k + 1]):
        low, high, count = fields[field[i]]
        after = count + share[i] * more
        change += WRONG * (max(low - after, after - high, 0) - max(low - count, count - high, 0))
    return change


@compiled
def _flip(image, squares, ends, field, share, fields, k):  # type: ignore[no-untyped-def]
    """Change square k."""
    square = squares[k]
    for i in range(ends[k], ends[k + 1]):
        fields[field[i], 2] += share[i] * (1 - 2 * image[square])
    image[square] = 1 - image[square]


class Blobs(NamedTuple):
    """The edge-connected occupied parts of a picture.

    labels : (rows, columns) int32, 0 for none, n for the part at [n - 1] of the others. area : squares. outward : sides
    of its squares beyond which nothing was seen. spread : sum of its principal moments, by the square of the area (a
    square has 1/6, a disc 1/2 pi). lengthy : the difference of the principal moments, by their sum (0: as wide
    as long).
    """

    labels: NDArray[np.int32]
    area: NDArray[np.int64]
    outward: NDArray[np.int64]
    spread: NDArray[np.float64]
    lengthy: NDArray[np.float64]


def blobs(image: NDArray[np.int8], ground: NDArray[np.int8]) -> Blobs:
    """The parts of one picture.

    >>> found = blobs(np.pad(np.ones((3, 3), np.int8), 2), np.full((7, 7), DRAWN, np.int8))
    >>> found.area.tolist(), found.outward.tolist(), (6 * found.spread).round(6).tolist(), found.lengthy.tolist()
    ([9], [0], [1.0], [0.0])
    """
    labels = np.zeros(image.shape, np.int32)
    sums = np.zeros((image.size // 2 + 2, 7))
    number = _parts(np.ascontiguousarray(image), np.ascontiguousarray(ground), labels, sums)
    n, x, y, xx, yy, xy, outward = sums[1 : number + 1].T
    east, north, cross = xx / n - (x / n) ** 2 + 1 / 12, yy / n - (y / n) ** 2 + 1 / 12, xy / n - x * y / n**2
    return Blobs(
        labels,
        n.astype(np.int64),
        outward.astype(np.int64),
        (east + north) / n,
        np.hypot(east - north, 2 * cross) / (east + north),
    )


@compiled
def _parts(image, ground, labels, sums):  # type: ignore[no-untyped-def]
    rows, columns = image.shape
    waiting = np.empty((rows * columns, 2), np.int64)
    number = 0
    for row in range(rows):
        for column in range(columns):
            if image[row, column] != 1 or labels[row, column] != 0:
                continue
            number += 1
            labels[row, column] = number
            waiting[0, 0], waiting[0, 1] = row, column
            left = 1
            while left > 0:
                left -= 1
                r, c = waiting[left, 0], waiting[left, 1]
                sums[number, 0] += 1
                sums[number, 1] += c
                sums[number, 2] += r
                sums[number, 3] += c * c
                sums[number, 4] += r * r
                sums[number, 5] += c * r
                for p, q in ((r + 1, c), (r - 1, c), (r, c + 1), (r, c - 1)):
                    if p < 0 or q < 0 or p >= rows or q >= columns or ground[p, q] == UNSEEN:
                        sums[number, 6] += 1
                    elif image[p, q] == 1 and labels[p, q] == 0:
                        labels[p, q] = number
                        waiting[left, 0], waiting[left, 1] = p, q
                        left += 1
    return number
