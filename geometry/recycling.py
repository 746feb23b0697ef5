"""Memory of dead screens, kept for the next one of the same shape.

A screen writes every byte of its arrays; on memory fresh from the system that can cost as much as the measuring itself.
One set is kept, the latest. No array of a set is ever handed to a user, so nothing can still look at it.
"""

import weakref
from typing import NamedTuple

import numpy as np

from geometry.distance import Squares
from geometry.skeleton import Words


class Buffers(NamedTuple):
    """The arrays of a screen, by padded shape."""

    square: Squares
    words: Words


SPARE: dict[tuple[int, int], Buffers] = {}


def take_buffers(owner: object, shape: tuple[int, int]) -> Buffers:
    """A set for an owner, spare again when the owner dies. All but the padding of ``words`` is arbitrary."""
    buffers = SPARE.pop(shape, None)
    if buffers is None:
        words = np.zeros((shape[0] * shape[1] + 7) // 8, np.uint64)
        buffers = Buffers(np.empty(shape, np.int32), words)
    weakref.finalize(owner, give_back, shape, buffers).atexit = False
    return buffers


def give_back(shape: tuple[int, int], buffers: Buffers) -> None:
    """Keep a set, and only this one."""
    SPARE.clear()
    SPARE[shape] = buffers
