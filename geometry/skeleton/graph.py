"""The skeleton contracted to a graph of nodes and chains, without the cells between.

A node is a skeleton cell with other than two links, or the first cell of a ring that has no such cell. A chain is a
maximal sequence of linked cells between two nodes, both included. Nodes come in ascending order of their cells, chains
in ascending order of their first node and direction, so equal skeletons give equal arrays. The cells of a chain are not
kept: ``state`` links them, and chains.py and pathgraph_arrays.py walk them again when they are asked for.

Directions are numbered counter-clockwise from the east: 0 east, 1 north, 2 west, 3 south.
"""

from typing import NamedTuple

import numpy as np

from geometry.kernels.arrays import Ints, SquaredDistances
from geometry.kernels.jit import bare
from geometry.skeleton.bit_parallel import Eights, count_nodes, list_nodes, node_number
from geometry.skeleton.lowest_cells import MIN_NOTES, Notes, find_lowest, lowest_of, new_notes
from geometry.skeleton.skeleton import HALT, LINKS, SADDLE, Flags, Heights, States, Words, above, stride

NOTES_CHECK_STEPS = 4  # steps of a walk between two checks that there is room for as many notes more (a convention)
WORDS_AHEAD = 1 << 14  # words of states listed ahead of the walk: twice as many (256 kB) fit into a core's own cache


class SkeletonGraph(NamedTuple):
    """The pathgraph of n nodes and m chains, by cells of the padded screen.

    A cell is the flat index row * (columns + 2) + column, both counted with the blocked frame of one cell, from the
    south-west. Nodes are junctions and ends of the skeleton, chains the lines of cells between them.

    Attributes
    ----------
    node : (n,) int32
        Cell of each node, ascending.
    port : (m, 2) int32
        First and last end of each chain, as 4 times the number of the node plus the direction in which the chain leaves
        it (0 east, 1 north, 2 west, 3 south). The first ends ascend, and each is less than its last end.
    neck : (m,) int32
        Lowest cell of each chain (least clearance, then least index): its narrowest place.
    steps : (m,) int32
        Number of steps from square to square from end to end of each chain.
    """

    node: Ints
    port: Ints
    neck: Ints
    steps: Ints


def contract(square: SquaredDistances, state: States, words: Words, min_notes: int = MIN_NOTES) -> SkeletonGraph:
    """Return the graph of a skeleton, and flag the first cells of rings without a junction as nodes in ``state``.

    Flat indices are row * width + column in the screen padded by one blocked cell on each side.

    Parameters
    ----------
    square : (rows + 2, columns + 2) int16 or int32
        Squared clearances in squared half squares, (2 * clearance in squares)^2.
    state : (rows + 2, columns + 2) uint8
        Links and flags of the skeleton: of each cell bits 1, 2, 4, 8 are links to the east, north, west, south; 16 says
        that an ascent passed it, 32 saddle, 64 summit, 128 that it was chosen as the node of a ring. That bit, HALT, of
        the first cell (least index) of a ring without a junction is set.
    words : (n,) uint64
        The memory of ``state`` by eights.
    min_notes : int
        The least room for notes, which are the cells that may be the lowest of their chain; it changes no result.

    Returns
    -------
    SkeletonGraph
        The cells of the nodes, ascending (flat padded indices), and of each chain its two ends (4 times the node plus
        the direction in which it leaves), its lowest cell and its number of steps. With no node when the skeleton is
        empty. A summit without links is a node without chains.
    """
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
    """Return ``bones`` with the rings added whose first cells are flagged in ``states``, in the order of cells.

    A ring is a closed chain without a junction; its first cell becomes a node, at which it begins and ends. New nodes
    and chains are inserted where the order of cells puts them, so the numbers of old ones behind them grow. The graph
    holds the cells of nodes, and of each chain its two ends, its lowest cell and its number of steps. Flat indices are
    row * width + column in the screen padded by one blocked cell on each side.

    Parameters
    ----------
    heights : (cells,) int16 or int32
        Squared clearances in squared half squares, flat.
    states : (cells,) uint8
        States of the skeleton, flat; cells with HALT are the first cells of rings.
    width : int
        Width of the padded screen.
    bones : SkeletonGraph
        The graph without the rings; it is not changed.
    notes : (size,) int32
        Scratch for cells that may be the lowest of their ring.
    """
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
    """Walk once around each ring whose only node has a number in ``ring``, and fill its ends, lowest cell and steps.

    Flat indices are row * width + column in the screen padded by one blocked cell on each side.

    Parameters
    ----------
    heights : (cells,) int16 or int32
        Squared clearances in squared half squares, flat.
    states : (cells,) uint8
        States of the skeleton, flat: bits 1, 2, 4, 8 are links to the east, north, west, south, 16 and more flags.
    width : int
        Width of the padded screen.
    node : (n,) int32
        Cell of each node, those of the rings included.
    ring : (r,) int32
        Numbers of the nodes of rings, ascending.
    port : (r, 2) int32
        Filled with the two ends of each ring: 4 times the number of its node plus the direction in which it leaves
        there.
    neck, steps : (r,) int32
        Filled with the lowest cell (flat index) of each ring and its number of steps from square to square.
    notes : (size,) int32
        Scratch for cells that may be the lowest of their ring.
    """
    for k in range(ring.shape[0]):
        cell = int(node[ring[k]])
        direction = first_direction(int(states[cell] & LINKS))
        _, back, steps[k], noted = walk_chain(cell, direction, heights, states, width, notes, 0)
        port[k, 0], port[k, 1] = 4 * ring[k] + direction, 4 * ring[k] + back
        neck[k] = lowest_of(notes, 0, noted, heights)


