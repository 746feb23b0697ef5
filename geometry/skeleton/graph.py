"""The skeleton contracted to a graph of nodes and chains, without the cells between.

A node is a skeleton cell with other than two links, or the first cell of a ring that has no such cell. A chain is a
maximal sequence of linked cells between two nodes, both included. Nodes come in ascending order of their cells, chains
in ascending order of their first node and direction, so equal skeletons give equal arrays. The cells of a chain are not
kept: ``state`` links them, and chains.py and pathgraph_arrays.py walk them again when they are asked for.

Directions are numbered counter-clockwise from the east: 0 east, 1 north, 2 west, 3 south.
"""

from typing import NamedTuple

import numpy as np

from utak.geometry.kernels.arrays import Ints, SquaredDistances
from utak.geometry.kernels.jit import bare
from utak.geometry.skeleton.bit_parallel import Eights, count_nodes, list_nodes, node_number
from utak.geometry.skeleton.lowest_cells import MIN_NOTES, Notes, find_lowest, lowest_of, new_notes
from utak.geometry.skeleton.skeleton import HALT, LINKS, SADDLE, Flags, Heights, States, Words, above, stride

NOTES_CHECK_STEPS = 4  # steps of a walk between two checks that there is room for as many notes more (a convention)
WORDS_AHEAD = 1 << 14  # words of states listed ahead of the walk: twice as many (256 kB) fit into a core's own cache


class SkeletonGraph(NamedTuple):
    """The pathgraph of n nodes and m chains, by cells of the padded screen."""

    node: Ints  # Cell of each node, ascending
    # First and last end of each chain, as 4 times the number of the node plus the direction in which the chain leaves
    # it (0 east, 1 north, 2 west, 3 south). The first ends ascend, and each is less than its last end.
    port: Ints
    neck: Ints  # Lowest cell of each chain (least clearance, then least index): its narrowest place
    steps: Ints  # Number of steps from square to square from end to end of each chain


