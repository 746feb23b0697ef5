"""Random floor plans: one to three rooms in a row, stacked or in an L, or six in two rows, with doors between them.

All lengths are squares, all corners of rooms and doors are whole squares of the table.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from shapely import Polygon, box, union_all
from shapely.geometry.base import BaseGeometry

JAMB = 2  # squares of wall left between a door and the corner of a room
MIN_ARM_WIDTH = 9  # squares: the least width of an arm of an L-shaped room


@dataclass(frozen=True)
class PlanRoom:
    """A room of the floor: its name and its polygon, without the necks of its doors."""

    name: str
    polygon: Polygon


@dataclass(frozen=True)
class PlanDoor:
    """A neck of the floor, as thick as the wall it goes through; `vertical` when the wall runs north and south."""

    rooms: tuple[str, str]
    polygon: Polygon
    width: int
    vertical: bool


@dataclass(frozen=True)
class FloorPlan:
    """A table of width x height squares, its rooms and its doors (none when the rooms are closed off)."""

    width: int
    height: int
    rooms: tuple[PlanRoom, ...]
    doors: tuple[PlanDoor, ...]

    @property
    def floor(self) -> BaseGeometry:
        """All that is not verge: rooms and necks together."""
        return union_all([room.polygon for room in self.rooms] + [door.polygon for door in self.doors]).simplify(0)

    @property
    def verge(self) -> BaseGeometry:
        """The rest of the table."""
        return box(0, 0, self.width, self.height).difference(self.floor)

    def room(self, name: str) -> Polygon:
        """Return the polygon of a room by its name."""
        return next(room.polygon for room in self.rooms if room.name == name)

    def neighbours(self, name: str) -> list[str]:
        """Return the rooms that share a door with a room."""
        return sorted({b if a == name else a for a, b in (door.rooms for door in self.doors) if name in (a, b)})


Cell = tuple[int, int]
LAYOUTS: dict[int, list[list[Cell]]] = {
    1: [[(0, 0)]],
    2: [[(0, 0), (1, 0)], [(0, 0), (0, 1)]],
    3: [
        [(0, 0), (1, 0), (2, 0)],
        [(0, 0), (0, 1), (0, 2)],
        [(1, 0), (0, 0), (0, 1)],
        [(0, 0), (1, 0), (1, 1)],
        [(0, 0), (0, 1), (1, 1)],
        [(1, 0), (1, 1), (0, 1)],
    ],
    6: [
        [(0, 0), (1, 0), (2, 0), (2, 1), (1, 1), (0, 1)],
        [(0, 0), (0, 1), (0, 2), (1, 2), (1, 1), (1, 0)],
        [(0, 1), (0, 0), (1, 0), (1, 1), (2, 1), (2, 0)],
        [(1, 0), (0, 0), (0, 1), (1, 1), (1, 2), (0, 2)],
    ],
}
ROOM_SIDES = {
    1: (20, 58),
    2: (16, 29),
    3: (14, 19),
    6: (14, 19),
}  # least and greatest inner side along an axis with so many rooms
SidesByCount = Mapping[int, tuple[int, int]]
SNUG: SidesByCount = dict.fromkeys(ROOM_SIDES, (18, 24))  # of rooms as they are mostly drawn


def random_plan(
    rng: np.random.Generator,
    rooms: int,
    doors: tuple[int, int],
    wall: int = 2,
    closed: bool = False,
    ells: float = 0.15,
    loops: float = 0.0,
    sides: SidesByCount = ROOM_SIDES,
) -> FloorPlan:
    """Return a random plan of some rooms, each joined to the next by a door.

    Parameters
    ----------
    rooms : 1 to 3, or 6.
    doors : least and greatest width of a door in squares; every room is at least twice as wide as its doors.
    wall : thickness of the walls in squares.
    closed : whether the doors are left out, so that nothing joins the rooms.
    ells : chance that a corner is cut from a room, which makes it L-shaped.
    loops : chance that two neighbours which do not follow each other share a door too, where their walls let them.
    sides : least and greatest inner side of a room along an axis, by the number of rooms along it.
    """
    while True:
        cells = LAYOUTS[rooms][rng.integers(len(LAYOUTS[rooms]))]
        widths = [int(rng.integers(doors[0], doors[1] + 1)) for _ in range(rooms - 1)]
        least = max([2 * w + 1 for w in widths] + [0])
        rects, size = _rectangles(rng, cells, wall, least, sides)
        joints = [_door(rng, rects, (i, i + 1), w, wall) for i, w in enumerate(widths)]
        if all(joint is not None for joint in joints):
            pairs = [(i, j) for j in range(rooms) for i in range(j - 1) if loops and rng.random() < loops]
            joints += [_door(rng, rects, pair, widths[pair[0]], wall) for pair in pairs]
            made = [joint for joint in joints if joint is not None]
            shapes = [
                _cut(rng, rect, made, max(MIN_ARM_WIDTH, least)) if rng.random() < ells else box(*rect)
                for rect in rects
            ]
            named = tuple(PlanRoom(f"r{i + 1}", shape) for i, shape in enumerate(shapes))
            return FloorPlan(*size, named, () if closed else tuple(made))


def corridor(rng: np.random.Generator, widths: tuple[int, int], wall: int = 2) -> tuple[FloorPlan, Polygon, Polygon]:
    """Return an L-shaped floor, mirrored at random: the plan (one room), and its two arms without the elbow.

    The first arm runs west and east and has width `widths[0]`, the second north and south with `widths[1]`.
    """
    long, tall = int(rng.integers(16, 25)), int(rng.integers(16, 25))
    width, height = long + widths[1] + 2 * wall, tall + widths[0] + 2 * wall
    first = box(wall, wall, wall + long, wall + widths[0])
    second = box(wall + long, wall + widths[0], width - wall, height - wall)
    elbow = box(wall + long, wall, width - wall, wall + widths[0])
    east, north = bool(rng.integers(2)), bool(rng.integers(2))
    parts = [_mirrored(part, width, height, east, north) for part in (first, second, elbow)]
    room = PlanRoom("r1", union_all(parts).simplify(0))
    return FloorPlan(width, height, (room,), ()), parts[0], parts[1]


Rect = tuple[int, int, int, int]


def _mirrored(part: Polygon, width: int, height: int, east: bool, north: bool) -> Polygon:
    west, south, right, top = (int(v) for v in part.bounds)
    if east:
        west, right = width - right, width - west
    if north:
        south, top = height - top, height - south
    return box(west, south, right, top)


def _spans(rng: np.random.Generator, count: int, wall: int, least: int, sides: SidesByCount) -> list[tuple[int, int]]:
    low, high = sides[count]
    spans, at = [], wall
    for _ in range(count):
        side = int(rng.integers(max(low, least), max(high, least) + 1))
        spans.append((at, at + side))
        at += side + wall
    return spans


def _rectangles(
    rng: np.random.Generator, cells: list[Cell], wall: int, least: int, sides: SidesByCount
) -> tuple[list[Rect], Cell]:
    """Return one rectangle for each cell of the layout, and the table's size; outer sides are drawn in a little."""
    columns = _spans(rng, 1 + max(c for c, _ in cells), wall, least, sides)
    rows = _spans(rng, 1 + max(r for _, r in cells), wall, least, sides)
    rects = []
    for column, row in cells:
        inset = [int(rng.integers(0, 5)) if rng.random() < 0.3 else 0 for _ in range(4)]
        for side, near in enumerate([(column - 1, row), (column, row - 1), (column + 1, row), (column, row + 1)]):
            inset[side] = 0 if near in cells or len(cells) == 1 else inset[side]
        (west, east), (south, north) = columns[column], rows[row]
        if east - west - inset[0] - inset[2] < max(14, least):
            inset[0] = inset[2] = 0
        if north - south - inset[1] - inset[3] < max(14, least):
            inset[1] = inset[3] = 0
        rects.append((west + inset[0], south + inset[1], east - inset[2], north - inset[3]))
    return rects, (columns[-1][1] + wall, rows[-1][1] + wall)


