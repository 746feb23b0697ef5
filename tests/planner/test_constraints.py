"""Constraints on the way: the squares that are kept off, and what a thing sweeps."""

from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import affinity

from tests.planner.situations import known_situation
from utak.kb.language.reader import facts_from_text
from utak.kb.perception.frame import Frame
from utak.kb.task.task import Task
from utak.planner.constraints import in_robot_frame, in_view_frame, region_squares, swept_region
from utak.planner.goals.placement import forbidden_squares
from utak.planner.screen.projection import UNSEEN_LEVEL, CostMaps
from utak.planner.situation import Situation, regions_kept_off

ROWS = [
    "b" * 16,
    *["b..............b"] * 5,
    "b.ggg..U.......b",
    *["b.ggg..........b"] * 2,
    *["b..............b"] * 3,
    "b" * 16,
]
NUMBERS = st.floats(-6, 6).map(lambda number: round(number, 2))
L_SHAPE = shapely.Polygon([(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)])


def task_of(text: str) -> Task:
    """Return a task with some goals. text : as in goal.lp."""
    return Task({}, (), facts_from_text(text))


def box(west: float, south: float, east: float, north: float) -> str:
    """Return a box as well-known text."""
    return f"POLYGON (({west} {south}, {east} {south}, {east} {north}, {west} {north}, {west} {south}))"


def situation_for(text: str) -> Situation:
    """Return a room with a thing g that the task calls x, and with constraints. text : as in goal.lp."""
    found = replace(known_situation(ROWS), task=task_of(text), binding={"x": "g"})
    kept_off = regions_kept_off(found.task, found.binding, found.model, "utak")
    return replace(found, cost_maps=CostMaps(found.model, kept_off=kept_off))


@settings(deadline=None, max_examples=30)
@given(NUMBERS, NUMBERS, st.integers(-44, 45))
def test_frames_are_inverse(x: float, y: float, angle: int) -> None:
    frame, shape = Frame(angle, (0.5, 0.25)), affinity.translate(L_SHAPE, x, y)
    there = in_view_frame(in_robot_frame(shape, frame), frame, 0.0, 0.0)
    assert there.symmetric_difference(shape).area < 1e-6


@settings(deadline=None, max_examples=20)
@given(NUMBERS, NUMBERS)
def test_a_pushed_thing_sweeps_every_place_on_its_way_and_no_other(dx: float, dy: float) -> None:
    swept = swept_region(L_SHAPE, affinity.translate(L_SHAPE, dx, dy), 0.0, (9.0, 9.0))
    parts = [affinity.translate(L_SHAPE, dx * n / 40, dy * n / 40) for n in range(41)]
    sampled = shapely.union_all(parts)
    assert sampled.difference(swept.buffer(1e-6)).area < 1e-6
    assert swept.difference(sampled.buffer(np.hypot(dx, dy) / 40 + 1e-6)).area < 1e-6


@pytest.mark.long
@settings(deadline=None, max_examples=20)
@given(st.integers(-180, 180), NUMBERS, NUMBERS)
def test_a_turned_thing_sweeps_an_arc(degrees: int, x: float, y: float) -> None:
    swept = swept_region(L_SHAPE, affinity.rotate(L_SHAPE, degrees, origin=shapely.Point(x, y)), degrees, (x, y))
    for part in (0.0, 0.33, 0.71, 1.0):
        lies = affinity.rotate(L_SHAPE, degrees * part, origin=shapely.Point(x, y))
        assert lies.difference(swept.buffer(0.25)).area < 1e-6


def test_squares_count_where_the_region_meets_them_or_fills_them() -> None:
    region = shapely.box(1.5, 1.0, 4.0, 2.0)
    assert np.argwhere(region_squares(region, (4, 6), wholly=False)).tolist() == [[1, 1], [1, 2], [1, 3]]
    assert np.argwhere(region_squares(region, (4, 6), wholly=True)).tolist() == [[1, 2], [1, 3]]
    wider = region_squares(region, (4, 6), wholly=False, margin=2)
    assert wider.shape == (8, 10) and np.argwhere(wider).tolist() == [[3, 3], [3, 4], [3, 5]]


def test_the_robot_keeps_off_its_region_at_every_certainty() -> None:
    found = situation_for(f'at(utak, start). avoid(utak, "{box(1, 1, 3, 3)}").')
    free = situation_for("at(utak, start).").cost_maps
    kept_off = found.region_kept_off("utak")
    assert kept_off.sum() == 9  # the robot woke in the middle of a square
    for level in range(UNSEEN_LEVEL + 1):
        assert (found.cost_maps.free(level) == free.free(level) & ~kept_off).all()
    assert not (found.cost_maps.safe & kept_off).any() and not found.region_kept_off("g").any()


def test_a_thing_keeps_a_square_away_and_may_leave_where_it_is() -> None:
    found = situation_for(f'at(x, start). avoid(x, "{box(-3, -2, -1, -1)}").')
    assert not found.region_kept_off("utak").any()
    forbidden, own = forbidden_squares(found.model.objects[0], found), found.model.mask(found.model.objects[0].patch)
    near = region_squares(
        in_view_frame(shapely.box(-4, -3, 0, 0), found.model.frame, found.model.view.west, found.model.view.south),
        own.shape,
        wholly=False,
    )
    assert (forbidden == near & ~own).all() and (near & own).any()
    lenient = replace(found, lenient=True).region_kept_off("g")
    assert lenient.sum() < near.sum() and not (lenient & ~near).any()


def test_a_door_closed_to_things_is_open_to_the_robot() -> None:
    rows = ["b" * 26, *["b" + "." * 11 + "bb" + "." * 11 + "b"] * 4, "b..U" + "." * 8 + "bb" + "." * 11 + "b"]
    rows += [*["b" + "." * 24 + "b"] * 3, *rows[1:5], "b" * 26]
    found = replace(known_situation(rows), task=task_of("carry_nothing_through(d)."))
    assert found.forbidden("utak") == ()
    assert [door.name for door in found.forbidden("o1")] == ["d1"]
