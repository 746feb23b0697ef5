"""Junctions and chains: the skeleton's links contracted to a graph held in arrays.

A node is a skeleton cell with other than two links (or one cell on a ring that has no such cell). A chain is a
maximal way of linked cells between two nodes, both included. Nodes come in the order of their cells, chains in the
order of their first node and direction, so equal skeletons give equal arrays.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from geometry.compiled import compiled
from geometry.distance import Squares
from geometry.skeleton import HALT, LINKS, States, Words

Ints = NDArray[np.int32]
Floats = NDArray[np.float64]
CHORD = 4  # a chain's length is measured by chords of so many steps, since a staircase is no longer than its slope


class Chains(NamedTuple):
    """The pathgraph in arrays, for n nodes and m chains; cells are padded indices (see distance.py)."""

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
    length: Floats
    """(m,) length in squares."""


def contract(square: Squares, state: States, words: Words) -> Chains:
    """The chains of the skeleton that ``state`` links."""
    while True:
        nodes, ends, links = count(state, words)
        chains = Chains(
            np.empty(nodes, np.int32),
            np.full((nodes, 4), -1, np.int32),
            np.empty((ends // 2, 2), np.int32),
            np.zeros(ends // 2 + 1, np.int32),
            np.empty(links + ends // 2, np.int32),
            np.empty(ends // 2, np.int32),
            np.empty(ends // 2, np.float64),
        )
        collect(state, words, chains.node)
        walked = walk_all(square, state, *chains)
        if walked == links:
            return chains
        halt_rings(state, words, chains.cells, walked + ends // 2)


@compiled
def is_node(here: int) -> bool:
    """Whether a cell of this state is a node: flagged, or one that has links or flags but not two links."""
    if here == 0:
        return False
    links = here & LINKS
    links = (links & 5) + ((links >> 1) & 5)
    return bool((here & HALT) or (links & 3) + (links >> 2) != 2)


@compiled
def count(state: States, words: Words) -> tuple[int, int, int]:
    """Nodes, chain ends at nodes, and links of the whole skeleton."""
    states = state.reshape(-1)
    nodes, ends, links = 0, 0, 0
    for word in range(words.shape[0]):
        if words[word] == 0:
            continue
        for cell in range(8 * word, min(8 * word + 8, states.shape[0])):
            here = int(states[cell])
            degree = (here & 1) + (here >> 1 & 1) + (here >> 2 & 1) + (here >> 3 & 1)
            links += degree
            if is_node(here):
                nodes += 1
                ends += degree
    return nodes, ends, links // 2


@compiled
def collect(state: States, words: Words, node: Ints) -> None:
    """List the nodes."""
    states = state.reshape(-1)
    found = 0
    for word in range(words.shape[0]):
        if words[word] == 0:
            continue
        for cell in range(8 * word, min(8 * word + 8, states.shape[0])):
            if is_node(states[cell]):
                node[found] = cell
                found += 1


@compiled
def walk_all(
    square: Squares,
    state: States,
    node: Ints,
    leave: Ints,
    ends: Ints,
    start: Ints,
    cells: Ints,
    neck: Ints,
    length: Floats,
) -> int:
    """Walk every chain once from its first node; returns the links walked."""
    width = state.shape[1]
    heights, states = square.reshape(-1), state.reshape(-1)
    chain, used = 0, 0
    for n in range(node.shape[0]):
        for direction in range(4):
            if leave[n, direction] >= 0 or not states[node[n]] >> direction & 1:
                continue
            used, back, neck[chain], length[chain] = walk(node[n], direction, heights, states, width, cells, used)
            other = find(node, cells[used - 1])
            leave[n, direction] = chain
            leave[other, back] = chain
            ends[chain, 0], ends[chain, 1] = n, other
            start[chain + 1] = used
            chain += 1
    return used - chain


@compiled
def walk(
    cell: int, direction: int, heights: Squares, states: States, width: int, cells: Ints, used: int
) -> tuple[int, int, int, float]:
    """Write one chain's cells from ``used`` on.

    Returns where they end, the direction back from the last, the position of the lowest, and the chain's length.
    """
    cells[used] = cell
    neck, low, lowest, length = used, heights[cell], cell, 0.0
    run, rise, steps = 0, 0, 0
    while True:
        used += 1
        if direction & 1:
            rise += 2 - direction
            cell += width if direction == 1 else -width
        else:
            run += 1 - direction
            cell += 1 if direction == 0 else -1
        cells[used] = cell
        steps += 1
        height = heights[cell]
        if height < low or (height == low and cell < lowest):
            neck, low, lowest = used, height, cell
        here = states[cell]
        end = is_node(here)
        if end or steps == CHORD:
            length += np.sqrt(float(run * run + rise * rise))
            run, rise, steps = 0, 0, 0
        if end:
            return used + 1, direction ^ 2, neck, length
        direction = onward(here, direction ^ 2)


@compiled
def onward(here: int, back: int) -> int:
    """The other direction of a cell with two links."""
    rest = (here & LINKS) ^ (1 << back)
    return (0 if rest == 1 else 1) if rest < 4 else (2 if rest == 4 else 3)


@compiled
def stride(direction: int, width: int) -> int:
    """The index step to the east, north, west or south."""
    if direction == 0:
        return 1
    if direction == 1:
        return width
    return -1 if direction == 2 else -width


@compiled
def find(node: Ints, cell: int) -> int:
    """The node of a cell, by bisection."""
    low, high = 0, node.shape[0] - 1
    while low < high:
        middle = (low + high) >> 1
        if node[middle] < cell:
            low = middle + 1
        else:
            high = middle
    return low


@compiled
def halt_rings(state: States, words: Words, cells: Ints, used: int) -> None:
    """Flag the first cell of every ring that the ``used`` chain cells do not meet."""
    states, width = state.reshape(-1), state.shape[1]
    trodden = np.zeros(states.shape[0], np.bool_)
    for k in range(used):
        trodden[cells[k]] = True
    for cell in range(states.shape[0]):
        if trodden[cell] or not states[cell] & LINKS:
            continue
        states[cell] |= HALT
        here, back = cell, -1
        while not trodden[here]:
            trodden[here] = True
            direction = 0
            while direction == back or not states[here] >> direction & 1:
                direction += 1
            here += stride(direction, width)
            back = direction ^ 2
