"""The skeleton where clearances change: ascents that may lead elsewhere are taken back, and climbed again.

# Strategy: a link leads from a cell to a higher one, and depends on the clearances around the lower cell alone. So only
links that leave a cell at or next to a changed one are removed; then, from where they led, every ascent that no other
leads into any more. What is left is part of the new skeleton, and the rest is grown as at first (skeleton.py).
"""

from typing import NamedTuple

import numpy as np

from geometry.kernels.arrays import Ints, SquaredDistances
from geometry.kernels.jit import bare
from geometry.skeleton.buffers import Scratch
from geometry.skeleton.skeleton import (
    CLIMBED,
    GROUPS,
    LINKS,
    SADDLE,
    SUMMIT,
    Flags,
    Heights,
    States,
    above,
    find_flags,
    higher_about,
    highest,
    highest_of,
    link,
    stride,
)

TOUCHED, MOVED = 1, 2  # bits of marks: the cell's state may differ, its clearance differs
JOINED, PASSED = 4, 8  # bits of marks: the cell has to be joined again, a walk along a chain has passed it


class ChangeLog(NamedTuple):
    """A log of the cells whose state or clearance a change may have altered.

    Cells are flat indices (row * width + column) into the padded screen.

    Attributes
    ----------
    states : (cells,) uint8
        The states of the skeleton, which are changed in place.
    mark : (cells,) uint8
        Bits: TOUCHED (1, logged), MOVED (2, other clearance), JOINED (4, its chain is joined again), PASSED (8, a walk
        has passed it); 0 for all other cells.
    touched : (cells,) int32
        Room for the touched cells, of which the first ``size[0]`` are listed.
    before : (cells,) uint8
        The states of these before the change, in the same order.
    size : (1,) int32
        Number of touched cells.
    """

    states: Flags
    mark: Flags
    touched: Ints
    before: Flags
    size: Ints


def regrow(
    square: SquaredDistances, state: States, bounds: Ints, fresh: SquaredDistances, scratch: Scratch
) -> ChangeLog:
    """Set new clearances, grow the skeleton again where they differ, and return the log of what may have changed.

    Flat indices are row * width + column in the screen padded by one blocked cell on each side.

    Parameters
    ----------
    square : (rows + 2, columns + 2) int16 or int32
        Squared clearances in squared half squares, (2 * clearance in squares)^2; changed in place.
    state : (rows + 2, columns + 2) uint8
        Links and flags of the skeleton: of each cell bits 1, 2, 4, 8 are links to the east, north, west, south; 16 says
        that an ascent passed it, 32 saddle, 64 summit, 128 that it was chosen as the node of a ring. Changed in place.
    bounds : (rows + 2, 3) int32
        For each row the first and last column that change, and the index in ``fresh`` of the value of the first. The
        last is -1 in rows where none does.
    fresh : (n,) int16 or int32
        New squared clearances in squared half squares, flat, of a part of the screen.
    scratch : Scratch
        Becomes part of the log; its marks are 0 before and have to be cleared by the caller.

    Returns
    -------
    ChangeLog
        The states, changed; marks of cells (logged, other clearance); and the touched cells (flat indices), in the
        order in which they were first touched, with their states before.
    """
    heights, states, width = square.reshape(-1), state.reshape(-1), square.shape[1]
    journal = ChangeLog(states, *scratch, np.zeros(1, np.int32))
    about = np.empty((len(bounds), 2), np.int32)
    find_columns_about(bounds, width, about)
    prune(heights, width, about, journal)
    set_clearances(heights, width, bounds, fresh, about, np.empty(width, np.uint8), journal)
    grow(heights, width, about, journal)
    return journal


@bare
def find_columns_about(bounds: Ints, width: int, about: Ints) -> None:
    """Fill ``about`` with the first and last column of each row at or next to a changed cell.

    Parameters
    ----------
    bounds : (rows + 2, 2 or more) int32, first and last column of each padded row that change; last -1 for none.
    width : width of the padded screen.
    about : (rows + 2, 2) int32, output, padded columns within the frame; the width and -1 for rows without such a cell.
    """
    rows = bounds.shape[0]
    for row in range(rows):
        about[row, 0], about[row, 1] = width, -1
    for row in range(1, rows - 1):
        for near in range(row - 1, row + 2):
            if bounds[near, 1] >= 0:
                first = bounds[near, 0] - 1 if bounds[near, 0] > 1 else 1
                last = bounds[near, 1] + 1 if bounds[near, 1] < width - 2 else width - 2
                about[row, 0] = first if first < about[row, 0] else about[row, 0]
                about[row, 1] = last if last > about[row, 1] else about[row, 1]


