"""Legs of carrying: Utak walks to a place, takes the body, pushes and turns it, lets go. Nodes of a search made legs.

# Strategy: the search pushes by steps along eight directions. Of the places that a push passes on the board as few as
# can be are kept, those that see each other straight (exact first contact, with the margins wished for).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
import shapely

from geometry.kernels.arrays import XY, Bools, Floats, Longs
from geometry.manipulation.workspace import Workspace, broad
from geometry.motion.se2 import Motion, Rotate, Translate
from geometry.raster.rasterize import areas
from geometry.state_lattice.footprints import DIRECTIONS

STOPS = 40  # of a push that are looked at, or all where it turns
NUMBERS = 9  # digits that commands are given with
STRIDE = 12  # squares walked by a command, about


@dataclass(frozen=True)
class Leg:
    """What Utak does with the body from taking it to letting go.

    Attributes
    ----------
    place : (x, y) where he stands to take it, table frame: the middle of a square, or where he is when he has it.
    direction_square : (columns, rows) from his own square to the one of the body that he takes, each -1, 0 or 1.
    motions : Translate (push) and Rotate (turn about where he then is), each free by exact first contact.
    hold : (x, y) his place relative to the body's centroid, seen in the frame of the body as it lay when the plan was
        asked for: if the body were turned back to how it lay then. To be given as `avoid` when the grasp fails.
    walk : squares to walk to get to the place, along rows and columns (an estimate).
    taken : whether he has hold of the body already: he neither walks nor grasps. Only of the first leg of a plan.
    """

    place: XY
    direction_square: tuple[int, int]
    motions: tuple[Motion, ...]
    hold: XY = (0.0, 0.0)
    walk: int = 0
    taken: bool = False

    @property
    def commands(self) -> int:
        """About how many commands this takes: walks, grasp, pushes, turns, release."""
        return math.ceil(self.walk / STRIDE) + (0 if self.taken else 1) + len(self.motions) + 1


def grip_square(shape: Any, place: XY) -> tuple[int, int] | None:
    """Which of the eight squares about Utak's own the body covers most, a straight one first; None when none."""
    column, row = math.floor(place[0]) - 1, math.floor(place[1]) - 1
    near = shapely.transform(shape, lambda p: p - np.array([column, row]))
    covered = areas(near, 3, 3)
    best = max(DIRECTIONS, key=lambda d: (round(float(covered[d[1] + 1, d[0] + 1]), 6), d[0] * d[1] == 0))
    return best if covered[best[1] + 1, best[0] + 1] > 1e-9 else None


def rounded(motion: Motion) -> Motion:
    """A motion with its numbers as they will be commanded."""
    if isinstance(motion, Translate):
        return Translate(round(motion.dx, NUMBERS) + 0.0, round(motion.dy, NUMBERS) + 0.0)
    return Rotate(round(motion.degrees, NUMBERS) + 0.0, motion.about)


def commands(legs: Sequence[Leg]) -> int:
    """About how many commands some legs take."""
    return sum(leg.commands for leg in legs)


def at_utak(place: XY, motions: Sequence[Motion]) -> tuple[Motion, ...]:
    """The motions with turns about where Utak is at that time, free of rounding."""
    told: list[Motion] = []
    for motion in motions:
        if isinstance(motion, Translate):
            place = (place[0] + motion.dx, place[1] + motion.dy)
            told.append(motion)
        else:
            told.append(motion._replace(about=place))
    return tuple(told)


def shifted(leg: Leg, dx: float, dy: float) -> Leg:
    """A leg, with all of it so much further east and north."""
    place = leg.place[0] + dx, leg.place[1] + dy
    return replace(leg, place=place, motions=at_utak(place, leg.motions))


def may_push(shape: Any, utak: XY, dx: float, dy: float) -> bool:
    """Whether a push leads away from Utak towards the body: it has a component along the line to its centroid."""
    return bool(dx * (shape.centroid.x - utak[0]) + dy * (shape.centroid.y - utak[1]) > 1e-9)


