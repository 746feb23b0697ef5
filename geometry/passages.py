"""Passages: the necks of free space, each with the walls that form it and how wide the floor is on either side.

# Strategy: every saddle of the clearance is a neck. Taken from the widest down, each joins the parts of the floor
that are wider than it; the greatest clearance of the part on either side is what the neck is compared with. So
between two wide parts exactly one place counts as the neck, however long and bumpy the way between them: the
narrowest, ties broken by index.
"""

from math import sqrt
from typing import NamedTuple

import numpy as np

from geometry.chains import Chains, Ints
from geometry.compiled import compiled
from geometry.distance import Squares
from geometry.runs import root
from geometry.skeleton import SADDLE, SUMMIT, States, above, beside, steepest
from geometry.ways import locate

XY = tuple[float, float]


class Passage(NamedTuple):
    """A neck of free space; all measures in squares."""

    place: XY
    """The centre of the saddle's square."""
    clearance: float
    """There."""
    width: float
    """The length of the neck: from wall to wall."""
    a: XY
    """One end of the neck, on the edge or corner of a blocked square."""
    b: XY
    """The other end."""
    sides: tuple[float, float]
    """The greatest clearance on either side, before any neck that is narrower."""
    gates: tuple[XY, XY]
    """The centres of two neighbouring free squares, one on either side of the neck, in the order of ``sides``."""
    chain: int
    """The chain of the pathgraph that leads through."""
    position: int
    """Where on it."""


def find_passages(square: Squares, state: States, chains: Chains) -> list[Passage]:
    """All passages, in the order of their saddles' squares."""
    saddles = np.flatnonzero(state.reshape(-1) & SADDLE).astype(np.int32)
    if not len(saddles):
        return []
    groups, first, peaks = compare_sides(square, state, saddles)
    found = []
    for k, saddle in enumerate(saddles.tolist()):
        count = int(groups[k])
        for g in range(1 if count == 2 else count):
            found.append(describe(square, state, chains, saddle, first[k, :count], peaks[k, :count], g))
    return found


def describe(square: Squares, state: States, chains: Chains, saddle: int, first: Ints, peaks: Ints, g: int) -> Passage:
    """The passage between one side of a saddle and the rest."""
    width = square.shape[1]
    others = [k for k in range(len(first)) if k != g]
    other = max(others, key=lambda k: (int(peaks[k]), -k))
    wall = neck_walls(square, saddle, int(first[g]))
    ends = nearest_points(wall[0], wall[1], width)
    one, two = crossing_step(square, saddle, int(first[g]), int(first[other]), ends)
    anchor = locate(int(first[g]), state, chains)
    chain, position = on_chain(chains, saddle, anchor.chain, state)
    return Passage(
        centre(saddle, width),
        clearance_of(square, saddle),
        float(np.hypot(ends[2] - ends[0], ends[3] - ends[1])),
        (ends[0], ends[1]),
        (ends[2], ends[3]),
        (0.5 * sqrt(float(peaks[g])), 0.5 * sqrt(float(peaks[other]))),
        (centre(one, width), centre(two, width)),
        chain,
        position,
    )


def on_chain(chains: Chains, saddle: int, fallback: int, state: States) -> tuple[int, int]:
    """The chain that leads from a saddle to one side, and the saddle's position on it."""
    anchor = locate(saddle, state, chains)
    chain = anchor.chain if anchor.node < 0 else fallback
    cells = chains.cells[chains.start[chain] : chains.start[chain + 1]]
    return int(chain), int(np.flatnonzero(cells == saddle)[0]) if saddle in cells else 0


def compare_sides(square: Squares, state: States, saddles: Ints) -> tuple[Ints, Ints, Ints]:
    """Per saddle: its number of sides, their first cells, and the highest ``square`` of each side's part."""
    heights = square.reshape(-1)
    count = np.zeros(len(saddles), np.int32)
    first, summit, peaks = (np.zeros((len(saddles), 4), np.int32) for _ in range(3))
    find_sides(square, state, saddles, count, first, summit)
    summits = np.flatnonzero(state.reshape(-1) & SUMMIT).astype(np.int32)
    parent = np.arange(len(summits), dtype=np.int32)
    highest = heights[summits].copy()
    order = np.lexsort((-saddles, -heights[saddles])).astype(np.int32)
    merge_sides(order, count, np.searchsorted(summits, summit).astype(np.int32), parent, highest, peaks)
    return count, first, peaks


@compiled
def find_sides(square: Squares, state: States, saddles: Ints, count: Ints, first: Ints, summit: Ints) -> None:
    """The highest neighbour in each group of higher ones, and the summit reached from it."""
    width = square.shape[1]
    heights, states = square.reshape(-1), state.reshape(-1)
    for k in range(saddles.shape[0]):
        saddle, start = saddles[k], 0
        while above(saddle + beside(start, width), saddle, heights):
            start += 1
        best = -1
        for j in range(start + 1, start + 9):
            cell = saddle + beside(j, width)
            if not above(cell, saddle, heights):
                if best >= 0:
                    first[k, count[k]] = best
                    while not states[best] & SUMMIT:
                        best = steepest(best, heights, width)
                    summit[k, count[k]] = best
                    count[k] += 1
                best = -1
            elif j % 2 == 0 and (best < 0 or above(cell, best, heights)):
                best = cell


