"""The local planner: one hop from pose to pose, a turn about the body's centre and a push in either order. For numba.

Hops are certified by exact first contact. Poses are x, y in squares, table frame, and an angle in radians.
"""

import math
from typing import NamedTuple

import numpy as np

from utak.geometry.kernels.arrays import Floats
from utak.geometry.kernels.jit import bare
from utak.geometry.motion.cell_clearance import MovingBody, NearbyEdges
from utak.geometry.motion.time_of_impact import Surface, first_push_skin_hit, first_turn_skin_hit

BLOCKED, TURN_FIRST, PUSH_FIRST = 0, 1, 2  # outcomes of hop
MIN_MOTION = 1e-12  # radians or squares: smaller motions count as none; bounds rounding


class HopContext(NamedTuple):
    """A body among its obstacles, as the local planner needs them."""

    body: MovingBody  # the body about its centre
    nearby: NearbyEdges  # obstacle edges by place, and the bounds of the reference point
    surface: Surface  # the boundary that the body must not cross, table frame
    placed: Floats  # (m, 7) scratch: the body's edges at a pose, table frame


def new_hop_context(body: MovingBody, nearby: NearbyEdges, surface: Surface) -> HopContext:
    """Return the body among its obstacles, as `hop` needs it. It has scratch memory of its own for the placed edges."""
    return HopContext(body, nearby, surface, np.empty_like(body.edges))


@bare
def copy_pose(target: Floats, pose: Floats) -> None:
    """Copy a `pose` (x, y, angle), (3,), into `target`, (3,), which is overwritten."""
    # An array assignment would take numba long to compile.
    for k in range(3):
        target[k] = pose[k]


@bare
def _write_placed_edges(body_edges: Floats, edges: Floats, x: float, y: float, angle: float) -> None:
    """Write the body's edges as they lie at a pose into `edges`; both are (m, 7)."""
    c, s = math.cos(angle), math.sin(angle)
    for i in range(len(edges)):
        for k in range(0, 6, 2):
            u, v = body_edges[i, k], body_edges[i, k + 1]
            edges[i, k], edges[i, k + 1] = c * u - s * v, s * u + c * v
        edges[i, 0] += x
        edges[i, 1] += y
        edges[i, 2] += x
        edges[i, 3] += y
        edges[i, 6] = body_edges[i, 6]


@bare
def push_is_free(context: HopContext, x: float, y: float, angle: float, dx: float, dy: float) -> bool:
    """Return whether the body can be pushed by (dx, dy) from a pose, free of obstacles and within bounds."""
    if not _reference_in_bounds(context.body.reference, context.nearby.bounds, x + dx, y + dy, angle):
        return False
    if abs(dx) + abs(dy) < MIN_MOTION:
        return True
    edges, surface = context.placed, context.surface
    _write_placed_edges(context.body.edges, edges, x, y, angle)
    return first_push_skin_hit(edges, edges, surface.hull, surface.skin, surface.chunks, dx, dy)[1] == 0


@bare
def turn_is_free(context: HopContext, x: float, y: float, angle: float, turn: float) -> bool:
    """Return whether the body can be turned about its centre by `turn` radians from a pose, free and within bounds."""
    if not _arc_in_bounds(context.body.reference, context.nearby.bounds, x, y, angle, turn):
        return False
    if abs(turn) < MIN_MOTION:
        return True
    edges, surface = context.placed, context.surface
    _write_placed_edges(context.body.edges, edges, x, y, angle)
    sign = 1.0 if turn > 0 else -1.0
    return first_turn_skin_hit(edges, edges, surface.hull, surface.skin, surface.chunks, x, y, sign, abs(turn))[1] == 0


@bare
def shorter_turn(turn: float) -> float:
    """Return the angle equal to `turn` radians, but for whole turns, that is from -pi to below pi."""
    return turn - 2 * math.pi * math.floor(turn / (2 * math.pi) + 0.5)


@bare
def hop(context: HopContext, here: Floats, there: Floats) -> int:
    """Return how the body can go from pose `here` to pose `there`: TURN_FIRST (1), PUSH_FIRST (2) or BLOCKED (0)."""
    dx, dy = there[0] - here[0], there[1] - here[1]
    turn = shorter_turn(there[2] - here[2])
    if turn_is_free(context, here[0], here[1], here[2], turn) and push_is_free(
        context, here[0], here[1], here[2] + turn, dx, dy
    ):
        return TURN_FIRST
    if abs(turn) < MIN_MOTION:
        return BLOCKED
    if push_is_free(context, here[0], here[1], here[2], dx, dy) and turn_is_free(
        context, there[0], there[1], here[2], turn
    ):
        return PUSH_FIRST
    return BLOCKED


@bare
def _reference_in_bounds(reference: Floats, bounds: Floats, x: float, y: float, angle: float) -> bool:
    """Return whether the reference point is within `bounds` (x0, y0, x1, y1) at a pose of the body's centre."""
    c, s = math.cos(angle), math.sin(angle)
    rx, ry = x + c * reference[0] - s * reference[1], y + s * reference[0] + c * reference[1]
    return bool(bounds[0] - 1e-9 <= rx <= bounds[2] + 1e-9 and bounds[1] - 1e-9 <= ry <= bounds[3] + 1e-9)


@bare
def _arc_in_bounds(reference: Floats, bounds: Floats, x: float, y: float, angle: float, turn: float) -> bool:
    """Return whether the reference point stays within its bounds over a turn: at both ends and the arc's extremes."""
    if not _reference_in_bounds(reference, bounds, x, y, angle):
        return False
    if not _reference_in_bounds(reference, bounds, x, y, angle + turn):
        return False
    begin = angle + math.atan2(reference[1], reference[0])
    low, high = min(begin, begin + turn), max(begin, begin + turn)
    quarter = math.ceil(low / (math.pi / 2)) * (math.pi / 2)
    while quarter < high:
        if not _reference_in_bounds(reference, bounds, x, y, angle + quarter - begin):
            return False
        quarter += math.pi / 2
    return True
