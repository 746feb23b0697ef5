"""Shapes and numbers that are invalid or barely valid: a clear error, or the answer for what they mean."""

import math
from typing import Any

import numpy as np
import pytest
import shapely
from shapely import MultiPolygon, Polygon, box

from utak.geometry.cspace.plan_motion import Inside, MotionPlan, plan_motion
from utak.geometry.manipulation.plan_carrying import At, InCorner, plan_carrying
from utak.geometry.motion.se2 import Pose
from utak.geometry.motion.validation import valid_polygons

BRICK = box(-2, -1, 2, 1)
WALLS = box(-1, -1, 26, 13).difference(shapely.union_all([box(0, 0, 12, 12), box(13, 0, 25, 12), box(12, 4, 13, 7)]))
START, GOAL = Pose(5, 6, 90), Pose(19, 7, 30)
FREE = np.zeros((14, 27), np.bool_)
FREE[1:13, 1:13] = FREE[1:13, 14:26] = FREE[5:8, 13] = True
LOAD, NEXT = box(4, 4, 8, 6), Inside(box(14, 1, 26, 13))
SAME = {
    "collinear": [(-2, -1), (0, -1), (1, -1), (2, -1), (2, 0), (2, 1), (-2, 1)],
    "repeated": [(-2, -1), (-2, -1), (2, -1), (2, -1), (2, 1), (-2, 1), (-2, 1)],
    "clockwise": [(-2, -1), (-2, 1), (2, 1), (2, -1)],
    "with a spike": [(-2, -1), (2, -1), (2, 1), (2, 3), (2, 1), (-2, 1)],
}
with np.errstate(invalid="ignore"):
    BROKEN = Polygon([(0, 0), (4, math.nan), (4, 4)])
    ENDLESS = Polygon([(0, 0), (4, math.inf), (4, 4)])
BOWTIE = [(14, 1), (24, 11), (24, 1), (14, 11)]


def move_brick(
    shape: Any = BRICK, walls: Any = WALLS, start: Pose = START, goal: Any = GOAL, **more: Any
) -> MotionPlan:
    """Plan the motion of the brick through the door, with the arguments given instead of the usual ones."""
    return plan_motion(shape, walls, start, goal, **more)


def carry_brick(shape: Any = LOAD, free: Any = FREE, utak: Any = (2.5, 2.5), goal: Any = NEXT, **more: Any) -> Any:
    """Plan carrying the brick into the next room, with the arguments given instead of the usual ones."""
    return plan_carrying(shape, free, utak, goal, **more)


@pytest.mark.parametrize("points", SAME.values(), ids=SAME)
def test_another_description_of_a_ring_is_the_same_body(points: list[tuple[float, float]]) -> None:
    shape = Polygon(points)
    assert valid_polygons(shape, "it").equals(BRICK)
    assert [m.pose(START) for m in move_brick(shape).motions[:1]] == [m.pose(START) for m in move_brick().motions[:1]]
    there = shapely.affinity.translate(shape, 6, 5)
    assert (carry_brick(there).status, carry_brick(there).commands) == ("found", carry_brick().commands)


def test_rings_that_cross_are_read_even_odd() -> None:
    assert valid_polygons(Polygon(BOWTIE), "it").area == pytest.approx(50)
    assert move_brick(goal=Inside(Polygon(BOWTIE))).status == "found"
    assert move_brick(walls=[WALLS, Polygon([(16, 1), (18, 3), (18, 1), (16, 3)])]).status == "found"
    assert move_brick(shapely.affinity.translate(Polygon(BOWTIE), -19, -6), start=Pose(6, 6)).status == "impossible"


@pytest.mark.parametrize("shape", [BROKEN, ENDLESS, box(0, 0, 1e12, 1)])
def test_coordinates_that_are_not_finite_or_too_large_are_refused(shape: Polygon) -> None:
    tries: list[Any] = [
        lambda: move_brick(shape),
        lambda: move_brick(walls=shape),
        lambda: move_brick(goal=Inside(shape)),
        lambda: carry_brick(shape),
        lambda: carry_brick(goal=Inside(shape)),
        lambda: carry_brick(walls=shape),
    ]
    for fails in tries:
        with pytest.raises(ValueError, match="must be finite"):
            fails()


