"""Goals of carrying: at a pose, inside a region, in a corner, between walls; and the cost of each end pose."""

import math
from collections.abc import Hashable, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt
import shapely

from utak.geometry.cspace.solver import Inside
from utak.geometry.kernels.arrays import Bools
from utak.geometry.motion.se2 import Pose, turned
from utak.geometry.raster.rasterize import covered_areas
from utak.geometry.state_lattice.footprints import PUSH_DIRECTIONS, Footprints, quarter
from utak.geometry.state_lattice.lattice import COMMAND_COST, Costs, Grid, StateLattice

__all__ = ["At", "Between", "End", "InCorner", "Inside"]

Extent = TypeVar("Extent", float, npt.NDArray[np.float64])

GOAL_TOLERANCE = 1e-6  # squares; rounding by which an end may miss a region's border
ROOMY_RADIUS = 10.0  # squares; convention: a roomy place further than this from the wished one does not count
TIGHT_END_COST = 2 * COMMAND_COST // 5  # of an end that only just meets the goal; chosen, no measurement on record


@dataclass(frozen=True)
class At:
    """A goal: the shape turned about its own centroid by pose.degrees, then moved by (pose.x, pose.y) squares."""

    # Relative to the shape as it lies when the goal is set; degrees counter-clockwise positive, x east, y north
    pose: Pose


@dataclass(frozen=True)
class InCorner:
    """A goal: the shape's bounding box within `slack` squares of both walls of a corner, at any angle of the shape."""

    x: float  # the corner, where the walls meet, in squares, table frame. The walls run along the axes.
    y: float
    sx: int  # 1 for an eastern or northern corner, else -1
    sy: int
    slack: float = 1.0  # the greatest gap to each wall, in squares
    # How far from the two walls the box may reach at most (its far sides), in squares, the lesser and the greater; a
    # shape that is not aligned with the walls reaches further
    within: tuple[float, float] = (math.inf, math.inf)
    # Squares beyond `slack` from the walls at which a body may end on the lattice, to be pressed on from there
    press: float = 0.0

    def gaps(self, bounds: tuple[Extent, Extent, Extent, Extent]) -> tuple[Extent, Extent]:
        """Return the gaps between bounding boxes and the two walls, in squares; negative beyond a wall."""
        x = self.x - bounds[2] if self.sx > 0 else bounds[0] - self.x
        y = self.y - bounds[3] if self.sy > 0 else bounds[1] - self.y
        return x, y

    def admits(self, bounds: tuple[Extent, Extent, Extent, Extent]) -> Any:
        """Return whether bounding boxes lie in the corner: a bool, or an array of bool."""
        x, y = self.gaps(bounds)
        across, up = x + bounds[2] - bounds[0], y + bounds[3] - bounds[1]
        near, far = np.minimum(across, up), np.maximum(across, up)
        close = (np.minimum(x, y) >= -GOAL_TOLERANCE) & (np.maximum(x, y) <= self.slack + GOAL_TOLERANCE)
        return close & (near <= self.within[0] + GOAL_TOLERANCE) & (far <= self.within[1] + GOAL_TOLERANCE)


@dataclass(frozen=True)
class Between:
    """A goal: the shape within `slack` squares of two straight walls that meet in a corner at any angle."""

    x: float  # the corner, in squares, table frame
    y: float
    # The unit normals (x, y) of its two walls, outward: from the floor into the wall
    walls: tuple[tuple[float, float], tuple[float, float]]
    slack: float = 1.0  # the greatest gap to each wall, in squares

    def gaps(self, shape: Any) -> tuple[float, float]:
        """Return the gaps between a shape and the two walls in the order of `walls`; negative beyond them."""
        points = shapely.get_coordinates(shape)
        one, two = (float(np.dot(n, (self.x, self.y)) - (points @ np.array(n)).max()) for n in self.walls)
        return one, two

    def move(self, gaps: tuple[float, float]) -> tuple[float, float]:
        """Return the translation (dx, dy) in squares, that reduces the gaps to the walls by these amounts."""
        dx, dy = np.linalg.solve(np.array(self.walls), np.array(gaps)).tolist()
        return dx, dy

    def about(self, reach: float) -> Any:
        """Return the area at most `reach` squares from both walls, and at most so far beyond them."""
        ends = [
            self.move((-far, -wide))
            for far, wide in ((-reach, -reach), (-reach, reach), (reach, reach), (reach, -reach))
        ]
        return shapely.Polygon([(self.x + dx, self.y + dy) for dx, dy in ends])


