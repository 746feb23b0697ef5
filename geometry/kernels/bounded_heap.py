"""A binary heap of fixed capacity: its size is kept in an array, and a full heap drops what is put on it."""

import numpy as np
import numpy.typing as npt

from geometry.kernels.arrays import Floats, Ints
from geometry.kernels.heap import pop as pop_item
from geometry.kernels.heap import push as push_item
from geometry.kernels.jit import bare

HeapSize = npt.NDArray[np.int64]  # (2,) number of items on the heap, number of items dropped


@bare
def push(key: Floats, item: Ints, size: HeapSize, new_key: float, new_item: int) -> None:
    """Put an item on the heap, or count it as dropped if the heap is full; nothing is returned.

    Parameters
    ----------
    key, item : (capacity,) float64 and int32: keys and items of the heap, least key first; changed in place.
    size : (2,) int64, number of items on the heap and number of items dropped so far; one of the two grows by 1.
    new_key : the key of the new item, in any unit; a lower key is taken off earlier.
    new_item : the item, any whole number of 32 bits (mostly the number of a node).
    """
    if size[0] >= len(key):
        size[1] += 1
    else:
        size[0] = push_item(key, item, size[0], new_key, new_item)


@bare
def pop(key: Floats, item: Ints, size: HeapSize) -> tuple[float, int]:
    """Take the item with the least key off a heap that is not empty; return that key and the item.

    Parameters
    ----------
    key, item : (capacity,) float64 and int32: keys and items of the heap; changed in place.
    size : (2,) int64, number of items on the heap, which must be 1 or more and falls by 1, and of items dropped.
    """
    least = key[0]
    best, size[0] = pop_item(key, item, size[0])
    return least, best
