"""States by eights: what eight cells that lie in one word say, counted at once.

# Strategy: most words of a skeleton are empty and few have a node, so looking at each cell costs more in wrong guesses
of the processor than in work. Sums of bits within each byte of a word need no guess: a byte, one cell, holds what it
counts in its lowest bits, and nothing ever carries to the next.
"""

import numpy as np
from numpy.typing import NDArray

from geometry.kernels.arrays import Ints
from geometry.kernels.jit import bare

Eights = NDArray[np.int64]
"""(words,) states of eight cells each, the first in the lowest byte; what is beyond the last cell is 0."""
Flags = NDArray[np.uint8]

LOWEST = 0x0101010101010101
BYTES, PAIRS, FOURS = 0x00FF00FF00FF00FF, 0x0000FFFF0000FFFF, 0xFFFFFFFF


@bare
def degrees(word: int) -> int:
    """The links of each cell, byte by byte."""
    return (word & LOWEST) + (word >> 1 & LOWEST) + (word >> 2 & LOWEST) + (word >> 3 & LOWEST)


@bare
def marks(word: int, degree: int) -> int:
    """1 in the byte of each node: a cell flagged by the highest bit, or with links or flags but not two links."""
    two = degree >> 1 & ~degree
    some = word | word >> 4
    some |= some >> 2
    return (some | some >> 1) & (~two | word >> 7) & LOWEST


@bare
def fold(word: int) -> int:
    """The sum of the bytes; the highest is less than 128."""
    pairs = (word & BYTES) + (word >> 8 & BYTES)
    fours = (pairs & PAIRS) + (pairs >> 16 & PAIRS)
    return (fours & FOURS) + (fours >> 32)


@bare
def count(words: Eights, base: Ints, since: Flags) -> tuple[int, int, int]:
    """Nodes, chain ends at nodes, and links of the whole skeleton.

    ``base`` gets the number of nodes before each sixteen words, ``since`` that of those between and each word.
    """
    nodes, ends, links, start, lots = 0, 0, 0, 0, 0
    for k in range(words.shape[0]):
        if k & 15 == 0:
            base[k >> 4] = start = nodes
            links += fold(lots)
            lots = 0
        since[k] = nodes - start
        degree = degrees(words[k])
        mark = marks(words[k], degree)
        lots += degree
        if mark != 0:
            nodes += fold(mark)
            ends += fold(degree & 7 * mark)
    return nodes, ends, (links + fold(lots)) // 2


@bare
def collect(words: Eights, first: int, last: int, node: Ints, found: int) -> int:
    """List the nodes of the words ``first <= k < last`` behind so many found; returns how many there are then.

    ``node`` has room for one more than there are nodes.
    """
    for k in range(first, last if last < words.shape[0] else words.shape[0]):
        mark = marks(words[k], degrees(words[k]))
        if mark != 0:
            for cell in range(8 * k, 8 * k + 8):
                node[found] = cell  # stands if it is a node
                found += mark & 1
                mark >>= 8
    return found


@bare
def number(cell: int, words: Eights, base: Ints, since: Flags) -> int:
    """The number of nodes before a cell, from what ``count`` noted."""
    k = cell >> 3
    before = marks(words[k], degrees(words[k])) & (1 << 8 * (cell & 7)) - 1
    return int(base[k >> 4] + since[k] + fold(before))
