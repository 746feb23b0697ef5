"""A priority queue for costs that are small whole numbers: a ring of buckets. Plain loops for numba.

Source: Dial 1969, "Algorithm 360: shortest-path forest with topological ordering".
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from utak.geometry.kernels.arrays import Ints
from utak.geometry.kernels.jit import bare, compiled

BUCKETS = 2048  # number of buckets; bounds the cost of a step, which must be less


class Queue(NamedTuple):
    """Nodes (numbers that the caller chooses) that wait, each with a cost, a whole number; the cheapest comes first."""

    # All costs that wait lie within BUCKETS (2048) of each other, so that each bucket holds nodes of one cost only.

    # (BUCKETS,) int32. first[cost % BUCKETS] is the number of the last entry put into that bucket; -1 for none.
    first: Ints
    node: Ints  # (size,) int32, node of each entry
    before: Ints  # (size,) int32, the number of the entry of the same bucket put before it; -1 for none
    # (2,) int64: number of entries used so far (those taken out included), number of entries that wait now
    used: npt.NDArray[np.int64]


@compiled
def new_queue(size: int) -> Queue:
    """Return an empty queue of nodes (whole numbers that the caller chooses), each with a whole-number cost."""
    first = np.full(BUCKETS, -1, np.int32)
    return Queue(first, np.empty(size, np.int32), np.empty(size, np.int32), np.zeros(2, np.int64))


@bare
def put(queue: Queue, cost: int, node: int) -> None:
    """Put a node into the queue, in place; it is silently lost if all memory (`size` of `new_queue`) is used."""
    entry = queue.used[0]
    if entry == len(queue.node):
        return
    queue.node[entry], queue.before[entry] = node, queue.first[cost % BUCKETS]
    queue.first[cost % BUCKETS] = entry
    queue.used[0] += 1
    queue.used[1] += 1


@bare
def take(queue: Queue, now: int) -> int:
    """Take a node of cost `now` out of the queue, the last one put in, and return it; -1 if none of that cost waits."""
    entry = queue.first[now % BUCKETS]
    if entry < 0:
        return -1
    queue.first[now % BUCKETS] = queue.before[entry]
    queue.used[1] -= 1
    return int(queue.node[entry])
