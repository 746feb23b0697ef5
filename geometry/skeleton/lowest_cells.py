"""Necks: the lowest cells of chains, found for many chains at once.

# Strategy: on a large screen the clearance of a saddle is far from the processor, and to wait for one at each saddle
takes longer than the walk. So a walk only notes the cells that may be lowest, and the clearances of many notes are
fetched together.

``notes`` lists cells, chain by chain; the first of each chain is noted as ~cell.
"""

import numpy as np

from geometry.kernels.arrays import Ints, SquaredDistances
from geometry.kernels.jit import bare

Notes = Ints

LEAST, MOST = 32, 1024  # notes


def new_notes(cells: int) -> Notes:
    """(2, many) room for notes and for the clearances of as many: little on a small screen."""
    return np.empty((2, min(max(LEAST, cells >> 6), MOST)), np.int32)


@bare
def lowest_of(notes: Ints, first: int, last: int, heights: SquaredDistances) -> int:
    """The lowest of one chain's notes, ``first <= k < last``, in the order of skeleton.py."""
    lowest = int(~notes[first])
    low = heights[lowest]
    for k in range(first + 1, last):
        cell = int(notes[k])
        height = heights[cell]
        if height < low or (height == low and cell < lowest):
            low, lowest = height, cell
    return lowest


@bare
def settle(notes: Ints, values: Ints, noted: int, heights: SquaredDistances, chain: int, neck: Ints) -> None:
    """Find the necks of successive chains, from ``chain`` on, of which there are so many notes. ``values`` is
    scratch. No branches: they are not to be foreseen.
    """
    for k in range(noted):
        cell = int(notes[k])
        values[k] = heights[cell if cell >= 0 else ~cell]
    chain, low = chain - 1, 0
    for k in range(noted):
        note = int(notes[k])
        first = note < 0
        rank = int(values[k]) << 32 | (~note if first else note)
        low = rank if first | (rank < low) else low
        chain += int(first)
        neck[chain] = low & 0xFFFFFFFF
