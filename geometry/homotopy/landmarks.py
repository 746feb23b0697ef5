"""Data that routing precomputes on a pathgraph: words and tight lengths of chains, and distances from landmarks."""

from typing import NamedTuple

import numpy as np

from utak.geometry.homotopy.funnel import Funnel, measure_line, new_funnel, tighten_word
from utak.geometry.homotopy.strips import Strips, append_symbol, symbol_between
from utak.geometry.kernels.arrays import Floats, Ints
from utak.geometry.kernels.heap import pop, push
from utak.geometry.kernels.jit import bare
from utak.geometry.skeleton.chains import Chains
from utak.geometry.skeleton.graph import find, first_direction, is_node, other_direction
from utak.geometry.skeleton.skeleton import Flags, Heights, steepest, stride

LANDMARK_COUNT = 6  # landmarks of a pathgraph, at most; chosen, no measurement on record


class Landmarks(NamedTuple):
    """Precomputed routing data of a pathgraph with n nodes and m chains."""

    # (cells,) for each chain cell, the signed portal between it and the next cell of its chain; 0 within a row
    symbol: Ints
    # (size,) the reduced words, from first to last cell (signed portals, negative when crossed southwards), of all
    # whole chains, one after the other
    word: Ints
    spelt: Ints  # (m + 1,) the index in `word` at which each chain's word starts
    length: Floats  # (m,) the length of each chain when pulled tight between its ends, in squares
    place: Floats  # (n, 2) the nodes' centres (x, y), in squares from the screen's south-west corner
    # (n, 4) the node to which the chain leads that leaves a node to the east, north, west, south; -1 for none, and for
    # a chain that leads back to its own node
    head: Ints
    arc: Ints  # (n, 4) the code of that arc; 0 for none
    step: Floats  # (n, 4) the length of that arc, in squares; 0 for none
    # (n, landmarks) distances over the pathgraph from the landmarks, in squares; infinite where there is no path
    sight: Floats


class Anchor(NamedTuple):
    """The point of the pathgraph at which the steepest ascent from a square meets the skeleton."""

    chain: int  # the number of the chain (at a node: of one of its chains), or -1 at a node without chains
    position: int  # the index of the cell on its chain, from 0 at the chain's first cell; 0 when there is no chain
    node: int  # the number of the node met, or -1 inside a chain
    cell: int  # the index of the cell in the flat padded screen, (row + 1) * width + column + 1