def _door(rng: np.random.Generator, rects: list[Rect], pair: tuple[int, int], width: int, wall: int) -> PlanDoor | None:
    """Return a door between two of the rectangles, or None where they do not face each other widely enough."""
    a, b = (rects[index] for index in pair)
    names = (f"r{pair[0] + 1}", f"r{pair[1] + 1}")
    for vertical in (True, False):
        axis, across = (0, 1) if vertical else (1, 0)
        for one, other in ((a, b), (b, a)):
            if other[axis] - one[axis + 2] == wall:
                low, high = max(a[across], b[across]) + JAMB, min(a[across + 2], b[across + 2]) - JAMB - width
                if low > high:
                    return None
                at = int(rng.integers(low, high + 1))
                corners = (one[axis + 2], at, other[axis], at + width)
                neck = box(*corners) if vertical else box(corners[1], corners[0], corners[3], corners[2])
                return PlanDoor(names, neck, width, vertical)
    return None


def _cut(rng: np.random.Generator, rect: Rect, doors: list[PlanDoor], arm: int) -> Polygon:
    """Return the rectangle without one of its corners, clear of the doors; unchanged when it is too small."""
    west, south, east, north = rect
    room = box(*rect)
    if min(east - west, north - south) < arm + 4:
        return room
    wide, high = int(rng.integers(4, east - west - arm + 1)), int(rng.integers(4, north - south - arm + 1))
    pieces = [
        box(x, y, x + wide, y + high)
        for x in (west, east - wide)
        for y in (south, north - high)
        if all(box(x, y, x + wide, y + high).distance(door.polygon) >= 4 for door in doors)
    ]
    return room.difference(pieces[rng.integers(len(pieces))]) if pieces else room


def convex_corners(floor: BaseGeometry) -> list[tuple[float, float, float, float]]:
    """Return the convex corners of a rectilinear floor: (x, y, inward x, inward y)."""
    corners = []
    for polygon in getattr(floor, "geoms", [floor]):
        ring = list(polygon.exterior.coords)[:-1]
        if not polygon.exterior.is_ccw:
            ring.reverse()
        for (px, py), (x, y), (nx, ny) in zip(ring[-1:] + ring[:-1], ring, ring[1:] + ring[:1], strict=True):
            if (x - px) * (ny - y) - (y - py) * (nx - x) > 0:
                inward = np.sign([px - x + nx - x, py - y + ny - y])
                corners.append((x, y, float(inward[0]), float(inward[1])))
    return corners


def is_simple_row(plan: FloorPlan) -> bool:
    """Return whether each room is joined to the next one, as random_plan promises unless the rooms are closed off."""
    joined = [set(door.rooms) for door in plan.doors]
    return all({a.name, b.name} in joined for a, b in pairwise(plan.rooms))
