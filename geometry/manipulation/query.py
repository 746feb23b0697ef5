"""An errand: what is to be carried where, by whom, among what."""

import math
from dataclasses import dataclass
from typing import Any

from geometry.kernels.arrays import XY, Bools
from geometry.manipulation.goals import End
from geometry.manipulation.workspace import Yard

NEAR = 0.25  # squares: a hold within this of one to be avoided is avoided


@dataclass(frozen=True)
class Errand:
    """What plan_carrying was asked.

    shape : as it lies. yard : where it and Utak may be. utak : where he is. goal : where the shape shall end. margin :
    clearance that pushes and turns should keep. pull : whether he may go backwards. avoid : holds not to be used, see
    Leg.hold. walk : (rows, columns) squares where he may walk with empty hands. held : whether he has hold of the shape
    already, by a hold that is not to be avoided. turn : how many commands a turn counts for.
    """

    shape: Any
    yard: Yard
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
