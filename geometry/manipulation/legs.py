"""Legs of a carrying plan: the robot walks to a place, grasps the body, pushes and turns it, releases it.

# Strategy: the lattice search pushes by steps along eight directions. Of the places that a push passes, as few as
# possible are kept: those from which the next one can be reached straight (exact first contact, with the margins).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
import shapely

from utak.geometry.kernels.arrays import XY, Bools, Floats, Longs
from utak.geometry.manipulation.workspace import Workspace, widened_body
from utak.geometry.motion.first_contact import ContactBody
from utak.geometry.motion.se2 import Motion, Rotate, Translate
from utak.geometry.raster.rasterize import MIN_COVERED_AREA, covered_areas
from utak.geometry.state_lattice.footprints import PUSH_DIRECTIONS

MAX_STOPS = 40  # stops of a push that are tried as its corners, besides those where it turns; convention, for time
LEG_DECIMALS = 9  # decimal digits of the numbers in commands; convention
WALK_SQUARES_PER_COMMAND = 12  # squares; estimate, as the cost of walking on the state lattice has it


@dataclass(frozen=True)
class Leg:
    """All that the robot does with the body from grasp to release."""

    # (x, y) in squares, table frame, where the robot stands to grasp the body: the centre of a square, or the robot's
    # own place when it holds the body already
    place: XY
    # (columns, rows) from the robot's own square to the square of the body that it grasps, each -1, 0, 1; columns count
    # to the east, rows to the north. It may be (0, 0) when `taken`, for then nothing is grasped.
    direction_square: tuple[int, int]
    # Translate (push) and Rotate (turn about the robot's place at that time), in order, table frame, each free by exact
    # first contact
    motions: tuple[Motion, ...]
    # (x, y) in squares, the offset of the grasp: the robot's place relative to the body's centroid, in the frame of the
    # body as it lay when the plan was asked for. To be given as `avoid` when the grasp fails.
    hold: XY = (0.0, 0.0)
    walk: int = 0  # squares to walk to get to the place, along rows and columns (an estimate)
    # Whether the robot holds the body already: it neither walks nor grasps. Only of the first leg of a plan.
    taken: bool = False

    @property
    def commands(self) -> int:
        """Return about how many commands the leg takes: walks, grasp, pushes, turns, release."""
        return math.ceil(self.walk / WALK_SQUARES_PER_COMMAND) + (0 if self.taken else 1) + len(self.motions) + 1


def direction_to_grasp(shape: Any, place: XY) -> tuple[int, int] | None:
    """Return the step (columns, rows) from the robot's square to the neighbour that the body covers most."""
    # None when the body covers none of the eight neighbours, as `squares` tells it: a sliver will do.
    column, row = math.floor(place[0]) - 1, math.floor(place[1]) - 1
    near = shapely.transform(shape, lambda p: p - np.array([column, row]))
    covered = covered_areas(near, 3, 3)
    met = [d for d in PUSH_DIRECTIONS if covered[d[1] + 1, d[0] + 1] > MIN_COVERED_AREA]
    return max(met, key=lambda d: (round(float(covered[d[1] + 1, d[0] + 1]), 6), d[0] * d[1] == 0), default=None)


def round_motion(motion: Motion) -> Motion:
    """Return a motion with its numbers rounded to LEG_DECIMALS, as they will be commanded; a pivot is not rounded."""
    if isinstance(motion, Translate):
        return Translate(round(motion.dx, LEG_DECIMALS) + 0.0, round(motion.dy, LEG_DECIMALS) + 0.0)
    return Rotate(round(motion.degrees, LEG_DECIMALS) + 0.0, motion.about)


def commands(legs: Sequence[Leg]) -> int:
    """Return about how many commands some legs take: the sum of Leg.commands, releases included."""
    return sum(leg.commands for leg in legs)


def with_pivots_at_robot(place: XY, motions: Sequence[Motion]) -> tuple[Motion, ...]:
    """Return the motions with each turn about the robot's place at that time, exactly; as many, in the same order."""
    pivoted: list[Motion] = []
    for motion in motions:
        if isinstance(motion, Translate):
            place = (place[0] + motion.dx, place[1] + motion.dy)
            pivoted.append(motion)
        else:
            pivoted.append(motion._replace(about=place))
    return tuple(pivoted)


def shifted(leg: Leg, dx: float, dy: float) -> Leg:
    """Return a leg with its place and the pivots of its motions translated by (dx, dy) squares; `hold` stays."""
    place = leg.place[0] + dx, leg.place[1] + dy
    return replace(leg, place=place, motions=with_pivots_at_robot(place, leg.motions))


