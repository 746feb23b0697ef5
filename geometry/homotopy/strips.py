"""Strips and portals: free space cut into horizontal strips, whose nerve has the homotopy type of free space.

A strip is a maximal horizontal row of free squares. A portal is the overlap of a strip with a strip in the row above.
The class of a path is the word of portals that it crosses, without neighbouring inverses (a word without them is
reduced): portals are counted from 1, positive when crossed upwards (to the north), negative when crossed downwards.
Such a number is called a symbol or a signed portal. All portals but those of a spanning forest of the strips get a
crossing number. With the ends fixed, the crossing numbers of a reduced word name its class.

Columns and rows count from 0 at the screen's south-west square, whose south-west corner is the point (0, 0). A padded
cell is a square given by its index in the flat screen with one blocked cell on each side: (row + 1) * width + column +
1, where width = columns + 2.
"""

from typing import NamedTuple

import numpy as np

from utak.geometry.kernels.arrays import Ints, SquaredDistances
from utak.geometry.kernels.jit import bare


class Strips(NamedTuple):
    """The n strips of a screen, ordered by (row, column), and its p portals, ordered by (lower row, column)."""

    row: Ints  # (rows + 1,) the number of the first strip of each row; the strips of row r are row[r] to row[r + 1] - 1
    low: Ints  # (n,) the first (western) column of each strip
    high: Ints  # (n,) the last (eastern) column of each strip, included
    # (n + 1,) the first portal from each strip to the row above; the portals of strip s are up[s] to up[s + 1] - 1
    up: Ints
    down: Ints  # (n + 1,) the first portal from each strip to the row below, in the same way
    left: Ints  # (p,) the first (western) column of each portal
    right: Ints  # (p,) the last (eastern) column of each portal, included
    lower: Ints  # (p,) the strip below (south of) each portal
    upper: Ints  # (p,) the strip above (north of) each portal
    # (p,) the row of the strip below each portal; the portal lies at y = line + 1, from x = left to x = right + 1
    line: Ints
    crossing: Ints  # (p,) the crossing number of each portal, counted from 1; 0 for portals of the spanning forest
    exit: Ints  # (n,) the signed portal by which every path out of a dead-end strip leaves it; 0 for all other strips


def find_strips(square: SquaredDistances) -> Strips:
    """Return the strips and portals of the free cells."""
    row = np.zeros(square.shape[0] - 1, np.int32)
    count = count_strips(square, row)
    low, high = np.empty(count, np.int32), np.empty(count, np.int32)
    fill_strips(square, low, high)
    up, down = np.zeros(count + 1, np.int32), np.zeros(count + 1, np.int32)
    left, right, lower, upper, line = (np.empty(2 * count, np.int32) for _ in range(5))
    portals = fill_portals(row, low, high, up, down, left, right, lower, upper, line)
    crossing = np.zeros(portals, np.int32)
    number_crossings(lower, upper, np.arange(count, dtype=np.int32), crossing)
    exits = np.zeros(count, np.int32)
    find_exits(up, down, lower, upper, exits, (np.diff(up) + np.diff(down)).astype(np.int32), np.empty(count, np.int32))
    return Strips(
        row,
        low,
        high,
        up,
        down,
        *copy_first(portals, left, right, lower),
        *copy_first(portals, upper, line, crossing),
        exits,
    )


def copy_first(size: int, a: Ints, b: Ints, c: Ints) -> tuple[Ints, Ints, Ints]:
    """Return copies of the first `size` entries of three one-dimensional arrays `a`, `b` and `c`, in that order."""
    return a[:size].copy(), b[:size].copy(), c[:size].copy()


@bare
def count_strips(square: SquaredDistances, row: Ints) -> int:
    """Return the number of strips; fill `row` with the number of strips up to the end of each row."""
    total = 0
    for i in range(1, square.shape[0] - 1):
        here = square[i]
        for j in range(1, here.shape[0]):
            total += (here[j] == 0) & (here[j - 1] > 0)
        row[i] = total
    return total


@bare
def fill_strips(square: SquaredDistances, low: Ints, high: Ints) -> None:
    """Fill the first and last columns of all strips."""
    strip = 0
    for i in range(1, square.shape[0] - 1):
        here = square[i]
        for j in range(1, here.shape[0]):
            if (here[j] > 0) != (here[j - 1] > 0):
                if here[j] > 0:
                    low[strip] = j - 1
                else:
                    high[strip] = j - 2
                    strip += 1