@bare
def halt_rings(heights: Heights, states: Flags, width: int, words: Words) -> None:
    """Set HALT in the state of the first cell of every ring that has no junction.

    A ring is found from the saddle that is its lowest cell. Its first cell is that of the least index. Flat indices are
    row * width + column in the screen padded by one blocked cell on each side.

    Parameters
    ----------
    heights : (cells,) int16 or int32
        Squared clearances in squared half squares, flat.
    states : (cells,) uint8
        States of the skeleton, flat; changed.
    width : int
        Width of the padded screen.
    words : (cells / 8, rounded up) uint64
        The memory of ``states`` by eights.
    """
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
    """Return the first cell (least flat index) of the ring on which a saddle lies and is the lowest cell.

    -1 when the ring has a node or a lower saddle. Flat indices are row * width + column in the screen padded by one
    blocked cell on each side.

    Parameters
    ----------
    saddle : int
        Flat index of a saddle that is no node.
    heights, states : (cells,)
        Squared clearances in squared half squares, and states of the skeleton, flat.
    width : int
        Width of the padded screen.
    """
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
    """Return whether a cell of the state `here` (links 1, 2, 4, 8; flags 16, 32, 64, HALT 128) is a node.

    It is when flagged HALT, or with links or flags but not two links. State 0, off the skeleton, is none.
    """
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
    """List the nodes, walk every chain once from its first end, and return the number of links (steps) walked.

    Nodes are listed some way ahead of the walk, which then finds the states there in the processor's cache. Rings
    without a node are not walked. Cells are flat indices into the padded screen; n is the number of nodes, m of chains.
    Flat indices are row * width + column in the screen padded by one blocked cell on each side.

    Parameters
    ----------
    heights : (cells,) int16 or int32
        Squared clearances in squared half squares, flat.
    states : (cells,) uint8
        States of the skeleton, flat: bits 1, 2, 4, 8 are links to the east, north, west, south, 16 and more flags.
    words : (cells / 8, rounded up) int64
        The memory of ``states`` by eights.
    width : int
        Width of the padded screen.
    base, since : int32 and uint8
        Nodes before each group of sixteen words, and from there up to each word.
    node : (n + 1,) int32
        Filled with the cells of the nodes, ascending.
    port : (m, 2) int32
        Filled with the first and the last end of each chain: 4 times the number of the node plus the direction (0 east,
        1 north, 2 west, 3 south) in which the chain leaves it.
    neck, steps : (m,) int32
        Filled with the lowest cell of each chain and its number of steps from square to square.
    seen : (n,) uint8
        0 at first; notes the ends met at each node, as bits by direction.
    notes : (2, size) int32
        Scratch for cells that may be the lowest of their chain, and their squared clearances.
    """
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
    """Walk one chain from a node; return its last cell, the direction back from there, its steps, and the notes so far.

    That is: the flat index of the node at its other end, the direction (0 to 3) in which the chain leaves that node,
    the number of steps from square to square, and how many of ``notes`` are in use now. Flat indices are row * width +
    column in the screen padded by one blocked cell on each side.

    Parameters
    ----------
    cell, direction : int
        Flat index of the first node, and the direction (0 east, 1 north, 2 west, 3 south) of the link by which the
        chain leaves it.
    heights, states : (cells,)
        Squared clearances in squared half squares, and states of the skeleton, flat.
    width : int
        Width of the padded screen.
    notes : (size,) int32
        Cells that may be the lowest of their chain: the two ends and the saddles of this one are added, the first as
        ~cell (see lowest_cells.py). When room runs out, those of this chain are replaced by the lowest so far.
    noted : int
        How many of ``notes`` are in use already.
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
        if (end or steps % NOTES_CHECK_STEPS == 0) and noted + NOTES_CHECK_STEPS >= notes.shape[0]:
            notes[first] = ~lowest_of(notes, first, noted, heights)
            noted = first + 1
        if end:
            return cell, (back >> 1) - (back >> 3), steps, noted
        way = here & LINKS ^ back


@bare
def other_direction(here: int, back: int) -> int:
    """Return the direction (0 east, 1 north, 2 west, 3 south) of the other link of a cell that has two links.

    Parameters
    ----------
    here : the state of the cell; its four lowest bits are the links. With other than two links the answer means
        nothing.
    back : the direction of the one link, 0 to 3, as seen from the cell.
    """
    rest = int(here & LINKS) ^ (1 << back)
    return (rest >> 1) - (rest >> 3)


@bare
def first_direction(here: int) -> int:
    """Return the first direction (0 east, 1 north, 2 west, 3 south) in which a cell has a link.

    `here` : its state, with a link at least; the flags in its higher bits do not count (see skeleton.py).
    """
    first = here & -here
    return (first >> 1) - (first >> 3)


@bare
def find(node: Ints, cell: int) -> int:
    """Return the number of the first node at or after a cell, by bisection; the number of nodes when there is none.

    Flat indices are row * width + column in the screen padded by one blocked cell on each side.

    `node` : (n,) cells of nodes (flat indices), ascending. `cell` : a flat index.
    """
    low, high = 0, node.shape[0]
    while low < high:
        middle = (low + high) >> 1
        if node[middle] < cell:
            low = middle + 1
        else:
            high = middle
    return low
