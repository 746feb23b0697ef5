"""Pictures that agree with counts: of a raster of which only the counts under fields are known, the simple ones.

A picture costs EDGE for each edge between an occupied and a free square, CORNER for each corner of their outline, and
more for each square by which a field's count is wrong. Pictures are drawn with a probability that falls with their
cost: each is changed a little, many times over, and a change is kept with the probability that its cost allows.

Source: Geman and Geman (1984), simulated annealing and the Gibbs sampler on an Ising prior. Beside single squares two
squares of one field are exchanged, which leaves its count as it is; and a stretch of a straight outline is moved by one
square, alone or with what lies opposite, so that a wall moves without being taken down.
"""

from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from geometry.kernels.jit import bare

FREE, FULL, DRAWN, UNSEEN = 0, 1, 2, 3
EDGE, CORNER = 0.3, 1.5
WRONG = 4.0  # edges that a square too many or too few under a field is worth
COLD = 2.5  # the inverse temperature at which a picture is taken
THICKEST = 4  # squares of what is moved as a whole
LONGEST = 60  # squares of an edge that is moved at once
SELDOM = 4  # of so many squares at an outline one is asked whether it moves
AROUND = ((-1, -1), (-1, 0), (-1, 1), (0, -1), (0, 1), (1, -1), (1, 0), (1, 1))  # (rows, columns); opposites add to 7
SIDES = (1, 6, 3, 4)  # of them, those beyond an edge: the square across
ALONG = (4, 4, 6, 6)  # and the next one on the same edge
GENERATOR, MODULUS = 48271, 2147483647  # of random numbers; Park and Miller (1988)
LUCKS = 1024
SETTLED, HIDDEN = -1, -2
Bits = NDArray[np.integer[Any]]


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


class _Board(NamedTuple):
    """What pictures are drawn on: a raster with a frame of one unseen square, and n squares of it to be drawn.

    squares : (n,) int64, flat indices. rank : (size,) int32, which of them a square is; SETTLED or HIDDEN if none.
    shown : (n,) int32, the four points about a square that lie amid squares seen, as bits. around : (8,) int64, flat
    steps to the neighbours. ends, field, share : the fields of square k are field[ends[k]:ends[k + 1]], and how often
    each counts it. where : (fields, m) int32, flat indices. used : (fields, m) bool, those to be drawn. limits :
    (fields, 2) int32, the least and the greatest count.
    """

    squares: NDArray[np.int64]
    rank: NDArray[np.int32]
    shown: NDArray[np.int32]
    around: NDArray[np.int64]
    ends: NDArray[np.int32]
    field: NDArray[np.int32]
    share: NDArray[np.int32]
    where: NDArray[np.int32]
    used: NDArray[np.bool_]
    limits: NDArray[np.int32]


def pictures(
    ground: NDArray[np.int8], counts: Counts, first: NDArray[np.int8], sweeps: int, hot: float, seed: int = 20031
) -> NDArray[np.int8]:
    """(m, rows, columns) int8, 1 where a square is occupied: as many pictures, each begun with another.

    Parameters
    ----------
    ground : (rows, columns) int8. FREE, FULL, DRAWN (to be found) or UNSEEN (not part of the picture, drawn as 0).
    counts : of squares of the ground. first : (m, rows, columns) int8, the pictures to begin with. sweeps : over all
    squares, from the inverse temperature `hot` to COLD. seed : from 1 to 2^31 - 2. The same arguments give the same
    pictures.
    """
    framed = np.pad(ground, 1, constant_values=UNSEEN)
    board = _board(framed, counts)
    begun = np.where(framed == DRAWN, np.pad(first, ((0, 0), (1, 1), (1, 1))), framed == FULL).astype(np.int8)
    images = begun.reshape(len(first), -1)
    count = np.ascontiguousarray((images[:, board.where] * counts.weight).sum(2, dtype=np.int32))
    near = np.zeros((len(first), len(board.squares)), np.int32)
    moved = np.zeros(2 * LONGEST + 2, np.int32)
    slopes = np.linspace(hot, COLD, sweeps, dtype=np.float32)
    draw_all(board, _prices(), _lucks(), images, near, count, moved, slopes, seed)
    return begun[:, 1:-1, 1:-1]


def costs(
    images: NDArray[np.int8], ground: NDArray[np.int8], counts: Counts, edge: float = EDGE
) -> NDArray[np.float64]:
    """(m,): what each picture costs: its edges, its corners, and the squares by which counts are wrong.

    images : (m, rows, columns), as drawn. ground, counts : as they were drawn with. edge : what an edge costs; 0 where
    pictures of grounds of different sizes are compared, for a wall that goes on straight is what is to be expected.
    """
    seen = ground != UNSEEN
    amid = seen[:-1, :-1] & seen[1:, :-1] & seen[:-1, 1:] & seen[1:, 1:]
    points = _price(images[:, :-1, :-1], images[:, :-1, 1:], images[:, 1:, :-1], images[:, 1:, 1:], edge) * amid
    count = (images.reshape(len(images), -1)[:, counts.where] * counts.weight).sum(2)
    wrong = np.maximum(counts.low - count, 0) + np.maximum(count - counts.high, 0)
    answer: NDArray[np.float64] = points.sum((1, 2)) + WRONG * wrong.sum(1)
    return answer


