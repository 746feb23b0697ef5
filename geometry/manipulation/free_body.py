"""The body by itself, as if it moved of its own accord: what it cannot do, Utak cannot do with it."""

from typing import Any

import numpy as np
import shapely

from geometry.cspace.plan_motion import MotionPlan, plan_motion
from geometry.manipulation.goals import At, Between, InCorner, Inside
from geometry.manipulation.query import ManipulationQuery
from geometry.motion.se2 import Pose

CELLS = 60_000  # looked at at most


def move_alone(errand: ManipulationQuery) -> MotionPlan:
    """MotionPlan the body's way without Utak. What is impossible for it by itself is impossible."""
    middle = errand.shape.centroid
    centred = shapely.transform(errand.shape, lambda p: p - np.array([middle.x, middle.y]))
    goal = errand.goal
    if isinstance(goal, At):
        there: Pose | Inside = Pose(middle.x + goal.pose.x, middle.y + goal.pose.y, goal.pose.degrees)
    elif isinstance(goal, InCorner):
        there = Inside(_about(goal, errand))
    elif isinstance(goal, Between):
        there = Inside(_near_both(goal, errand))
    elif isinstance(goal, Inside):
        there = goal
    else:
        return MotionPlan("limit")
    return plan_motion(centred, errand.yard.floor, Pose(middle.x, middle.y, 0.0), there, cells=CELLS)


def _about(goal: InCorner, errand: ManipulationQuery) -> Any:
    """The floor near a corner in which a body must lie to be in it: what cannot be brought there cannot be in it."""
    reach = 2.0 * shapely.minimum_bounding_radius(errand.shape) + goal.slack

    def back(across: float, up: float) -> Any:
        x0, x1 = sorted([goal.x, goal.x - goal.sx * across])
        y0, y1 = sorted([goal.y, goal.y - goal.sy * up])
        return shapely.box(x0, y0, x1, y1)

    ends = [back(goal.slack, reach), back(reach, goal.slack)]
    parts = shapely.get_parts(errand.yard.floor_polygon.intersection(back(reach, reach)))
    fitting = [part for part in parts if part.area > 0.0 and all(part.intersects(end) for end in ends)]
    return shapely.MultiPolygon(fitting)


def _near_both(goal: Between, errand: ManipulationQuery) -> Any:
    """The floor near two walls in which a body must lie to be within so many squares of both."""
    reach = 2.0 * shapely.minimum_bounding_radius(errand.shape) + goal.slack
    parts = shapely.get_parts(errand.yard.floor_polygon.intersection(goal.about(reach)))
    return shapely.MultiPolygon([p for p in parts if p.area > 0.0 and max(goal.gaps(p)) <= goal.slack])
