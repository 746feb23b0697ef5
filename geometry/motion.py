"""Planning the motion of a polygon among polygons: certified when found, proved when impossible.

    plan = plan_motion(shape, obstacles, Pose(2, 2, 0), Pose(9, 5, 90))

# Strategy: poses are searched in cells that are split only along the way (geometry.cells, geometry.chain). A chain of
# cells from start to goal is an optimist's plan. Its hops are checked by exact first contact; where one fails the cells
# to blame are split and the search goes on. A chain all of whose hops are free is a motion. When there is no chain left
# although only cells were dropped in which the body certainly overlaps an obstacle, there is no motion: a proof.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt
import shapely

from geometry.bottleneck import Neck, missing_width, neck_near
from geometry.cells import Tree, leaf_at, new_tree
from geometry.chain import REGION, SETTLED, Hunt, find_chain, new_hunt
from geometry.floor import Floor
from geometry.follow import Scene, Way, follow
from geometry.mover import centre_pose, new_mover, reference_pose
from geometry.rigid import Motion, Pose, Translate
from geometry.separation import Ground, Mover
from geometry.shorten import motions_along, shorten

Floats = npt.NDArray[np.float64]
CAPACITY = 300_000  # cells
COARSE, FEW = 1e-3, 40_000  # resolution and cells for the missing width


@dataclass(frozen=True)
class Inside:
    """A goal: the whole body within a polygon, at any place and angle.

    polygon : shapely Polygon or MultiPolygon, table frame.
    """

    polygon: Any


@dataclass(frozen=True)
class Question:
    """What plan_motion was asked, and where its search was stuck: the place nearest to the goal that it got to.

    stuck : (x, y) of the middle of the body's greatest inscribed disc. ways : what is left to go from every pixel.
    """

    shape: Any
    floor: Floor
    start: Pose
    goal: "Pose | Inside"
    points: Sequence[tuple[float, float]]
    radius: float
    stuck: tuple[float, float]
    ways: Floats


@dataclass(frozen=True)
class Plan:
    """What plan_motion found.

    Attributes
    ----------
    status : "found", "impossible" (proved) or "limit" (not decided at the resolution or within the cells allowed).
    motions : Translate and Rotate from start to goal, each free by exact first contact; () unless found.
    poses : Pose of the reference point before, between and after the motions; () unless found.
    cells : how many cells were looked at; rounds : how many chains.
    resolution : the least size of a cell, in squares.
    reason : "start", "goal" when impossible because the body overlaps an obstacle there; else "".
    question : what was asked, for passage and missing; None unless impossible.
    """

    status: str
    motions: tuple[Motion, ...] = ()
    poses: tuple[Pose, ...] = ()
    cells: int = 0
    rounds: int = 0
    resolution: float = 0.0
    reason: str = ""
    question: Question | None = field(default=None, repr=False, compare=False)

    @cached_property
    def passage(self) -> Neck | None:
        """The neck that is too narrow; None unless impossible for want of one. Worked out when asked for."""
        q = self.question
        return None if q is None else neck_near(q.floor, q.ways, (q.start.x, q.start.y), q.stuck, q.radius)

    @cached_property
    def missing(self) -> float:
        """How much wider the passage must be, in squares, to about 0.02: a second or so of work when asked for.

        nan unless there is a passage; inf when widening that passage alone does not help.
        """
        q, neck = self.question, self.passage
        if q is None or neck is None:
            return math.nan

        def passes(walls: Any) -> bool:
            floor = Floor(walls, q.floor.bounds.tolist())
            return plan_motion(q.shape, floor, q.start, q.goal, None, COARSE, q.points, FEW).status == "found"

        return missing_width(shapely.union_all(q.floor.polygons), neck, q.radius, passes)

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
) -> Plan:
    """Find how to move a polygon among polygons from a pose to a goal, or prove that it cannot be done.

    Parameters
    ----------
    shape : shapely Polygon or MultiPolygon whose reference point is the origin, in squares.
    obstacles : any shapely geometry, a sequence of them, or a Floor prepared for many calls (bounds are then its own).
    start : Pose of the reference point. The body may touch obstacles there.
    goal : Pose, or Inside(polygon).
    bounds : (x0, y0, x1, y1) of the reference point; None for the box around obstacles, start and goal.
    resolution : cells smaller than this times the bounds' greater side are not split.
    points : (x, y) in the body's own frame that move with it and must not enter obstacles, such as Utak.
    cells : no more than so many cells are looked at.

    Returns
    -------
    Plan

    Raises
    ------
    ValueError : when the body has no area, or a number is not finite.
    """
    mover = new_mover(shape, points)
    floor = obstacles if isinstance(obstacles, Floor) else Floor(obstacles, _bounds(obstacles, start, goal, bounds))
    problem = _Problem(mover, floor, start, goal, resolution, cells)
    for name, pose in (("start", start), ("goal", goal)):
        if isinstance(pose, Pose) and not floor.has_room(shape, points, pose):
            return Plan("impossible", resolution=problem.least, reason=name)
    plan = problem.solve()
    if plan.status != "impossible":
        return plan
    asked = Question(shape, floor, start, goal, tuple(points), mover.radius, problem.stuck(), problem.hunt.ways)
    return replace(plan, question=asked)


def _bounds(obstacles: Any, start: Pose, goal: Pose | Inside, bounds: Sequence[float] | None) -> Sequence[float]:
    """The bounds given, or the box around all there is."""
    if bounds is not None:
        return bounds
    several = list(obstacles) if isinstance(obstacles, list | tuple) else [obstacles]
    ends = [goal.polygon] if isinstance(goal, Inside) else [shapely.Point(goal.x, goal.y)]
    around = shapely.total_bounds([*several, shapely.Point(start.x, start.y).buffer(1.0), *ends])
    return [float(v) for v in around]


class _Problem:
    """One planning problem on its way to a Plan."""

    def __init__(
        self, mover: Mover, floor: Floor, start: Pose, goal: Pose | Inside, resolution: float, cells: int
    ) -> None:
        self.mover, self.floor = mover, floor
        self.start = centre_pose(mover, start)
        self.ground = floor.ground(mover)
        self.least = resolution * floor.side
        if not np.all(np.isfinite(self.start)) or not self.least > 0.0:
            raise ValueError("start and resolution must be finite, the resolution positive")
        self.end, self.region, goals = self._goal(goal)
        reach = float(np.hypot(*mover.reference))
        corner, side = floor.bounds[:2] - reach, floor.side + 2 * reach
        self.tree: Tree = new_tree(corner[0], corner[1], side * (1 + 1e-9), mover.radius, self.least, cells)
        eye = mover.probes[0]
        self.hunt: Hunt = new_hunt(cells, floor.ways(goals, float(eye[2])), eye[:2].copy())

    def _goal(self, goal: Pose | Inside) -> tuple[Floats, Ground, npt.NDArray[np.bool_]]:
        """The pose to end at (empty for a region), the region's complement as ground, and the goal's pixels."""
        if isinstance(goal, Pose):
            end = centre_pose(self.mover, goal)
            if not np.all(np.isfinite(end)):
                raise ValueError("goal must be finite")
            c, s = math.cos(end[2]), math.sin(end[2])
            px, py = self.mover.probes[0, :2]
            return end, self.ground, self.floor.pixel_of(end[0] + c * px - s * py, end[1] + s * px + c * py)
        outer = shapely.box(*self.floor.bounds).buffer(self.floor.side, join_style="mitre")
        region = Floor(outer.difference(goal.polygon), self.floor.bounds.tolist())
        goals = region.raster >= self.mover.probes[0, 2] - region.frame[2]
        return np.empty(0), region.ground(self.mover), goals

    def solve(self) -> Plan:
        """Search and split until there is an answer."""
        scene = Scene(self.mover, self.ground, self.region, self.floor.surface)
        way = Way(np.empty((2 * len(self.tree.child) + 2, 3)), np.ones(1, np.int64), self.end)
        way.poses[0] = self.start
        rounds = 0
        while True:
            rounds += 1
            length = self._chain(rounds, False)
            if length == 0:
                break
            if follow(self.tree, scene, self.hunt, length, way) == 0:
                return self._found(way.poses[: way.used[0]], rounds)
        lost = bool(self.hunt.size[1])
        self.hunt.seen[0] = self.hunt.size[0] = 0
        undecided = lost or self._chain(rounds + 1, True) > 0
        return self._plan("limit" if undecided else "impossible", rounds)

    def _chain(self, nth: int, dead: bool) -> int:
        first = leaf_at(self.tree, *self.start)
        last = leaf_at(self.tree, *self.end) if len(self.end) else REGION
        if first < 0 or last == -1:
            return 0
        return find_chain(self.tree, self.mover, self.ground, self.region, self.hunt, first, last, nth, dead)

    def stuck(self) -> tuple[float, float]:
        """The place of the greatest inscribed disc's middle in the settled cell that is nearest to the goal."""
        known = self.hunt.seen[0]
        settled = np.nonzero((self.hunt.state[:known] >= SETTLED) & (self.tree.child[:known] < 0))[0]
        if len(settled) == 0:
            return float(self.start[0]), float(self.start[1])
        x, y, angle = self.tree.middle[settled[np.argmin(self.hunt.guess[settled])]]
        c, s, (px, py) = math.cos(angle), math.sin(angle), self.hunt.eye
        return float(x + c * px - s * py), float(y + s * px + c * py)

    def _found(self, poses: Floats, rounds: int) -> Plan:
        ways = shorten(self.mover, self.ground, self.floor.surface, poses)
        motions = motions_along(self.mover, self.ground, self.floor.surface, ways)
        return self._plan("found", rounds, motions)

    def _plan(self, status: str, rounds: int, motions: tuple[Motion, ...] = (), reason: str = "") -> Plan:
        poses = [reference_pose(self.mover, self.start)] if status == "found" else []
        for motion in motions:
            poses.append(motion.pose(poses[-1]))
        return Plan(status, motions, tuple(poses), int(self.tree.used[0]), rounds, self.least, reason)
