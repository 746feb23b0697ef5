"""Carrying without pulling: what pushes away from the robot can and cannot do, by arguments that need no search.

A push must have a component from the robot to the middle of the body. So a body that fills a blind alley is never
brought out of it. A body in a corner is brought along a wall only by a robot on the corner's side of its middle.
"""

import numpy as np
import pytest
from shapely import box

from tests.geometry.replay import replay
from utak.geometry.manipulation.plan_carrying import At, InCorner, Inside, Pose, plan_carrying


def alley(width: int, bay: int = 0) -> np.ndarray:
    """Return a blind alley `width` wide, open to a room on the east, with a bay `bay` deep north of its western end."""
    free = np.zeros((width + bay + 10, 30), bool)
    free[5 : 5 + width, 2:14] = True
    free[1:-1, 14:29] = True
    free[5 + width : 5 + width + bay, 2:8] = True
    return free


@pytest.mark.parametrize("width", [1, 2, 3, 4])
def test_a_body_that_fills_a_blind_alley_must_be_pulled(width: int) -> None:
    """Three squares long, it can only be tilted a little in so narrow an alley: its far side is never reached."""
    free, room = alley(width), Inside([box(14, 1, 29, width + 9)])
    body = box(4, 5.2, 7, 4.8 + width)
    utak = (8.5, 5.5)
    pulled = plan_carrying(body, free, utak, room)
    assert pulled.status == "found"
    replay(pulled, body, free, utak)
    pushed = plan_carrying(body, free, utak, room, pull=False)
    assert (pushed.status, pushed.reason) == ("limit", "hold")


@pytest.mark.parametrize("width", [1, 2, 3])
def test_a_body_is_pushed_into_a_blind_alley(width: int) -> None:
    free = alley(width)
    body = box(16, 5.2, 18, 4.8 + width)
    plan = plan_carrying(body, free, (22.5, 2.5), At(Pose(-13, 0)), pull=False)
    assert plan.status == "found"
    assert np.allclose(replay(plan, body, free, (22.5, 2.5), pull=False).bounds, (3, 5.2, 5, 4.8 + width))


def test_a_bay_lets_the_robot_walk_round_the_body() -> None:
    """As above, but the robot can walk behind the body through the bay."""
    free, room = alley(2, bay=2), Inside([box(14, 1, 29, 13)])
    body = box(4, 5.2, 5, 6.8)
    plan = plan_carrying(body, free, (8.5, 5.5), room, pull=False)
    assert plan.status == "found" and plan.legs[0].place[0] < 4
    replay(plan, body, free, (8.5, 5.5), pull=False)


ROOM = np.pad(np.ones((10, 12), bool), 1)


def test_a_crate_of_one_square_is_never_pushed_out_of_a_corner() -> None:
    """The middle of a square next to it is not on the corner's side, and turning the crate would hit the wall."""
    crate, goal = box(12, 10, 13, 11), InCorner(1, 1, -1, -1)
    assert plan_carrying(crate, ROOM, (3.5, 3.5), goal).status == "found"
    plan = plan_carrying(crate, ROOM, (3.5, 3.5), goal, pull=False)
    assert (plan.status, plan.reason) == ("limit", "hold")


@pytest.mark.parametrize(("off", "status"), [(0.2, "found"), (0.01, "found"), (-0.01, "limit"), (-0.2, "limit")])
def test_a_robot_on_the_corners_side_slides_the_crate_along_the_wall(off: float, status: str) -> None:
    """From south of the crate, a little east of its middle, a push west is allowed; a little to the west it is not."""
    crate, utak = box(12, 10, 13, 11), (12.5 + off, 9.5)
    plan = plan_carrying(crate, ROOM, utak, InCorner(1, 1, -1, -1), pull=False, held=True)
    assert plan.status == status
    if status == "found":
        assert plan.legs[0].taken
        replay(plan, crate, ROOM, utak, pull=False)


@pytest.mark.parametrize("size", [2, 3])
def test_a_larger_crate_is_pushed_out_of_a_corner(size: int) -> None:
    """The middle of some square lies on the corner's side of the crate's own middle."""
    body, goal = box(13 - size, 11 - size, 13, 11), InCorner(1, 1, -1, -1)
    plan = plan_carrying(body, ROOM, (3.5, 3.5), goal, pull=False)
    assert plan.status == "found"
    replay(plan, body, ROOM, (3.5, 3.5), pull=False)


@pytest.mark.parametrize(("utak", "goal", "max_commands"), [((3.5, 3.5), (1, 1), 4), ((2.5, 2.5), (-1, 1), 5)])
def test_a_free_push_is_one_command(utak: tuple[float, float], goal: tuple[int, int], max_commands: int) -> None:
    """A square block in an open room goes into a corner: walk, grasp, one push, release."""
    free = np.pad(np.ones((20, 24), bool), 1)
    square = box(9, 8, 12, 11)
    corner = InCorner(25 if goal[0] > 0 else 1, 21 if goal[1] > 0 else 1, *goal)
    for pull in (True, False):
        plan = plan_carrying(square, free, utak, corner, pull=pull)
        assert [len(leg.motions) for leg in plan.legs] == [1] and plan.commands <= max_commands
        replay(plan, square, free, utak, pull)
