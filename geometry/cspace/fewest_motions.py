"""Fewer motions for a way that is known: other places near it are tried, and the way with least motions kept.

# Strategy: candidates are poses along the way, moved without turning to where the body has most room, and some more
# that lie straight to the axes. Dijkstra's algorithm over all pairs of them: what leads from one to another is a push,
# a turn, or one of each in either order, all checked by exact first contact.
"""

import math
from typing import Any

import numpy as np
import numpy.typing as npt
import shapely

from geometry.cspace.local_planner import BLOCKED, EVEN, HopContext, hop, shorter_turn
from geometry.cspace.smoothing import motions_along
from geometry.kernels.arrays import Floats
from geometry.kernels.jit import bare, compiled
from geometry.motion.cell_clearance import MovingBody, NearbyEdges, distance_at
from geometry.motion.se2 import Motion

STEPS, SWING = 40.0, 20.0  # squares pushed, radians turned that count as much as one motion
BESIDE = 30  # candidates along the way
ROOMY = 0.2  # of the body's radius: more room is not looked for


def fewest_motions(scene: HopContext, track: Floats, edge: float) -> tuple[Motion, ...]:
    """The motions of a way made few; () when a hop of it is not free.

    Parameters
    ----------
    scene : the body, with its pivot as centre, among its obstacles.
    track : (n, 3) a way of that centre, x, y, radians; hops from one to the next are free.
    edge : radians, the direction of the body's edge that may well lie along an axis.
    """
    candidates = _candidates(scene.mover, scene.ground, track, edge)
    order = _fewest(scene, candidates)
    return motions_along(scene, candidates[order]) if len(order) else ()


def slant(shape: Any) -> float:
    """The direction of a shape's longest edge, in radians."""
    corners = shapely.get_coordinates(shape.exterior)
    along = np.diff(corners, axis=0)
    x, y = along[int(np.argmax(np.round(np.hypot(along[:, 0], along[:, 1]), 6)))]
    return math.atan2(y, x)


def askew(shape: Any) -> float:
    """How far a shape's longest edge is turned from an axis, counter-clockwise, in degrees from 0 to 90."""
    return math.degrees(slant(shape)) % 90.0


def _candidates(mover: MovingBody, ground: NearbyEdges, track: Floats, edge: float) -> Floats:
    """Poses on and near a way: (n, 3), the first its start, the last its end."""
    along = evenly(track, mover.radius, BESIDE)
    straight = along[::2].copy()
    straight[:, 2] = np.round((straight[:, 2] + edge) / (math.pi / 2)) * (math.pi / 2) - edge
    roomy = np.vstack([along[1:-1], straight])
    for pose in roomy:
        centred(mover, ground, pose)
    return np.vstack([track[:-1], along[1:-1], roomy, straight, track[-1:]])


def evenly(track: Floats, radius: float, count: int) -> Floats:
    """Poses at even distances along a way, turns counted by how far they move the rim: (count, 3)."""
    angles = np.unwrap(track[:, 2])
    step = np.hypot(*np.diff(track[:, :2], axis=0).T) + radius * np.abs(np.diff(angles))
    far = np.concatenate([[0.0], np.cumsum(step)])
    at = np.linspace(0.0, far[-1], count)
    return np.column_stack([np.interp(at, far, column) for column in (track[:, 0], track[:, 1], angles)])


@bare
def centred(mover: MovingBody, ground: NearbyEdges, pose: Floats) -> None:
    """Move a pose, in place and without turning it, to where the body has more room: steps in eight directions."""
    c, s = math.cos(pose[2]), math.sin(pose[2])
    enough = ROOMY * mover.radius
    best = distance_at(mover, ground, pose[0], pose[1], c, s)
    step = 0.1 * mover.radius
    while step > 1e-4 * mover.radius and best < enough:
        better = False
        for k in range(8):
            x, y = pose[0] + step * math.cos(k * math.pi / 4), pose[1] + step * math.sin(k * math.pi / 4)
            room = distance_at(mover, ground, x, y, c, s)
            if room > best + 1e-9:
                best, better = room, True
                pose[0], pose[1] = x, y
        if not better:
            step *= 0.5


@compiled
def _fewest(scene: HopContext, poses: Floats) -> npt.NDArray[np.int64]:
    """The order of the poses on the way with the fewest motions from the first to the last; empty without any."""
    count = len(poses)
    cost, before = np.full(count, np.inf), np.full(count, -1, np.int64)
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
            far = math.hypot(poses[n, 0] - poses[here, 0], poses[n, 1] - poses[here, 1])
            turn = abs(shorter_turn(poses[n, 2] - poses[here, 2]))
            price = (1.0 if far > EVEN else 0.0) + (1.0 if turn > EVEN else 0.0) + far / STEPS + turn / SWING
            if cost[here] + price < cost[n] and hop(scene, poses[here], poses[n]) != BLOCKED:
                cost[n], before[n] = cost[here] + price, here
    length, n = 0, count - 1
    if cost[n] == np.inf:
        return np.empty(0, np.int64)
    while n >= 0:
        length, n = length + 1, before[n]
    order = np.empty(length, np.int64)
    n = count - 1
    for k in range(length - 1, -1, -1):
        order[k] = n
        n = before[n]
    return order
