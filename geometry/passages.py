"""Passages: the necks of free space, each with the walls that form it and how wide the floor is on either side.

# Strategy: every saddle of the clearance is a neck. Taken from the widest down, each joins the parts of the floor
that are wider than it; the greatest clearance of the part on either side is what the neck is compared with. So
between two wide parts exactly one place counts as the neck, however long and bumpy the way between them: the
narrowest, ties broken by index.
"""

from math import sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from geometry.bones import Ints
from geometry.chains import Chains
from geometry.compiled import bare, compiled
from geometry.distance import Squares
from geometry.runs import root
from geometry.skeleton import (
    GROUPS,
    LINKS,
    SADDLE,
    SUMMIT,
    States,
    above,
    beside,
    higher_about,
    highest_of,
    steepest,
    stride,
)
from geometry.ways import locate

XY = tuple[float, float]
Bools = NDArray[np.bool_]
PLATEAU = 64  # cells as high as a saddle that are looked at
ROOMY = 1.5  # squares of clearance from which on a saddle may be moved along its wall
TIE = 1e-9  # squares by which a neck must be narrower to be another one
OFF_CENTRE = 0.75  # squares by which a clearance may differ between a square's centre and elsewhere in it


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
    """The greatest clearance on either side, before any neck that is narrower (also between squares' centres)."""
    cut: tuple[XY, ...]
    """Centres of squares from wall to wall over ``place``: where the floor is cut."""
    towards: XY
    """The centre of the square beside ``place`` on the way to the first side; the cut runs between the two."""
    chain: int
    """The chain of the pathgraph that leads through."""
    position: int
    """Where on it."""

    @property
    def gates(self) -> tuple[XY, XY]:
        """The centres of two neighbouring free squares on either side of the cut, in the order of ``sides``."""
        return self.towards, self.place

    def shifted(self, columns: float, rows: float) -> "Passage":
        """The same passage where the origin lies so many squares further west and south."""

        def there(point: XY) -> XY:
            return point[0] + columns, point[1] + rows

        place, a, b, towards = map(there, (self.place, self.a, self.b, self.towards))
        return self._replace(place=place, a=a, b=b, cut=tuple(map(there, self.cut)), towards=towards)


def find_passages(square: Squares, state: States, chains: Chains, pinch: float = 0.0) -> list[Passage]:
    """All passages, in the order of their saddles' squares; or those alone that are pinched.

    pinch : how many times as wide as the neck the floor must be on both sides of it.
    """
    saddles = np.flatnonzero(state.reshape(-1) & SADDLE).astype(np.int32)
    if not len(saddles):
        return []
    groups, first, peaks = compare_sides(square, state, saddles)
    chosen = np.flatnonzero(may_be_pinched(square.reshape(-1), saddles, groups, peaks, pinch))
    finer = {peak: finest(square, peak) for peak in np.unique(peaks[chosen]).tolist()}
    found = []
    for k in chosen.tolist():
        count = int(groups[k])
        for g in range(1 if count == 2 else count):
            sides = [finer[peak] for peak in peaks[k, :count].tolist()]
            found.append(describe(square, state, chains, int(saddles[k]), first[k, :count], sides, g))
    return [passage for passage in found if pinch * passage.width <= 2 * min(passage.sides)]


def may_be_pinched(heights: Squares, saddles: Ints, count: Ints, peaks: Ints, pinch: float) -> Bools:
    """(n,): saddles that may be pinched, by what their squares' centres tell of necks and floor."""
    neck = np.sqrt(heights[saddles], dtype=np.float64) - 2 * OFF_CENTRE
    sides = np.sqrt(np.where(np.arange(4) < count[:, None], heights[peaks], 0), dtype=np.float64) + 2 * OFF_CENTRE
    answer: Bools = pinch * neck <= np.sort(sides, axis=1)[:, -2]
    return answer


def describe(
    square: Squares, state: States, chains: Chains, saddle: int, first: Ints, sides: list[float], g: int
) -> Passage:
    """The passage between one side of a saddle and the rest."""
    width = square.shape[1]
    others = [k for k in range(len(first)) if k != g]
    other = max(others, key=lambda k: (sides[k], -k))
    chain, position = on_chain(chains, saddle, int(first[g]), state)
    towards = int(first[g])
    neck, roomy = neck_at(square, saddle, towards), clearance_of(square, saddle) >= ROOMY
    for cell, step, back, onward in plateau(square, saddle).tolist() if len(first) == 2 else ():
        ahead = apart_squares(step, int(first[g]), width) < apart_squares(step, int(first[other]), width)
        beyond = onward if ahead else back
        nearby, on = neck_at(square, cell, beyond, strictly=True), leads_through(chains, cell, beyond, state)
        narrower = nearby.width < min(neck.width, sides[g], sides[other]) - TIE
        if on is not None and narrower and nearby.straight and roomy:
            neck, saddle, towards, (chain, position) = nearby, cell, beyond, on
    return Passage(
        centre(saddle, width),
        clearance_of(square, saddle),
        neck.width,
        neck.a,
        neck.b,
        (sides[g], sides[other]),
        tuple(centre(cell, width) for cell in neck.cells),
        centre(towards, width),
        chain,
        position,
    )


