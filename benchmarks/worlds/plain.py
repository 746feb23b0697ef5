"""Plain worlds: one or two rooms, walls two squares thick, everything on whole squares, headings quarter turns.

Such are the worlds that people draw first; those of benchmarks.worlds.walking and benchmarks.worlds.carrying are harder
in every respect.
"""

import numpy as np
from shapely import Point, Polygon, box, union_all
from shapely.geometry.base import BaseGeometry

from benchmarks.worlds.carrying import ELLS
from benchmarks.worlds.floorplans import FloorPlan, PlanDoor, PlanRoom, corridor
from benchmarks.worlds.furniture import ell, rectangle
from benchmarks.worlds.placing import colour, lay, stand
from benchmarks.worlds.scenes import Maker, PlacedThing, RandomScenario, TaskTexts, wkt
from benchmarks.worlds.walking import NO_REGION, corner_box, furthest_corner

PLAIN_WALL = 2
PLAIN_OTHER_SHAPES = ("brick", "l_shape", "triangle")
MIN_WALK = 6.0  # squares that a walk takes at least


def one_room(rng: np.random.Generator) -> FloorPlan:
    """Return a rectangular room."""
    width, height = (int(rng.integers(20, 44)) for _ in range(2))
    room = box(PLAIN_WALL, PLAIN_WALL, PLAIN_WALL + width, PLAIN_WALL + height)
    return FloorPlan(width + 2 * PLAIN_WALL, height + 2 * PLAIN_WALL, (PlanRoom("r1", room),), ())


def two_rooms(rng: np.random.Generator, doors: tuple[int, int]) -> FloorPlan:
    """Return two rooms side by side or one above the other, with a door of a given width."""
    width = int(rng.integers(doors[0], doors[1] + 1))
    near, far = (int(rng.integers(18, 24)) for _ in range(2))
    across = int(rng.integers(max(18, 2 * width + 1), max(25, 2 * width + 2)))
    at = int(rng.integers(PLAIN_WALL + 2, PLAIN_WALL + across - width - 1))
    first, second = near + PLAIN_WALL, near + 2 * PLAIN_WALL
    rects = [
        (PLAIN_WALL, PLAIN_WALL, first, PLAIN_WALL + across),
        (second, PLAIN_WALL, second + far, PLAIN_WALL + across),
    ]
    neck = (first, at, second, at + width)
    size = (second + far + PLAIN_WALL, across + 2 * PLAIN_WALL)
    if rng.random() < 0.5:
        rects = [(s, w, n, e) for w, s, e, n in rects]
        neck, size = (neck[1], neck[0], neck[3], neck[2]), (size[1], size[0])
        vertical = False
    else:
        vertical = True
    rooms = tuple(PlanRoom(f"r{i}", box(*rect)) for i, rect in enumerate(rects, 1))
    return FloorPlan(*size, rooms, (PlanDoor(("r1", "r2"), box(*neck), width, vertical),))


def other(rng: np.random.Generator, without: str) -> tuple[str, Polygon]:
    """Return the class and outline of an object that the task does not name."""
    shapes = [shape for shape in PLAIN_OTHER_SHAPES if shape != without]
    shape = shapes[rng.integers(len(shapes))]
    outlines = {
        "brick": rectangle(int(rng.integers(4, 7)), 2),
        "l_shape": ell(6, 6, 2),
        "triangle": Polygon([(0, 0), (4, 4), (4, 0)]),
    }
    return shape, outlines[shape]


def load(rng: np.random.Generator, shape: str) -> tuple[Polygon, float]:
    """Return the object of the task, and the least width of a passage in a wall that lets it through."""
    if shape == "brick":
        return (rectangle(4, 2) if rng.random() < 0.5 else rectangle(2, 4)), 2.0
    if shape == "l_shape":
        return ell(6, 6, 2), ELLS[6, 2]
    return rectangle(3, 3), 3.0


TASK_SHAPES = {3: "square", 4: "square", 5: "square", 6: "square", 7: "brick", 8: "brick", 9: "l_shape"}
PLAIN_GOALS = {
    1: "at(utak, corner(northeast)).\n",
    2: "in(utak, room(next)).\n",
    3: "at(utak, x).\n",
    4: "circled(utak, x).\nat(utak, start).\n",
    5: "at(x, corner(northeast)).\n",
    6: "in(x, room(next)).\n",
    7: "through(x, d).\n",
    8: "around(x, corner).\n",
    9: "in(x, room(next)).\n",
}


