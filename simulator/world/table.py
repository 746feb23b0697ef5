"""TABLE: the array of squares onto which the things are projected, and what a look takes from it.

The verge and fixed things are projected once; a movable thing again when it has moved, on its own few squares.
"""

import math
from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import shapely

from geometry.raster.rasterize import squares
from simulator.world.world import VERGE_COLOUR, World

Bools = npt.NDArray[np.bool_]
Ints = npt.NDArray[np.intp]


class Projection(NamedTuple):
    """The squares of one thing: [row, column] True where it covers the square (west + column, south + row)."""

    west: int
    south: int
    covered: Bools

    def covers(self, i: int, j: int) -> bool:
        """Whether the thing covers the square (i, j)."""
        rows, columns = self.covered.shape
        row, column = j - self.south, i - self.west
        return 0 <= row < rows and 0 <= column < columns and bool(self.covered[row, column])

    def under(self, i: Ints, j: Ints) -> Bools:
        """Which of many squares the thing covers; i and j of one shape."""
        rows, columns = self.covered.shape
        row, column = j - self.south, i - self.west
        inside = (row >= 0) & (row < rows) & (column >= 0) & (column < columns)
        found = np.zeros(i.shape, dtype=bool)
        found[inside] = self.covered[row[inside], column[inside]]
        return found


def project(shape: Any) -> Projection:
    """Return the digital representation of a shape on the squares of its containing rectangle."""
    if shape.is_empty:
        return Projection(0, 0, np.zeros((0, 0), dtype=bool))
    x0, y0, x1, y1 = shape.bounds
    west, south = math.floor(x0), math.floor(y0)
    moved = shapely.transform(shape, lambda points: points - (west, south))
    return Projection(west, south, squares(moved, math.ceil(x1) - west, math.ceil(y1) - south))


class Table:
    """The TABLE array of a world.

    Of things that share a square the movable come first, then the fixed, each in the order of their names, then the
    verge: that decides whose colour is felt and what a grasp takes.
    """

    def __init__(self, world: World) -> None:
        self.width, self.height = world.width, world.height
        self._colours = {thing.name: thing.colour for thing in world.movable}
        self._movable = {thing.name: project(thing.polygon) for thing in world.movable}
        self._fixed = [(thing.colour, project(thing.polygon)) for thing in world.fixed]
        self._verge = project(world.verge)

    def update(self, name: str, polygon: Any) -> None:
        """Project a movable thing again."""
        self._movable[name] = project(polygon)

    def occupied(self, i: Ints, j: Ints) -> Bools:
        """Which of many squares something covers, Utak left out; squares beyond the table are verge."""
        found = (i < 0) | (i >= self.width) | (j < 0) | (j >= self.height)
        for part in self._parts():
            found |= part.under(i, j)
        return found

    def colour(self, i: int, j: int) -> str | None:
        """The colour of what covers a square, or None for floor."""
        if not (0 <= i < self.width and 0 <= j < self.height):
            return VERGE_COLOUR
        name = self.movable_at(i, j)
        if name is not None:
            return self._colours[name]
        layers = [*self._fixed, (VERGE_COLOUR, self._verge)]
        return next((colour for colour, part in layers if part.covers(i, j)), None)

    def movable_at(self, i: int, j: int) -> str | None:
        """The movable thing that covers a square, the first by name, or None."""
        return next((name for name, part in self._movable.items() if part.covers(i, j)), None)

    def _parts(self) -> Iterable[Projection]:
        yield self._verge
        yield from (part for _, part in self._fixed)
        yield from self._movable.values()