@dataclass(frozen=True)
class Roomy:
    """A goal on the way to others: two free squares all round, so that the robot can grasp the shape from any side."""

    # (x, y) in squares, table frame, the wished place of the shape's centroid: the nearer, the cheaper; None for
    # anywhere
    near: tuple[float, float] | None = None


End = At | Inside | InCorner | Between | Roomy


def goal_key(goal: End) -> Hashable:
    """Return what a goal is, to know it again: the goal itself, and for a region its outline in bytes."""
    return goal.polygon.wkb if isinstance(goal, Inside) else goal


def is_goal_met(goal: End, shape: Any, now: Any) -> bool:
    """Return whether a shape meets the goal as it lies now, to GOAL_TOLERANCE squares."""
    if isinstance(goal, Inside):
        return any(part.buffer(GOAL_TOLERANCE).covers(now) for part in shapely.get_parts(goal.polygon))
    if isinstance(goal, InCorner):
        return bool(goal.admits(now.bounds))
    if isinstance(goal, Between):
        return max(goal.gaps(now)) <= goal.slack + GOAL_TOLERANCE
    if isinstance(goal, Roomy):
        return False
    return bool(shapely.hausdorff_distance(shape_at_pose(shape, goal.pose), now) <= GOAL_TOLERANCE)


def shape_at_pose(shape: Any, pose: Pose) -> Any:
    """Return a shape turned about its centroid by pose.degrees, then moved by (pose.x, pose.y) squares."""
    middle = np.array([shape.centroid.x, shape.centroid.y])
    return shapely.transform(shape, lambda p: turned(p - middle, pose.degrees) + middle + np.array([pose.x, pose.y]))


def moved(goal: End, dx: float, dy: float) -> End:
    """Return a goal translated by (dx, dy) squares, table frame, for a shape that is translated as far."""
    if isinstance(goal, Inside):
        return Inside(shapely.transform(goal.polygon, lambda p: p + np.array([dx, dy])))
    if isinstance(goal, InCorner | Between):
        return replace(goal, x=goal.x + dx, y=goal.y + dy)
    if isinstance(goal, Roomy) and goal.near is not None:
        return Roomy((goal.near[0] + dx, goal.near[1] + dy))
    return goal


def end_costs(goal: End, shape: Any, footprints: Footprints, lattice: StateLattice, grid: Grid) -> Costs:
    """Return the cost of ending at each pose of the lattice."""
    # -1 where the goal is not reached or the body cannot lie.
    # For a goal pose off the lattice, the places beside it count when it is a whole number of quarter turns away; their
    # costs are -1 otherwise.
    if isinstance(goal, At):
        return _costs_at_pose(goal.pose, shape, footprints, grid)
    if isinstance(goal, Inside):
        parts = [
            grid.padded(covered_areas(part, grid.columns, grid.rows) < 1 - GOAL_TOLERANCE, True)
            for part in shapely.get_parts(goal.polygon)
        ]
        found = [_costs_inside(parts, quarter(footprints.lying, k), lattice, grid) for k in range(4)]
    elif isinstance(goal, Between):
        found = [_costs_between(goal, shape, footprints, k, grid) for k in range(4)]
    elif isinstance(goal, Roomy):
        found = [_costs_roomy(goal, quarter(footprints.lying, k), lattice, grid) for k in range(4)]
    else:
        found = [_costs_in_corner(goal, shape, footprints, k, grid) for k in range(4)]
    return np.where(lattice.lies, np.array(found), -1).astype(np.int32)


def _costs_inside(parts: Sequence[Bools], offsets: npt.NDArray[np.int64], lattice: StateLattice, grid: Grid) -> Costs:
    """Return the costs of one quarter turn: higher where the body has less than a free square about it."""
    cost = np.full(len(lattice.solid), -1, np.int32)
    own = grid.offsets(offsets)
    grown = np.unique([own, *(own + step for step in grid.offsets(np.array(PUSH_DIRECTIONS)))])
    for outside in parts:
        inside, easy = grid.clear(outside, own), grid.clear(outside & ~lattice.solid, grown)
        cost[inside & (cost != 0)] = TIGHT_END_COST
        cost[inside & easy] = 0
    return cost


