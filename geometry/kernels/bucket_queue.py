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
    """Nodes (numbers that the caller chooses) that wait, each with a cost, a whole number; the cheapest comes first.

    All costs that wait lie within BUCKETS (2048) of each other, so that each bucket holds nodes of one cost only.

    Attributes
    ----------
    first : (BUCKETS,) int32. first[cost % BUCKETS] is the number of the last entry put into that bucket; -1 for none.
    node : (size,) int32, node of each entry.
    before : (size,) int32, the number of the entry of the same bucket put before it; -1 for none.
    used : (2,) int64: number of entries used so far (those taken out included), number of entries that wait now.
    """

    first: Ints
    node: Ints
    before: Ints
    used: npt.NDArray[np.int64]


@compiled
def new_queue(size: int) -> Queue:
    """Return an empty queue of nodes (whole numbers that the caller chooses), each with a whole-number cost.

    The Queue holds BUCKETS buckets of linked entries and the counts of entries used and waiting; `put` and `take`
    change it.

    Parameters
    ----------
    size : how many nodes can be put into it in all; memory of nodes that were taken out is not used again.
    """
    first = np.full(BUCKETS, -1, np.int32)
    return Queue(first, np.empty(size, np.int32), np.empty(size, np.int32), np.zeros(2, np.int64))


@bare
def put(queue: Queue, cost: int, node: int) -> None:
    """Put a node into the queue, in place; it is silently lost if all memory (`size` of `new_queue`) is used.

    Parameters
    ----------
    queue : changed in place.
    cost : a whole number, 0 or more, less than the least cost that waits plus BUCKETS (2048); not checked.
    node : a whole number. It may wait several times, also with different costs.
    """
    entry = queue.used[0]
    if entry == len(queue.node):
        return
    queue.node[entry], queue.before[entry] = node, queue.first[cost % BUCKETS]
    queue.first[cost % BUCKETS] = entry
    queue.used[0] += 1
    queue.used[1] += 1


@bare
def take(queue: Queue, now: int) -> int:
    """Take a node of cost `now` out of the queue, the last one put in, and return it; -1 if none of that cost waits.

    The caller goes through the costs: from the least on, to the next one when -1 is returned, until queue.used[1] is 0.

    Parameters
    ----------
    queue : changed in place.
    now : the least cost that may still wait, a whole number as given to `put`.
    """
    entry = queue.first[now % BUCKETS]
    if entry < 0:
        return -1
    queue.first[now % BUCKETS] = queue.before[entry]
    queue.used[1] -= 1
    return int(queue.node[entry])
