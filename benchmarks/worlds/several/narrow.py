"""Worlds with narrow places, in which it matters what is put there first, and how deep.

A closet is a small room behind a door: what is put down right behind the door blocks it. In a dead end things must lie
one behind the other. In a neck between two rooms one thing shall lie where another one must go through, or a row of
things must be cleared away before another one can go through.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from shapely import Polygon, box

from benchmarks.worlds.floorplans import FloorPlan, PlanRoom
from benchmarks.worlds.furniture import THING_COLOURS, ell, rectangle
from benchmarks.worlds.scenes import PlacedThing
from benchmarks.worlds.several.scene import (
    SEVERAL_WALL,
    Load,
    Scene,
    beyond,
    door_range,
    finished,
    joined,
    loads,
    mirrored,
    placed,
    quarter_heading,
    robot_place,
)
from benchmarks.worlds.several.tasks import PARAMETERS, SeveralWorld, Want, to_pose, to_room

CLOSET_KIND = "closet"
DEAD_END_KIND = "dead_end"
PLUG_KIND = "plug"
ROW_KIND = "row"
THREE_SHARE = 0.4  # of the closets and dead ends take three things
EXCHANGE_SHARE = 0.5  # of the dead ends for two things: they lie there already, the wrong way round
MIN_ROW_DOOR = 4  # squares: of a neck in which things two squares thick stand a square from both walls
HALL_SIDES = (20, 27)  # squares: of the room before the narrow place, from 20 to 26
CLOSET_ELL = Load("l_shape", ell(5, 5, 2), 4.0)


def closet_world(rng: np.random.Generator, seed: int) -> SeveralWorld | None:
    """Return a world in which two or three things belong into a closet; None for no place.

    The closet is just deep and wide enough for its opening to be a door.
    """
    side, long, thin = int(rng.integers(4, 6)), int(rng.integers(7, 10)), int(rng.integers(3, 5))
    carried = [Load("square", rectangle(side, side), float(side)), Load("brick", rectangle(long, thin), float(thin))]
    carried += [CLOSET_ELL] if rng.random() < THREE_SHARE else []
    door = side + 1
    closet = 2 * door + int(rng.integers(0, 3)), 2 * door + int(rng.integers(0, 3))
    plan = _attached(rng, closet, door)
    carried = [carried[int(k)] for k in rng.permutation(len(carried))]
    hall = plan.room("r1")
    things = placed(rng, carried, [hall] * len(carried), [door.polygon for door in plan.doors])
    utak = things and robot_place(rng, hall, things)
    if not things or utak is None:
        return None
    scene = Scene(plan, things, False, utak, quarter_heading(rng))
    wants = [to_room(PARAMETERS[k], thing, beyond(plan, "r1")) for k, thing in enumerate(things)]
    return finished(CLOSET_KIND, seed, f"{len(things)} things", scene, [wants], len(things))


def dead_end_world(rng: np.random.Generator, seed: int) -> SeveralWorld | None:
    """Return a world in which two or three things shall lie one behind the other in a dead end; None for no place."""
    count = 3 if rng.random() < THREE_SHARE else 2
    width = int(rng.integers(4, 8))
    carried, by_colour = loads(rng, count, ("square", "brick", "square")[:count])
    by_colour = by_colour or count == 3
    sizes = [tuple(int(side) for side in load.outline.bounds[2:]) for load in carried]
    exchange = count == 2 and rng.random() < EXCHANGE_SHARE
    if any(high + 2 * exchange > width for _, high in sizes):
        return None
    gaps = [int(rng.integers(int(exchange), 3)) for _ in carried]
    depth = sum(long for long, _ in sizes) + sum(gaps) + int(rng.integers(1, 6))
    long, across, wall = *(int(rng.integers(*HALL_SIDES)) for _ in range(2)), SEVERAL_WALL
    south, mirror = wall + int(rng.integers(0, across - width + 1)), int(rng.integers(8))
    table = (long + depth + 2 * wall, across + 2 * wall)
    hall = mirrored(box(wall, wall, wall + long, wall + across), *table, mirror)
    alley = mirrored(box(wall + long, south, wall + long + depth, south + width), *table, mirror)
    floor = hall.union(alley).simplify(0)
    assert isinstance(floor, Polygon)
    plan = FloorPlan(*(table[::-1] if mirror & 4 else table), (PlanRoom("r1", floor),), ())
    things = placed(rng, carried, [hall] * count, [alley])
    utak = things and robot_place(rng, hall, things)
    if not things or utak is None:
        return None

    def queue(order: Sequence[int], gap: int) -> dict[int, Polygon]:
        """Return the places of things in the dead end, the first one deepest. gap : at least, from its side walls."""
        places, east = {}, wall + long + depth
        for k in order:
            east -= gaps[k]
            at = south + int(rng.integers(gap, width - sizes[k][1] - gap + 1))
            places[k] = mirrored(box(east - sizes[k][0], at, east, at + sizes[k][1]), *table, mirror)
            east -= sizes[k][0]
        return places

    order = [int(k) for k in rng.permutation(count)]
    places, variant = queue(order, int(exchange)), "exchange" if exchange else f"{count} things"
    if exchange:  # they lie there already, the wrong way round
        begin = queue(order[::-1], 1)
        things = tuple(replace(thing, polygon=begin[k]) for k, thing in enumerate(things))
    scene = Scene(plan, things, by_colour, utak, quarter_heading(rng))
    wants = [_filling(k, places[k], scene) for k in range(count)]
    return finished(DEAD_END_KIND, seed, variant, scene, [wants], count)


def plug_world(rng: np.random.Generator, seed: int) -> SeveralWorld | None:
    """Return a world in which y shall lie in the only neck through which x must go; None for no place."""
    carried, by_colour = loads(rng, 2, ("square", "brick"))
    low, high = door_range(carried)
    door = int(rng.integers(low, high + 1))
    long, thin = (int(side) for side in carried[1].outline.bounds[2:])
    neck_length = long + int(rng.integers(2, 5))
    sides = [max(int(rng.integers(16, 22)), 2 * door + 1) for _ in range(3)]
    wall = SEVERAL_WALL
    at = wall + int(rng.integers(2, sides[2] - door - 1))
    first, gate = wall + sides[0], wall + sides[0] + neck_length
    table, mirror = (gate + sides[1] + wall, sides[2] + 2 * wall), int(rng.integers(8))
    rooms = box(wall, wall, first, wall + sides[2]), box(gate, wall, gate + sides[1], wall + sides[2])
    plan = joined(table, *rooms, box(first, at, gate, at + door), mirror)
    things = placed(rng, carried, [plan.room("r1")] * 2, [door.polygon for door in plan.doors])
    utak = things and robot_place(rng, plan.room("r1"), things)
    if not things or utak is None:
        return None
    west, south = first + int(rng.integers(1, neck_length - long)), at + int(rng.integers(0, door - thin + 1))
    place = mirrored(box(west, south, west + long, south + thin), *table, mirror)
    scene = Scene(plan, things, by_colour, utak, quarter_heading(rng))
    wants = [to_room("x", things[0], beyond(plan, "r1")), _filling(1, place, scene)]
    return finished(PLUG_KIND, seed, "", scene, [wants], 2)


def row_world(rng: np.random.Generator, seed: int) -> SeveralWorld | None:
    """Return a world in which x belongs beyond a neck that a row of other things fills; None for no place."""
    (carried,), _ = loads(rng, 1, ("square", "brick"))
    count = int(rng.integers(1, 4))
    door = max(int(carried.least), MIN_ROW_DOOR - 2) + int(rng.integers(1, 3))
    if door < MIN_ROW_DOOR:
        return None
    sizes = [(int(rng.integers(2, 5)), int(rng.integers(2, door - 1))) for _ in range(count)]
    gaps = [int(rng.integers(1, 3)) for _ in range(count + 1)]
    neck_length = sum(long for long, _ in sizes) + sum(gaps)
    wall = SEVERAL_WALL
    sides = [max(int(rng.integers(16, 22)), 2 * door + 1) for _ in range(3)]
    at = wall + int(rng.integers(2, sides[2] - door - 1))
    first, gate = wall + sides[0], wall + sides[0] + neck_length
    table, mirror = (gate + sides[1] + wall, sides[2] + 2 * wall), int(rng.integers(8))
    rooms = box(wall, wall, first, wall + sides[2]), box(gate, wall, gate + sides[1], wall + sides[2])
    plan = joined(table, *rooms, box(first, at, gate, at + door), mirror)
    home = plan.room("r1")
    things = placed(rng, [carried], [home], [plan.doors[0].polygon])
    utak = things and robot_place(rng, home, things)
    if not things or utak is None:
        return None
    x = first
    for number, ((long, high), gap) in enumerate(zip(sizes, gaps, strict=False)):
        x += gap
        south = at + int(rng.integers(1, door - high))  # a square from the walls, where x cannot pass it
        polygon = mirrored(box(x, south, x + long, south + high), *table, mirror)
        shape = "square" if long == high else "brick"
        if shape == carried.shape:
            return None
        things = (*things, PlacedThing(f"d{number + 1}", str(rng.choice(list(THING_COLOURS))), shape, polygon))
        x += long
    scene = Scene(plan, things, False, utak, quarter_heading(rng))
    return finished(ROW_KIND, seed, f"{count} in the way", scene, [[to_room("x", things[0], beyond(plan, "r1"))]], 1)


def _attached(rng: np.random.Generator, closet: tuple[int, int], door: int) -> FloorPlan:
    """Return a hall r1 with a closet r2 behind a door. closet : squares along and across. door : its width."""
    wall = SEVERAL_WALL
    long, across = int(rng.integers(*HALL_SIDES)), max(int(rng.integers(*HALL_SIDES)), closet[1])
    south = wall + int(rng.integers(0, across - closet[1] + 1))
    at = south + int(rng.integers(2, closet[1] - door - 1))
    west = long + 2 * wall
    hall, inner = box(wall, wall, wall + long, wall + across), box(west, south, west + closet[0], south + closet[1])
    table = (west + closet[0] + wall, across + 2 * wall)
    return joined(table, hall, inner, box(wall + long, at, west, at + door), int(rng.integers(8)))


def _filling(number: int, place: Polygon, scene: Scene) -> Want:
    """Return the want that the rectangle with a number fills a place; it is turned when its sides want it so."""
    thing = scene.things[number]
    sides = [(shape.bounds[2] - shape.bounds[0], shape.bounds[3] - shape.bounds[1]) for shape in (thing.polygon, place)]
    degrees = 0.0 if abs(sides[0][0] - sides[1][0]) < 0.5 else 90.0
    dx, dy = place.centroid.x - thing.polygon.centroid.x, place.centroid.y - thing.polygon.centroid.y
    return to_pose(PARAMETERS[number], thing, (dx, dy, degrees), scene.utak, scene.heading)
