"""Clearances measured in a part of a block equal those measured in all of it."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from geometry import Screen
from geometry.incremental.update_distance import measure_within
from tests.geometry import oracles
from tests.geometry.measuring import measure


@settings(max_examples=200, deadline=None)
@given(oracles.screens(most=24), st.integers(0, 2**32 - 1), st.sampled_from([np.int16, np.int32]))
def test_every_part_has_the_clearances_of_the_whole(free, seed, kind):
    rng = np.random.default_rng(seed)
    rows, columns = free.shape
    whole, part = (np.empty((rows + 2, columns + 2), kind) for _ in range(2))
    assert measure(free, whole)
    bounds = np.full((rows + 2, 2), (columns + 2, -1), np.int32)
    for row in rng.permutation(rows)[: rng.integers(rows + 1)]:
        bounds[row + 1] = np.sort(rng.integers(1, columns + 1, 2))
    assert measure_within(free, bounds, 0, 0, part)
    for row, (first, last) in enumerate(bounds):
        assert np.array_equal(part[row, first : last + 1], whole[row, first : last + 1])


@pytest.mark.parametrize(("side", "fits"), [(182, True), (183, False)])
def test_16_bits_hold_a_square_floor_of_182_squares(side, fits):
    free = np.ones((side, side), bool)
    bounds = np.tile(np.array([1, side], np.int32), (side + 2, 1))
    assert measure_within(free, bounds, 0, 0, np.empty((side + 2, side + 2), np.int16)) == fits
    assert measure(free, np.empty((side + 2, side + 2), np.int16)) == fits
    assert measure_within(free, bounds, 0, 0, np.empty((side + 2, side + 2), np.int32))


@pytest.mark.parametrize("seed", range(4))
def test_a_wide_floor_changes_in_place(seed):
    rng = np.random.default_rng(seed)
    free = np.ones((230, 240), bool)
    screen = Screen(free.copy())
    for _ in range(6):
        i, j = rng.integers(0, 200, 2)
        rows, columns = np.mgrid[i : i + rng.integers(1, 9), j : j + rng.integers(1, 30)]
        free[rows, columns] = rng.random(rows.shape) < rng.choice([0.0, 0.5, 1.0])
        screen.changed(rows, columns, free[rows, columns])
        fresh = Screen(free)
        assert np.array_equal(screen.clearance, fresh.clearance)
        assert np.array_equal(screen.skeleton, fresh.skeleton)
