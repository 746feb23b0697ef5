"""Worlds with two things that belong into two corners; in most of them one lies where the other one belongs."""

from dataclasses import replace

import numpy as np
from shapely import Polygon, box
from shapely.affinity import rotate, translate

from benchmarks.worlds.floorplans import FloorPlan, PlanRoom
from benchmarks.worlds.furniture import rounded
from benchmarks.worlds.placing import OBJECT_GAP
from benchmarks.worlds.plain import two_rooms
from benchmarks.worlds.several.scene import (
    SEVERAL_WALL,
    Load,
    Scene,
    door_range,
    finished,
    loads,
    placed,
    quarter_heading,
    robot_place,
)
from benchmarks.worlds.several.tasks import SeveralWorld, to_corner
from benchmarks.worlds.walking import CORNER_DIRECTIONS, furthest_corner

CORNERS_KIND = "corners"
TWO_ROOMS_SHARE = 0.3  # of the worlds have two rooms
VARIANTS = ("free", "taken", "exchange")  # none, one, or each of the things lies where the other one belongs
TAKEN_GAPS = (1, 4)  # squares from such a thing to the walls of the corner, 1 to 3


def corners_world(rng: np.random.Generator, seed: int) -> SeveralWorld | None:
    """Return a world in which x and y belong into different corners of the whole floor; None for no place."""
    carried, by_colour = loads(rng, 2)
    plan = two_rooms(rng, door_range(carried)) if rng.random() < TWO_ROOMS_SHARE else single_room(rng)
    heading = quarter_heading(rng)
    first, second = (str(compass) for compass in rng.permutation(sorted(CORNER_DIRECTIONS))[:2])
    rooms = [plan.rooms[int(rng.integers(len(plan.rooms)))].polygon for _ in carried]
    things = placed(rng, carried, rooms, [door.polygon for door in plan.doors])
    if things is None:
        return None
    variant = str(rng.choice(VARIANTS))
    for k, compass in ((1, first), (0, second))[: VARIANTS.index(variant)]:
        polygon = _in_the_way(rng, carried[k], plan, compass, heading)
        if polygon is None or polygon.distance(things[1 - k].polygon) < OBJECT_GAP:
            return None
        things = tuple(replace(thing, polygon=polygon) if k == n else thing for n, thing in enumerate(things))
    utak = robot_place(rng, plan.rooms[int(rng.integers(len(plan.rooms)))].polygon, things)
    if utak is None:
        return None
    scene = Scene(plan, things, by_colour, utak, heading)
    wants = [to_corner("x", things[0], plan, first, heading), to_corner("y", things[1], plan, second, heading)]
    if any(want and want.holds({thing.name: thing.polygon}) for want, thing in zip(wants, things, strict=True)):
        return None
    return finished(CORNERS_KIND, seed, variant, scene, [wants], 2)


def _in_the_way(rng: np.random.Generator, load: Load, plan: FloorPlan, compass: str, heading: int) -> Polygon | None:
    """Return a thing as it lies near a corner of the floor, where another one belongs; None without such a corner."""
    corner = furthest_corner(plan.floor, compass, heading)
    if corner is None:
        return None
    x, y, inward_x, inward_y = corner
    thing = rotate(load.outline, 90.0 * int(rng.integers(4)), origin=(0, 0))
    west, south, east, north = thing.bounds
    gaps = [int(rng.integers(*TAKEN_GAPS)) for _ in range(2)]
    to_x = x + gaps[0] if inward_x > 0 else x - gaps[0] - (east - west)
    to_y = y + gaps[1] if inward_y > 0 else y - gaps[1] - (north - south)
    return rounded(translate(thing, to_x - west, to_y - south))


def single_room(rng: np.random.Generator) -> FloorPlan:
    """Return one rectangular room of 20 to 30 squares a side."""
    width, height = (int(rng.integers(20, 31)) for _ in range(2))
    room = box(SEVERAL_WALL, SEVERAL_WALL, SEVERAL_WALL + width, SEVERAL_WALL + height)
    return FloorPlan(width + 2 * SEVERAL_WALL, height + 2 * SEVERAL_WALL, (PlanRoom("r1", room),), ())