def _board(framed: NDArray[np.int8], counts: Counts) -> _Board:
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
    rank = np.where(flat == UNSEEN, np.int32(HIDDEN), np.int32(SETTLED))
    rank[squares] = np.arange(len(squares))
    seen = flat != UNSEEN
    shown = np.zeros(len(squares), np.int32)
    for point in range(4):
        corner = squares - point % 2 - point // 2 * columns  # the lower left of the four squares about it
        amid = seen[corner] & seen[corner + 1] & seen[corner + columns] & seen[corner + columns + 1]
        shown |= amid.astype(np.int32) << point
    return _Board(
        squares,
        rank,
        shown,
        np.array([rows * columns + across for rows, across in AROUND]),
        ends.astype(np.int32),
        field.astype(np.int32),
        counts.weight[field, entry].astype(np.int32),
        where.astype(np.int32),
        used,
        np.stack([counts.low, counts.high], axis=1).astype(np.int32),
    )


@cache
def _prices() -> NDArray[np.float32]:
    """(16, 256, 2), flat: by how much a picture becomes dearer when a square changes.

    By the points about it that are shown, by its neighbours, and by what it was.
    """
    shown, around, was = np.ogrid[:16, :256, :2]
    change = np.zeros((16, 256, 2))
    for point in range(4):
        across, rows = 1 - 2 * (point % 2), 1 - 2 * (point // 2)
        beside, over, beyond = (around >> AROUND.index(at) & 1 for at in ((0, across), (rows, 0), (rows, across)))
        change += (shown >> point & 1) * (_price(1 - was, beside, over, beyond) - _price(was, beside, over, beyond))
    return change.astype(np.float32).ravel()


def _price(square: Bits, beside: Bits, over: Bits, beyond: Bits, edge: float = EDGE) -> NDArray[np.float64]:
    """What four squares about a point cost: half of each edge between two of them, and each corner."""
    edges = (square ^ beside) + (over ^ beyond) + (square ^ over) + (beside ^ beyond)
    corners = np.where(edges == 4, 2, (square + beside + over + beyond) % 2)
    answer: NDArray[np.float64] = edge * edges / 2 + CORNER * corners
    return answer


@cache
def _lucks() -> NDArray[np.float32]:
    """(LUCKS,), equally likely: how much dearer a picture may become at the inverse temperature 1."""
    return (-np.log((np.arange(LUCKS) + 0.5) / LUCKS)).astype(np.float32)


@bare
def draw_all(board, prices, lucks, images, near, counts, moved, slopes, seed):  # type: ignore[no-untyped-def]
    """Change pictures, (m, size) int8, until they are simple and agree with the counts.

    near : (m, n) int32, gets the neighbours of each square to be drawn, as bits. counts : (m, fields) int32, those of
    the pictures. moved : (2 LONGEST + 2,) int32, for use.
    """
    for number in range(images.shape[0]):
        chance = seed * (number + 1) % MODULUS
        draw(board, prices, lucks, images[number], near[number], counts[number], moved, slopes, chance)


@bare
def draw(board, prices, lucks, image, near, counts, moved, slopes, chance):  # type: ignore[no-untyped-def]
    """Change one picture, square by square, so many times over as there are slopes."""
    squares, rank, shown, around, ends, field, share, where, used, limits = board
    wrong = 0
    for f in range(limits.shape[0]):
        wrong += max(limits[f, 0] - counts[f], counts[f] - limits[f, 1], 0)
    for k in range(squares.shape[0]):
        for n in range(8):
            near[k] |= image[squares[k] + around[n]] << n
    for sweep in range(slopes.shape[0]):
        warmth = 1 / slopes[sweep]
        for k in range(squares.shape[0]):
            # the square alone
            chance = chance * GENERATOR % MODULUS
            square, luck = squares[k], lucks[chance & LUCKS - 1] * warmth
            if prices[(shown[k] << 9) + (near[k] << 1) + image[square]] <= luck + WRONG * wrong:
                more = 1 - 2 * image[square]
                worse = worsening(k, more, ends, field, share, limits, counts)
                if prices[(shown[k] << 9) + (near[k] << 1) + image[square]] + WRONG * worse <= luck:
                    recount(k, more, ends, field, share, counts)
                    tip(square, rank, around, image, near)
                    wrong += worse
            # and another one of the same field
            if ends[k] < ends[k + 1]:
                f = field[ends[k] + ((chance >> 15) * (ends[k + 1] - ends[k]) >> 16)]
                chance = chance * GENERATOR % MODULUS
                entry = (chance & 65535) * where.shape[1] >> 16
                if used[f, entry] and image[where[f, entry]] != image[square]:
                    other = rank[where[f, entry]]
                    luck = lucks[chance >> 17 & LUCKS - 1] * warmth
                    if price_of_both(squares, shown, around, prices, image, near, k, other) <= luck + WRONG * wrong:
                        moved[0], moved[1] = k, other
                        wrong += change(board, prices, image, near, counts, wrong, luck, moved, 2)
            # and the edge at which it lies
            if near[k] != 0 and near[k] != 255 and (chance >> 27) % SELDOM == 0:
                chance = chance * GENERATOR % MODULUS
                number = edge(squares, rank, around, image, k, chance, moved)
                luck = lucks[chance >> 12 & LUCKS - 1] * warmth
                wrong += change(board, prices, image, near, counts, wrong, luck, moved, number)


@bare
def price_of_both(squares, shown, around, prices, image, near, k, other):  # type: ignore[no-untyped-def]
    """By how much the picture, but for its counts, becomes dearer when two squares change."""
    beside = near[other]  # once k is changed
    for n in range(8):
        beside ^= (squares[k] + around[n] == squares[other]) << (7 - n)
    price = prices[(shown[k] << 9) + (near[k] << 1) + image[squares[k]]]
    return price + prices[(shown[other] << 9) + (beside << 1) + image[squares[other]]]


@bare
def change(board, prices, image, near, counts, wrong, luck, moved, number):  # type: ignore[no-untyped-def]
    """Change the first so many squares of ``moved`` together, if that is not dearer than luck allows.

    wrong : by how many squares the counts are wrong. Returns by how many more they are then.
    """
    squares, rank, shown, around, ends, field, share, _, _, limits = board
    price, worse = 0.0, 0
    for m in range(number):
        k = moved[m]
        price += prices[(shown[k] << 9) + (near[k] << 1) + image[squares[k]]]
        tip(squares[k], rank, around, image, near)
    if price <= luck + WRONG * wrong:
        for m in range(number):
            k, more = moved[m], 2 * image[squares[moved[m]]] - 1
            worse += worsening(k, more, ends, field, share, limits, counts)
            recount(k, more, ends, field, share, counts)
        if price + WRONG * worse <= luck:
            return worse
        for m in range(number):
            recount(moved[m], 1 - 2 * image[squares[moved[m]]], ends, field, share, counts)
    for m in range(number):
        tip(squares[moved[m]], rank, around, image, near)
    return 0


@bare
def edge(squares, rank, around, image, k, chance, moved):  # type: ignore[no-untyped-def]
    """List the squares that change when the edge on one side of square k is moved beyond it; returns how many.

    All of the edge or a piece, and with what lies opposite or without: as chance has it. Squares lie at one edge while
    they are to be drawn, look as k does, and those across look otherwise.
    """
    side, here = chance & 3, squares[k]
    across, along, look = around[SIDES[side]], around[ALONG[side]], image[here]
    if image[here + across] == look:
        return 0
    moved[0], number = k, 1
    for way in range(2):
        step, bits = along * (1 - 2 * way), chance >> (2 + 4 * way)
        most = LONGEST if bits & 1 else bits >> 1 & 7
        square = here + step
        while most > 0 and number <= LONGEST and rank[square] >= 0 and image[square] == look != image[square + across]:
            moved[number] = rank[square]
            number, most, square = number + 1, most - 1, square + step
    if chance >> 10 & 1:
        for m in range(number):
            square, thick = squares[moved[m]] - across, 1
            while thick < THICKEST and image[square] == look and rank[square] != HIDDEN:
                square, thick = square - across, thick + 1
            if image[square] != look and rank[square] >= 0:
                moved[number] = rank[square]
                number += 1
    return number


@bare
def tip(square, rank, around, image, near):  # type: ignore[no-untyped-def]
    """Change a square, but for the counts."""
    image[square] = 1 - image[square]
    for n in range(8):
        other = rank[square + around[n]]
        if other >= 0:
            near[other] ^= 1 << (7 - n)


@bare
def worsening(k, more, ends, field, share, limits, counts):  # type: ignore[no-untyped-def]
    """By how many squares more the counts are wrong when square k is counted once more, or less."""
    worse = 0
    for i in range(ends[k], ends[k + 1]):
        f = field[i]
        before = counts[f]
        after = before + share[i] * more
        low, high = limits[f, 0], limits[f, 1]
        worse += max(low - after, after - high, 0) - max(low - before, before - high, 0)
    return worse


@bare
def recount(k, more, ends, field, share, counts):  # type: ignore[no-untyped-def]
    """Count square k once more or less."""
    for i in range(ends[k], ends[k + 1]):
        counts[field[i]] += share[i] * more
