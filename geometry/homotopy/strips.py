"""Strips and portals: free space cut into horizontal strips, whose nerve has the homotopy type of free space.

A run is a maximal horizontal row of free squares; a portal is the overlap of a run with one in the row above. The
class of a path is the word of portals it crosses (up positive, down negative, counted from 1) without neighbouring
inverses. All portals but those of a spanning forest of the runs get a crossing number: with the ends fixed, the
crossing numbers of a reduced word name its class.
"""

from typing import NamedTuple

import numpy as np

from geometry.kernels.arrays import Ints, SquaredDistances
from geometry.kernels.jit import bare


class Strips(NamedTuple):
    """n runs ordered by (row, column) and p portals ordered by (lower row, column); rows and columns are unpadded."""

    row: Ints
    """(rows + 1,) the first run of each row."""
    low: Ints
    """(n,) first column of a run."""
    high: Ints
    """(n,) last column of a run, included."""
    up: Ints
    """(n + 1,) where the portals to the row above start."""
    down: Ints
    """(n + 1,) where the portals to the row below start."""
    left: Ints
    """(p,) first column of a portal."""
    right: Ints
    """(p,) last column of a portal, included."""
    lower: Ints
    """(p,) the run below."""
    upper: Ints
    """(p,) the run above."""
    line: Ints
    """(p,) the row of the run below."""
    crossing: Ints
    """(p,) the crossing number, 0 in the spanning forest."""
    exit: Ints
    """(n,) the signed portal out of a run from which there is no other way on, however one goes; else 0."""


def find_runs(square: SquaredDistances, level: int) -> Strips:
    """The runs and portals of the cells whose ``square`` is at least ``level``."""
    row = np.zeros(square.shape[0] - 1, np.int32)
    n = count_runs(square, level, row)
    low, high = np.empty(n, np.int32), np.empty(n, np.int32)
    fill_runs(square, level, low, high)
    up, down = np.zeros(n + 1, np.int32), np.zeros(n + 1, np.int32)
    left, right, lower, upper, line = (np.empty(2 * n, np.int32) for _ in range(5))
    p = fill_portals(row, low, high, up, down, left, right, lower, upper, line)
    crossing = np.zeros(p, np.int32)
    number_crossings(lower, upper, np.arange(n, dtype=np.int32), crossing)
    exits = np.zeros(n, np.int32)
    find_exits(up, down, lower, upper, exits, (np.diff(up) + np.diff(down)).astype(np.int32), np.empty(n, np.int32))
    return Strips(row, low, high, up, down, *trimmed(p, left, right, lower), *trimmed(p, upper, line, crossing), exits)


def trimmed(size: int, a: Ints, b: Ints, c: Ints) -> tuple[Ints, Ints, Ints]:
    """Copies of the arrays' first ``size`` entries, without the spare room behind."""
    return a[:size].copy(), b[:size].copy(), c[:size].copy()


@bare
def count_runs(square: SquaredDistances, level: int, row: Ints) -> int:
    """Fill ``row`` and return the number of runs."""
    total = 0
    for i in range(1, square.shape[0] - 1):
        here = square[i]
        for j in range(1, here.shape[0]):
            total += (here[j] < level) & (here[j - 1] >= level)
        row[i] = total
    return total


@bare
def fill_runs(square: SquaredDistances, level: int, low: Ints, high: Ints) -> None:
    """Write the ends of all runs."""
    run = 0
    for i in range(1, square.shape[0] - 1):
        here = square[i]
        for j in range(1, here.shape[0]):
            if (here[j] >= level) != (here[j - 1] >= level):
                if here[j] >= level:
                    low[run] = j - 1
                else:
                    high[run] = j - 2
                    run += 1


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
    """Merge each row with the next; returns the number of portals."""
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
    """Number the portals that close a ring of runs, in their order."""
    number = 0
    for portal in range(crossing.shape[0]):
        a, b = root(parent, lower[portal]), root(parent, upper[portal])
        if a == b:
            number += 1
            crossing[portal] = number
        else:
            parent[max(a, b)] = min(a, b)


@bare
def find_exits(up: Ints, down: Ints, lower: Ints, upper: Ints, exits: Ints, degree: Ints, queue: Ints) -> None:
    """Peel off runs with one portal left, until there are none: the dead ends of free space."""
    size = 0
    for run in range(exits.shape[0]):
        if degree[run] == 1:
            queue[size] = run
            size += 1
    done = 0
    while done < size:
        run = queue[done]
        done += 1
        if degree[run] != 1:
            continue
        for k in range(up[run], up[run + 1] + down[run + 1] - down[run]):
            above = k < up[run + 1]
            portal = k if above else k - up[run + 1] + down[run]
            other = upper[portal] if above else lower[portal]
            if exits[other] == 0:  # the one not yet peeled
                exits[run] = portal + 1 if above else -portal - 1
                degree[other] -= 1
                if degree[other] == 1:
                    queue[size] = other
                    size += 1
        degree[run] = 0


@bare
def root(parent: Ints, run: int) -> int:
    """The representative of a run's component, halving the way."""
    while parent[run] != run:
        parent[run] = parent[parent[run]]
        run = parent[run]
    return int(run)


@bare
def run_at(rows: Ints, lows: Ints, row: int, column: int) -> int:
    """The run of a square that lies in one; ``rows`` and ``lows`` are ``row`` and ``low`` of the runs."""
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
    """The signed portal crossed between two edge neighbours (padded cells); 0 within a row.

    ``rows``, ``up`` and ``left`` are ``row``, ``up`` and ``left`` of the runs.
    """
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
def extend(word: Ints, size: int, symbol: int) -> int:
    """Append a symbol to a reduced word; returns its new size. A word that fills its room needs a larger one."""
    if symbol == 0 or size >= word.shape[0]:
        return size
    if size > 0 and word[size - 1] == -symbol:
        return size - 1
    word[size] = symbol
    return size + 1
