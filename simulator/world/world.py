"""The true contents of the table and the place where Utak wakes, as frozen values in squares, table frame."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

RingPoints = tuple[tuple[float, float], ...]  # a closed boundary, (x, y) in squares; the first point is not repeated
VERGE_COLOUR = "b"  # docs/files.md


@dataclass(frozen=True)
class Thing:
    """An object on the table."""

    name: str  # its name in the world file
    colour: str  # one lower-case letter
    polygon: Any  # shapely Polygon, squares, table frame; without holes when the thing can be moved


@dataclass(frozen=True)
class World:
    """A table with its contents at the start."""

    width: int  # the size of the table, in squares
    height: int
    verge: Any  # shapely Polygon or MultiPolygon, colour b; it never moves. Everything beyond the table is verge, too.
    movable: tuple[Thing, ...]  # the things, in the order of their names
    fixed: tuple[Thing, ...]
    utak: tuple[float, float]  # the point (x, y) where Utak wakes
    # The direction that Utak faces, in degrees from the table's north, counter-clockwise positive, 0 to 359
    heading: int

    def moved(self, polygons: Mapping[str, Any], utak: tuple[float, float]) -> "World":
        """Return the world with other outlines of movable things, by name, and with Utak elsewhere."""
        things = tuple(replace(thing, polygon=polygons.get(thing.name, thing.polygon)) for thing in self.movable)
        return replace(self, movable=things, utak=utak)


def outer_ring(polygon: Any) -> RingPoints:
    """Return the outer boundary of a polygon as points (x, y); the last point differs from the first."""
    return tuple((float(x), float(y)) for x, y in polygon.exterior.coords[:-1])
