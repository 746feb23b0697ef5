"""Outlines of things: that of the class of shapes that fits, or of the squares of what is of no class."""

import numpy as np
import pytest
import shapely

from utak.geometry.shapes.fit import fit_shapes
from utak.kb.mapping.patch import Patch, patch_of_polygon
from utak.kb.objects.shape_fit import ShapeMeasurement, measure_whole
from utak.kb.perception.interpretation import classify_shapes
from utak.kb.world.objects import shape_facts

OF_NO_CLASS = {
    "plus": ["..##..", "..##..", "######", "######", "..##..", "..##.."],
    "stairs": ["##....", "##....", "####..", "####..", "..####", "..####"],
    "broad T": ["...###...", "...###...", "...###...", "#########", "#########", "#########", "#########", "#########"],
    "comb": ["##..##..##", "##..##..##", "##########", "##########"],
}
OF_A_CLASS = {
    "square": ["####"] * 4,
    "brick": ["######"] * 3,
    "L": ["##....", "##....", "######", "######"],
    "T": ["######", "######", "..##..", "..##.."],
    "U": ["##..##", "##..##", "######", "######"],
}


def patch(rows: list[str]) -> Patch:
    """Return the patch of a drawing, the north row first."""
    return Patch(3, -2, np.array([list(row) for row in reversed(rows)]) == "#")


@pytest.mark.parametrize("rows", OF_NO_CLASS.values(), ids=OF_NO_CLASS)
def test_what_is_of_no_class_has_the_outline_of_its_squares(rows: list[str]) -> None:
    drawn = patch(rows)
    measured = measure_whole(drawn)
    _, traced = classify_shapes(shape_facts({"o1": measured}))
    assert traced == {"o1"}
    outline = measured.traced(drawn).polygon
    assert patch_of_polygon(outline).squares() == drawn.squares()
    assert outline.area == drawn.mask.sum()
    assert patch_of_polygon(measured.polygon).squares() != drawn.squares()  # the class that fits least badly


@pytest.mark.parametrize("rows", OF_A_CLASS.values(), ids=OF_A_CLASS)
def test_what_is_of_a_class_has_the_outline_of_its_class(rows: list[str]) -> None:
    drawn = patch(rows)
    measured = measure_whole(drawn)
    assert not classify_shapes(shape_facts({"o1": measured}))[1]
    assert patch_of_polygon(measured.polygon).squares() == drawn.squares()
    assert fit_shapes(drawn.mask)[0].misfit == 0


def test_squares_that_are_open_give_the_outline_while_they_are_fewer_than_the_class_leaves_wrong() -> None:
    others = ("l_shape", "triangle", "square", "disc", "u_shape", "brick")
    fits = (("t_shape", 39), *((one, 44) for one in others))
    traced = [
        classify_shapes(shape_facts({"o1": ShapeMeasurement(fits, None, count, full=88)}))[1] for count in (29, 60)
    ]
    assert traced == [{"o1"}, set()]


def test_squares_that_touch_at_a_corner_alone_have_no_outline() -> None:
    drawn = patch(["##..", "##..", "..##", "..##"])
    measured = measure_whole(drawn)
    assert measured.traced(drawn) == measured


def test_a_hole_is_not_in_the_outline() -> None:
    drawn = patch(["####", "#..#", "####"])
    outline = measure_whole(drawn).traced(drawn).polygon
    assert outline.equals(shapely.box(3, -2, 7, 1))
