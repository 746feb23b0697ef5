"""Shortening a way of certified hops, and writing it as motions. Every hop is checked again."""

import math
from itertools import pairwise

import numpy as np

from geometry.cspace.local_planner import BLOCKED, EVEN, TURN_FIRST, HopContext, hop, put, shorter_turn
from geometry.kernels.arrays import Floats
from geometry.kernels.jit import bare, compiled
from geometry.motion.cell_clearance import distance_at
from geometry.motion.se2 import Motion, Rotate, Translate

LOOSE = 0.01  # of the body's radius: with less room a pose counts as touching
PULLS = 4  # times that every corner of the way is pulled straight


@compiled
def shorten(scene: HopContext, poses: Floats) -> Floats:
    """A shorter way from the first to the last of (n, 3) poses: hops over poses, then corners pulled straight."""
    kept = _jump(scene, poses)
    if len(kept) > 2:
        kept = _jump(scene, _retracted(scene, kept))
    for _ in range(PULLS):
        _pull(scene, kept)
        kept = _jump(scene, kept)
    return kept


@compiled
def _retracted(scene: HopContext, poses: Floats) -> Floats:
    """The way with its corners moved to where the body has most room: there the longest hops begin.

    Where two such corners do not see each other the old ones stay between them.
    """
    roomy = poses.copy()
    for n in range(1, len(poses) - 1):
        _make_room(scene, roomy[n])
        if hop(scene, poses[n], roomy[n]) == BLOCKED:
            put(roomy[n], poses[n])
    way = np.empty((3 * len(poses), 3))
    put(way[0], poses[0])
    count = 1
    for n in range(1, len(poses)):
        if hop(scene, roomy[n - 1], roomy[n]) == BLOCKED:
            put(way[count], poses[n - 1])
            put(way[count + 1], poses[n])
            count += 2
        put(way[count], roomy[n])
        count += 1
    return way[:count].copy()


@bare
def _make_room(scene: HopContext, pose: Floats) -> None:
    """Move a pose, in place, towards more distance from the obstacles: halving steps in place and angle."""
    best, radius = _room(scene, pose), scene.mover.radius
    step = min(max(best, 0.02 * radius), 0.5 * radius)
    while step > 1e-4 * radius:
        better = False
        for k in range(6):
            size = (step if k % 2 == 0 else -step) / (radius if k >= 4 else 1.0)
            pose[k // 2] += size
            room = _room(scene, pose)
            if room > best + 1e-9:
                best, better = room, True
            else:
                pose[k // 2] -= size
        if not better:
            step *= 0.5


@compiled
def loosened(scene: HopContext, pose: Floats, leaving: bool) -> Floats:
    """A pose near one that touches obstacles, with more room about it and a free push from there or, leaving, to there.

    Where a body touches no cell is free: a search must begin and end a little away from the wall.
    """
    best, found, tried = _room(scene, pose), pose.copy(), pose.copy()
    radius = scene.mover.radius
    if best > LOOSE * radius:
        return found
    size = 0.2 * radius
    while size > 0.001 * radius:
        for k in range(32):
            tried[0] = pose[0] + size * math.cos(k * math.pi / 16)
            tried[1] = pose[1] + size * math.sin(k * math.pi / 16)
            room = _room(scene, tried)
            if room <= best:
                continue
            way = hop(scene, pose, tried) if leaving else hop(scene, tried, pose)
            if way != BLOCKED:
                best = room
                put(found, tried)
        size *= 0.7
    return found


@bare
def _room(scene: HopContext, pose: Floats) -> float:
    """The body's distance from the obstacles at a pose, as far as it matters."""
    mover, c, s = scene.mover, math.cos(pose[2]), math.sin(pose[2])
    return min(distance_at(mover, scene.ground, pose[0], pose[1], c, s), 0.3 * mover.radius)


@compiled
def _jump(scene: HopContext, poses: Floats) -> Floats:
    """From each pose hop as far ahead as doubling and halving finds."""
    kept = np.empty_like(poses)
    put(kept[0], poses[0])
    count, at, last = 1, 0, len(poses) - 1
    while at < last:
        low, step = at + 1, 2
        high = last + 1
        if hop(scene, poses[at], poses[last]) != BLOCKED:
            low, high = last, last + 1
        while low + 1 < high:
            tried = min(at + step, last) if step > 0 else (low + high) // 2
            if tried <= low:
                break
            if hop(scene, poses[at], poses[tried]) != BLOCKED:
                low, step = tried, 2 * step
            else:
                high, step = tried, 0
        at = low
        put(kept[count], poses[at])
        count += 1
    return kept[:count].copy()


@compiled
def _pull(scene: HopContext, poses: Floats) -> None:
    """Move each pose towards the straight way between its neighbours as far as the hops stay free."""
    here, step = np.empty(3), np.empty(3)
    for n in range(1, len(poses) - 1):
        before, after = poses[n - 1], poses[n + 1]
        put(here, poses[n])
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
            if hop(scene, before, poses[n]) != BLOCKED and (hop(scene, poses[n], after) != BLOCKED):
                break
            pull *= 0.5
            put(poses[n], here)


def motions_along(scene: HopContext, poses: Floats) -> tuple[Motion, ...]:
    """The turns and pushes of a way, in order, those of no size left out.

    Raises
    ------
    RuntimeError : when a hop is not free; the way was never certified.
    """
    motions: list[Motion] = []
    for here, there in pairwise(poses):
        way = hop(scene, here, there)
        if way == BLOCKED:
            raise RuntimeError("a hop of the way is blocked")
        dx, dy = float(there[0] - here[0]), float(there[1] - here[1])
        turn = float(shorter_turn(there[2] - here[2]))
        pivot = here if way == TURN_FIRST else there
        steps: list[Motion] = [Rotate(math.degrees(turn), (float(pivot[0]), float(pivot[1]))), Translate(dx, dy)]
        sizes = [abs(turn), abs(dx) + abs(dy)]
        if way != TURN_FIRST:
            steps.reverse()
            sizes.reverse()
        motions += [step for step, size in zip(steps, sizes, strict=True) if size >= EVEN]
    return tuple(motions)
