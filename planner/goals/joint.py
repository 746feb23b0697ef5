"""Goals that cannot hold at once, by the regions in which an object lies when each of them holds."""

import math
from collections.abc import Sequence
from itertools import combinations, product
from typing import Any

import shapely

from utak.geometry.manipulation.goals import At, Between, End, InCorner, Inside, Roomy, shape_at_pose
from utak.kb.language.terms import Fact
from utak.planner.goals.placement import Placement
from utak.planner.goals.robot_goals import corner_side
from utak.planner.situation import Situation

REGION_ROUNDING = 1e-6  # squares, or squares of area, that rounding errors of shapely may make (convention)
CORNER_REACH = (1.0, 1.0)  # squares east and north of a corner within which the robot is at it (meaning of the goal)
OPPOSITE_CORNERS = (("northeast", "southwest"), ("northwest", "southeast"))


def conflicting_goals(placements: Sequence[Placement], shape: Any) -> tuple[int, int] | None:
    """Find two of some goals that cannot hold at once for one object."""
    # None when each two of them may hold at once.
    for (one, a), (other, b) in combinations(enumerate(placements), 2):
        if all(placement.ends and not placement.missing for placement in (a, b)):
            pairs = product(*([*placement.ends.values(), *placement.loose.values()] for placement in (a, b)))
            if not any(_may_share(first, second, shape) for first, second in pairs):
                return one, other
    return None


def opposite_corners_reason(goals: Sequence[Fact], situation: Situation, length: float = 0.0) -> str:
    """Return in words why nothing can be at two opposite corners at once; "" when the goals do not ask for that."""
    wanted = set(map(corner_side, goals))
    for one, other in OPPOSITE_CORNERS:
        if {one, other} <= wanted:
            points = (situation.corners[side].point for side in (one, other))
            (x, y), (u, v) = (situation.model.place_to_utak(*point) for point in points)
            along = abs(x - u + y - v) if one == "northeast" else abs(x - u - y + v)
            if along > 2 * sum(CORNER_REACH) + math.sqrt(2) * length:
                return f"the {one} and the {other} corner are too far apart to be at both at once"
    return ""


def _may_share(one: End, other: End, shape: Any) -> bool:
    """Return whether the regions of two ends have enough area in common for a shape: a necessary condition only."""
    room = enclosing_region(one, shape).intersection(enclosing_region(other, shape))
    return bool(room.area >= shape.area - REGION_ROUNDING)


def enclosing_region(end: End, shape: Any) -> Any:
    """Compute a region that holds a shape wholly wherever it meets an end, at any orientation."""
    # Raises ValueError for a Roomy end, which no goal of a task has.
    if isinstance(end, Inside):
        return end.polygon.buffer(REGION_ROUNDING)
    if isinstance(end, At):
        return shape_at_pose(shape, end.pose).buffer(REGION_ROUNDING)
    if isinstance(end, Roomy):
        raise ValueError("a place on the way is no goal of a task")
    longest = 2 * shapely.minimum_bounding_radius(shape)
    if isinstance(end, Between):
        return end.about(longest + end.slack)
    return _corner_region(end, longest)


def _corner_region(end: InCorner, longest: float) -> Any:
    """Return the box (shapely Polygon) in a corner that holds any shape that meets the end."""
    reach = end.slack + end.press + longest + REGION_ROUNDING
    far_x, far_y = end.x - math.copysign(reach, end.sx), end.y - math.copysign(reach, end.sy)
    near_x, near_y = end.x + math.copysign(REGION_ROUNDING, end.sx), end.y + math.copysign(REGION_ROUNDING, end.sy)
    return shapely.box(min(far_x, near_x), min(far_y, near_y), max(far_x, near_x), max(far_y, near_y))
