"""Junctions and chains in short: the skeleton's links contracted to a graph, without the cells between.

A node is a skeleton cell with other than two links (or one cell on a ring that has no such cell). A chain is a
maximal way of linked cells between two nodes, both included. Nodes come in the order of their cells, chains in the
order of their first node and direction, so equal skeletons give equal arrays. The cells of a chain are not kept:
``state`` links them, and chains.py walks them when routes are asked for.
"""

from typing import NamedTuple

import numpy as np

from geometry.kernels.arrays import Ints, SquaredDistances
from geometry.kernels.jit import bare
from geometry.skeleton.bit_parallel import Eights, collect, count, number
from geometry.skeleton.lowest_cells import Notes, lowest_of, new_notes, settle
from geometry.skeleton.skeleton import HALT, LINKS, SADDLE, Flags, Heights, States, Words, above, stride

LOOK = 4  # steps of a walk after which it looks whether there is room for as many notes more
AHEAD = 1 << 14  # words of states: twice as many fit into a processor's own cache beside what a walk needs


class SkeletonGraph(NamedTuple):
    """The pathgraph of n nodes and m chains; cells are padded indices (see distance_transform.py)."""

    node: Ints
    """(n,) cell of each node, ascending."""
    port: Ints
    """(m, 2) first and last end of each chain: 4 node + direction of leaving (east, north, west, south); ascending."""
    neck: Ints
    """(m,) each chain's lowest cell in the order of skeleton.py."""
    steps: Ints
    """(m,) how many steps from square to square it takes from end to end."""


def contract(square: SquaredDistances, state: States, words: Words) -> SkeletonGraph:
    """The chains of the skeleton that ``state`` links."""
    heights, states, width = square.reshape(-1), state.reshape(-1), state.shape[1]
    eights, size, notes = words.view(np.int64), len(words), new_notes(len(states))
    base, since = np.empty((size + 15) // 16, np.int32), np.empty(size, np.uint8)
    nodes, ends, links = count(eights, base, since)
    node, port = np.empty(nodes + 1, np.int32), np.empty((ends // 2, 2), np.int32)
    neck, steps = np.empty(ends // 2, np.int32), np.empty(ends // 2, np.int32)
    seen = np.zeros(nodes, np.uint8)
    walked = pace_all(heights, states, eights, width, base, since, node, port, neck, steps, seen, notes)
    found = SkeletonGraph(node[:nodes], port, neck, steps)
    if walked < links:
        halt_rings(heights, states, width, words)
        found = insert_rings(heights, states, width, found, notes[0])
    return found


def insert_rings(heights: Heights, states: Flags, width: int, bones: SkeletonGraph, notes: Ints) -> SkeletonGraph:
    """Return the graph with the rings added whose first cells are flagged. ``notes`` is scratch."""
    cells = np.flatnonzero(states >= HALT).astype(np.int32)
    place = bones.node.searchsorted(cells)
    node, ring = np.insert(bones.node, place, cells), (place + np.arange(len(cells))).astype(np.int32)
    port, neck, steps = np.empty((len(ring), 2), np.int32), np.empty(len(ring), np.int32), np.empty(len(ring), np.int32)
    pace_rings(heights, states, width, node, ring, port, neck, steps, notes)
    shift = 4 * np.bincount(place, minlength=len(bones.node)).cumsum(dtype=np.int32)
    old = bones.port + shift[bones.port >> 2]
    place = old[:, 0].searchsorted(port[:, 0])
    return SkeletonGraph(
        node,
        np.insert(old, place, port, axis=0),
        np.insert(bones.neck, place, neck),
        np.insert(bones.steps, place, steps),
    )


@bare
def pace_rings(
    heights: Heights,
    states: Flags,
    width: int,
    node: Ints,
    ring: Ints,
    port: Ints,
    neck: Ints,
    steps: Ints,
    notes: Ints,
) -> None:
    """Walk once around each ring whose only node has a number in ``ring``, and fill its ends, lowest cell and steps."""
    for k in range(ring.shape[0]):
        cell = int(node[ring[k]])
        direction = first_way(int(states[cell] & LINKS))
        _, back, steps[k], noted = pace(cell, direction, heights, states, width, notes, 0)
        port[k, 0], port[k, 1] = 4 * ring[k] + direction, 4 * ring[k] + back
        neck[k] = lowest_of(notes, 0, noted, heights)


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
def pace_all(
    heights: Heights,
    states: Flags,
    words: Eights,
    width: int,
    base: Ints,
    since: Flags,
    node: Ints,
    port: Ints,
    neck: Ints,
    steps: Ints,
    seen: States,
    notes: Notes,
) -> int:
    """List the nodes and walk every chain once from its first end; returns the links walked.

    ``seen`` has the ends met, as bits. Nodes are listed some way ahead of the walk, which then finds the states there
    in the processor's cache.
    """
    chain, settled, noted, walked, n, found = 0, 0, 0, 0, 0, 0
    for first in range(-AHEAD, words.shape[0], AHEAD):
        listed, found = found, collect(words, first + AHEAD, first + 2 * AHEAD, node, found)
        while n < listed:
            cell = int(node[n])
            ends = int(states[cell]) & LINKS & ~int(seen[n])
            while ends != 0:
                direction = first_way(ends)
                last, back, steps[chain], noted = pace(cell, direction, heights, states, width, notes[0], noted)
                other = number(last, words, base, since)
                seen[n] |= 1 << direction
                seen[other] |= 1 << back
                port[chain, 0], port[chain, 1] = 4 * n + direction, 4 * other + back
                walked += steps[chain]
                chain += 1
                if noted > notes.shape[1] >> 1 or chain == neck.shape[0]:
                    settle(notes[0], notes[1], noted, heights, settled, neck)
                    settled, noted = chain, 0
                ends &= ~int(seen[n])
            n += 1
    return walked


@bare
def pace(
    cell: int, direction: int, heights: Heights, states: Flags, width: int, notes: Ints, noted: int
) -> tuple[int, int, int, int]:
    """Walk one chain.

    Returns its last cell, the direction back from there, the number of steps, and that of notes: its ends and saddles,
    one of which is its lowest cell, are added to the ``noted`` ones.
    """
    steps, first = 0, noted
    notes[noted] = ~cell
    noted += 1
    way = 1 << direction
    while True:
        east, north = (way & 1) - (way >> 2 & 1), (way >> 1 & 1) - (way >> 3)
        cell += east + north * width
        steps += 1
        here = int(states[cell])
        end = is_node(here)
        notes[noted] = cell  # stands if it may be the lowest
        noted += int(end | (here & SADDLE != 0))
        back = way >> 2 | (way & 3) << 2
        if (end or steps % LOOK == 0) and noted + LOOK >= notes.shape[0]:
            notes[first] = ~lowest_of(notes, first, noted, heights)
            noted = first + 1
        if end:
            return cell, (back >> 1) - (back >> 3), steps, noted
        way = here & LINKS ^ back


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