def may_push(shape: Any, utak: XY, dx: float, dy: float) -> bool:
    """Return whether a push (dx, dy) leads from the robot towards the body."""
    return bool(dx * (shape.centroid.x - utak[0]) + dy * (shape.centroid.y - utak[1]) > 1e-9)


def only_pushes(shape: Any, place: XY, motions: Sequence[Motion]) -> bool:
    """Return whether no motion pulls: every Translate leads from the robot towards the body's centroid."""
    for motion in motions:
        if isinstance(motion, Translate):
            if not may_push(shape, place, motion.dx, motion.dy):
                return False
            place = (place[0] + motion.dx, place[1] + motion.dy)
        shape = motion.carry(shape)
    return True


@dataclass(frozen=True)
class PushSegment:
    """A push in several straight pieces, to be replaced by one with fewer. Squares, table frame."""

    shape: Any  # shapely Polygon, the body as it lies when the push begins
    stops: Floats  # (n, 2) places of the robot on the known path, x, y in squares; the first is where it stands
    corners: Longs  # indices of the stops at which the path turns, both ends among them, ascending
    ends: Floats  # (m, 2) other places of the robot where the push may end; (0, 2) for none
    margin: float  # clearance for the shape, in squares
    pull: bool  # whether the robot may pull

    def pieces(self, workspace: Workspace) -> Floats:
        """Return the stops to keep so that the push has the fewest straight pieces, then the least length."""
        if len(self.corners) <= 2:
            return self.stops[self.corners]
        sampled = np.union1d(self.corners, np.arange(0, len(self.stops), math.ceil(len(self.stops) / MAX_STOPS)))
        stops, corners = self.stops[sampled], np.searchsorted(sampled, self.corners)
        known = {(int(a), int(b)) for a, b in pairwise(corners)}
        best: list[tuple[int, float, int]] = [(0, 0.0, -1)] + [(len(stops), math.inf, -1)] * (len(stops) - 1)
        for i in range(len(stops) - 1):
            for j, free in enumerate(self._free_pushes(workspace, stops[i], stops[i + 1 :]), i + 1):
                if free or (i, j) in known:
                    candidate = (best[i][0] + 1, best[i][1] + math.dist(stops[i], stops[j]), i)
                    best[j] = min(best[j], candidate)
        return self._traced_stops(workspace, stops, best)

    def _traced_stops(self, workspace: Workspace, stops: Floats, best: list[tuple[int, float, int]]) -> Floats:
        """Return the stops of the best path to the last one, or to another end where that takes fewer pieces."""
        final, at = (best[-1][0], best[-1][1]), len(stops) - 1
        kept: list[Floats] = []
        for i in range(len(stops) - 1):
            if best[i][0] + 1 >= final[0] or not len(self.ends):
                continue
            free = self._free_pushes(workspace, stops[i], self.ends)
            if free.any():
                far = np.where(free, np.hypot(*(self.ends - stops[i]).T), np.inf)
                n = int(np.argmin(far))
                final, at, kept = (best[i][0] + 1, best[i][1] + float(far[n])), i, [self.ends[n]]
        while at >= 0:
            kept.append(stops[at])
            at = best[at][2]
        return np.array(kept[::-1])

    def _free_pushes(self, workspace: Workspace, here: Floats, there: Floats) -> Bools:
        """Return to which of the places `there` (n, 2) the robot can push straight from the place `here`: (n,) bool."""
        vectors = there - here
        free = workspace.far(self._widened.after(Translate(*(here - self.stops[0]))), vectors)
        if not self.pull:
            free &= [may_push(self.shape, self._utak, dx, dy) for dx, dy in vectors.tolist()]
        return free

    @property
    def _utak(self) -> XY:
        """The place of the robot when the push begins."""
        return float(self.stops[0, 0]), float(self.stops[0, 1])

    @cached_property
    def _widened(self) -> ContactBody:
        """Body and robot as one, with their clearance, when the push begins."""
        return widened_body(self.shape, self._utak, self.margin)


def verified(workspace: Workspace, shape: Any, legs: Sequence[Leg]) -> Any:
    """Return the shape after all legs; None when a motion is not free or a grasp reaches nothing."""
    for leg in legs:
        at = leg.place
        if not leg.taken and direction_to_grasp(shape, at) is None:
            return None
        for motion in leg.motions:
            if not workspace.lets(shape, at, motion):
                return None
            shape = motion.carry(shape)
            if isinstance(motion, Translate):
                at = (at[0] + motion.dx, at[1] + motion.dy)
    return shape
