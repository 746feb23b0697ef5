"""Fewer motions for a way that is known: other places and angles near it are tried, the way with least motions kept.

# Strategy: candidates are the poses of the way, the same with the body straight to the nearest axis, and both moved to
# where the body has more room. Dijkstra's algorithm over all pairs of them: what leads from one to another is a push, a
# turn, or one of each in either order, all checked by exact first contact.
"""

import math
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from geometry.compiled import compiled
from geometry.hop import BLOCKED, EVEN, hop, shorter_turn
from geometry.impact import Surface
from geometry.mover import centre_pose
from geometry.rigid import Motion, Pose
from geometry.separation import Ground, Mover, distance_at
from geometry.shorten import motions_along

Floats = npt.NDArray[np.float64]
STEPS = 40.0  # squares that count as much as one motion
PIECE = 0.35  # of the body's radius: long pushes are cut in pieces, for more candidates
MOST = 90  # candidates


def fewest_motions(mover: Mover, ground: Ground, surface: Surface, way: list[Pose], edge: float) -> tuple[Motion, ...]:
    """The motions of a way made few.

    Parameters
    ----------
    mover : the body with its pivot as centre.
    way : poses of its reference point, each led to from the one before by one motion.
    edge : radians, the direction of the body's edge that should lie along an axis.
    """
    poses = np.array([centre_pose(mover, pose) for pose in way])
    candidates = _candidates(mover, ground, poses, edge)
    order = _fewest(mover, ground, surface, candidates)
    return motions_along(mover, ground, surface, candidates[order]) if len(order) else ()


def _candidates(mover: Mover, ground: Ground, poses: Floats, edge: float) -> Floats:
    """Poses on and near a way: (n, 3), the first its start, the last its end."""
    dense = [poses[0]]
    for here, there in pairwise(poses):
        count = max(1, min(8, math.ceil(math.dist(here[:2], there[:2]) / (PIECE * mover.radius))))
        dense += [here + (there - here) * (n + 1) / count for n in range(count)]
    step = max(1, math.ceil(len(dense) / (MOST // 3)))
    way = np.array([*dense[:-1:step], dense[-1]])
    straight = way.copy()
    straight[:, 2] = np.round((way[:, 2] + edge) / (math.pi / 2)) * (math.pi / 2) - edge
    roomy = np.vstack([straight, way[1:-1]])
    for pose in roomy:
        centred(mover, ground, pose)
    return np.vstack([way[:-1], straight, roomy, way[-1:]])


@compiled
def centred(mover: Mover, ground: Ground, pose: Floats) -> None:
    """Move a pose, in place and without turning it, to where the body has more room."""
    best = distance_at(mover, ground, pose[0], pose[1], math.cos(pose[2]), math.sin(pose[2]))
    step = 0.3 * mover.radius
    while step > 1e-3 * mover.radius and best < 0.3 * mover.radius:
        better = False
        for k in range(4):
            size = step if k % 2 == 0 else -step
            pose[k // 2] += size
            room = distance_at(mover, ground, pose[0], pose[1], math.cos(pose[2]), math.sin(pose[2]))
            if room > best + 1e-9:
                best, better = room, True
            else:
                pose[k // 2] -= size
        if not better:
            step *= 0.5


@compiled
def _fewest(mover: Mover, ground: Ground, surface: Surface, poses: Floats) -> npt.NDArray[np.int64]:
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
            price = (1.0 if far > EVEN else 0.0) + (1.0 if turn > EVEN else 0.0) + far / STEPS + turn / 20.0
            if cost[here] + price < cost[n] and hop(mover, ground, surface, poses[here], poses[n]) != BLOCKED:
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
