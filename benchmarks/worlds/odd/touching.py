"""Objects that touch: each other, in one colour or two, the robot's square, a wall, or both walls of a corner."""

import numpy as np
from shapely import Point, Polygon, box
from shapely.affinity import translate

from benchmarks.worlds.furniture import ell
from benchmarks.worlds.odd import tasks
from benchmarks.worlds.odd.houses import House, one_room, straight, two_rooms
from benchmarks.worlds.odd.lying import own_square, place, rounded, stand
from benchmarks.worlds.odd.offgrid import doorways
from benchmarks.worlds.odd.tasks import OddScene, OddWorld
from benchmarks.worlds.placing import colour
from benchmarks.worlds.scenes import PlacedThing

TOUCHING_KIND = "touching"
TOUCHING_VARIANTS = ("pair", "same_colour", "row", "robot", "wall", "corner", "pair", "robot_pair")
TOUCHING_TASKS = ("at_x", "carry_corner", "carry_next", "carry_corner", "carry_next", "both", "carry_door")
SQUARE_SIDE = 3.0  # squares: x is a square
TOUCHING_SHAPES = {"brick": box(0, 0, 2, 4), "l_shape": ell(5, 5, 2)}


def world(rng: np.random.Generator, seed: int) -> OddWorld | None:
    """Return the world of a seed; None when the things find no place by these random numbers."""
    variant, task = TOUCHING_VARIANTS[seed % len(TOUCHING_VARIANTS)], TOUCHING_TASKS[seed % len(TOUCHING_TASKS)]
    if variant.startswith("robot") and task == "at_x":
        task = "carry_next"  # it is at x from the start
    plan = _plan(rng, task)
    home = int(rng.integers(len(plan.rooms)))
    room = plan.rooms[home]
    square = box(0, 0, SQUARE_SIDE, SQUARE_SIDE)
    x = _at_walls(rng, room, square, variant == "corner") if variant in ("wall", "corner") else None
    x = x or place(rng, square, room, doorways(plan), bool(rng.random() < 0.7), 0.0, 5.5)
    if x is None or any(x.distance(door) < 3 for door in doorways(plan)):
        return None
    tint = colour(rng)
    things = [PlacedThing("t1", tint, "square", x)]
    if variant in ("pair", "same_colour", "row", "robot_pair"):
        for number, side in enumerate((1, -1) if variant == "row" else (int(rng.choice([1, -1])),), 1):
            shape = str(rng.choice(sorted(TOUCHING_SHAPES)))
            other = _against(rng, x, TOUCHING_SHAPES[shape], side)
            paint = tint if variant == "same_colour" else _another(rng, tint)
            things.append(PlacedThing(f"d{number}", paint, shape, other))
    utak = _by(rng, things, room) if variant.startswith("robot") else None
    if utak is None:
        utak = stand(rng, room, [thing.polygon for thing in things], True, 2.0)
    if utak is None or not all(room.buffer(-0.5).covers(thing.polygon) for thing in things[1:]):
        return None
    facing = tasks.heading(rng, True)
    compass = tasks.choose_corner(rng, plan, facing) if task in tasks.TO_CORNER else ""
    if compass is None:
        return None
    return tasks.given(
        TOUCHING_KIND, seed, task, variant, OddScene(plan, home, tuple(things), utak, facing), compass=compass
    )


def _plan(rng: np.random.Generator, task: str) -> House:
    """Return one room where a corner is the goal, else two rooms with a wide door, on whole squares."""
    depths = tuple(float(rng.integers(17, 21)) for _ in range(3))
    if task in tasks.TO_CORNER:
        return one_room(box(0, 0, depths[0] + 4, depths[1]))
    door = float(rng.integers(5, 8))
    at = float(rng.integers(2, int(depths[2] - door) - 1))
    first, second, neck = straight((depths[0], depths[1]), (depths[2], depths[2]), 2.0, door, at)
    return two_rooms(first, second, [neck], 90.0 * int(rng.integers(2)))


def _at_walls(rng: np.random.Generator, room: Polygon, shape: Polygon, corner: bool) -> Polygon:
    """Return a shape flush with a wall of a rectangular room, or with both walls of one of its corners."""
    west, south, east, north = room.bounds
    across = shape.bounds[2]
    x, y = float(rng.choice([west, east - across])), float(rng.choice([south, north - across]))
    if not corner:
        along = float(rng.integers(4, int(min(east - west, north - south) - across - 3)))
        x, y = (x, south + along) if rng.random() < 0.5 else (west + along, y)
    return rounded(translate(shape, x, y))


def _against(rng: np.random.Generator, x: Polygon, outline: Polygon, side: int) -> Polygon:
    """Return an outline flush with the east (1) or west (-1) side of x, moved along it by whole squares."""
    west, south, east, _ = x.bounds
    along = south + float(rng.integers(-1, 2))
    return rounded(translate(outline, east if side > 0 else west - outline.bounds[2], along))


def _another(rng: np.random.Generator, tint: str) -> str:
    while (other := colour(rng)) == tint:
        pass
    return other


def _by(rng: np.random.Generator, things: list[PlacedThing], room: Polygon) -> Point | None:
    """Return a place for the robot in a square beside one of an object's squares."""
    west, south, east, north = things[0].polygon.bounds
    ways = [(west - 0.5, south + 1.5), (east + 0.5, south + 1.5), (west + 1.5, south - 0.5), (west + 1.5, north + 0.5)]
    for n in rng.permutation(len(ways)):
        at = Point(ways[n])
        if room.covers(at) and all(own_square(at).intersection(t.polygon).area < 1e-9 for t in things):
            return at
    return None
