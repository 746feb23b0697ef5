"""Lifting: from the word of a route to its path over the skeleton, that is, its chains and its least clearance.

A path is a list of cells, each an edge neighbour of the one before; a link is an entry of that list. Cells are indices
in the flat padded grid, (row + 1) * width + column + 1. A cell is higher than another when its clearance is greater, or
as great and its index greater.

# Strategy: every class of paths holds exactly one path over the skeleton that never turns back. It is found by raising
any path of the class, cell by cell. From a cell, the paths to the higher cells of one group (see skeleton.py) can be
deformed into each other over higher cells only, so a step up to a cell of a group becomes the step to the group's
highest edge neighbour and on along the ring. A cell that is left as it was reached is a spur, and is dropped. What
cannot be raised is a step of the skeleton, or of the steepest ascent to it from an end.
"""

from typing import NamedTuple

import numpy as np

from utak.geometry.homotopy.funnel import Ends
from utak.geometry.homotopy.landmarks import locate
from utak.geometry.homotopy.strips import Strips
from utak.geometry.kernels.arrays import Ints
from utak.geometry.kernels.jit import bare
from utak.geometry.routes.layer import Layer
from utak.geometry.skeleton.chains import Chains
from utak.geometry.skeleton.graph import find, is_node
from utak.geometry.skeleton.skeleton import GROUPS, Flags, Heights, above, beside, higher_about, highest_of

TRAIL_OVERFLOW = -1  # returned when the trail has no room
DROPPED = -1  # the cell of a link that was dropped from its path


class Lifted(NamedTuple):
    """A path over the skeleton."""

    lowest: int  # the least squared clearance on it, its ends included, in squared half squares
    # The numbers of the chains (edges of the pathgraph) that it follows, in order; empty when it follows none
    chains: tuple[int, ...]


class Trail(NamedTuple):
    """A path as a linked list of cells, each an edge neighbour of the one before."""

    # Link 0 is the start, link 1 the goal.

    # (room,) the padded cell of each link (index in the flat padded grid, (row + 1) * width + column + 1), or DROPPED
    cell: Ints
    before: Ints  # (room,) the number of the link before, DROPPED at the start
    after: Ints  # (room,) the number of the link after, DROPPED at the goal
    queue: Ints  # (room,) numbers of links to examine
    queued: Ints  # (room,) 1 when a link is in the queue, else 0
    counts: Ints  # (2,) how many links were ever made, and how many are in the queue


def new_trail(room: int) -> Trail:
    """Return scratch for a path of at most `room` links, which are entries of a linked list of cells; it holds none."""
    cell, before, after, queue = (np.empty(room, np.int32) for _ in range(4))
    return Trail(cell, before, after, queue, np.zeros(room, np.int32), np.zeros(2, np.int32))


def lift_to_skeleton(layer: Layer, ends: Ends, word: Ints, trail: Trail | None = None) -> tuple[Lifted, Trail]:
    """Return the one path over the skeleton, without turning back, of the class of a reduced word."""
    trail = trail or new_trail(4 * len(word) + 1024)
    heights, states, width, chains, strips, _ = layer
    while (size := lift_word(heights, states, width, chains, strips, ends, word, trail)) == TRAIL_OVERFLOW:
        trail = new_trail(4 * len(trail.cell))
    lowest, *followed = trail.queue[:size].tolist()
    return Lifted(lowest, tuple(followed)), trail


@bare
def lift_word(
    heights: Heights, states: Flags, width: int, chains: Chains, strips: Strips, ends: Ends, word: Ints, trail: Trail
) -> int:
    """Write the least squared clearance and the chains of a word's path over the skeleton to the trail's queue."""
    # Return how many numbers these are (the clearance first, then the numbers of the chains in order), or
    # TRAIL_OVERFLOW when there is no room.
    if (
        write_cells_of_word(strips, ends, word, width, trail) == TRAIL_OVERFLOW
        or raise_to_skeleton(heights, width, trail) == TRAIL_OVERFLOW
    ):
        return TRAIL_OVERFLOW
    cell, after, out = trail.cell, trail.after, trail.queue
    link, last, size, lowest = 0, -1, 1, heights[cell[0]]
    while link >= 0:
        here = 0 + cell[link]
        lowest = heights[here] if heights[here] < lowest else lowest
        if states[here] != 0 and here != last:  # the steepest ascents to the skeleton are no part of it
            if last >= 0 and is_node(0 + states[last]):
                out[size] = chains.leave[find(chains.node, last), direction_of(here - last)]
                size += 1
            elif last >= 0 and size == 1:
                out[1] = locate(last, states, width, chains.node, chains.leave, chains.start, chains.cells).chain
                size = 2
            last = here
        link = 0 + after[link]
    out[0] = lowest
    return size


