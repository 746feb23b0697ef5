"""Random worlds for the tasks in which the robot carries nothing.

(i) Go to the northeast corner, (ii) to the next room, (iii) to the square, (iv) around the square and return.
"""

import math

import numpy as np
from shapely import Point, Polygon, box, union_all
from shapely.affinity import translate
from shapely.geometry.base import BaseGeometry

from benchmarks.worlds.floorplans import FloorPlan, convex_corners, random_plan
from benchmarks.worlds.furniture import rectangle
from benchmarks.worlds.placing import OBJECT_GAP, colour, face, furniture, lay, spot, stand
from benchmarks.worlds.scenes import Maker, PlacedThing, RandomScenario, TaskTexts, random_scenario, wkt

DOORS = (3, 6)
EYESHOT = 8.0  # squares: what lies so near is seen at every heading
CORNER_MARGIN = 3.0  # squares: a corner must be further out than all others by so much
CORNER_BOX_SIDE = 2.5  # squares: side of the box that Utak must be in at a corner
CORNER_DIRECTIONS = {"northeast": (1, 1), "northwest": (-1, 1), "southwest": (-1, -1), "southeast": (1, -1)}
SQUARE_FACTS = "object(x).\nshape(x, square).\n"
NO_REGION = Polygon()
WHY = {
    "": "",
    "none": "there is no square",
    "ring": "the square is walled in",
    "flush": "the square stands against a wall",
    "closed": "the square is in a closed room",
}


def walls(rng: np.random.Generator) -> int:
    """Return the thickness of the walls: 2 squares, now and then 1 or 3."""
    return int(rng.choice([2, 2, 2, 2, 2, 2, 2, 2, 1, 3]))


def corner_box(corner: tuple[float, float, float, float], side: float) -> Polygon:
    """Return the box of a given side in a corner of the floor."""
    x, y, inward_x, inward_y = corner
    return box(
        min(x, x + side * inward_x),
        min(y, y + side * inward_y),
        max(x, x + side * inward_x),
        max(y, y + side * inward_y),
    )


def furthest_corner(floor: BaseGeometry, compass: str, heading: int) -> tuple[float, float, float, float] | None:
    """Return the convex corner of a floor furthest towards a corner of the robot's frame; None when two nearly tie."""
    east, north = CORNER_DIRECTIONS[compass]
    c, s = math.cos(math.radians(heading)), math.sin(math.radians(heading))
    towards = ((east * c - north * s) / math.sqrt(2), (east * s + north * c) / math.sqrt(2))
    ranked = sorted(convex_corners(floor), key=lambda k: -(k[0] * towards[0] + k[1] * towards[1]))
    best, second = (k[0] * towards[0] + k[1] * towards[1] for k in ranked[:2])
    return ranked[0] if best - second >= CORNER_MARGIN else None


def corner_world(rng: np.random.Generator, seed: int, unable: bool) -> RandomScenario | None:
    """Return a world of task (i): go to the northeast corner (now and then another) of the whole floor.

    unable : whether it lies in a closed room.
    """
    plan = random_plan(rng, 2 if unable else int(rng.integers(1, 4)), DOORS, walls(rng), closed=unable)
    heading = face(rng)
    compass = "northeast" if rng.random() < 0.75 else str(rng.choice(sorted(CORNER_DIRECTIONS)))
    corner = furthest_corner(plan.floor, compass, heading)
    if corner is None:
        return None
    target = corner_box(corner, CORNER_BOX_SIDE)
    rooms = [room.polygon for room in plan.rooms]
    starts = [room for room in rooms if not (unable and room.intersects(target))]
    if unable and not _overlooks(starts[0], compass, heading, union_all(rooms).difference(starts[0])):
        return None
    things = furniture(rng, rooms, int(rng.integers(0, 5)), [target, *_necks(plan)])
    utak = stand(rng, starts, things, target, 6)
    expect = f'inside(utak, "{wkt(target)}").\n'
    why = "the corner is in a room without a door" if unable else ""
    return random_scenario(
        1, seed, plan, things, utak, heading, TaskTexts("", f"at(utak, corner({compass})).\n", expect, why), target
    )


