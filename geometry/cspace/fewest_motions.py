"""Fewer motions for a known path: other poses near it are tried, and the path with the fewest motions is kept.

# Strategy: candidates are poses along the path, poses moved without turning to where the body has more clearance, and
# some whose longest edge is parallel to an axis. Dijkstra's algorithm runs over all pairs of them. What leads from one
# to another is a push, a turn, or one of each in either order, all checked by exact first contact.
"""

import math
from typing import Any

import numpy as np
import numpy.typing as npt
import shapely

from utak.geometry.cspace.local_planner import BLOCKED, MIN_MOTION, HopContext, hop, shorter_turn
from utak.geometry.cspace.smoothing import motions_along
from utak.geometry.kernels.arrays import Floats
from utak.geometry.kernels.jit import bare, compiled
from utak.geometry.motion.cell_clearance import MovingBody, NearbyEdges, clearance_at
from utak.geometry.motion.se2 import Motion

PUSH_PER_MOTION = 40.0  # squares pushed that cost as much as one motion more; tuned on random worlds
TURN_PER_MOTION = 20.0  # radians turned that cost as much as one motion more; tuned (benchmarks.campaign)
CANDIDATE_POSES = 30  # candidates along the path; tuned likewise
ENOUGH_CLEARANCE = 0.2  # part of the body's radius: more clearance is not sought; tuned likewise


def fewest_motions(context: HopContext, path: Floats, edge: float) -> tuple[Motion, ...]:
    """Return the motions of a path, replaced by as few as the candidates allow; () if a hop of it is not free."""
    candidates = _candidates(context.body, context.nearby, path, edge)
    order = _cheapest_order(context, candidates)
    return motions_along(context, candidates[order]) if len(order) else ()


def longest_edge_angle(shape: Any) -> float:
    """Return the direction of the longest edge of a polygon's outer ring, in radians from -pi to pi."""
    corners = shapely.get_coordinates(shape.exterior)
    along = np.diff(corners, axis=0)
    x, y = along[int(np.argmax(np.round(np.hypot(along[:, 0], along[:, 1]), 6)))]
    return math.atan2(y, x)


def longest_edge_tilt(shape: Any) -> float:
    """Return how far a polygon's longest edge is turned counter-clockwise from an axis: degrees, from 0 to below 90."""
    return math.degrees(longest_edge_angle(shape)) % 90.0


def _candidates(body: MovingBody, nearby: NearbyEdges, path: Floats, edge: float) -> Floats:
    """Return poses on and near a path: (n, 3) x, y, radians; the first its start, the last its end."""
    # In between, in this order: the other poses of the path, poses evenly along it, these and turned ones moved to more
    # clearance, and poses turned so that the edge lies along an axis.
    along = resample_evenly(path, body.radius, CANDIDATE_POSES)
    straight = along[::2].copy()
    straight[:, 2] = np.round((straight[:, 2] + edge) / (math.pi / 2)) * (math.pi / 2) - edge
    with_clearance = np.vstack([along[1:-1], straight])
    for pose in with_clearance:
        move_to_clearance(body, nearby, pose)
    return np.vstack([path[:-1], along[1:-1], with_clearance, straight, path[-1:]])


def resample_evenly(path: Floats, radius: float, count: int) -> Floats:
    """Return `count` poses at even distances along a path: (count, 3) x, y, radians (unwrapped), its ends included."""
    angles = np.unwrap(path[:, 2])
    step = np.hypot(*np.diff(path[:, :2], axis=0).T) + radius * np.abs(np.diff(angles))
    distance = np.concatenate([[0.0], np.cumsum(step)])
    at = np.linspace(0.0, distance[-1], count)
    return np.column_stack([np.interp(at, distance, column) for column in (path[:, 0], path[:, 1], angles)])


@bare
def move_to_clearance(body: MovingBody, nearby: NearbyEdges, pose: Floats) -> None:
    """Move a pose, in place and without turning it, to where the body has more clearance: steps in eight directions."""
    c, s = math.cos(pose[2]), math.sin(pose[2])
    enough = ENOUGH_CLEARANCE * body.radius
    best = clearance_at(body, nearby, pose[0], pose[1], c, s)
    step = 0.1 * body.radius
    while step > 1e-4 * body.radius and best < enough:
        better = False
        for k in range(8):
            x, y = pose[0] + step * math.cos(k * math.pi / 4), pose[1] + step * math.sin(k * math.pi / 4)
            room = clearance_at(body, nearby, x, y, c, s)
            if room > best + 1e-9:
                best, better = room, True
                pose[0], pose[1] = x, y
        if not better:
            step *= 0.5


@compiled
def _cheapest_order(context: HopContext, poses: Floats) -> npt.NDArray[np.int64]:
    """Return the indices of the poses on the cheapest path from the first to the last; empty if there is none."""
    count = len(poses)
    cost, parent = np.full(count, np.inf), np.full(count, -1, np.int64)
    done = np.zeros(count, np.bool_)
    cost[0] = 0.0
    for _ in range(count):
        here = -1
        for n in range(count):
            if not done[n] and cost[n] < np.inf and (here < 0 or cost[n] < cost[here]):
                here = n
        if here < 0 or here == count - 1:
            break
        done[here] = True
        for n in range(count):
            if done[n]:
                continue
            distance = math.hypot(poses[n, 0] - poses[here, 0], poses[n, 1] - poses[here, 1])
            turn = abs(shorter_turn(poses[n, 2] - poses[here, 2]))
            price = (
                (1.0 if distance > MIN_MOTION else 0.0)
                + (1.0 if turn > MIN_MOTION else 0.0)
                + distance / PUSH_PER_MOTION
                + turn / TURN_PER_MOTION
            )
            if cost[here] + price < cost[n] and hop(context, poses[here], poses[n]) != BLOCKED:
                cost[n], parent[n] = cost[here] + price, here
    length, n = 0, count - 1
    if cost[n] == np.inf:
        return np.empty(0, np.int64)
    while n >= 0:
        length, n = length + 1, parent[n]
    order = np.empty(length, np.int64)
    n = count - 1
    for k in range(length - 1, -1, -1):
        order[k] = n
        n = parent[n]
    return order
