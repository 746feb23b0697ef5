"""From the word of a route to its way over the skeleton: which chains it walks, and how low it must go.

# Strategy: every class of ways holds exactly one over the skeleton that never turns back. It is found by raising any
way of the class, cell by cell. From a cell, the ways to the higher cells of one group (see skeleton.py) can be deformed
into each other over higher cells only, so a step up to a cell of a group becomes the step to the group's highest edge
neighbour and on along the ring. A cell that is left as it was reached is a spur, and is dropped. What cannot be raised
is a step of the skeleton, or of the steepest way up to it from an end.
"""

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from geometry.bones import Ints, is_node
from geometry.chains import Chains
from geometry.compiled import bare
from geometry.layer import Layer
from geometry.skeleton import GROUPS, Heights, above, beside, higher_about, highest_of, stride
from geometry.ways import locate

FULL = -1
GONE = -1  # the cell of a link of the way that was dropped


class Lifted(NamedTuple):
    """A way over the skeleton."""

    lowest: int
    """The least square on it, its ends included, in half squares."""
    chains: tuple[int, ...]
    """The chains that it walks, in order."""


class Trail(NamedTuple):
    """A way as a linked list of cells, each an edge neighbour of the one before; link 0 is the start, 1 the goal."""

    cell: Ints
    """(room,) padded cells."""
    before: Ints
    """(room,)"""
    after: Ints
    """(room,)"""
    queue: Ints
    """(room,) links to look at."""
    waits: Ints
    """(room,) whether a link is in the queue."""
    tally: Ints
    """(2,) how many links were ever made, and how many wait."""


def new_trail(room: int) -> Trail:
    """Return room for so many links."""
    cell, before, after, queue = (np.empty(room, np.int32) for _ in range(4))
    return Trail(cell, before, after, queue, np.zeros(room, np.int32), np.zeros(2, np.int32))


def lift(layer: Layer, ends: tuple[float, float, float, float], word: Ints) -> Lifted:
    """Return the one way over the skeleton, without turning back, of the class of a reduced word.

    Parameters
    ----------
    ends : x and y of the start, x and y of the goal, in squares, in squares where the body may be.
    word : signed portals from the start's run to the goal's.
    """
    cells = raised_cells(layer, np.array(cells_of_word(layer, ends, word), np.int32))
    heights = layer.square.reshape(-1)
    return Lifted(int(heights[cells].min()), chains_along(layer, cells.tolist()))


def cells_of_word(layer: Layer, ends: tuple[float, float, float, float], word: Ints) -> list[int]:
    """Return the cells of a way of a word, along each run to the nearest square of the next portal."""
    runs, width = layer.runs, layer.square.shape[1]
    row, column = int(ends[1]), int(ends[0])
    cells = [(row + 1) * width + column + 1]
    for symbol in word.tolist():
        portal = abs(symbol) - 1
        column = min(max(column, int(runs.left[portal])), int(runs.right[portal]))
        walk_row(cells, (row + 1) * width + column + 1)
        row += 1 if symbol > 0 else -1
        cells.append((row + 1) * width + column + 1)
    walk_row(cells, (row + 1) * width + int(ends[2]) + 1)
    return cells


def walk_row(cells: list[int], cell: int) -> None:
    """Add the cells from the last one to another of its row."""
    step = 1 if cell > cells[-1] else -1
    cells.extend(range(cells[-1] + step, cell + step, step) if cell != cells[-1] else ())


def raised_cells(layer: Layer, cells: Ints) -> Ints:
    """Return the cells of the way over the skeleton, its ends' steepest ways up included."""
    heights, width, room = layer.square.reshape(-1), layer.square.shape[1], 4 * len(cells) + 256
    while True:
        trail = new_trail(room)
        lay(trail, cells)
        if raise_trail(heights, width, trail) != FULL:
            break
        room *= 4
    out, link = [int(trail.cell[0])], int(trail.after[0]) if len(cells) > 1 else 1
    while link != 1:
        out.append(int(trail.cell[link]))
        link = int(trail.after[link])
    if trail.cell[1] != out[-1]:
        out.append(int(trail.cell[1]))
    return np.array(out, np.int32)


def lay(trail: Trail, cells: Ints) -> None:
    """Make the links of a way, all of them waiting."""
    count = max(len(cells), 2)
    order = np.array([0, *range(2, count), 1], np.int32)
    trail.cell[order[:-1]], trail.cell[1] = cells[: count - 1], cells[-1]
    trail.after[order[:-1]], trail.before[order[1:]] = order[1:], order[:-1]
    trail.before[0], trail.after[1] = GONE, GONE
    trail.queue[:count], trail.waits[:count] = order, 1
    trail.tally[:] = count, count