def _overlooks(room: Polygon, compass: str, heading: int, beyond: BaseGeometry) -> bool:
    """Return whether the floor beyond a closed room's wall can be seen from the furthest corner of the room."""
    corner = furthest_corner(room, compass, heading)
    return corner is not None and Point(corner[:2]).distance(beyond) < EYESHOT


def next_room_world(rng: np.random.Generator, seed: int, unable: bool) -> RandomScenario | None:
    """Return a world of task (ii): go to any room that shares a door with the first.

    unable : whether there is none, or no door.
    """
    closed = unable and rng.random() < 0.3
    count = (2 if closed else 1) if unable else int(rng.integers(2, 4))
    plan = random_plan(rng, count, DOORS, walls(rng), closed=closed)
    first = plan.rooms[rng.integers(len(plan.rooms))]
    things = furniture(rng, [room.polygon for room in plan.rooms], int(rng.integers(0, 5)), _necks(plan))
    utak = stand(rng, [first.polygon], things, NO_REGION, 0)
    target = union_all([plan.room(name) for name in plan.neighbours(first.name)])
    expect = "" if unable else f'inside(utak, "{wkt(target)}").\n'
    why = ("no door leads to the other room" if closed else "there is one room only") if unable else ""
    return random_scenario(
        2, seed, plan, things, utak, face(rng), TaskTexts("", "in(utak, room(next)).\n", expect, why), target
    )


def to_square_world(rng: np.random.Generator, seed: int, unable: bool) -> RandomScenario | None:
    """Return a world of task (iii): go to the square, now and then to either of two.

    unable : whether there is none, or it is walled in or in a closed room.
    """
    kind = str(rng.choice(["none", "ring", "closed"])) if unable else ""
    plan = _any_plan(rng, kind == "closed")
    count = 0 if kind == "none" else 1 + int(not unable and rng.random() < 0.2)
    squares = _squares(rng, plan, count) if kind != "ring" else _ringed(rng, plan)
    if squares is None:
        return None
    rooms = [room.polygon for room in plan.rooms]
    keep = [*_necks(plan), *(thing.polygon for thing in squares)]
    things = squares + furniture(rng, rooms, int(rng.integers(0, 5 - count)), keep, without=["square"])
    goals = union_all([thing.polygon for thing in squares if thing.shape == "square"])
    starts = [room for room in rooms if not (kind == "closed" and room.intersects(goals))]
    utak = stand(rng, starts, [thing for thing in things if thing.shape != "wall"] + _filled(things), goals, 6)
    expect = f'near(utak, "{wkt(goals)}", 2).\n' if count else ""
    texts = TaskTexts(SQUARE_FACTS, "at(utak, x).\n", expect, WHY[kind])
    return random_scenario(3, seed, plan, things, utak, face(rng), texts, goals.buffer(2, quad_segs=8))


def round_square_world(rng: np.random.Generator, seed: int, unable: bool) -> RandomScenario | None:
    """Return a world of task (iv): go around the square and return.

    unable : whether there is none, or it stands against a wall or in a closed room.
    """
    kind = str(rng.choice(["none", "flush", "closed"])) if unable else ""
    plan = _any_plan(rng, kind == "closed")
    squares = _squares(rng, plan, 0 if kind == "none" else 1) if kind != "flush" else _flush(rng, plan)
    if squares is None:
        return None
    rooms = [room.polygon for room in plan.rooms]
    keep = [*_necks(plan), *(thing.polygon for thing in squares)]
    things = squares + furniture(rng, rooms, int(rng.integers(0, 4)), keep, without=["square"])
    goals = union_all([thing.polygon for thing in squares])
    starts = [room for room in rooms if not (kind == "closed" and room.intersects(goals))]
    utak = stand(rng, starts, things, goals, 1)
    if utak is None:
        return None
    circle = "circles(utak, t1).\nunmoved(t1).\n" if squares else ""
    expect = circle + f'near(utak, "{wkt(utak)}", 2).\n'
    texts = TaskTexts(SQUARE_FACTS, "circled(utak, x).\nat(utak, start).\n", expect, WHY[kind])
    return random_scenario(4, seed, plan, things, utak, face(rng), texts, NO_REGION)


