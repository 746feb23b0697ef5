"""What is handed in made sound: numbers finite and not too large to be told apart finely, rings that do not cross."""

from collections.abc import Iterable
from typing import Any

import numpy as np
import shapely

FURTHEST = 1e7  # squares: further off the skin of first contact, 1e-8, is lost in the rounding of coordinates


def sound(shape: Any, what: str) -> Any:
    """A shapely polygon or several as they are, or with rings that cross read even-odd; of all else its polygons.

    Raises
    ------
    ValueError : when a coordinate is not finite or beyond FURTHEST.
    """
    check(shapely.get_coordinates(shape), what)
    if shape is None or (shape.geom_type in ("Polygon", "MultiPolygon") and shapely.is_valid(shape)):
        return shape
    parts = [part for part in shapely.get_parts(shapely.make_valid(shape)) if part.geom_type.endswith("Polygon")]
    polygons = [polygon for part in parts for polygon in shapely.get_parts(part)]
    return polygons[0] if len(polygons) == 1 else shapely.MultiPolygon(polygons)


def check(numbers: Any, what: str) -> None:
    """Raise when some numbers are not all finite and at most FURTHEST.

    Raises
    ------
    ValueError : says what is wrong of what.
    """
    values = np.asarray(list(numbers) if isinstance(numbers, Iterable) else numbers, dtype=float)
    if not (np.abs(values) <= FURTHEST).all():
        raise ValueError(f"{what} must be finite, and no coordinate beyond {FURTHEST:g}")