@compiled
def merge_sides(order: Ints, count: Ints, summit: Ints, parent: Ints, highest: Ints, peaks: Ints) -> None:
    """Take the saddles in order; note the heights of the parts they join, then join them."""
    for saddle in order:
        for g in range(count[saddle]):
            peaks[saddle, g] = highest[root(parent, summit[saddle, g])]
        for g in range(1, count[saddle]):
            a, b = root(parent, summit[saddle, 0]), root(parent, summit[saddle, g])
            highest[min(a, b)] = max(highest[a], highest[b])
            parent[max(a, b)] = min(a, b)


@compiled
def neck_walls(square: Squares, saddle: int, side: int) -> tuple[int, int]:
    """The two blocked squares nearest to each other across the way from a saddle to one of its sides."""
    width = square.shape[1]
    heights = square.reshape(-1)
    k = 0
    while saddle + beside(k, width) != side:
        k += 1
    a = descend(heights, saddle, k, 1, width)
    b = descend(heights, saddle, k, 7, width)
    for _ in range(4):
        c = across(square, saddle, a, b)
        d = across(square, saddle, c, a)
        if c == b and d == a:
            break
        a, b = d, c
    return a, b


@compiled
def descend(heights: Squares, saddle: int, k: int, turn: int, width: int) -> int:
    """The blocked square at the foot of the first lower neighbours, turning from the k-th one way."""
    k += turn
    while above(saddle + beside(k, width), saddle, heights):
        k += turn
    cell = saddle + beside(k, width)
    while heights[cell] > 0:
        best = cell
        for j in range(8):
            other = cell + beside(j, width)
            if heights[other] < heights[best]:
                best = other
        cell = best
    return cell


@compiled
def across(square: Squares, saddle: int, wall: int, before: int) -> int:
    """The blocked square nearest to ``wall`` on the other side of the saddle; ``before`` if none is nearer."""
    rows, width = square.shape
    i, j = saddle // width, saddle % width
    u, v = wall // width - i, wall % width - j
    best, least = before, apart(before // width - i - u, before % width - j - v)
    reach = int(np.sqrt(float(least))) + 2
    for y in range(max(i + u - reach, 0), min(i + u + reach + 1, rows)):
        for x in range(max(j + v - reach, 0), min(j + v + reach + 1, width)):
            if square[y, x] == 0 and (y - i) * u + (x - j) * v < 0:
                gap = apart(y - i - u, x - j - v)
                if gap < least:
                    best, least = y * width + x, gap
    return best


@compiled
def apart(rise: int, run: int) -> int:
    """The squared distance between two squares at that offset."""
    y, x = max(abs(rise) - 1, 0), max(abs(run) - 1, 0)
    return y * y + x * x


def nearest_points(wall: int, other: int, width: int) -> tuple[float, float, float, float]:
    """The nearest points of two squares; in the middle where they face each other."""
    ay, by = nearest_on_axis(wall // width - 1, other // width - 1)
    ax, bx = nearest_on_axis(wall % width - 1, other % width - 1)
    return ax, ay, bx, by


def nearest_on_axis(a: int, b: int) -> tuple[float, float]:
    """The nearest points of the unit intervals at a and b."""
    if a == b:
        return a + 0.5, a + 0.5
    return (a + 1.0, float(b)) if a < b else (float(a), b + 1.0)


def crossing_step(
    square: Squares, saddle: int, one: int, two: int, ends: tuple[float, float, float, float]
) -> tuple[int, int]:
    """The two neighbouring cells between which the skeleton crosses the neck, first the one towards ``one``."""
    width = square.shape[1]
    for side, swap in ((one, False), (two, True)):
        cell, onward = saddle, side
        for _ in range(int(2 * max(abs(ends[2] - ends[0]), abs(ends[3] - ends[1]))) + 4):
            if crosses(centre(cell, width), centre(onward, width), ends):
                return (cell, onward) if swap else (onward, cell)
            cell, onward = onward, int(steepest(onward, square.reshape(-1), width))
    return one, saddle


def crosses(p: XY, q: XY, ends: tuple[float, float, float, float]) -> bool:
    """Whether the unit step from p to q crosses the segment; a point on its line counts as left of it."""
    ax, ay, bx, by = ends
    sides = [(bx - ax) * (y - ay) - (by - ay) * (x - ax) >= 0.0 for x, y in (p, q)]
    if sides[0] == sides[1]:
        return False
    if p[1] == q[1]:
        return min(ay, by) <= p[1] <= max(ay, by)
    return min(ax, bx) <= p[0] <= max(ax, bx)


def centre(cell: int, width: int) -> XY:
    """The centre of a padded cell."""
    return cell % width - 0.5, cell // width - 0.5


def clearance_of(square: Squares, cell: int) -> float:
    """The clearance at a padded cell."""
    return 0.5 * sqrt(float(square.reshape(-1)[cell]))