class Neck(NamedTuple):
    """The ends of a neck, from wall to wall, and the padded cells between them."""

    a: XY
    b: XY
    cells: tuple[int, ...]

    @property
    def straight(self) -> bool:
        """Does it run along a row or a column?"""
        return self.a[0] == self.b[0] or self.a[1] == self.b[1]

    @property
    def width(self) -> float:
        """From end to end."""
        return float(np.hypot(self.b[0] - self.a[0], self.b[1] - self.a[1]))


def neck_at(square: Squares, saddle: int, side: int, strictly: bool = False) -> Neck:
    """The neck at a cell, across the way to a cell beside it. strictly : no cell as high as it is on its slopes."""
    left, right = slopes(square, saddle, side, strictly)
    ax, ay, bx, by = neck_ends(square, saddle, int(left[-1]), int(right[-1]))
    return Neck((ax, ay), (bx, by), (*left[::-1].tolist(), saddle, *right.tolist()))


def apart_squares(one: int, other: int, width: int) -> int:
    """The squared distance between the centres of two cells."""
    return (one // width - other // width) ** 2 + (one % width - other % width) ** 2


@compiled
def plateau(square: Squares, saddle: int) -> Ints:
    """Cells as high as a saddle and joined to it, with lower floor on both sides: rows (cell, step, back, onward).

    Along a straight wall the clearance does not change: any cell may be the saddle, but the neck is at such a one.
    step : the first cell of the way there. back, onward : the cells beside it on that way and beyond it.
    """
    width = square.shape[1]
    heights = square.reshape(-1)
    queue = np.empty((PLATEAU, 3), np.int32)  # cell, step, back
    found = np.empty((PLATEAU, 4), np.int32)
    queue[0, 0], queue[0, 1], queue[0, 2] = saddle, -1, -1
    first, last, count = 0, 1, 0
    while first < last:
        cell, step, back = queue[first]
        first += 1
        onward, changes = -1, 0
        for k in range(8):
            here, before = heights[cell + beside(k, width)], heights[cell + beside(k + 7, width)]
            changes += (here < heights[saddle]) != (before < heights[saddle])
        for k in range(0, 8, 2):
            other = cell + beside(k, width)
            if heights[other] < heights[saddle]:
                continue
            if other != back and other + back != 2 * cell:
                onward = onward if onward >= 0 else other
            elif other != back:
                onward = other
            known = other == saddle
            for n in range(last):
                known |= queue[n, 0] == other
            if heights[other] == heights[saddle] and not known and last < PLATEAU:
                queue[last, 0], queue[last, 1], queue[last, 2] = other, other if step < 0 else step, cell
                last += 1
        if cell != saddle and changes >= 4 and onward >= 0:
            found[count, 0], found[count, 1], found[count, 2], found[count, 3] = cell, step, back, onward
            count += 1
    return found[:count]


def on_chain(chains: Chains, saddle: int, side: int, state: States) -> tuple[int, int]:
    """The chain that leads from a saddle to one side, and the saddle's position on it."""
    width, tracks = state.shape[1], (chains.node, chains.leave, chains.start, chains.cells)
    anchor = locate(saddle, state.reshape(-1), width, *tracks)
    if anchor.node < 0:
        return anchor.chain, anchor.position
    for chain in sorted(set(chains.leave[anchor.node].tolist()) - {-1}):
        cells = chains.cells[chains.start[chain] : chains.start[chain + 1]]
        if (cells[0], cells[1]) == (saddle, side):
            return chain, 0
        if (cells[-1], cells[-2]) == (saddle, side):
            return chain, len(cells) - 1
    raise AssertionError("a saddle that is a node has a chain into each of its sides")


def leads_through(chains: Chains, cell: int, side: int, state: States) -> tuple[int, int] | None:
    """The chain that leads from a cell to one beside it, and the cell's position on it; None when none does."""
    if not state.reshape(-1)[cell] & LINKS:
        return None
    anchor = locate(cell, state.reshape(-1), state.shape[1], chains.node, chains.leave, chains.start, chains.cells)
    if anchor.node >= 0:
        return None
    first, last = chains.start[anchor.chain], chains.start[anchor.chain + 1] - 1
    about = [chains.cells[first + n] for n in (anchor.position - 1, anchor.position + 1) if 0 <= n <= last - first]
    return (anchor.chain, anchor.position) if side in about else None


def compare_sides(square: Squares, state: States, saddles: Ints) -> tuple[Ints, Ints, Ints]:
    """Per saddle: its number of sides, their first cells, and the summit of each side's part."""
    heights = square.reshape(-1)
    count = np.zeros(len(saddles), np.int32)
    first, summit, peaks = (np.zeros((len(saddles), 4), np.int32) for _ in range(3))
    find_sides(square, state, saddles, count, first, summit)
    summits = np.flatnonzero(state.reshape(-1) & SUMMIT).astype(np.int32)
    parent = np.arange(len(summits), dtype=np.int32)
    highest = summits.copy()
    order = np.lexsort((-saddles, -heights[saddles])).astype(np.int32)
    merge_sides(order, count, np.searchsorted(summits, summit).astype(np.int32), parent, highest, heights, peaks)
    return count, first, peaks


@bare
def find_sides(square: Squares, state: States, saddles: Ints, count: Ints, first: Ints, summit: Ints) -> None:
    """The highest neighbour in each group of higher ones, and the summit reached from it."""
    width = square.shape[1]
    heights, states = square.reshape(-1), state.reshape(-1)
    for k in range(saddles.shape[0]):
        saddle, found = 0 + saddles[k], 0
        rest = int(GROUPS[higher_about(saddle, heights, width)])
        while rest != 0:
            best = saddle + stride(highest_of(saddle, rest & LINKS, heights, width), width)
            first[k, found] = best
            while not states[best] & SUMMIT:
                best = steepest(best, heights, width)
            summit[k, found] = best
            found, rest = found + 1, rest >> 4
        count[k] = found


@bare
def merge_sides(
    order: Ints, count: Ints, summit: Ints, parent: Ints, highest: Ints, heights: Squares, peaks: Ints
) -> None:
    """Take the saddles in order; note the summits of the parts they join, then join them."""
    for saddle in order:
        for g in range(count[saddle]):
            peaks[saddle, g] = highest[root(parent, summit[saddle, g])]
        for g in range(1, count[saddle]):
            a, b = root(parent, summit[saddle, 0]), root(parent, summit[saddle, g])
            if above(highest[max(a, b)], highest[min(a, b)], heights):
                highest[min(a, b)] = highest[max(a, b)]
            parent[max(a, b)] = min(a, b)


@bare
def finest(square: Squares, cell: int) -> float:
    """The greatest clearance at a cell's centre, corners and edges' middles."""
    rows, width = square.shape
    i, j = cell // width, cell % width
    reach = int(np.sqrt(float(square[i, j]))) // 2 + 2
    best = 0.0
    for dy in range(-1, 2):
        for dx in range(-1, 2):
            least = np.inf
            for y in range(max(i - reach, 0), min(i + reach + 1, rows)):
                for x in range(max(j - reach, 0), min(j + reach + 1, width)):
                    if square[y, x] == 0:
                        rise, run = max(abs(y - i - 0.5 * dy) - 0.5, 0.0), max(abs(x - j - 0.5 * dx) - 0.5, 0.0)
                        least = min(least, rise * rise + run * run)
            best = max(best, np.sqrt(least) if least < np.inf else 0.0)
    return best


@compiled
def slopes(square: Squares, saddle: int, side: int, strictly: bool) -> tuple[Ints, Ints]:
    """The steepest ways down to the walls, left and right of the way to a side; strictly: over no cell as high."""
    width = square.shape[1]
    heights = square.reshape(-1)
    k = 0
    while saddle + beside(k, width) != side:
        k += 1
    return descend(heights, saddle, k, 1, width, strictly), descend(heights, saddle, k, 7, width, strictly)


def neck_ends(square: Squares, saddle: int, one: int, two: int) -> tuple[float, float, float, float]:
    """The ends of a neck: the nearest points of its walls, or those nearest the saddle if it does not lie between."""
    width = square.shape[1]
    i, j = saddle // width, saddle % width
    if (one // width - i) * (two // width - i) + (one % width - j) * (two % width - j) < 0:
        return nearest_points(*neck_walls(square, saddle, one, two), width)
    return (*nearest_points(one, saddle, width)[:2], *nearest_points(two, saddle, width)[:2])


@bare
def neck_walls(square: Squares, saddle: int, one: int, two: int) -> tuple[int, int]:
    """The blocked squares nearest to each other across a saddle, starting from the feet of its slopes."""
    for _ in range(4):
        nearer = across(square, saddle, one, two)
        back = across(square, saddle, nearer, one)
        if nearer == two and back == one:
            break
        one, two = back, nearer
    return one, two


@compiled
def descend(heights: Squares, saddle: int, k: int, turn: int, width: int, strictly: bool) -> Ints:
    """The cells of the steepest way down to a wall from the first lower neighbour, turning from the k-th one way."""
    k += turn
    while above(saddle + beside(k, width), saddle, heights) or (
        strictly and heights[saddle + beside(k, width)] == heights[saddle]
    ):
        k += turn
    cells = [saddle + beside(k, width)]
    while heights[cells[-1]] > 0:
        best = cells[-1]
        for j in range(8):
            other = cells[-1] + beside(j, width)
            if heights[other] < heights[best]:
                best = other
        cells.append(best)
    return np.array(cells, np.int32)


@bare
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


@bare
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


def centre(cell: int, width: int) -> XY:
    """The centre of a padded cell."""
    return cell % width - 0.5, cell // width - 0.5


def clearance_of(square: Squares, cell: int) -> float:
    """The clearance at a padded cell."""
    return 0.5 * sqrt(float(square.reshape(-1)[cell]))
