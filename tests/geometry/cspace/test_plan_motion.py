"""Planned motions: certified again with shapely when found; closed-form thresholds tested on both sides."""

import math

import numpy as np
import pytest
import shapely
from shapely import affinity, box

from utak.geometry.cspace.plan_motion import Inside, MotionPlan, plan_motion
from utak.geometry.motion.first_contact import ContactBody, Obstacles
from utak.geometry.motion.obstacle_field import ObstacleField
from utak.geometry.motion.se2 import Pose, Rotate

BRICK = box(-3, -1, 3, 1)


def two_rooms(door: float, thick: float = 1.0) -> shapely.Polygon:
    """Return the walls of two rooms of 12 x 12 in a row with a door in the middle of the wall between them."""
    rooms = box(0, 0, 12, 12).union(box(12 + thick, 0, 24 + thick, 12))
    return box(-1, -1, 25 + thick, 13).difference(rooms.union(box(12, 6 - door / 2, 12 + thick, 6 + door / 2)))


def check(plan: MotionPlan, shape: shapely.Geometry, walls: shapely.Geometry, start: Pose, goal: Pose | None) -> None:
    """Assert that the motions lead from start to goal and none of 257 poses a motion overlaps a wall."""
    assert plan.status == "found"
    solid = walls.buffer(-1e-6, join_style="mitre")
    shapely.prepare(solid)
    body = start.place(shape)
    for motion in plan.motions:
        swept = [motion.part(t).carry(body) for t in np.linspace(0, 1, 257)]
        assert not shapely.intersects(solid, swept).any()
        body = motion.carry(body)
    if goal is not None:
        assert body.symmetric_difference(goal.place(shape)).area < 1e-6


@pytest.mark.parametrize("door", [2.02, 2.3, 4.0])
def test_a_brick_passes_a_door_wider_than_itself(door: float) -> None:
    walls, start, goal = two_rooms(door), Pose(5, 6, 90), Pose(19, 7, 30)
    check(plan_motion(BRICK, walls, start, goal), BRICK, walls, start, goal)


@pytest.mark.parametrize("door", [1.5, 1.95, 1.99])
def test_a_narrower_door_is_proved_impossible(door: float) -> None:
    assert plan_motion(BRICK, two_rooms(door), Pose(5, 6, 90), Pose(19, 7, 30)).status == "impossible"


def corner(length: float) -> tuple[shapely.Geometry, shapely.Geometry]:
    """Return a brick 1.6 wide and a corner of a corridor 4 wide.

    `length` is a part of the length of the longest brick that turns the corner.
    """
    field = box(0, 0, 20, 4).union(box(16, 0, 20, 20))
    longest = 2 * (math.sqrt(2) * 4 - 1.6)
    half = length * longest / 2
    return box(-half, -0.8, half, 0.8), box(-1, -1, 21, 21).difference(field)


@pytest.mark.parametrize("part", [0.9, 0.97, 0.99])
def test_a_brick_turns_a_corner(part: float) -> None:
    brick, walls = corner(part)
    start, goal = Pose(5, 2, 0), Pose(18, 15, 90)
    check(plan_motion(brick, walls, start, goal), brick, walls, start, goal)


@pytest.mark.parametrize("part", [1.005, 1.03])
def test_a_longer_brick_is_proved_not_to_turn_the_corner(part: float) -> None:
    brick, walls = corner(part)
    assert plan_motion(brick, walls, Pose(5, 2, 0), Pose(18, 15, 90)).status == "impossible"


def sofa(size: float, steps: int = 32) -> shapely.Polygon:
    """Return Hammersley's sofa for a corridor 1 wide, scaled: it turns the corner up to size 1 and not above."""
    r = 2 / math.pi
    a = np.linspace(0, math.pi / 2, steps)
    right = np.column_stack([r + np.sin(a), np.cos(a)])[::-1]
    left = np.column_stack([-r - np.sin(a), np.cos(a)])
    bite = np.linspace(0, math.pi, 2 * steps)
    inner = np.column_stack([-r * np.cos(bite), r * np.sin(bite)])
    outline = shapely.Polygon([*right, *left, *inner])
    return affinity.scale(outline, size, size, origin=(0, 0.5))


