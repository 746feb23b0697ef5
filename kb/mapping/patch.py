"""A patch: a set of squares of the map, and where it lies."""

from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np
import shapely

from utak.geometry.kernels.arrays import XY, Bools, Square
from utak.geometry.raster.rasterize import squares
from utak.kb.mapping.occupancy import MapView


class Patch(NamedTuple):
    """A set of squares of the map frame."""

    west: int  # The square at [0, 0] of the mask, map frame
    south: int
    mask: Bools  # Which squares belong to it; row 0 in the south, column 0 in the west

    @property
    def centre(self) -> XY:
        """The mean of the centres of its squares, (x, y) in squares, map frame; it has at least one square."""
        rows, columns = np.nonzero(self.mask)
        return self.west + float(columns.mean()) + 0.5, self.south + float(rows.mean()) + 0.5

    def squares(self) -> set[Square]:
        """Return its squares (x, y), that is (column, row) of the map frame, as a new set; empty when it has none."""
        rows, columns = np.nonzero(self.mask)
        return {(self.west + c, self.south + r) for r, c in zip(rows.tolist(), columns.tolist(), strict=True)}


def patch_of(mask: Bools, view: MapView) -> Patch:
    """Return the patch of a mask on the view's arrays, cut to its extent; the mask is copied."""
    rows, columns = np.flatnonzero(mask.any(1)), np.flatnonzero(mask.any(0))
    part = mask[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
    return Patch(view.west + int(columns[0]), view.south + int(rows[0]), part.copy())


def patch_of_polygon(polygon: Any) -> Patch:
    """Return the patch of the squares whose open interior meets a polygon; its mask spans the bounding box."""
    x0, y0, x1, y1 = polygon.bounds
    west, south = int(np.floor(x0)), int(np.floor(y0))
    placed = shapely.transform(polygon, lambda points: points - np.array([west, south]))
    return Patch(west, south, squares(placed, int(np.ceil(x1)) - west, int(np.ceil(y1)) - south))


def patch_of_squares(squares_: Iterable[Square]) -> Patch:
    """Return the patch of some squares (x, y) of the map frame, cut to their extent."""
    columns, rows = np.array(sorted(squares_)).T
    west, south = int(columns.min()), int(rows.min())
    mask = np.zeros((int(rows.max()) + 1 - south, int(columns.max()) + 1 - west), np.bool_)
    mask[rows - south, columns - west] = True
    return Patch(west, south, mask)
