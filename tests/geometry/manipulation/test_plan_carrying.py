"""Plans of plan_carrying: replayed with shapely alone, and refused where closed forms say so."""

import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import affinity, box

from benchmarks.errands import faults, free_squares, goal_of
from benchmarks.worlds.makers import scenario
from tests.geometry.replay import replay, walls_of
from tests.tables import few
from utak.geometry.manipulation.free_body import plan_body_alone
from utak.geometry.manipulation.goals import Roomy, is_goal_met, moved
from utak.geometry.manipulation.legs import verified
from utak.geometry.manipulation.plan_carrying import (
    At,
    Between,
    CarryingPlan,
    InCorner,
    Inside,
    Pose,
    plan_carrying,
)
from utak.geometry.manipulation.query import ManipulationQuery
from utak.geometry.manipulation.single_grasp import plan_with_one_grasp
from utak.geometry.manipulation.workspace import Workspace
from utak.geometry.motion.se2 import Rotate, Translate

ELL = shapely.Polygon([(0, 0), (6, 0), (6, 2), (2, 2), (2, 6), (0, 6)])
ROOM = box(26, 2, 50, 22)


def two_rooms(door: int, thick: int = 2) -> np.ndarray:
    """Return the free squares of two rooms of about 22 x 20 with a door between them, from row 10 up.

    `door` is its width in squares, `thick` the thickness of the wall.
    """
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


def test_a_body_on_the_lattice_ends_on_the_lattice() -> None:
    plan = plan_carrying(affinity.translate(ELL, 8, 8), two_rooms(5), (3.5, 18.5), Inside([ROOM]))
    for motion in [motion for leg in plan.legs for motion in leg.motions]:
        numbers = motion[:2] if isinstance(motion, Translate) else [motion.degrees / 90]
        assert all(number == int(number) for number in numbers)
    assert shapely.get_coordinates(plan.polygon).tolist() == shapely.get_coordinates(plan.polygon).round().tolist()


@given(st.floats(-4, 4), st.floats(-5, 5), st.booleans())
@settings(max_examples=30, deadline=None)
def test_one_push_is_planned_where_one_is_enough(dx: float, dy: float, held: bool) -> None:
    shape, free = box(8, 9, 12, 11), two_rooms(5)
    utak = (7.5, 10.5) if held else (3.5, 18.5)
    plan = plan_carrying(shape, free, utak, At(Pose(dx, dy, 0.0)), held=held)
    end = replay(plan, shape, free, utak)
    assert end.bounds == pytest.approx(affinity.translate(shape, dx, dy).bounds, abs=1e-5)
    assert [len(leg.motions) for leg in plan.legs] in ([1], [])
    assert plan.goes_on == (held and bool(plan.legs))


@pytest.mark.parametrize("pose", [Pose(30, 2, 0), Pose(30.3, 1.7, 90), Pose(28, 5, 180), Pose(0.25, 0, 0)])
def test_a_pose_is_reached_exactly(pose: Pose) -> None:
    shape = box(8, 9, 12, 11)
    plan = plan_carrying(shape, two_rooms(5), (3.5, 18.5), At(pose))
    end = replay(plan, shape, two_rooms(5), (3.5, 18.5))
    wanted = affinity.translate(affinity.rotate(shape, pose.degrees), pose.x, pose.y)
    assert end.symmetric_difference(wanted).area < 1e-6
    assert plan.pose is not None and plan.pose[:2] == pytest.approx(pose[:2])


def test_a_goal_that_is_met_needs_no_legs() -> None:
    plan = plan_carrying(box(30, 5, 34, 7), two_rooms(5), (3.5, 18.5), Inside([ROOM]))
    assert (plan.status, plan.legs, plan.commands) == ("found", (), 0)


@pytest.mark.long
def test_a_door_that_is_too_narrow_is_proved_impossible() -> None:
    plan = plan_carrying(box(5, 5, 8, 8), two_rooms(2), (3.5, 18.5), Inside([ROOM]))
    assert plan.status == "impossible"
    assert plan.passage is not None and plan.passage.width == pytest.approx(2, abs=0.02)
    assert plan.missing == pytest.approx(1, abs=0.1)


