"""The places of objects and of the robot: clear of walls, doors, each other and of what the task needs free."""

from collections.abc import Sequence

import numpy as np
import shapely
from shapely import Point, Polygon, box
from shapely.geometry.base import BaseGeometry

from benchmarks.worlds.furniture import OUTLINE_SHAPES, THING_COLOURS, laid, outline
from benchmarks.worlds.scenes import PlacedThing

OBJECT_GAP = 3.0  # squares between an object and anything else: at least two whole free squares for Utak
TURNED_GAP = 4.0  # between an object at an odd angle and another one: its squares reach beyond its sides
MAX_PLACING_TRIES = 80


def spot(rng: np.random.Generator, room: BaseGeometry) -> Point:
    """Return a point of the bounding box of a room."""
    west, south, east, north = room.bounds
    return Point(float(rng.uniform(west, east)), float(rng.uniform(south, north)))


def lay(
    rng: np.random.Generator,
    shape: str | Polygon,
    room: BaseGeometry,
    others: Sequence[BaseGeometry],
    turned: bool = False,
    wall_gap: float = OBJECT_GAP,
) -> Polygon | None:
    """Return a shape (by class, or its outline) in a room, clear of its walls and of others; None for no place."""
    inner = room.buffer(-wall_gap)
    for _ in range(MAX_PLACING_TRIES):
        raw = outline(rng, shape, turned) if isinstance(shape, str) else shape
        here = laid(rng, raw, spot(rng, room), turned)
        gap = TURNED_GAP if turned else OBJECT_GAP
        if inner.covers(here) and all(here.distance(other) >= gap for other in others):
            return here
    return None


def furniture(
    rng: np.random.Generator,
    rooms: Sequence[Polygon],
    count: int,
    keep_clear: Sequence[BaseGeometry],
    without: Sequence[str] = (),
) -> tuple[PlacedThing, ...]:
    """Return up to `count` objects of all shapes but those in `without`, named d1, d2 ...; some rotated or fixed."""
    shapes = [shape for shape in OUTLINE_SHAPES if shape not in without]
    things: list[PlacedThing] = []
    for _ in range(count):
        room = rooms[int(rng.integers(len(rooms)))]
        shape, turned = shapes[rng.integers(len(shapes))], bool(rng.random() < 0.35)
        taken = [*keep_clear, *(thing.polygon for thing in things)]
        polygon = lay(rng, shape, room, taken, turned)
        if polygon is not None:
            fixed = bool(rng.random() < 0.12)
            things.append(PlacedThing(f"d{len(things) + 1}", colour(rng), shape, polygon, fixed))
    return tuple(things)


def colour(rng: np.random.Generator) -> str:
    """Return any colour but the verge's."""
    return THING_COLOURS[rng.integers(len(THING_COLOURS))]


def stand(
    rng: np.random.Generator,
    rooms: Sequence[Polygon],
    things: Sequence[PlacedThing],
    away: BaseGeometry,
    distance: float,
) -> Point | None:
    """Return a place for the robot in a free square of a room, at least `distance` from a region; None for none.

    Mostly it is the middle of the square, now and then any point of it.
    """
    for _ in range(MAX_PLACING_TRIES):
        at = spot(rng, rooms[int(rng.integers(len(rooms)))])
        west, south = int(at.x), int(at.y)
        square = box(west, south, west + 1, south + 1)
        inside = any(room.covers(square) for room in rooms)
        free = all(square.intersection(thing.polygon).area == 0 for thing in things)
        if inside and free and (away.is_empty or at.distance(away) >= distance):
            if rng.random() < 0.85:
                return Point(west + 0.5, south + 0.5)
            return Point(*(corner + round(float(rng.uniform(0.05, 0.95)), 2) for corner in (west, south)))
    return None


def face(rng: np.random.Generator) -> int:
    """Return a heading in degrees: half of them quarter turns, half any whole degree."""
    return int(rng.integers(4)) * 90 if rng.random() < 0.5 else int(rng.integers(360))


def digital(shape: BaseGeometry, width: int, height: int) -> np.ndarray:
    """Return the squares whose open interior meets a shape: bool (height, width), row 0 in the south."""
    columns, rows = np.meshgrid(np.arange(width), np.arange(height))
    cut = shapely.intersection(shapely.box(columns, rows, columns + 1, rows + 1), shape)
    return np.asarray(shapely.area(cut) > 1e-9)
