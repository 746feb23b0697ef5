"""Carrying plans: done again with shapely alone, and refused where closed forms say so."""

import numpy as np
import pytest
import shapely
from shapely import affinity, box

from geometry.carrying import At, InCorner, Inside, Pose, plan_carrying
from geometry.rigid import Rotate, Translate
from tests.geometry.replay import replay, walls_of

ELL = shapely.Polygon([(0, 0), (6, 0), (6, 2), (2, 2), (2, 6), (0, 6)])
ROOM = box(26, 2, 50, 22)


def two_rooms(door: int, thick: int = 2) -> np.ndarray:
    """Two rooms about 22 x 20 and a door so wide between them, from row 10 up."""
    free = np.zeros((24, 52), bool)
    free[2:22, 2 : 26 - thick] = free[2:22, 26:50] = True
    free[10 : 10 + door, 26 - thick : 26] = True
    return free


@pytest.mark.parametrize("shape", [affinity.translate(ELL, 8, 8), box(8, 9, 12, 11), box(5, 3, 8, 6)])
@pytest.mark.parametrize("goal", [Inside([ROOM]), InCorner(50, 22, 1, 1), InCorner(26, 2, -1, -1, 0.5)])
def test_bodies_are_carried_into_the_next_room(shape: shapely.Polygon, goal: Inside | InCorner) -> None:
    free = two_rooms(5)
    plan = plan_carrying(shape, free, (3.5, 18.5), goal)
    assert plan.status == "found" and plan.commands <= 9
    end = replay(plan, shape, free, (3.5, 18.5))
    if isinstance(goal, Inside):
        assert ROOM.buffer(1e-6).covers(end)
    else:
        assert max(goal.gaps(end.bounds)) <= goal.slack


def test_all_stays_on_the_lattice() -> None:
    plan = plan_carrying(affinity.translate(ELL, 8, 8), two_rooms(5), (3.5, 18.5), Inside([ROOM]))
    for motion in [motion for leg in plan.legs for motion in leg.motions]:
        numbers = motion[:2] if isinstance(motion, Translate) else [motion.degrees / 90]
        assert all(number == int(number) for number in numbers)
    assert shapely.get_coordinates(plan.polygon).tolist() == shapely.get_coordinates(plan.polygon).round().tolist()


@pytest.mark.parametrize("pose", [Pose(30, 2, 0), Pose(30.3, 1.7, 90), Pose(28, 5, 180), Pose(0.25, 0, 0)])
def test_a_pose_is_reached_exactly(pose: Pose) -> None:
    shape = box(8, 9, 12, 11)
    plan = plan_carrying(shape, two_rooms(5), (3.5, 18.5), At(pose))
    end = replay(plan, shape, two_rooms(5), (3.5, 18.5))
    wanted = affinity.translate(affinity.rotate(shape, pose.degrees), pose.x, pose.y)
    assert end.symmetric_difference(wanted).area < 1e-6
    assert plan.pose is not None and plan.pose[:2] == pytest.approx(pose[:2])


def test_what_is_there_needs_no_legs() -> None:
    plan = plan_carrying(box(30, 5, 34, 7), two_rooms(5), (3.5, 18.5), Inside([ROOM]))
    assert (plan.status, plan.legs, plan.commands) == ("found", (), 0)


def test_too_narrow_a_door_is_proved_impossible() -> None:
    plan = plan_carrying(box(5, 5, 8, 8), two_rooms(2), (3.5, 18.5), Inside([ROOM]))
    assert plan.status == "impossible"
    assert plan.passage is not None and plan.passage.width == pytest.approx(2, abs=0.02)
    assert plan.missing == pytest.approx(1, abs=0.1)


def test_a_held_body_is_only_pushed() -> None:
    shape = box(8, 9, 12, 11)
    plan = plan_carrying(shape, two_rooms(5), (18.5, 10.5), Inside([ROOM]), pull=False)
    assert plan.status == "found"
    replay(plan, shape, two_rooms(5), (18.5, 10.5), pull=False)


def test_refuted_holds_are_not_used_again() -> None:
    shape, refuted = box(8, 9, 12, 11), []
    for _ in range(4):
        plan = plan_carrying(shape, two_rooms(5), (3.5, 18.5), Inside([ROOM]), avoid=refuted)
        assert plan.legs[0].hold not in refuted
        refuted.append(plan.legs[0].hold)


def test_a_margin_keeps_turns_from_walls() -> None:
    free, shape = two_rooms(5), affinity.translate(ELL, 2, 2)
    plan = plan_carrying(shape, free, (12.5, 12.5), At(Pose(9, 8, 90)), margin=0.4)
    replay(plan, shape, free, (12.5, 12.5))
    solid = walls_of(free)
    for leg in plan.legs:
        for motion in leg.motions:
            if isinstance(motion, Rotate):
                swept = [motion.part(t).carry(shape).buffer(0.39) for t in np.linspace(0, 1, 65)]
                assert not shapely.intersects(solid, swept).any()
            shape = motion.carry(shape)
