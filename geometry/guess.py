"""What is left to be done at least, from every pose on the board: carrying with Utak's own body and walks left out.

# Strategy: Dijkstra's algorithm backwards from the goal, over poses and the direction in which the body is being pushed
# (none: it lies), so that going on in the same direction is no new command. Costs are small whole numbers: a ring of
# buckets (Dial 1969) holds the queue.
"""

import numpy as np

from geometry.board import COMMAND, Board, Costs, shifted, turned_place
from geometry.compiled import compiled
from geometry.stencil import DIRECTIONS

ACROSS = np.array([d[0] for d in DIRECTIONS])
ALONG = np.array([d[1] for d in DIRECTIONS])
NEVER = np.int32(2**30)
RING = 4096


@compiled
def guess(board: Board, ends: Costs) -> Costs:
    """The least cost left: (4, 9, places), by quarter turn and direction of the push that is under way (8: none).

    ends : (4, places) the price of ending at a pose, -1 where the goal is not met. Below RING - 1200.
    """
    places = ends.shape[1]
    left = np.full((4, 9, places), NEVER, np.int32)
    first = np.full(RING, -1, np.int64)
    size = 1 << 16
    entry, before = np.empty(size, np.int64), np.empty(size, np.int64)
    used, waiting, now = 0, 0, 0
    around = np.empty(3 * board.holds.shape[1] + 16, np.int64)
    price = np.empty(len(around), np.int64)
    for k in range(4):
        for p in range(places):
            if ends[k, p] >= 0 and board.lies[k, p]:
                left[k, 8, p] = ends[k, p]
                if used == size:
                    entry, before, size = _doubled(entry), _doubled(before), 2 * size
                entry[used], before[used] = (k * 9 + 8) * places + p, first[ends[k, p] % RING]
                first[ends[k, p] % RING] = used
                used += 1
                waiting += 1
    while waiting > 0:
        slot = now % RING
        at = first[slot]
        if at < 0:
            now += 1
            continue
        first[slot] = before[at]
        waiting -= 1
        node = entry[at]
        p, km = node % places, node // places
        k, m = km // 9, km % 9
        if left[k, m, p] != now:
            continue
        count = _befores(board, k, m, p, around, price)
        for n in range(count):
            k0, m0, p0 = around[n] // places // 9, around[n] // places % 9, around[n] % places
            cost = now + price[n]
            if cost < left[k0, m0, p0]:
                left[k0, m0, p0] = cost
                if used == size:
                    entry, before, size = _doubled(entry), _doubled(before), 2 * size
                entry[used], before[used] = around[n], first[cost % RING]
                first[cost % RING] = used
                used += 1
                waiting += 1
    return left


@compiled
def _doubled(queue):  # type: ignore[no-untyped-def]
    """A copy twice as long."""
    longer = np.empty(2 * len(queue), queue.dtype)
    longer[: len(queue)] = queue
    return longer


@compiled
def _befores(board, k, m, p, around, price):  # type: ignore[no-untyped-def]
    """The nodes from which one step leads to a node, and its price; how many."""
    places = board.lies.shape[1]
    count = 0
    if m < 8:
        p0 = shifted(board, p, -ACROSS[m], -ALONG[m])
        if p0 >= 0 and board.push[k, m, p0] > 0:
            around[count], price[count] = (k * 9 + m) * places + p0, board.push[k, m, p0]
            around[count + 1], price[count + 1] = (k * 9 + 8) * places + p0, COMMAND + board.push[k, m, p0]
            count += 2
        return count
    for d in range(8):
        around[count], price[count] = (k * 9 + d) * places + p, 0
        count += 1
    for hold in range(board.holds.shape[1]):
        if board.grip[hold] < 0:
            continue
        p1 = turned_place(board, hold, k, p, 1)
        p2 = turned_place(board, hold, k, p, -1)
        if p1 >= 0 and board.lies[(k + 1) % 4, p1]:
            around[count], price[count] = (((k + 1) % 4) * 9 + 8) * places + p1, COMMAND
            count += 1
        if p2 >= 0 and board.lies[(k + 3) % 4, p2]:
            around[count], price[count] = (((k + 3) % 4) * 9 + 8) * places + p2, COMMAND
            count += 1
        here, there = board.holds[k, hold], board.holds[(k + 2) % 4, hold]
        p3 = shifted(board, p, here[0] - there[0], here[1] - there[1])
        if p3 >= 0 and board.lies[(k + 2) % 4, p3]:
            around[count], price[count] = (((k + 2) % 4) * 9 + 8) * places + p3, COMMAND
            count += 1
    return count
