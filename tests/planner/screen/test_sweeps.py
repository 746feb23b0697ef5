"""Sweeps of a unit square, checked against exact sweeps by shapely."""

import itertools

import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from utak.planner.screen.sweeps import line_sweep_is_free, squares_along, sweep_is_free, swept_offsets

whole = st.integers(-9, 9)


def sweep(columns: int, rows: int) -> shapely.Geometry:
    """Return the area that a unit square covers on its way from (0, 0) by (columns, rows)."""
    corners = [(x + a, y + b) for x, y in ((0, 0), (columns, rows)) for a in (0, 1) for b in (0, 1)]
    return shapely.MultiPoint(corners).convex_hull


@pytest.mark.long
@settings(max_examples=200, deadline=None)
@given(whole, whole)
def test_swept_squares_are_those_with_an_interior_that_is_met(columns: int, rows: int) -> None:
    c, r = swept_offsets(columns, rows)
    found = set(zip(c.tolist(), r.tolist(), strict=True))
    covered = sweep(columns, rows)
    for i in range(-11, 12):
        for j in range(-11, 12):
            meets = shapely.area(shapely.intersection(shapely.box(i, j, i + 1, j + 1), covered)) > 1e-9
            assert ((i, j) in found) == meets


@settings(max_examples=200, deadline=None)
@given(st.integers(2, 12), st.integers(2, 12), st.integers(0, 2**32 - 1))
def test_a_sweep_is_free_exactly_when_it_meets_no_blocked_square(rows: int, columns: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    free = rng.random((rows, columns)) < 0.85
    a, b = ((int(rng.integers(columns)), int(rng.integers(rows))) for _ in range(2))
    covered = shapely.transform(sweep(b[0] - a[0], b[1] - a[1]), lambda p: p + np.array(a))
    blocked = shapely.union_all([shapely.box(x, y, x + 1, y + 1) for y, x in np.argwhere(~free).tolist()])
    assert sweep_is_free(free, a, b) == (shapely.area(shapely.intersection(covered, blocked)) < 1e-9)
    assert sweep_is_free(free, a, b) == sweep_is_free(free, b, a)


@pytest.mark.long
@settings(max_examples=200, deadline=None)
@given(st.integers(3, 12), st.integers(3, 12), st.integers(0, 2**32 - 1), st.booleans())
def test_a_line_sweep_is_free_exactly_when_it_meets_no_blocked_square(
    rows: int, columns: int, seed: int, straight: bool
) -> None:
    rng = np.random.default_rng(seed)
    free = rng.random((rows, columns)) < 0.85
    a, b = ((float(rng.uniform(0, columns)), float(rng.uniform(0, rows))) for _ in range(2))
    b = (b[0], a[1]) if straight else b
    corners = [(x + i, y + j) for x, y in (a, b) for i in (-0.5, 0.5) for j in (-0.5, 0.5)]
    covered = shapely.MultiPoint(corners).convex_hull
    walls = [shapely.box(x, y, x + 1, y + 1) for y, x in np.argwhere(~np.pad(free, 2)).tolist()]
    blocked = shapely.transform(shapely.union_all(walls), lambda p: p - 2)
    overlap = float(shapely.area(shapely.intersection(covered, blocked)))
    assume(not 0.0 < overlap < 1e-9)  # too small an overlap for the rounding of shapely
    assert line_sweep_is_free(free, a, b) == (overlap == 0.0)


@settings(max_examples=150, deadline=None)
@given(st.integers(2, 10), st.integers(2, 10), st.integers(0, 2**32 - 1))
def test_squares_along_a_line_connect_its_ends(rows: int, columns: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    free = rng.random((rows, columns)) < 0.9
    line = [(float(rng.uniform(0, columns)), float(rng.uniform(0, rows))) for _ in range(3)]
    touched = {(x, y) for x in range(columns) for y in range(rows) if _touches(line, x, y)}
    assume(all(free[y, x] for x, y in touched))
    path = squares_along(free, line)
    assert path[0] == (int(line[0][0]), int(line[0][1]))
    assert path[-1] == (int(line[-1][0]), int(line[-1][1]))
    assert set(path) <= touched
    assert all(abs(a - c) + abs(b - d) == 1 for (a, b), (c, d) in itertools.pairwise(path))


def _touches(line: list[tuple[float, float]], x: int, y: int) -> bool:
    return bool(shapely.intersects(shapely.LineString(line), shapely.box(x, y, x + 1, y + 1)))


def test_a_line_along_an_edge_uses_the_free_side() -> None:
    free = np.array([[True, True, True], [True, False, True]])
    path = squares_along(free, [(0.5, 1.5), (1.0, 1.0), (2.0, 1.0), (2.5, 1.5)])
    assert path == [(0, 1), (0, 0), (1, 0), (2, 0), (2, 1)]


def test_a_line_through_a_wall_is_refused() -> None:
    free = np.array([[True, False, True]])
    with pytest.raises(ValueError, match="no free squares lead"):
        squares_along(free, [(0.5, 0.5), (2.5, 0.5)])
