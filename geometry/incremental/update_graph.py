"""The graph of a skeleton that has changed in places: chains that no change meets are kept.

# Strategy: from every changed cell the old links lead to the ends of the chains it lay on, and these chains go. New
chains start at changed cells that are nodes now and at the ends left open. They are walked and spliced in
(splice_arrays.py) in the order that graph.py would give them.
"""

from bisect import bisect_left

import numpy as np

from geometry.incremental.splice_arrays import splice_chains, splice_nodes
from geometry.incremental.update_skeleton import JOINED, MOVED, PASSED, ChangeLog
from geometry.kernels.arrays import Ints, Longs
from geometry.kernels.jit import bare
from geometry.skeleton.graph import SkeletonGraph, find, first_direction, is_node, other_direction
from geometry.skeleton.skeleton import HALT, LINKS, Flags, Heights, stride

IS_NODE_STATE = np.array([bool(state) and is_node.function(state) for state in range(256)])
"""(256,) bool by state: whether a cell of that state is a node."""

NODE_GONE = 31  # open ends of a node that is no longer one, or has changed: all four, and a mark


def rejoin(heights: Heights, width: int, bones: SkeletonGraph, journal: ChangeLog) -> SkeletonGraph:
    """Return the graph after a change of the skeleton.

    Flat indices are row * width + column in the screen padded by one blocked cell on each side.

    Parameters
    ----------
    heights : (cells,) int16 or int32
        Squared clearances in squared half squares after the change, flat.
    width : int
        Width of the padded screen.
    bones : SkeletonGraph
        The graph before the change. Its arrays may be reused for the result, so that it no longer holds.
    journal : ChangeLog
        The cells that may have changed, with their states before. In its states the bit HALT is set and cleared as
        rings without a junction come and go; its marks get JOINED and PASSED.

    Returns
    -------
    SkeletonGraph
        The cells of the nodes, and the ends, lowest cells and numbers of steps of the chains. Equal to that of a new
        screen; ``bones`` itself when nothing in it has changed.
    """
    states, mark = journal.states, journal.mark
    keys = np.empty(int(journal.size[0]), np.int64)
    keys = keys[: find_changed(journal, keys)]
    if not len(keys):
        return bones
    keys.sort()
    cells, before = (keys >> 8).astype(np.int32), keys.astype(np.uint8)
    open_ends = np.zeros(len(bones.node), np.uint8)
    low, high = find_open(states, mark, width, cells, before, bones.node, open_ends)
    bases = np.empty(len(cells), np.int32)
    rings = find_rings(states, mark, width, cells, bases)
    if rings:
        cells = np.unique(np.concatenate([cells, bases[:rings]]))
    grown = cells[IS_NODE_STATE[states[cells]]]
    if len(grown):
        low, high = min(low, bisect_left(bones.node, grown[0])), max(high, bisect_left(bones.node, grown[-1]))
    if low > high:
        return bones
    splice = splice_nodes(bones.node, low, high, open_ends, grown)
    seeds = np.empty(4 * (len(grown) + high - low), np.int32)
    seeds = seeds[: find_seeds(states, splice.node, grown, low, splice.number, open_ends, seeds)]
    seeds.sort()
    return splice_chains(heights, states, width, bones, splice, open_ends, seeds)


@bare
def find_changed(journal: ChangeLog, keys: Longs) -> int:
    """Mark the touched cells that differ as JOINED, list them in ``keys``, and return their number.

    Flat indices are row * width + column in the screen padded by one blocked cell on each side.

    Parameters
    ----------
    journal : ChangeLog
        The cells that may have changed (`touched`, of which size[0] are listed), with their states before; its marks
        are changed: JOINED (4) is set where a cell's chain is to be joined again.
    keys : (touched,) int64
        Filled from index 0 on with 256 times the cell (flat index) plus its state before, for each cell whose state or
        clearance differs.
    """
    found = 0
    for k in range(journal.size[0]):
        cell = journal.touched[k]
        if journal.states[cell] != journal.before[k] or journal.mark[cell] & MOVED:
            journal.mark[cell] |= JOINED
            keys[found] = np.int64(cell) << 8 | journal.before[k]
            found += 1
    return found


