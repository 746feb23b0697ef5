"""The binary heap of heap.py for callers that keep its size in an array and let a full heap lose items."""

import numpy as np
import numpy.typing as npt

from geometry.kernels.arrays import Floats, Ints
from geometry.kernels.heap import pop as take
from geometry.kernels.heap import push as put
from geometry.kernels.jit import bare

Count = npt.NDArray[np.int64]


@bare
def push(key: Floats, item: Ints, size: Count, new_key: float, new_item: int) -> None:
    """Put an item on the heap. size: (2,) how many there are, and how many were lost because there was no room."""
    if size[0] >= len(key):
        size[1] += 1
    else:
        size[0] = put(key, item, size[0], new_key, new_item)


@bare
def pop(key: Floats, item: Ints, size: Count) -> tuple[float, int]:
    """Take the item with the least key off a heap that is not empty."""
    least = key[0]
    best, size[0] = take(key, item, size[0])
    return least, best
