"""TABLE: the array of squares onto which all things are projected.

The verge and fixed things are projected once. A movable thing is projected again after it has moved, on the squares of
its containing rectangle only.
"""

import string
from copy import copy
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from utak.geometry.kernels.arrays import Bools, Floats
from utak.geometry.raster.rasterize import outline_edges, window_of
from utak.simulator.world.world import VERGE_COLOUR, World

TableColours = npt.NDArray[np.uint8]  # numbers of colours: the places of their letters in the alphabet, 0 for floor
COLOUR_OF_CODE: tuple[str | None, ...] = (None, *string.ascii_lowercase)  # the letter of each number


class Projection(NamedTuple):
    """The squares that a thing covers."""

    west: int  # column and row of the south-west square of `covered`
    south: int
    # (rows, columns) bool; [row, column] is True where the thing covers the square (west + column, south + row)
    covered: Bools

    def covers(self, i: int, j: int) -> bool:
        """Return whether the thing covers the square (i, j)."""
        rows, columns = self.covered.shape
        row, column = j - self.south, i - self.west
        return 0 <= row < rows and 0 <= column < columns and bool(self.covered[row, column])


def colour_code(letter: str) -> int:
    """Return the number of a lower-case letter in the alphabet, from 1."""
    return ord(letter) - ord("a") + 1


def project(shape: Any) -> Projection:
    """Return the digital representation of a shape."""
    return project_edges(outline_edges(shape))


def project_edges(edges: Floats) -> Projection:
    """Return the digital representation of the shape with some edges."""
    if not len(edges):
        return Projection(0, 0, np.zeros((0, 0), dtype=bool))
    return Projection(*window_of(edges))


class Table:
    """The TABLE array of a world."""

    def __init__(self, world: World) -> None:
        self.width, self.height = world.width, world.height
        self._codes = {thing.name: colour_code(thing.colour) for thing in world.movable}
        self._movable = {thing.name: project(thing.polygon) for thing in world.movable}
        self._standing = np.zeros((self.height, self.width), np.uint8)  # verge and fixed things alone
        self._paint(self._standing, project(world.verge), colour_code(VERGE_COLOUR))
        for thing in reversed(world.fixed):
            self._paint(self._standing, project(thing.polygon), colour_code(thing.colour))
        self.colours: TableColours = self._standing.copy()
        self._paint_movable(0, 0, self.width, self.height)

    def copy(self) -> "Table":
        """Return a table in the same state, which changes independently."""
        copied = copy(self)
        copied._movable = dict(self._movable)
        copied.colours = self.colours.copy()
        return copied

    def update(self, name: str, edges: Floats) -> None:
        """Project a movable thing again after it has moved."""
        before, now = self._movable[name], project_edges(edges)
        self._movable[name] = now
        rows, columns = zip(before.covered.shape, now.covered.shape, strict=True)
        self._paint_movable(
            min(before.west, now.west),
            min(before.south, now.south),
            max(before.west + columns[0], now.west + columns[1]),
            max(before.south + rows[0], now.south + rows[1]),
        )

    def movable_at(self, i: int, j: int) -> str | None:
        """Return the name of the movable thing that covers the square (i, j), the first by name; None without one."""
        return next((name for name, part in self._movable.items() if part.covers(i, j)), None)

    def _paint_movable(self, west: int, south: int, east: int, north: int) -> None:
        """Write the colours of a rectangle of squares anew, after movable things in it have changed."""
        west, south = max(west, 0), max(south, 0)
        window = slice(south, max(north, south)), slice(west, max(east, west))
        self.colours[window] = self._standing[window]
        for name in reversed(self._movable):
            part = self._movable[name]
            rows, columns = part.covered.shape
            if part.west < east and part.south < north and part.west + columns > west and part.south + rows > south:
                self._paint(self.colours, part, self._codes[name])

    def _paint(self, colours: TableColours, part: Projection, code: int) -> None:
        """Write the code of a colour to the squares that a thing covers, as far as they are on the table."""
        rows, columns = part.covered.shape
        south, west = max(part.south, 0), max(part.west, 0)
        north, east = min(part.south + rows, self.height), min(part.west + columns, self.width)
        if south < north and west < east:
            covered = part.covered[south - part.south : north - part.south, west - part.west : east - part.west]
            np.copyto(colours[south:north, west:east], np.uint8(code), where=covered)
