"""Planning the motion of a polygon among polygons: certified when found, proved when impossible.

    plan = plan_motion(shape, obstacles, Pose(2, 2, 0), Pose(9, 5, 90))

# Strategy: poses are searched in cells that are split only along the way (geometry.cspace.cell_tree,
# geometry.cspace.channel). A chain of
# cells from start to goal is an optimist's plan. Its hops are checked by exact first contact; where one fails the cells
# to blame are split and the search goes on. A chain all of whose hops are free is a motion. When there is no chain left
# although only cells were dropped in which the body certainly overlaps an obstacle, there is no motion: a proof.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt
import shapely

from geometry.cspace.bottleneck import Bottleneck, helps, missing_width, neck_near
from geometry.cspace.solver import Inside, MotionSolver
from geometry.kernels.arrays import Floats
from geometry.motion.body import new_mover
from geometry.motion.obstacle_field import ObstacleField
from geometry.motion.se2 import Motion, Pose, Translate
from geometry.motion.validation import check

__all__ = ["Inside", "MotionPlan", "plan_motion"]

FIRST, CAPACITY = 100_000, 400_000  # cells: enough for margins of a few times the resolution; and for wide rooms
AGAIN = 0.25  # of the resolution, when it is asked again with more cells
COARSE, FEW = 4e-4, 40_000  # resolution and cells for the missing width at first


@dataclass(frozen=True)
class MotionQuery:
    """What plan_motion was asked, and how far its search got.

    reached : (n, 2) where the middle of the body's greatest inscribed disc came to, the start first. goals : the pixels
    of the floor's raster that are its goal.
    """

    shape: Any
    floor: ObstacleField
    start: Pose
    goal: "Pose | Inside"
    points: Sequence[tuple[float, float]]
    radius: float
    reached: Floats
    goals: npt.NDArray[np.bool_]

    @cached_property
    def solid(self) -> Any:
        """All obstacles, as one geometry."""
        return shapely.union_all(self.floor.polygons)

    def among(self, walls: Any, at_length: bool) -> str:
        """The status of the same question with less wall: what was wall is part of a goal that it borders on.

        at_length : with as many cells as the question itself, rather than with a few.
        """
        floor, goal = ObstacleField(walls, self.floor.bounds.tolist()), self.goal
        if isinstance(goal, Inside):
            opened = self.solid.difference(walls)
            goal = Inside([shapely.union_all([part, opened]) for part in shapely.get_parts(goal.polygon)])
        cells = CAPACITY if at_length else FEW
        return plan_motion(self.shape, floor, self.start, goal, None, COARSE, self.points, cells).status


@dataclass(frozen=True)
class MotionPlan:
    """What plan_motion found.

    Attributes
    ----------
    status : "found", "impossible" (proved) or "limit" (not decided at the resolution or within the cells allowed).
    motions : Translate and Rotate from start to goal, each free by exact first contact; () unless found.
    poses : Pose of the reference point before, between and after the motions; () unless found.
    cells : how many cells were looked at; rounds : how many chains.
    resolution : the least size of a cell, in squares.
    reason : "start", "goal" when impossible because the body overlaps an obstacle there; else "".
    track : (n, 3) the way before it was shortened: x, y, radians of the centre that the body is turned about.
    question : what was asked, for passage and missing; None unless impossible.
    """

    status: str
    motions: tuple[Motion, ...] = ()
    poses: tuple[Pose, ...] = ()
    cells: int = 0
    rounds: int = 0
    resolution: float = 0.0
    reason: str = ""
    track: Floats = field(default_factory=lambda: np.empty((0, 3)), repr=False, compare=False)
    question: MotionQuery | None = field(default=None, repr=False, compare=False)

    @cached_property
    def passage(self) -> Bottleneck | None:
        """The neck that is too narrow; None unless impossible for want of one. Worked out when asked for."""
        q = self.question
        return None if q is None else neck_near(q.floor, q.goals, q.reached, q.radius)

    @cached_property
    def opens(self) -> bool:
        """Would widening the passage alone help? Worked out when asked for."""
        q, neck = self.question, self.passage
        return q is not None and neck is not None and helps(q.solid, neck, q.radius, q.among)

    @cached_property
    def missing(self) -> float:
        """How much wider the passage must be, in squares, to about 0.03: a second or so of work when asked for.

        nan unless there is a passage; inf when widening that passage alone does not help.
        """
        q, neck = self.question, self.passage
        if q is None or neck is None:
            return math.nan
        return missing_width(q.solid, neck, q.radius, q.among) if self.opens else math.inf

    @cached_property
    def length(self) -> float:
        """The way of the reference point, in squares; nan unless found."""
        if self.status != "found":
            return math.nan
        return sum(_way(motion, pose) for motion, pose in zip(self.motions, self.poses, strict=False))


def _way(motion: Motion, pose: Pose) -> float:
    """How far a motion takes the reference point."""
    if isinstance(motion, Translate):
        return math.hypot(motion.dx, motion.dy)
    return abs(math.radians(motion.degrees)) * math.dist((pose.x, pose.y), motion.about)


def plan_motion(
    shape: Any,
    obstacles: Any,
    start: Pose,
    goal: Pose | Inside,
    bounds: Sequence[float] | None = None,
    resolution: float = 2e-4,
    points: Sequence[tuple[float, float]] = (),
    cells: int = CAPACITY,
    pivot: tuple[float, float] | None = None,
) -> MotionPlan:
    """Find how to move a polygon among polygons from a pose to a goal, or prove that it cannot be done.

    Parameters
    ----------
    shape : shapely Polygon or MultiPolygon whose reference point is the origin, in squares.
    obstacles : any shapely geometry, a sequence of them, or a ObstacleField prepared for many calls (bounds are
    then its own).
    start : Pose of the reference point. The body may touch obstacles there.
    goal : Pose, or Inside(polygon).
    bounds : (x0, y0, x1, y1) of the reference point; None for the box around obstacles, start and goal.
    resolution : cells smaller than this times the bounds' greater side are not split.
    points : (x, y) in the body's own frame that move with it and must not enter obstacles, such as Utak.
    cells : no more than so many cells are looked at. When that is more than FIRST, what is not decided with FIRST cells
        is asked once more with all of them, and AGAIN times the resolution.
    pivot : (x, y) in the body's own frame that it is turned about in every motion; None for what is quickest.

    Returns
    -------
    MotionPlan

    Raises
    ------
    ValueError : when the body has no area, a number is not finite, or a coordinate is beyond ten million squares; and
        when the body is smaller than the smallest cell, a quarter of the resolution, in a passage that the disc about
        it does not fit through and the disc within it does: that no cell can tell.
    """
    for name, pose in (("start", start), ("goal", goal)):
        if isinstance(pose, Pose):
            check(pose[:2], name)
            if not math.isfinite(pose.degrees):
                raise ValueError(f"{name} must be finite")
    mover = new_mover(shape, points, pivot)
    floor = (
        obstacles
        if isinstance(obstacles, ObstacleField)
        else ObstacleField(obstacles, _bounds(obstacles, start, goal, bounds))
    )
    problem = MotionSolver(mover, floor, start, goal, resolution, min(cells, FIRST))
    for name, pose in (("start", start), ("goal", goal)):
        if isinstance(pose, Pose) and not floor.has_room(mover, shape, points, pose):
            return MotionPlan("impossible", resolution=problem.least, reason=name)
    status, motions = problem.solve()
    if status == "limit" and cells > FIRST:
        problem = MotionSolver(mover, floor, start, goal, AGAIN * resolution, cells)
        status, motions = problem.solve()
    if status == "limit" and problem.small:
        status, motions = problem.by_discs()
    poses = [start] if status == "found" else []
    for motion in motions:
        poses.append(motion.pose(poses[-1]))
    asked = None
    if status == "impossible":
        asked = MotionQuery(shape, floor, start, goal, tuple(points), mover.radius, problem.reached(), problem.goals)
    looked = int(problem.tree.used[0])
    return MotionPlan(status, motions, tuple(poses), looked, problem.rounds, problem.least, "", problem.track, asked)


def _bounds(obstacles: Any, start: Pose, goal: Pose | Inside, bounds: Sequence[float] | None) -> Sequence[float]:
    """The bounds given, or the box around all there is."""
    if bounds is not None:
        return bounds
    several = list(obstacles) if isinstance(obstacles, list | tuple) else [obstacles]
    ends = [goal.polygon] if isinstance(goal, Inside) else [shapely.Point(goal.x, goal.y)]
    around = shapely.total_bounds([*several, shapely.Point(start.x, start.y).buffer(1.0), *ends])
    return [float(v) for v in around]
