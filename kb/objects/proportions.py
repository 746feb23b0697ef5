"""Whether a rectangle is a square or a brick, by what is known of how far in its sides lie (kb.objects.subcell_extent).

What lies between the squares covers some in part and looks longer than it is: a square looks like a brick longer by
one, and a brick may look like a square, unless pushes by parts of a square have told.
"""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
import shapely

from kb.objects.subcell_extent import ALONG, SubcellExtent

SAME = 0.25  # squares by which the sides of a square may seem to differ
TOLD = 0.5  # squares within which the length of a side must be known to go by it


class SideInterval(NamedTuple):
    """How long a side is believed to be, and at least and at most, in squares."""

    believed: float
    least: float
    most: float


def spans(polygon: Any, insets: SubcellExtent | None) -> tuple[SideInterval, SideInterval] | None:
    """The sides of a rectangle that lies along the lattice, to the east and to the north; None for all else."""
    if polygon is None or insets is None:
        return None
    points = shapely.get_coordinates(polygon)
    x0, y0, x1, y1 = polygon.bounds
    if len(points) != 5 or np.abs((points - (x0, y0)) * (points - (x1, y1))).max() > ALONG:
        return None
    return _span(x1 - x0, insets, 0), _span(y1 - y0, insets, 2)


def _span(length: float, insets: SubcellExtent, axis: int) -> SideInterval:
    here, least, most = (sum(sides[axis : axis + 2]) for sides in (insets.believed, insets.least, insets.most))
    return SideInterval(length, length + here - most, length + here - least)


def may_be(polygon: Any, insets: SubcellExtent | None) -> tuple[str, ...]:
    """What a rectangle may be as far as its sides are told: square, brick, or both; () for all else."""
    sides = spans(polygon, insets)
    if sides is None:
        return ()
    (_, low, high), (_, left, right) = sides
    apart, further = max(low - right, left - high), max(high - left, right - low)
    return ("square",) * (apart <= SAME) + ("brick",) * (further > SAME)


def reshaped(shape: Mapping[str, int], polygon: Any, insets: SubcellExtent | None) -> Mapping[str, int]:
    """The confidences in classes of shapes, where pushes told that a rectangle is smaller than the squares it fills."""
    sides = spans(polygon, insets)
    if sides is None or insets is None or not any(insets.believed):
        return shape
    if any(side.most - side.least > TOLD for side in sides):
        return shape
    square, brick = "square", "brick"
    if abs(sides[0].believed - sides[1].believed) > SAME:
        square, brick = brick, square
    confidence = max(shape.get(name, 0) for name in ("square", "brick", "rectangle"))
    return {**shape, square: confidence, brick: min(shape.get(square, 0), shape.get(brick, 0))}
