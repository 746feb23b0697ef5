"""Carrying at any place and angle with one hold all the way: body and Utak are one thing that is turned about him.

# Strategy: with one hold Utak can bring the body wherever body and he as one rigid thing can go, for turns about him
# and pushes make up all rigid motions. So it is one question to plan_motion whether a hold will do. Asked first are
# holds that would seldom bring Utak into a wall if the body went as it goes by itself, and of these the ones that have
# all its corners near: a turn about them moves it least. Each is asked with an arm's length of room about Utak and a
# margin about the body, then without.
"""

import math
from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np
import shapely

from geometry.cspace.fewest_motions import askew, fewest_motions, slant
from geometry.cspace.local_planner import new_scene
from geometry.cspace.plan_motion import plan_motion
from geometry.kernels.arrays import XY, Floats
from geometry.manipulation.align import carry_straightened
from geometry.manipulation.free_body import move_alone
from geometry.manipulation.goals import At, Between, InCorner, Inside, Roomy, placed
from geometry.manipulation.grasps import Grasp, holds_about, promise
from geometry.manipulation.lattice_planner import carry_squarewise
from geometry.manipulation.legs import Leg, at_utak, grip_square, only_pushes, rounded, verified
from geometry.manipulation.query import ManipulationQuery, after, joined
from geometry.manipulation.workspace import ARM, padded
from geometry.motion.body import centre_pose, new_mover
from geometry.motion.se2 import Motion, Pose

HOLDS = 6  # asked at most
SHORT = 9  # motions that are few enough
ENOUGH = 3  # holds that will do, of which the best is taken
EACH, LEAST, CELLS = 12_000, 1_000, 40_000  # cells looked at for each of them at most and at least, and for all
MOST_TURNS = 5  # that lay a body along a wall are tried
AWAY = 0.1  # squares: how far from the walls of a corner a body is put


def carry_held(errand: ManipulationQuery, track: Floats) -> list[Leg] | None:
    """One leg that leads to the goal, the first that is short enough or the best of some; None when none is found.

    track : (n, 3) a way of the body by itself, places and angles of some point of it, or nothing.
    """
    holds = sorted(holds_about(errand), key=lambda hold: promise(errand, hold, track))[:HOLDS]
    left, legs = CELLS, list[Leg]()
    for hold in holds:
        for goal, roomy in product(ends_of(errand), (True, False)):
            leg, cells = _leg(errand, hold, goal, roomy, max(min(left, EACH), LEAST))
            left -= cells
            if leg is not None and verified(errand.yard, errand.shape, [leg]) is not None:
                legs.append(leg)
                break
        if left <= 0 or len(legs) == ENOUGH or any(len(leg.motions) <= SHORT for leg in legs):
            break
    return [min(legs, key=lambda leg: leg.commands)] if legs else None


def carry_freed(errand: ManipulationQuery) -> list[Leg] | None:
    """Legs by whole squares to where there is room all round, near the pose to be reached, and then one leg there."""
    near = None
    if isinstance(errand.goal, At):
        there = placed(errand.shape, errand.goal.pose).centroid
        near = (there.x, there.y)
    on_the_way = replace(errand, goal=Roomy(near))
    first = carry_squarewise(on_the_way) or carry_straightened(on_the_way)
    if not first or not first[-1].motions or verified(errand.yard, errand.shape, first) is None:
        return None
    freed = after(errand, first, held=True)
    rest = carry_held(freed, move_alone(freed).track)
    return None if rest is None else joined(first, rest)


def ends_of(errand: ManipulationQuery) -> list[Pose | Inside]:
    """The goal as poses of the body's centroid or regions. In a corner: near the walls, turned by quarters.

    Where it must not reach far from them, straight to the axes, however it lies now.
    """
    goal, middle = errand.goal, errand.shape.centroid
    if isinstance(goal, Inside):
        return [goal]
    if isinstance(goal, At):
        return [Pose(middle.x + goal.pose.x, middle.y + goal.pose.y, goal.pose.degrees)]
    if isinstance(goal, Roomy):
        return []
    if isinstance(goal, Between):
        return [_along(goal, errand.shape, degrees) for degrees in _flush(goal, errand.shape)]
    over = askew(errand.shape) if math.isfinite(goal.within[0]) else 0.0
    return [_cornered(goal, errand.shape, degrees - over) for degrees in (0.0, 90.0, -90.0, 180.0)]