@bare
def fill_portals(
    row: Ints,
    low: Ints,
    high: Ints,
    up: Ints,
    down: Ints,
    left: Ints,
    right: Ints,
    lower: Ints,
    upper: Ints,
    line: Ints,
) -> int:
    """Fill the portals between each row and the next, and return their number."""
    found = 0
    for i in range(row.shape[0] - 2):
        a, b = row[i], row[i + 1]
        while a < row[i + 1] and b < row[i + 2]:
            first, last = max(low[a], low[b]), min(high[a], high[b])
            if first <= last:
                left[found], right[found], lower[found], upper[found], line[found] = first, last, a, b, i
                up[a + 1] += 1
                down[b + 1] += 1
                found += 1
            if high[a] < high[b]:
                a += 1
            else:
                b += 1
    for k in range(low.shape[0]):
        up[k + 1] += up[k]
        down[k + 1] += down[k]
    return found


@bare
def number_crossings(lower: Ints, upper: Ints, parent: Ints, crossing: Ints) -> None:
    """Give crossing numbers, from 1 in the order of the portals, to the portals that close a ring of strips."""
    number = 0
    for portal in range(crossing.shape[0]):
        a, b = find_root(parent, lower[portal]), find_root(parent, upper[portal])
        if a == b:
            number += 1
            crossing[portal] = number
        else:
            parent[max(a, b)] = min(a, b)


@bare
def find_exits(up: Ints, down: Ints, lower: Ints, upper: Ints, exits: Ints, degree: Ints, queue: Ints) -> None:
    """Fill `exits` for the dead ends of free space: remove strips with one portal left until there are none."""
    size = 0
    for strip in range(exits.shape[0]):
        if degree[strip] == 1:
            queue[size] = strip
            size += 1
    done = 0
    while done < size:
        strip = queue[done]
        done += 1
        if degree[strip] != 1:
            continue
        for k in range(up[strip], up[strip + 1] + down[strip + 1] - down[strip]):
            above = k < up[strip + 1]
            portal = k if above else k - up[strip + 1] + down[strip]
            other = upper[portal] if above else lower[portal]
            if exits[other] == 0:  # the one not yet peeled
                exits[strip] = portal + 1 if above else -portal - 1
                degree[other] -= 1
                if degree[other] == 1:
                    queue[size] = other
                    size += 1
        degree[strip] = 0


@bare
def find_root(parent: Ints, strip: int) -> int:
    """Return the representative of a strip's component, a strip; halve the path to it in the union-find forest."""
    while parent[strip] != strip:
        parent[strip] = parent[parent[strip]]
        strip = parent[strip]
    return int(strip)


@bare
def strip_at(rows: Ints, lows: Ints, row: int, column: int) -> int:
    """Return the number of the strip in which a square lies."""
    low, high = 0 + rows[row], rows[row + 1] - 1
    while low < high:
        middle = (low + high + 1) >> 1
        if lows[middle] <= column:
            low = middle
        else:
            high = middle - 1
    return int(low)


@bare
def symbol_between(rows: Ints, up: Ints, left: Ints, cell: int, other: int, width: int) -> int:
    """Return the signed portal crossed between two cells that share an edge; 0 when both are in one row."""
    step = other - cell
    if step == 1 or step == -1:
        return 0
    bottom = cell if step > 0 else other
    row, column = bottom // width - 1, bottom % width - 1
    low, high = 0 + up[rows[row]], up[rows[row + 1]] - 1
    while low < high:
        middle = (low + high + 1) >> 1
        if left[middle] <= column:
            low = middle
        else:
            high = middle - 1
    return int(low + 1 if step > 0 else -low - 1)


@bare
def append_symbol(word: Ints, size: int, symbol: int) -> int:
    """Append a signed portal to a reduced word and return the word's new size; an inverse cancels the last symbol."""
    if symbol == 0 or size >= word.shape[0]:
        return size
    if size > 0 and word[size - 1] == -symbol:
        return size - 1
    word[size] = symbol
    return size + 1