@pytest.mark.parametrize("wrong", [math.nan, math.inf, 1e12])
def test_numbers_that_are_not_finite_or_too_large_are_refused(wrong: float) -> None:
    tries: list[Any] = [
        lambda: move_brick(start=Pose(wrong, 6)),
        lambda: move_brick(goal=Pose(6, wrong)),
        lambda: move_brick(points=[(wrong, 0)]),
        lambda: move_brick(pivot=(wrong, 0)),
        lambda: carry_brick(utak=(wrong, 1)),
        lambda: carry_brick(avoid=[(wrong, 0)]),
        lambda: carry_brick(goal=At(Pose(wrong, 0))),
        lambda: carry_brick(goal=At(Pose(0, 0, wrong))),
        lambda: carry_brick(goal=InCorner(wrong, 13, 1, 1)),
    ]
    for fails in tries:
        with pytest.raises(ValueError, match="finite"):
            fails()


@pytest.mark.parametrize(
    ("what", "match"),
    [
        ({"resolution": 0}, "resolution"),
        ({"resolution": math.nan}, "resolution"),
        ({"cells": 0}, "cell"),
        ({"cells": -5}, "cell"),
        ({"bounds": (25, 12, 0, 0)}, "bounds"),
        ({"bounds": (0, 0, 25)}, "bounds"),
        ({"bounds": (0, 0, math.nan, 12)}, "bounds"),
        ({"shape": None}, "area"),
        ({"shape": Polygon()}, "area"),
        ({"shape": Polygon([(-2, -1), (2, -1), (0, -1)])}, "area"),
        ({"shape": box(0, 0, 1e-9, 1e-9)}, "area"),
        ({"shape": shapely.LineString([(0, 0), (1, 1)])}, "area"),
    ],
)
def test_invalid_arguments_of_plan_motion_are_refused(what: dict[str, Any], match: str) -> None:
    with pytest.raises(ValueError, match=match):
        move_brick(**what)


@pytest.mark.parametrize(
    ("what", "match"),
    [
        ({"shape": None}, "area"),
        ({"shape": box(4, 4, 4 + 1e-9, 4 + 1e-9)}, "area"),
        ({"shape": MultiPolygon([box(4, 4, 5, 6), box(7, 4, 8, 6)])}, "a polygon"),
        ({"free": FREE[0]}, "rows"),
        ({"free": np.zeros((0, 0), np.bool_)}, "rows"),
        ({"walk": FREE[1:]}, "rows"),
        ({"margin": -1.0}, "margin"),
        ({"margin": math.nan}, "margin"),
        ({"goal": None}, "goal"),
        ({"goal": InCorner(26, 13, 0, 1)}, "corner"),
        ({"goal": InCorner(26, 13, 1, 1, -1.0)}, "corner"),
    ],
)
def test_invalid_arguments_of_plan_carrying_are_refused(what: dict[str, Any], match: str) -> None:
    with pytest.raises(ValueError, match=match):
        carry_brick(**what)


@pytest.mark.parametrize(
    "region", [Polygon(), Polygon([(14, 1), (20, 1), (17, 1)]), shapely.LineString([(14, 1), (20, 1)])]
)
def test_no_body_can_be_within_a_region_without_area(region: Any) -> None:
    assert move_brick(goal=Inside(region)).status == "impossible"
    assert carry_brick(goal=Inside(region)).status == "impossible"
    assert move_brick(goal=Inside([])).status == "impossible"


def test_a_body_at_its_goal_need_not_move() -> None:
    assert (move_brick(goal=START).status, move_brick(goal=START).motions) == ("found", ())
    assert move_brick(goal=Pose(5, 6, 450)).motions == ()
    assert carry_brick(goal=At(Pose(0, 0, 360))).legs == ()
    assert move_brick(start=Pose(12, 9), goal=Pose(12, 9)).reason == "start"


def test_a_start_or_goal_in_a_wall_is_named() -> None:
    assert move_brick(start=Pose(12, 9)).reason == "start"
    assert move_brick(goal=Pose(12, 9)).reason == "goal"
    assert move_brick(start=Pose(-50, 9), bounds=(0, 0, 25, 12)).reason == "start"
    assert carry_brick(box(11, 4, 15, 6)).reason == "start"
    assert carry_brick(box(-1e6, -1e6, 1e6, 1e6)).reason == "start"
    assert carry_brick(box(1e6, 1e6, 1e6 + 4, 1e6 + 2)).reason == "start"
    assert carry_brick(goal=At(Pose(1e6, 0))).reason == "goal"


def test_far_from_the_origin_the_same_plan_is_found() -> None:
    far = 1e6
    walls = shapely.affinity.translate(WALLS, far, far)
    plan = move_brick(walls=walls, start=Pose(5 + far, 6 + far, 90), goal=Pose(19 + far, 7 + far, 30))
    assert (plan.status, len(plan.motions)) == ("found", len(move_brick().motions))


def test_a_margin_wider_than_the_floor_is_kept_where_that_is_possible() -> None:
    assert carry_brick(margin=1e9).status == "found"
