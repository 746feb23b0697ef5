"""TABLE: the array of squares onto which all things are projected.

The verge and fixed things are projected once. A movable thing is projected again after it has moved, on the squares of
its containing rectangle only.
"""

import math
from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import shapely

from geometry.kernels.arrays import Bools
from geometry.raster.rasterize import squares
from simulator.world.world import VERGE_COLOUR, World

TableIndices = npt.NDArray[np.intp]  # columns or rows of squares


class Projection(NamedTuple):
    """The squares that a thing covers.

    Attributes
    ----------
    west, south : column and row of the south-west square of `covered`.
    covered : (rows, columns) bool; [row, column] is True where the thing covers the square (west + column, south +
        row).
    """

    west: int
    south: int
    covered: Bools

    def covers(self, i: int, j: int) -> bool:
        """Return whether the thing covers the square (i, j)."""
        rows, columns = self.covered.shape
        row, column = j - self.south, i - self.west
        return 0 <= row < rows and 0 <= column < columns and bool(self.covered[row, column])

    def under(self, i: TableIndices, j: TableIndices) -> Bools:
        """Return which of many squares the thing covers.

        i, j : columns and rows of the squares, arrays of one shape. The result has the same shape.
        """
        rows, columns = self.covered.shape
        row, column = j - self.south, i - self.west
        inside = (row >= 0) & (row < rows) & (column >= 0) & (column < columns)
        found = np.zeros(i.shape, dtype=bool)
        found[inside] = self.covered[row[inside], column[inside]]
        return found


def project(shape: Any) -> Projection:
    """Return the digital representation of a shape.

    Parameters
    ----------
    shape : shapely geometry, squares, table frame.

    Returns
    -------
    The covered squares within the shape's containing rectangle.
    """
    if shape.is_empty:
        return Projection(0, 0, np.zeros((0, 0), dtype=bool))
    x0, y0, x1, y1 = shape.bounds
    west, south = math.floor(x0), math.floor(y0)
    moved = shapely.transform(shape, lambda points: points - (west, south))
    return Projection(west, south, squares(moved, math.ceil(x1) - west, math.ceil(y1) - south))


class Table:
    """The TABLE array of a world.

    When several things share a square, movable things come first, then fixed things, each in the order of their names,
    then the verge. The first one determines the colour that is felt, and what a grasp takes.
    """

    def __init__(self, world: World) -> None:
        self.width, self.height = world.width, world.height
        self._colours = {thing.name: thing.colour for thing in world.movable}
        self._movable = {thing.name: project(thing.polygon) for thing in world.movable}
        self._fixed = [(thing.colour, project(thing.polygon)) for thing in world.fixed]
        self._verge = project(world.verge)

    def update(self, name: str, polygon: Any) -> None:
        """Project a movable thing again after it has moved."""
        self._movable[name] = project(polygon)

    def occupied(self, i: TableIndices, j: TableIndices) -> Bools:
        """Return which of many squares are occupied by anything but Utak; squares beyond the table are.

        i, j : columns and rows of the squares, arrays of one shape. The result has the same shape.
        """
        found = (i < 0) | (i >= self.width) | (j < 0) | (j >= self.height)
        for part in self._parts():
            found |= part.under(i, j)
        return found

    def colour(self, i: int, j: int) -> str | None:
        """Return the colour of what covers the square (i, j); None for floor."""
        if not (0 <= i < self.width and 0 <= j < self.height):
            return VERGE_COLOUR
        name = self.movable_at(i, j)
        if name is not None:
            return self._colours[name]
        layers = [*self._fixed, (VERGE_COLOUR, self._verge)]
        return next((colour for colour, part in layers if part.covers(i, j)), None)

    def movable_at(self, i: int, j: int) -> str | None:
        """Return the name of the movable thing that covers the square (i, j), the first by name; None without one."""
        return next((name for name, part in self._movable.items() if part.covers(i, j)), None)

    def _parts(self) -> Iterable[Projection]:
        """Yield the projections of the verge and of all things."""
        yield self._verge
        yield from (part for _, part in self._fixed)
        yield from self._movable.values()
