"""The parts of an outline are convex, cover it, and do not overlap."""

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import Polygon, affinity, box

from utak.geometry.shapes.classes import CLASSES, RECTANGLES
from utak.kb.objects.parts import MAX_INNER_CORNERS, parts_of

MANY_LEGS = shapely.union_all([box(0, 0, 9, 1), *(box(2 * n, 0, 2 * n + 1, 3) for n in range(5))])
EXPECTED_PARTS = {"l_shape": 2, "t_shape": 2, "u_shape": 3}


@st.composite
def outlines(draw: st.DrawFn) -> tuple[str, Polygon]:
    """Draw an outline made of rectangles of any size, turned and put anywhere, with its class."""
    of_rectangles = [one for one in CLASSES if one.form == RECTANGLES]
    one = draw(st.sampled_from(of_rectangles))
    sizes = np.array([draw(st.floats(6, 12)), draw(st.floats(6, 12)), draw(st.floats(1, 2.5)), draw(st.floats(1, 2.5))])
    corners = [[float(x @ sizes), float(y @ sizes)] for x, y in one.corners]
    turned = affinity.rotate(Polygon(corners), draw(st.floats(0, 360)))
    return one.name, affinity.translate(turned, draw(st.floats(-50, 50)), draw(st.floats(-50, 50)))


@given(outlines())
@settings(max_examples=200, deadline=None)
def test_parts_are_convex_and_cover_the_outline(drawn: tuple[str, Polygon]) -> None:
    name, outline = drawn
    parts = parts_of(outline)
    assert len(parts) == EXPECTED_PARTS.get(name, 0)
    for part in parts:
        assert part.is_valid
        assert part.convex_hull.area == pytest.approx(part.area)
    if parts:
        assert sum(part.area for part in parts) == pytest.approx(outline.area)
        assert shapely.union_all([part.buffer(1e-6) for part in parts]).symmetric_difference(outline).area < 1e-2


@given(outlines())
@settings(max_examples=50, deadline=None)
def test_parts_are_the_same_whatever_the_order_of_corners(drawn: tuple[str, Polygon]) -> None:
    outline = drawn[1]
    mirrored = Polygon(list(outline.exterior.coords)[::-1])
    assert [p.area for p in parts_of(outline)] == pytest.approx([p.area for p in parts_of(mirrored)])


@pytest.mark.parametrize("outline", [box(0, 0, 3, 2), Polygon([(0, 0), (4, 0), (0, 4)]), shapely.Point(0, 0).buffer(3)])
def test_what_is_convex_has_no_parts(outline: Polygon) -> None:
    assert parts_of(outline) == ()


def test_what_has_many_inner_corners_or_holes_has_no_parts() -> None:
    assert MANY_LEGS.geom_type == "Polygon"
    assert len(MANY_LEGS.exterior.coords) - 1 > 2 * MAX_INNER_CORNERS
    assert parts_of(MANY_LEGS) == ()
    assert parts_of(box(0, 0, 9, 9).difference(box(3, 3, 6, 6))) == ()
