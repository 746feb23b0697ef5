"""One hop from pose to pose, certified by exact first contact: a turn about the body's centre and a push. For numba."""

import math

import numpy as np
import numpy.typing as npt

from geometry.compiled import compiled
from geometry.impact import Surface, push_through_skin, turn_through_skin
from geometry.separation import Ground, Mover

Floats = npt.NDArray[np.float64]
BLOCKED, TURN_FIRST, PUSH_FIRST = 0, 1, 2
EVEN = 1e-12  # radians or squares: less is no motion


@compiled
def put(target: Floats, pose: Floats) -> None:
    """Copy a pose (x, y, angle) into another array. (An array assignment would take numba long to compile.)"""
    for k in range(3):
        target[k] = pose[k]


@compiled
def placed(mover: Mover, x: float, y: float, angle: float) -> Floats:
    """The body's edges at a pose: (m, 7)."""
    c, s = math.cos(angle), math.sin(angle)
    edges = np.empty_like(mover.edges)
    for i in range(len(edges)):
        for k in range(0, 6, 2):
            u, v = mover.edges[i, k], mover.edges[i, k + 1]
            edges[i, k], edges[i, k + 1] = c * u - s * v, s * u + c * v
        edges[i, 0] += x
        edges[i, 1] += y
        edges[i, 2] += x
        edges[i, 3] += y
        edges[i, 6] = mover.edges[i, 6]
    return edges


@compiled
def push_is_free(
    mover: Mover, ground: Ground, surface: Surface, x: float, y: float, angle: float, dx: float, dy: float
) -> bool:
    """Whether the body can be pushed from a pose by (dx, dy)."""
    if not _reference_within(mover, ground, x + dx, y + dy, angle):
        return False
    if abs(dx) + abs(dy) < EVEN:
        return True
    edges = placed(mover, x, y, angle)
    return push_through_skin(edges[:, :2], edges, surface.hull, surface.skin, surface.chunks, dx, dy)[1] == 0


@compiled
def turn_is_free(mover: Mover, ground: Ground, surface: Surface, x: float, y: float, angle: float, turn: float) -> bool:
    """Whether the body can be turned about its centre from a pose by some radians."""
    if not _arc_within(mover, ground, x, y, angle, turn):
        return False
    if abs(turn) < EVEN:
        return True
    edges = placed(mover, x, y, angle)
    sign = 1.0 if turn > 0 else -1.0
    hull, skin, chunks = surface.hull, surface.skin, surface.chunks
    return turn_through_skin(edges[:, :2], edges, hull, skin, chunks, x, y, sign, abs(turn))[1] == 0


@compiled
def shorter_turn(turn: float) -> float:
    """The same turn the short way: from -pi to pi."""
    return turn - 2 * math.pi * math.floor(turn / (2 * math.pi) + 0.5)


@compiled
def hop(mover: Mover, ground: Ground, surface: Surface, here: Floats, there: Floats) -> int:
    """Whether the body can go from pose to pose (x, y, angle): TURN_FIRST, PUSH_FIRST or BLOCKED."""
    dx, dy = there[0] - here[0], there[1] - here[1]
    turn = shorter_turn(there[2] - here[2])
    if turn_is_free(mover, ground, surface, here[0], here[1], here[2], turn) and push_is_free(
        mover, ground, surface, here[0], here[1], here[2] + turn, dx, dy
    ):
        return TURN_FIRST
    if abs(turn) < EVEN:
        return BLOCKED
    if push_is_free(mover, ground, surface, here[0], here[1], here[2], dx, dy) and turn_is_free(
        mover, ground, surface, there[0], there[1], here[2], turn
    ):
        return PUSH_FIRST
    return BLOCKED


@compiled
def _reference_within(mover: Mover, ground: Ground, x: float, y: float, angle: float) -> bool:
    """Whether the reference point is within its bounds at a pose."""
    c, s = math.cos(angle), math.sin(angle)
    ox, oy = mover.reference[0], mover.reference[1]
    rx, ry = x + c * ox - s * oy, y + s * ox + c * oy
    low_x, low_y, high_x, high_y = ground.bounds[0], ground.bounds[1], ground.bounds[2], ground.bounds[3]
    return bool(low_x - 1e-9 <= rx <= high_x + 1e-9 and low_y - 1e-9 <= ry <= high_y + 1e-9)


@compiled
def _arc_within(mover: Mover, ground: Ground, x: float, y: float, angle: float, turn: float) -> bool:
    """Whether the reference point stays within its bounds over a turn: at both ends and wherever its arc is outmost."""
    if not _reference_within(mover, ground, x, y, angle) or not _reference_within(mover, ground, x, y, angle + turn):
        return False
    begin = angle + math.atan2(mover.reference[1], mover.reference[0])
    low, high = min(begin, begin + turn), max(begin, begin + turn)
    quarter = math.ceil(low / (math.pi / 2)) * (math.pi / 2)
    while quarter < high:
        if not _reference_within(mover, ground, x, y, angle + quarter - begin):
            return False
        quarter += math.pi / 2
    return True
