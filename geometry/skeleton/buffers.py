"""Memory of dead screens, kept for the next one of the same shape.

A screen writes every byte of its arrays; on memory fresh from the system that can cost as much as the measuring itself.
One set is kept, the latest, and likewise the scratch of the latest change.
No array of a set is ever handed to a user, so nothing can still look at it.
"""

import sys
import weakref
from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from geometry.kernels.arrays import SquaredDistances
from geometry.skeleton.skeleton import States, Waiting, Words

PAGE = 4096  # bytes; the system's own may be larger
LEAST, MOST = 1 << 16, 1 << 22  # bytes: less is not worth a call, and for more numpy asks for large pages
POPULATE_WRITE = 23  # of Linux's madvise, since 5.14


class Buffers(NamedTuple):
    """The arrays of a screen, by padded shape."""

    square: SquaredDistances
    words: Words


class Tenant:
    """Whoever holds a set, as long as it lives."""


class Scratch(NamedTuple):
    """What a change of a screen notes, by cells. Little of it is ever written."""

    mark: States
    """All 0 before and after."""
    touched: Waiting
    before: States


SPARE: dict[tuple[int, int], Buffers] = {}
SCRATCH: dict[int, Scratch] = {}


def take_buffers(tenant: Tenant, shape: tuple[int, int], kind: type[np.int16] | type[np.int32]) -> Buffers:
    """A set for a tenant, spare again when it dies; ``square`` is of that kind or a larger one. All but the padding of
    ``words`` is arbitrary.
    """
    buffers = SPARE.pop(shape, None)
    if buffers is None or buffers.square.dtype < kind:
        cells = shape[0] * shape[1]
        share, eighth = -(-cells * np.dtype(kind).itemsize // 8), -(-cells // 8)
        del buffers
        whole = np.empty(share + eighth, np.uint64)  # one array: what numpy zeroes it touches page by page
        populate(whole)
        whole[-1] = 0
        square: Any = whole[:share].view(kind)[:cells].reshape(shape)
        buffers = Buffers(square, whole[share:])
    weakref.finalize(tenant, give_back, shape, buffers).atexit = False
    return buffers


def give_back(shape: tuple[int, int], buffers: Buffers) -> None:
    """Keep a set, and only this one."""
    SPARE.clear()
    SPARE[shape] = buffers


def take_scratch(cells: int) -> Scratch:
    """Scratch for a screen of so many cells, that of the last change if it was of that size."""
    scratch = SCRATCH.pop(cells, None)
    if scratch is None:
        scratch = Scratch(np.zeros(cells, np.uint8), np.empty(cells, np.int32), np.empty(cells, np.uint8))
    return scratch


def keep_scratch(scratch: Scratch) -> None:
    """Keep scratch for the next change, and only this."""
    SCRATCH.clear()
    SCRATCH[len(scratch.mark)] = scratch


def populate(array: NDArray[Any]) -> None:
    """Have the system find the memory of an array at once, which is quicker than page by page as it is written.

    This is advice: where it is not understood nothing happens.
    """
    advise = adviser()
    if advise is not None and LEAST <= array.nbytes < MOST:
        begin = array.ctypes.data
        first = begin - begin % PAGE
        advise(first, begin + array.nbytes - first, POPULATE_WRITE)


@cache
def adviser() -> Callable[[int, int, int], int] | None:
    """Linux's madvise, or None elsewhere."""
    if not sys.platform.startswith("linux"):
        return None
    import ctypes

    try:
        advise = ctypes.CDLL(None).madvise
    except (OSError, AttributeError):
        return None
    advise.argtypes = (ctypes.c_size_t, ctypes.c_size_t, ctypes.c_int)
    return advise
