"""The places of objects and of the robot in an odd world."""

from collections.abc import Sequence

import numpy as np
import shapely
from shapely import Point, Polygon, box
from shapely.affinity import rotate, translate
from shapely.geometry.base import BaseGeometry

from benchmarks.worlds.odd.houses import GRAIN
from benchmarks.worlds.placing import spot

MAX_LYING_TRIES = 100
LYING_GAP = 2.5  # squares from a thing to walls and other things: two free squares wherever the grid lies
ROBOT_GAP = 1.5  # squares from the robot to walls and things


def rounded(shape: Polygon) -> Polygon:
    """Return a shape with its corners as the world file has them."""
    return shapely.set_precision(shape, GRAIN)


def place(
    rng: np.random.Generator,
    outline: Polygon,
    room: Polygon,
    taken: Sequence[BaseGeometry],
    whole: bool,
    angle: float = 0.0,
    gap: float = LYING_GAP,
) -> Polygon | None:
    """Return an outline placed in a room, clear of its walls and of what is taken; None when no place is found.

    whole : whether its bounding box begins at whole squares; else anywhere, at hundredths of a square.
    """
    inner = room.buffer(-gap)
    if inner.is_empty:
        return None
    turned = rotate(outline, angle, origin=(0, 0))
    for _ in range(MAX_LYING_TRIES):
        at = spot(rng, inner)
        west, south, east, north = turned.bounds
        x, y = (round(v, 0 if whole else 2) for v in (at.x - (east - west) / 2, at.y - (north - south) / 2))
        here = rounded(translate(turned, x - west, y - south))
        if inner.covers(here) and all(here.distance(other) >= gap for other in taken):
            return here
    return None


def stand(
    rng: np.random.Generator, room: Polygon, taken: Sequence[BaseGeometry], whole: bool, gap: float = ROBOT_GAP
) -> Point | None:
    """Return a place for the robot clear of walls and of what is taken; None when no place is found.

    whole : whether it is the middle of a square; else anywhere, at hundredths of a square.
    """
    inner = room.buffer(-gap)
    for _ in range(MAX_LYING_TRIES if not inner.is_empty else 0):
        at = spot(rng, inner)
        x, y = (int(v) + 0.5 if whole else int(v) + round(float(rng.uniform(0.05, 0.95)), 2) for v in (at.x, at.y))
        if inner.covers(Point(x, y)) and all(Point(x, y).distance(other) >= gap for other in taken):
            return Point(x, y)
    return None


def own_square(utak: Point) -> Polygon:
    """Return the square in which the robot stands."""
    x, y = int(utak.x), int(utak.y)
    return box(x, y, x + 1, y + 1)


def box_outline(width: float, height: float) -> Polygon:
    """Return a rectangle at the origin."""
    return box(0, 0, width, height)
