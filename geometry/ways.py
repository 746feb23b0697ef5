"""What routing needs besides chains and runs: the portals along each chain, and how long a chain is when pulled
tight.
"""

from typing import NamedTuple

import numpy as np

from geometry.chains import Chains, Floats, Ints, find, is_node, onward, stride
from geometry.compiled import compiled
from geometry.distance import Squares
from geometry.heap import pop, push
from geometry.rope import Rope, measure_line, new_rope, tighten_word
from geometry.runs import Runs, extend, symbol_between
from geometry.skeleton import States, steepest

LANDMARKS = 6


class Ways(NamedTuple):
    """For n nodes and m chains."""

    symbol: Ints
    """Per chain cell, the signed portal (from 1) between it and the next cell of its chain; 0 within a row."""
    length: Floats
    """(m,) the length of the tight rope between the chain's ends, in squares."""
    place: Floats
    """(n, 2) the nodes' centres, in squares."""
    sight: Floats
    """(n, landmarks) distances over the pathgraph from the landmarks; infinite where there is no way."""


class Anchor(NamedTuple):
    """Where a square's steepest way up meets the skeleton."""

    chain: int
    """The chain, or -1 at a node without chains."""
    position: int
    """Which of the chain's cells."""
    node: int
    """The node met, or -1 inside a chain."""
    cell: int
    """The padded cell."""


def find_ways(square: Squares, chains: Chains, runs: Runs, body: bool) -> Ways:
    """Prepare routing on a pathgraph."""
    width = square.shape[1]
    symbol = np.zeros(chains.cells.shape[0], np.int32)
    length = np.empty(chains.length.shape[0])
    longest = int(np.diff(chains.start).max(initial=1))
    word, line = np.empty(longest, np.int32), np.empty((4 * longest + 8, 2))
    measure_ways(chains, runs, body, width, symbol, length, word, line, new_rope(2 * longest))
    place = np.stack([chains.node % width - 0.5, chains.node // width - 0.5], axis=1)
    return Ways(symbol, length, place, sights(chains, length))


@compiled
def measure_ways(
    chains: Chains,
    runs: Runs,
    body: bool,
    width: int,
    symbol: Ints,
    length: Floats,
    word: Ints,
    line: Floats,
    rope: Rope,
) -> None:
    """Fill the symbols and tight lengths of all chains."""
    for chain in range(length.shape[0]):
        size = 0
        first, last = chains.start[chain], chains.start[chain + 1] - 1
        for k in range(first, last):
            symbol[k] = symbol_between(runs, chains.cells[k], chains.cells[k + 1], width)
            size = extend(word, size, symbol[k])
        a, b = chains.cells[first], chains.cells[last]
        ends = (a % width - 0.5, a // width - 0.5, b % width - 0.5, b // width - 0.5)
        corners = tighten_word(runs, body, word, size, ends, rope, line)
        length[chain] = measure_line(line, corners)


def sights(chains: Chains, length: Floats) -> Floats:
    """Distances from landmarks: each next one is the node furthest from those before (Goldberg and Harrelson 2005)."""
    n = len(chains.node)
    sight = np.full((n, min(LANDMARKS, n)), np.inf)
    key, node = np.empty(2 * len(length) + 8), np.empty(2 * len(length) + 8, np.int32)
    nearest, spot = np.full(n, np.inf), 0
    for k in range(sight.shape[1]):
        distances_from(chains, length, spot, sight[:, k], key, node)
        if k == 0:  # the first is only a place to start from
            first = np.where(np.isfinite(sight[:, 0]), sight[:, 0], -1.0)
            spot = int(np.argmax(first))
            sight[:, 0] = np.inf
            distances_from(chains, length, spot, sight[:, 0], key, node)
        nearest = np.minimum(nearest, sight[:, k])
        spot = int(np.argmax(nearest))
    return sight


@compiled
def distances_from(chains: Chains, length: Floats, spot: int, out: Floats, key: Floats, node: Ints) -> None:
    """Dijkstra over the whole pathgraph."""
    out[spot] = 0.0
    size = push(key, node, 0, 0.0, spot)
    while size > 0:
        done = key[0]
        here, size = pop(key, node, size)
        if done > out[here]:
            continue
        for direction in range(4):
            chain = chains.leave[here, direction]
            if chain < 0:
                continue
            other = chains.ends[chain, 0] if chains.ends[chain, 1] == here else chains.ends[chain, 1]
            if done + length[chain] < out[other]:
                out[other] = done + length[chain]
                size = push(key, node, size, out[other], other)


@compiled
def ascend(cell: int, square: Squares, state: States, runs: Runs, word: Ints, size: int) -> tuple[int, int]:
    """Go up the steepest way from a cell to the skeleton, adding its portals; returns cell and word size."""
    width = square.shape[1]
    heights, states = square.reshape(-1), state.reshape(-1)
    while states[cell] == 0:
        higher = steepest(cell, heights, width)
        size = extend(word, size, symbol_between(runs, cell, higher, width))
        cell = higher
    return cell, size


@compiled
def locate(cell: int, state: States, chains: Chains) -> Anchor:
    """The place of a skeleton cell on the pathgraph."""
    width = state.shape[1]
    states = state.reshape(-1)
    if is_node(states[cell]):
        return locate_node(cell, chains)
    direction = 0
    while not states[cell] >> direction & 1:
        direction += 1
    steps, here = 0, cell
    while steps == 0 or not is_node(states[here]):
        if steps > 0:
            direction = onward(states[here], direction ^ 2)
        here += stride(direction, width)
        steps += 1
    chain = chains.leave[find(chains.node, here), direction ^ 2]
    first = chains.start[chain]
    if chains.cells[first + steps] != cell:  # we came to the chain's far end (or round a ring to its near one)
        steps = chains.start[chain + 1] - first - 1 - steps
    return Anchor(0 + chain, steps, -1, cell)


@compiled
def locate_node(cell: int, chains: Chains) -> Anchor:
    """The place of a node, as an end of one of its chains if it has any."""
    node, found, position = find(chains.node, cell), -1, 0
    for direction in range(4):
        chain = chains.leave[node, direction]
        if chain >= 0:
            found = chain
            at_start = chains.cells[chains.start[chain]] == cell
            position = 0 if at_start else chains.start[chain + 1] - chains.start[chain] - 1
    return Anchor(found, position, node, cell)


@compiled
def add_chain(chains: Chains, ways: Ways, chain: int, begin: int, end: int, word: Ints, size: int) -> int:
    """Add the portals along a chain from one position to another, in either direction; returns the word's size."""
    first = chains.start[chain]
    if begin <= end:
        for k in range(first + begin, first + end):
            size = extend(word, size, ways.symbol[k])
    else:
        for k in range(first + begin - 1, first + end - 1, -1):
            size = extend(word, size, -ways.symbol[k])
    return size
