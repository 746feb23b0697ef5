"""Carrying at any place and angle with one hold all the way: body and Utak are one thing that is turned about him.

# Strategy: with one hold Utak can bring the body wherever body and he as one rigid thing can go, for turns about him
# and pushes make up all rigid motions. So it is one question to plan_motion whether a hold will do. Asked first are
# holds that would seldom bring Utak into a wall if the body went as it goes by itself, and of these the ones that have
# all its corners near: a turn about them moves it least. Each is asked with an arm's length of room about Utak and a
# margin about the body, then without.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely

from geometry.digital import squares
from geometry.ends import At, InCorner, Inside, placed
from geometry.errand import Errand
from geometry.fewest import evenly, fewest_motions
from geometry.legs import Leg, Point, grip_square, may_push, rounded, verified
from geometry.motion import plan_motion
from geometry.mover import centre_pose, new_mover
from geometry.reach import reach
from geometry.rigid import Motion, Pose, Translate
from geometry.stencil import DIRECTIONS, Floats
from geometry.yard import ARM, padded

HOLDS = 6  # asked at most
SHORT = 9  # motions that are few enough
ENOUGH = 3  # holds that will do, of which the best is taken
SAMPLES = 60  # of a track
CELLS = 20_000  # looked at for each of them
AWAY = 0.1  # squares: how far from the walls of a corner a body is put
FIFTHS = 5  # of a square: the unit of geometry.reach


@dataclass(frozen=True)
class Hold:
    """A place where Utak can take the body where it lies: (x, y), the middle of a square, and the squares to walk."""

    place: Point
    walk: int


def holds_about(errand: Errand, shape: Any, utak: Point) -> list[Hold]:
    """The holds that he can walk to while the shape lies so, the most promising first."""
    rows, columns = errand.walk.shape
    lying = squares(shape, columns, rows)
    walk = errand.walk & ~lying
    at = (min(max(math.floor(utak[0]), 0), columns - 1), min(max(math.floor(utak[1]), 0), rows - 1))
    walk[at[1], at[0]] = True
    ways = reach(walk, *at)
    beside = np.zeros_like(lying)
    framed = np.pad(lying, 1)
    for dx, dy in DIRECTIONS:
        beside |= framed[1 + dy : 1 + dy + rows, 1 + dx : 1 + dx + columns]
    found = np.argwhere(beside & ~lying & errand.yard.free & (ways >= 0))
    holds = [Hold((column + 0.5, row + 0.5), int(ways[row, column]) // FIFTHS) for row, column in found.tolist()]
    return sorted(holds, key=lambda hold: (hold.walk, hold.place))


def carry_held(errand: Errand, track: Floats, most: int = HOLDS) -> list[Leg] | None:
    """One leg that leads to the goal, the first that is short enough or the best of some; None when none is found.

    track : (n, 3) a way of the body by itself, places and angles of some point of it, or nothing.
    """
    middle, best = errand.shape.centroid, None
    fit = [h for h in holds_about(errand, errand.shape, errand.utak) if not _avoided(errand, h, middle)]
    found = 0
    for hold in sorted(fit, key=lambda hold: _promise(errand, hold, track))[:most]:
        leg = _best_leg(errand, hold)
        found += leg is not None
        if leg is not None and (best is None or len(leg.motions) < len(best.motions)):
            best = leg
        if best is not None and (len(best.motions) <= SHORT or found == ENOUGH):
            break
    return None if best is None else [best]


def _promise(errand: Errand, hold: Hold, track: Floats) -> tuple[int, float, int, Point]:
    """How often the track would bring Utak into a wall; how far the furthest corner is; how far he has to walk."""
    inside = 0
    if len(track):
        way = evenly(track, 1.0, SAMPLES)
        away = np.array(hold.place) - way[0, :2]
        turn = way[:, 2] - way[0, 2]
        x = way[:, 0] + np.cos(turn) * away[0] - np.sin(turn) * away[1]
        y = way[:, 1] + np.sin(turn) * away[0] + np.cos(turn) * away[1]
        inside = int(shapely.contains_xy(shapely.union_all(errand.yard.walls), x, y).sum())
    far = round(float(shapely.hausdorff_distance(errand.shape, shapely.Point(hold.place))), 6)
    return inside, far, hold.walk, hold.place


def _best_leg(errand: Errand, hold: Hold) -> Leg | None:
    """A leg with one hold, with room about body and Utak where there is some."""
    for roomy in (True, False):
        for goal in ends_of(errand):
            leg = _leg(errand, hold, goal, roomy)
            if leg is not None and verified(errand.yard, errand.shape, [leg]) is not None:
                return leg
    return None


def _avoided(errand: Errand, hold: Hold, middle: Any) -> bool:
    """Whether a hold was refuted."""
    return errand.avoids(hold.place[0] - middle.x, hold.place[1] - middle.y)


def ends_of(errand: Errand) -> list[Pose | Inside]:
    """The goal as poses of the body's centroid or regions. In a corner: near the walls, straight to the axes."""
    goal, middle = errand.goal, errand.shape.centroid
    if isinstance(goal, Inside):
        return [goal]
    if isinstance(goal, At):
        return [Pose(middle.x + goal.pose.x, middle.y + goal.pose.y, goal.pose.degrees)]
    return [_cornered(goal, errand.shape, degrees) for degrees in (0.0, 90.0, -90.0, 180.0)]


