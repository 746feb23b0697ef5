"""Boundary rings against the squares that they enclose."""

import numpy as np
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from utak.geometry.raster.components import components
from utak.geometry.raster.contours import outline


def area(ring: tuple[tuple[int, int], ...]) -> float:
    """Return the signed area of a ring, positive if it runs counter-clockwise."""
    x, y = np.array(ring, float).T
    return float((x * np.roll(y, -1) - np.roll(x, -1) * y).sum() / 2)


@settings(max_examples=200, deadline=None)
@given(st.integers(1, 9), st.integers(1, 9), st.integers(0, 2**32 - 1), st.floats(0.1, 1))
def test_rings_enclose_exactly_their_squares(rows: int, columns: int, seed: int, density: float) -> None:
    mask = np.random.default_rng(seed).random((rows, columns)) < density
    rings = outline(mask)
    assert sum(area(ring) for ring in rings) == mask.sum()
    x, y = np.meshgrid(np.arange(columns) + 0.5, np.arange(rows) + 0.5)
    winding = np.zeros(mask.shape, int)
    for ring in rings:
        inside = shapely.contains_xy(shapely.make_valid(shapely.Polygon(ring)), x.ravel(), y.ravel()).reshape(
            mask.shape
        )
        winding += np.sign(int(area(ring))) * inside
    assert np.array_equal(winding == 1, mask)
    assert np.isin(winding, [0, 1]).all()


@settings(max_examples=200, deadline=None)
@given(st.integers(1, 9), st.integers(1, 9), st.integers(0, 2**32 - 1), st.floats(0.1, 1))
def test_each_component_has_one_outer_ring(rows: int, columns: int, seed: int, density: float) -> None:
    mask = np.random.default_rng(seed).random((rows, columns)) < density
    assert sum(area(ring) > 0 for ring in outline(mask)) == components(mask).number


@settings(max_examples=100, deadline=None)
@given(st.integers(1, 9), st.integers(1, 9), st.integers(0, 2**32 - 1))
def test_rings_turn_at_every_corner(rows: int, columns: int, seed: int) -> None:
    mask = np.random.default_rng(seed).random((rows, columns)) < 0.6
    rings = outline(mask)
    assert rings == sorted(rings)
    for ring in rings:
        assert ring[0] == min(ring)
        steps = np.diff(np.array([*ring, *ring[:2]]), axis=0)
        assert ((steps == 0).sum(1) == 1).all()
        assert ((steps[:-1] * steps[1:]).sum(1) == 0).all()


def test_an_empty_mask_has_no_rings() -> None:
    assert outline(np.zeros((3, 3), bool)) == []
