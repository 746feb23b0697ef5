"""The least gap through which a body may pass, against plans of motion through a slit of a thin wall."""

import math

import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import affinity

from utak.geometry import Pose, plan_motion
from utak.geometry.cspace.bottleneck import least_gap

L_SHAPE = shapely.Polygon([(0, 0), (6, 0), (6, 2), (3, 2), (3, 7), (0, 7)])
WALL = 0.2  # squares: how thick the wall with the slit is


def passes(body: shapely.Polygon, gap: float) -> str:
    """Return the status of the motion of a body through a slit of some width from the left of it to the right."""
    middle = affinity.translate(body, -body.centroid.x, -body.centroid.y)
    wall = shapely.box(9.9, -30, 9.9 + WALL, 30) - shapely.box(9, -gap / 2, 11, gap / 2)
    return plan_motion(middle, wall, Pose(0, 0, 0), Pose(20, 0, 0), bounds=(-1, -9, 21, 9), resolution=2e-3).status


def test_it_is_the_shorter_side_of_a_rectangle_and_the_thickest_leg_of_others() -> None:
    assert least_gap(shapely.box(0, 0, 5, 3)) == pytest.approx(3)
    assert least_gap(affinity.rotate(shapely.box(0, 0, 5, 3), 31)) == pytest.approx(3)
    assert least_gap(shapely.Point(0, 0).buffer(2, 32)) == pytest.approx(4, abs=0.02)
    assert least_gap(shapely.Polygon([(0, 0), (4, 0), (0, 3)])) == pytest.approx(12 / 5)
    assert least_gap(L_SHAPE) == pytest.approx(3)
    assert least_gap(affinity.rotate(L_SHAPE, 77)) == pytest.approx(3)
    dart = shapely.Polygon([(0, 0), (4, 1), (8, 0), (4, 5)])  # neither convex nor of right angles: a rectangle in it
    assert 0.0 <= least_gap(dart) < 4.0


@pytest.mark.long
@given(st.lists(st.tuples(st.integers(0, 12), st.integers(0, 12)), min_size=3, max_size=6), st.booleans())
@settings(max_examples=12, deadline=None)
def test_no_body_passes_a_narrower_slit(points: list[tuple[int, int]], angled: bool) -> None:
    hull = shapely.MultiPoint(points).convex_hull
    body = (
        L_SHAPE
        if angled
        else affinity.scale(hull, 0.4, 0.4)
        if hull.geom_type == "Polygon"
        else shapely.box(0, 0, 2, 2)
    )
    least = least_gap(body)
    assert least > 0.0 and not math.isinf(least)
    assert passes(body, 0.97 * least) != "found"


def test_a_brick_passes_a_slit_that_is_a_little_wider() -> None:
    assert passes(shapely.box(0, 0, 5, 3), 3.1) == "found"
    assert passes(shapely.box(0, 0, 5, 3), 2.95) == "impossible"