def test_a_held_body_is_only_pushed() -> None:
    shape = box(8, 9, 12, 11)
    plan = plan_carrying(shape, two_rooms(5), (18.5, 10.5), Inside([ROOM]), pull=False)
    assert plan.status == "found"
    replay(plan, shape, two_rooms(5), (18.5, 10.5), pull=False)


def test_grasps_to_avoid_are_not_used() -> None:
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


@pytest.mark.parametrize("pull", [True, False])
@pytest.mark.parametrize("utak", [(7.5, 9.5), (7.7, 10.3), (8.0, 8.2)])
def test_the_present_grasp_is_used(utak: tuple[float, float], pull: bool) -> None:
    """On the lattice or off it: neither released nor grasped again, and a straight push is one command."""
    dx, dy = utak[0] - 7.5, utak[1] - 9.5
    shape = affinity.translate(box(8, 9, 12, 11), dx, dy)
    free = two_rooms(5)
    plan = plan_carrying(shape, free, utak, Inside([ROOM]), pull=pull, held=True)
    assert plan.legs[0].taken and plan.legs[0].walk == 0 and plan.legs[0].place == utak
    assert len(plan.legs) == 1 and plan.commands == len(plan.legs[0].motions) + 1
    assert ROOM.buffer(1e-6).covers(replay(plan, shape, free, utak, pull))
    assert plan.commands < plan_carrying(shape, free, utak, Inside([ROOM]), pull=pull).commands


@pytest.mark.parametrize(("dx", "dy"), [(0.0, 0.0), (0.35, 0.06), (-0.4, 0.49)])
def test_a_body_on_the_lattice_stays_there_when_held_off_the_centre_of_a_square(dx: float, dy: float) -> None:
    """Two squares along the wall that it touches, into the corner; no push to the centre of a square first."""
    free, utak = two_rooms(5), (18.5 + dx, 19.5 + dy)
    square = box(19, 17, 22, 22)
    plan = plan_carrying(square, free, utak, InCorner(24, 22, 1, 1, slack=0.5), held=True)
    ((push,),) = [leg.motions for leg in plan.legs]
    assert push == Translate(2.0, 0.0) and plan.legs[0].place == utak
    assert replay(plan, square, free, utak).bounds == (21.0, 17.0, 24.0, 22.0)


def test_a_body_held_off_the_centre_is_turned_from_the_centre() -> None:
    """A turn about another place would leave it between the squares."""
    free, utak = two_rooms(3), (7.7, 9.4)
    brick = box(8, 8, 10, 13)
    plan = plan_carrying(brick, free, utak, Inside([ROOM]), held=True)
    turns = [motion for leg in plan.legs for motion in leg.motions if isinstance(motion, Rotate)]
    assert turns and all(np.allclose(np.array(turn.about) % 1, 0.5) for turn in turns)


def test_a_present_grasp_that_must_be_avoided_is_released() -> None:
    shape, free, utak = box(8, 9, 12, 11), two_rooms(5), (7.5, 9.5)
    middle = shape.centroid
    refuted = [(utak[0] - middle.x, utak[1] - middle.y)]
    plan = plan_carrying(shape, free, utak, Inside([ROOM]), avoid=refuted, held=True)
    assert plan.status == "found" and not plan.legs[0].taken
    unheld = plan_carrying(shape, free, utak, Inside([ROOM]), avoid=refuted)
    assert plan.legs == unheld.legs and plan.commands == unheld.commands + 1  # the release