WALKING: dict[int, Maker] = {
    1: corner_world,
    2: next_room_world,
    3: to_square_world,
    4: round_square_world,
}


def _any_plan(rng: np.random.Generator, closed: bool) -> FloorPlan:
    return random_plan(rng, 2 if closed else int(rng.integers(1, 4)), DOORS, walls(rng), closed=closed)


def _necks(plan: FloorPlan) -> list[BaseGeometry]:
    return [door.polygon for door in plan.doors]


def _squares(rng: np.random.Generator, plan: FloorPlan, count: int) -> tuple[PlacedThing, ...] | None:
    """Return `count` squares anywhere, a third of them rotated; None when one finds no place."""
    made: list[PlacedThing] = []
    for number in range(count):
        room = plan.rooms[rng.integers(len(plan.rooms))].polygon
        taken = [*_necks(plan), *(thing.polygon for thing in made)]
        polygon = lay(rng, "square", room, taken, turned=bool(rng.random() < 0.35))
        if polygon is None:
            return None
        made.append(PlacedThing(f"t{number + 1}", colour(rng), "square", polygon))
    return tuple(made)


def _ringed(rng: np.random.Generator, plan: FloorPlan) -> tuple[PlacedThing, ...] | None:
    """Return a square of side 3 in a yard of fixed walls 2 thick: two simple polygons that touch, longer than wide."""
    yard = lay(rng, rectangle(14, 11), plan.rooms[rng.integers(len(plan.rooms))].polygon, _necks(plan))
    if yard is None:
        return None
    west, south, east, north = yard.bounds
    corners = [(east, south), (east, south + 2), (west + 2, south + 2), (west + 2, north), (west, north)]
    half = Polygon([(west, south), *corners])
    inner = box(west + 2, south + 2, east - 2, north - 2)
    rest = yard.difference(half).difference(inner)
    middle = inner.centroid
    square = translate(rectangle(3, 3), math.floor(middle.x - 1), math.floor(middle.y - 1))
    shade = colour(rng)
    halves = [PlacedThing(f"p{k + 1}", shade, "wall", part, fixed=True) for k, part in enumerate((half, rest))]
    return (PlacedThing("t1", colour(rng), "square", square), *halves)


def _filled(things: tuple[PlacedThing, ...]) -> list[PlacedThing]:
    """Return the yard with all that is in it as one object, so that the robot does not begin inside."""
    parts = [thing.polygon for thing in things if thing.shape == "wall"]
    return [PlacedThing("yard", "a", "wall", union_all(parts).envelope)] if parts else []


def _flush(rng: np.random.Generator, plan: FloorPlan) -> tuple[PlacedThing, ...] | None:
    """Return a square that stands against the wall of a room, clear of its corners and doors."""
    room = plan.rooms[rng.integers(len(plan.rooms))].polygon
    side = int(rng.integers(3, 6))
    west, south, east, north = (int(v) for v in room.bounds)
    at = spot(rng, room)
    x, y = [
        (west, int(at.y)),
        (east - side, int(at.y)),
        (int(at.x), south),
        (int(at.x), north - side),
    ][rng.integers(4)]
    square = translate(rectangle(side, side), x, y)
    along = square.intersection(room.boundary).length
    clear = all(square.distance(neck) >= OBJECT_GAP for neck in _necks(plan))
    fits = room.covers(square) and abs(along - side) < 1e-9 and clear
    return (PlacedThing("t1", colour(rng), "square", square),) if fits else None
