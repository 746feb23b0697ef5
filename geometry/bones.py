"""Junctions and chains in short: the skeleton's links contracted to a graph, without the cells between.

A node is a skeleton cell with other than two links (or one cell on a ring that has no such cell). A chain is a
maximal way of linked cells between two nodes, both included. Nodes come in the order of their cells, chains in the
order of their first node and direction, so equal skeletons give equal arrays. The cells of a chain are not kept:
``state`` links them, and chains.py walks them when routes are asked for.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from geometry.compiled import compiled
from geometry.distance import Squares
from geometry.skeleton import HALT, LINKS, Flags, Heights, States, Words

Ints = NDArray[np.int32]
Floats = NDArray[np.float64]
CHORD = 4  # a chain's length is measured by chords of so many steps, since a staircase is no longer than its slope


class Bones(NamedTuple):
    """The pathgraph of n nodes and m chains; cells are padded indices (see distance.py)."""

    node: Ints
    """(n,) cell of each node, ascending."""
    port: Ints
    """(m, 2) first and last end of each chain: 4 node + direction of leaving (east, north, west, south); ascending."""
    neck: Ints
    """(m,) each chain's lowest cell in the order of skeleton.py."""
    length: Floats
    """(m,) length in squares."""


def contract(square: Squares, state: States, words: Words) -> Bones:
    """The chains of the skeleton that ``state`` links."""
    heights, states, width = square.reshape(-1), state.reshape(-1), state.shape[1]
    while True:
        nodes, ends, links = count(states, words)
        bones = Bones(
            np.empty(nodes, np.int32),
            np.empty((ends // 2, 2), np.int32),
            np.empty(ends // 2, np.int32),
            np.empty(ends // 2, np.float64),
        )
        collect(states, words, bones.node)
        walked = pace_all(heights, states, width, *bones, np.zeros(nodes, np.uint8))
        if walked == links:
            return bones
        trodden = np.zeros(states.shape[0], np.bool_)
        tread(states, width, bones.node, bones.port, trodden)
        del bones  # its memory is wanted again
        halt_rings(states, width, trodden)


@compiled
def is_node(here: int) -> bool:
    """Whether a cell of this state is a node: flagged, or one that has links or flags but not two links."""
    if here == 0:
        return False
    links = here & LINKS
    links = (links & 5) + ((links >> 1) & 5)
    return bool((here & HALT) or (links & 3) + (links >> 2) != 2)


@compiled
def count(states: Flags, words: Words) -> tuple[int, int, int]:
    """Nodes, chain ends at nodes, and links of the whole skeleton."""
    nodes, ends, links = 0, 0, 0
    for word in range(words.shape[0]):
        if words[word] == 0:
            continue
        for k in range(8):
            cell = 8 * word + k
            here = int(states[cell]) if cell < states.shape[0] else 0
            degree = (here & 1) + (here >> 1 & 1) + (here >> 2 & 1) + (here >> 3 & 1)
            links += degree
            if is_node(here):
                nodes += 1
                ends += degree
    return nodes, ends, links // 2


@compiled
def collect(states: Flags, words: Words, node: Ints) -> None:
    """List the nodes."""
    found = 0
    for word in range(words.shape[0]):
        if words[word] == 0:
            continue
        for k in range(8):
            cell = 8 * word + k
            if cell < states.shape[0] and is_node(states[cell]):
                node[found] = cell
                found += 1


@compiled
def pace_all(
    heights: Heights, states: Flags, width: int, node: Ints, port: Ints, neck: Ints, length: Floats, seen: States
) -> int:
    """Walk every chain once from its first end; returns the links walked. ``seen`` has the ends met, as bits."""
    chain, walked = 0, 0
    for n in range(node.shape[0]):
        for direction in range(4):
            if seen[n] >> direction & 1 or not states[node[n]] >> direction & 1:
                continue
            last, back, neck[chain], length[chain], steps = pace(node[n], direction, heights, states, width)
            other = find(node, last)
            seen[n] |= 1 << direction
            seen[other] |= 1 << back
            port[chain, 0], port[chain, 1] = 4 * n + direction, 4 * other + back
            walked += steps
            chain += 1
    return walked


@compiled
def pace(cell: int, direction: int, heights: Heights, states: Flags, width: int) -> tuple[int, int, int, float, int]:
    """Walk one chain.

    Returns its last cell, the direction back from there, the lowest cell, its length, and the number of steps.
    """
    low, lowest, length = heights[cell], cell, 0.0
    run, rise, steps = 0, 0, 0
    while True:
        if direction & 1:
            rise += 2 - direction
            cell += width if direction == 1 else -width
        else:
            run += 1 - direction
            cell += 1 if direction == 0 else -1
        steps += 1
        height = heights[cell]
        if height < low or (height == low and cell < lowest):
            low, lowest = height, cell
        here = states[cell]
        end = is_node(here)
        if end or steps % CHORD == 0:
            length += np.sqrt(float(run * run + rise * rise))
            run, rise = 0, 0
        if end:
            return cell, direction ^ 2, lowest, length, steps
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
    """The node of a cell, or the next one, by bisection."""
    low, high = 0, node.shape[0]
    while low < high:
        middle = (low + high) >> 1
        if node[middle] < cell:
            low = middle + 1
        else:
            high = middle
    return low


@compiled
def tread(states: Flags, width: int, node: Ints, port: Ints, trodden: NDArray[np.bool_]) -> None:
    """Mark the cells of all chains."""
    for chain in range(port.shape[0]):
        cell, direction = node[port[chain, 0] >> 2], port[chain, 0] & 3
        trodden[cell] = True
        while True:
            cell += stride(direction, width)
            trodden[cell] = True
            if is_node(states[cell]):
                break
            direction = onward(states[cell], direction ^ 2)


@compiled
def halt_rings(states: Flags, width: int, trodden: NDArray[np.bool_]) -> None:
    """Flag the first cell of every ring that the chains do not meet."""
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
