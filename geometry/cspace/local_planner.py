"""One hop from pose to pose, certified by exact first contact: a turn about the body's centre and a push. For numba."""

import math
from typing import NamedTuple

import numpy as np

from geometry.kernels.arrays import Floats
from geometry.kernels.jit import bare
from geometry.motion.cell_clearance import MovingBody, NearbyEdges
from geometry.motion.time_of_impact import Surface, push_through_skin, turn_through_skin

BLOCKED, TURN_FIRST, PUSH_FIRST = 0, 1, 2
EVEN = 1e-12  # radians or squares: less is no motion


class HopContext(NamedTuple):
    """A body, where it moves, the surface that it must not go into; scratch: (m, 7) the edges of the body placed."""

    mover: MovingBody
    ground: NearbyEdges
    surface: Surface
    placed: Floats


def new_scene(mover: MovingBody, ground: NearbyEdges, surface: Surface) -> HopContext:
    """A scene with scratch of its own."""
    return HopContext(mover, ground, surface, np.empty_like(mover.edges))


@bare
def put(target: Floats, pose: Floats) -> None:
    """Copy a pose (x, y, angle) into another array. (An array assignment would take numba long to compile.)"""
    for k in range(3):
        target[k] = pose[k]


@bare
def _place(own: Floats, edges: Floats, x: float, y: float, angle: float) -> None:
    """Write where a body's own edges are at a pose into `edges`: (m, 7) both."""
    c, s = math.cos(angle), math.sin(angle)
    for i in range(len(edges)):
        for k in range(0, 6, 2):
            u, v = own[i, k], own[i, k + 1]
            edges[i, k], edges[i, k + 1] = c * u - s * v, s * u + c * v
        edges[i, 0] += x
        edges[i, 1] += y
        edges[i, 2] += x
        edges[i, 3] += y
        edges[i, 6] = own[i, 6]


@bare
def push_is_free(scene: HopContext, x: float, y: float, angle: float, dx: float, dy: float) -> bool:
    """Whether the body can be pushed from a pose by (dx, dy)."""
    if not _reference_within(scene.mover.reference, scene.ground.bounds, x + dx, y + dy, angle):
        return False
    if abs(dx) + abs(dy) < EVEN:
        return True
    edges, surface = scene.placed, scene.surface
    _place(scene.mover.edges, edges, x, y, angle)
    return push_through_skin(edges, edges, surface.hull, surface.skin, surface.chunks, dx, dy)[1] == 0


@bare
def turn_is_free(scene: HopContext, x: float, y: float, angle: float, turn: float) -> bool:
    """Whether the body can be turned about its centre from a pose by some radians."""
    if not _arc_within(scene.mover.reference, scene.ground.bounds, x, y, angle, turn):
        return False
    if abs(turn) < EVEN:
        return True
    edges, surface = scene.placed, scene.surface
    _place(scene.mover.edges, edges, x, y, angle)
    sign = 1.0 if turn > 0 else -1.0
    return turn_through_skin(edges, edges, surface.hull, surface.skin, surface.chunks, x, y, sign, abs(turn))[1] == 0


@bare
def shorter_turn(turn: float) -> float:
    """The same turn the short way: from -pi to pi."""
    return turn - 2 * math.pi * math.floor(turn / (2 * math.pi) + 0.5)


@bare
def hop(scene: HopContext, here: Floats, there: Floats) -> int:
    """Whether the body can go from pose to pose (x, y, angle): TURN_FIRST, PUSH_FIRST or BLOCKED."""
    dx, dy = there[0] - here[0], there[1] - here[1]
    turn = shorter_turn(there[2] - here[2])
    if turn_is_free(scene, here[0], here[1], here[2], turn) and push_is_free(
        scene, here[0], here[1], here[2] + turn, dx, dy
    ):
        return TURN_FIRST
    if abs(turn) < EVEN:
        return BLOCKED
    if push_is_free(scene, here[0], here[1], here[2], dx, dy) and turn_is_free(
        scene, there[0], there[1], here[2], turn
    ):
        return PUSH_FIRST
    return BLOCKED


@bare
def _reference_within(reference: Floats, bounds: Floats, x: float, y: float, angle: float) -> bool:
    """Whether the reference point is within its bounds at a pose."""
    c, s = math.cos(angle), math.sin(angle)
    rx, ry = x + c * reference[0] - s * reference[1], y + s * reference[0] + c * reference[1]
    return bool(bounds[0] - 1e-9 <= rx <= bounds[2] + 1e-9 and bounds[1] - 1e-9 <= ry <= bounds[3] + 1e-9)


@bare
def _arc_within(reference: Floats, bounds: Floats, x: float, y: float, angle: float, turn: float) -> bool:
    """Whether the reference point stays within its bounds over a turn: at both ends and wherever its arc is outmost."""
    if not _reference_within(reference, bounds, x, y, angle):
        return False
    if not _reference_within(reference, bounds, x, y, angle + turn):
        return False
    begin = angle + math.atan2(reference[1], reference[0])
    low, high = min(begin, begin + turn), max(begin, begin + turn)
    quarter = math.ceil(low / (math.pi / 2)) * (math.pi / 2)
    while quarter < high:
        if not _reference_within(reference, bounds, x, y, angle + quarter - begin):
            return False
        quarter += math.pi / 2
    return True
