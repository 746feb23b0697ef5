"""One planning problem: chains are sought and followed, cells split, until one is free or none is left."""

import math
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt
import shapely

from geometry.cspace.cell_tree import CellTree, new_tree
from geometry.cspace.channel import SETTLED, ChannelSearch, new_hunt
from geometry.cspace.disc_bounds import cannot_pass, way_of_disc
from geometry.cspace.local_planner import BLOCKED, HopContext, hop, new_scene
from geometry.cspace.refine import new_way
from geometry.cspace.rounds import FOUND, MORE, next_chain, pursue
from geometry.cspace.smoothing import loosened, motions_along, shorten
from geometry.kernels.arrays import Floats
from geometry.motion.body import centre_pose
from geometry.motion.cell_clearance import OPEN, MovingBody, NearbyEdges
from geometry.motion.obstacle_field import ObstacleField
from geometry.motion.se2 import Motion, Pose
from geometry.motion.validation import sound

FEW = 20  # cells: a body fewer across is decided by its discs where the cells leave it open
ROUNDS = 64  # at a stretch: between two, the user may interrupt


@dataclass(frozen=True)
class Inside:
    """A goal: the whole body within a polygon, or one of several, at any place and angle.

    polygons : shapely Polygon or MultiPolygon, or a sequence of them, table frame. They should not overlap.
    """

    polygons: Any

    @cached_property
    def polygon(self) -> Any:
        """All of them as one shapely geometry; those that touch stay apart. ValueError when a number is not finite."""
        several = self.polygons if isinstance(self.polygons, list | tuple) else [self.polygons]
        parts = [part for each in several for part in shapely.get_parts(sound(each, "the goal"))]
        return parts[0] if len(parts) == 1 else shapely.MultiPolygon(parts)


