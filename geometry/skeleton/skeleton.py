"""The skeleton of a screen: the steepest ascents from every saddle of the clearance.

# Strategy: cells are totally ordered by (squared clearance, index). The neighbours of a cell that are above it in that
order fall into groups along its ring of eight neighbours; a group counts when it touches the cell by an edge. A cell
without a higher edge neighbour is a maximum (summit), one with two groups or more a saddle. Clearance has no interior
minimum, so by discrete Morse theory (Forman 1998) maxima - sum of (groups - 1) over saddles = components - holes of the
free space, connected through edges. From each saddle one steepest ascent leads up per group, until it meets an earlier
one. The union has the homotopy type of free space.

Rows are classified and climbed in bands from the north, while they are in the processor's cache. An ascent that leads
south out of the rows done so far waits at the last of them.

``state`` holds one byte a cell: bits 0 to 3 are the links to the east, north, west and south neighbours, the others the
flags below. Directions are numbered 0 east, 1 north, 2 west, 3 south.
"""

import numpy as np
from numpy.typing import NDArray

from utak.geometry.kernels.arrays import SquaredDistances
from utak.geometry.kernels.jit import bare

States = NDArray[np.uint8]
Heights = SquaredDistances
"""(cells,) squared clearances in squared half squares, flat."""
Flags = States
"""(cells,) states, flat."""
Words = NDArray[np.uint64]
"""(cells / 8, rounded up) the memory of states, eight cells a word."""
Truth = np.bool_
Waiting = NDArray[np.int32]
"""Cells at which ascents wait that lead out of the rows done so far."""

LINKS = 15  # bits of a state: the four links
SOUTH = 3  # a direction, counted from the east counter-clockwise
CLIMBED, SADDLE, SUMMIT, HALT = 16, 32, 64, 128  # bits of a state; HALT: the node chosen on a ring without a junction


@bare
def flag(e: Truth, ne: Truth, n: Truth, nw: Truth, w: Truth, sw: Truth, s: Truth, se: Truth) -> np.uint8:
    """Return SADDLE (32), SUMMIT (64) or 0 for a cell, given which of its eight neighbours are higher."""
    a, b, c, d = e & ~(ne & n), n & ~(nw & w), w & ~(sw & s), s & ~(se & e)
    several = (a | b) & (c | d) | a & b | c & d
    return np.uint8(np.uint8(several) << np.uint8(5) | np.uint8(~(e | n | w | s)) << np.uint8(6))


def kinds() -> States:
    """Return the flag (SADDLE, SUMMIT, 0) by the set of higher neighbours: (256,) uint8."""
    # Set 255 does not occur, because clearance has no interior minimum; 0 stands there.
    sets = [[np.bool_(higher >> k & 1) for k in range(8)] for higher in range(255)]
    return np.array([flag.function(*ring) for ring in sets] + [0], np.uint8)


KINDS = kinds()


def edge_groups() -> NDArray[np.uint16]:
    """Return the groups by the set of higher neighbours, (256,) uint16: four bits a group, from the lowest on."""
    table = np.zeros(256, dtype=np.uint16)
    for higher in range(255):
        ring = [bool(higher >> k & 1) for k in range(8)]
        start, found, edges = ring.index(False), 0, 0
        for k in range(start + 1, start + 9):
            if not ring[k % 8]:
                table[higher] |= edges << 4 * found
                found, edges = found + (edges > 0), 0
            elif k % 2 == 0:
                edges |= 1 << k % 8 // 2
    return table


GROUPS = edge_groups()


@bare
def grow(
    heights: Heights,
    states: Flags,
    words: Words,
    width: int,
    south: int,
    north: int,
    flags: States,
    waiting: Waiting,
    waits: int,
) -> int:
    """Classify rows from ``north`` down to ``south``, link the ascents from their saddles, and return how many wait."""
    for row in range(south, north + 1):
        classify(heights, states, width, row, flags)
    first, last, left = south * width, (north + 1) * width, 0
    for k in range(waits):
        waiting[left] = climb(0 + waiting[k], SOUTH, heights, states, width, first)
        left += waiting[left] >= 0
    for word in range(first >> 3, (last + 7) >> 3):
        if words[word] == 0:
            continue
        for cell in range(8 * word if 8 * word > first else first, 8 * word + 8 if 8 * word + 8 < last else last):
            if states[cell] & SADDLE:
                rest = int(GROUPS[higher_about(cell, heights, width)])
                while rest != 0:
                    way = climb(cell, highest_of(cell, rest & LINKS, heights, width), heights, states, width, first)
                    if way >= 0:
                        waiting[left] = way
                        left += 1
                    rest >>= 4
    return left