def _costs_roomy(goal: Roomy, offsets: npt.NDArray[np.int64], lattice: StateLattice, grid: Grid) -> Costs:
    """Return the costs of one quarter turn where all squares within two of the body's are free; -1 elsewhere."""
    reach = range(-2, 3)
    grown = np.unique([grid.offsets(offsets + np.array((dx, dy))) for dx in reach for dy in reach])
    roomy = grid.clear(lattice.solid, grown)
    if goal.near is None:
        return np.where(roomy, 0, -1).astype(np.int32)
    row, column = np.divmod(np.arange(len(roomy)), grid.stride)
    far = np.hypot(column - grid.pad + 0.5 - goal.near[0], row - grid.pad + 0.5 - goal.near[1])
    return np.where(roomy & (far <= ROOMY_RADIUS), np.round(far * COMMAND_COST / 10), -1).astype(np.int32)


def _costs_in_corner(goal: InCorner, shape: Any, footprints: Footprints, k: int, grid: Grid) -> Costs:
    """Return the costs of quarter turn k: higher where a gap to a wall is more than half of what is allowed."""
    x0, y0, x1, y1 = shape_in_pose(shape, footprints, k, footprints.home).bounds
    row, column = np.divmod(np.arange((grid.rows + 2 * grid.pad) * grid.stride), grid.stride)
    dx, dy = column - grid.pad - footprints.home[0], row - grid.pad - footprints.home[1]
    bounds = x0 + dx, y0 + dy, x1 + dx, y1 + dy
    gap, most = np.maximum(*goal.gaps(bounds)), replace(goal, slack=goal.slack + goal.press)
    return np.where(
        most.admits(bounds), np.where(gap <= goal.slack / 2 + GOAL_TOLERANCE, 0, TIGHT_END_COST), -1
    ).astype(np.int32)


def _costs_between(goal: Between, shape: Any, footprints: Footprints, k: int, grid: Grid) -> Costs:
    """Return the costs of quarter turn k: higher where a gap to a wall is more than half of what is allowed."""
    gaps = goal.gaps(shape_in_pose(shape, footprints, k, footprints.home))
    row, column = np.divmod(np.arange((grid.rows + 2 * grid.pad) * grid.stride), grid.stride)
    dx, dy = column - grid.pad - footprints.home[0], row - grid.pad - footprints.home[1]
    gap = np.maximum(*(gap - x * dx - y * dy for gap, (x, y) in zip(gaps, goal.walls, strict=True)))
    return np.where(gap <= goal.slack + GOAL_TOLERANCE, np.where(gap <= goal.slack / 2, 0, TIGHT_END_COST), -1).astype(
        np.int32
    )


def shape_in_pose(shape: Any, footprints: Footprints, k: int, place: tuple[int, int]) -> Any:
    """Return the shape in a pose of the lattice: k quarter turns about the centre of its home square, then moved."""
    home = np.array(footprints.home) + 0.5
    move = np.array(place) + 0.5
    return shapely.transform(shape, lambda p: turned(p - home, 90.0 * k) + move)


def _costs_at_pose(pose: Pose, shape: Any, footprints: Footprints, grid: Grid) -> Costs:
    """Return the costs of the pose's own place on the lattice, or of the up to four places about it; -1 elsewhere."""
    found = np.full((4, (grid.rows + 2 * grid.pad) * grid.stride), -1, np.int32)
    k = round(pose.degrees / 90.0)
    if abs(pose.degrees - 90.0 * k) > 1e-7:
        return found
    there, here = shape_at_pose(shape, pose).centroid, shape_in_pose(shape, footprints, k, footprints.home).centroid
    dx, dy = there.x - here.x + footprints.home[0], there.y - here.y + footprints.home[1]
    for x in {math.floor(dx + GOAL_TOLERANCE), math.ceil(dx - GOAL_TOLERANCE)}:
        for y in {math.floor(dy + GOAL_TOLERANCE), math.ceil(dy - GOAL_TOLERANCE)}:
            if 0 <= x < grid.columns and 0 <= y < grid.rows:
                found[k % 4, grid.number(x, y)] = round(100 * math.hypot(x - dx, y - dy))
    return found
