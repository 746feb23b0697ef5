"""Memory of screens: new when none is spare, and used again when a screen has died."""

import numpy as np
import pytest

from utak.geometry import Screen
from utak.geometry.skeleton import buffers


@pytest.fixture(autouse=True)
def no_spare_buffers():
    buffers.SPARE_BUFFERS.clear()


@pytest.mark.parametrize("kind", [np.int16, np.int32])
@pytest.mark.parametrize("shape", [(3, 3), (130, 126), (700, 333)])
def test_new_memory_has_the_shape_and_empty_padding(shape, kind):
    tenant = buffers.Tenant()
    square, words = buffers.take_buffers(tenant, shape, kind)
    assert square.shape == shape and square.dtype == kind and len(words) == -(-shape[0] * shape[1] // 8)
    assert not words.view(np.uint8)[shape[0] * shape[1] :].any()
    assert not np.shares_memory(square, words)


def test_the_memory_of_a_dead_screen_is_used_again_and_leaves_no_trace():
    rng = np.random.default_rng(3)
    first, second = rng.random((2, 300, 200)) < 0.8
    fresh = Screen(second)
    dead = Screen(first)
    square = dead._square
    del dead
    again = Screen(second)
    assert again._square is square and fresh._square is not square
    assert (again.clearance == fresh.clearance).all()
    for mine, other in zip(again._bones, fresh._bones, strict=True):
        assert all(np.array_equal(a, b) for a, b in zip(mine, other, strict=True))


@pytest.mark.long
def test_memory_for_small_clearances_is_not_used_for_large_ones():
    open_floor = np.ones((200, 210), bool)
    walled = open_floor.copy()
    walled[::20] = walled[:, ::20] = False
    walled[1, 1] = False
    Screen(walled)
    wide = Screen(open_floor)
    assert wide.clearance.max() == 99.5
    del wide
    again, fresh = Screen(walled), Screen(walled)
    assert again._square.dtype == np.int32 and fresh._square.dtype == np.int16
    assert (again.clearance == fresh.clearance).all()


def test_populating_an_array_keeps_its_values():
    for length in (10, 70_000, 1_000_000):
        array = np.arange(length)
        buffers.populate(array[1:-1], buffers.adviser())
        assert (array == np.arange(length)).all()


def test_populating_does_nothing_on_systems_without_madvise():
    assert buffers.adviser("darwin") is None
    array = np.arange(100_000)
    buffers.populate(array, None)
    assert (array == np.arange(100_000)).all()


def test_populating_asks_for_whole_pages_of_arrays_that_are_worth_it():
    asked = []
    for length in (10, 100_000, 1_000_000):
        buffers.populate(np.zeros(length), lambda *advice: asked.append(advice) or 0)
    ((first, size, advice),) = asked
    assert first % buffers.PAGE_BYTES == 0
    assert 800_000 <= size < 800_000 + buffers.PAGE_BYTES
    assert advice == buffers.MADV_POPULATE_WRITE
