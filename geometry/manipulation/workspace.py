"""Workspace: free squares and the walls around them as polygons, ready for exact first contact."""

from collections.abc import Callable, Hashable
from functools import cached_property, lru_cache
from typing import Any, TypeVar

import numpy as np
import shapely

from utak.geometry.kernels.arrays import Bools, Floats
from utak.geometry.motion.first_contact import ContactBody, Obstacles
from utak.geometry.motion.obstacle_field import ObstacleField
from utak.geometry.motion.se2 import Motion
from utak.geometry.raster.runs import runs_along_rows

OUTER_WALL_THICKNESS = 4.0  # squares; convention: the thickness of the wall that surrounds the array
ROBOT_CLEARANCE = 0.45  # squares; convention: the robot keeps so far from walls where it can, less than half a square
FULL_MOTION = 1.0 - 1e-12  # fraction of a motion; rounding: free up to here counts as free to the end
Remembered = TypeVar("Remembered")
MAX_KEPT_WORKSPACES = 64  # of squares that were asked for last; a bound on memory, a megabyte or so each
MAX_KEPT_RESULTS = 64  # of one workspace; a bound on memory, some kilobytes each


class Workspace:
    """The squares on which a body and the robot may be; all else, and all outside the array, is wall."""

    def __init__(self, free: Bools, walls: Any = None) -> None:
        self.free = free
        self._given = walls
        self._known: dict[Hashable, Any] = {}

    def once(self, key: Hashable, work: Callable[[], Remembered]) -> Remembered:
        """Return what some work comes to."""
        found: Remembered = self._known.pop(key) if key in self._known else work()
        self._known[key] = found  # the last one: those that were not asked for longest come first
        if len(self._known) > MAX_KEPT_RESULTS:
            del self._known[next(iter(self._known))]
        return found

    # Many questions are answered by squares alone, so what follows is computed on first access.

    @cached_property
    def floor_polygon(self) -> Any:
        """Return the floor, shapely geometry, squares, table frame."""
        if self._given is not None:
            return shapely.box(0, 0, *self.free.shape[::-1]).difference(self._given)
        return shapely.union_all(_free_rectangles(self.free)) if self.free.any() else shapely.Polygon()

    @cached_property
    def walls(self) -> list[Any]:
        """Return what is no floor, with a wall about the array: shapely Polygons, squares, table frame."""
        rows, columns = self.free.shape
        thick = OUTER_WALL_THICKNESS
        return list(
            shapely.get_parts(shapely.box(-thick, -thick, columns + thick, rows + thick).difference(self.floor_polygon))
        )

    @cached_property
    def obstacles(self) -> Obstacles:
        """Return the walls prepared for exact first contact."""
        return Obstacles(self.walls)

    @cached_property
    def floor(self) -> ObstacleField:
        """Return the walls prepared for plan_motion, with the table as bounds. Computed on first access."""
        rows, columns = self.free.shape
        return ObstacleField(self.walls, (0.0, 0.0, float(columns), float(rows)))

    def lets(self, shape: Any, utak: tuple[float, float], motion: Motion) -> bool:
        """Return whether shape and robot as one rigid body can make a motion to its end; touching walls is allowed."""
        return self.is_free(ContactBody(shape, [utak]), motion)

    def is_free(self, body: ContactBody, motion: Motion) -> bool:
        """Return whether a body can make a motion (Translate or Rotate, table frame) to its end; it may touch walls."""
        return self.obstacles.first_contact(body, motion) >= FULL_MOTION

    def far(self, body: ContactBody, vectors: Floats) -> Bools:
        """Return which pushes a body can make to their ends, each from where it stands: (n,) bool."""
        free: Bools = self.obstacles.pushes(body, vectors) >= FULL_MOTION
        return free


def workspace_of(free: Bools, walls: Any = None) -> Workspace:
    """Return the workspace of some free squares, the same one as before where it was asked for not long ago."""
    # Squares are asked about again and again while a robot walks, for several goals.
    if walls is not None:
        return Workspace(free, walls)
    return _workspace_of_squares(free.tobytes(), free.shape[0], free.shape[1])


@lru_cache(maxsize=MAX_KEPT_WORKSPACES)
def _workspace_of_squares(free: bytes, rows: int, columns: int) -> Workspace:
    """Return the workspace of free squares, given as the bytes of a bool array, row by row."""
    return Workspace(np.frombuffer(free, np.bool_).reshape(rows, columns).copy())


def widened_body(shape: Any, utak: tuple[float, float], margin: float) -> ContactBody:
    """Return shape and robot as one body, widened by a margin (squares) and by ROBOT_CLEARANCE."""
    return ContactBody(shapely.MultiPolygon(shapely.get_parts([padded_shape(shape, margin), clear_square(utak)])))


def padded_shape(shape: Any, margin: float) -> Any:
    """Return a shape with a margin (squares) around it, its corners kept sharp; the shape itself without a margin."""
    return shape.buffer(margin, join_style="mitre") if margin > 0.0 else shape


def clear_square(utak: tuple[float, float]) -> Any:
    """Return the square about the robot that should stay free: shapely Polygon, squares, table frame."""
    return shapely.box(
        utak[0] - ROBOT_CLEARANCE, utak[1] - ROBOT_CLEARANCE, utak[0] + ROBOT_CLEARANCE, utak[1] + ROBOT_CLEARANCE
    )


def _free_rectangles(free: Bools) -> Any:
    """Return the free squares as few rectangles: a list of shapely Polygons, squares, table frame."""
    rectangles = []
    growing: dict[tuple[int, int], int] = {}
    for row, runs in enumerate(_runs_by_row(np.pad(free, ((0, 1), (0, 0))))):
        for (x0, x1), since in sorted(growing.items()):
            if (x0, x1) not in runs:
                rectangles.append(shapely.box(x0, since, x1, row))
        growing = {run: growing.get(run, row) for run in runs}
    return rectangles


def _runs_by_row(free: Bools) -> list[set[tuple[int, int]]]:
    """Return for each row the runs of True in it: sets of (first column, column after the last)."""
    found: list[set[tuple[int, int]]] = [set() for _ in free]
    for row, first, after in runs_along_rows(free).each():
        found[row].add((first, after))
    return found
