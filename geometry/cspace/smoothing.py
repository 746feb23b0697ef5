"""Smoothing: shorten a path of certified hops, and write it as motions. Every hop is checked again."""

import math
from itertools import pairwise

import numpy as np

from utak.geometry.cspace.local_planner import BLOCKED, MIN_MOTION, TURN_FIRST, HopContext, copy_pose, hop, shorter_turn
from utak.geometry.kernels.arrays import Floats
from utak.geometry.kernels.jit import bare, compiled
from utak.geometry.motion.cell_clearance import clearance_at
from utak.geometry.motion.se2 import Motion, Rotate, Translate

TOUCHING_CLEARANCE = 0.01  # part of the body's radius: with less clearance a pose counts as touching; a convention
PULL_ROUNDS = 4  # times that every corner of a path is pulled straight; tuned on random worlds (benchmarks.campaign)


@compiled
def shorten_path(context: HopContext, poses: Floats) -> Floats:
    """Return a shorter path (m, 3) from the first to the last of `poses` (n, 3); every hop of it is free."""
    kept = _skip_poses(context, poses)
    if len(kept) > 2:
        kept = _skip_poses(context, _with_roomy_corners(context, kept))
    for _ in range(PULL_ROUNDS):
        _pull_straight(context, kept)
        kept = _skip_poses(context, kept)
    return kept


@compiled
def _with_roomy_corners(context: HopContext, poses: Floats) -> Floats:
    """Return the path with its corners moved to where the body has more clearance: there the longest hops begin."""
    roomy = poses.copy()
    for n in range(1, len(poses) - 1):
        _move_to_clearance(context, roomy[n])
        if hop(context, poses[n], roomy[n]) == BLOCKED:
            copy_pose(roomy[n], poses[n])
    path = np.empty((3 * len(poses), 3))
    copy_pose(path[0], poses[0])
    count = 1
    for n in range(1, len(poses)):
        if hop(context, roomy[n - 1], roomy[n]) == BLOCKED:
            copy_pose(path[count], poses[n - 1])
            copy_pose(path[count + 1], poses[n])
            count += 2
        copy_pose(path[count], roomy[n])
        count += 1
    return path[:count].copy()


@bare
def _move_to_clearance(context: HopContext, pose: Floats) -> None:
    """Move a pose, in place, to where the body has more clearance: pattern search in place and angle, halving steps."""
    best, radius = _clearance(context, pose), context.body.radius
    step = min(max(best, 0.02 * radius), 0.5 * radius)
    while step > 1e-4 * radius:
        better = False
        for k in range(6):
            size = (step if k % 2 == 0 else -step) / (radius if k >= 4 else 1.0)
            pose[k // 2] += size
            room = _clearance(context, pose)
            if room > best + 1e-9:
                best, better = room, True
            else:
                pose[k // 2] -= size
        if not better:
            step *= 0.5


@compiled
def pose_with_room(context: HopContext, pose: Floats, leaving: bool) -> Floats:
    """Return a pose near one that touches obstacles, with more clearance and a free hop between the two."""
    best, found, tried = _clearance(context, pose), pose.copy(), pose.copy()
    radius = context.body.radius
    if best > TOUCHING_CLEARANCE * radius:
        return found
    size = 0.2 * radius
    while size > 0.001 * radius:
        for k in range(32):
            tried[0] = pose[0] + size * math.cos(k * math.pi / 16)
            tried[1] = pose[1] + size * math.sin(k * math.pi / 16)
            room = _clearance(context, tried)
            if room <= best:
                continue
            order = hop(context, pose, tried) if leaving else hop(context, tried, pose)
            if order != BLOCKED:
                best = room
                copy_pose(found, tried)
        size *= 0.7
    return found


@bare
def _clearance(context: HopContext, pose: Floats) -> float:
    """Return the distance of the body from the obstacles at a pose, in squares, capped at 0.3 of the body's radius."""
    body, c, s = context.body, math.cos(pose[2]), math.sin(pose[2])
    return min(clearance_at(body, context.nearby, pose[0], pose[1], c, s), 0.3 * body.radius)


@compiled
def _skip_poses(context: HopContext, poses: Floats) -> Floats:
    """Return a subsequence (m, 3) of `poses` (n, 3), the first and the last among it, with free hops between them."""
    kept = np.empty_like(poses)
    copy_pose(kept[0], poses[0])
    count, at, last = 1, 0, len(poses) - 1
    while at < last:
        low, step = at + 1, 2
        high = last + 1
        if hop(context, poses[at], poses[last]) != BLOCKED:
            low, high = last, last + 1
        while low + 1 < high:
            tried = min(at + step, last) if step > 0 else (low + high) // 2
            if tried <= low:
                break
            if hop(context, poses[at], poses[tried]) != BLOCKED:
                low, step = tried, 2 * step
            else:
                high, step = tried, 0
        at = low
        copy_pose(kept[count], poses[at])
        count += 1
    return kept[:count].copy()


@compiled
def _pull_straight(context: HopContext, poses: Floats) -> None:
    """Move each of `poses`, in place, towards the straight line between its neighbours as far as the hops stay free."""
    here, step = np.empty(3), np.empty(3)
    for n in range(1, len(poses) - 1):
        before, after = poses[n - 1], poses[n + 1]
        copy_pose(here, poses[n])
        d0 = math.hypot(here[0] - before[0], here[1] - before[1])
        d1 = math.hypot(after[0] - here[0], after[1] - here[1])
        part = d0 / (d0 + d1) if d0 + d1 > 0.0 else 0.5
        step[0] = before[0] + part * (after[0] - before[0]) - here[0]
        step[1] = before[1] + part * (after[1] - before[1]) - here[1]
        step[2] = shorter_turn(before[2] + part * shorter_turn(after[2] - before[2]) - here[2])
        pull = 1.0
        for _ in range(5):
            for k in range(3):
                poses[n, k] = here[k] + pull * step[k]
            if hop(context, before, poses[n]) != BLOCKED and (hop(context, poses[n], after) != BLOCKED):
                break
            pull *= 0.5
            copy_pose(poses[n], here)


def motions_along(context: HopContext, poses: Floats) -> tuple[Motion, ...]:
    """Return the turns and pushes of a path of poses (n, 3), in order, without those of no size."""
    motions: list[Motion] = []
    for here, there in pairwise(poses):
        order = hop(context, here, there)
        if order == BLOCKED:
            raise RuntimeError("a hop of the path is blocked")
        dx, dy = float(there[0] - here[0]), float(there[1] - here[1])
        turn = float(shorter_turn(there[2] - here[2]))
        pivot = here if order == TURN_FIRST else there
        steps: list[Motion] = [Rotate(math.degrees(turn), (float(pivot[0]), float(pivot[1]))), Translate(dx, dy)]
        sizes = [abs(turn), abs(dx) + abs(dy)]
        if order != TURN_FIRST:
            steps.reverse()
            sizes.reverse()
        motions += [step for step, size in zip(steps, sizes, strict=True) if size >= MIN_MOTION]
    return tuple(motions)