@bare
def find_open(
    states: Flags, mark: Flags, width: int, cells: Ints, before: Flags, node: Ints, open_ends: Flags
) -> tuple[int, int]:
    """Set ``open_ends``: for each old node the bits of the ends of all chains on which a changed cell lay.

    Returns the numbers of the first node with such an end and of the one behind the last; the number of nodes and 0
    when there is none. Flat indices are row * width + column in the screen padded by one blocked cell on each side.

    Parameters
    ----------
    states, mark : (cells,) uint8
        States of the skeleton after the change, in which HALT is cleared on changed rings, and marks
        (JOINED, 4: changed).
    width : int
        Width of the padded screen.
    cells, before : (k,) int32 and uint8
        The changed cells (flat indices, ascending) and their states before the change.
    node : (n,) int32
        Cells of the old nodes, ascending.
    open_ends : (n,) uint8
        0 at first; filled with bits by direction (0 east to 3 south), or NODE_GONE (31) where the node itself has
        changed.
    """
    low, high = node.shape[0], 0
    for k in range(cells.shape[0]):
        if is_node(before[k]):
            here = find(node, cells[k])
            open_ends[here] = NODE_GONE
            low, high = here if here < low else low, here + 1 if here >= high else high
        states[cells[k]] &= 255 - HALT
        for first in range(4):
            if not before[k] >> first & 1:
                continue
            direction = first
            cell = cells[k] + stride(direction, width)
            while not mark[cell] & JOINED and not is_node(states[cell]):
                direction = other_direction(states[cell], direction ^ 2)
                cell += stride(direction, width)
            if mark[cell] & JOINED:
                continue
            here = find(node, cell)
            low, high = here if here < low else low, here + 1 if here >= high else high
            if states[cell] & HALT:  # the ring that this cell stood for has changed
                states[cell] &= 255 - HALT
                open_ends[here] = NODE_GONE
            else:
                open_ends[here] |= 1 << (direction ^ 2)
    return low, high


@bare
def find_rings(states: Flags, mark: Flags, width: int, cells: Ints, bases: Ints) -> int:
    """Flag the first cell of every ring without a junction on which a changed cell lies; return the number of rings.

    Each chain is followed only from changed cells that no earlier walk passed. HALT (128 in a state) makes a cell a
    node. Flat indices are row * width + column in the screen padded by one blocked cell on each side.

    Parameters
    ----------
    states, mark : (cells,) uint8
        States of the skeleton, in which HALT is set on the first cell (least index) of such rings, and marks, which get
        PASSED.
    width : int
        Width of the padded screen.
    cells : (k,) int32
        The changed cells, flat indices.
    bases : (k,) int32
        Filled from index 0 on with the first cells of the rings.
    """
    found = 0
    for k in range(cells.shape[0]):
        cell = cells[k]
        if states[cell] & LINKS == 0 or is_node(states[cell]) or mark[cell] & PASSED:
            continue
        mark[cell] |= PASSED
        direction, lowest = first_direction(int(states[cell])), cell
        cell += stride(direction, width)
        while cell != cells[k] and not is_node(states[cell]) and not mark[cell] & PASSED:
            if mark[cell] & JOINED:
                mark[cell] |= PASSED
            lowest = cell if cell < lowest else lowest
            direction = other_direction(states[cell], direction ^ 2)
            cell += stride(direction, width)
        if cell == cells[k]:
            states[lowest] |= HALT
            bases[found] = lowest
            found += 1
    return found


@bare
def find_seeds(states: Flags, node: Ints, grown: Ints, low: int, number: Longs, open_ends: Flags, seeds: Ints) -> int:
    """Fill ``seeds`` with the ends where new chains may start, and return their number.

    An end is 4 times the new number of the node plus the direction (0 east to 3 south). They are not sorted. Flat
    indices are row * width + column in the screen padded by one blocked cell on each side.

    Parameters
    ----------
    states : (cells,) uint8
        States of the skeleton after the change, flat.
    node : (new n,) int32
        Cells of all nodes after the change, ascending.
    grown : (g,) int32
        Cells of the new nodes; each of their links is a seed.
    low, number : int and (s,) int64
        The new numbers of the old nodes from ``low`` on, -1 for those that are gone.
    open_ends : (old n,) uint8
        For each old node the bits (by direction) of the ends whose chains are gone; these are seeds where the node
        stays.
    seeds : (4 (g + s),) int32
        Filled from index 0 on.
    """
    found = 0
    for k in range(grown.shape[0]):
        for direction in range(4):
            if states[grown[k]] >> direction & 1:
                seeds[found] = 4 * find(node, grown[k]) + direction
                found += 1
    for n in range(number.shape[0]):
        if number[n] >= 0 and open_ends[low + n]:
            for direction in range(4):
                if open_ends[low + n] >> direction & 1:
                    seeds[found] = 4 * number[n] + direction
                    found += 1
    return found
