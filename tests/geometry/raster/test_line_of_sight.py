"""Straight moves of a unit square over a raster, against an exact sweep with shapely."""

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from utak.geometry.raster.line_of_sight import straight

SQUARE = ((0, 0), (1, 0), (1, 1), (0, 1))


def swept(here: tuple[int, int], there: tuple[int, int]) -> shapely.Geometry:
    """Return the region that a unit square sweeps on its way from one square (column, row) to another."""
    return shapely.MultiPoint([(x + a, y + b) for x, y in (here, there) for a, b in SQUARE]).convex_hull


def raster(rows: int, columns: int, seed: int) -> tuple[np.ndarray, tuple[int, int]]:
    """Return a mask of mostly free squares, and a free square (column, row) of it."""
    rng = np.random.default_rng(seed)
    free = rng.random((rows, columns)) < rng.uniform(0.7, 1.0)
    here = int(rng.integers(columns)), int(rng.integers(rows))
    free[here[1], here[0]] = True
    return free, here


@pytest.mark.long
@settings(max_examples=60, deadline=None)
@given(st.integers(1, 14), st.integers(1, 14), st.integers(0, 2**32 - 1), st.integers(0, 15))
def test_a_move_leads_where_all_that_it_sweeps_is_free(rows: int, columns: int, seed: int, longest: int) -> None:
    free, here = raster(rows, columns, seed)
    blocked = shapely.union_all([shapely.box(c, r, c + 1, r + 1) for r, c in np.argwhere(~free).tolist()])
    reached = straight(free, *here, longest)
    for row, column in np.ndindex(rows, columns):
        near = max(abs(column - here[0]), abs(row - here[1])) <= longest
        open_ = shapely.area(shapely.intersection(swept(here, (column, row)), blocked)) < 1e-9
        assert reached[row, column] == (near and open_), (row, column)


@settings(max_examples=40, deadline=None)
@given(st.integers(2, 20), st.integers(2, 20), st.integers(0, 2**32 - 1))
def test_a_move_can_be_reversed(rows: int, columns: int, seed: int) -> None:
    free, here = raster(rows, columns, seed)
    for row, column in np.argwhere(straight(free, *here, 99)).tolist():
        assert straight(free, column, row, 99)[here[1], here[0]]


@given(st.integers(1, 20), st.integers(1, 20), st.integers(0, 2**32 - 1))
def test_only_the_squares_asked_about_are_marked(rows: int, columns: int, seed: int) -> None:
    free, here = raster(rows, columns, seed)
    among = np.random.default_rng(seed + 1).random(free.shape) < 0.5
    assert np.array_equal(straight(free, *here, 9, among), straight(free, *here, 9) & among)


def test_the_start_must_lie_on_the_raster() -> None:
    with pytest.raises(ValueError, match="outside"):
        straight(np.ones((2, 3), np.bool_), 3, 0, 9)
