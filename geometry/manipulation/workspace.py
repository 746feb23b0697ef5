"""Free squares as a place to carry things in: the walls around them as polygons, ready for exact first contact."""

from functools import cached_property
from typing import Any

import numpy as np
import shapely

from geometry.kernels.arrays import Bools, Floats
from geometry.motion.first_contact import ContactBody, Obstacles
from geometry.motion.obstacle_field import ObstacleField
from geometry.motion.se2 import Motion

EDGE = 4.0  # squares: how thick the outside of the array is drawn
ARM = 0.45  # squares: how far Utak should keep from walls, where he can
WHOLE = 1.0 - 1e-12


class Workspace:
    """The squares on which a body and Utak may be; all else, and all outside the array, is wall.

    Parameters
    ----------
    free : (rows, columns) bool.
    walls : shapely geometry, what is wall among and around the squares; None for all that is not free. Where walls are
        known better than by squares, `free` are those squares that they leave whole.
    """

    def __init__(self, free: Bools, walls: Any = None) -> None:
        rows, columns = free.shape
        self.free = free
        self.outer = shapely.box(-EDGE, -EDGE, columns + EDGE, rows + EDGE)
        whole = shapely.union_all(_strips(free)) if free.any() else shapely.Polygon()
        self.floor_polygon = whole if walls is None else shapely.box(0, 0, columns, rows).difference(walls)
        self.walls = list(shapely.get_parts(self.outer.difference(self.floor_polygon)))
        self.obstacles = Obstacles(self.walls)

    @cached_property
    def floor(self) -> ObstacleField:
        """The walls prepared for plan_motion."""
        rows, columns = self.free.shape
        return ObstacleField(self.walls, (0.0, 0.0, float(columns), float(rows)))

    def lets(self, shape: Any, utak: tuple[float, float], motion: Motion) -> bool:
        """Whether shape and Utak as one body can make a motion."""
        return self.frees(ContactBody(shape, [utak]), motion)

    def frees(self, body: ContactBody, motion: Motion) -> bool:
        """Whether a body can make a motion to the end."""
        return self.obstacles.first_contact(body, motion).fraction >= WHOLE

    def far(self, body: ContactBody, vectors: Floats) -> Bools:
        """Which pushes (n, 2) a body can make to the end: (n,)."""
        free: Bools = self.obstacles.pushes(body, vectors) >= WHOLE
        return free


def broad(shape: Any, utak: tuple[float, float], margin: float) -> ContactBody:
    """Shape and Utak with all the room about them that they should have: a margin, and an arm's length."""
    return ContactBody(shapely.MultiPolygon(shapely.get_parts([padded(shape, margin), arms(utak)])))


def padded(shape: Any, margin: float) -> Any:
    """A shape with a margin around it, its corners kept sharp."""
    return shape.buffer(margin, join_style="mitre") if margin > 0.0 else shape


def arms(utak: tuple[float, float]) -> Any:
    """The square about Utak that should stay free."""
    return shapely.box(utak[0] - ARM, utak[1] - ARM, utak[0] + ARM, utak[1] + ARM)


def _strips(free: Bools) -> Any:
    """The free squares as few rectangles: runs along rows, joined with the same runs of the rows that follow."""
    strips = []
    growing: dict[tuple[int, int], int] = {}
    for row in range(len(free) + 1):
        runs = _runs(free[row]) if row < len(free) else set()
        for (x0, x1), since in sorted(growing.items()):
            if (x0, x1) not in runs:
                strips.append(shapely.box(x0, since, x1, row))
        growing = {run: growing.get(run, row) for run in runs}
    return strips


def _runs(line: Bools) -> set[tuple[int, int]]:
    """The runs of True in a row as (first, stop)."""
    change = np.flatnonzero(np.diff(np.concatenate([[False], line, [False]]).astype(np.int8)))
    return {(int(a), int(b)) for a, b in change.reshape(-1, 2)}
