"""The insets of an object's sides, narrowed by the squares that it covers after pushes by parts of a square."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from shapely.affinity import rotate, translate

from utak.geometry.motion.se2 import Rotate, Translate
from utak.kb.mapping.patch import patch_of_polygon
from utak.kb.objects.held_object import HeldObject, initial_insets
from utak.kb.objects.subcell_extent import (
    FULL_INSETS,
    MIN_TESTED_INTERVAL,
    NO_INSETS,
    SideValues,
    SubcellExtent,
    inset_change,
    inset_outline,
    narrowed,
    turn_sides,
)
from utak.kb.world.model import Node
from utak.planner.skills.measure_size import INSET_TOLERANCE, least_outline, push_parts

ELL = shapely.Polygon([(0, 0), (6, 0), (6, 3), (3, 3), (3, 6), (0, 6)])
SHAPES = {"square": shapely.box(0, 0, 4, 4), "brick": shapely.box(0, 0, 3, 6), "ell": ELL}
parts = st.integers(0, 19).map(lambda n: n / 20 + 0.017)  # never exactly on a grid line, also after a push


def image(thing: Any) -> Any:
    """Return the outline of the squares that an object covers, by its corners."""
    whole = shapely.union_all([shapely.box(x, y, x + 1, y + 1) for x, y in patch_of_polygon(thing).squares()])
    points = whole.exterior.coords[:-1]
    around = zip([points[-1], *points], points, [*points[1:], points[0]], strict=False)
    return shapely.Polygon([b for a, b, c in around if (b[0] - a[0]) * (c[1] - b[1]) != (b[1] - a[1]) * (c[0] - b[0])])


def looks_like(thing: Any) -> Callable[[Any], bool]:
    """Return whether an outline covers the same squares as the object."""
    return lambda outline: patch_of_polygon(outline).squares() == patch_of_polygon(thing).squares()


def lies_within(insets: SubcellExtent, seen: Any, thing: Any) -> bool:
    """Return whether the inset of each side of an object is within the possible insets."""
    (x0, y0, x1, y1), (a0, b0, a1, b1) = seen.bounds, thing.bounds
    far = a0 - x0, x1 - a1, b0 - y0, y1 - b1
    return all(low - 1e-9 <= at <= high + 1e-9 for low, at, high in zip(insets.least, far, insets.most, strict=True))


@pytest.mark.long
@given(st.sampled_from(sorted(SHAPES)), parts, parts, st.lists(st.tuples(parts, parts), max_size=6))
@settings(max_examples=80, deadline=None)
def test_the_true_insets_stay_possible_after_any_pushes(
    name: str, x: float, y: float, pushes: list[tuple[float, float]]
) -> None:
    thing = translate(SHAPES[name], x, y)
    seen = image(thing)
    load = HeldObject("o1", seen, seen, insets=initial_insets(seen), proven=True)
    assert load.insets == SubcellExtent(NO_INSETS, FULL_INSETS)
    for dx, dy in pushes:
        push = Translate(dx, dy)
        thing, seen = push.carry(thing), push.carry(seen)
        carried = load.moved(push.carry(load.polygon), load.slack, commanded=True)
        found = carried.told(looks_like(thing))
        load = found or carried
        assert load.insets is not None
        if found is None:  # a side is known so well that its last row stays open
            assert (
                min(most - least for least, most in zip(load.insets.least, load.insets.most, strict=True))
                <= MIN_TESTED_INTERVAL
            )
        else:
            assert patch_of_polygon(load.polygon).squares() == patch_of_polygon(thing).squares()
        assert lies_within(load.insets, seen, thing)
        assert load.sure.squares() <= patch_of_polygon(thing).squares() <= load.possible.squares()


@pytest.mark.long
@given(st.sampled_from(sorted(SHAPES)), parts, parts, st.integers(0, 3))
@settings(max_examples=60, deadline=None)
def test_pushes_by_parts_of_a_square_show_the_size_of_an_object(name: str, x: float, y: float, quarters: int) -> None:
    thing = translate(rotate(SHAPES[name], 90 * quarters, origin=(0, 0)), 20 + x, 20 + y)
    seen = image(thing)
    load = HeldObject("o1", seen, seen, insets=initial_insets(seen), proven=True)
    for _ in range(14):
        wanted = push_parts(node_of(load))
        if wanted is None:
            break
        push = Translate(wanted[0] or 0.0, wanted[1] or 0.0)
        thing = push.carry(thing)
        load = load.moved(push.carry(load.polygon), load.slack, commanded=True).told(looks_like(thing)) or load
    assert push_parts(node_of(load)) is None
    assert max(load.short) <= INSET_TOLERANCE
    for at, true in zip(load.polygon.bounds, thing.bounds, strict=True):
        assert abs(at - true) <= 0.125
    least = least_outline(node_of(load))
    assert thing.buffer(1e-6).covers(least)


@pytest.mark.parametrize("quarters", [0, 1, 2, 3])
def test_two_pushes_show_that_an_object_fills_whole_squares(quarters: int) -> None:
    load = HeldObject("o1", ELL, ELL, insets=initial_insets(ELL), proven=True)
    turn = Rotate(90.0 * quarters, (3.0, 3.0))
    load = load.moved(turn.carry(ELL), 0.0, 90.0 * quarters, commanded=True)
    thing = load.polygon
    for _ in range(2):
        wanted = push_parts(node_of(load))
        assert wanted is not None
        push = Translate(wanted[0] or 0.0, wanted[1] or 0.0)
        thing = push.carry(thing)
        load = load.moved(push.carry(load.polygon), load.slack, commanded=True).told(looks_like(thing)) or load
    assert push_parts(node_of(load)) is None
    assert load.polygon.symmetric_difference(thing).area < 1e-9


def test_an_impression_that_agrees_with_no_outline_gives_none() -> None:
    assert narrowed(SubcellExtent(), translate(ELL, 0.25, 0.25), lambda outline: False) is None


def test_a_stopped_object_may_lie_beside_a_grid_line() -> None:
    seen = shapely.box(0, 0, 4, 4)
    load = HeldObject("o1", seen, seen, insets=SubcellExtent(), proven=True)
    there = shapely.box(0.25, 0, 4.25, 4)
    exact, stopped = (load.moved(there, 0.0, commanded=commanded) for commanded in (True, False))
    assert exact.possible.squares() == patch_of_polygon(there).squares()
    assert stopped.possible.squares() > exact.possible.squares()


sides = st.tuples(*[st.floats(0, 0.9)] * 4)


@given(st.sampled_from(sorted(SHAPES)), sides, st.integers(0, 3))
@settings(max_examples=60, deadline=None)
def test_sides_moved_in_and_out_again_lie_where_they_did(name: str, by: SideValues, quarters: int) -> None:
    outline = rotate(SHAPES[name], 90 * quarters, origin=(0, 0))
    there = inset_outline(outline, by)
    assert there is not None and outline.buffer(1e-9).covers(there)
    x0, y0, x1, y1 = outline.bounds
    west, east, south, north = by
    assert there.bounds == pytest.approx((x0 + west, y0 + south, x1 - east, y1 - north))
    west, east, south, north = (-side for side in by)
    back = inset_outline(there, (west, east, south, north))
    assert back.symmetric_difference(outline).area < 1e-9
    spun = inset_outline(rotate(outline, 90, origin=(0, 0)), turn_sides(by, 1))
    assert spun.symmetric_difference(rotate(there, 90, origin=(0, 0))).area < 1e-9


@pytest.mark.parametrize(
    "outline", [rotate(ELL, 20), shapely.Point(0, 0).buffer(3), shapely.Polygon([(0, 0), (4, 0), (0, 4)])]
)
def test_an_outline_not_parallel_to_the_grid_cannot_be_inset(outline: Any) -> None:
    assert inset_outline(outline, (0.1, 0.1, 0.1, 0.1)) is None


def test_an_inset_that_removes_an_arm_gives_none() -> None:
    assert inset_outline(ELL, (1.0, 1.0, 0.0, 0.0)) is not None
    assert inset_outline(inset_outline(ELL, (1.0, 1.0, 0.0, 0.0)), (0.5, 0.5, 0.0, 0.0)) is None


@given(st.floats(0, 0.9), st.floats(0, 0.9), st.floats(0.01, 1), st.floats(0.01, 1))
@settings(max_examples=60, deadline=None)
def test_the_believed_insets_are_possible(west: float, east: float, wide: float, narrow: float) -> None:
    least, most = (west, east, 0.0, 0.0), (min(west + wide, 1.0), min(east + narrow, 1.0), 1.0, 1.0)
    assume(all(high - low > 0.01 for low, high in zip(least, most, strict=True)))
    insets = SubcellExtent(least, most)
    here = insets.believed
    assert all(low - 1e-9 <= at <= high + 1e-9 for low, at, high in zip(least, here, most, strict=True))
    assert all(short >= -1e-9 for short in insets.short)
    if any(least) and max(east, 1 - most[0]) < min(most[1], 1 - west):
        assert math.isclose(here[0] + here[1], 1.0)  # as long as whole squares, where that is possible
    assert inset_change(insets, insets) == NO_INSETS


def node_of(load: HeldObject) -> Node:
    """Return a node with what is known of a held object."""
    node = Node(load.name, "object", 100, "part1", patch_of_polygon(load.polygon), 0, polygon=load.polygon)
    return replace(node, short=load.short, insets=load.lying_insets, moved=True)


def test_an_object_with_nearly_known_sides_may_fill_whole_squares_but_is_not_exact() -> None:
    insets = SubcellExtent((0.395, 0.595, 0.0, 0.0), (0.405, 0.605, 1.0, 1.0))
    thing = HeldObject("o1", shapely.box(3.1, 2, 6.1, 5), shapely.box(3.1, 2, 6.1, 5), 0.01, insets=insets, proven=True)
    aligned = thing.moved(shapely.box(3, 2, 6, 5), 0.01, commanded=True)
    assert aligned.play
    for less in (-0.005, 0.0, 0.005):
        squares = patch_of_polygon(shapely.box(3 + less, 2, 6 + less, 5)).squares()
        assert aligned.sure.squares() <= squares <= aligned.possible.squares()
