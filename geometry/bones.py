"""Junctions and chains in short: the skeleton's links contracted to a graph, without the cells between.

A node is a skeleton cell with other than two links (or one cell on a ring that has no such cell). A chain is a
maximal way of linked cells between two nodes, both included. Nodes come in the order of their cells, chains in the
order of their first node and direction, so equal skeletons give equal arrays. The cells of a chain are not kept:
``state`` links them, and chains.py walks them when routes are asked for.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from geometry.compiled import bare
from geometry.distance import Squares
from geometry.skeleton import HALT, LINKS, SADDLE, Flags, Heights, States, Words, above, stride

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
    index = np.empty((len(words) + 3) // 4, np.int32)
    while True:
        nodes, ends, links = count(states, words, index)
        node, port = np.empty(nodes + 1, np.int32), np.empty((ends // 2, 2), np.int32)
        neck, length = np.empty(ends // 2, np.int32), np.empty(ends // 2, np.float64)
        collect(states, words, node)
        bones = Bones(node[:nodes], port, neck, length)
        if pace_all(heights, states, width, index, *bones, np.zeros(nodes, np.uint8)) == links:
            return bones
        del node, port, neck, length, bones  # their memory is wanted again
        halt_rings(heights, states, width, words)


@bare
def halt_rings(heights: Heights, states: Flags, width: int, words: Words) -> None:
    """Flag the first cell of every ring that has no junction. On each there is a lowest cell, a saddle."""
    for word in range(words.shape[0]):
        if words[word] == 0:
            continue
        for cell in range(8 * word, 8 * word + 8 if 8 * word + 8 < states.shape[0] else states.shape[0]):
            if states[cell] & SADDLE and not is_node(states[cell]):
                first = first_on_ring(cell, heights, states, width)
                if first >= 0:
                    states[first] |= HALT


@bare
def first_on_ring(saddle: int, heights: Heights, states: Flags, width: int) -> int:
    """The first cell of the ring without a node of which a saddle is the lowest; -1 when it is not."""
    cell, direction, first = saddle, first_way(int(states[saddle])), saddle
    while True:
        cell += stride(direction, width)
        here = states[cell]
        if cell == saddle:
            return first
        if is_node(here) or (here & SADDLE and above(saddle, cell, heights)):
            return -1
        first = cell if cell < first else first
        direction = onward(here, direction ^ 2)


@bare
def is_node(here: int) -> bool:
    """Whether a cell of this state is a node: flagged, or one that has links or flags but not two links."""
    links = (here & 5) + (here >> 1 & 5)
    return bool((here != 0) & ((here & HALT != 0) | ((links & 3) + (links >> 2) != 2)))


@bare
def count(states: Flags, words: Words, index: Ints) -> tuple[int, int, int]:
    """Nodes, chain ends at nodes, and links of the whole skeleton.

    ``index`` gets the number of nodes before each 32 cells.
    """
    nodes, ends, links = 0, 0, 0
    for word in range(words.shape[0]):
        if word & 3 == 0:
            index[word >> 2] = nodes
        if words[word] == 0:
            continue
        for cell in range(8 * word, 8 * word + 8 if 8 * word + 8 < states.shape[0] else states.shape[0]):
            here = int(states[cell])
            found, degree = int(is_node(here)), (here & 1) + (here >> 1 & 1) + (here >> 2 & 1) + (here >> 3 & 1)
            nodes += found
            ends += found * degree
            links += degree
    return nodes, ends, links // 2


@bare
def collect(states: Flags, words: Words, node: Ints) -> None:
    """List the nodes; ``node`` has room for one more."""
    found = 0
    for word in range(words.shape[0]):
        if words[word] == 0:
            continue
        for cell in range(8 * word, 8 * word + 8 if 8 * word + 8 < states.shape[0] else states.shape[0]):
            node[found] = cell  # stands if it is a node
            found += int(is_node(int(states[cell])))


@bare
def pace_all(
    heights: Heights,
    states: Flags,
    width: int,
    index: Ints,
    node: Ints,
    port: Ints,
    neck: Ints,
    length: Floats,
    seen: States,
) -> int:
    """Walk every chain once from its first end; returns the links walked. ``seen`` has the ends met, as bits."""
    chain, walked = 0, 0
    for n in range(node.shape[0]):
        ends = int(states[node[n]]) & LINKS
        for direction in range(4):
            if not ends >> direction & 1 or seen[n] >> direction & 1:
                continue
            last, back, neck[chain], length[chain], steps = pace(0 + node[n], direction, heights, states, width)
            other = 0 + index[last >> 5]
            while node[other] < last:
                other += 1
            seen[n] |= 1 << direction
            seen[other] |= 1 << back
            port[chain, 0], port[chain, 1] = 4 * n + direction, 4 * other + back
            walked += steps
            chain += 1
    return walked


@bare
def pace(cell: int, direction: int, heights: Heights, states: Flags, width: int) -> tuple[int, int, int, float, int]:
    """Walk one chain.

    Returns its last cell, the direction back from there, the lowest cell (an end or a saddle), its length, and the
    number of steps.
    """
    low, lowest, length = heights[cell], cell, 0.0
    run, rise, steps = 0, 0, 0
    while True:
        step, upright = 1 - (direction & 2), direction & 1
        rise += step * upright
        run += step * (1 - upright)
        cell += step * (width if upright else 1)
        steps += 1
        here = states[cell]
        end = is_node(here)
        if end or here & SADDLE:
            height = heights[cell]
            if height < low or (height == low and cell < lowest):
                low, lowest = height, cell
        if end or steps % CHORD == 0:
            length += np.sqrt(float(run * run + rise * rise))
            run, rise = 0, 0
        if end:
            return cell, direction ^ 2, lowest, length, steps
        direction = onward(here, direction ^ 2)


@bare
def onward(here: int, back: int) -> int:
    """The other direction of a cell with two links."""
    rest = int(here & LINKS) ^ (1 << back)
    return (rest >> 1) - (rest >> 3)


@bare
def first_way(here: int) -> int:
    """The first direction of a cell with links."""
    first = here & -here
    return (first >> 1) - (first >> 3)


@bare
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