def _cornered(goal: InCorner, shape: Any, degrees: float) -> Pose:
    """The pose of the centroid in which a shape, so turned, lies near both walls of a corner."""
    x0, y0, x1, y1 = placed(shape, Pose(0.0, 0.0, degrees)).bounds
    away = min(AWAY, goal.slack / 2)
    dx = goal.x - goal.sx * away - (x1 if goal.sx > 0 else x0)
    dy = goal.y - goal.sy * away - (y1 if goal.sy > 0 else y0)
    return Pose(shape.centroid.x + dx, shape.centroid.y + dy, degrees)


def _leg(errand: Errand, hold: Hold, goal: Pose | Inside, roomy: bool) -> Leg | None:
    """The leg with one hold, with room about body and Utak or without; None when plan_motion finds none."""
    square = grip_square(errand.shape, hold.place)
    motions = held_motions(errand, errand.shape, hold.place, goal, roomy) if square else None
    if motions is None or square is None:
        return None
    if not errand.pull and not _only_pushes(errand.shape, hold.place, motions):
        return None
    middle = errand.shape.centroid
    relative = (hold.place[0] - middle.x, hold.place[1] - middle.y)
    return Leg(hold.place, square, motions, relative, hold.walk)


def held_motions(
    errand: Errand, shape: Any, place: Point, goal: Pose | Inside, roomy: bool
) -> tuple[Motion, ...] | None:
    """The motions that bring a shape to a goal with a hold; None when plan_motion does not find them."""
    middle = np.array([shape.centroid.x, shape.centroid.y])
    utak = (place[0] - middle[0], place[1] - middle[1])
    body = shapely.transform(padded(shape, errand.margin if roomy else 0.0), lambda p: p - middle)
    if roomy:
        body = shapely.union_all([body, shapely.Point(utak).buffer(ARM, quad_segs=2)])
    start = Pose(float(middle[0]), float(middle[1]), 0.0)
    floor = errand.yard.floor
    plan = plan_motion(body, floor, start, goal, points=[utak], cells=CELLS, pivot=utak)
    if plan.status != "found":
        return None
    mover = new_mover(body, [utak], utak)
    way = np.array([centre_pose(mover, pose) for pose in plan.poses])
    few = fewest_motions(mover, floor.ground(mover), floor.surface, way, slant(shape))
    motions = few if few and len(few) < len(plan.motions) else plan.motions
    return at_utak(place, [rounded(motion) for motion in motions])


def slant(shape: Any) -> float:
    """The direction of a shape's longest edge, in radians."""
    corners = shapely.get_coordinates(shape.exterior)
    along = np.diff(corners, axis=0)
    x, y = along[int(np.argmax(np.round(np.hypot(along[:, 0], along[:, 1]), 6)))]
    return math.atan2(y, x)


def at_utak(place: Point, motions: Sequence[Motion]) -> tuple[Motion, ...]:
    """The motions with turns about where Utak is at that time, free of rounding."""
    told: list[Motion] = []
    for motion in motions:
        if isinstance(motion, Translate):
            place = (place[0] + motion.dx, place[1] + motion.dy)
            told.append(motion)
        else:
            told.append(motion._replace(about=place))
    return tuple(told)


def _only_pushes(shape: Any, place: Point, motions: Sequence[Motion]) -> bool:
    """Whether no push goes backwards."""
    for motion in motions:
        if isinstance(motion, Translate):
            if not may_push(shape, place, motion.dx, motion.dy):
                return False
            place = (place[0] + motion.dx, place[1] + motion.dy)
        shape = motion.carry(shape)
    return True
