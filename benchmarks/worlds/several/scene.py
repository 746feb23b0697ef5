"""Scenes for tasks about several things: floors, things that can be told apart, their places, and the robot's.

Everything is on whole squares and every heading is a quarter turn: what makes these tasks hard is order and places.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from shapely import Point, Polygon, box, union_all
from shapely.geometry.base import BaseGeometry

from benchmarks.worlds.carrying import ELLS
from benchmarks.worlds.floorplans import FloorPlan, PlanDoor, PlanRoom
from benchmarks.worlds.furniture import THING_COLOURS, ell, rectangle
from benchmarks.worlds.placing import lay, stand
from benchmarks.worlds.scenes import PlacedThing
from benchmarks.worlds.several.tasks import SeveralWorld, Want, claims_of
from benchmarks.worlds.walking import NO_REGION

SEVERAL_WALL = 2  # squares, the thickness of walls
SAME_SHAPE_SHARE = 0.3  # of all tasks are about things of one shape, which their colours tell apart
THING_SHAPES = ("square", "brick", "l_shape")
NECK_OVERLAP = 0.01  # squares by which half a neck is drawn on into its room, so that their union has no seam


class Load(NamedTuple):
    """A thing that is not placed yet.

    Attributes
    ----------
    shape : the class of its shape. outline : its polygon about the origin.
    least : the least width of a door that lets it through, in squares.
    """

    shape: str
    outline: Polygon
    least: float


class Scene(NamedTuple):
    """A floor with things on it, and the robot: the first things are those of the task.

    Attributes
    ----------
    by_colour : whether the things of the task have the same shape.
    heading : degrees counter-clockwise from table north.
    """

    plan: FloorPlan
    things: tuple[PlacedThing, ...]
    by_colour: bool
    utak: Point
    heading: int


def loads(rng: np.random.Generator, count: int, shapes: Sequence[str] = THING_SHAPES) -> tuple[list[Load], bool]:
    """Return things for a task, and whether all have the same shape.

    count : how many, at most as many as there are shapes.
    """
    if rng.random() < SAME_SHAPE_SHARE:
        shape = str(rng.choice(shapes))
        return [load_of(rng, shape) for _ in range(count)], True
    return [load_of(rng, str(shape)) for shape in rng.permutation(list(shapes))[:count]], False


def load_of(rng: np.random.Generator, shape: str) -> Load:
    """Return a small thing of a shape: a square, a brick or an L."""
    if shape == "square":
        side = int(rng.integers(3, 6))
        return Load(shape, rectangle(side, side), float(side))
    if shape == "brick":
        thin = int(rng.integers(2, 4))
        return Load(shape, rectangle(thin + int(rng.integers(2, 5)), thin), float(thin))
    arm = int(rng.integers(5, 7))
    return Load(shape, ell(arm, arm, 2), ELLS[arm, 2])


def door_range(carried: Sequence[Load]) -> tuple[int, int]:
    """Return the least and greatest width of a door for things: one to three squares more than the widest needs."""
    least = max(load.least for load in carried)
    return int(np.ceil(least)) + 1, int(np.ceil(least)) + 3


def joined(size: tuple[int, int], first: Polygon, second: Polygon, neck: Polygon, mirror: int) -> FloorPlan:
    """Return a plan of two rooms beside each other along x and the neck between them.

    size : of the table. mirror : 0 to 7, how the plan is mirrored (bits: east and west, north and south, x and y).
    """
    width, height = size
    parts = [mirrored(part, width, height, mirror) for part in (first, second, neck)]
    across, vertical = int(neck.bounds[3] - neck.bounds[1]), not mirror & 4
    door = PlanDoor(("r1", "r2"), parts[2], across, vertical)
    rooms = (PlanRoom("r1", parts[0]), PlanRoom("r2", parts[1]))
    return FloorPlan(*((width, height) if vertical else (height, width)), rooms, (door,))


def mirrored(part: Polygon, width: int, height: int, mirror: int) -> Polygon:
    """Return a rectangle of a table of width x height squares, mirrored as `joined` says."""
    west, south, east, north = part.bounds
    if mirror & 1:
        west, east = width - east, width - west
    if mirror & 2:
        south, north = height - north, height - south
    if mirror & 4:
        west, south, east, north = south, west, north, east
    return box(west, south, east, north)


def beyond(plan: FloorPlan, home: str) -> BaseGeometry:
    """Return the rooms that share a door with a room, each with the half of its neck: what lies there is through."""
    parts: list[BaseGeometry] = [plan.room(name) for name in plan.neighbours(home)]
    for door in plan.doors:
        if home in door.rooms:
            other = plan.room(next(name for name in door.rooms if name != home))
            west, south, east, north = door.polygon.bounds
            x, y = (west + east) / 2, (south + north) / 2
            halves = (
                (box(west, south, x, north), box(x, south, east, north))
                if door.vertical
                else (box(west, south, east, y), box(west, y, east, north))
            )
            near = min(halves, key=lambda half: half.distance(other))
            parts.append(near.buffer(NECK_OVERLAP, join_style="mitre"))
    return union_all(parts)


def placed(
    rng: np.random.Generator,
    carried: Sequence[Load],
    rooms: Sequence[Polygon],
    clear: Sequence[BaseGeometry],
) -> tuple[PlacedThing, ...] | None:
    """Return things t1, t2, ... of different colours, each in its room and clear of regions; None for no place."""
    colours = rng.permutation(list(THING_COLOURS))
    things: list[PlacedThing] = []
    for number, (load, room) in enumerate(zip(carried, rooms, strict=True)):
        polygon = lay(rng, load.outline, room, [*clear, *(thing.polygon for thing in things)])
        if polygon is None:
            return None
        things.append(PlacedThing(f"t{number + 1}", str(colours[number]), load.shape, polygon))
    return tuple(things)


def robot_place(rng: np.random.Generator, room: Polygon, things: Sequence[PlacedThing]) -> Point | None:
    """Return the middle of a free square of a room for the robot; None for none."""
    found = stand(rng, [room], things, NO_REGION, 0)
    return found and Point(int(found.x) + 0.5, int(found.y) + 0.5)


def quarter_heading(rng: np.random.Generator) -> int:
    """Return a heading that is a quarter turn, in degrees."""
    return 90 * int(rng.integers(4))


def finished(
    kind: str, seed: int, variant: str, scene: Scene, stages: Sequence[Sequence[Want | None]], count: int
) -> SeveralWorld | None:
    """Return a scene as a world with a task about its first `count` things.

    None when a want is None, or when everything that the last stage wants holds at the start.
    """
    wanted = tuple(tuple(want for want in stage if want is not None) for stage in stages)
    if [len(stage) for stage in wanted] != [len(stage) for stage in stages]:
        return None
    lying = {"utak": scene.utak, **{thing.name: thing.polygon for thing in scene.things}}
    if all(want.holds(lying) for want in wanted[-1]):
        return None
    claims = claims_of(scene.things[:count], scene.by_colour)
    return SeveralWorld(kind, seed, variant, scene.plan, scene.things, scene.utak, scene.heading, claims, wanted)
