"""The class of a polygon, by the table of classes (geometry/shapes/classes.py), whatever its size and angle."""

from collections.abc import Iterator

import numpy as np
import shapely
from shapely import Polygon

from utak.geometry.kernels.arrays import Floats
from utak.geometry.shapes.classes import CLASSES, MIN_BRICK_RATIO, RECTANGLES, ShapeClass

TOLERANCE = 1e-4  # of the length of an outline: rounding of the corners in a world's file
MIN_DISC_CORNERS = 12  # a polygon with so many corners, all equally far from the middle, stands for a disc
NO_CLASS = "none"  # a polygon of no class
RECTANGLE = "rectangle"  # longer than wide, but less than a brick: neither square nor brick is right or wrong


def class_of(polygon: Polygon) -> str:
    """Return the name of the class of a polygon, RECTANGLE, or NO_CLASS.

    >>> class_of(Polygon([(0, 0), (3, 0), (3, 3), (0, 3)]))
    'square'
    """
    ring = shapely.geometry.polygon.orient(polygon.simplify(1e-6))
    corners = np.asarray(ring.exterior.coords)[:-1]
    if len(ring.interiors):
        return NO_CLASS
    if len(corners) == 3:
        return "triangle"
    away = np.hypot(*(corners - corners.mean(0)).T)
    if len(corners) >= MIN_DISC_CORNERS and np.ptp(away) < TOLERANCE * ring.length:
        return "disc"
    return next((name for kind in CLASSES if (name := _fitting(kind, corners, ring.length))), NO_CLASS)


def _fitting(kind: ShapeClass, corners: Floats, length: float) -> str:
    """Return the name of a class of rectangles that has these corners; "" when it has not."""
    if kind.form != RECTANGLES or len(kind.corners) != len(corners) or kind.name == "square":
        return ""
    for begun in _turned(corners):
        rows = np.reshape(kind.corners, (-1, 4))
        sizes, *_ = np.linalg.lstsq(rows, begun.ravel(), rcond=None)
        fits = np.abs(rows @ sizes - begun.ravel()).max() < TOLERANCE * length
        if fits and all(feature @ sizes > TOLERANCE * length for feature in kind.features):
            return kind.name if kind.name != "brick" else _rectangle(sizes)
    return ""


def _rectangle(sizes: Floats) -> str:
    """Return which rectangle one of some sizes is."""
    ratio = max(sizes[:2]) / min(sizes[:2])
    return "square" if ratio < 1 + TOLERANCE else "brick" if ratio >= MIN_BRICK_RATIO else RECTANGLE


def _turned(corners: Floats) -> Iterator[Floats]:
    """Yield the corners from each of them on, with that one at the origin and the next one along x."""
    for first in range(len(corners)):
        rest = np.roll(corners, -first, axis=0) - corners[first]
        x, y = rest[1] / np.hypot(*rest[1])
        yield rest @ np.array([[x, -y], [y, x]])
