"""Quick tests that rule out a carry, and what a carry sweeps."""

import math
from collections.abc import Sequence

import numpy as np
import shapely
from shapely import Polygon
from shapely.geometry.base import BaseGeometry

from benchmarks.worlds.placing import digital
from utak.geometry.kernels.arrays import XY, Bools
from utak.geometry.manipulation.legs import Leg
from utak.geometry.raster.components import components
from utak.geometry.screen import Screen

SQUARE_SLACK = 1.0  # squares by which clearances of squares may be less than those of the shapes that cover them
PARTS_OF_MOTION = 8  # poses of a motion whose shapes, joined, stand for all that it sweeps
TOUCHING_DEPTH = 0.01  # squares: what overlaps less only touches


def is_in_reach(shape: Polygon, free: Bools, utak: XY) -> bool:
    """Return whether the robot can walk to a square next to a thing.

    free : (rows, columns) bool, the squares that no wall and no other thing covers.
    """
    rows, columns = free.shape
    covered = digital(shape, columns, rows)
    labels = components(free & ~covered).labels
    own = labels[math.floor(utak[1]), math.floor(utak[0])]
    if not own:
        return True  # the robot stands on a square that a thing covers in part: not decided here
    near = np.zeros((rows + 2, columns + 2), bool)
    for dx in range(3):
        for dy in range(3):
            near[dy : dy + rows, dx : dx + columns] |= covered
    return bool((near[1:-1, 1:-1] & (labels == own)).any())


def may_pass(shape: Polygon, free: Bools, target: BaseGeometry) -> bool:
    """Return whether the largest circle in a thing might pass to a region; False rules a carry out.

    free : as of `is_in_reach`; what the thing itself covers is free.
    """
    rows, columns = free.shape
    circle = shapely.maximum_inscribed_circle(shape)
    wide = Screen(free).clearance >= circle.length - SQUARE_SLACK
    labels = components(wide).labels
    x, y = circle.coords[0]
    own = labels[math.floor(y), math.floor(x)]
    if not own:
        return True
    return bool((digital(target, columns, rows) & (labels == own)).any())


def swept(shape: Polygon, legs: Sequence[Leg]) -> BaseGeometry:
    """Return about what a thing sweeps when it is carried so, without what it covers at first."""
    begin, parts = shape, []
    for leg in legs:
        for motion in leg.motions:
            parts += [motion.part(k / PARTS_OF_MOTION).carry(shape) for k in range(1, PARTS_OF_MOTION + 1)]
            shape = motion.carry(shape)
    return shapely.union_all(parts).difference(begin).buffer(-TOUCHING_DEPTH)