def only_pushes(shape: Any, place: XY, motions: Sequence[Motion]) -> bool:
    """Whether no push goes backwards. shape, place : as the shape lies and where Utak is before the first motion."""
    for motion in motions:
        if isinstance(motion, Translate):
            if not may_push(shape, place, motion.dx, motion.dy):
                return False
            place = (place[0] + motion.dx, place[1] + motion.dy)
        shape = motion.carry(shape)
    return True


@dataclass(frozen=True)
class PushSegment:
    """A push in several pieces that shall have fewer.

    shape : as it lies when the push begins. stops : (n, 2) places of Utak on the way that is known, the first where he
    is. corners : of the stops, those where it turns, both ends among them. ends : (m, 2) other places where it may end.
    margin : of clearance for the shape. pull : whether he may go backwards.
    """

    shape: Any
    stops: Floats
    corners: Longs
    ends: Floats
    margin: float
    pull: bool

    def pieces(self, yard: Workspace) -> Floats:
        """The stops to keep, so that the push has the fewest straight pieces, then the shortest: (k, 2)."""
        if len(self.corners) <= 2:
            return self.stops[self.corners]
        some = np.union1d(self.corners, np.arange(0, len(self.stops), math.ceil(len(self.stops) / STOPS)))
        stops, corners = self.stops[some], np.searchsorted(some, self.corners)
        known = {(int(a), int(b)) for a, b in pairwise(corners)}
        best: list[tuple[int, float, int]] = [(0, 0.0, -1)] + [(len(stops), math.inf, -1)] * (len(stops) - 1)
        for i in range(len(stops) - 1):
            for j, free in enumerate(self._free(yard, stops[i], stops[i + 1 :]), i + 1):
                if free or (i, j) in known:
                    told = (best[i][0] + 1, best[i][1] + math.dist(stops[i], stops[j]), i)
                    best[j] = min(best[j], told)
        return self._traced(yard, stops, best)

    def _traced(self, yard: Workspace, stops: Floats, best: list[tuple[int, float, int]]) -> Floats:
        """The stops of the best way to the last one, or to another end where that takes fewer pieces."""
        final, at = (best[-1][0], best[-1][1]), len(stops) - 1
        kept: list[Floats] = []
        for i in range(len(stops) - 1):
            if best[i][0] + 1 >= final[0] or not len(self.ends):
                continue
            free = self._free(yard, stops[i], self.ends)
            if free.any():
                far = np.where(free, np.hypot(*(self.ends - stops[i]).T), np.inf)
                n = int(np.argmin(far))
                final, at, kept = (best[i][0] + 1, best[i][1] + float(far[n])), i, [self.ends[n]]
        while at >= 0:
            kept.append(stops[at])
            at = best[at][2]
        return np.array(kept[::-1])

    def _free(self, yard: Workspace, here: Floats, there: Floats) -> Bools:
        """To which of some places (n, 2) he can push straight from one: (n,)."""
        utak = (float(self.stops[0, 0]), float(self.stops[0, 1]))
        vectors = there - here
        free = yard.far(broad(self.shape, utak, self.margin).after(Translate(*(here - self.stops[0]))), vectors)
        if not self.pull:
            free &= [may_push(self.shape, utak, dx, dy) for dx, dy in vectors.tolist()]
        return free


def verified(yard: Workspace, shape: Any, legs: Sequence[Leg]) -> Any:
    """The shape after all legs; None when one of the motions is not free or a grasp reaches nothing."""
    for leg in legs:
        at = leg.place
        if not leg.taken and grip_square(shape, at) is None:
            return None
        for motion in leg.motions:
            if not yard.lets(shape, at, motion):
                return None
            shape = motion.carry(shape)
            if isinstance(motion, Translate):
                at = (at[0] + motion.dx, at[1] + motion.dy)
    return shape
