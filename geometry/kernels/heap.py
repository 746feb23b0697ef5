"""A binary heap in two arrays: keys, and the items that they belong to. The caller keeps its size."""

from geometry.kernels.arrays import Floats, Ints
from geometry.kernels.jit import bare


@bare
def push(keys: Floats, items: Ints, size: int, key: float, item: int) -> int:
    """Put an item on the heap, in place; return the heap's new size, a number of items.

    Parameters
    ----------
    keys, items : (capacity,) float64 and int32: the heap, least key first, with memory for one more.
    size : number of items on it; a full heap is not noticed.
    key : the key of the new item, in any unit.
    item : the item, any whole number of 32 bits (mostly the number of a node).
    """
    k = size
    while k > 0:
        parent = (k - 1) >> 1
        if keys[parent] <= key:
            break
        keys[k], items[k] = keys[parent], items[parent]
        k = parent
    keys[k], items[k] = key, item
    return size + 1


@bare
def pop(keys: Floats, items: Ints, size: int) -> tuple[int, int]:
    """Take the item with the least key off a heap that is not empty, in place; return the item and the new size.

    Its key is not returned: read ``keys[0]`` before the call.

    Parameters
    ----------
    keys, items : (capacity,) float64 and int32: the heap, least key first; changed in place.
    size : number of items on it, 1 or more.
    """
    top = 0 + items[0]
    size -= 1
    key, item = keys[size], items[size]
    k = 0
    while 2 * k + 1 < size:
        child = 2 * k + 1
        if child + 1 < size and keys[child + 1] < keys[child]:
            child += 1
        if keys[child] >= key:
            break
        keys[k], items[k] = keys[child], items[child]
        k = child
    keys[k], items[k] = key, item
    return top, size
