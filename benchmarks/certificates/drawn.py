"""Random worlds and walks: rooms and things beside the grid, robots on lines and askew, walks that are stopped."""

import itertools
import math
from collections.abc import Callable

import numpy as np
import shapely
from shapely.affinity import rotate

from benchmarks.certificates.recorded import RecordedWalk, recorded_walk
from utak.geometry.kernels.arrays import XY
from utak.kb.body import Command, Grasp, Move, Push, Release, Turn
from utak.simulator.certificates.courses import TOUCH_NAMES, VERGE_LETTER
from utak.simulator.world.physics import Tabletop
from utak.simulator.world.placing import robot_misplaced, standing
from utak.simulator.world.world import Thing, World

HEADINGS = (0, 0, 0, 0, 90, 180, 270, 1, 2, 89, 30, 45, 17)  # degrees; as often as they stand here
MAX_TRIES = 1000  # of a place for the robot
Walk = tuple[list[Command], str]  # and the goal that it is said to attain


def drawn_walk(seed: int, noise: float = 0.0) -> RecordedWalk:
    """Return a walk in a random world that attains its goal, or seems to."""
    random = np.random.default_rng([17, seed])
    world = _world(random)
    walks: tuple[Callable[[np.random.Generator, World], Walk], ...] = (_returning, _cornered, _circling, _carrying)
    draw = walks[seed % len(walks)]
    world = _beside_thing(random, world) if draw is _carrying else world
    commands, goal = draw(random, world)
    return recorded_walk(world, commands, [goal], parameters=("x", "y"), noise=(noise, seed))


def drawn_push(seed: int, noise: float = 0.0) -> RecordedWalk:
    """Return a walk in a random world that pushes a thing into a corner, or seems to."""
    random = np.random.default_rng([31, seed])
    world = _beside_thing(random, _world(random))
    commands, goal = _pushing(random, world)
    return recorded_walk(world, commands, [goal], parameters=("x", "y"), noise=(noise, seed))


def _near_grid(random: np.random.Generator, low: float, high: float) -> float:
    """Return a random number: whole, half, or any."""
    value = float(random.uniform(low, high))
    return (round(value), round(2 * value) / 2, value)[int(random.integers(3))]


def _world(random: np.random.Generator) -> World:
    """Return a room with some things and a stub of wall."""
    width, height = (int(n) for n in random.integers(10, 26, 2))
    table = shapely.box(0, 0, width, height)
    inside = [_near_grid(random, low, low + 1.5) for low in (1, 1, width - 2.5, height - 2.5)]
    verge = table - shapely.box(*inside)
    if random.random() < 0.4:
        x, y = _near_grid(random, 3, width - 3), _near_grid(random, 1, height / 2)
        verge = verge | shapely.box(x, 0, x + float(random.uniform(0.2, 2)), y)
    things: list[Thing] = []
    for letter in "gry"[: int(random.integers(1, 4))]:
        x, y = _near_grid(random, 2, width - 4), _near_grid(random, 2, height - 4)
        shape = shapely.box(x, y, x + _near_grid(random, 0.6, 4), y + _near_grid(random, 0.6, 4))
        shape = rotate(shape, float(random.uniform(0, 90))) if random.random() < 0.3 else shape
        taken = [verge, *(thing.polygon for thing in things)]
        if shape.area > 0.1 and table.contains(shape) and all(shape.intersection(o).area == 0 for o in taken):
            things.append(Thing(f"{letter}1", letter, shape))
    world = World(width, height, verge, tuple(things), (), (0.0, 0.0), int(random.choice(HEADINGS)))
    for _ in range(MAX_TRIES):
        here = _near_grid(random, 1, width - 1), _near_grid(random, 1, height - 1)
        if not robot_misplaced(
            world, shapely.Point(here), [*standing(world), *((t.name, t.polygon) for t in world.movable)]
        ):
            return world.moved({}, here)
    return _world(random)


def _commands(world: World, points: list[XY], random: np.random.Generator) -> list[Command]:
    """Return the moves from waking along points of the table frame, some of them rounded to halves in his frame."""
    c, s = math.cos(math.radians(world.heading)), math.sin(math.radians(world.heading))
    coarse = random.random() < 0.7
    commands: list[Command] = []
    for (x0, y0), (x1, y1) in itertools.pairwise([world.utak, *points]):
        east, north = (x1 - x0) * c + (y1 - y0) * s, -(x1 - x0) * s + (y1 - y0) * c
        commands.append(Move(round(2 * east) / 2, round(2 * north) / 2) if coarse else Move(east, north))
    return commands


def _returning(random: np.random.Generator, world: World) -> Walk:
    """Return a walk there and back, as far as nothing stops it."""
    points = [(_near_grid(random, 0, world.width), _near_grid(random, 0, world.height)) for _ in range(2)]
    there = _commands(world, points[: int(random.integers(1, 3))], random)
    back = [Move(-move.east, -move.north) for move in (there if random.random() < 0.5 else reversed(there))]
    return [*there, *back], "at(utak,start)"


