"""Carrying at any place and angle with one grasp: body and robot are one rigid thing that turns about the robot.

# Strategy: with one grasp the robot can bring the body wherever both as one rigid thing can go, because turns about the
robot and pushes make up all rigid motions. So it is one query to plan_motion whether a grasp will do. Asked first are
grasps that would seldom bring the robot into a wall if the body moved as it does alone, and of these the ones that have
all its corners near: a turn about them moves it least. Each is asked with clearance about the robot and a margin about
the body, then without.
"""

import math
from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np
import shapely

from utak.geometry.cspace.fewest_motions import fewest_motions, longest_edge_angle, longest_edge_tilt
from utak.geometry.cspace.local_planner import new_hop_context
from utak.geometry.cspace.plan_motion import plan_motion
from utak.geometry.kernels.arrays import XY, Floats
from utak.geometry.manipulation.align import plan_aligned
from utak.geometry.manipulation.free_body import plan_body_alone
from utak.geometry.manipulation.goals import At, Between, InCorner, Inside, Roomy, shape_at_pose
from utak.geometry.manipulation.grasps import GraspCandidate, grasp_candidates, grasp_rank
from utak.geometry.manipulation.lattice_planner import plan_on_lattice
from utak.geometry.manipulation.legs import (
    Leg,
    direction_to_grasp,
    only_pushes,
    round_motion,
    verified,
    with_pivots_at_robot,
)
from utak.geometry.manipulation.query import ManipulationQuery, join_legs, query_after
from utak.geometry.manipulation.workspace import ROBOT_CLEARANCE, padded_shape
from utak.geometry.motion.body import centre_pose, new_moving_body
from utak.geometry.motion.se2 import Motion, Pose

# Bounds on time; no measurement on record.
MAX_GRASPS = 6  # grasps that are asked
FEW_MOTIONS = 9  # a leg with at most so many motions ends the search
SUFFICIENT_LEGS = 3  # so many legs end the search; the best of them is taken
MAX_CELLS_PER_GRASP = 12_000  # cells of configuration space
MIN_CELLS_PER_GRASP = 1_000
MAX_GRASP_CELLS = 40_000  # for all grasps together
MAX_FLUSH_TURNS = 5  # rotations that lay a body along a wall

CORNER_GAP = 0.1  # squares; convention: the gap at which a body is put before the walls of a corner


def plan_with_one_grasp(query: ManipulationQuery, track: Floats) -> list[Leg] | None:
    """Return one leg that leads to the goal, the first that is short enough or the best of some."""
    candidates = sorted(grasp_candidates(query), key=lambda candidate: grasp_rank(query, candidate, track))[:MAX_GRASPS]
    left, legs = MAX_GRASP_CELLS, list[Leg]()
    for candidate in candidates:
        for goal, with_margin in product(goal_poses(query), (True, False)):
            leg, cells = _leg(
                query, candidate, goal, with_margin, max(min(left, MAX_CELLS_PER_GRASP), MIN_CELLS_PER_GRASP)
            )
            left -= cells
            if leg is not None and verified(query.workspace, query.shape, [leg]) is not None:
                legs.append(leg)
                break
        if left <= 0 or len(legs) == SUFFICIENT_LEGS or any(len(leg.motions) <= FEW_MOTIONS for leg in legs):
            break
    return [min(legs, key=lambda leg: leg.commands)] if legs else None


def plan_by_freeing(query: ManipulationQuery) -> list[Leg] | None:
    """Return legs by whole squares to a place with room about it near the goal pose, then one leg to the goal."""
    near = None
    if isinstance(query.goal, At):
        there = shape_at_pose(query.shape, query.goal.pose).centroid
        near = (there.x, there.y)
    on_the_way = replace(query, goal=Roomy(near))
    first = plan_on_lattice(on_the_way) or plan_aligned(on_the_way)
    if not first or not first[-1].motions or verified(query.workspace, query.shape, first) is None:
        return None
    freed = query_after(query, first, held=True)
    alone = plan_body_alone(freed)
    rest = plan_with_one_grasp(freed, alone.track) if alone.status == "found" else None
    return None if rest is None else join_legs(first, rest)


