"""A binary heap in two arrays: keys, and the items that they belong to. The caller keeps its size."""

from utak.geometry.kernels.arrays import Floats, Ints
from utak.geometry.kernels.jit import bare


@bare
def push(keys: Floats, items: Ints, size: int, key: float, item: int) -> int:
    """Put an item on the heap, in place; return the heap's new size, a number of items."""
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
    """Take the item with the least key off a heap that is not empty, in place; return the item and the new size."""
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