@pytest.mark.long
@pytest.mark.parametrize(("size", "status"), [(0.97, "found"), (0.99, "found"), (1.01, "impossible")])
def test_a_sofa_turns_the_corner_up_to_its_closed_form_size(size: float, status: str) -> None:
    field = box(-6, 0, 1, 1).union(box(0, -6, 1, 1))
    walls = box(-7, -7, 2, 2).difference(field)
    start, goal = Pose(-4, 0, 0), Pose(0, -4, -90)
    plan = plan_motion(sofa(size), walls, start, goal, resolution=5e-4)
    assert plan.status == status
    if status == "found":
        check(plan, sofa(size), walls, start, goal)


def test_a_start_that_touches_walls() -> None:
    walls = two_rooms(3.0)
    start, goal = Pose(1, 3, 90), Pose(22 - 0.0, 12 - 1.0, 0)
    check(plan_motion(BRICK, walls, start, goal), BRICK, walls, start, goal)


def test_an_exact_fit_is_answered_with_limit_not_impossible() -> None:
    """Flush on both sides in a slot, no cell has room for the body: the method reports its limit."""
    slot = box(0, 0, 20, 12).difference(box(1, 1, 13, 11)).difference(box(13, 5, 19, 7))
    assert plan_motion(BRICK, slot, Pose(16, 6, 0), Pose(5, 5, 90), cells=3000).status == "limit"
    roomy = box(0, 0, 20, 12).difference(box(1, 1, 13, 11)).difference(box(13, 4.95, 19, 7))
    start, goal = Pose(16, 6, 0), Pose(5, 5, 90)
    check(plan_motion(BRICK, roomy, start, goal), BRICK, roomy, start, goal)


@pytest.mark.parametrize("door", [4.0, 6.0])
def test_a_flush_passage_is_left_for_a_roomy_one(door: float) -> None:
    """An L of 6 x 6 fits a door of 6 flush, and its arms, 2 wide, one of 4: it turns instead, and soon."""
    ell = affinity.translate(shapely.Polygon([(0, 0), (6, 0), (6, 2), (2, 2), (2, 6), (0, 6)]), -2.2, -2.2)
    walls, start = two_rooms(door), Pose(5.2, 5.2, 0)
    for goal in (Pose(19, 6, 180), Inside(box(13, 0, 25, 12))):
        plan = plan_motion(ell, walls, start, goal, cells=5000)
        check(plan, ell, walls, start, goal if isinstance(goal, Pose) else None)


def test_an_overlap_at_either_end_is_the_reason() -> None:
    walls = two_rooms(3.0)
    assert plan_motion(BRICK, walls, Pose(12, 2), Pose(5, 5)).reason == "start"
    assert plan_motion(BRICK, walls, Pose(5, 5), Pose(12, 2)).reason == "goal"


def test_a_region_as_goal() -> None:
    """Anywhere in the other room will do, at any angle; a room too small will not."""
    walls, start = two_rooms(3.0), Pose(5, 6, 90)
    room = box(13, 0, 25, 12)
    plan = plan_motion(BRICK, walls, start, Inside(room))
    check(plan, BRICK, walls, start, None)
    assert room.buffer(1e-6).covers(plan.poses[-1].place(BRICK))
    assert plan_motion(BRICK, walls, start, Inside(box(14, 1, 19.5, 2.5))).status == "impossible"


def test_points_move_with_the_body() -> None:
    """A brick passes a door of 2.4 with Utak at its end; with Utak at its side, Utak would hit the wall."""
    walls, start, goal = two_rooms(2.4), Pose(5, 6, 0), Pose(19, 6, 0)
    at_end = plan_motion(BRICK, walls, start, goal, points=[(-3.5, 0.0)])
    check(at_end, BRICK, walls, start, goal)
    solid = walls.buffer(-1e-6)
    utak = shapely.Point(start.x - 3.5, start.y)
    for motion in at_end.motions:
        assert not any(motion.part(t).carry(utak).within(solid) for t in np.linspace(0, 1, 65))
        utak = motion.carry(utak)
    beside = plan_motion(BRICK, walls, start, goal, points=[(0.0, 1.5)])
    assert beside.status == "impossible"


def test_an_obstacle_field_serves_several_plans() -> None:
    walls = two_rooms(3.0)
    field = ObstacleField(walls, (0, 0, 25, 12))
    plans = [plan_motion(BRICK, field, Pose(5, 6, 90), Pose(19, 7, degrees)) for degrees in (0, 90, 200)]
    assert [plan.status for plan in plans] == ["found"] * 3
    assert plans[0] == plan_motion(BRICK, walls, Pose(5, 6, 90), Pose(19, 7, 0), bounds=(0, 0, 25, 12))


