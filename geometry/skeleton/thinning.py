"""The skeleton as a raster: the cells of all chains, thinned, with the components and holes of free space.

Two chains may run in cells that touch although the chains do not meet there.

# Strategy: cells enclosed between chains with no blocked square among them are filled in, which restores the holes of
free space. Then every cell whose removal changes neither components nor holes (a simple point) is removed, in the order
of cells, but for the ends of lines.
"""

import numpy as np

from geometry.kernels.arrays import Bools, Ints, SquaredDistances
from geometry.kernels.jit import bare
from geometry.skeleton.skeleton import KINDS, States, beside


def thin_skeleton(square: SquaredDistances, state: States) -> Bools:
    """Return the thin skeleton as a raster.

    Parameters
    ----------
    square : (rows + 2, columns + 2) int16 or int32
        Squared clearances in squared half squares, (2 * clearance in squares)^2; 0 on blocked squares.
    state : (rows + 2, columns + 2) uint8
        Links and flags of the skeleton: of each cell bits 1, 2, 4, 8 are links to the east, north, west, south; 16 says
        that an ascent passed it, 32 saddle, 64 summit, 128 that it was chosen as the node of a ring.

    Returns
    -------
    (rows, columns) bool
        True on the squares of the skeleton; a new array without the padding, row 0 in the south.
    """
    line = state > 0
    reached = square == 0
    flood(line, reached, np.flatnonzero(reached).astype(np.int32), np.empty(square.size, np.int32))
    line |= ~reached & ~line
    while thin(line, KINDS):
        pass
    return line[1:-1, 1:-1].copy()


@bare
def flood(line: Bools, reached: Bools, seeds: Ints, stack: Ints) -> None:
    """Set ``reached`` for all cells off the line that the seeds reach by sides and corners.

    Flat indices are row * width + column in the screen padded by one blocked cell on each side.

    Parameters
    ----------
    line : (rows + 2, columns + 2) bool, the cells of the skeleton, which the flood does not enter.
    reached : (rows + 2, columns + 2) bool, True on the seeds; changed.
    seeds : (n,) int32, flat indices of cells to begin at.
    stack : (cells,) int32, scratch.
    """
    width, cells = line.shape[1], line.size
    lines, reach = line.reshape(-1), reached.reshape(-1)
    for seed in seeds:
        stack[0] = seed
        size = 1
        while size > 0:
            size -= 1
            cell = stack[size]
            for k in range(8):
                other = cell + beside(k, width)
                if 0 <= other < cells and not reach[other] and not lines[other]:
                    reach[other] = True
                    stack[size] = other
                    size += 1


@bare
def thin(line: Bools, kind: States) -> bool:
    """Remove, one after the other, all simple points of the line but its ends; return whether there were any.

    A simple point is a cell whose removal changes neither components nor holes. Points that only the removals of this
    pass make simple may be left: call again until False is returned.

    Parameters
    ----------
    line : (rows + 2, columns + 2) bool, True on the cells of the line; changed. Its first and last row are left alone.
    kind : (256,) uint8, KINDS of skeleton.py: by the set of neighbours on the line, 0 where they are one group.
    """
    width = line.shape[1]
    lines = line.reshape(-1)
    removed = False
    for cell in range(width, lines.shape[0] - width):
        if not lines[cell]:
            continue
        around, touching = 0, 0
        for k in range(8):
            if lines[cell + beside(k, width)]:
                around |= 1 << k
                touching += 1 - k % 2
        if touching > 1 and around != 255 and kind[around] == 0:
            lines[cell] = False
            removed = True
    return removed
