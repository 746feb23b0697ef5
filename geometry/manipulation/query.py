"""An errand: what is to be carried where, by whom, among what."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from geometry.kernels.arrays import XY, Bools
from geometry.manipulation.goals import At, End, placed
from geometry.manipulation.legs import Leg
from geometry.manipulation.workspace import Workspace
from geometry.motion.se2 import Pose, Rotate, Translate, turned

NEAR = 0.25  # squares: a hold within this of one to be avoided is avoided


@dataclass(frozen=True)
class ManipulationQuery:
    """What plan_carrying was asked.

    shape : as it lies. yard : where it and Utak may be. utak : where he is. goal : where the shape shall end. margin :
    clearance that pushes and turns should keep. pull : whether he may go backwards. avoid : holds not to be used, see
    Leg.hold. walk : (rows, columns) squares where he may walk with empty hands. held : whether he has hold of the shape
    already, by a hold that is not to be avoided. turn : how many commands a turn counts for.
    """

    shape: Any
    yard: Workspace
    utak: XY
    goal: End
    margin: float
    pull: bool
    avoid: tuple[XY, ...]
    walk: Bools
    held: bool = False
    turn: float = 1.0

    @property
    def square(self) -> tuple[int, int]:
        """The (column, row) of Utak's own square, on the board."""
        rows, columns = self.walk.shape
        column, row = math.floor(self.utak[0]), math.floor(self.utak[1])
        return min(max(column, 0), columns - 1), min(max(row, 0), rows - 1)

    def hold_from(self, place: XY) -> XY:
        """Where a place is relative to the centroid of the shape as it lies now: see Leg.hold."""
        return place[0] - self.shape.centroid.x, place[1] - self.shape.centroid.y

    def avoids(self, x: float, y: float) -> bool:
        """Whether a hold, relative to the centroid of the shape as it lies now, is one to be avoided."""
        return any(math.dist((x, y), refuted) <= NEAR for refuted in self.avoid)


def after(errand: ManipulationQuery, legs: Sequence[Leg], held: bool = False) -> ManipulationQuery:
    """The errand that is left after some legs: shape and Utak are elsewhere, the goal is the same.

    held : whether he has not let go at the end of them.
    """
    shape, utak = errand.shape, errand.utak
    for leg in legs:
        utak = leg.place
        for motion in leg.motions:
            shape = motion.carry(shape)
            utak = (utak[0] + motion.dx, utak[1] + motion.dy) if isinstance(motion, Translate) else utak
    degrees = turned_by(legs)
    avoid = tuple(_turned(hold, degrees) for hold in errand.avoid)
    goal = _goal_after(errand.goal, errand.shape, shape, degrees)
    return replace(errand, shape=shape, utak=utak, goal=goal, avoid=avoid, held=held)


def joined(first: Sequence[Leg], then: Sequence[Leg]) -> list[Leg]:
    """Legs and the legs of the errand after them, their holds told in the frame of the errand before.

    Where these go on with the hold that he has, the legs on both sides become one.
    """
    degrees = turned_by(first)
    rest = [replace(leg, hold=_turned(leg.hold, -degrees)) for leg in then]
    if first and rest and rest[0].taken:
        return [*first[:-1], replace(first[-1], motions=first[-1].motions + rest[0].motions), *rest[1:]]
    return [*first, *rest]


def turned_by(legs: Sequence[Leg]) -> float:
    """By how much legs turn the shape, in degrees."""
    return sum(motion.degrees for leg in legs for motion in leg.motions if isinstance(motion, Rotate))


def _goal_after(goal: End, before: Any, now: Any, degrees: float) -> End:
    """The same goal for a shape that has been moved."""
    if not isinstance(goal, At):
        return goal
    there, here = placed(before, goal.pose).centroid, now.centroid
    return At(Pose(there.x - here.x, there.y - here.y, round(goal.pose.degrees - degrees, 7)))


def _turned(hold: XY, degrees: float) -> XY:
    """A hold in a frame turned by some degrees."""
    x, y = turned(np.array([hold]), degrees)[0]
    return float(x), float(y)
