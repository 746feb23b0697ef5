"""Plain worlds: one room or two, walls two squares thick, everything on whole squares, headings quarter turns.

Such are the worlds that people draw first; those of benchmarks.worlds.walking and benchmarks.worlds.carrying are
harder in every
respect.
"""

import numpy as np
from shapely import Point, Polygon, box, union_all
from shapely.geometry.base import BaseGeometry

from benchmarks.worlds.carrying import ELLS
from benchmarks.worlds.floorplans import FloorPlan, PlanDoor, PlanRoom, corridor
from benchmarks.worlds.furniture import ell, rectangle
from benchmarks.worlds.placing import colour, lay, stand
from benchmarks.worlds.scenes import Maker, PlacedThing, RandomScenario, TaskTexts, wkt
from benchmarks.worlds.walking import NOWHERE, corner_box, furthest_corner

WALL = 2
OTHERS = ("brick", "l_shape", "triangle")
APART = 6.0  # squares that a walk takes at least


def one_room(rng: np.random.Generator) -> FloorPlan:
    """A rectangular room."""
    width, height = (int(rng.integers(20, 44)) for _ in range(2))
    room = box(WALL, WALL, WALL + width, WALL + height)
    return FloorPlan(width + 2 * WALL, height + 2 * WALL, (PlanRoom("r1", room),), ())


def two_rooms(rng: np.random.Generator, doors: tuple[int, int]) -> FloorPlan:
    """Two rooms side by side or one above the other, with a door of a width between these."""
    width = int(rng.integers(doors[0], doors[1] + 1))
    near, far = (int(rng.integers(18, 24)) for _ in range(2))
    across = int(rng.integers(max(18, 2 * width + 1), max(25, 2 * width + 2)))
    at = int(rng.integers(WALL + 2, WALL + across - width - 1))
    first, second = near + WALL, near + 2 * WALL
    rects = [(WALL, WALL, first, WALL + across), (second, WALL, second + far, WALL + across)]
    neck = (first, at, second, at + width)
    size = (second + far + WALL, across + 2 * WALL)
    if rng.random() < 0.5:
        rects = [(s, w, n, e) for w, s, e, n in rects]
        neck, size = (neck[1], neck[0], neck[3], neck[2]), (size[1], size[0])
        vertical = False
    else:
        vertical = True
    rooms = tuple(PlanRoom(f"r{i}", box(*rect)) for i, rect in enumerate(rects, 1))
    return FloorPlan(*size, rooms, (PlanDoor(("r1", "r2"), box(*neck), width, vertical),))


def other(rng: np.random.Generator, without: str) -> tuple[str, Polygon]:
    """A thing that stands about: its class and outline."""
    shapes = [shape for shape in OTHERS if shape != without]
    shape = shapes[rng.integers(len(shapes))]
    outlines = {
        "brick": rectangle(int(rng.integers(4, 7)), 2),
        "l_shape": ell(6, 6, 2),
        "triangle": Polygon([(0, 0), (4, 4), (4, 0)]),
    }
    return shape, outlines[shape]


def load(rng: np.random.Generator, shape: str) -> tuple[Polygon, float]:
    """What is gone to, gone round or carried, and the least passage that lets it through a wall."""
    if shape == "brick":
        return (rectangle(4, 2) if rng.random() < 0.5 else rectangle(2, 4)), 2.0
    if shape == "l_shape":
        return ell(6, 6, 2), ELLS[6, 2]
    return rectangle(3, 3), 3.0


SHAPE = {3: "square", 4: "square", 5: "square", 6: "square", 7: "brick", 8: "brick", 9: "l_shape"}
GOALS = {
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
    """One of the nine tasks in a plain world; None when the things find no place."""
    shape = SHAPE.get(task, "")
    outline, least = load(rng, shape) if shape else (None, 3.0)
    second: BaseGeometry = NOWHERE
    if task == 8:
        plan, home, second = corridor(rng, (9, 9), WALL)
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
        if polygon is None or (task == 8 and polygon.distance(second) < APART):
            return None
        things.append(PlacedThing("t1", colour(rng), shape, polygon))
    if task != 8:
        things += _others(rng, plan, shape, [*necks, *(thing.polygon for thing in things)])
    target = _target(task, plan, home, corner, things, second)
    away = target if task in (1, 3) else NOWHERE
    utak = stand(rng, [home] if task in (2, 8) else [r.polygon for r in plan.rooms], things, away, APART)
    if utak is None:
        return None
    utak = Point(int(utak.x) + 0.5, int(utak.y) + 0.5)
    return RandomScenario(task, seed, plan, tuple(things), utak, heading, _texts(task, shape, target, utak), target)


def _others(rng: np.random.Generator, plan: FloorPlan, shape: str, keep: list[BaseGeometry]) -> list[PlacedThing]:
    """Up to two things that are not of the task."""
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
    """The region that is to be reached."""
    if task == 1:
        return corner_box(corner, 2.5)
    if task == 5:
        return corner_box(corner, 4.5)
    if task == 3:
        return things[0].polygon.buffer(2, join_style="mitre")
    if task == 4:
        return NOWHERE
    if task == 8:
        return second
    return union_all([room.polygon for room in plan.rooms if not room.polygon.equals(home)])


def _texts(task: int, shape: str, target: BaseGeometry, utak: Point) -> TaskTexts:
    start = f"object(x).\nshape(x, {shape}).\n" if shape else ""
    start += "door(d).\n" if task == 7 else ""
    who = "t1" if task >= 5 else "utak"
    expect = f'inside({who}, "{wkt(target)}").\n'
    if task == 4:
        expect = f'circles(utak, t1).\nnear(utak, "{wkt(utak)}", 2).\nunmoved(t1).\n'
    return TaskTexts(start, GOALS[task], expect)


PLAIN: dict[int, Maker] = {
    task: lambda rng, seed, unable, task=task: plain_world(rng, task, seed)  # type: ignore[misc]
    for task in GOALS
}