@bare
def raise_trail(heights: Heights, width: int, trail: Trail) -> int:
    """Raise a way to the skeleton; returns the number of links made, or FULL when there is no room for more."""
    cell, before, after, queue, waits, tally = trail
    while tally[1] > 0:
        tally[1] -= 1
        link = 0 + queue[tally[1]]
        waits[link] = 0
        if cell[link] == GONE:
            continue
        if tally[0] + 16 > cell.shape[0]:
            return FULL
        if link != 1:
            raise_step(heights, width, trail, link, 0 + after[link], True)
        if link != 0:
            raise_step(heights, width, trail, link, 0 + before[link], False)
        if link > 1 and cell[before[link]] == cell[after[link]]:
            drop_spur(trail, link)
    return int(tally[0])


@bare
def raise_step(heights: Heights, width: int, trail: Trail, link: int, next_link: int, forward: bool) -> None:
    """Lead the step from a link to a higher one over the highest edge neighbour of its group."""
    cell = trail.cell
    here, there = 0 + cell[link], 0 + cell[next_link]
    if here == there or not above(there, here, heights):
        return
    higher, side = higher_about(here, heights, width), 0
    while here + beside(side, width) != there:
        side += 2
    rest = int(GROUPS[higher])
    while not rest >> (side >> 1) & 1:
        rest >>= 4
    best = 2 * highest_of(here, rest & 15, heights, width)
    if best == side:
        return
    turn = 1
    spot = best
    while spot != side:  # which way round there are only higher cells
        spot = (spot + 1) & 7
        if not higher >> spot & 1:
            turn = 7
            break
    spot, last = best, link
    while spot != side:
        last = insert_link(trail, here + beside(spot, width), last, next_link, forward)
        spot = (spot + turn) & 7
    wait(trail, link)
    wait(trail, next_link)


@bare
def insert_link(trail: Trail, cell: int, last: int, next_link: int, forward: bool) -> int:
    """Put a cell between two links of a way; returns its link."""
    new = 0 + trail.tally[0]
    trail.tally[0] += 1
    trail.cell[new], trail.waits[new] = cell, 0
    if forward:
        trail.after[last], trail.before[new], trail.after[new], trail.before[next_link] = new, last, next_link, new
    else:
        trail.before[last], trail.after[new], trail.before[new], trail.after[next_link] = new, last, next_link, new
    wait(trail, new)
    return int(new)


@bare
def drop_spur(trail: Trail, link: int) -> None:
    """Drop a link that is left as it was reached, with one of the two beside it, which are the same cell."""
    cell, before, after = trail.cell, trail.before, trail.after
    first, last = 0 + before[link], 0 + after[link]
    cell[link] = GONE
    if first == 0 and last == 1:
        after[0], before[1] = 1, 0
        return
    if last == 1:
        cell[first] = GONE
        first = 0 + before[first]
        after[first], before[last] = last, first
    else:
        cell[last] = GONE
        last = 0 + after[last]
        after[first], before[last] = last, first
    wait(trail, first)
    wait(trail, last)


@bare
def wait(trail: Trail, link: int) -> None:
    """Look at a link again."""
    if not trail.waits[link]:
        trail.waits[link] = 1
        trail.queue[trail.tally[1]] = link
        trail.tally[1] += 1


def chains_along(layer: Layer, cells: list[int]) -> tuple[int, ...]:
    """Return the chains that a way over the skeleton walks, in order."""
    states, width, chains = layer.state.reshape(-1), layer.square.shape[1], layer.chains
    track = [cell for cell in cells if states[cell]]  # the steepest ways up to it are no part of the skeleton
    found: list[int] = []
    for k, (cell, other) in enumerate(pairwise(track)):
        if is_node(states[cell]):
            found.append(chain_out(chains, cell, other, width))
        elif k == 0:
            anchor = locate(cell, states, width, chains.node, chains.leave, chains.start, chains.cells)
            found.append(anchor.chain)
    return tuple(found)


def chain_out(chains: Chains, cell: int, other: int, width: int) -> int:
    """Return the chain that leaves a node to a cell beside it."""
    node = int(np.searchsorted(chains.node, cell))
    direction = next(k for k in range(4) if cell + stride(k, width) == other)
    return int(chains.leave[node, direction])
