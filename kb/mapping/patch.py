"""A patch: a set of squares of the map, with where it lies."""

from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np
import shapely

from geometry.kernels.arrays import Bools, Square
from geometry.raster.rasterize import squares
from kb.mapping.occupancy import MapView


class Patch(NamedTuple):
    """A set of squares of the lattice. west, south.

    The square at [0, 0] of mask, a (rows, columns) array cut to its extent.
    """

    west: int
    south: int
    mask: Bools

    @property
    def centre(self) -> tuple[float, float]:
        """The mean of its squares' centres."""
        rows, columns = np.nonzero(self.mask)
        return self.west + float(columns.mean()) + 0.5, self.south + float(rows.mean()) + 0.5

    def squares(self) -> set[tuple[int, int]]:
        """Its squares (x, y)."""
        rows, columns = np.nonzero(self.mask)
        return {(self.west + c, self.south + r) for r, c in zip(rows.tolist(), columns.tolist(), strict=True)}


def patch_of(mask: Bools, view: MapView) -> Patch:
    """The squares of a mask on the view's arrays, cut to their extent."""
    rows, columns = np.flatnonzero(mask.any(1)), np.flatnonzero(mask.any(0))
    part = mask[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
    return Patch(view.west + int(columns[0]), view.south + int(rows[0]), part.copy())


def covered(polygon: Any) -> Patch:
    """The squares of the lattice that a polygon covers."""
    x0, y0, x1, y1 = polygon.bounds
    west, south = int(np.floor(x0)), int(np.floor(y0))
    placed = shapely.transform(polygon, lambda points: points - np.array([west, south]))
    return Patch(west, south, squares(placed, int(np.ceil(x1)) - west, int(np.ceil(y1)) - south))


def patch_of_squares(squares_: Iterable[Square]) -> Patch:
    """The patch of some squares, at least one."""
    columns, rows = np.array(sorted(squares_)).T
    west, south = int(columns.min()), int(rows.min())
    mask = np.zeros((int(rows.max()) + 1 - south, int(columns.max()) + 1 - west), np.bool_)
    mask[rows - south, columns - west] = True
    return Patch(west, south, mask)
