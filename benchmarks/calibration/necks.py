"""The necks of a true floor that are doors as belief means them: at most half as wide as the floor on both sides."""

from functools import lru_cache

import numpy as np
import shapely
from shapely import LineString, Polygon
from shapely.geometry.base import BaseGeometry

from benchmarks.worlds.placing import digital
from utak.geometry import Screen
from utak.kb.world.doors import ENCODED_DOOR_RATIO

FINENESS = 2  # parts of a square's side on which necks are sought, so that walls need not lie along the squares
NECK_DEPTH = 0.25  # squares on either side of the narrowest line that are neither room


@lru_cache(maxsize=64)
def door_necks(floor: BaseGeometry, width: int, height: int) -> tuple[tuple[Polygon, float], ...]:
    """Return the doors of a floor by geometry alone: about the narrowest line of each, and its width, in squares."""
    fine = shapely.transform(floor, lambda points: FINENESS * points)
    walls = fine.envelope.buffer(FINENESS).difference(fine)
    free = ~np.asarray(digital(walls, FINENESS * width, FINENESS * height))
    free &= np.asarray(digital(fine, FINENESS * width, FINENESS * height))
    found = []
    for passage in Screen(free).passages(ENCODED_DOOR_RATIO):
        line = LineString([passage.a, passage.b])
        placed = shapely.transform(line, lambda points: points / FINENESS)
        found.append((placed.buffer(NECK_DEPTH, cap_style="flat"), placed.length))
    return tuple(found)
