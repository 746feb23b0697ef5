"""Random worlds for the tasks (v) to (ix), in which the robot carries an object."""

import math
from collections.abc import Sequence
from functools import partial

import numpy as np
from shapely import Point, Polygon, union_all
from shapely.geometry.base import BaseGeometry

from benchmarks.worlds.floorplans import ROOM_SIDES, SNUG, FloorPlan, PlanDoor, SidesByCount, corridor, random_plan
from benchmarks.worlds.furniture import ell, rectangle
from benchmarks.worlds.placing import colour, face, furniture, lay, stand
from benchmarks.worlds.scenes import Maker, PlacedThing, RandomScenario, TaskTexts, random_scenario, wkt
from benchmarks.worlds.walking import NO_REGION, corner_box, furthest_corner

# Least door in a wall 2 thick that an L of arms `a` and width `w` passes: {(a, w): squares}. Found by a flood of the
# grid of poses, so right to about 0.1; that of (6, 2) agrees with 3.80-3.88, proved by other means.
ELLS = {(5, 2): 3.84, (6, 2): 3.84, (7, 2): 3.84, (8, 2): 3.84, (6, 3): 5.28, (8, 3): 5.26}


def load(rng: np.random.Generator, shape: str) -> tuple[Polygon, float]:
    """Return an outline to be carried and the least width of a passage in a wall 2 thick that lets it through."""
    if shape == "square":
        side = int(rng.integers(3, 6))
        return rectangle(side, side), float(side)
    if shape == "brick":
        thin = int(rng.integers(2, 4))
        return rectangle(thin + int(rng.integers(2, 4)), thin), float(thin)
    sizes = sorted(ELLS)
    arm, thick = sizes[rng.integers(len(sizes))]
    return ell(arm, arm, thick), ELLS[arm, thick]


def door_widths(least: float, narrow: bool) -> tuple[int, int]:
    """Return door widths: 1 to 3 squares more than the least passage, or half a square to one and a half less."""
    if narrow:
        width = math.ceil(least - 1.5)
        return width, width
    return math.ceil(least + 1), math.floor(least + 3)


def to_corner_world(
    rng: np.random.Generator, seed: int, narrow: bool, sides: SidesByCount = ROOM_SIDES, fewest: int = 1
) -> RandomScenario | None:
    """Return a world of task (v): push the square into the northeast corner of the floor.

    narrow : whether the corner is beyond a door that is too narrow. fewest : the least number of rooms.
    """
    outline, least = load(rng, "square")
    plan = random_plan(rng, 2 if narrow else int(rng.integers(fewest, 4)), door_widths(least, narrow), sides=sides)
    heading = face(rng)
    corner = furthest_corner(plan.floor, "northeast", heading)
    if corner is None:
        return None
    target = corner_box(corner, outline.bounds[2] + 1.5)
    home = _one_of(rng, [r.name for r in plan.rooms if not (narrow and r.polygon.intersects(target))])
    goal = "at(x, corner(northeast)).\n"
    return carried(rng, 5, seed, plan, "square", outline, home, target, goal, heading, least if narrow else 0.0)


def next_room_world(
    rng: np.random.Generator,
    seed: int,
    narrow: bool,
    task: int = 6,
    shape: str = "square",
    sides: SidesByCount = ROOM_SIDES,
) -> RandomScenario | None:
    """Return a world of task (vi), push the square, or (ix), push the L-shaped object, into the next room."""
    outline, least = load(rng, shape)
    plan = random_plan(rng, 2 if narrow else int(rng.integers(2, 4)), door_widths(least, narrow), sides=sides)
    home = _one_of(rng, [room.name for room in plan.rooms])
    target = union_all([plan.room(name) for name in plan.neighbours(home)])
    goal = "in(x, room(next)).\n"
    return carried(rng, task, seed, plan, shape, outline, home, target, goal, face(rng), least if narrow else 0.0)


def through_door_world(
    rng: np.random.Generator, seed: int, narrow: bool, sides: SidesByCount = ROOM_SIDES
) -> RandomScenario | None:
    """Return a world of task (vii): push the brick through a door, and so into any other room."""
    outline, least = load(rng, "brick")
    plan = random_plan(rng, 2 if narrow else int(rng.integers(2, 4)), door_widths(least, narrow), sides=sides)
    home = _one_of(rng, [room.name for room in plan.rooms])
    target = union_all([room.polygon for room in plan.rooms if room.name != home])
    goal = "through(x, d).\n"
    return carried(rng, 7, seed, plan, "brick", outline, home, target, goal, face(rng), least if narrow else 0.0)


