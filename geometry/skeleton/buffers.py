"""Memory of dead screens, kept for the next screen of the same shape.

A screen writes every byte of its arrays; in memory fresh from the system that can cost as much as the measuring itself.
One set of arrays is kept, the latest. No array of a set is ever handed to a user, so nothing else can refer to it.
"""

import sys
import weakref
from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from utak.geometry.kernels.arrays import SquaredDistances
from utak.geometry.skeleton.skeleton import Words

Adviser = Callable[[int, int, int], int]
"""Takes address, length in bytes and the number of the advice; returns 0 when the system follows it."""

PAGE_BYTES = 4096  # to which addresses are rounded down; the system's pages may be larger
MIN_POPULATED_BYTES = 1 << 16  # less is not worth a system call (tuned by benchmarks.screens)
MAX_POPULATED_BYTES = 1 << 22  # for arrays of so much and more numpy itself asks for large pages
MADV_POPULATE_WRITE = 23  # of Linux's madvise, since 5.14


class Buffers(NamedTuple):
    """The arrays of a screen, which has a padded shape of (rows + 2, columns + 2): one blocked cell on each side."""

    square: SquaredDistances  # Room for squared clearances in squared half squares
    words: Words  # Room for the states of the skeleton, eight cells a word, a byte each


class Tenant:
    """The holder of a set of arrays, without attributes: when it is collected, the set is spare."""


SPARE_BUFFERS: dict[tuple[int, int], Buffers] = {}
"""The latest set that no screen holds, by its padded shape."""


def take_buffers(tenant: Tenant, shape: tuple[int, int], kind: type[np.int16] | type[np.int32]) -> Buffers:
    """Return a set of arrays for a tenant, which is spare again when the tenant dies."""
    buffers = SPARE_BUFFERS.pop(shape, None)
    if buffers is None or buffers.square.dtype < kind:
        cells = shape[0] * shape[1]
        share, eighth = -(-cells * np.dtype(kind).itemsize // 8), -(-cells // 8)
        del buffers
        whole = np.empty(share + eighth, np.uint64)  # one array: what numpy zeroes it touches page by page
        populate(whole, adviser())
        whole[-1] = 0
        square: Any = whole[:share].view(kind)[:cells].reshape(shape)
        buffers = Buffers(square, whole[share:])
    weakref.finalize(tenant, give_back, shape, buffers).atexit = False
    return buffers


def give_back(shape: tuple[int, int], buffers: Buffers) -> None:
    """Keep a set of arrays, `buffers`, no longer in use, as the only spare one; `shape` is its padded shape."""
    SPARE_BUFFERS.clear()
    SPARE_BUFFERS[shape] = buffers


def populate(array: NDArray[Any], advise: Adviser | None) -> None:
    """Ask the system to provide the memory of an array at once, which is faster than page by page as it is written."""
    if advise is not None and MIN_POPULATED_BYTES <= array.nbytes < MAX_POPULATED_BYTES:
        begin = array.ctypes.data
        first = begin - begin % PAGE_BYTES
        advise(first, begin + array.nbytes - first, MADV_POPULATE_WRITE)


@cache
def adviser(platform: str = sys.platform) -> Adviser | None:
    """Return Linux's madvise, or None on other systems and where it is not found."""
    # It takes an address, a number of bytes and the number of an advice, and returns 0 or, for an error, -1.
    if not platform.startswith("linux"):
        return None
    import ctypes

    try:
        advise = ctypes.CDLL(None).madvise
    except (OSError, AttributeError):
        return None
    advise.argtypes = (ctypes.c_size_t, ctypes.c_size_t, ctypes.c_int)
    return advise