@bare
def direction_of(step: int) -> int:
    """Return the direction of an index step between edge neighbours: 0 east, 1 north, 2 west, 3 south."""
    if step == 1 or step == -1:
        return 1 - step
    return 1 if step > 0 else 3


@bare
def write_cells_of_word(strips: Strips, ends: Ends, word: Ints, width: int, trail: Trail) -> int:
    """Write the cells of a path with this word as a linked list, and return the number of links."""
    # Link 0 is the start, link 1 the goal; those between are numbered from 2 in order.
    cell, before, after, queue, queued, counts = trail
    left, right = strips.left, strips.right
    row, column, last, new = int(ends[1]), int(ends[0]), 0, 2
    cell[0] = (row + 1) * width + column + 1
    for k in range(word.shape[0] + 1):
        end = k == word.shape[0]
        portal = 0 if end else abs(word[k]) - 1
        target = int(ends[2]) if end else column
        if not end:
            target = left[portal] if column < left[portal] else right[portal] if column > right[portal] else column
        if new + abs(target - column) + 32 > cell.shape[0]:
            return TRAIL_OVERFLOW
        while column != target or not end:
            if column != target:
                column += 1 if column < target else -1
            else:
                row += 1 if word[k] > 0 else -1
                end = True
            cell[new], before[new], after[last] = (row + 1) * width + column + 1, last, new
            last = new
            new += 1
    if last > 0:  # the last link is the goal
        new -= 1
        cell[1], last = cell[last], before[last]
    else:
        cell[1] = cell[0]
    before[1], after[last], before[0], after[1] = last, 1, DROPPED, DROPPED
    for link in range(new):
        queue[link], queued[link] = link, 1
    counts[0], counts[1] = new, new
    return new


@bare
def raise_to_skeleton(heights: Heights, width: int, trail: Trail) -> int:
    """Raise a path to the skeleton and return the number of links made, or TRAIL_OVERFLOW without room for more."""
    cell, before, after, queue, queued, counts = trail
    while counts[1] > 0:
        counts[1] -= 1
        link = 0 + queue[counts[1]]
        queued[link] = 0
        if cell[link] == DROPPED:
            continue
        if counts[0] + 16 > cell.shape[0]:
            return TRAIL_OVERFLOW
        if link != 1:
            raise_step(heights, width, trail, link, 0 + after[link], True)
        if link != 0:
            raise_step(heights, width, trail, link, 0 + before[link], False)
        if link > 1 and cell[before[link]] == cell[after[link]]:
            drop_spur(trail, link)
    return int(counts[0])


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
    position = best
    while position != side:  # which way round there are only higher cells
        position = (position + 1) & 7
        if not higher >> position & 1:
            turn = 7
            break
    position, last = best, link
    while position != side:
        last = insert_link(trail, here + beside(position, width), last, next_link, forward)
        position = (position + turn) & 7
    enqueue(trail, link)
    enqueue(trail, next_link)


@bare
def insert_link(trail: Trail, cell: int, last: int, next_link: int, forward: bool) -> int:
    """Put a cell between two links of a path, queue it, and return the number of its link."""
    new = 0 + trail.counts[0]
    trail.counts[0] += 1
    trail.cell[new], trail.queued[new] = cell, 0
    if forward:
        trail.after[last], trail.before[new], trail.after[new], trail.before[next_link] = new, last, next_link, new
    else:
        trail.before[last], trail.after[new], trail.before[new], trail.after[next_link] = new, last, next_link, new
    enqueue(trail, new)
    return int(new)


@bare
def drop_spur(trail: Trail, link: int) -> None:
    """Drop a link that is left as it was reached, with one of its two neighbours, which are the same cell."""
    cell, before, after = trail.cell, trail.before, trail.after
    first, last = 0 + before[link], 0 + after[link]
    cell[link] = DROPPED
    if first == 0 and last == 1:
        after[0], before[1] = 1, 0
        return
    if last == 1:
        cell[first] = DROPPED
        first = 0 + before[first]
        after[first], before[last] = last, first
    else:
        cell[last] = DROPPED
        last = 0 + after[last]
        after[first], before[last] = last, first
    enqueue(trail, first)
    enqueue(trail, last)


@bare
def enqueue(trail: Trail, link: int) -> None:
    """Put a link, by number, into the trail's queue of links to examine, unless it is there."""
    if not trail.queued[link]:
        trail.queued[link] = 1
        trail.queue[trail.counts[1]] = link
        trail.counts[1] += 1
