"""Worlds of six rooms with an object to be carried to or in a distant one; the same for the same kind and seed."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from shapely import Polygon, union_all
from shapely.affinity import rotate, translate

from benchmarks.worlds.carrying import carried, door_widths, load
from benchmarks.worlds.floorplans import FloorPlan, random_plan
from benchmarks.worlds.placing import OBJECT_GAP, face, spot
from benchmarks.worlds.scenes import RandomScenario, wkt
from benchmarks.worlds.walking import corner_box, furthest_corner
from utak.kb.perception.frame import turned

SIX_ROOM_SHAPES = {"corner": "square", "pose": "l_shape"}  # else the kind is the shape
MIN_CARRY_DOORS = 3  # doors between a thing and where it must go
MIN_WALK_DOORS = 2  # doors between Utak and a thing for the next room
SIX_ROOM_TASKS = {"corner": 5, "square": 6, "brick": 7, "l_shape": 9, "pose": 6}


def six_room_world(kind: str, seed: int, loops: bool = False) -> RandomScenario:
    """Return a random world of six rooms.

    Parameters
    ----------
    kind : corner: a square to the northeast corner of the whole floor, MIN_CARRY_DOORS doors away or more. pose: an L
        to a pose so far away. square, l_shape: into the next room, MIN_WALK_DOORS from the robot or more. brick: so
        through a door.
    seed : any integer from 0.
    loops : whether some rooms are joined to others than the next, too. Then pieces of wall stand alone between doors.
    """
    rng = np.random.default_rng([sorted(SIX_ROOM_TASKS).index(kind), seed, 6])
    while True:
        made = _drawn(rng, kind, seed, 0.3 * loops)
        if made is not None:
            return made


def doors_between(plan: FloorPlan, one: str) -> dict[str, int]:
    """Return the number of doors between a room and each room."""
    away, front = {one: 0}, [one]
    while front:
        room = front.pop(0)
        for other in plan.neighbours(room):
            if other not in away:
                away[other] = away[room] + 1
                front.append(other)
    return away


def _drawn(rng: np.random.Generator, kind: str, seed: int, loops: float) -> RandomScenario | None:
    """Return a world, or None when what was drawn is too near, or leaves no room."""
    shape = SIX_ROOM_SHAPES.get(kind, kind)
    outline, least = load(rng, shape)
    plan = random_plan(rng, 6, door_widths(least, False), loops=loops)
    away = doors_between(plan, home := f"r{int(rng.integers(6)) + 1}")
    far = [room.polygon for room in plan.rooms if away[room.name] >= MIN_CARRY_DOORS]
    heading, goal, target = face(rng), "in(x, room(next)).\n", union_all([plan.room(n) for n in plan.neighbours(home)])
    if kind == "brick":
        goal, target = "through(x, d).\n", union_all([room.polygon for room in plan.rooms if room.name != home])
    if kind == "corner":
        corner = furthest_corner(plan.floor, "northeast", heading)
        if corner is None or not any(room.intersects(corner_box(corner, 1.0)) for room in far):
            return None
        goal, target = "at(x, corner(northeast)).\n", corner_box(corner, outline.bounds[2] + 1.5)
    made = carried(rng, SIX_ROOM_TASKS[kind], seed, plan, shape, outline, home, target, goal, heading, 0.0)
    if made is None or kind in ("corner", "pose"):
        return made if made is None or kind == "corner" else _posed(rng, made, far)
    stands = next((room.name for room in plan.rooms if room.polygon.covers(made.utak)), home)
    return made if away[stands] >= MIN_WALK_DOORS else None


def _posed(rng: np.random.Generator, world: RandomScenario, rooms: Sequence[Polygon]) -> RandomScenario | None:
    """Return the same world with its object to be brought to a pose in one of some rooms."""
    thing, quarters = world.things[0].polygon, int(rng.integers(4))
    if not rooms:
        return None
    room = rooms[int(rng.integers(len(rooms)))].buffer(-OBJECT_GAP)
    spun = rotate(thing, 90.0 * quarters, origin="centroid")
    goal = spot(rng, room)
    x, y = goal.x - thing.centroid.x, goal.y - thing.centroid.y
    there = translate(spun, x, y)
    if not room.covers(there) or any(other.polygon.distance(there) < OBJECT_GAP for other in world.things[1:]):
        return None
    east, north = turned(goal.x - world.utak.x, goal.y - world.utak.y, -world.heading)
    text = f'pose(x, "POINT ({east:.4f} {north:.4f})", {90 * quarters}).\n'
    texts = replace(world.texts, goal=text, expect=f'inside(t1, "{wkt(there.buffer(0.5))}").\n')
    return replace(world, texts=texts, target=there)