@bare
def classify(heights: Heights, states: Flags, width: int, row: int, flags: States) -> None:
    """Clear the states of a row and set SADDLE or SUMMIT in those of its saddles and summits."""
    first = row * width
    out = states[first : first + width]
    find_flags(heights, width, first + 1, flags[: width - 2])
    out[0] = 0
    out[width - 1] = 0
    for j in range(width - 2):
        out[j + 1] = flags[j]


@bare
def find_flags(heights: Heights, width: int, first: int, flags: Flags) -> None:
    """Fill ``flags`` for as many cells of a row from ``first`` on: SADDLE, SUMMIT or 0."""
    size, least = flags.shape[0] + 2, heights.dtype.type(1)
    below, here = heights[first - width - 1 : first - width - 1 + size], heights[first - 1 : first - 1 + size]
    above = heights[first + width - 1 : first + width - 1 + size]
    for j in range(size - 2):  # from 0, so that no index can count from the end
        own = here[j + 1]
        e, ne, n, nw = here[j + 2] >= own, above[j + 2] >= own, above[j + 1] >= own, above[j] >= own
        w, sw, s, se = here[j] > own, below[j] > own, below[j + 1] > own, below[j + 2] > own
        flags[j] = flag(e, ne, n, nw, w, sw, s, se) if own >= least else np.uint8(0)


@bare
def higher_about(cell: int, heights: Heights, width: int) -> int:
    """Return the set of a cell's higher neighbours."""
    # Bit k for the k-th of the eight, from the east counter-clockwise.
    own = heights[cell]
    higher = int(heights[cell + 1] >= own) | int(heights[cell + width + 1] >= own) << 1
    higher |= int(heights[cell + width] >= own) << 2 | int(heights[cell + width - 1] >= own) << 3
    higher |= int(heights[cell - 1] > own) << 4 | int(heights[cell - width - 1] > own) << 5
    return int(higher | int(heights[cell - width] > own) << 6 | int(heights[cell - width + 1] > own) << 7)


@bare
def highest_of(cell: int, edges: int, heights: Heights, width: int) -> int:
    """Return the direction (0 east, 1 north, 2 west, 3 south) of the highest among some edge neighbours of a cell."""
    # Without branches, because at saddles none could be predicted.
    south = np.int64(heights[cell - width]) << 2
    west = np.int64(heights[cell - 1]) << 2 | 1
    east = np.int64(heights[cell + 1]) << 2 | 2
    north = np.int64(heights[cell + width]) << 2 | 3
    best = south if edges & 8 else -1
    best = west if edges & 4 and west > best else best
    best = east if edges & 1 and east > best else best
    best = north if edges & 2 and north > best else best
    return int(0b01001011 >> 2 * (best & 3) & 3)


@bare
def highest(cell: int, heights: Heights, width: int) -> int:
    """Return the direction (0 east, 1 north, 2 west, 3 south) of the highest of the four edge neighbours of a cell."""
    east, north, west, south = heights[cell + 1], heights[cell + width], heights[cell - 1], heights[cell - width]
    if (north if north >= east else east) >= (west if west >= south else south):
        return 1 if north >= east else 0
    return 2 if west >= south else 3


@bare
def climb(cell: int, direction: int, heights: Heights, states: Flags, width: int, first: int) -> int:
    """Link a cell to a higher neighbour and ascend from there until a saddle, a summit or an earlier ascent."""
    while True:
        other = cell + stride(direction, width)
        if other < first:
            return cell
        link(cell, other, direction, states)
        cell = other
        if states[cell] & (CLIMBED | SADDLE | SUMMIT):
            return -1
        states[cell] |= CLIMBED
        direction = highest(cell, heights, width)


@bare
def link(cell: int, other: int, direction: int, states: Flags) -> None:
    """Set the two link bits between edge neighbours in ``states``."""
    states[cell] |= 1 << direction
    states[other] |= 1 << (direction ^ 2)


@bare
def steepest(cell: int, heights: Heights, width: int) -> int:
    """Return the highest edge neighbour (flat index) of a cell that is no summit; of equal ones the greater index."""
    return int(cell + stride(highest(cell, heights, width), width))


@bare
def above(cell: int, other: int, heights: Heights) -> bool:
    """Return whether `cell` is above `other` in the total order: by clearance, then by flat index."""
    return bool(heights[cell] > heights[other] or (heights[cell] == heights[other] and cell > other))


@bare
def stride(direction: int, width: int) -> int:
    """Return the difference of flat indices of one step in a direction (0 east, 1 north, 2 west, 3 south)."""
    return (1 - (direction & 2)) * (width if direction & 1 else 1)


@bare
def beside(k: int, width: int) -> int:
    """Return the difference of flat indices to the k-th of the eight neighbours, from the east counter-clockwise."""
    k %= 8
    if k < 4:
        return 1 if k == 0 else width + 2 - k
    return -1 if k == 4 else k - width - 6
