"""A changed screen equals a new screen of the changed squares."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from geometry import Screen
from geometry.incremental import affected_region
from tests.geometry import oracles
from tests.geometry.measuring import measure


@pytest.fixture(params=["always", "if little"])
def screen_of(request):
    """Return a maker of screens that change in place even where much of a small screen is affected, or as usual."""

    def made(free):
        screen = Screen(free)
        if request.param == "always":
            screen._max_affected_share = 1.0
        return screen

    return made


def same(screen, other):
    assert (screen.free == other.free).all()
    assert (screen.clearance == other.clearance).all()
    assert (screen.skeleton == other.skeleton).all()
    assert np.array_equal(screen._skeleton_at(1)[0], other._skeleton_at(1)[0])
    for mine, fresh in zip(screen._skeleton_at(1)[2], other._skeleton_at(1)[2], strict=True):
        assert np.array_equal(mine, fresh)


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(oracles.screens(most=20), st.integers(0, 2**32 - 1), st.integers(1, 3))
def test_changes_give_what_a_fresh_build_gives(screen_of, free, seed, times):
    rng = np.random.default_rng(seed)
    screen = screen_of(free.copy())
    for _ in range(times):
        n = int(rng.integers(1, 12))
        rows, columns = rng.integers(free.shape[0], size=n), rng.integers(free.shape[1], size=n)
        values = rng.random(n) < rng.choice([0.0, 0.5, 1.0])
        changed = screen.free.copy()
        changed[rows, columns] = values
        if not changed.any():
            with pytest.raises(ValueError, match="no free square"):
                screen.changed(rows, columns, values)
            continue
        same(screen.changed(rows, columns, values), Screen(changed))


@pytest.mark.parametrize("most", [12, 40, 90])
def test_every_clearance_that_changes_lies_within_the_bounds(most):
    rng = np.random.default_rng(most)
    for _ in range(400):
        free = rng.random(rng.integers(1, most, 2)) < rng.choice([0.5, 0.8, 0.97, 0.997, 1.0])
        changed, (rows, columns) = free.copy(), rng.integers(0, free.shape, (int(rng.integers(1, 7)), 2)).T
        changed[rows, columns] = rng.random(len(rows)) < 0.5
        square, other = np.empty((2, free.shape[0] + 2, free.shape[1] + 2), np.int32)
        measure(free, square)
        measure(changed, other)
        square[[0, -1]] = other[[0, -1]] = 0
        bounds = np.empty((len(square), 3), np.int32)
        cells = np.flatnonzero(np.pad(free != changed, 1)).astype(np.int32)
        affected_region.find_affected(square, affected_region.boxes_of(cells, square.shape), bounds)
        row, column = np.nonzero(square != other)
        assert (bounds[row, 0] <= column).all() and (column <= bounds[row, 1]).all()


@pytest.mark.parametrize("texture", ["rooms", "noise", "open", "wide"])
def test_many_changes_in_a_row_give_what_a_new_screen_gives(screen_of, texture):
    rng = np.random.default_rng(7)
    share = {"rooms": 0.0, "noise": 0.3, "open": 0.003, "wide": 0.0}[texture]
    free = rng.random((150, 300) if texture == "wide" else (60, 70)) > share
    if texture == "rooms":
        free = np.kron(rng.random((20, 24)) > 0.4, np.ones((3, 3))).astype(bool)
    screen = screen_of(free)
    for _ in range(60):
        i, j = (int(rng.integers(0, n - 8)) for n in free.shape)
        free = free.copy()
        free[i : i + 8, j : j + 8] = rng.random((8, 8)) < rng.choice([0.0, 0.5, 1.0])
        rows, columns = np.mgrid[i : i + 8, j : j + 8]
        same(screen.changed(rows, columns, free[rows, columns]), Screen(free))


@pytest.mark.parametrize("size", [210, 520])
def test_clearances_may_outgrow_their_type(screen_of, size):
    free = np.ones((size, size), bool)
    free[::26] = free[:, ::26] = False
    free[1, 1::26] = free[2::26, 5] = True
    free[5:205, 5:205] = True
    free[96:112, 90:98] = False
    screen = screen_of(free.copy())
    assert screen._square.dtype == np.int16 and screen.clearance.max() < 90
    free[96:112, 90:98] = True
    rows, columns = np.mgrid[96:112, 90:98]
    same(screen.changed(rows, columns, free[rows, columns]), Screen(free))
    assert screen._square.dtype == np.int32 and screen.clearance.max() > 98
    assert screen.routes((100.5, 100.5), (7.5, 8.5))[0].length == pytest.approx(np.hypot(93, 92))
    free[96:112, 90:98] = False
    same(screen.changed(rows, columns, free[rows, columns]), Screen(free))


def test_routes_follow_a_change(screen_of):
    free = np.ones((5, 9), bool)
    screen = screen_of(free)
    assert len(screen.routes((0.5, 2.5), (8.5, 2.5), k=3)) == 1
    screen.changed([2], [4], False)
    assert len(screen.routes((0.5, 2.5), (8.5, 2.5), k=3)) == 2
    screen.changed([0, 1, 3, 4], [4] * 4, False)
    assert screen.routes((0.5, 2.5), (8.5, 2.5), k=3) == []


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (([5], [0], True), "outside"),
        (([0], [-1], True), "outside"),
        (([0, 1], [0], True), "one length"),
        (([0], [0], 1.0), "True or False"),
        (([0.5], [0], True), "whole numbers"),
    ],
)
def test_bad_changes_are_rejected_with_a_reason(screen_of, change, message):
    with pytest.raises(ValueError, match=message):
        screen_of(np.ones((5, 5), bool)).changed(*change)


def test_an_empty_change_changes_nothing(screen_of):
    screen = screen_of(np.ones((3, 4), bool))
    before = screen.clearance.copy()
    same(screen.changed([], [], []), Screen(np.ones((3, 4), bool)))
    assert (screen.clearance == before).all()
