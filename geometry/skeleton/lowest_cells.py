"""The lowest cells of chains (their narrowest places), found for many chains at once.

# Strategy: on a large screen the clearance of a saddle is in main memory, and waiting for it takes longer than the walk
along the chain. So a walk only notes the cells that may be lowest, the ends and saddles of the chain, and
the clearances of many notes are fetched together.

``notes`` lists cells, chain by chain; the first note of each chain is ~cell, which is negative.
"""

import numpy as np

from utak.geometry.kernels.arrays import Ints, SquaredDistances
from utak.geometry.kernels.jit import bare

Notes = Ints

MIN_NOTES, MAX_NOTES = 32, 1024  # room on the smallest and the largest screens (tuned by benchmarks.screens)


def new_notes(cells: int, min_notes: int = MIN_NOTES) -> Notes:
    """Return scratch (2, size) int32, uninitialised: row 0 for notes, row 1 for their squared clearances."""
    return np.empty((2, min(max(min_notes, cells >> 6), MAX_NOTES)), np.int32)


@bare
def lowest_of(notes: Ints, first: int, last: int, heights: SquaredDistances) -> int:
    """Return the lowest cell (flat index) of one chain, by its notes ``first <= k < last``."""
    lowest = int(~notes[first])
    low = heights[lowest]
    for k in range(first + 1, last):
        cell = int(notes[k])
        height = heights[cell]
        if height < low or (height == low and cell < lowest):
            low, lowest = height, cell
    return lowest


@bare
def find_lowest(notes: Ints, values: Ints, noted: int, heights: SquaredDistances, chain: int, neck: Ints) -> None:
    """Fill ``neck`` with the lowest cells of successive chains, from number ``chain`` on, by their notes."""
    # The loop has no branches, because none could be predicted.
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
