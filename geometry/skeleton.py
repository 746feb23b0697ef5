"""The skeleton of a screen: steepest ways up from every saddle of the clearance.

# Strategy: cells are totally ordered by (squared clearance, index). Seen from a cell, the neighbours above it in
that order fall into groups along the ring of eight; a group counts when it touches the cell by an edge. A cell with
no higher edge neighbour is a maximum, one with two groups or more a saddle. Clearance has no interior minimum, so
discrete Morse theory gives maxima - sum of (groups - 1) over saddles = components - holes of the free space
(4-connected, as DESIGN has it). From each saddle one steepest way up per group, until a way already trodden: the
union has the homotopy type of free space, and so has its part at or above any level, which is free space for a body
of that radius.

``state`` holds one byte a cell: bits 0-3 the links to the east, north, west and south neighbours, then the flags
below.
"""

import numpy as np
from numpy.typing import NDArray

from geometry.compiled import compiled
from geometry.distance import Squares

States = NDArray[np.uint8]
Heights = Squares
"""(cells,) squares, flat."""
Flags = States
"""(cells,) states, flat."""
Words = NDArray[np.uint64]

LINKS = 15
CLIMBED, SADDLE, SUMMIT, HALT = 16, 32, 64, 128  # HALT: a node chosen on a ring that has no junction


def kinds() -> States:
    """The flag of a cell by the set of its higher neighbours: bits from the east counter-clockwise; 255 is no cell."""
    table = np.zeros(256, dtype=np.uint8)
    for higher in range(255):
        ring = [bool(higher >> k & 1) for k in range(8)]
        start = ring.index(False)
        groups, touching = 0, False
        for k in range(start, start + 9):
            touching = ring[k % 8] and (touching or k % 2 == 0)
            groups += touching and not ring[(k + 1) % 8]
        table[higher] = SUMMIT if groups == 0 else SADDLE if groups > 1 else 0
    return table


KINDS = kinds()


@compiled
def classify(square: Squares, level: int, state: States, ring: States, kind: States) -> None:
    """Clear ``state`` and flag the summits and saddles among the cells whose ``square`` is at least ``level``."""
    rows, width = square.shape
    state[0, :] = 0
    state[rows - 1, :] = 0
    for row in range(1, rows - 1):
        classify_part(square, level, state, ring, kind, row, 1, width - 1)


@compiled
def classify_part(
    square: Squares, level: int, state: States, ring: States, kind: States, row: int, first: int, last: int
) -> None:
    """Flag the cells ``first <= column < last`` of one row."""
    below, here, above = square[row - 1][first - 1 :], square[row][first - 1 :], square[row + 1][first - 1 :]
    for j in range(last - first):  # from 0, lest the loop have to allow for indices from the end
        own = here[j + 1]
        higher = np.uint8(here[j + 2] >= own)
        higher |= np.uint8(above[j + 2] >= own) << np.uint8(1)
        higher |= np.uint8(above[j + 1] >= own) << np.uint8(2)
        higher |= np.uint8(above[j] >= own) << np.uint8(3)
        higher |= np.uint8(here[j] > own) << np.uint8(4)
        higher |= np.uint8(below[j] > own) << np.uint8(5)
        higher |= np.uint8(below[j + 1] > own) << np.uint8(6)
        higher |= np.uint8(below[j + 2] > own) << np.uint8(7)
        ring[j] = higher if own >= level else np.uint8(255)
    out = state[row]
    out[0] = 0
    out[out.shape[0] - 1] = 0
    for j in range(last - first):
        out[first + j] = kind[ring[j]]


@compiled
def trace(heights: Heights, states: Flags, width: int, words: Words, starts: NDArray[np.int32]) -> None:
    """Link the ways up from all saddles. ``words`` is ``states`` by eights; ``starts`` is scratch (4,)."""
    for word in range(words.shape[0]):
        if words[word] == 0:
            continue
        for cell in range(8 * word, 8 * word + 8):
            if cell < states.shape[0] and states[cell] & SADDLE:
                for k in range(ways_up(cell, heights, width, starts)):
                    climb(cell, starts[k], heights, states, width)


@compiled
def ways_up(saddle: int, heights: Heights, width: int, starts: NDArray[np.int32]) -> int:
    """Write the highest edge neighbour in each group of higher neighbours of a saddle; returns how many."""
    start, found, best = 0, 0, -1
    while above(saddle + beside(start, width), saddle, heights):
        start += 1
    for k in range(start + 1, start + 9):
        cell = saddle + beside(k, width)
        if not above(cell, saddle, heights):
            if best >= 0:
                starts[found] = best
                found += 1
            best = -1
        elif k % 2 == 0 and (best < 0 or above(cell, best, heights)):
            best = cell
    return found


@compiled
def climb(cell: int, higher: int, heights: Squares, states: States, width: int) -> None:
    """Link a cell to a higher one and go on up from there, until a way already trodden."""
    while True:
        link(cell, higher, states, width)
        cell = higher
        if states[cell] & (CLIMBED | SADDLE | SUMMIT):
            return
        states[cell] |= CLIMBED
        higher = steepest(cell, heights, width)


@compiled
def link(cell: int, other: int, states: States, width: int) -> None:
    """Set the two link bits between edge neighbours."""
    step = other - cell
    if step == 1:
        one, back = 1, 4
    elif step == width:
        one, back = 2, 8
    elif step == -1:
        one, back = 4, 1
    else:
        one, back = 8, 2
    states[cell] |= one
    states[other] |= back


@compiled
def steepest(cell: int, heights: Squares, width: int) -> int:
    """The highest edge neighbour of a cell, or the cell itself when none is higher."""
    best = cell
    for other in (cell + 1, cell + width, cell - 1, cell - width):
        if above(other, best, heights):
            best = other
    return best


@compiled
def above(cell: int, other: int, heights: Squares) -> bool:
    """The total order of cells."""
    return bool(heights[cell] > heights[other] or (heights[cell] == heights[other] and cell > other))


@compiled
def beside(k: int, width: int) -> int:
    """The index step to the k-th of the eight neighbours, from the east counter-clockwise."""
    k %= 8
    if k < 4:
        return 1 if k == 0 else width + 2 - k
    return -1 if k == 4 else k - width - 6
