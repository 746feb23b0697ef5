"""The true contents of the table and the place where Utak wakes, as frozen values in squares, table frame."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

from shapely.affinity import translate

RingPoints = tuple[tuple[float, float], ...]  # a closed boundary, (x, y) in squares; the first point is not repeated
VERGE_COLOUR = "b"  # docs/files.md
DISTANCE_BESIDE_TABLE = 2.0  # squares from the table to what lies beside it, beyond all reach; a convention


@dataclass(frozen=True)
class Thing:
    """An object on the table."""

    name: str  # its name in the world file
    colour: str  # one lower-case letter
    polygon: Any  # shapely Polygon, squares, table frame; without holes when the thing can be moved


class Disturbance(NamedTuple):
    """A change of the table by others before a command of the robot."""

    step: int  # the number of that command, from 1
    name: str  # the thing that is put elsewhere; "utak" for the robot
    # Where to, shapely, squares, table frame: the Point of the thing's centroid or of the robot; the Polygon of a thing
    # that appears; None for a thing that is put beside the table
    place: Any
    fact: str  # the fact that states it (docs/files.md)

    def outline(self, polygon: Any, table_width: int) -> Any:
        """Return the outline that a thing has then, which has the outline `polygon` before."""
        if self.place is None:
            return beside_table(polygon, table_width)
        if self.place.geom_type == "Polygon":
            return self.place
        middle = polygon.centroid
        return translate(polygon, self.place.x - middle.x, self.place.y - middle.y)


@dataclass(frozen=True)
class World:
    """A table with its contents at the start, and what others will do to it."""

    width: int  # the size of the table, in squares
    height: int
    verge: Any  # shapely Polygon or MultiPolygon, colour b; it never moves. Everything beyond the table is verge, too.
    movable: tuple[Thing, ...]  # the things, in the order of their names
    fixed: tuple[Thing, ...]
    utak: tuple[float, float]  # the point (x, y) where Utak wakes
    # The direction that Utak faces, in degrees from the table's north, counter-clockwise positive, 0 to 359
    heading: int
    disturbances: tuple[Disturbance, ...] = ()  # in the order in which they happen

    def moved(self, polygons: Mapping[str, Any], utak: tuple[float, float]) -> "World":
        """Return the world with other outlines of movable things, by name, and with Utak elsewhere."""
        things = tuple(replace(thing, polygon=polygons.get(thing.name, thing.polygon)) for thing in self.movable)
        return replace(self, movable=things, utak=utak)


def outer_ring(polygon: Any) -> RingPoints:
    """Return the outer boundary of a polygon as points (x, y); the last point differs from the first."""
    return tuple((float(x), float(y)) for x, y in polygon.exterior.coords[:-1])


def beside_table(polygon: Any, table_width: int) -> Any:
    """Return the outline of a thing that lies off the table, to the east of it, out of the robot's reach."""
    return translate(polygon, table_width + DISTANCE_BESIDE_TABLE - polygon.bounds[0], 0.0)
