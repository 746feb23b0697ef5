"""Replay of a carrying plan with shapely alone."""

from collections import deque
from typing import Any

import numpy as np
import shapely

from utak.geometry.manipulation.plan_carrying import CarryingPlan
from utak.geometry.motion.se2 import Rotate

MAX_PENETRATION = 1e-6  # squares: how far anything may enter a wall; above the skin of first contact
POSES_PER_MOTION = 65  # poses checked in every motion; a convention


def walls_of(free: np.ndarray) -> Any:
    """Return the squares that are not free, and a rim around the table, as one geometry."""
    rows, columns = np.nonzero(free)
    floor = shapely.union_all(shapely.box(columns, rows, columns + 1, rows + 1))
    return shapely.box(-20, -20, free.shape[1] + 20, free.shape[0] + 20).difference(floor)


def under(shape: Any, size: tuple[int, int]) -> np.ndarray:
    """Return the squares that a shape covers: (rows, columns) bool for a table of this size."""
    columns, rows = np.meshgrid(np.arange(size[1]), np.arange(size[0]))
    return np.asarray(
        shapely.area(shapely.intersection(shapely.box(columns, rows, columns + 1, rows + 1), shape)) > 1e-9
    )


def reachable(walk: np.ndarray, start: tuple[int, int]) -> np.ndarray:
    """Return the squares that can be walked to from a (column, row), over shared edges."""
    seen = np.zeros_like(walk)
    seen[start[1], start[0]] = True
    queue = deque([start])
    while queue:
        x, y = queue.popleft()
        for u, v in ((x + 1, y), (x, y + 1), (x - 1, y), (x, y - 1)):
            if 0 <= v < walk.shape[0] and 0 <= u < walk.shape[1] and walk[v, u] and not seen[v, u]:
                seen[v, u] = True
                queue.append((u, v))
    return seen


def replay(
    plan: CarryingPlan, shape: Any, free: np.ndarray, utak: tuple[float, float], pull: bool = True, walls: Any = None
) -> Any:
    """Carry out a plan, asserting that each leg can be done; return the shape as it lies at the end."""
    solid = (walls_of(free) if walls is None else walls).buffer(-MAX_PENETRATION, join_style="mitre")
    shapely.prepare(solid)
    for n, leg in enumerate(plan.legs):
        if leg.taken:
            assert plan.held and n == 0 and leg.place == utak
        else:
            x, y = int(leg.place[0]), int(leg.place[1])
            assert leg.place == (x + 0.5, y + 0.5)
            covered = under(shape, free.shape)
            assert reachable(free & ~covered, (int(utak[0]), int(utak[1])))[y, x]
            utak = leg.place
            assert covered[y + leg.direction_square[1], x + leg.direction_square[0]]
        for motion in leg.motions:
            if isinstance(motion, Rotate):
                assert motion.about == utak
            elif not pull:
                middle = shape.centroid
                assert motion.dx * (middle.x - utak[0]) + motion.dy * (middle.y - utak[1]) > 0
            swept = [motion.part(t).carry(shape) for t in np.linspace(0, 1, POSES_PER_MOTION)]
            assert not shapely.intersects(solid, swept).any()
            if not isinstance(motion, Rotate):
                after = (utak[0] + motion.dx, utak[1] + motion.dy)
                assert not solid.intersects(shapely.LineString([utak, after]))
                utak = after
            shape = motion.carry(shape)
    if plan.polygon is not None:
        assert shape.symmetric_difference(plan.polygon).area < 1e-6
    return shape
