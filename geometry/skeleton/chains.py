"""The pathgraph with the cells of its chains, in arrays: everything that searches for routes need of it."""

from typing import NamedTuple

import numpy as np

from geometry.kernels.arrays import Ints
from geometry.kernels.jit import bare
from geometry.skeleton.graph import SkeletonGraph, other_direction
from geometry.skeleton.skeleton import Flags, States, stride


class Chains(NamedTuple):
    """The pathgraph of n nodes and m chains, by cells of the padded screen.

    A cell is the flat index row * (columns + 2) + column, both counted with the blocked frame of one cell, from the
    south-west. Nodes are junctions and ends of the skeleton, chains the lines of cells between them.

    Attributes
    ----------
    node : (n,) int32
        Cell of each node, ascending.
    leave : (n, 4) int32
        Number of the chain that leaves a node to the east, north, west, south; -1 where none does.
    ends : (m, 2) int32
        Numbers of the first and the last node of each chain.
    start : (m + 1,) int32
        Index into ``cells`` at which the cells of each chain start.
    cells : (start[m],) int32
        Cells of all chains, one chain after the other, both end nodes included.
    neck : (m,) int32
        Index into ``cells`` of the lowest cell of each chain (least clearance, then least index): its narrowest place.
    """

    node: Ints
    leave: Ints
    ends: Ints
    start: Ints
    cells: Ints
    neck: Ints


def find_chains(bones: SkeletonGraph, state: States) -> Chains:
    """Return a graph with the cells of its chains, found by walking them.

    Flat indices are row * width + column in the screen padded by one blocked cell on each side.

    Parameters
    ----------
    bones : SkeletonGraph
        Nodes and chains of the skeleton; its array of nodes becomes part of the result.
    state : (rows + 2, columns + 2) uint8
        Links of the skeleton (bits 1, 2, 4, 8 to the east, north, west, south), of which ``bones`` was made.

    Returns
    -------
    Chains
        The cells of the nodes, the chain that leaves each node in each of the four directions (-1 for none), and of
        each chain its two nodes, its cells from the first to the last, and its lowest cell. Cells are flat padded
        indices. Numbered as in ``bones``; with no chain and no node when the skeleton is empty.
    """
    states, width, size = state.reshape(-1), state.shape[1], len(bones.steps)
    start = np.zeros(size + 1, np.int32)
    np.cumsum(bones.steps + 1, out=start[1:])
    cells, neck = np.empty(start[-1], np.int32), np.empty(size, np.int32)
    leave = np.full((len(bones.node), 4), -1, np.int32)
    fill_cells(states, width, bones.node, bones.port, bones.neck, start, cells, neck, leave)
    return Chains(bones.node, leave, bones.port >> 2, start, cells, neck)


@bare
def fill_cells(
    states: Flags, width: int, node: Ints, port: Ints, lowest: Ints, start: Ints, cells: Ints, neck: Ints, leave: Ints
) -> None:
    """Walk every chain from its first end, and fill ``cells``, ``neck`` and ``leave``.

    Cells are flat indices into the padded screen; n is the number of nodes, m of chains. Flat indices are row * width +
    column in the screen padded by one blocked cell on each side.

    Parameters
    ----------
    states : (cells,) uint8
        States of the skeleton, flat: bits 1, 2, 4, 8 are links to the east, north, west, south, 16 and more flags.
    width : int
        Width of the padded screen.
    node : (n,) int32
        Cell of each node.
    port : (m, 2) int32
        First and last end of each chain: 4 times the number of the node plus the direction (0 east, 1 north, 2 west, 3
        south) in which the chain leaves it.
    lowest : (m,) int32
        Cell of the lowest place of each chain.
    start : (m + 1,) int32
        Index into ``cells`` at which those of each chain start.
    cells : (start[m],) int32
        Filled with the cells of all chains, both end nodes included.
    neck : (m,) int32
        Filled with the index into ``cells`` of the lowest cell of each chain, the first one when a ring has it twice.
    leave : (n, 4) int32
        All -1 at first; filled with the number of the chain that leaves a node to the east, north, west, south.
    """
    for chain in range(port.shape[0]):
        cell, direction = node[port[chain, 0] >> 2] + 0, port[chain, 0] & 3
        leave[port[chain, 0] >> 2, direction] = chain
        leave[port[chain, 1] >> 2, port[chain, 1] & 3] = chain
        first = start[chain]
        for k in range(first, start[chain + 1]):
            cells[k] = cell
            if cell == lowest[chain] and (k == first or cell != cells[first]):
                neck[chain] = k
            if k > first and k < start[chain + 1] - 1:
                direction = other_direction(states[cell], direction ^ 2)
            cell += stride(direction, width)
