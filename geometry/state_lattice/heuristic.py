"""What is left to be done at least, from every pose on the board: carrying with Utak's own body and walks left out.

# Strategy: Dijkstra's algorithm backwards from the goal, over poses and the direction in which the body is being pushed
# (none: it lies), so that going on in the same direction is no new command. Costs are small whole numbers: a ring of
# buckets holds the queue (geometry.kernels.bucket_queue).
"""

import numpy as np

from geometry.kernels.bucket_queue import new_queue, put, take
from geometry.kernels.jit import compiled
from geometry.state_lattice.lattice import COMMAND, Costs, StateLattice, turn_cost, turned_place

STILL = 8  # the direction of a body that lies
NEVER = 2**30
PUTS = 64  # entries for each pose: far more than come to be, and memory that is not touched costs nothing


@compiled
def guess(board: StateLattice, ends: Costs, bend: int) -> Costs:
    """The least cost left: (4, 9, squares), by quarter turn and direction of the push that is under way.

    ends : (4, squares) the price of ending at a pose, -1 where the goal is not met; below RING. bend : the price of
    going on in another direction in the same push; COMMAND: that is another push.
    NEVER where the goal cannot be reached; -1 where a body that lies would overlap something.
    """
    squares = ends.shape[1]
    left = np.full((4, 9, squares), NEVER, np.int32)
    size = PUTS * 4 * squares
    queue = new_queue(size)
    for k in range(4):
        for p in range(squares):
            if not board.lies[k, p]:
                left[k, STILL, p] = -1
            elif ends[k, p] >= 0:
                left[k, STILL, p] = ends[k, p]
                put(queue, ends[k, p], (p << 8) + (STILL << 4) + k)
    now = 0
    while queue.used[1] > 0:
        node = take(queue, now)
        if node < 0:
            now += 1
            continue
        p, m, k = node >> 8, (node >> 4) & 15, node & 15
        if left[k, m, p] != now:
            continue
        if m < STILL:
            for d in range(8):
                if bend < COMMAND and now + bend < left[k, d, p]:
                    left[k, d, p] = now + bend
                    put(queue, now + bend, (p << 8) + (d << 4) + k)
            _back(board, left, queue, k, m, p, now)
            continue
        for d in range(8):
            if now < left[k, d, p]:
                left[k, d, p] = now
                _back(board, left, queue, k, d, p, now)
        _turn_back(board, left, queue, k, p, now + board.turn)
    return left


@compiled
def _turn_back(board, left, queue, k, p, then):  # type: ignore[no-untyped-def]
    """Go back over the turns that end at a pose, about every hold."""
    for hold in range(len(board.grip)):
        if board.grip[hold] < 0 or board.solid[p + board.holds[k, hold]]:
            continue
        for way in (1, -1):
            p1, p2 = turned_place(board, hold, k, p, way), turned_place(board, hold, k, p, 2 * way)
            k1, k2 = (k + way) % 4, (k + 2) % 4
            if then >= left[k1, STILL, p1] and then >= left[k2, STILL, p2]:
                continue
            extra = turn_cost(board, hold, k, p, way)
            if extra < 0:
                continue
            if then + extra < left[k1, STILL, p1]:
                left[k1, STILL, p1] = then + extra
                put(queue, then + extra, (p1 << 8) + (STILL << 4) + k1)
            if then + extra < left[k2, STILL, p2]:
                more = turn_cost(board, hold, k1, p1, way)
                if more >= 0 and then + max(extra, more) < left[k2, STILL, p2]:
                    left[k2, STILL, p2] = then + max(extra, more)
                    put(queue, then + max(extra, more), (p2 << 8) + (STILL << 4) + k2)


@compiled
def _back(board, left, queue, k, m, p, now):  # type: ignore[no-untyped-def]
    """Go back a step of a push: to the same push under way, and to where it began."""
    before = p - board.steps[m]
    price = board.push[k, m, before]
    if price == 0:
        return
    then = now + price
    if then < left[k, m, before]:
        left[k, m, before] = then
        put(queue, then, (before << 8) + (m << 4) + k)
    if then + COMMAND < left[k, STILL, before]:
        left[k, STILL, before] = then + COMMAND
        put(queue, then + COMMAND, (before << 8) + (STILL << 4) + k)
