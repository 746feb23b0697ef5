"""The pathgraph of a skeleton that has changed in places: chains that no change meets are kept.

# Strategy: from every changed cell the old links lead to the ends of the chains it lay on, which go. Changed cells
that are nodes now, and the ends left open, are where new chains start. Nodes and chains are merged with those kept,
in the order that bones.py would give them.
"""

import numpy as np

from geometry.bones import Bones, Floats, Ints, find, first_way, is_node, onward, pace
from geometry.compiled import bare
from geometry.necks import lowest_of, new_notes
from geometry.regrowth import JOINED, MOVED, Journal
from geometry.skeleton import HALT, LINKS, Flags, Heights, stride

GONE = 31  # a node that is none any more, or has changed: all its ends are open


def rejoin(heights: Heights, width: int, bones: Bones, journal: Journal) -> Bones:
    """The pathgraph after a change."""
    states, mark, size = journal.states, journal.mark, int(journal.size[0])
    cells, before = journal.touched[:size], journal.before[:size]
    kept = (states[cells] != before) | (mark[cells] & MOVED > 0)
    order = np.argsort(cells[kept], kind="stable")
    cells, before = cells[kept][order], before[kept][order]
    if not len(cells):
        return bones
    mark[cells] |= JOINED
    open_ends = np.zeros(len(bones.node), np.uint8)
    find_open(states, mark, width, cells, before, bones.node, open_ends)
    bases = np.empty(len(cells), np.int32)
    rings = find_rings(states, mark, width, cells, bases)
    grown = np.unique(np.concatenate([cells, bases[:rings]]))
    keep_nodes(states, grown)
    grown = grown[grown > 0]
    node = np.empty(np.count_nonzero(open_ends < 16) + len(grown), np.int32)
    number = np.empty(len(bones.node), np.int32)
    merge_nodes(bones.node, open_ends, grown, node, number)
    seeds = np.empty(4 * len(node), np.int32)[: 4 * (len(grown) + np.count_nonzero(open_ends))]
    seeds = seeds[: find_seeds(states, node, grown, number, open_ends, seeds)]
    seeds.sort()
    room = len(bones.length) + len(seeds)
    port, neck, length = np.empty((room, 2), np.int32), np.empty(room, np.int32), np.empty(room)
    notes = new_notes(len(heights))[0]
    found = merge_chains(heights, states, width, *bones, open_ends, number, seeds, node, port, neck, length, notes)
    return Bones(node, port[:found], neck[:found], length[:found])


@bare
def find_open(states: Flags, mark: Flags, width: int, cells: Ints, before: Flags, node: Ints, open_ends: Flags) -> None:
    """The ends, as bits per node, of all chains on which a changed cell lay."""
    for k in range(cells.shape[0]):
        if is_node(before[k]):
            open_ends[find(node, cells[k])] = GONE
        states[cells[k]] &= 255 - HALT
        for first in range(4):
            if not before[k] >> first & 1:
                continue
            direction = first
            cell = cells[k] + stride(direction, width)
            while not mark[cell] & JOINED and not is_node(states[cell]):
                direction = onward(states[cell], direction ^ 2)
                cell += stride(direction, width)
            if mark[cell] & JOINED:
                continue
            if states[cell] & HALT:  # the ring that this cell stood for has changed
                states[cell] &= 255 - HALT
                open_ends[find(node, cell)] = GONE
            else:
                open_ends[find(node, cell)] |= 1 << (direction ^ 2)


@bare
def find_rings(states: Flags, mark: Flags, width: int, cells: Ints, bases: Ints) -> int:
    """Flag the first cell of every ring without a junction on which a changed cell lies; returns how many.

    Of the changed cells on a ring only the first comes round.
    """
    found = 0
    for k in range(cells.shape[0]):
        cell = cells[k]
        if states[cell] & LINKS == 0 or is_node(states[cell]):
            continue
        direction, lowest = first_way(int(states[cell])), cell
        cell += stride(direction, width)
        while cell != cells[k] and not is_node(states[cell]) and (cell > cells[k] or not mark[cell] & JOINED):
            lowest = cell if cell < lowest else lowest
            direction = onward(states[cell], direction ^ 2)
            cell += stride(direction, width)
        if cell == cells[k]:
            states[lowest] |= HALT
            bases[found] = lowest
            found += 1
    return found


@bare
def keep_nodes(states: Flags, cells: Ints) -> None:
    """Set to 0 the cells that are no nodes."""
    for k in range(cells.shape[0]):
        if not is_node(states[cells[k]]):
            cells[k] = 0


@bare
def merge_nodes(old: Ints, open_ends: Flags, grown: Ints, node: Ints, number: Ints) -> None:
    """The nodes kept and the new ones, in order; ``number`` gets what each old one is called now, or -1."""
    k, size = 0, 0
    for n in range(old.shape[0]):
        while k < grown.shape[0] and grown[k] <= old[n]:
            node[size] = grown[k]
            size, k = size + 1, k + 1
        number[n] = -1
        if open_ends[n] < 16:
            node[size], number[n] = old[n], size
            size += 1
    while k < grown.shape[0]:
        node[size] = grown[k]
        size, k = size + 1, k + 1


@bare
def find_seeds(states: Flags, node: Ints, grown: Ints, number: Ints, open_ends: Flags, seeds: Ints) -> int:
    """The ends (4 node + direction) where new chains may start; returns how many."""
    found = 0
    for k in range(grown.shape[0]):
        for direction in range(4):
            if states[grown[k]] >> direction & 1:
                seeds[found] = 4 * find(node, grown[k]) + direction
                found += 1
    for n in range(number.shape[0]):
        if number[n] >= 0 and open_ends[n]:
            for direction in range(4):
                if open_ends[n] >> direction & 1:
                    seeds[found] = 4 * number[n] + direction
                    found += 1
    return found


@bare
def merge_chains(
    heights: Heights,
    states: Flags,
    width: int,
    old_node: Ints,
    old_port: Ints,
    old_neck: Ints,
    old_length: Floats,
    open_ends: Flags,
    number: Ints,
    seeds: Ints,
    node: Ints,
    port: Ints,
    neck: Ints,
    length: Floats,
    notes: Ints,
) -> int:
    """The chains kept and the new ones, in order; returns how many."""
    size, k = 0, 0
    for chain in range(old_port.shape[0] + 1):
        first, last = 4 * node.shape[0], 0
        if chain < old_port.shape[0]:
            a, b = old_port[chain, 0], old_port[chain, 1]
            if open_ends[a >> 2] >> (a & 3) & 1 or open_ends[b >> 2] >> (b & 3) & 1:
                continue
            first, last = 4 * number[a >> 2] + (a & 3), 4 * number[b >> 2] + (b & 3)
        while k < seeds.shape[0] and seeds[k] < first:
            end, back, long, _, noted = pace(node[seeds[k] >> 2], seeds[k] & 3, heights, states, width, notes, 0)
            other = 4 * find(node, end) + back
            if seeds[k] < other:
                port[size, 0], port[size, 1], neck[size], length[size] = (
                    seeds[k],
                    other,
                    lowest_of(notes, 0, noted, heights),
                    long,
                )
                size += 1
            k += 1
        if chain < old_port.shape[0]:
            port[size, 0], port[size, 1] = first, last
            neck[size], length[size] = old_neck[chain], old_length[chain]
            size += 1
    return size
