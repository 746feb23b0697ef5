"""A binary heap of fixed capacity: its size is kept in an array, and a full heap drops what is put on it."""

import numpy as np
import numpy.typing as npt

from utak.geometry.kernels.arrays import Floats, Ints
from utak.geometry.kernels.heap import pop as pop_item
from utak.geometry.kernels.heap import push as push_item
from utak.geometry.kernels.jit import bare

HeapSize = npt.NDArray[np.int64]  # (2,) number of items on the heap, number of items dropped


@bare
def push(key: Floats, item: Ints, size: HeapSize, new_key: float, new_item: int) -> None:
    """Put an item on the heap, or count it as dropped if the heap is full; nothing is returned."""
    if size[0] >= len(key):
        size[1] += 1
    else:
        size[0] = push_item(key, item, size[0], new_key, new_item)


@bare
def pop(key: Floats, item: Ints, size: HeapSize) -> tuple[float, int]:
    """Take the item with the least key off a heap that is not empty; return that key and the item."""
    least = key[0]
    best, size[0] = pop_item(key, item, size[0])
    return least, best