@bare
def touch(journal: ChangeLog, cell: int) -> None:
    """Log a cell (flat index) and its state in `journal` before the state changes; later calls for it do nothing.

    Flat indices are row * width + column in the screen padded by one blocked cell on each side.
    """
    if not journal.mark[cell] & TOUCHED:
        journal.mark[cell] |= TOUCHED
        k = journal.size[0]
        journal.touched[k], journal.before[k], journal.size[0] = cell, journal.states[cell], k + 1


@bare
def prune(heights: Heights, width: int, about: Ints, journal: ChangeLog) -> None:
    """Remove the links that lead up from the cells within ``about``, and the ascents that depend on them.

    An ascent goes from each cell to its highest edge neighbour, from a saddle on (a cell whose higher neighbours form
    two groups or more). Nothing is returned. Flat indices are row * width + column in the screen padded by one blocked
    cell on each side.

    Parameters
    ----------
    heights : (cells,) int16 or int32
        Squared clearances in squared half squares before the change, flat.
    width : int
        Width of the padded screen.
    about : (rows + 2, 2) int32
        First and last column of each padded row; the last is -1 for none.
    journal : ChangeLog
        Its states are changed, and every cell that is touched is logged.
    """
    states = journal.states
    for row in range(about.shape[0]):
        for cell in range(row * width + about[row, 0], row * width + about[row, 1] + 1):
            if not states[cell] & (255 - SADDLE - SUMMIT):
                continue
            touch(journal, cell)
            for direction in range(4):
                other = cell + stride(direction, width)
                if states[cell] >> direction & 1 and above(other, cell, heights):
                    unlink(journal, cell, other, direction)
                    prune_ascent(heights, width, about, journal, other)
            states[cell] &= LINKS | SADDLE | SUMMIT


@bare
def unlink(journal: ChangeLog, cell: int, other: int, direction: int) -> None:
    """Remove the link from `cell` to `other`, its neighbour in a direction (0 east to 3 south), and log both first.

    Both are flat indices. In the states of `journal` the bit of the link is cleared in both cells. Flat indices are row
    * width + column in the screen padded by one blocked cell on each side.
    """
    touch(journal, cell)
    touch(journal, other)
    journal.states[cell] &= 255 - (1 << direction)
    journal.states[other] &= 255 - (1 << (direction ^ 2))


@bare
def prune_ascent(heights: Heights, width: int, about: Ints, journal: ChangeLog, cell: int) -> None:
    """Remove the ascent from a cell outside ``about`` up to where another ascent still leads into it.

    An ascent goes from each cell to its highest edge neighbour. What is removed also ends at saddles, summits and cells
    within ``about``, which are pruned otherwise. Flat indices are row * width + column in the screen padded by one
    blocked cell on each side.

    Parameters
    ----------
    heights, width : (cells,) and int
        Squared clearances (half squares) before the change, flat, and the width of the padded screen.
    about : (rows + 2, 2) int32
        First and last column of each padded row at or next to a changed cell; the last is -1 for none.
    journal : ChangeLog
        Its states are changed, and every cell that is touched is logged.
    cell : int
        Flat index of the cell from which a link below was removed.
    """
    states = journal.states
    while not states[cell] & (SADDLE | SUMMIT):
        row = cell // width
        if about[row, 0] <= cell - row * width <= about[row, 1]:
            return
        up, higher = -1, cell
        for direction in range(4):
            if states[cell] >> direction & 1:
                other = cell + stride(direction, width)
                if not above(other, cell, heights):
                    return
                up, higher = direction, other
        touch(journal, cell)
        states[cell] &= LINKS
        if up < 0:
            return
        unlink(journal, cell, higher, up)
        cell = higher