def goal_poses(query: ManipulationQuery) -> list[Pose | Inside]:
    """Return the goal as poses of the body's centroid, or as regions, in the order in which to try them."""
    goal, middle = query.goal, query.shape.centroid
    if isinstance(goal, Inside):
        return [goal]
    if isinstance(goal, At):
        return [Pose(middle.x + goal.pose.x, middle.y + goal.pose.y, goal.pose.degrees)]
    if isinstance(goal, Roomy):
        return []
    if isinstance(goal, Between):
        return [_pose_between_walls(goal, query.shape, degrees) for degrees in _flush_rotations(goal, query.shape)]
    tilt = longest_edge_tilt(query.shape) if math.isfinite(goal.within[0]) else 0.0
    return [_pose_in_corner(goal, query.shape, degrees - tilt) for degrees in (0.0, 90.0, -90.0, 180.0)]


def _pose_in_corner(goal: InCorner, shape: Any, degrees: float) -> Pose:
    """Return the pose of the centroid in which a shape, turned by `degrees`, lies near both walls of a corner."""
    x0, y0, x1, y1 = shape_at_pose(shape, Pose(0.0, 0.0, degrees)).bounds
    away = min(CORNER_GAP, goal.slack / 2)
    dx = goal.x - goal.sx * away - (x1 if goal.sx > 0 else x0)
    dy = goal.y - goal.sy * away - (y1 if goal.sy > 0 else y0)
    return Pose(shape.centroid.x + dx, shape.centroid.y + dy, degrees)


def _flush_rotations(goal: Between, shape: Any) -> list[float]:
    """Return the rotations that lay one of a shape's sides along a wall, in degrees, least first; before them 0."""
    ring = np.array(shapely.convex_hull(shape).exterior.coords)
    sides = np.degrees(np.arctan2(*np.diff(ring, axis=0).T[::-1]))
    turns = {
        round((float(np.degrees(np.arctan2(x, -y)) - side) + 180.0 * n) % 360.0 - 180.0, 6)
        for x, y in goal.walls
        for side in sides
        for n in (0, 1)
    }
    return [0.0, *sorted(turns, key=lambda turn: (abs(turn), turn))[:MAX_FLUSH_TURNS]]


def _pose_between_walls(goal: Between, shape: Any, degrees: float) -> Pose:
    """Return the pose of the centroid in which a shape, turned by `degrees`, lies near two walls."""
    one, two = goal.gaps(shape_at_pose(shape, Pose(0.0, 0.0, degrees)))
    away = max(goal.slack - CORNER_GAP, goal.slack / 2)  # walls at an angle appear as stairs that stand out
    dx, dy = goal.move((one - away, two - away))
    return Pose(shape.centroid.x + dx, shape.centroid.y + dy, degrees)


def _leg(
    query: ManipulationQuery, candidate: GraspCandidate, goal: Pose | Inside, with_margin: bool, cells: int
) -> tuple[Leg | None, int]:
    """Return the leg with one grasp, or None, and how many cells the search took."""
    # None when the robot reaches nothing there, no motions are found, or a pull is needed and forbidden.
    square = direction_to_grasp(query.shape, candidate.place)
    if square is None and not candidate.taken:
        return None, 0
    motions, looked = _motions(query, candidate.place, goal, with_margin, cells)
    if not motions or not (query.pull or only_pushes(query.shape, candidate.place, motions)):
        return None, looked
    return Leg(
        candidate.place, square or (0, 0), motions, query.grasp_offset(candidate.place), candidate.walk, candidate.taken
    ), looked


def _motions(
    query: ManipulationQuery, place: XY, goal: Pose | Inside, with_margin: bool, cells: int
) -> tuple[tuple[Motion, ...], int]:
    """Return the motions that bring the shape to a goal with a grasp at `place`, and how many cells the search took."""
    middle = np.array([query.shape.centroid.x, query.shape.centroid.y])
    utak = (place[0] - middle[0], place[1] - middle[1])
    body = shapely.transform(padded_shape(query.shape, query.margin if with_margin else 0.0), lambda p: p - middle)
    if with_margin:
        body = shapely.union_all([body, shapely.Point(utak).buffer(ROBOT_CLEARANCE, quad_segs=2)])
    floor, start = query.workspace.floor, Pose(float(middle[0]), float(middle[1]), 0.0)
    plan = plan_motion(body, floor, start, goal, points=[utak], cells=cells, pivot=utak)
    if plan.status != "found":
        return (), plan.cells
    mover = new_moving_body(body, [utak], utak)
    way = np.array([centre_pose(mover, pose) for pose in plan.poses])
    scene = new_hop_context(mover, floor.ground(mover), floor.surface)
    fewest = fewest_motions(scene, way, longest_edge_angle(query.shape))
    motions = fewest if fewest and len(fewest) < len(plan.motions) else plan.motions
    return with_pivots_at_robot(place, [round_motion(motion) for motion in motions]), plan.cells
