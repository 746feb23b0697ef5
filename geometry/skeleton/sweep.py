"""Clearance and skeleton of a whole screen, computed in one sweep over its rows.

# Strategy: on large screens memory is slower than arithmetic. So distances along columns are counted once, in the
memory that will hold the clearances. Then rows are measured, classified and climbed band by band from the north, each
band while it is in the processor's cache.
"""

import numpy as np

from utak.geometry.kernels.arrays import Bools, SquaredDistances
from utak.geometry.kernels.jit import bare
from utak.geometry.raster.distance_rows import RowWindow, fill_distance_rows, new_row_window
from utak.geometry.raster.distance_transform import ColumnSteps, count_steps_south
from utak.geometry.skeleton.skeleton import Flags, Heights, States, Waiting, Words, grow

BAND_CELLS = 1 << 16  # about so many cells in a band: of 3 to 5 bytes each, which fit into a core's own cache


def new_state(shape: tuple[int, ...], words: Words | None = None) -> tuple[States, Words]:
    """Return a skeleton `state` of that padded shape, and the same memory as words of eight cells."""
    cells = shape[0] * shape[1]
    if words is None:
        words = np.zeros((cells + 7) // 8, np.uint64)
    return words.view(np.uint8)[:cells].reshape(shape), words


def survey(free: Bools, square: SquaredDistances, state: States, words: Words, band_cells: int = BAND_CELLS) -> None:
    """Measure the clearance of all free squares and find their skeleton."""
    width, steps = square.shape[1], square.view(np.int16)
    count_steps_south(free, steps)
    square[0], square[-1], state[0], state[-1] = 0, 0, 0, 0
    flags, waiting = np.empty(width, np.uint8), np.empty(width, np.int32)
    flat = square.reshape(-1), state.reshape(-1), words
    sweep(square, steps, *flat, max(1, band_cells // width), new_row_window(width), flags, waiting)


@bare
def sweep(
    square: SquaredDistances,
    steps: ColumnSteps,
    heights: Heights,
    states: Flags,
    words: Words,
    band: int,
    window: RowWindow,
    flags: States,
    waiting: Waiting,
) -> None:
    """Measure, classify and climb bands of ``band`` rows from the north to the south."""
    last, width = square.shape[0] - 2, square.shape[1]
    measured, waits = last + 1, 0
    for north in range(last, 0, -band):
        south = north - band + 1 if north > band else 1
        edge = south - 1 if south > 1 else 1
        fill_distance_rows(square, steps, edge, measured - 1, window)
        waits = grow(heights, states, words, width, south, north, flags, waiting, waits)
        measured = edge
