"""Unjamming an object that stands against something: shapely tells whether it can go on then."""

import math
from dataclasses import replace

import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from shapely.affinity import translate

from tests.kb.drawings import known_model
from utak.geometry.motion.se2 import Translate
from utak.kb.mapping.occupancy import OCCUPIED
from utak.kb.mapping.patch import patch_of_polygon
from utak.kb.world.model import Node, WorldModel
from utak.planner.skills.failed_grasps import MAX_RETRIES, FailedGrasps
from utak.planner.skills.unjam import RETREAT, ROOM_AHEAD, ROOM_TO_SPARE, retreat_push

DOOR = ["b" * 24, *["b" + "." * 22 + "b"] * 8, "b" * 9 + "." * 6 + "b" * 9]
DOOR += [
    "b" * 9 + "." * 6 + "b" * 9,
    *["b" + "." * 22 + "b"] * 5,
    "b.U" + "." * 20 + "b",
    *["b" + "." * 22 + "b"] * 4,
    "b" * 24,
]
WEST = 7  # the door has the columns 7 to 12 of the map frame, for the robot stands in the third of the drawing
NORTH = Translate(0.0, 6.0)


def before_the_door(x: float, wide: float, inexact: bool = True) -> tuple[Node, WorldModel]:
    """Return an object, `wide` squares wide, that stands right below the wall with the door, its west side at x."""
    model = known_model(DOOR)
    sill = min(row for row in range(1, 12) if model.view.state[model.view.locate(0, row)] == OCCUPIED)
    polygon = shapely.box(x, sill - 4.0, x + wide, sill)
    node = Node("o1", "object", 95, "part1", patch_of_polygon(polygon), 0, polygon=polygon, moved=True, inexact=inexact)
    return node, replace(model, objects=(node,))


def walls_of(model: WorldModel) -> shapely.Geometry:
    view = model.view
    boxes = [
        shapely.box(column + view.west, row + view.south, column + view.west + 1, row + view.south + 1)
        for row, column in zip(*(view.state == OCCUPIED).nonzero(), strict=True)
    ]
    return shapely.union_all(boxes)


def passes(polygon: shapely.Geometry, motion: Translate, walls: shapely.Geometry) -> bool:
    swept = shapely.box(*polygon.bounds)
    for step in range(1, 201):
        swept = swept.union(translate(polygon, motion.dx * step / 200, motion.dy * step / 200))
    return bool(swept.intersection(walls).area < 1e-4)


@pytest.mark.long
@given(st.floats(-0.9, 0.9).filter(lambda x: abs(x) > 0.01), st.sampled_from([3.0, 4.0, 5.0, 5.5]))
@settings(max_examples=30, deadline=None)
def test_an_object_is_drawn_back_and_so_far_aside_that_it_passes(aside: float, wide: float) -> None:
    x = WEST + aside if aside < 0 else WEST + 6 - wide + aside  # over one of the jambs
    node, model = before_the_door(x, wide)
    walls = walls_of(model)
    assert not passes(node.polygon, NORTH, walls)
    freed = retreat_push(node, NORTH, model)
    assert freed.dy == pytest.approx(-RETREAT)
    assert math.copysign(1, freed.dx) == -math.copysign(1, aside)
    assert passes(node.polygon, freed, walls)
    onward = Translate(0.0, RETREAT + ROOM_AHEAD)
    there = translate(node.polygon, freed.dx, freed.dy)
    if abs(aside) <= 0.85:
        assert passes(there, onward, walls)
        assert abs(freed.dx) >= abs(aside)
        assert abs(freed.dx) <= abs(aside) + ROOM_TO_SPARE + 0.1 + 1e-9


def test_an_object_that_nothing_known_stops_is_only_drawn_back() -> None:
    node, model = before_the_door(WEST + 1.0, 4.0)
    assert tuple(retreat_push(node, NORTH, model)) == pytest.approx((0.0, -RETREAT))


def test_an_object_that_is_known_exactly_is_only_drawn_back() -> None:
    node, model = before_the_door(WEST - 0.5, 4.0, inexact=False)
    assert tuple(retreat_push(node, NORTH, model)) == pytest.approx((0.0, -RETREAT))


@pytest.mark.long
@given(st.floats(0.0, 1.0), st.sampled_from([4.0, 4.6, 5.0]))
@settings(max_examples=20, deadline=None)
def test_an_object_that_is_stopped_again_by_nothing_known_is_brought_to_the_middle(part: float, wide: float) -> None:
    node, model = before_the_door(WEST + part * (6 - wide), wide, inexact=False)
    walls = walls_of(model)
    freed = retreat_push(node, NORTH, model, doubted=True)
    assert freed.dy == pytest.approx(-RETREAT)
    assert passes(node.polygon, freed, walls)
    offs = [abs(x - WEST - (6 - wide) / 2) for x in (node.polygon.bounds[0], node.polygon.bounds[0] + freed.dx)]
    assert offs[1] <= offs[0] / 2 + 0.1  # no further than a square aside


def test_a_doubted_object_in_the_open_is_drawn_back_straight() -> None:
    node, model = before_the_door(WEST + 1.0, 4.0)
    assert tuple(retreat_push(node, Translate(0.0, -3.0), model, doubted=True)) == pytest.approx((0.0, RETREAT))


def test_an_object_wider_than_the_door_is_only_drawn_back() -> None:
    node, model = before_the_door(WEST - 0.5, 7.0)
    assert tuple(retreat_push(node, NORTH, model)) == pytest.approx((0.0, -RETREAT))


def test_failed_grasps_are_forgiven_a_few_times() -> None:
    node, model = before_the_door(WEST, 4.0)
    failed = FailedGrasps()
    assert not failed
    assert not failed.forgive(node)
    for _ in range(MAX_RETRIES):
        failed.record(node, model)
        assert failed.grasps(node)
        assert failed.forgive(node)
        assert not failed.grasps(node)
    failed.record(node, model)
    assert not failed.forgive(node)
    assert failed.grasps(node)


@given(st.floats(-9, 9), st.floats(-9, 9), st.floats(-5, 5), st.floats(-5, 5))
@settings(max_examples=60, deadline=None)
def test_a_steered_push_leads_so_far_on_and_so_far_to_the_left(
    dx: float, dy: float, onward: float, left: float
) -> None:
    length = math.hypot(dx, dy)
    assume(length > 1e-3)
    steered = Translate(dx, dy).steered(onward, left)
    assert (steered.dx * dx + steered.dy * dy) / length == pytest.approx(onward, abs=1e-9)
    assert (steered.dy * dx - steered.dx * dy) / length == pytest.approx(left, abs=1e-9)