@pytest.mark.long
def test_a_brick_leaves_a_blind_alley_only_when_held_from_behind() -> None:
    """The alley is as wide as the brick.

    In front of it the robot would have to walk round, and cannot. From behind it pushes the brick out.
    """
    free = np.zeros((8, 30), bool)
    free[2:6, 1:29] = True
    shape, utak = box(20, 2.2, 22, 5.8), (22.5, 3.5)
    held = plan_carrying(shape, free, utak, Inside([box(23, 2, 29, 6)]), held=True, pull=False)
    assert held.status == "limit" and held.reason == "hold"
    behind = plan_carrying(shape, free, (19.5, 3.5), Inside([box(23, 2, 29, 6)]), held=True, pull=False)
    assert behind.status == "found" and behind.legs[0].taken and behind.commands == 2


def test_the_present_grasp_of_a_body_at_an_angle_is_used() -> None:
    """A brick through a door that it passes only when aligned: the first leg uses the present grasp."""
    free, utak = two_rooms(3), (7.6, 6.1)
    brick = affinity.rotate(box(8, 4, 12, 7), 13)
    plan = plan_carrying(brick, free, utak, Inside([ROOM]), held=True)
    assert plan.status == "found" and plan.legs[0].taken
    replay(plan, brick, free, utak)


@pytest.mark.long
@settings(max_examples=20, deadline=None, derandomize=True)
@given(
    st.floats(5, 12),
    st.floats(5, 15),
    st.floats(0, 360),
    st.integers(0, 3),
    st.sampled_from([Inside([ROOM]), InCorner(2, 22, -1, 1), At(Pose(24, 3, 30))]),
    st.booleans(),
)
def test_any_present_grasp_can_be_used(
    x: float, y: float, degrees: float, side: int, goal: At | Inside | InCorner, pull: bool
) -> None:
    free, shape = two_rooms(5), affinity.rotate(box(x, y, x + 4, y + 2), degrees)
    utak = [(x - 0.4, y + 1), (x + 4.4, y + 0.5), (x + 1, y - 0.4), (x + 3, y + 2.4)][side]
    spoke = affinity.rotate(shapely.Point(utak), degrees, origin=shape.centroid)
    utak = (spoke.x, spoke.y)
    walls = walls_of(free)
    if walls.intersects(shape) or walls.intersects(spoke):
        return
    plan = plan_carrying(shape, free, utak, goal, pull=pull, held=True)
    assert plan.status == "found" or not pull
    replay(plan, shape, free, utak, pull)
    assert plan == plan_carrying(shape, free, utak, goal, pull=pull, held=True)


@st.composite
def bricks_and_doors(draw: st.DrawFn) -> tuple[shapely.Polygon, np.ndarray, int]:
    """Draw a brick at any angle in the western of two rooms; the floor; how much wider the door is."""
    thin, more, door = draw(st.integers(1, 3)), draw(st.integers(0, 3)), draw(st.integers(1, 5))
    brick = affinity.translate(box(0, 0, thin + more, thin), draw(st.integers(6, 13)), draw(st.integers(6, 13)))
    degrees = draw(st.sampled_from([0, 0, 90, 17, -38, 45, 131]))
    free = two_rooms(door, draw(st.integers(1, 3)))
    return affinity.rotate(brick, degrees, origin=(13, 12)), free, door - thin


@pytest.mark.long
@settings(max_examples=25, deadline=None, derandomize=True)
@given(bricks_and_doors(), st.sampled_from([(3.5, 3.5), (22.5, 20.5), (2.2, 20.7)]), st.booleans())
def test_a_brick_passes_just_the_doors_that_are_wide_enough(
    scene: tuple[shapely.Polygon, np.ndarray, int], utak: tuple[float, float], pull: bool
) -> None:
    brick, free, spare = scene
    plan = plan_carrying(brick, free, utak, Inside([ROOM]), pull=pull)
    if spare < 0:
        assert plan.status == "impossible"
    else:
        assert plan.status == "found" or (not pull and plan.status == "limit")
        assert plan.status != "found" or ROOM.buffer(1e-6).covers(replay(plan, brick, free, utak, pull))


def exact(floor: shapely.Polygon, columns: int = 25, rows: int = 12) -> tuple[np.ndarray, shapely.Polygon]:
    """Return the squares that a floor covers whole, and its walls."""
    x, y = np.meshgrid(np.arange(columns), np.arange(rows))
    free = shapely.covers(floor, box(x, y, x + 1, y + 1))
    return free, box(-4, -4, columns + 4, rows + 4).difference(floor)


