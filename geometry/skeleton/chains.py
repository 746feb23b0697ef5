"""The cells of chains: the graph of graph.py with everything that routes need of it, in arrays."""

from typing import NamedTuple

import numpy as np

from geometry.kernels.arrays import Ints
from geometry.kernels.jit import bare
from geometry.skeleton.graph import SkeletonGraph, onward
from geometry.skeleton.skeleton import Flags, States, stride


class Chains(NamedTuple):
    """The pathgraph in arrays, for n nodes and m chains; cells are padded indices (see distance_transform.py)."""

    node: Ints
    """(n,) cell of each node, ascending."""
    leave: Ints
    """(n, 4) the chain that leaves a node to the east, north, west, south; -1 where none does."""
    ends: Ints
    """(m, 2) first and last node of each chain."""
    start: Ints
    """(m + 1,) where each chain's cells start in ``cells``."""
    cells: Ints
    """Cells of all chains, end nodes included."""
    neck: Ints
    """(m,) index into ``cells`` of each chain's lowest cell in the order of skeleton.py."""


def find_chains(bones: SkeletonGraph, state: States) -> Chains:
    """Walk all chains."""
    states, width, size = state.reshape(-1), state.shape[1], len(bones.steps)
    start = np.zeros(size + 1, np.int32)
    np.cumsum(bones.steps + 1, out=start[1:])
    cells, neck = np.empty(start[-1], np.int32), np.empty(size, np.int32)
    leave = np.full((len(bones.node), 4), -1, np.int32)
    fill(states, width, bones.node, bones.port, bones.neck, start, cells, neck, leave)
    return Chains(bones.node, leave, bones.port >> 2, start, cells, neck)


@bare
def fill(
    states: Flags, width: int, node: Ints, port: Ints, lowest: Ints, start: Ints, cells: Ints, neck: Ints, leave: Ints
) -> None:
    """Fill ``cells``, ``neck`` and ``leave``."""
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
                direction = onward(states[cell], direction ^ 2)
            cell += stride(direction, width)
