"""Whether a rectangle is a square or a brick, as far as pushes have shown its size."""

import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.affinity import translate

from utak.geometry.motion.se2 import Translate
from utak.kb.mapping.patch import patch_of_polygon
from utak.kb.objects.held_object import HeldObject, initial_insets
from utak.kb.objects.proportions import corrected_shape, possible_rectangle_shapes, side_intervals
from utak.kb.objects.subcell_extent import FULL_INSETS, SubcellExtent

SEEN = {"brick": 86, "square": 2, "rectangle": 86, "polygon": 99}
parts = st.integers(0, 19).map(lambda n: n / 20 + 0.017)  # never exactly on a grid line
longs = st.integers(2, 6)


def image(thing: shapely.Polygon) -> shapely.Polygon:
    return shapely.box(
        *shapely.union_all([shapely.box(x, y, x + 1, y + 1) for x, y in patch_of_polygon(thing).squares()]).bounds
    )


@pytest.mark.long
@given(longs, longs, parts, parts, st.lists(st.tuples(parts, parts), max_size=8))
@settings(max_examples=80, deadline=None)
def test_the_true_class_of_a_rectangle_is_always_possible(
    wide: int, high: int, x: float, y: float, pushes: list[tuple[float, float]]
) -> None:
    thing = shapely.box(x, y, x + wide, y + high)
    load = HeldObject("o1", image(thing), image(thing), insets=initial_insets(image(thing)), proven=True)
    for dx, dy in [(0.0, 0.0), *pushes]:
        thing = translate(thing, dx, dy)
        moved = load.moved(Translate(dx, dy).carry(load.polygon), load.slack, commanded=True)
        load = (
            moved.told(lambda outline, at=thing: patch_of_polygon(outline).squares() == patch_of_polygon(at).squares())
            or moved
        )
        sides = side_intervals(load.polygon, load.lying_insets)
        assert sides is not None
        for side, long in zip(sides, (wide, high), strict=True):
            assert side.least - 1e-9 <= long <= side.most + 1e-9
            assert side.least - 1e-9 <= side.believed <= side.most + 1e-9
        assert ("square" if wide == high else "brick") in possible_rectangle_shapes(load.polygon, load.lying_insets)


def test_a_square_off_the_grid_looks_like_a_brick_until_its_size_is_known() -> None:
    observations, told = shapely.box(0, 0, 4, 3), SubcellExtent((0.45, 0.45, 0.0, 0.0), (0.55, 0.55, 0.1, 0.1))
    assert set(possible_rectangle_shapes(observations, SubcellExtent())) == {"square", "brick"}
    assert corrected_shape(SEEN, observations, SubcellExtent()) == SEEN
    half = SubcellExtent((0.45, 0.45, 0.0, 0.0), (0.55, 0.55, 1.0, 1.0))
    assert corrected_shape(SEEN, shapely.box(0.5, 0, 3.5, 3), half) == SEEN  # along north it may still be shorter
    square = corrected_shape(SEEN, shapely.box(0.5, 0, 3.5, 3), told)
    assert square["square"] == 86 and square["brick"] == 2 and square["rectangle"] == 86


def test_an_object_known_to_fill_its_squares_keeps_its_class() -> None:
    told = SubcellExtent((0.0, 0.0, 0.0, 0.0), (0.1, 0.1, 0.1, 0.1))
    assert possible_rectangle_shapes(shapely.box(0, 0, 4, 3), told) == ("brick",)
    assert possible_rectangle_shapes(shapely.box(0, 0, 6, 3), SubcellExtent()) == ("brick",)
    assert corrected_shape(SEEN, shapely.box(0, 0, 4, 3), told) == SEEN


def test_only_rectangles_have_side_intervals() -> None:
    ell = shapely.Polygon([(0, 0), (4, 0), (4, 2), (2, 2), (2, 4), (0, 4)])
    assert (
        possible_rectangle_shapes(ell, SubcellExtent()) == ()
        and possible_rectangle_shapes(None, SubcellExtent()) == ()
        and possible_rectangle_shapes(shapely.box(0, 0, 2, 2), None) == ()
    )
    assert corrected_shape(SEEN, ell, SubcellExtent((0.5, 0.5, 0.5, 0.5), FULL_INSETS)) == SEEN
    slanted = shapely.Polygon([(0, 1), (1, 0), (2, 1), (1, 2)])
    assert possible_rectangle_shapes(slanted, SubcellExtent()) == ()