def door_of(width: float) -> shapely.Polygon:
    """Return the floor of two rooms of 12 x 12 with a door in a wall 1 square thick between them."""
    return box(0, 0, 12, 12).union(box(13, 0, 25, 12)).union(box(12, 6 - width / 2, 13, 6 + width / 2))


def test_an_ell_passes_a_door_that_only_just_lets_it() -> None:
    floor = door_of(3.6)
    free, walls = exact(floor)
    ell = affinity.translate(ELL, 3, 3)
    plan = plan_carrying(ell, free, (1.5, 1.5), Inside([box(13, 0, 25, 12)]), walls=walls)
    assert plan.status == "found" and plan.commands <= 13
    replay(plan, ell, free, (1.5, 1.5), walls=walls)


@pytest.mark.parametrize(("door", "status"), [(2.2, "found"), (2.05, "found"), (1.95, "impossible")])
def test_a_brick_at_a_door_that_no_squares_make(door: float, status: str) -> None:
    free, walls = exact(door_of(door))
    for degrees in (0, 90, 33):
        brick = affinity.rotate(box(4, 4, 8, 6), degrees)
        plan = plan_carrying(brick, free, (1.5, 1.5), Inside([box(13, 0, 25, 12)]), walls=walls)
        assert plan.status == status and plan.commands <= 12
        replay(plan, brick, free, (1.5, 1.5), walls=walls)


@pytest.mark.parametrize(("part", "status"), [(0.97, "found"), (1.005, "impossible")])
def test_a_brick_round_a_corner_on_both_sides_of_the_threshold(part: float, status: str) -> None:
    free, walls = exact(box(0, 0, 20, 4).union(box(16, 0, 20, 20)), 20, 20)
    half = part * (math.sqrt(2) * 4 - 1.6)
    brick = box(5 - half, 1.2, 5 + half, 2.8)
    plan = plan_carrying(brick, free, (0.5, 0.5), Inside([box(16, 4, 20, 20)]))
    assert plan.status == status
    replay(plan, brick, free, (0.5, 0.5), walls=walls)


def test_a_body_at_an_angle_is_aligned_where_it_must_be() -> None:
    free, brick = two_rooms(3), affinity.rotate(box(8, 4, 12, 7), 33)
    plan = plan_carrying(brick, free, (3.5, 3.5), Inside([ROOM]))
    assert plan.status == "found" and len(plan.legs) == 2
    end = replay(plan, brick, free, (3.5, 3.5))
    assert np.abs(shapely.get_coordinates(end) - shapely.get_coordinates(end).round()).max() < 1e-7


def test_a_body_at_an_angle_is_aligned_where_it_would_reach_too_far_from_a_corner() -> None:
    free, square = two_rooms(3), affinity.rotate(box(8, 4, 12, 8), 33)
    at_an_angle = plan_carrying(square, free, (3.5, 3.5), InCorner(24, 22, 1, 1))
    assert at_an_angle.status == "found" and len(at_an_angle.legs) == 1
    goal = InCorner(24, 22, 1, 1, within=(4.5, 4.5))
    plan = plan_carrying(square, free, (3.5, 3.5), goal)
    assert plan.status == "found"
    end = replay(plan, square, free, (3.5, 3.5))
    assert goal.admits(end.bounds) and not goal.admits(at_an_angle.polygon.bounds)


def test_a_body_that_no_lattice_plan_aligns_is_aligned_with_one_grasp() -> None:
    free, square = two_rooms(3), affinity.rotate(box(8, 4, 12, 8), 33)
    goal = InCorner(24, 22, 1, 1, within=(4.5, 4.5))
    query = ManipulationQuery(square, Workspace(free), (3.5, 3.5), goal, 0.0, True, (), free)
    legs = plan_with_one_grasp(query, plan_body_alone(query).track)
    assert legs is not None and len(legs) == 1
    plan = CarryingPlan("found", tuple(legs), polygon=verified(query.workspace, square, legs))
    assert goal.admits(replay(plan, square, free, (3.5, 3.5)).bounds)


