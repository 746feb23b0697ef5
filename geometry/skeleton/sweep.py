"""Clearance and skeleton of a whole screen, computed in one sweep over its rows.

# Strategy: on large screens memory is slower than arithmetic. So distances along columns are counted once, in the
memory that will hold the clearances. Then rows are measured, classified and climbed band by band from the north, each
band while it is in the processor's cache.
"""

import numpy as np

from geometry.kernels.arrays import Bools, SquaredDistances
from geometry.kernels.jit import bare
from geometry.raster.distance_rows import RowWindow, fill_distance_rows, new_row_window
from geometry.raster.distance_transform import ColumnSteps, count_steps_south
from geometry.skeleton.skeleton import Flags, Heights, States, Waiting, Words, grow

BAND_CELLS = 1 << 16  # about so many cells in a band: of 3 to 5 bytes each, which fit into a core's own cache


def survey(free: Bools, square: SquaredDistances, state: States, words: Words, band_cells: int = BAND_CELLS) -> None:
    """Measure the clearance of all free squares and find their skeleton.

    Parameters
    ----------
    free : (rows, columns) bool
        True on free squares; row 0 in the south.
    square : (rows + 2, columns + 2) int16 or int32
        Filled with squared clearances in squared half squares, (2 * clearance in squares)^2, 0 where blocked; its type
        must hold them. The first and last row and column are a blocked frame.
    state : (rows + 2, columns + 2) uint8
        Filled with the links and flags of the skeleton: of each cell bits 1, 2, 4, 8 are links to the east, north,
        west, south; 16 says that an ascent passed it, 32 saddle, 64 summit, 128 that it was chosen as the node of a
        ring.
    words : (n,) uint64
        The memory of ``state`` by eights, 0 beyond its last cell.
    band_cells : int
        About so many cells are in a band.
    """
    width, steps = square.shape[1], square.view(np.int16)
    count_steps_south(free, steps)
    square[0], square[-1], state[0], state[-1] = 0, 0, 0, 0
    flags, waiting = np.empty(width, np.uint8), np.empty(width, np.int32)
    flat = square.reshape(-1), state.reshape(-1), words
    sweep(square, steps, *flat, max(1, band_cells // width), new_row_window(width), flags, waiting)


def grow_all(square: SquaredDistances, level: int, state: States, words: Words) -> None:
    """Find the skeleton of the cells whose squared clearance is at least ``level``.

    Parameters
    ----------
    square : (rows + 2, columns + 2) int16 or int32
        Squared clearances in squared half squares, (2 * clearance in squares)^2.
    level : int
        The least squared clearance, in half squares, that counts as free; the higher, the larger the body and the
        smaller the skeleton. Levels beyond the type of ``square`` count as its greatest value.
    state : (rows + 2, columns + 2) uint8
        Filled with the links and flags of the skeleton (see skeleton.py); all 0 when no cell is that high.
    words : (n,) uint64
        The memory of ``state`` by eights, 0 beyond its last cell.
    """
    width, level = square.shape[1], min(level, int(np.iinfo(square.dtype).max))
    state[0], state[-1] = 0, 0
    flags, waiting = np.empty(width, np.uint8), np.empty(width, np.int32)
    grow(square.reshape(-1), state.reshape(-1), words, width, level, 1, len(square) - 2, flags, waiting, 0)


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
    """Measure, classify and climb bands of ``band`` rows from the north to the south.

    Flat indices are row * width + column in the screen padded by one blocked cell on each side.

    Parameters
    ----------
    square : (rows + 2, columns + 2) int16 or int32
        Filled, but for its first and last row, with squared clearances in squared half squares.
    steps : (rows + 2, columns + 2 or more) int16
        Steps from each square to the nearest blocked one to the south, in the memory of ``square``; overwritten.
    heights : (cells,)
        The memory of ``square``, flat.
    states : (cells,) uint8
        Filled, but for the first and the last row, with the links and flags of the skeleton, flat.
    words : (cells / 8, rounded up) uint64
        The memory of ``states`` by eights.
    band : int
        Number of rows that are measured and climbed at a time, 1 or more.
    window, flags, waiting
        Scratch: a new window of rows for the measuring (distance_rows.py), (width,) uint8 for the flags of a row, and
        (width,) int32 for cells whose ascents wait.
    """
    last, width = square.shape[0] - 2, square.shape[1]
    measured, waits = last + 1, 0
    for north in range(last, 0, -band):
        south = north - band + 1 if north > band else 1
        edge = south - 1 if south > 1 else 1
        fill_distance_rows(square, steps, edge, measured - 1, window)
        waits = grow(heights, states, words, width, 1, south, north, flags, waiting, waits)
        measured = edge
