"""Validation of what callers hand in: numbers are finite and bounded, rings of polygons do not cross."""

from collections.abc import Iterable
from typing import Any

import numpy as np
import shapely

MAX_COORDINATE = 1e7  # squares; derived: beyond it, rounding of coordinates exceeds the skin of first contact, 1e-8


def valid_polygons(shape: Any, what: str) -> Any:
    """Return a geometry's polygons as one valid shapely geometry."""
    require_bounded(shapely.get_coordinates(shape), what)
    if shape is None or (shape.geom_type in ("Polygon", "MultiPolygon") and shapely.is_valid(shape)):
        return shape
    parts = [part for part in shapely.get_parts(shapely.make_valid(shape)) if part.geom_type.endswith("Polygon")]
    polygons = [polygon for part in parts for polygon in shapely.get_parts(part)]
    return polygons[0] if len(polygons) == 1 else shapely.MultiPolygon(polygons)


def require_bounded(numbers: Any, what: str) -> None:
    """Raise ValueError unless all numbers are finite and of a magnitude of at most MAX_COORDINATE."""
    values = np.asarray(list(numbers) if isinstance(numbers, Iterable) else numbers, dtype=float)
    if not (np.abs(values) <= MAX_COORDINATE).all():
        raise ValueError(f"{what} must be finite, and no coordinate beyond {MAX_COORDINATE:g}")