def test_the_reference_point_stays_within_its_bounds() -> None:
    walls, start, goal = two_rooms(3.0), Pose(5, 6, 90), Pose(19, 7, 30)
    bounds = (2, 2, 22, 8)
    plan = plan_motion(affinity.translate(BRICK, 1, 0), walls, start, goal, bounds=bounds)
    place = shapely.Point(start.x, start.y)
    for motion in plan.motions:
        track = [motion.part(t).carry(place) for t in np.linspace(0, 1, 33)]
        assert all(box(*bounds).buffer(1e-6).covers(p) for p in track)
        place = motion.carry(place)
    assert plan_motion(BRICK, walls, start, goal, bounds=(2, 2, 10, 8)).reason == "goal"


def test_the_length_is_that_of_the_path_of_the_reference_point() -> None:
    plan = plan_motion(BRICK, two_rooms(3.0), Pose(5, 6, 90), Pose(19, 7, 30))
    samples = []
    for motion, pose in zip(plan.motions, plan.poses, strict=False):
        samples += [motion.part(t).pose(pose)[:2] for t in np.linspace(0, 1, 400 if isinstance(motion, Rotate) else 2)]
    assert plan.length == pytest.approx(shapely.LineString(samples).length, rel=1e-4)


@pytest.mark.parametrize("wrong", [math.nan, math.inf])
def test_bad_numbers_are_refused(wrong: float) -> None:
    with pytest.raises(ValueError, match="finite"):
        plan_motion(BRICK, two_rooms(3.0), Pose(wrong, 6), Pose(19, 7), bounds=(0, 0, 25, 12))
    with pytest.raises(ValueError, match="area"):
        plan_motion(shapely.Point(0, 0), two_rooms(3.0), Pose(5, 6), Pose(19, 7))


@pytest.mark.long
@pytest.mark.parametrize(("door", "missing"), [(1.7, 0.3), (1.95, 0.05)])
def test_the_passage_and_its_missing_width_are_found(door: float, missing: float) -> None:
    plan = plan_motion(BRICK, two_rooms(door), Pose(5, 6, 90), Pose(19, 7, 30))
    assert plan.passage is not None
    assert plan.passage.width == pytest.approx(door, abs=0.01)
    assert math.dist(plan.passage.place, (12.5, 6)) < 0.7
    assert plan.opens
    assert plan.missing == pytest.approx(missing, abs=0.05)


def test_where_two_passages_are_too_narrow_widening_one_alone_does_not_help() -> None:
    doors = [box(12, 6 - 0.8, 13, 6 + 0.8), box(25, 6 - 0.8, 26, 6 + 0.8)]
    rooms = shapely.union_all([box(0, 0, 12, 12), box(13, 0, 25, 12), box(26, 0, 38, 12), *doors])
    plan = plan_motion(BRICK, box(-1, -1, 39, 13).difference(rooms), Pose(5, 6), Pose(32, 6), (0, 0, 38, 12))
    assert plan.passage is not None and plan.passage.width == pytest.approx(1.6, abs=0.01)
    assert not plan.opens
    assert plan.missing == math.inf


@pytest.mark.long
@pytest.mark.parametrize("bottom", [28.0, 28.3, 28.57, 29.0])
def test_a_slit_that_falls_between_the_pixels_of_a_large_floor_is_the_passage(bottom: float) -> None:
    rooms = [box(2, 2, 37, 90), box(39, 2, 76, 90), box(37, bottom, 39, bottom + 0.6)]
    walls = box(-2, -2, 78, 94).difference(shapely.union_all(rooms))
    plan = plan_motion(BRICK, walls, Pose(49.5, 64), Pose(20, 40), (0, 0, 78, 92))
    assert plan.passage is not None
    assert plan.passage.width == pytest.approx(0.6, abs=0.01)
    assert math.dist(plan.passage.place, (38, bottom + 0.3)) < 1.1
    assert plan.missing == pytest.approx(1.4, abs=0.05)