def _cornered(goal: InCorner, shape: Any, degrees: float) -> Pose:
    """The pose of the centroid in which a shape, so turned, lies near both walls of a corner."""
    x0, y0, x1, y1 = placed(shape, Pose(0.0, 0.0, degrees)).bounds
    away = min(AWAY, goal.slack / 2)
    dx = goal.x - goal.sx * away - (x1 if goal.sx > 0 else x0)
    dy = goal.y - goal.sy * away - (y1 if goal.sy > 0 else y0)
    return Pose(shape.centroid.x + dx, shape.centroid.y + dy, degrees)


def _flush(goal: Between, shape: Any) -> list[float]:
    """By how much to turn a shape for one of its sides to lie along a wall, the least first; as it lies before that."""
    ring = np.array(shapely.convex_hull(shape).exterior.coords)
    sides = np.degrees(np.arctan2(*np.diff(ring, axis=0).T[::-1]))
    turns = {
        round((float(np.degrees(np.arctan2(x, -y)) - side) + 180.0 * n) % 360.0 - 180.0, 6)
        for x, y in goal.walls
        for side in sides
        for n in (0, 1)
    }
    return [0.0, *sorted(turns, key=lambda turn: (abs(turn), turn))[:MOST_TURNS]]


def _along(goal: Between, shape: Any, degrees: float) -> Pose:
    """The pose of the centroid in which a shape, so turned, lies near two walls."""
    one, two = goal.gaps(placed(shape, Pose(0.0, 0.0, degrees)))
    away = max(goal.slack - AWAY, goal.slack / 2)  # walls at an angle are seen as stairs, which reach before them
    dx, dy = goal.move((one - away, two - away))
    return Pose(shape.centroid.x + dx, shape.centroid.y + dy, degrees)


def _leg(
    errand: ManipulationQuery, hold: Grasp, goal: Pose | Inside, roomy: bool, cells: int
) -> tuple[Leg | None, int]:
    """The leg with one hold, with room about body and Utak or without, and how many cells that took."""
    square = grip_square(errand.shape, hold.place)
    if square is None and not hold.taken:
        return None, 0
    motions, looked = _motions(errand, hold.place, goal, roomy, cells)
    if not motions or not (errand.pull or only_pushes(errand.shape, hold.place, motions)):
        return None, looked
    return Leg(hold.place, square or (0, 0), motions, errand.hold_from(hold.place), hold.walk, hold.taken), looked


def _motions(
    errand: ManipulationQuery, place: XY, goal: Pose | Inside, roomy: bool, cells: int
) -> tuple[tuple[Motion, ...], int]:
    """The motions that bring the shape to a goal with a hold, () when none are found; how many cells were looked at."""
    middle = np.array([errand.shape.centroid.x, errand.shape.centroid.y])
    utak = (place[0] - middle[0], place[1] - middle[1])
    body = shapely.transform(padded(errand.shape, errand.margin if roomy else 0.0), lambda p: p - middle)
    if roomy:
        body = shapely.union_all([body, shapely.Point(utak).buffer(ARM, quad_segs=2)])
    floor, start = errand.yard.floor, Pose(float(middle[0]), float(middle[1]), 0.0)
    plan = plan_motion(body, floor, start, goal, points=[utak], cells=cells, pivot=utak)
    if plan.status != "found":
        return (), plan.cells
    mover = new_mover(body, [utak], utak)
    way = np.array([centre_pose(mover, pose) for pose in plan.poses])
    few = fewest_motions(new_scene(mover, floor.ground(mover), floor.surface), way, slant(errand.shape))
    motions = few if few and len(few) < len(plan.motions) else plan.motions
    return at_utak(place, [rounded(motion) for motion in motions]), plan.cells