@bare
def set_clearances(
    heights: Heights, width: int, bounds: Ints, fresh: SquaredDistances, about: Ints, flags: Flags, journal: ChangeLog
) -> None:
    """Set the new clearances, and the flags SADDLE and SUMMIT of the cells within ``about``.

    Flat indices are row * width + column in the screen padded by one blocked cell on each side.

    Parameters
    ----------
    heights : (cells,) int16 or int32
        Squared clearances in squared half squares, flat; changed.
    width : int
        Width of the padded screen.
    bounds : (rows + 2, 3) int32
        For each padded row the first and last column that change, and the index in ``fresh`` of the value of the first.
    fresh : (n,) int16 or int32
        New squared clearances in squared half squares.
    about : (rows + 2, 2) int32
        First and last column of each padded row at or next to a changed cell.
    flags : (width,) uint8
        Scratch.
    journal : ChangeLog
        Its states are changed; cells that differ are marked MOVED, and those with other flags logged.
    """
    states = journal.states
    for row in range(bounds.shape[0]):
        size = bounds[row, 1] - bounds[row, 0] + 1
        if size > 0:
            first, source = row * width + bounds[row, 0], bounds[row, 2]
            replace(heights[first : first + size], fresh[source : source + size], journal.mark[first : first + size])
    for row in range(about.shape[0]):
        size = about[row, 1] - about[row, 0] + 1
        if size > 0:
            first = row * width + about[row, 0]
            find_flags(heights, width, first, 1, flags[:size])
            if differ(states[first : first + size], flags):
                for k in range(size):
                    if states[first + k] & (SADDLE | SUMMIT) != flags[k]:
                        touch(journal, first + k)
                        states[first + k] = states[first + k] & LINKS | flags[k]


@bare
def replace(heights: Heights, fresh: Heights, mark: Flags) -> None:
    """Copy ``fresh`` into ``heights``, and mark the cells that differ as MOVED in ``mark``; all three are (n,)."""
    for k in range(heights.shape[0]):
        mark[k] |= np.uint8(MOVED) if heights[k] != fresh[k] else np.uint8(0)
        heights[k] = fresh[k]


@bare
def differ(states: Flags, flags: Flags) -> bool:
    """Return whether any of some states (n,) has other flags (SADDLE 32, SUMMIT 64) than given in ``flags`` (n,)."""
    other = np.uint8(0)
    for k in range(states.shape[0]):
        other |= flags[k] ^ states[k] & np.uint8(SADDLE | SUMMIT)
    return bool(other != 0)


@bare
def grow(heights: Heights, width: int, about: Ints, journal: ChangeLog) -> None:
    """Climb again from the saddles within ``about``, and from where ascents from outside lead into it.

    An ascent goes from each cell to its highest edge neighbour; from a saddle one goes up in each group of higher
    cells. Flat indices are row * width + column in the screen padded by one blocked cell on each side.

    Parameters
    ----------
    heights : (cells,) int16 or int32
        Squared clearances in squared half squares after the change, flat.
    width : int
        Width of the padded screen.
    about : (rows + 2, 2) int32
        First and last column of each padded row; the last is -1 for none.
    journal : ChangeLog
        Its states are changed, and every cell that is touched is logged.
    """
    states = journal.states
    for row in range(about.shape[0]):
        for cell in range(row * width + about[row, 0], row * width + about[row, 1] + 1):
            here = states[cell]
            if here & SADDLE:
                rest = int(GROUPS[higher_about(cell, heights, width)])
                while rest != 0:
                    climb(cell, highest_of(cell, rest & LINKS, heights, width), heights, width, journal)
                    rest >>= 4
            elif here & LINKS and not here & (SUMMIT | CLIMBED):
                states[cell] |= CLIMBED
                climb(cell, highest(cell, heights, width), heights, width, journal)


@bare
def climb(cell: int, direction: int, heights: Heights, width: int, journal: ChangeLog) -> None:
    """Link a cell to a higher neighbour, ascend until a saddle, a summit or an earlier ascent, and log every cell.

    Flat indices are row * width + column in the screen padded by one blocked cell on each side.

    Parameters
    ----------
    cell, direction : int
        Flat index of the cell, and the direction (0 east, 1 north, 2 west, 3 south) of the neighbour.
    heights : (cells,) int16 or int32
        Squared clearances in squared half squares, flat.
    width : int
        Width of the padded screen.
    journal : ChangeLog
        In its states links and CLIMBED are set on the way.
    """
    states = journal.states
    while True:
        other = cell + stride(direction, width)
        touch(journal, cell)
        touch(journal, other)
        link(cell, other, direction, states)
        cell = other
        if states[cell] & (CLIMBED | SADDLE | SUMMIT):
            return
        states[cell] |= CLIMBED
        direction = highest(cell, heights, width)