class MotionSolver:
    """One planning problem on its way to a Plan."""

    def __init__(
        self, mover: MovingBody, floor: ObstacleField, start: Pose, goal: Pose | Inside, resolution: float, cells: int
    ) -> None:
        self.mover, self.floor = mover, floor
        self.start = centre_pose(mover, start)
        self.ground = floor.ground(mover)
        self.least = resolution * floor.side
        self.rounds = 0
        self.track = np.empty((0, 3))
        if not 0.0 < self.least < math.inf or cells < 1:
            raise ValueError("the resolution must be positive and finite, and there must be a cell at least")
        self.end, self.region, self.goals = self._goal(goal)
        self.told = self.start, self.end  # the search may begin and end a little off, where there is more room
        self.within = goal.polygon if isinstance(goal, Inside) else None
        reach = float(np.hypot(*mover.reference))
        corner, side = floor.bounds[:2] - reach, floor.side + 2 * reach
        self.tree: CellTree = new_tree(corner[0], corner[1], side * (1 + 1e-9), mover.radius, self.least, cells)

    @cached_property
    def hunt(self) -> ChannelSearch:
        """The search, with its guess of the way left."""
        eye = self.mover.probes[0]
        return new_hunt(len(self.tree.child), self.floor.ways(self.goals, float(eye[2])), eye[:2].copy())

    def _goal(self, goal: Pose | Inside) -> tuple[Floats, NearbyEdges, npt.NDArray[np.bool_]]:
        """The pose to end at (empty for a region), the region's complement as ground, and the goal's pixels."""
        if isinstance(goal, Pose):
            end = centre_pose(self.mover, goal)
            c, s = math.cos(end[2]), math.sin(end[2])
            px, py = self.mover.probes[0, :2]
            return end, self.ground, self.floor.pixel_of(end[0] + c * px - s * py, end[1] + s * px + c * py)
        region = self.floor.around(goal.polygon)
        room = min(float(self.mover.probes[0, 2]) - region.frame[2], float(region.raster.max()))
        goals = region.raster >= room  # where the region is too narrow for the body, its widest place
        return np.empty(0), region.ground(self.mover), goals

    def solve(self) -> tuple[str, tuple[Motion, ...]]:
        """Search and split until there is an answer: the status of a Plan, and its motions."""
        scene = self._scene()
        straight = np.array([self.start, self.end]) if len(self.end) else None
        if straight is not None and hop(scene, *straight) != BLOCKED:
            self.track = straight
            return "found", motions_along(scene, straight)
        start, end = self.start, self.end
        self.start = loosened(scene, start, True)
        self.end = loosened(scene, end, False) if len(end) else end
        way = new_way(self.start, self.end, len(self.tree.child))
        outcome = MORE
        while outcome == MORE:
            asked = self.tree, scene, self.region, self.hunt, way, self.rounds + 1, self.rounds + ROUNDS
            outcome, self.rounds = pursue(*asked)
        if outcome == FOUND:
            self.track = np.vstack([start, way.poses[: way.used[0]], end.reshape(-1, 3)])
            return "found", motions_along(scene, shorten(scene, self.track))
        lost = bool(self.hunt.size[1])
        self.hunt.seen[0] = self.hunt.size[0] = 0
        self.rounds += 1
        lost = lost or next_chain(self.tree, scene, self.region, self.hunt, way, self.rounds, True) > 0
        return "limit" if lost else "impossible", ()

    @property
    def small(self) -> bool:
        """Whether the body is so few cells across that they tell little of it."""
        return 2.0 * self.mover.radius < FEW * self.least

    def by_discs(self) -> tuple[str, tuple[Motion, ...]]:
        """Decide what cells left open by the discs within and about the body: the status, and the motions.

        Raises
        ------
        ValueError : when that decides nothing either and the body is smaller than a cell.
        """
        reach, eye = float(np.hypot(*self.mover.reference)), math.hypot(*self.mover.probes[0, :2].tolist())
        outward = np.array([-1.0, -1.0, 1.0, 1.0])
        goal = shapely.Point(self._eye(self.told[1])) if len(self.end) else self.within
        obstacles = shapely.union_all(self.floor.polygons)
        inner = float(self.mover.probes[0, 2])
        if cannot_pass(obstacles, inner, self.floor.bounds + (reach + eye) * outward, self._eye(self.told[0]), goal):
            return "impossible", ()
        poses = self._way_by_disc(obstacles, self.floor.bounds - reach * outward) if len(self.end) else None
        if poses is not None:
            self.track = poses
            return "found", motions_along(self._scene(), poses)
        if 2.0 * self.mover.radius < self.least:
            raise ValueError(
                f"the body is {2.0 * self.mover.radius:g} squares across, and the smallest cells {self.least:g}: "
                "ask with a finer resolution or within narrower bounds"
            )
        return "limit", ()

    def _way_by_disc(self, obstacles: Any, bounds: Floats) -> Floats | None:
        """Poses from start to goal by way of where the enclosing disc fits, each hop free; None when not found so."""
        if bounds[2] <= bounds[0] or bounds[3] <= bounds[1]:
            return None
        start, end = ((float(pose[0]), float(pose[1])) for pose in (self.start, self.end))
        way = way_of_disc(obstacles, self.mover.radius, bounds, start, end)
        if way is None:
            return None
        turned = [(x, y, float(self.start[2])) for x, y in way]
        poses = np.array([self.told[0], *turned, self.end, self.told[1]])
        scene = self._scene()
        return None if any(hop(scene, a, b) == BLOCKED for a, b in pairwise(poses)) else poses

    def _scene(self) -> HopContext:
        """The body among the obstacles, for exact first contact."""
        return new_scene(self.mover, self.ground, self.floor.surface)

    def _eye(self, pose: Floats) -> tuple[float, float]:
        """Where the middle of the greatest inscribed disc is at a pose."""
        x, y, angle = pose.tolist()
        px, py = self.mover.probes[0, :2].tolist()
        c, s = math.cos(angle), math.sin(angle)
        return x + c * px - s * py, y + s * px + c * py

    def reached(self) -> Floats:
        """Where the middle of the body's greatest inscribed disc got to: (n, 2), the start first.

        These are the middles of cells; one in which the body overlaps something may be anywhere beside a wall.
        """
        known = self.hunt.seen[0]
        leaf, free = self.tree.child[:known] < 0, self.tree.kind[:known] <= OPEN
        settled = np.nonzero((self.hunt.state[:known] >= SETTLED) & leaf & free)[0]
        x, y, angle = np.vstack([self.start, self.tree.middle[settled]]).T
        c, s, (px, py) = np.cos(angle), np.sin(angle), self.hunt.eye
        return np.column_stack([x + c * px - s * py, y + s * px + c * py])
