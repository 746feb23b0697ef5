"""Nodes of the skeleton counted and listed eight cells at a time, with bit operations on words of eight states.

# Strategy: most words of a skeleton are empty and few have a node, so testing each cell costs more in mispredicted
branches than in work. Sums of bits within each byte of a word need no branch: a byte, one cell, holds its count in its
lowest bits, and no sum ever carries to the next byte.
"""

import numpy as np
from numpy.typing import NDArray

from utak.geometry.kernels.arrays import Ints
from utak.geometry.kernels.jit import bare

Eights = NDArray[np.int64]
"""(words,) states of eight cells each, the first in the lowest byte; bytes beyond the last cell are 0."""
ByteFlags = NDArray[np.uint8]

LOWEST_BITS = 0x0101010101010101  # of each byte
EVEN_BYTES, EVEN_PAIRS, LOWER_HALF = 0x00FF00FF00FF00FF, 0x0000FFFF0000FFFF, 0xFFFFFFFF  # masks for sums of bytes


@bare
def degrees(word: int) -> int:
    """Return a word with the number of links (0 to 4) of each of its eight cells in the byte of the cell."""
    return (word & LOWEST_BITS) + (word >> 1 & LOWEST_BITS) + (word >> 2 & LOWEST_BITS) + (word >> 3 & LOWEST_BITS)


@bare
def node_marks(word: int, degree: int) -> int:
    """Return a word with 1 in the byte of each node, 0 elsewhere."""
    two = degree >> 1 & ~degree
    some = word | word >> 4
    some |= some >> 2
    return (some | some >> 1) & (~two | word >> 7) & LOWEST_BITS


@bare
def sum_of_bytes(word: int) -> int:
    """Return the sum of the eight bytes of a word (unsigned) whose highest byte is less than 128."""
    pairs = (word & EVEN_BYTES) + (word >> 8 & EVEN_BYTES)
    fours = (pairs & EVEN_PAIRS) + (pairs >> 16 & EVEN_PAIRS)
    return (fours & LOWER_HALF) + (fours >> 32)


@bare
def count_nodes(words: Eights, base: Ints, since: ByteFlags) -> tuple[int, int, int]:
    """Return the numbers of nodes, of chain ends at nodes, and of links of the whole skeleton."""
    nodes, ends, links, start, lots = 0, 0, 0, 0, 0
    for k in range(words.shape[0]):
        if k & 15 == 0:
            base[k >> 4] = start = nodes
            links += sum_of_bytes(lots)
            lots = 0
        since[k] = nodes - start
        degree = degrees(words[k])
        mark = node_marks(words[k], degree)
        lots += degree
        if mark != 0:
            nodes += sum_of_bytes(mark)
            ends += sum_of_bytes(degree & 7 * mark)
    return nodes, ends, (links + sum_of_bytes(lots)) // 2


@bare
def list_nodes(words: Eights, first: int, last: int, node: Ints, found: int) -> int:
    """Append the cells of the nodes in the words ``first <= k < last`` to ``node``, and return their number so far."""
    for k in range(first, last if last < words.shape[0] else words.shape[0]):
        mark = node_marks(words[k], degrees(words[k]))
        if mark != 0:
            for cell in range(8 * k, 8 * k + 8):
                node[found] = cell  # stands if it is a node
                found += mark & 1
                mark >>= 8
    return found


@bare
def node_number(cell: int, words: Eights, base: Ints, since: ByteFlags) -> int:
    """Return the number of nodes before a cell; when the cell is a node itself, that is its own number."""
    k = cell >> 3
    before = node_marks(words[k], degrees(words[k])) & (1 << 8 * (cell & 7)) - 1
    return int(base[k >> 4] + since[k] + sum_of_bytes(before))