def test_the_body_is_grasped_again_from_the_other_side() -> None:
    free = np.zeros((12, 20), bool)
    free[1:3, 1:19] = free[9:11, 1:19] = free[1:11, 1:3] = free[1:11, 17:19] = True  # a ring two squares wide
    brick = box(6, 1, 10, 3)
    plan = plan_carrying(brick, free, (4.5, 1.5), InCorner(1, 1, -1, -1), pull=False)
    assert plan.status == "found" and plan.legs[0].place[0] > 10
    replay(plan, brick, free, (4.5, 1.5), pull=False)
    there_and_back = At(Pose(-5, 0, 0))
    plan = plan_carrying(brick, free, (4.5, 1.5), there_and_back)
    assert plan.status == "found"
    replay(plan, brick, free, (4.5, 1.5))


def turns_of(plan: CarryingPlan) -> int:
    return sum(isinstance(motion, Rotate) for leg in plan.legs for motion in leg.motions)


def test_the_robot_walks_round_instead_of_turning_where_turns_cost_more() -> None:
    brick, utak, corner = box(8, 9, 12, 11), (12.5, 9.5), InCorner(24, 22, 1, 1, 0.1)
    turned, walked = (plan_carrying(brick, two_rooms(5), utak, corner, turn=turn) for turn in (1.0, 2.5))
    assert turns_of(turned) == 1
    assert turns_of(walked) == 0
    assert walked.legs[0].walk > 0
    for plan in (turned, walked):
        replay(plan, brick, two_rooms(5), utak)


@pytest.mark.parametrize(("task", "seed"), few([(task, seed) for task in (6, 7, 9) for seed in range(6)], 3))
def test_costly_turns_are_made_only_where_they_save_more(task: int, seed: int) -> None:
    world = scenario(task, 40 + seed)
    if not world.possible:
        return
    shape, free, goal = world.things[0].polygon, free_squares(world), goal_of(world)
    cheap, costly = (plan_carrying(shape, free, (world.utak.x, world.utak.y), goal, turn=turn) for turn in (1.0, 2.5))
    assert costly.status == cheap.status == "found"
    assert faults(costly, shape, free, goal) == []
    assert turns_of(costly) <= turns_of(cheap)
    assert (
        costly.commands + 1.5 * turns_of(costly) <= cheap.commands + 1.5 * turns_of(cheap) + 1
    )  # walks count by length


@pytest.mark.parametrize(("task", "seed"), few([(task, seed) for task in range(5, 10) for seed in range(4)], 5))
def test_random_worlds(task: int, seed: int) -> None:
    world = scenario(task, 8 + seed)
    shape, free, goal = world.things[0].polygon, free_squares(world), goal_of(world)
    plan = plan_carrying(shape, free, (world.utak.x, world.utak.y), goal)
    assert plan.status == ("found" if world.possible else "impossible")
    if plan.status == "found":
        assert faults(plan, shape, free, goal) == []
    else:
        assert plan.missing == pytest.approx(world.missing, abs=0.05)


@pytest.mark.parametrize(
    "wrong",
    [
        {"shape": shapely.Point(1, 1)},
        {"free": np.ones(5, bool)},
        {"walk": np.ones((2, 2), bool)},
        {"margin": -1.0},
        {"utak": (math.nan, 0.0)},
        {"goal": InCorner(50, 22, 1, 1, within=(6.0, 4.0))},
        {"goal": InCorner(50, 22, 1, 1, within=(math.nan, 4.0))},
        {"turn": 0.5},
        {"turn": 3.0},
        {"turn": math.nan},
    ],
)
def test_arguments_that_make_no_sense_are_refused(wrong: dict[str, object]) -> None:
    goal = At(Pose(1, 0))
    asked: dict[str, object] = {"shape": box(2, 2, 4, 4), "free": two_rooms(5), "utak": (9.5, 9.5), "goal": goal}
    with pytest.raises(ValueError):
        plan_carrying(**(asked | wrong))


