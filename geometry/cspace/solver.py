"""One planning problem: channels are sought and followed, cells split, until one is free or none is left."""

import math
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt
import shapely

from utak.geometry.cspace.cell_tree import CellTree, new_cell_tree
from utak.geometry.cspace.channel import NODE_SETTLED, ChannelSearch, new_channel_search
from utak.geometry.cspace.disc_bounds import disc_room, find_disc_path, is_cut_off
from utak.geometry.cspace.local_planner import BLOCKED, HopContext, hop, new_hop_context
from utak.geometry.cspace.refine import new_hop_sequence
from utak.geometry.cspace.rounds import SEARCH_FOUND, SEARCH_UNFINISHED, next_channel, run_rounds
from utak.geometry.cspace.smoothing import motions_along, pose_with_room, shorten_path
from utak.geometry.kernels.arrays import Floats
from utak.geometry.motion.body import centre_pose
from utak.geometry.motion.cell_clearance import CELL_CENTRE_FREE, MovingBody, NearbyEdges
from utak.geometry.motion.obstacle_field import ObstacleField
from utak.geometry.motion.se2 import Motion, Pose
from utak.geometry.motion.validation import valid_polygons

SMALL_BODY_CELLS = 20  # cells: a body of fewer across is decided by its discs if the cells do not decide; a convention
ROUNDS_PER_CALL = 64  # rounds in one kernel call; between two calls the user may interrupt; a convention


@dataclass(frozen=True)
class Inside:
    """A goal: the whole body within a polygon, or within one of several, at any place and angle.

    Attributes
    ----------
    polygons : shapely Polygon or MultiPolygon, or a sequence of them, squares, table frame. They should not overlap.
    """

    polygons: Any

    @cached_property
    def polygon(self) -> Any:
        """Return all polygons as one valid shapely Polygon or MultiPolygon; those that touch stay separate parts.

        Squares, table frame. Computed at first use.

        Raises
        ------
        ValueError : a coordinate is not finite or too large.
        """
        several = self.polygons if isinstance(self.polygons, list | tuple) else [self.polygons]
        parts = [part for each in several for part in shapely.get_parts(valid_polygons(each, "the goal"))]
        return parts[0] if len(parts) == 1 else shapely.MultiPolygon(parts)