def plain_world(rng: np.random.Generator, task: int, seed: int) -> RandomScenario | None:
    """Return one of the nine tasks in a plain world; None when the objects find no place."""
    shape = TASK_SHAPES.get(task, "")
    outline, least = load(rng, shape) if shape else (None, 3.0)
    second: BaseGeometry = NO_REGION
    if task == 8:
        plan, home, second = corridor(rng, (9, 9), PLAIN_WALL)
    else:
        doors = (int(np.ceil(least + 1)), int(np.floor(least + 3)))
        plan = two_rooms(rng, doors) if task in (2, 6, 7, 9) else one_room(rng)
        home = plan.rooms[int(rng.integers(len(plan.rooms)))].polygon
    heading = 90 * int(rng.integers(4))
    corner = furthest_corner(plan.floor, "northeast", heading)
    if corner is None:
        return None
    necks: list[BaseGeometry] = [door.polygon for door in plan.doors]
    things: list[PlacedThing] = []
    if outline is not None:
        keep = [*necks, *([corner_box(corner, outline.bounds[2] + 1.5)] if task == 5 else []), second]
        polygon = lay(rng, outline, home, [area for area in keep if not area.is_empty])
        if polygon is None or (task == 8 and polygon.distance(second) < MIN_WALK):
            return None
        things.append(PlacedThing("t1", colour(rng), shape, polygon))
    if task != 8:
        things += _others(rng, plan, shape, [*necks, *(thing.polygon for thing in things)])
    target = _target(task, plan, home, corner, things, second)
    away = target if task in (1, 3) else NO_REGION
    utak = stand(rng, [home] if task in (2, 8) else [r.polygon for r in plan.rooms], things, away, MIN_WALK)
    if utak is None:
        return None
    utak = Point(int(utak.x) + 0.5, int(utak.y) + 0.5)
    return RandomScenario(task, seed, plan, tuple(things), utak, heading, _texts(task, shape, target, utak), target)


def _others(rng: np.random.Generator, plan: FloorPlan, shape: str, keep: list[BaseGeometry]) -> list[PlacedThing]:
    """Return up to two objects that are not of the task."""
    found: list[PlacedThing] = []
    for number in range(1, int(rng.integers(0, 3)) + 1):
        kind, outline = other(rng, shape)
        room = plan.rooms[int(rng.integers(len(plan.rooms)))].polygon
        polygon = lay(rng, outline, room, [area.buffer(2) for area in keep] + [t.polygon for t in found])
        if polygon is not None:
            found.append(PlacedThing(f"d{number}", colour(rng), kind, polygon))
    return found


def _target(
    task: int,
    plan: FloorPlan,
    home: Polygon,
    corner: tuple[float, float, float, float],
    things: list[PlacedThing],
    second: BaseGeometry,
) -> BaseGeometry:
    """Return the region that is to be reached."""
    if task == 1:
        return corner_box(corner, 2.5)
    if task == 5:
        return corner_box(corner, 4.5)
    if task == 3:
        return things[0].polygon.buffer(2, join_style="mitre")
    if task == 4:
        return NO_REGION
    if task == 8:
        return second
    return union_all([room.polygon for room in plan.rooms if not room.polygon.equals(home)])


def _texts(task: int, shape: str, target: BaseGeometry, utak: Point) -> TaskTexts:
    start = f"object(x).\nshape(x, {shape}).\n" if shape else ""
    start += "door(d).\n" if task == 7 else ""
    subject = "t1" if task >= 5 else "utak"
    expect = f'inside({subject}, "{wkt(target)}").\n'
    if task == 4:
        expect = f'circles(utak, t1).\nnear(utak, "{wkt(utak)}", 2).\nunmoved(t1).\n'
    return TaskTexts(start, PLAIN_GOALS[task], expect)


PLAIN: dict[int, Maker] = {
    task: lambda rng, seed, unable, task=task: plain_world(rng, task, seed)  # type: ignore[misc]
    for task in PLAIN_GOALS
}
