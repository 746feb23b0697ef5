"""A manipulation query: which body the robot shall bring where, and among what."""

import math
from collections.abc import Hashable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from utak.geometry.kernels.arrays import XY, Bools
from utak.geometry.manipulation.goals import At, End, goal_key, shape_at_pose
from utak.geometry.manipulation.legs import Leg
from utak.geometry.manipulation.workspace import Workspace
from utak.geometry.motion.se2 import Pose, Rotate, Translate, turned

GRASP_AVOID_DISTANCE = 0.25  # squares; convention: a grasp this near to one that failed is the same grasp


@dataclass(frozen=True)
class ManipulationQuery:
    """The arguments of plan_carrying, checked; all in squares, table frame."""

    shape: Any  # shapely Polygon, the body where it lies
    workspace: Workspace  # where the body and the robot may be
    utak: XY  # (x, y) of the robot
    goal: End  # where the shape shall end
    margin: float  # clearance that pushes and turns should keep
    pull: bool  # whether the robot may pull; otherwise every push leads towards the body
    # Offsets of grasps that must not be used (see `Leg.hold`): the robot's place relative to the body's centroid.
    avoid: tuple[XY, ...]
    walk: Bools  # (rows, columns) bool, row 0 in the south: squares where the robot may walk with empty hands
    held: bool = False  # whether the robot holds the shape already, by a grasp that need not be avoided
    turn: float = 1.0  # how many commands a turn counts for

    @property
    def square(self) -> tuple[int, int]:
        """Return (column, row) of the robot's square, the nearest one of the table when it is outside."""
        rows, columns = self.walk.shape
        column, row = math.floor(self.utak[0]), math.floor(self.utak[1])
        return min(max(column, 0), columns - 1), min(max(row, 0), rows - 1)

    @cached_property
    def middle(self) -> XY:
        """Return the centroid (x, y) of the shape as it lies now, in squares, table frame. Computed on first access."""
        return self.shape.centroid.x, self.shape.centroid.y

    @property
    def key(self) -> tuple[Hashable, ...]:
        """Return all that the query is about beside its workspace, to know it again."""
        rest = self.utak, self.margin, self.pull, self.avoid, self.walk.tobytes(), self.held, self.turn
        return self.shape.wkb, goal_key(self.goal), *rest

    def grasp_offset(self, place: XY) -> XY:
        """Return a place (x, y), table frame, relative to the centroid of the shape as it lies now, in squares."""
        return place[0] - self.middle[0], place[1] - self.middle[1]

    def is_avoided(self, x: float, y: float) -> bool:
        """Return whether a grasp must be avoided: one at most GRASP_AVOID_DISTANCE squares from one of `avoid`."""
        return any(math.dist((x, y), refuted) <= GRASP_AVOID_DISTANCE for refuted in self.avoid)


def query_after(query: ManipulationQuery, legs: Sequence[Leg], held: bool = False) -> ManipulationQuery:
    """Return the query that is left after some legs: shape and robot are elsewhere, the goal is the same."""
    shape, utak = query.shape, query.utak
    for leg in legs:
        utak = leg.place
        for motion in leg.motions:
            shape = motion.carry(shape)
            utak = (utak[0] + motion.dx, utak[1] + motion.dy) if isinstance(motion, Translate) else utak
    degrees = total_rotation(legs)
    avoid = tuple(_rotated_offset(offset, degrees) for offset in query.avoid)
    goal = _goal_after(query.goal, query.shape, shape, degrees)
    return replace(query, shape=shape, utak=utak, goal=goal, avoid=avoid, held=held)


def join_legs(first: Sequence[Leg], following: Sequence[Leg]) -> list[Leg]:
    """Return legs followed by the legs of the query after them, with grasp offsets in the frame of the first query."""
    degrees = total_rotation(first)
    rest = [replace(leg, hold=_rotated_offset(leg.hold, -degrees)) for leg in following]
    if first and rest and rest[0].taken:
        return [*first[:-1], replace(first[-1], motions=first[-1].motions + rest[0].motions), *rest[1:]]
    return [*first, *rest]


def total_rotation(legs: Sequence[Leg]) -> float:
    """Return the angle by which legs turn the shape, in degrees, counter-clockwise positive."""
    return sum(motion.degrees for leg in legs for motion in leg.motions if isinstance(motion, Rotate))


def _goal_after(goal: End, before: Any, now: Any, degrees: float) -> End:
    """Return the same goal for a shape that has been moved; only a goal pose changes, being relative to the shape."""
    if not isinstance(goal, At):
        return goal
    there, here = shape_at_pose(before, goal.pose).centroid, now.centroid
    return At(Pose(there.x - here.x, there.y - here.y, round(goal.pose.degrees - degrees, 7)))


def _rotated_offset(offset: XY, degrees: float) -> XY:
    """Return a grasp offset (x, y) in squares rotated by an angle in degrees, counter-clockwise positive."""
    x, y = turned(np.array([offset]), degrees)[0]
    return float(x), float(y)
