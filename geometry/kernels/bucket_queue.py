"""A priority queue for costs that are small whole numbers: a ring of buckets. Plain loops for numba.

Source: Dial 1969, "Algorithm 360: shortest-path forest with topological ordering".
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from geometry.kernels.arrays import Ints
from geometry.kernels.jit import bare, compiled

BUCKETS = 2048  # number of buckets; bounds the cost of a step, which must be less


class Queue(NamedTuple):
    """Nodes by cost; all costs that wait lie within BUCKETS of each other.

    Attributes
    ----------
    first : (BUCKETS,) first[cost % BUCKETS] is the last entry put into that bucket; -1 for none.
    node : (size,) node of each entry.
    before : (size,) the entry of the same bucket put before it; -1 for none.
    used : (2,) number of entries used, number of entries that wait.
    """

    first: Ints
    node: Ints
    before: Ints
    used: npt.NDArray[np.int64]


@compiled
def new_queue(size: int) -> Queue:
    """Return an empty queue with memory for `size` entries in all, taken ones included."""
    first = np.full(BUCKETS, -1, np.int32)
    return Queue(first, np.empty(size, np.int32), np.empty(size, np.int32), np.zeros(2, np.int64))


@bare
def put(queue: Queue, cost: int, node: int) -> None:
    """Put a node into the queue; it is lost if no memory is left."""
    entry = queue.used[0]
    if entry == len(queue.node):
        return
    queue.node[entry], queue.before[entry] = node, queue.first[cost % BUCKETS]
    queue.first[cost % BUCKETS] = entry
    queue.used[0] += 1
    queue.used[1] += 1


@bare
def take(queue: Queue, now: int) -> int:
    """Take a node of cost `now` out of the queue and return it; -1 if there is none."""
    entry = queue.first[now % BUCKETS]
    if entry < 0:
        return -1
    queue.first[now % BUCKETS] = queue.before[entry]
    queue.used[1] -= 1
    return int(queue.node[entry])
