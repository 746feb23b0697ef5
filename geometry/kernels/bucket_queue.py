"""A queue for costs that are small whole numbers: a ring of buckets. Plain loops for numba.

Source: Dial 1969, "Algorithm 360: shortest-path forest with topological ordering".
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from geometry.kernels.arrays import Ints
from geometry.kernels.jit import bare, compiled

RING = 2048  # buckets: more than the dearest step


class Queue(NamedTuple):
    """Nodes by cost: first[cost % RING] is the last entry put there, before[entry] the one before it, -1 none.

    used : (2,) entries used, entries that wait.
    """

    first: Ints
    node: Ints
    before: Ints
    used: npt.NDArray[np.int64]


@compiled
def new_queue(size: int) -> Queue:
    """An empty queue with room for so many entries in all."""
    first = np.full(RING, -1, np.int32)
    return Queue(first, np.empty(size, np.int32), np.empty(size, np.int32), np.zeros(2, np.int64))


@bare
def put(queue: Queue, cost: int, node: int) -> None:
    """Put a node into the queue; it is lost when there is no room left."""
    entry = queue.used[0]
    if entry == len(queue.node):
        return
    queue.node[entry], queue.before[entry] = node, queue.first[cost % RING]
    queue.first[cost % RING] = entry
    queue.used[0] += 1
    queue.used[1] += 1


@bare
def take(queue: Queue, now: int) -> int:
    """A node of cost `now`, taken out of the queue; -1 when there is none."""
    entry = queue.first[now % RING]
    if entry < 0:
        return -1
    queue.first[now % RING] = queue.before[entry]
    queue.used[1] -= 1
    return int(queue.node[entry])