def contract(square: SquaredDistances, state: States, words: Words, min_notes: int = MIN_NOTES) -> SkeletonGraph:
    """Return the graph of a skeleton, and flag the first cells of rings without a junction as nodes in ``state``."""
    heights, states, width = square.reshape(-1), state.reshape(-1), state.shape[1]
    eights, size, notes = words.view(np.int64), len(words), new_notes(len(states), min_notes)
    base, since = np.empty((size + 15) // 16, np.int32), np.empty(size, np.uint8)
    nodes, ends, links = count_nodes(eights, base, since)
    node, port = np.empty(nodes + 1, np.int32), np.empty((ends // 2, 2), np.int32)
    neck, steps = np.empty(ends // 2, np.int32), np.empty(ends // 2, np.int32)
    seen = np.zeros(nodes, np.uint8)
    walked = walk_chains(heights, states, eights, width, base, since, node, port, neck, steps, seen, notes)
    found = SkeletonGraph(node[:nodes], port, neck, steps)
    if walked < links:
        halt_rings(heights, states, width, words)
        found = insert_rings(heights, states, width, found, notes[0])
    return found


def insert_rings(heights: Heights, states: Flags, width: int, bones: SkeletonGraph, notes: Ints) -> SkeletonGraph:
    """Return ``bones`` with the rings added whose first cells are flagged in ``states``, in the order of cells."""
    # New nodes and chains are inserted where the order of cells puts them, so the numbers of old ones behind them grow.
    cells = np.flatnonzero(states >= HALT).astype(np.int32)
    place = bones.node.searchsorted(cells)
    node, ring = np.insert(bones.node, place, cells), (place + np.arange(len(cells))).astype(np.int32)
    port, neck, steps = np.empty((len(ring), 2), np.int32), np.empty(len(ring), np.int32), np.empty(len(ring), np.int32)
    walk_rings(heights, states, width, node, ring, port, neck, steps, notes)
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
def walk_rings(
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
        direction = first_direction(int(states[cell] & LINKS))
        _, back, steps[k], noted = walk_chain(cell, direction, heights, states, width, notes, 0)
        port[k, 0], port[k, 1] = 4 * ring[k] + direction, 4 * ring[k] + back
        neck[k] = lowest_of(notes, 0, noted, heights)


@bare
def halt_rings(heights: Heights, states: Flags, width: int, words: Words) -> None:
    """Set HALT in the state of the first cell of every ring that has no junction."""
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
    """Return the first cell (least flat index) of the ring on which a saddle lies and is the lowest cell."""
    cell, direction, first = saddle, first_direction(int(states[saddle])), saddle
    while True:
        cell += stride(direction, width)
        here = states[cell]
        if cell == saddle:
            return first
        if is_node(here) or (here & SADDLE and above(saddle, cell, heights)):
            return -1
        first = cell if cell < first else first
        direction = other_direction(here, direction ^ 2)


@bare
def is_node(here: int) -> bool:
    """Return whether a cell of the state `here` (links 1, 2, 4, 8; flags 16, 32, 64, HALT 128) is a node."""
    links = (here & 5) + (here >> 1 & 5)
    return bool((here != 0) & ((here & HALT != 0) | ((links & 3) + (links >> 2) != 2)))


@bare
def walk_chains(
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
    """List the nodes, walk every chain once from its first end, and return the number of links (steps) walked."""
    chain, settled, noted, walked, n, found = 0, 0, 0, 0, 0, 0
    for first in range(-WORDS_AHEAD, words.shape[0], WORDS_AHEAD):
        listed, found = found, list_nodes(words, first + WORDS_AHEAD, first + 2 * WORDS_AHEAD, node, found)
        while n < listed:
            cell = int(node[n])
            ends = int(states[cell]) & LINKS & ~int(seen[n])
            while ends != 0:
                direction = first_direction(ends)
                last, back, steps[chain], noted = walk_chain(cell, direction, heights, states, width, notes[0], noted)
                other = node_number(last, words, base, since)
                seen[n] |= 1 << direction
                seen[other] |= 1 << back
                port[chain, 0], port[chain, 1] = 4 * n + direction, 4 * other + back
                walked += steps[chain]
                chain += 1
                if noted > notes.shape[1] >> 1 or chain == neck.shape[0]:
                    find_lowest(notes[0], notes[1], noted, heights, settled, neck)
                    settled, noted = chain, 0
                ends &= ~int(seen[n])
            n += 1
    return walked


@bare
def walk_chain(
    cell: int, direction: int, heights: Heights, states: Flags, width: int, notes: Ints, noted: int
) -> tuple[int, int, int, int]:
    """Walk one chain from a node."""
    # Return its last cell, the direction back from there, its steps, and the notes so far.
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
        if (end or steps % NOTES_CHECK_STEPS == 0) and noted + NOTES_CHECK_STEPS >= notes.shape[0]:
            notes[first] = ~lowest_of(notes, first, noted, heights)
            noted = first + 1
        if end:
            return cell, (back >> 1) - (back >> 3), steps, noted
        way = here & LINKS ^ back


@bare
def other_direction(here: int, back: int) -> int:
    """Return the direction (0 east, 1 north, 2 west, 3 south) of the other link of a cell that has two links."""
    rest = int(here & LINKS) ^ (1 << back)
    return (rest >> 1) - (rest >> 3)


@bare
def first_direction(here: int) -> int:
    """Return the first direction (0 east, 1 north, 2 west, 3 south) in which a cell has a link."""
    first = here & -here
    return (first >> 1) - (first >> 3)


@bare
def find(node: Ints, cell: int) -> int:
    """Return the number of the first node at or after a cell, by bisection; the number of nodes when there is none."""
    low, high = 0, node.shape[0]
    while low < high:
        middle = (low + high) >> 1
        if node[middle] < cell:
            low = middle + 1
        else:
            high = middle
    return low
