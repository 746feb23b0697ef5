"""A binary heap of numbered items by key, in arrays. Plain loops for numba."""

import numpy as np
import numpy.typing as npt

from geometry.compiled import compiled

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int32]
Count = npt.NDArray[np.int64]


@compiled
def push(key: Floats, item: Ints, size: Count, new_key: float, new_item: int) -> None:
    """Put an item on the heap. size: (2,) how many there are, and how many were lost because there was no room."""
    at = size[0]
    if at >= len(key):
        size[1] += 1
        return
    size[0] += 1
    while at > 0:
        up = (at - 1) >> 1
        if key[up] <= new_key:
            break
        key[at], item[at] = key[up], item[up]
        at = up
    key[at], item[at] = new_key, new_item


@compiled
def pop(key: Floats, item: Ints, size: Count) -> tuple[float, int]:
    """Take the item with the least key off a heap that is not empty."""
    best, least = item[0], key[0]
    size[0] -= 1
    last_key, last = key[size[0]], item[size[0]]
    at = 0
    while True:
        down = 2 * at + 1
        if down >= size[0]:
            break
        if down + 1 < size[0] and key[down + 1] < key[down]:
            down += 1
        if key[down] >= last_key:
            break
        key[at], item[at] = key[down], item[down]
        at = down
    key[at], item[at] = last_key, last
    return float(least), int(best)