class MotionSolver:
    """One planning problem on its way to a MotionPlan."""

    def __init__(
        self, body: MovingBody, field: ObstacleField, start: Pose, goal: Pose | Inside, resolution: float, cells: int
    ) -> None:
        self.body, self.field = body, field
        self.start = centre_pose(body, start)
        self.nearby = field.ground(body)
        self.min_cell = resolution * field.side
        self.rounds = 0
        self.track = np.empty((0, 3))
        self._decided_by_disc = False
        if not 0.0 < self.min_cell < math.inf or cells < 1:
            raise ValueError("the resolution must be positive and finite, and there must be a cell at least")
        self.end, self.region, self.goals = self._goal(goal)
        self.ends = self.start, self.end  # the search may begin and end a little off, where there is more room
        self.goal_region = goal.polygon if isinstance(goal, Inside) else None
        offset = float(np.hypot(*body.reference))
        corner, side = field.bounds[:2] - offset, field.side + 2 * offset
        self.tree: CellTree = new_cell_tree(corner[0], corner[1], side * (1 + 1e-9), body.radius, self.min_cell, cells)

    @cached_property
    def search(self) -> ChannelSearch:
        """Return the search among the cells, with its estimates of the length to go; made at first use, then kept."""
        largest = self.body.probes[0]
        distances = self.field.disc_distances(self.goals, float(largest[2]))
        return new_channel_search(len(self.tree.child), distances, largest[:2].copy())

    def _goal(self, goal: Pose | Inside) -> tuple[Floats, NearbyEdges, npt.NDArray[np.bool_]]:
        """Return the pose to end at, the complement of the goal region as obstacles, and the goal's pixels."""
        # The pixels are a bool mask (rows, columns) of the field's raster, for the centre of the body's largest
        # inscribed disc.
        if isinstance(goal, Pose):
            end = centre_pose(self.body, goal)
            c, s = math.cos(end[2]), math.sin(end[2])
            px, py = self.body.probes[0, :2]
            return end, self.nearby, self.field.pixel_mask(end[0] + c * px - s * py, end[1] + s * px + c * py)
        region = self.field.complement_of(goal.polygon)
        room = min(float(self.body.probes[0, 2]) - region.frame[2], float(region.raster.max()))
        goals = region.raster >= room  # where the region is too narrow for the body, its widest place
        return np.empty(0), region.ground(self.body), goals

    def solve(self) -> tuple[str, tuple[Motion, ...]]:
        """Search and split until there is an answer; return the status of a MotionPlan and its motions."""
        # "found" with the motions in order (Translate and Rotate, table frame, squares and degrees); "impossible"
        # (proved) or "limit" (cells were given up) with ().
        context = self._hop_context()
        direct = np.array([self.start, self.end]) if len(self.end) else None
        if direct is not None and hop(context, *direct) != BLOCKED:
            self.track = direct
            return "found", motions_along(context, direct)
        start, end = self.start, self.end
        self.start = pose_with_room(context, start, True)
        self.end = pose_with_room(context, end, False) if len(end) else end
        hops = new_hop_sequence(self.start, self.end, len(self.tree.child))
        outcome = SEARCH_UNFINISHED
        while outcome == SEARCH_UNFINISHED:
            first, last = self.rounds + 1, self.rounds + ROUNDS_PER_CALL
            outcome, self.rounds = run_rounds(self.tree, context, self.region, self.search, hops, first, last)
        if outcome == SEARCH_FOUND:
            self.track = np.vstack([start, hops.poses[: hops.used[0]], end.reshape(-1, 3)])
            return "found", motions_along(context, shorten_path(context, self.track))
        given_up = bool(self.search.size[1])
        self.search.seen[0] = self.search.size[0] = 0
        self.rounds += 1
        given_up = given_up or next_channel(self.tree, context, self.region, self.search, hops, True) > 0
        return "limit" if given_up else "impossible", ()

    @property
    def is_small(self) -> bool:
        """Return whether the body is so few cells across (below SMALL_BODY_CELLS) that cells tell little about it."""
        return 2.0 * self.body.radius < SMALL_BODY_CELLS * self.min_cell

    @cached_property
    def is_proved_by_disc(self) -> bool:
        """Whether the disc within the body surely cannot pass, and so the body cannot; False proves nothing."""
        goal = shapely.Point(self._disc_centre_at(self.ends[1])) if len(self.end) else self.goal_region
        return is_cut_off(self._disc_room, goal)

    @cached_property
    def _disc_room(self) -> Any:
        """The floor for the centre of the disc within the body, at most: shapely geometry, squares, table frame."""
        obstacles, radius = shapely.union_all(self.field.polygons), float(self.body.probes[0, 2])
        bounds = self._bounds_grown_by(self._offset + math.hypot(*self.body.probes[0, :2].tolist()))
        return disc_room(obstacles, radius, bounds, self._disc_centre_at(self.ends[0]))

    @property
    def _offset(self) -> float:
        """The distance of the body's reference point from its centre, in squares."""
        return float(np.hypot(*self.body.reference))

    def _bounds_grown_by(self, squares: float) -> Floats:
        """Return the bounds of the field with so many squares more on each side: (4,) x0, y0, x1, y1."""
        return self.field.bounds + squares * np.array([-1.0, -1.0, 1.0, 1.0])

    def solve_by_discs(self) -> tuple[str, tuple[Motion, ...]]:
        """Decide, by the discs within and about the body, what the cells left undecided; return status and motions."""
        if self.is_proved_by_disc:
            self._decided_by_disc = True
            return "impossible", ()
        obstacles = shapely.union_all(self.field.polygons)
        poses = self._path_by_disc(obstacles, self._bounds_grown_by(-self._offset)) if len(self.end) else None
        if poses is not None:
            self.track = poses
            return "found", motions_along(self._hop_context(), poses)
        if 2.0 * self.body.radius < self.min_cell:
            raise ValueError(
                f"the body is {2.0 * self.body.radius:g} squares across, and the smallest cells {self.min_cell:g}: "
                "ask with a finer resolution or within narrower bounds"
            )
        return "limit", ()

    def _path_by_disc(self, obstacles: Any, bounds: Floats) -> Floats | None:
        """Return poses (n, 3) from start to goal where the enclosing disc fits between them; None if none are found."""
        if bounds[2] <= bounds[0] or bounds[3] <= bounds[1]:
            return None
        start, end = ((float(pose[0]), float(pose[1])) for pose in (self.start, self.end))
        corners = find_disc_path(obstacles, self.body.radius, bounds, start, end)
        if corners is None:
            return None
        disc_poses = [(x, y, float(self.start[2])) for x, y in corners]
        poses = np.array([self.ends[0], *disc_poses, self.end, self.ends[1]])
        context = self._hop_context()
        return None if any(hop(context, a, b) == BLOCKED for a, b in pairwise(poses)) else poses

    def _hop_context(self) -> HopContext:
        """Return the body, the obstacle edges by place and the surface that it must not cross, squares, table frame."""
        return new_hop_context(self.body, self.nearby, self.field.surface)

    def _disc_centre_at(self, pose: Floats) -> tuple[float, float]:
        """Return where the centre of the largest inscribed disc is at a pose of the body's centre: x, y in squares."""
        x, y, angle = pose.tolist()
        px, py = self.body.probes[0, :2].tolist()
        c, s = math.cos(angle), math.sin(angle)
        return x + c * px - s * py, y + s * px + c * py

    def reached_places(self) -> Floats:
        """Return where the centre of the body's largest inscribed disc got to."""
        # (n, 2) x, y in squares, the start first.
        # These are the middles of settled cells, in order of their numbers.
        known = self.search.seen[0]
        leaf, free = self.tree.child[:known] < 0, self.tree.kind[:known] <= CELL_CENTRE_FREE
        settled = np.nonzero((self.search.state[:known] >= NODE_SETTLED) & leaf & free)[0]
        x, y, angle = np.vstack([self.start, self.tree.middle[settled]]).T
        c, s, (px, py) = np.cos(angle), np.sin(angle), self.search.disc_centre
        places = np.column_stack([x + c * px - s * py, y + s * px + c * py])
        if not self._decided_by_disc:
            return places
        own = shapely.intersects_xy(self._disc_room.buffer(self.min_cell), *places.T)
        own[0] = True
        return np.ascontiguousarray(places[own])
