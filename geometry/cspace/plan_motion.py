"""Motion planning of a polygon among polygons: certified when found, proved when impossible.

    plan = plan_motion(shape, obstacles, Pose(2, 2, 0), Pose(9, 5, 90))

# Strategy: poses are searched in cells that are split only along the way (cell_tree, channel). A channel, a chain of
# cells from start to goal, is an optimistic plan. Its hops are checked by exact first contact. Where one fails the
cells # to blame are split and the search goes on. A channel all of whose hops are free is a motion. When no channel is
left # although only cells were dropped in which the body certainly overlaps an obstacle, there is no motion: a proof.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from dataclasses import field as dataclass_field
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt
import shapely

from utak.geometry.cspace.bottleneck import Bottleneck, find_bottleneck, missing_width, status_when_wide
from utak.geometry.cspace.solver import Inside, MotionSolver
from utak.geometry.kernels.arrays import Floats
from utak.geometry.motion.body import new_moving_body
from utak.geometry.motion.obstacle_field import ObstacleField
from utak.geometry.motion.se2 import Motion, Pose, Translate
from utak.geometry.motion.validation import require_bounded

__all__ = ["Inside", "MotionPlan", "plan_motion"]

# All are tuned on random worlds (benchmarks.campaign).
FIRST_CELLS = 100_000  # cells of the first search: enough for margins of a few times the resolution
MAX_CELLS = 400_000  # cells of the second search: enough for wide rooms
RETRY_RESOLUTION = 0.25  # resolution of the second search as a part of the first's
WIDENING_RESOLUTION = 4e-4  # resolution of the searches for the missing width


@dataclass(frozen=True)
class MotionQuery:
    """A question to plan_motion that was answered "impossible", and how far its search got."""

    shape: Any  # as in plan_motion; `field` are the obstacles prepared
    field: ObstacleField
    start: Pose
    goal: "Pose | Inside"
    points: Sequence[tuple[float, float]]
    radius: float  # radius of the body about its centre, squares
    # (n, 2) x, y in squares, table frame, where the centre of the body's largest inscribed disc came to, the start
    # first
    reached: Floats
    # (rows, columns) bool, pixels of the field's raster (row 0 in the south) that are the goal
    goals: npt.NDArray[np.bool_]

    @cached_property
    def solid(self) -> Any:
        """Return all obstacles as one shapely geometry, squares, table frame. Computed at first use."""
        return shapely.union_all(self.field.polygons)

    def status_among(self, walls: Any, cells: int) -> tuple[str, int]:
        """Return the status of the same question among other, smaller obstacles, and the number of cells it took."""
        field, goal = ObstacleField(walls, self.field.bounds.tolist()), self.goal
        if isinstance(goal, Inside):
            opened = self.solid.difference(walls)
            goal = Inside([shapely.union_all([part, opened]) for part in shapely.get_parts(goal.polygon)])
        plan = plan_motion(self.shape, field, self.start, goal, None, WIDENING_RESOLUTION, self.points, cells)
        return plan.status, plan.cells


@dataclass(frozen=True)
class MotionPlan:
    """The answer of plan_motion.

    Attributes
    ----------
    status : "found", "impossible" (proved) or "limit" (not decided at the resolution or within the cells allowed).
    motions : Translate and Rotate from start to goal, in order, table frame, each free by exact first contact; ()
        unless found.
    poses : Pose of the reference point, table frame, before, between and after the motions (one more than motions); ()
        unless found.
    cells : number of cells made.
    rounds : number of channels (chains of cells from start to goal) looked at.
    resolution : size of the smallest cells, squares.
    reason : "start" or "goal" if impossible because the body overlaps an obstacle or is out of bounds there; else "".
    track : (n, 3) the path before smoothing: x, y in squares, table frame, radians, of the body's centre; (0, 3) unless
        found.
    question : what was asked, for `passage` and `missing`; None unless impossible for another reason than start or
        goal.
    """

    status: str
    motions: tuple[Motion, ...] = ()
    poses: tuple[Pose, ...] = ()
    cells: int = 0
    rounds: int = 0
    resolution: float = 0.0
    reason: str = ""
    track: Floats = dataclass_field(default_factory=lambda: np.empty((0, 3)), repr=False, compare=False)
    question: MotionQuery | None = dataclass_field(default=None, repr=False, compare=False)

    @cached_property
    def passage(self) -> Bottleneck | None:
        """Return the bottleneck that is too narrow; None unless impossible for want of one. Computed at first use.

        Its middle (x, y), the two points (x, y) of obstacles that make it and their distance, in squares, table frame.
        """
        query = self.question
        return None if query is None else find_bottleneck(query.field, query.goals, query.reached, query.radius)

    @cached_property
    def when_wide(self) -> str:
        """Return the status if the passage alone were wide: "found", "impossible", or "limit" where that is undecided.

        "impossible" without a passage, too. Computed at first use.
        """
        query, bottleneck = self.question, self.passage
        if query is None or bottleneck is None:
            return "impossible"
        return status_when_wide(query.solid, bottleneck, query.radius, query.status_among)

    @property
    def opens(self) -> bool:
        """Return whether widening the passage alone surely makes the motion possible. Computed at first use."""
        return self.when_wide == "found"

    @property
    def missing(self) -> float:
        """Return about how much wider the passage must be, in squares, as `missing_between` holds it.

        inf if widening that passage alone does not suffice; nan if that is undecided, or there is no passage.
        """
        return self.missing_between[1]

    @cached_property
    def missing_between(self) -> tuple[float, float, float]:
        """Return how much wider the passage must be: more than the first number, about the second, at most the third.

        In squares. They differ by about 0.02 where the search decides that. All nan if there is no passage, all inf if
        widening that passage alone does not suffice, (0, nan, inf) where that is undecided. Computed at first use.
        """
        query, bottleneck = self.question, self.passage
        if query is None or bottleneck is None:
            return (math.nan,) * 3
        if not self.opens:
            return (0.0, math.nan, math.inf) if self.when_wide == "limit" else (math.inf,) * 3
        return missing_width(query.solid, bottleneck, query.radius, query.status_among)

    @cached_property
    def length(self) -> float:
        """Return the length of the path of the reference point, in squares, arcs included; nan unless found."""
        if self.status != "found":
            return math.nan
        return sum(_path_length(motion, pose) for motion, pose in zip(self.motions, self.poses, strict=False))


def _path_length(motion: Motion, pose: Pose) -> float:
    """Return how far a motion takes a reference point that is at `pose` before it, in squares; of a turn the arc."""
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
    cells: int = MAX_CELLS,
    pivot: tuple[float, float] | None = None,
) -> MotionPlan:
    """Find how to move a polygon among polygons from a pose to a goal, or prove that it cannot be done.

    Parameters
    ----------
    shape : shapely Polygon or MultiPolygon whose reference point is the origin, in squares, body frame.
    obstacles : any shapely geometry, a list of them, or an ObstacleField prepared for many calls (whose bounds then
        hold). Squares, table frame.
    start : Pose of the reference point, table frame. The body may touch obstacles there.
    goal : Pose of the reference point, table frame, or Inside(polygon) for the whole body in a region.
    bounds : (x0, y0, x1, y1) of the reference point, squares, table frame; None for the bounding box of obstacles,
        start and goal.
    resolution : cells smaller than this times the bounds' longer side are not split.
    points : (x, y) in the body's own frame that move with it and must not enter obstacles, such as Utak.
    cells : upper bound on the number of cells. If it is more than FIRST_CELLS, what is not decided with FIRST_CELLS
        cells is asked once more with all of them and RETRY_RESOLUTION times the resolution.
    pivot : (x, y) in the body's own frame that it is turned about in every motion; None for the centre of the smallest
        enclosing circle, which is quickest.

    Returns
    -------
    MotionPlan : its status is "found", "impossible" (proved) or "limit" (not decided). When found it holds the motions
        in order and the poses of the reference point between them, squares and degrees, table frame; when impossible
        the reason ("start", "goal" or "") and, computed when asked for, the passage that is too narrow.

    Raises
    ------
    ValueError : the body has no area, a number is not finite, or a coordinate is beyond ten million squares. Also when
        the body is smaller than the smallest cell, a quarter of the resolution, and lies between its discs: the
        enclosing disc does not fit through a passage and the inscribed disc does, which no cell can decide.
    """
    for name, pose in (("start", start), ("goal", goal)):
        if isinstance(pose, Pose):
            require_bounded(pose[:2], name)
            if not math.isfinite(pose.degrees):
                raise ValueError(f"{name} must be finite")
    body = new_moving_body(shape, points, pivot)
    field = (
        obstacles
        if isinstance(obstacles, ObstacleField)
        else ObstacleField(obstacles, _bounds(obstacles, start, goal, bounds))
    )
    solver = MotionSolver(body, field, start, goal, resolution, min(cells, FIRST_CELLS))
    for name, pose in (("start", start), ("goal", goal)):
        if isinstance(pose, Pose) and not field.is_free_at(body, shape, points, pose):
            return MotionPlan("impossible", resolution=solver.min_cell, reason=name)
    status, motions = solver.solve()
    if status == "limit" and cells > FIRST_CELLS and not solver.is_proved_by_disc:
        solver = MotionSolver(body, field, start, goal, RETRY_RESOLUTION * resolution, cells)
        status, motions = solver.solve()
    if status == "limit" and (solver.is_proved_by_disc or solver.is_small):
        status, motions = solver.solve_by_discs()
    poses = [start] if status == "found" else []
    for motion in motions:
        poses.append(motion.pose(poses[-1]))
    query = None
    if status == "impossible":
        query = MotionQuery(
            shape, field, start, goal, tuple(points), body.radius, solver.reached_places(), solver.goals
        )
    cells_used = int(solver.tree.used[0])
    return MotionPlan(
        status, motions, tuple(poses), cells_used, solver.rounds, solver.min_cell, "", solver.track, query
    )


def _bounds(obstacles: Any, start: Pose, goal: Pose | Inside, bounds: Sequence[float] | None) -> Sequence[float]:
    """Return the bounds given, or the bounding box of obstacles, start and goal."""
    if bounds is not None:
        return bounds
    geometries = list(obstacles) if isinstance(obstacles, list | tuple) else [obstacles]
    ends = [goal.polygon] if isinstance(goal, Inside) else [shapely.Point(goal.x, goal.y)]
    around = shapely.total_bounds([*geometries, shapely.Point(start.x, start.y).buffer(1.0), *ends])
    return [float(v) for v in around]