def _cornered(random: np.random.Generator, world: World) -> Walk:
    """Return a walk towards a corner, which may end before it, or in another one."""
    name = str(random.choice(["northeast", "northwest", "southwest", "southeast"]))
    e, n = (1 if "east" in name else -1), (1 if "north" in name else -1)
    c, s = math.cos(math.radians(world.heading)), math.sin(math.radians(world.heading))
    x, y = e * c - n * s, e * s + n * c
    target = (world.width - 2 if x > 0 else 2.0, world.height - 2 if y > 0 else 2.0)
    points = [(float(random.uniform(2, world.width - 2)), float(random.uniform(2, world.height - 2))), target]
    commands = _commands(world, points[int(random.integers(2)) :], random)
    nudges = [Move(e * float(random.choice([0, 0.5, 1, 2])), 0.0), Move(0.0, n * float(random.choice([0, 0.5, 1, 2])))]
    return [*commands, *nudges], f"at(utak,corner({name}))"


def _pushing(random: np.random.Generator, world: World) -> Walk:
    """Return pushes towards a corner, most often until the thing is stopped, and perhaps a second grasp."""
    corner = str(random.choice(["northeast", "northwest", "southwest", "southeast"]))
    east, north = (1 if "east" in corner else -1), (1 if "north" in corner else -1)
    ways = _graspable(world) or list(TOUCH_NAMES)
    commands: list[Command] = []
    for _ in range(int(random.integers(1, 3))):
        far = [_near_grid(random, 0, 12), _near_grid(random, 0, 12)]
        parts = [(east * far[0], 0.0), (0.0, north * far[1])]
        parts += [(east * _near_grid(random, 0, 2), north * _near_grid(random, 0, 2))]
        way = str(random.choice(ways))
        commands += [Grasp(way), *(Push(*parts[k]) for k in random.permutation(len(parts)))]
        if random.random() < 0.5:
            away = [float(random.choice([-1, 0, 1])) for _ in range(2)]
            commands += [Release(), Move(*away), Move(-away[0], -away[1])]
        else:
            commands += [Release()]
    return commands[: len(commands) - int(random.integers(3))], f"at(x,corner({corner}))"


def _circling(random: np.random.Generator, world: World) -> Walk:
    """Return a walk about a thing, or beside it, and back to its beginning."""
    x0, y0, x1, y1 = world.movable[0].polygon.bounds if world.movable else (3.0, 3.0, 5.0, 5.0)
    away = float(random.choice([0.3, 0.5, 1, 1.5]))
    ring = [(x0 - away, y0 - away), (x1 + away, y0 - away), (x1 + away, y1 + away), (x0 - away, y1 + away)]
    if random.random() < 0.3:
        ring.pop(int(random.integers(4)))
    points = [*ring, ring[0], world.utak]
    return _commands(world, points, random), "circled(utak,x)"


def _beside_thing(random: np.random.Generator, world: World) -> World:
    """Return a world in which the robot wakes beside a thing, where one is found."""
    things = [*standing(world), *((thing.name, thing.polygon) for thing in world.movable)]
    for _ in range(MAX_TRIES if world.movable else 0):
        x0, y0, x1, y1 = world.movable[0].polygon.bounds
        here = _near_grid(random, x0 - 1.5, x1 + 1.5), _near_grid(random, y0 - 1.5, y1 + 1.5)
        moved = world.moved({}, here)
        if not robot_misplaced(world, shapely.Point(here), things) and _graspable(moved):
            return moved
    return world


def _graspable(world: World) -> list[str]:
    """Return the directions in which the robot feels a thing where it wakes."""
    touches = Tabletop(world).look()[1]
    return [name for name, letter in zip(TOUCH_NAMES, touches, strict=True) if letter not in (None, VERGE_LETTER)]


def _carrying(random: np.random.Generator, world: World) -> Walk:
    """Return a walk with something in hand, most often moved to where the robot woke, or near something else."""
    commands: list[Command] = []
    east, north = 0.0, 0.0
    for _ in range(int(random.integers(1, 3))):
        ways = _graspable(world)
        commands.append(Grasp(str(random.choice(ways)) if ways and not commands else str(random.choice(TOUCH_NAMES))))
        for _ in range(int(random.integers(1, 4))):
            if random.random() < 0.2:
                commands.append(Turn(float(random.choice([90.0, 45.0, -17.0]))))
            else:
                e, n = (_near_grid(random, -4, 4) * float(random.integers(2)) for _ in range(2))
                commands.append(Push(e, n))
                east, north = east + e, north + n
        if random.random() < 0.5:
            commands.append(Push(-east, -north))
            east, north = 0.0, 0.0
        if random.random() < 0.8:
            commands.append(Release())
            commands.append(Move(float(random.choice([-1, 0, 1])), float(random.choice([-1, 0, 1]))))
    corner = random.choice(["northeast", "northwest", "southwest", "southeast"])
    goals = ("at(utak,start)", "at(x,start)", "at(x,y)", "beside(x,y)", f"at(x,corner({corner}))")
    return commands, str(random.choice(goals, p=(0.2, 0.3, 0.1, 0.1, 0.3)))