@pytest.mark.long
@given(st.integers(0, 40), st.integers(0, 40))
@settings(max_examples=20, deadline=None)
def test_a_translated_query_has_a_translated_plan(dx: int, dy: int) -> None:
    free, shape, goal = two_rooms(4), box(5, 3, 8, 6), Inside(ROOM)
    plan = plan_carrying(shape, free, (3.5, 18.5), goal)
    framed = np.pad(free, ((dy, 3), (dx, 3)))
    there = plan_carrying(affinity.translate(shape, dx, dy), framed, (3.5 + dx, 18.5 + dy), moved(goal, dx, dy))
    assert there.commands == plan.commands
    back = there.shifted(-dx, -dy)
    assert shapely.hausdorff_distance(replay(back, shape, free, (3.5, 18.5)), back.polygon) < 1e-6
    assert ROOM.buffer(1e-6).covers(back.polygon)


@pytest.mark.parametrize("goal", [InCorner(50, 22, 1, 1, 0.5, (3.0, 4.0)), At(Pose(3, -2, 90)), Roomy(), Roomy((3, 4))])
def test_a_goal_moved_there_and_back_is_the_same(goal: InCorner | At | Roomy) -> None:
    shape = box(0, 0, 3, 4)
    away = moved(goal, 7, -3)
    assert moved(away, -7, 3) == goal
    ends = [box(47, 18, 50, 22), affinity.translate(affinity.rotate(shape, 90), 3, -2), box(0, 0, 3, 4)]
    for end in ends:
        there = affinity.translate(end, 7, -3)
        assert is_goal_met(goal, shape, end) == is_goal_met(away, affinity.translate(shape, 7, -3), there)


@pytest.mark.parametrize("degrees", [10, 25, 45, 70])
def test_a_body_is_brought_between_walls_at_any_angle(degrees: float) -> None:
    """As squares the walls are stairs; the body ends near both lines, behind which the true walls are."""
    room = affinity.translate(affinity.rotate(box(0, 0, 18, 14), degrees, origin=(9, 7)), 4, 6)
    columns, rows = np.meshgrid(np.arange(28), np.arange(28))
    free = shapely.covers(room, shapely.box(columns, rows, columns + 1, rows + 1))
    turn = math.radians(degrees)
    walls = (-math.cos(turn), -math.sin(turn)), (math.sin(turn), -math.cos(turn))
    (x, y), *_ = sorted(room.exterior.coords, key=lambda p: -sum(n[0] * p[0] + n[1] * p[1] for n in walls))
    square, utak = box(12, 12, 14, 14), (11.5, 12.5)
    goal = Between(x, y, walls, slack=2.0)
    plan = plan_carrying(square, free, utak, goal)
    assert plan.status == "found"
    assert max(goal.gaps(replay(plan, square, free, utak))) <= 2.0 + 1e-6


def test_a_question_asked_again_from_elsewhere_is_answered_as_if_it_were_the_first() -> None:
    """What is remembered of the same squares does not depend on where the robot stands, or on what else was asked."""
    free, shape = two_rooms(5), affinity.translate(ELL, 8, 8)
    narrow = two_rooms(1)
    goals = [Inside([ROOM]), At(Pose(25.0, 2.0, 90.0))]
    first = [plan_carrying(shape, free, (3.5, 18.5), goal) for goal in goals]
    for utak in ((20.5, 3.5), (3.5, 18.5)):
        for goal in goals:
            plan_carrying(shape, narrow, utak, goal, held=False)
            assert plan_carrying(shape, narrow, utak, goal, on_lattice=True).status == "limit"
            assert plan_carrying(shape, narrow, utak, goal).status == "impossible"
            replay(plan_carrying(shape, free, utak, goal), shape, free, utak)
    assert [plan_carrying(shape, free, (3.5, 18.5), goal) for goal in goals] == first