def around_corner_world(rng: np.random.Generator, seed: int, narrow: bool) -> RandomScenario | None:
    """Return a world of task (viii): push the brick around the corner of a corridor.

    narrow : whether the second arm is narrower than the brick.
    """
    outline, least = load(rng, "brick")
    long, thin = int(outline.bounds[2]), int(least)
    low = long + 4  # Utak has to get round the brick in the first arm
    first = int(rng.integers(low, low + 4))
    second = thin - 1 if narrow else int(rng.integers(long + 1, long + 6))
    plan, one, two = corridor(rng, (first, second))
    polygon = lay(rng, outline, one, [two], wall_gap=1.5)
    if polygon is None or polygon.distance(two) < 6:
        return None
    thing = PlacedThing("t1", colour(rng), "brick", polygon)
    utak = stand(rng, [one], [thing], NO_REGION, 0)
    missing = float(thin - second) if narrow else 0.0
    return _finished(8, seed, plan, (thing,), utak, face(rng), "around(x, corner).\n", two, missing)


CARRYING: dict[int, Maker] = {
    5: to_corner_world,
    6: next_room_world,
    7: through_door_world,
    8: around_corner_world,
    9: partial(next_room_world, task=9, shape="l_shape"),
}
CARRYING_SNUG: dict[int, Maker] = CARRYING | {
    5: partial(to_corner_world, sides=SNUG, fewest=2),
    6: partial(next_room_world, sides=SNUG),
    7: partial(through_door_world, sides=SNUG),
    9: partial(next_room_world, task=9, shape="l_shape", sides=SNUG),
}


def _one_of(rng: np.random.Generator, names: Sequence[str]) -> str:
    return names[int(rng.integers(len(names)))]


def carried(
    rng: np.random.Generator,
    task: int,
    seed: int,
    plan: FloorPlan,
    shape: str,
    outline: Polygon,
    home: str,
    target: BaseGeometry,
    goal: str,
    heading: int,
    least: float,
) -> RandomScenario | None:
    """Return a world with the load in its home room and up to two other objects; None when these block its way."""
    necks = [door.polygon for door in plan.doors]
    polygon = lay(rng, outline, plan.room(home), [*necks, *([target] if task == 5 else [])])
    if polygon is None:
        return None
    thing = PlacedThing("t1", colour(rng), shape, polygon)
    span = math.hypot(outline.bounds[2], outline.bounds[3])
    keep = [polygon, *[neck.buffer(span) for neck in necks], *([target.buffer(span)] if task == 5 else [])]
    rooms = [room.polygon for room in plan.rooms]
    things = (thing, *furniture(rng, rooms, int(rng.integers(0, 3)), keep, without=[shape]))
    utak = stand(rng, rooms if least == 0 else [plan.room(home)], things, NO_REGION, 0)
    if not least and not _roomy(plan, things, span / 2 + 0.5, target if task == 5 else None):
        return None
    missing = least - plan.doors[0].width if least else 0.0
    return _finished(task, seed, plan, things, utak, heading, goal, target, missing)


def _roomy(plan: FloorPlan, things: Sequence[PlacedThing], radius: float, target: BaseGeometry | None) -> bool:
    """Return whether a disc around the load can move in each room from the load to the doors and the target's box."""
    for room in plan.rooms:
        others = union_all([thing.polygon for thing in things[1:]])
        free = room.polygon.buffer(-radius).difference(others.buffer(radius))
        parts = [part for part in getattr(free, "geoms", [free]) if part.area > 1]
        doors = [_before(door, room.polygon, radius) for door in plan.doors if room.name in door.rooms]
        places = [place.buffer(1.0) for place in doors]
        if room.polygon.covers(things[0].polygon):
            places.append(things[0].polygon.envelope.centroid.buffer(1.5))
        if target is not None and room.polygon.covers(target):
            places.append(target.buffer(1.0))
        if not any(all(part.intersects(place) for place in places) for part in parts):
            return False
    return True


def _before(door: PlanDoor, room: Polygon, radius: float) -> Point:
    """Return the point in a room that is `radius` before the middle of a door."""
    middle = door.polygon.centroid
    away = radius + door.polygon.area / door.width / 2
    steps = [(away, 0.0), (-away, 0.0)] if door.vertical else [(0.0, away), (0.0, -away)]
    return next((p for dx, dy in steps if room.covers(p := Point(middle.x + dx, middle.y + dy))), middle)


def _finished(
    task: int,
    seed: int,
    plan: FloorPlan,
    things: tuple[PlacedThing, ...],
    utak: Point | None,
    heading: int,
    goal: str,
    target: BaseGeometry,
    missing: float,
) -> RandomScenario | None:
    """Return the scenario, with the texts of a task that carries the first object into the target."""
    expect = f'inside(t1, "{wkt(target)}").\n'
    unable = f"the passage is {missing:g} squares too narrow" if missing else ""
    start = f"object(x).\nshape(x, {things[0].shape}).\n" + ("door(d).\n" if task == 7 else "")
    texts = TaskTexts(start, goal, expect, unable)
    return random_scenario(task, seed, plan, things, utak, heading, texts, target, missing)
