"""The skeleton as a raster: the cells of all chains, thinned, with the components and holes of free space.

Two chains may run in cells that touch although the chains do not meet there.

# Strategy: cells enclosed between chains with no blocked square among them are filled in, which restores the holes of
free space. Then every cell whose removal changes neither components nor holes (a simple point) is removed, in the order
of cells, but for the ends of lines.
"""

import numpy as np

from utak.geometry.kernels.arrays import Bools, Ints, SquaredDistances
from utak.geometry.kernels.jit import bare
from utak.geometry.skeleton.skeleton import KINDS, States, beside


def thin_skeleton(square: SquaredDistances, state: States) -> Bools:
    """Return the thin skeleton as a raster."""
    line = state > 0
    reached = square == 0
    flood(line, reached, np.flatnonzero(reached).astype(np.int32), np.empty(square.size, np.int32))
    line |= ~reached & ~line
    while thin(line, KINDS):
        pass
    return line[1:-1, 1:-1].copy()


@bare
def flood(line: Bools, reached: Bools, seeds: Ints, stack: Ints) -> None:
    """Set ``reached`` for all cells off the line that the seeds reach by sides and corners."""
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
    """Remove, one after the other, all simple points of the line but its ends; return whether there were any."""
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
