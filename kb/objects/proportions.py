"""Whether a rectangle is a square or a brick, as far as it is known how far its sides lie within their squares.

An object that lies between the squares of the grid covers some of them in part and looks longer than it is: a square
looks like a brick longer by one, and a brick may look like a square, unless pushes by parts of a square have shown
more (kb.objects.subcell_extent).
"""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
import shapely

from utak.kb.objects.subcell_extent import GRID_ALIGNMENT_TOLERANCE, SubcellExtent

MAX_SQUARE_DIFFERENCE = 0.25  # squares: the sides of a square may seem to differ by so much; tuned
MAX_SIDE_UNCERTAINTY = 0.5  # squares: the length of a side must be known within this for the class to change; tuned


class SideInterval(NamedTuple):
    """The length of a side, in squares."""

    believed: float  # As the outline has it
    # Its least and its greatest possible value, as far as it is known how far its ends lie within their squares
    least: float
    most: float


def side_intervals(polygon: Any, insets: SubcellExtent | None) -> tuple[SideInterval, SideInterval] | None:
    """Return the lengths of the sides of a rectangle parallel to the grid, in squares: along x, then along y."""
    # None for all that is no rectangle parallel to the grid, and when an argument is None.
    if polygon is None or insets is None:
        return None
    points = shapely.get_coordinates(polygon)
    x0, y0, x1, y1 = polygon.bounds
    if len(points) != 5 or np.abs((points - (x0, y0)) * (points - (x1, y1))).max() > GRID_ALIGNMENT_TOLERANCE:
        return None
    return _side_interval(x1 - x0, insets, 0), _side_interval(y1 - y0, insets, 2)


def _side_interval(length: float, insets: SubcellExtent, axis: int) -> SideInterval:
    """Return the interval of a side believed to be `length` squares long; axis 0 is west-east, axis 2 south-north."""
    here, least, most = (sum(sides[axis : axis + 2]) for sides in (insets.believed, insets.least, insets.most))
    return SideInterval(length, length + here - most, length + here - least)


def possible_rectangle_shapes(polygon: Any, insets: SubcellExtent | None) -> tuple[str, ...]:
    """Return what a rectangle may be, as far as the lengths of its sides are known."""
    sides = side_intervals(polygon, insets)
    if sides is None:
        return ()
    (_, low, high), (_, left, right) = sides
    apart, further = max(low - right, left - high), max(high - left, right - low)
    return ("square",) * (apart <= MAX_SQUARE_DIFFERENCE) + ("brick",) * (further > MAX_SQUARE_DIFFERENCE)


def corrected_shape(shape: Mapping[str, int], polygon: Any, insets: SubcellExtent | None) -> Mapping[str, int]:
    """Return the confidences in shape classes, corrected where a rectangle is known to be smaller than its squares."""
    sides = side_intervals(polygon, insets)
    if sides is None or insets is None or not any(insets.believed):
        return shape
    if any(side.most - side.least > MAX_SIDE_UNCERTAINTY for side in sides):
        return shape
    is_brick = abs(sides[0].believed - sides[1].believed) > MAX_SQUARE_DIFFERENCE
    lesser, greater = sorted(shape.get(name, 0) for name in ("square", "brick"))
    return {**shape, "square": lesser if is_brick else greater, "brick": greater if is_brick else lesser}
