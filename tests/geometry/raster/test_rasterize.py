"""Rasterization against its definition: the area that each square shares with the shape."""

import time

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from utak.geometry.motion.se2 import Rotate, Translate
from utak.geometry.raster.rasterize import covered_areas, squares, squares_after

WIDTH, HEIGHT = 14, 11
whole = st.integers(-3, 16).map(float)
real = st.floats(-3, 16).map(lambda v: round(v, 3))
corner = st.tuples(whole, whole) | st.tuples(real, real)


def by_definition(shape: shapely.Geometry) -> np.ndarray:
    """Return the area that each square shares with the shape, by intersecting them one by one."""
    x, y = np.meshgrid(np.arange(WIDTH), np.arange(HEIGHT))
    return shapely.area(shapely.intersection(shapely.box(x, y, x + 1, y + 1), shape))


def polygons_of(shape: shapely.Geometry) -> shapely.Geometry:
    """Return the parts of a geometry that have an area."""
    return shapely.MultiPolygon([p for p in shapely.get_parts(shape) if p.geom_type == "Polygon" and p.area > 0])


@pytest.mark.long
@settings(max_examples=300, deadline=None)
@given(st.lists(corner, min_size=3, max_size=9), st.booleans(), st.tuples(whole, whole))
def test_squares_are_those_that_share_area(points: list, outside: bool, hole: tuple) -> None:
    shape = polygons_of(shapely.make_valid(shapely.Polygon(points)))
    if outside:
        shape = polygons_of(shapely.box(0, 0, WIDTH, HEIGHT).difference(shape))
    shape = polygons_of(shape.difference(shapely.box(*hole, hole[0] + 2, hole[1] + 1)))
    want = by_definition(shape)
    np.testing.assert_allclose(covered_areas(shape, WIDTH, HEIGHT), want, atol=1e-9)
    well_decided = np.abs(want - 1e-9) > 1e-11
    assert (squares(shape, WIDTH, HEIGHT) == (want > 1e-9))[well_decided].all()


pushes = st.builds(Translate, whole | real, whole | real)
turns = st.builds(Rotate, st.sampled_from([90.0, -180.0]) | st.floats(-400, 400), st.tuples(real, real))


@settings(max_examples=100, deadline=None)
@given(st.lists(corner, min_size=3, max_size=6), st.lists(pushes | turns, max_size=5))
def test_squares_after_motions_are_the_union_over_the_motions(points: list, motions: list) -> None:
    shape = polygons_of(shapely.make_valid(shapely.Polygon(points)))
    covered = [covered_areas(motion.carry(shape), WIDTH, HEIGHT) for motion in motions]
    want = np.max(covered, axis=0, initial=0.0)
    well_decided = np.all([np.abs(area - 1e-9) > 1e-11 for area in covered], axis=0) if covered else slice(None)
    assert (squares_after(shape, motions, WIDTH, HEIGHT) == (want > 1e-9))[well_decided].all()


@pytest.mark.parametrize("rise", [5e-324, 2.225073858507203e-309, 1e-300])
def test_an_edge_that_rises_by_a_tiny_number_is_cut_like_a_level_one(rise: float) -> None:
    shape = shapely.Polygon([(0.5, 0), (3.5, rise), (3.5, 2), (0.5, 2)])
    np.testing.assert_allclose(
        covered_areas(shape, WIDTH, HEIGHT), covered_areas(shapely.box(0.5, 0, 3.5, 2), WIDTH, HEIGHT), atol=1e-12
    )


def test_an_edge_on_a_grid_line_does_not_cover_the_square_beyond() -> None:
    assert np.argwhere(squares(shapely.box(2, 3, 4, 4), WIDTH, HEIGHT)).tolist() == [[3, 2], [3, 3]]


@pytest.mark.parametrize("shape", [shapely.Polygon(), shapely.Point(1, 1), shapely.LineString([(0, 0), (5, 5)])])
def test_a_geometry_without_area_covers_nothing(shape: shapely.Geometry) -> None:
    assert not squares(shape, WIDTH, HEIGHT).any()


def test_a_shape_beyond_the_table_is_cut_off() -> None:
    assert squares(shapely.box(-9, -9, 99, 99), WIDTH, HEIGHT).all()
    assert not squares(shapely.box(20, 0, 30, 9), WIDTH, HEIGHT).any()


def test_a_large_ring_is_rasterized_quickly() -> None:
    ring = shapely.box(0, 0, 512, 512).difference(shapely.Point(256, 256).buffer(250, quad_segs=100))
    squares(ring, 512, 512)
    start = time.process_time()
    squares(ring, 512, 512)
    assert time.process_time() - start < 0.25  # 5 ms on a quiet machine
