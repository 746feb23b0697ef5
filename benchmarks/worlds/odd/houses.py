"""Floors of rooms and doors with walls of any thickness and at any angle, as frozen values in the table frame.

A house is drawn in a frame of its own, with two rooms beside each other along x, and then rotated and placed on the
table.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from shapely import LineString, Point, Polygon, box, union_all
from shapely.affinity import rotate, translate
from shapely.geometry.base import BaseGeometry

GRAIN = 1e-6  # squares: the world file has so many decimals
OVERLAP = 0.01  # squares that a neck is drawn on into its rooms, so that their union has no seams
CORNER_LEAD = 3.0  # squares by which a corner must be further out than all others to be told for the furthest
COMPASS = {"northeast": (1, 1), "northwest": (-1, 1), "southwest": (-1, -1), "southeast": (1, -1)}
Pair = tuple[float, float]


@dataclass(frozen=True)
class OddNeck:
    """A door: corners `a0, a1` on the first room's wall and `b0, b1` opposite them on the second room's wall."""

    a0: Pair
    a1: Pair
    b0: Pair
    b1: Pair

    @property
    def polygon(self) -> Polygon:
        """The floor between the two walls."""
        return Polygon([self.a0, self.a1, self.b1, self.b0])

    @property
    def gap(self) -> float:
        """The distance between the jambs: nothing convex of a greater least width passes."""
        return LineString([self.a0, self.b0]).distance(LineString([self.a1, self.b1]))

    @property
    def clear(self) -> float:
        """The distance between the lines of the jambs: a square with a smaller side passes along them."""
        (x, y), (u, v) = np.subtract(self.b0, self.a0), np.subtract(self.a1, self.a0)
        return float(abs(x * v - y * u) / math.hypot(x, y))

    @property
    def middle(self) -> LineString:
        """The line from jamb to jamb, halfway through: who crosses it goes through the door."""
        return LineString([np.mean([self.a0, self.b0], axis=0), np.mean([self.a1, self.b1], axis=0)])

    def half(self, second: bool) -> Polygon:
        """Return the half of the neck at its first or its second room."""
        m0, m1 = np.add(self.a0, self.b0) / 2, np.add(self.a1, self.b1) / 2
        return Polygon([m0, m1, self.b1, self.b0] if second else [self.a0, self.a1, m1, m0])

    def drawn_on(self, by: float) -> Polygon:
        """Return the neck made longer by a length at both ends."""
        step = np.subtract(self.b0, self.a0)
        step = by * step / np.hypot(*step)
        return Polygon([self.a0 - step, self.a1 - step, self.b1 + step, self.b0 + step])


@dataclass(frozen=True)
class House:
    """A table of width x height squares with one or two rooms, and the necks between the first and the second."""

    width: int
    height: int
    rooms: tuple[Polygon, ...]
    necks: tuple[OddNeck, ...]
    floor: Polygon

    @property
    def verge(self) -> BaseGeometry:
        """The rest of the table."""
        return box(0, 0, self.width, self.height).difference(self.floor)

    def beyond(self, home: int) -> BaseGeometry:
        """Return the other room with the necks' halves at it: what lies there is through the door by any reading."""
        halves = [neck.half(home == 0).buffer(OVERLAP, join_style="mitre") for neck in self.necks]
        return union_all([self.rooms[1 - home], *halves])

    def furthest_corner(self, compass: str, heading: float) -> Point | None:
        """Return the convex corner of the floor furthest towards a corner of the robot's frame; None for near ties."""
        east, north = COMPASS[compass]
        c, s = math.cos(math.radians(heading)), math.sin(math.radians(heading))
        way = np.array([east * c - north * s, east * s + north * c]) / math.sqrt(2)
        ranked = sorted(convex_corners(self.floor), key=lambda corner: -float(np.dot(corner, way)))
        best, second = (float(np.dot(corner, way)) for corner in ranked[:2])
        return Point(ranked[0]) if best - second >= CORNER_LEAD else None


def convex_corners(floor: Polygon) -> list[Pair]:
    """Return the corners of a floor that turn to the inside."""
    ring = list(shapely.geometry.polygon.orient(floor).exterior.coords)[:-1]
    corners = []
    for before, at, after in zip(ring[-1:] + ring[:-1], ring, ring[1:] + ring[:1], strict=True):
        (x, y), (u, v) = np.subtract(at, before), np.subtract(after, at)
        if x * v - y * u > 1e-6:
            corners.append(at)
    return corners


def one_room(room: Polygon, angle: float = 0.0, margin: Pair = (2, 2)) -> House:
    """Place a floor of one room on a table, rotated by `angle` degrees, its bounding box `margin` from the corner."""
    return _laid([room], [], angle, margin)


def two_rooms(
    first: Polygon, second: Polygon, necks: Sequence[OddNeck], angle: float = 0.0, margin: Pair = (2, 2)
) -> House:
    """Place a floor of two rooms with doors between them on a table."""
    return _laid([first, second], list(necks), angle, margin)


def straight(
    depths: Pair, heights: Pair, wall: float, door: float, at: float, shift: float = 0.0
) -> tuple[Polygon, Polygon, OddNeck]:
    """Return two rectangular rooms beside each other and the door between them, in the house's own frame.

    depths, heights : of the rooms, across and along the wall between them. at : where the door begins along the wall.
    shift : how much further along the wall the second room lies.
    """
    far = depths[0] + wall
    first = box(0, 0, depths[0], heights[0])
    second = box(far, shift, far + depths[1], shift + heights[1])
    return first, second, OddNeck((depths[0], at), (depths[0], at + door), (far, at), (far, at + door))


def _laid(rooms: list[Polygon], necks: list[OddNeck], angle: float, margin: Pair) -> House:
    floor = union_all([*rooms, *(neck.drawn_on(OVERLAP) for neck in necks)])
    low = rotate(floor, angle, origin=(0, 0)).bounds
    by = (margin[0] - low[0], margin[1] - low[1])

    def put(shape: BaseGeometry) -> BaseGeometry:
        turned = rotate(shape, angle, origin=(0, 0)) if angle else shape
        return shapely.set_precision(translate(turned, *by), GRAIN)

    def corner(pair: Pair) -> Pair:
        point = put(Point(pair))
        return (point.x, point.y)

    laid = put(floor).simplify(0)
    size = (math.ceil(laid.bounds[2] + 1 - GRAIN), math.ceil(laid.bounds[3] + 1 - GRAIN))
    moved = [OddNeck(corner(n.a0), corner(n.a1), corner(n.b0), corner(n.b1)) for n in necks]
    return House(*size, tuple(put(room) for room in rooms), tuple(moved), laid)
