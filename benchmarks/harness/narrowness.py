"""The passage that a verdict calls too narrow, compared with the truth."""

import math
import re
from typing import NamedTuple

from shapely import Point

from benchmarks.worlds.scenes import RandomScenario
from utak.kb.perception.frame import turned

ALLOWED = 0.25  # squares by which a missing width may be off
MAX_PASSAGE_DISTANCE = 1.5  # squares from the true passage to the one told
SAID = re.compile(r"at POINT \((\S+) (\S+)\), is too narrow by (\S+) squares")


class Narrowness(NamedTuple):
    """The comparison of a named passage with the true one.

    off : squares by which the named missing width differs from the true one; nan when none is named.
    away : squares from the named passage to the true one, 0 within it; nan when none is named.
    """

    off: float
    away: float

    @property
    def right(self) -> bool:
        """Whether the passage was told, and rightly."""
        return abs(self.off) <= ALLOWED and self.away <= MAX_PASSAGE_DISTANCE


def narrowness(world: RandomScenario, reason: str) -> Narrowness | None:
    """Compare the reason of a verdict with the truth; None where no passage is too narrow."""
    if not world.missing:
        return None
    said = SAID.search(reason)
    if said is None:
        return Narrowness(math.nan, math.nan)
    east, north, missing = (float(part) for part in said.groups())
    x, y = turned(east, north, world.heading)
    place = Point(world.utak.x + x, world.utak.y + y)
    necks = [door.polygon for door in world.plan.doors] or [world.target]  # around a corner: the arm beyond it
    return Narrowness(missing - world.missing, min(float(neck.distance(place)) for neck in necks))
