"""A binary heap in two arrays, keys and what they belong to; the caller keeps its size."""

from geometry.chains import Floats, Ints
from geometry.compiled import compiled


@compiled
def push(keys: Floats, nodes: Ints, size: int, key: float, node: int) -> int:
    """Put a node on the heap; returns the heap's size."""
    k = size
    while k > 0:
        parent = (k - 1) >> 1
        if keys[parent] <= key:
            break
        keys[k], nodes[k] = keys[parent], nodes[parent]
        k = parent
    keys[k], nodes[k] = key, node
    return size + 1


@compiled
def pop(keys: Floats, nodes: Ints, size: int) -> tuple[int, int]:
    """Take the most promising node; returns it and the heap's size."""
    top = nodes[0]
    size -= 1
    key, node = keys[size], nodes[size]
    k = 0
    while 2 * k + 1 < size:
        child = 2 * k + 1
        if child + 1 < size and keys[child + 1] < keys[child]:
            child += 1
        if keys[child] >= key:
            break
        keys[k], nodes[k] = keys[child], nodes[child]
        k = child
    keys[k], nodes[k] = key, node
    return top, size
