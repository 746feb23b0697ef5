"""Constraints on the way: regions that are kept off, and what a thing sweeps while it is moved.

Regions are those of `avoid(T, "WKT")`, in squares, in the robot's own frame (origin where it woke).
"""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import shapely
from shapely import affinity

from utak.geometry.kernels.arrays import XY, Bools
from utak.geometry.raster.rasterize import covered_areas
from utak.kb.language.terms import Fact, Text
from utak.kb.language.wkt import parse_wkt
from utak.kb.perception.frame import Frame
from utak.kb.task.task import Task

AVOID = "avoid"
CARRY_NOTHING_THROUGH = "carry_nothing_through"
MIN_COVERED = 1e-9  # squares squared: a square covered by less is only touched, as in geometry.raster.rasterize
OBJECT_DISTANCE = 1.0  # squares that plans keep objects from a region: more than the doubt of where these are (derived)
MAX_KEPT_SPREAD = 0.04  # radians of doubt of the frame's angle that plans allow for: 2 degrees; more settles on the way
TURN_STEP = 2.0  # degrees between sampled poses of a turn: an arc of 0.17 squares at 5 squares off; a convention
SAME_PLACE = 1e-6  # squares by which a thing may differ and count as not moved (convention)


def region_of(fact: Fact) -> Any:
    """Return the region of avoid(T, "WKT"), a shapely geometry in squares, in the robot's own frame."""
    where = fact.args[1]
    assert isinstance(where, Text)
    return parse_wkt(where.value)


def avoidances(task: Task) -> Iterator[tuple[str, Fact]]:
    """Yield each constraint avoid(T, "WKT") of a task with its T: `utak` or the parameter of an object."""
    yield from ((str(fact.args[0]), fact) for fact in task.goals if fact.name == AVOID)


def in_view_frame(region: Any, frame: Frame, west: float, south: float) -> Any:
    """Return a region (shapely geometry, in squares) of the robot's own frame in the view frame."""

    def convert(points: Any) -> Any:
        x, y = frame.place_from_utak(points[:, 0], points[:, 1])
        return np.column_stack([x - west, y - south])

    return shapely.transform(region, convert)


def in_robot_frame(shape: Any, frame: Frame) -> Any:
    """Return a shape (shapely geometry, in squares) of the map frame in the robot's own frame."""
    return shapely.transform(shape, lambda points: np.array([frame.place_to_utak(x, y) for x, y in points]))


def region_squares(region: Any, shape: tuple[int, ...], wholly: bool, margin: int = 0) -> Bools:
    """Return the squares that a region (shapely geometry, in squares, view frame) meets."""
    rows, columns = shape[0] + 2 * margin, shape[1] + 2 * margin
    areas = covered_areas(affinity.translate(region, margin, margin), columns, rows)
    mask: Bools = areas > (1.0 - MIN_COVERED if wholly else MIN_COVERED)
    return mask


def swept_region(before: Any, after: Any, degrees: float, pivot: XY) -> Any:
    """Return what an object covers while it is moved once: pushed straight, or turned about the robot."""
    if abs(degrees) > SAME_PLACE:
        steps = math.ceil(abs(degrees) / TURN_STEP)
        parts = [affinity.rotate(before, degrees * n / steps, origin=shapely.Point(*pivot)) for n in range(steps)]
        return shapely.union_all([*parts, after])
    dx, dy = after.centroid.x - before.centroid.x, after.centroid.y - before.centroid.y
    ring = np.asarray(before.exterior.coords)
    edges = [
        shapely.MultiPoint([*pair, *(pair + np.array([dx, dy]))]).convex_hull
        for pair in (ring[n : n + 2] for n in range(len(ring) - 1))
    ]
    return shapely.union_all([before, after, *edges])
