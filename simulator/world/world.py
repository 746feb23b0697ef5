"""The truth: what stands on the table and where Utak wakes. Frozen values, table frame, squares."""

from dataclasses import dataclass
from typing import Any

Ring = tuple[tuple[float, float], ...]
VERGE_COLOUR = "b"


@dataclass(frozen=True)
class Thing:
    """Something that lies on the table.

    Attributes
    ----------
    name : as in the world file.
    colour : one lower-case letter.
    polygon : shapely Polygon; without holes when the thing can be moved.
    """

    name: str
    colour: str
    polygon: Any


@dataclass(frozen=True)
class World:
    """A table with all that is on it.

    Attributes
    ----------
    width, height : of the table, in squares.
    verge : shapely Polygon or MultiPolygon, colour b; it never moves. Beyond the table all is verge.
    movable, fixed : things by name, in the order of the names.
    utak : (x, y) where Utak wakes.
    heading : the direction he faces then, degrees from the table's north, counter-clockwise, 0 to 359.
    """

    width: int
    height: int
    verge: Any
    movable: tuple[Thing, ...]
    fixed: tuple[Thing, ...]
    utak: tuple[float, float]
    heading: int


def ring_of(polygon: Any) -> Ring:
    """The outer boundary of a polygon as points, the last one different from the first."""
    return tuple((float(x), float(y)) for x, y in polygon.exterior.coords[:-1])