def compute_landmarks(width: int, chains: Chains, strips: Strips) -> Landmarks:
    """Return what routing precomputes on a pathgraph: words, lengths and arcs of its chains, and landmark distances."""
    symbol = np.zeros(chains.cells.shape[0], np.int32)
    length = np.empty(chains.ends.shape[0])
    longest = int(np.diff(chains.start).max(initial=1))
    words, spelt = np.empty(len(symbol) + 1, np.int32), np.zeros(len(length) + 1, np.int32)
    line, funnel = np.empty((4 * longest + 8, 2)), new_funnel(2 * longest)
    find_chain_symbols(chains.start, chains.cells, strips.row, strips.up, strips.left, width, symbol)
    portals = strips.left, strips.right, strips.line
    measure_chains(chains.start, chains.cells, symbol, *portals, width, length, words, spelt, line, funnel)
    place = np.stack([chains.node % width - 0.5, chains.node // width - 0.5], axis=1)
    shape = len(chains.node), 4
    head, arc, step = np.full(shape, -1, np.int32), np.zeros(shape, np.int32), np.zeros(shape)
    find_arcs(chains.leave, chains.ends, length, head, arc, step)
    return Landmarks(
        symbol, words[: spelt[-1]].copy(), spelt, length, place, head, arc, step, landmark_distances(head, step)
    )


@bare
def find_chain_symbols(start: Ints, cells: Ints, row: Ints, up: Ints, left: Ints, width: int, symbol: Ints) -> None:
    """Fill `symbol` with the signed portal between each chain cell and the next of its chain; 0 within a row."""
    for chain in range(start.shape[0] - 1):
        for k in range(start[chain], start[chain + 1] - 1):
            symbol[k] = symbol_between(row, up, left, 0 + cells[k], 0 + cells[k + 1], width)


@bare
def measure_chains(
    start: Ints,
    cells: Ints,
    symbol: Ints,
    left: Ints,
    right: Ints,
    line: Ints,
    width: int,
    length: Floats,
    words: Ints,
    spelt: Ints,
    out: Floats,
    funnel: Funnel,
) -> None:
    """Fill the reduced words (`words`, `spelt`) and the tight lengths of all chains, in squares."""
    for chain in range(length.shape[0]):
        word, size = words[spelt[chain] :], 0
        first, last = start[chain], start[chain + 1] - 1
        for k in range(first, last):
            size = append_symbol(word, size, 0 + symbol[k])
        a, b = cells[first], cells[last]
        ends = (a % width - 0.5, a // width - 0.5, b % width - 0.5, b // width - 0.5)
        corners = tighten_word(left, right, line, word, size, ends, funnel, out)
        length[chain] = measure_line(out, corners)
        spelt[chain + 1] = spelt[chain] + size


@bare
def find_arcs(leave: Ints, ends: Ints, length: Floats, head: Ints, arc: Ints, step: Floats) -> None:
    """Fill the arcs out of every node. A chain from a node back to itself gives no arc."""
    for node in range(leave.shape[0]):
        for slot in range(4):
            chain = leave[node, slot]
            if chain >= 0 and ends[chain, 0] != ends[chain, 1]:
                backward = 0 if ends[chain, 0] == node else 1
                head[node, slot], arc[node, slot] = ends[chain, 1 - backward], 2 * chain + backward
                step[node, slot] = length[chain]


def landmark_distances(head: Ints, step: Floats) -> Floats:
    """Return the distances of all nodes from the landmarks, (n, landmarks) float64, in squares."""
    n = len(head)
    sight = np.full((min(LANDMARK_COUNT, n), n), np.inf)
    key, node = np.empty(4 * n + 8), np.empty(4 * n + 8, np.int32)
    nearest, spot = np.full(n, np.inf), 0
    for k in range(len(sight)):
        fill_distances_from(head, step, spot, sight[k], key, node)
        if k == 0:  # the first is only a place to start from
            spot = int(np.argmax(np.where(np.isfinite(sight[0]), sight[0], -1.0)))
            sight[0] = np.inf
            fill_distances_from(head, step, spot, sight[0], key, node)
        nearest = np.minimum(nearest, sight[k])
        spot = int(np.argmax(nearest))
    return np.ascontiguousarray(sight.T)


@bare
def fill_distances_from(head: Ints, step: Floats, spot: int, out: Floats, key: Floats, node: Ints) -> None:
    """Fill `out` with the distances of all nodes from node `spot` by Dijkstra's algorithm, in squares."""
    out[spot] = 0.0
    size = push(key, node, 0, 0.0, spot)
    while size > 0:
        done = key[0]
        here, size = pop(key, node, size)
        if done > out[here]:
            continue
        for slot in range(4):
            other = 0 + head[here, slot]
            if other >= 0 and done + step[here, slot] < out[other]:
                out[other] = done + step[here, slot]
                size = push(key, node, size, out[other], other)


@bare
def ascend(
    cell: int, heights: Heights, states: Flags, width: int, row: Ints, up: Ints, left: Ints, word: Ints
) -> tuple[int, int]:
    """Climb from a cell to the skeleton along the steepest ascent, writing the portals crossed to `word`."""
    size = 0
    while states[cell] == 0:
        higher = steepest(cell, heights, width)
        size = append_symbol(word, size, symbol_between(row, up, left, cell, higher, width))
        cell = higher
    return cell, size


@bare
def locate(cell: int, states: Flags, width: int, node: Ints, leave: Ints, start: Ints, cells: Ints) -> Anchor:
    """Return the anchor of a skeleton cell: its chain and position on the pathgraph, or its node."""
    if is_node(0 + states[cell]):
        return locate_node(cell, node, leave, start, cells)
    direction, steps, here = first_direction(int(states[cell])), 0, cell
    while steps == 0 or not is_node(0 + states[here]):
        if steps > 0:
            direction = other_direction(0 + states[here], direction ^ 2)
        here += stride(direction, width)
        steps += 1
    chain = leave[find(node, here), direction ^ 2]
    first = start[chain]
    if cells[first + steps] != cell:  # we came to the chain's far end (or round a ring to its near one)
        steps = start[chain + 1] - first - 1 - steps
    return Anchor(0 + chain, steps, -1, cell)


@bare
def locate_node(cell: int, node: Ints, leave: Ints, start: Ints, cells: Ints) -> Anchor:
    """Return the anchor of a node's cell: an end of one of its chains if it has any."""
    number, found, position = find(node, cell), -1, 0
    for direction in range(4):
        chain = 0 + leave[number, direction]
        if chain >= 0:
            found = chain
            position = 0 if cells[start[chain]] == cell else start[chain + 1] - start[chain] - 1
    return Anchor(found, position, number, cell)


@bare
def add_chain(start: Ints, symbol: Ints, chain: int, begin: int, end: int, word: Ints, size: int) -> int:
    """Append the portals along a chain, from position `begin` to `end` in either direction; return the word's size."""
    first = start[chain]
    if begin <= end:
        for k in range(first + begin, first + end):
            size = append_symbol(word, size, 0 + symbol[k])
    else:
        for k in range(first + begin - 1, first + end - 1, -1):
            size = append_symbol(word, size, 0 - symbol[k])
    return size


@bare
def add_word(other: Ints, first: int, last: int, backwards: bool, word: Ints, size: int) -> int:
    """Append part of a reduced word, or its inverse, to a reduced word; return the new size."""
    if backwards:
        while last > first and size > 0 and word[size - 1] == other[last - 1]:
            last, size = last - 1, size - 1
    else:
        while last > first and size > 0 and word[size - 1] == -other[first]:
            first, size = first + 1, size - 1
    if size + last - first >= word.shape[0]:
        return int(word.shape[0])
    for k in range(last - first):
        word[size + k] = -other[last - 1 - k] if backwards else other[first + k]
    return size + last - first