def test_moving_the_sides_of_a_door_opens_no_wall_behind_which_there_is_room() -> None:
    """The reference point lies beside the body: if the outer walls opened, it could pass outside, within bounds."""
    chest = box(-3.4, -1.4, -0.6, 1.4)
    rooms = shapely.union_all([box(0, 0, 12, 10), box(14, 0, 26, 10), box(12, 5.38, 14, 6.62)])
    walls = box(-1, -1, 27, 11).difference(rooms)
    plan = plan_motion(chest, walls, Pose(7, 6, 180), Pose(20, 6, 180), (0, 0, 26, 10))
    assert (plan.status, plan.missing) == ("impossible", pytest.approx(1.56, abs=0.05))


def test_a_plan_that_is_found_has_no_missing_width() -> None:
    plan = plan_motion(BRICK, two_rooms(3.0), Pose(5, 6, 90), Pose(19, 7, 30))
    assert plan.passage is None and not plan.opens
    assert math.isnan(plan.missing)


def slotted(door: float) -> list[shapely.Geometry]:
    """Return the walls of a room of 20 x 20 with a wall across that has a door."""
    room = shapely.box(0, 0, 20, 20).difference(shapely.box(1, 1, 19, 19))
    return [room, shapely.box(10, 1, 11, 10 - door / 2), shapely.box(10, 10 + door / 2, 11, 19)]


@pytest.mark.parametrize("size", [1e-3, 1e-4, 1e-5])
@pytest.mark.parametrize(("times", "status"), [(0.0, "impossible"), (0.9, "impossible"), (1.5, "found"), (40, "found")])
def test_a_very_small_body_is_decided_by_its_discs(size: float, times: float, status: str) -> None:
    body = shapely.box(-size / 2, -size / 2, size / 2, size / 2)
    plan = plan_motion(body, slotted(times * size), Pose(3, 3, 0), Pose(17, 3, 90), cells=4000)
    assert plan.status == status
    at = Pose(3, 3, 0)
    for motion in plan.motions:
        assert Obstacles(slotted(times * size)).first_contact(ContactBody(at.place(body)), motion) == 1.0
        at = motion.pose(at)
    assert status != "found" or (at.x, at.y, at.degrees) == pytest.approx((17, 3, 90), abs=1e-9)


def test_a_body_too_small_for_cells_in_a_tight_passage_is_refused() -> None:
    body = shapely.box(-5e-5, -5e-5, 5e-5, 5e-5)
    with pytest.raises(ValueError, match="smallest cells"):
        plan_motion(body, slotted(1.1e-4), Pose(3, 3, 0), Pose(17, 3, 90), cells=4000)


@pytest.mark.parametrize("goal", [Pose(19, 6, 0), Inside(box(16, 5, 22, 7))])
@pytest.mark.parametrize("cells", [12, 4000])
def test_a_goal_behind_a_solid_wall_is_proved_to_be_out_of_reach_however_few_cells_there_are(
    goal: Pose | Inside, cells: int
) -> None:
    """What the cells leave undecided is decided by the disc within the brick: it cannot pass the wall."""
    walls = box(0, 0, 26, 12).difference(box(1, 1, 11, 11)).difference(box(14, 5, 25, 7))
    plan = plan_motion(BRICK, walls, Pose(5, 5, 0), goal, cells=cells)
    assert plan.status == "impossible"
    assert plan.question is not None and (plan.question.reached[:, 0] < 12).all()


def test_what_lies_behind_a_door_as_wide_as_the_disc_is_not_proved_to_be_out_of_reach() -> None:
    walls = box(0, 0, 26, 12).difference(box(1, 1, 11, 11)).difference(box(11, 5, 25, 7))
    assert plan_motion(BRICK, walls, Pose(5, 6, 90), Pose(19, 6, 0), cells=4000).status != "impossible"


@pytest.mark.parametrize("seed", range(4))
def test_the_raster_of_a_field_holds_the_distance_to_the_nearest_wall(seed: int) -> None:
    rng = np.random.default_rng(seed)
    corners = rng.uniform(0, 20, (6, 2))
    walls = shapely.union_all([box(*corner, *(corner + rng.uniform(0.2, 6, 2))) for corner in corners])
    field = ObstacleField(walls, (0.0, 0.0, 22.0, 18.0))
    rows, columns = np.indices(field.raster.shape)
    x, y = (field.frame[k] + (index + 0.5) * field.frame[2] for k, index in enumerate((columns, rows)))
    places = shapely.points(x, y)
    distances = shapely.distance(walls.boundary, places)
    signed = np.where(shapely.contains(walls, places), -distances, distances)
    assert np.abs(field.raster - signed).max() < 1e-9
