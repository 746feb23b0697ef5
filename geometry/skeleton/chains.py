"""The pathgraph with the cells of its chains, in arrays: everything that searches for routes need of it."""

from typing import NamedTuple

import numpy as np

from utak.geometry.kernels.arrays import Ints
from utak.geometry.kernels.jit import bare
from utak.geometry.skeleton.graph import SkeletonGraph, other_direction
from utak.geometry.skeleton.skeleton import Flags, States, stride


class Chains(NamedTuple):
    """The pathgraph of n nodes and m chains, by cells of the padded screen."""

    node: Ints  # Cell of each node, ascending
    leave: Ints  # Number of the chain that leaves a node to the east, north, west, south; -1 where none does
    ends: Ints  # Numbers of the first and the last node of each chain
    start: Ints  # Index into ``cells`` at which the cells of each chain start
    cells: Ints  # Cells of all chains, one chain after the other, both end nodes included
    # Index into ``cells`` of the lowest cell of each chain (least clearance, then least index): its narrowest place
    neck: Ints


def find_chains(bones: SkeletonGraph, state: States) -> Chains:
    """Return a graph with the cells of its chains, found by walking them."""
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
    """Walk every chain from its first end, and fill ``cells``, ``neck`` and ``leave``."""
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
