"""The motion of the body alone, as if it moved by itself: what it cannot do, the robot cannot do with it."""

from functools import partial
from typing import Any

import numpy as np
import shapely

from utak.geometry.cspace.plan_motion import MotionPlan, plan_motion
from utak.geometry.manipulation.goals import At, Between, InCorner, Inside, goal_key
from utak.geometry.manipulation.query import ManipulationQuery
from utak.geometry.motion.se2 import Pose

MAX_FREE_BODY_CELLS = 60_000  # cells of configuration space examined at most; a bound on time, no measurement on record


def plan_body_alone(query: ManipulationQuery) -> MotionPlan:
    """Return the motion plan of the body without the robot; "impossible" for it is a proof for the robot, too."""
    return query.workspace.once(("alone", query.shape.wkb, goal_key(query.goal)), partial(_plan_alone, query))


def _plan_alone(query: ManipulationQuery) -> MotionPlan:
    """Return the motion plan of the body without the robot. `query` : as for `plan_body_alone`."""
    middle = query.shape.centroid
    centred = shapely.transform(query.shape, lambda p: p - np.array([middle.x, middle.y]))
    goal = query.goal
    if isinstance(goal, At):
        there: Pose | Inside = Pose(middle.x + goal.pose.x, middle.y + goal.pose.y, goal.pose.degrees)
    elif isinstance(goal, InCorner):
        there = Inside(_corner_region(goal, query))
    elif isinstance(goal, Between):
        there = Inside(_region_between_walls(goal, query))
    elif isinstance(goal, Inside):
        there = goal
    else:
        return MotionPlan("limit")
    return plan_motion(centred, query.workspace.floor, Pose(middle.x, middle.y, 0.0), there, cells=MAX_FREE_BODY_CELLS)


def _corner_region(goal: InCorner, query: ManipulationQuery) -> Any:
    """Return the floor near a corner in which a body must lie to be in the corner: shapely MultiPolygon."""
    reach = 2.0 * shapely.minimum_bounding_radius(query.shape) + goal.slack

    def corner_box(across: float, up: float) -> Any:
        """Return the box from the corner `across` squares along x and `up` squares along y into the floor."""
        x0, x1 = sorted([goal.x, goal.x - goal.sx * across])
        y0, y1 = sorted([goal.y, goal.y - goal.sy * up])
        return shapely.box(x0, y0, x1, y1)

    ends = [corner_box(goal.slack, reach), corner_box(reach, goal.slack)]
    parts = shapely.get_parts(query.workspace.floor_polygon.intersection(corner_box(reach, reach)))
    fitting = [part for part in parts if part.area > 0.0 and all(part.intersects(end) for end in ends)]
    return shapely.MultiPolygon(fitting)


def _region_between_walls(goal: Between, query: ManipulationQuery) -> Any:
    """Return the floor near two walls in which a body must lie to be within the slack of both."""
    reach = 2.0 * shapely.minimum_bounding_radius(query.shape) + goal.slack
    parts = shapely.get_parts(query.workspace.floor_polygon.intersection(goal.about(reach)))
    return shapely.MultiPolygon([p for p in parts if p.area > 0.0 and max(goal.gaps(p)) <= goal.slack])
