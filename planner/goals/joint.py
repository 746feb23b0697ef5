"""Whether several goals can hold for one thing at once, by the regions in which it must lie for each of them."""

import math
from collections.abc import Sequence
from itertools import combinations, product
from typing import Any

import shapely

from geometry.manipulation.goals import At, Between, End, InCorner, Inside, Roomy, placed
from kb.language.terms import Fact
from planner.goals.placement import Placement
from planner.goals.robot_goals import corner_side
from planner.situation import Situation

ROUNDING = 1e-6  # squares
AT_CORNER = (1.0, 1.0)  # squares from a corner, east and north, within which Utak is at it
OPPOSITE = (("northeast", "southwest"), ("northwest", "southeast"))


def conflict(lands: Sequence[Placement], shape: Any) -> tuple[int, int] | None:
    """Return which two of some goals cannot hold at once for a shape, as indices; None when each two may.

    lands : where each goal holds; one of which it is not known yet may hold anywhere. shape : in the frame of the
    view's arrays.
    """
    for (one, a), (other, b) in combinations(enumerate(lands), 2):
        if all(land.ends and not land.missing for land in (a, b)):
            pairs = product(*(_places(land) for land in (a, b)))
            if not any(_may_share(first, second, shape) for first, second in pairs):
                return one, other
    return None


def opposite_corners(goals: Sequence[Fact], situation: Situation) -> str:
    """Return why Utak cannot be in two opposite corners at once, in words; "" when the task does not ask for that.

    However much more floor becomes known, such corners only move further apart.
    """
    wanted = set(map(corner_side, goals))
    for one, other in OPPOSITE:
        if {one, other} <= wanted:
            points = (situation.corners[side].point for side in (one, other))
            (x, y), (u, v) = (situation.model.place_to_utak(*point) for point in points)
            along = abs(x - u + y - v) if one == "northeast" else abs(x - u - y + v)
            if along > 2 * sum(AT_CORNER):
                return f"the {one} and the {other} corner are too far apart to be at both at once"
    return ""


def _places(land: Placement) -> list[End]:
    return [*land.ends.values(), *land.loose.values()]


def _may_share(one: End, other: End, shape: Any) -> bool:
    """Return whether there is room for a shape where two goals hold: a necessary condition alone."""
    room = confines(one, shape).intersection(confines(other, shape))
    return bool(room.area >= shape.area - ROUNDING)


def confines(end: End, shape: Any) -> Any:
    """Return a region in which a shape lies wholly wherever it meets a goal, however it is turned."""
    if isinstance(end, Inside):
        return end.polygon.buffer(ROUNDING)
    if isinstance(end, At):
        return placed(shape, end.pose).buffer(ROUNDING)
    if isinstance(end, Roomy):
        raise ValueError("a place on the way is no goal of a task")
    longest = 2 * shapely.minimum_bounding_radius(shape)
    if isinstance(end, Between):
        return end.about(longest + end.slack)
    return _in_corner(end, longest)


def _in_corner(end: InCorner, longest: float) -> Any:
    """Return the region of a corner for a shape that is at most so long, in squares."""
    reach = end.slack + end.press + longest + ROUNDING
    far_x, far_y = end.x - math.copysign(reach, end.sx), end.y - math.copysign(reach, end.sy)
    near_x, near_y = end.x + math.copysign(ROUNDING, end.sx), end.y + math.copysign(ROUNDING, end.sy)
    return shapely.box(min(far_x, near_x), min(far_y, near_y), max(far_x, near_x), max(far_y, near_y))
