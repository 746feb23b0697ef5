"""Random rooms in a row with doors between them, and walks and pushes that lead through them, or do not."""

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import shapely
from shapely.affinity import affine_transform

from benchmarks.certificates.drawn import HEADINGS
from benchmarks.certificates.recorded import RecordedWalk, TrueRooms, recorded_walk
from utak.geometry.kernels.arrays import XY
from utak.kb.body import Command, Grasp, Move, Push, Release
from utak.simulator.certificates.courses import TOUCH_NAMES, VERGE_LETTER
from utak.simulator.world.physics import Tabletop
from utak.simulator.world.world import Thing, World

MAX_DRAWN_PLANS = 200  # of cells and openings that are rooms and doors, or neither, beyond doubt
OUTER_WALL = 2.0  # squares: outside
LEAST_BEGINNING = 7.0  # squares: the sides of a cell in which a walk begins
Box = tuple[float, float, float, float]


class DrawnGap(NamedTuple):
    """An opening of the wall between two cells."""

    low: float  # its ends along the wall
    high: float
    thing: Box | None  # that makes it look narrower


class RowOfCells(NamedTuple):
    """Cells in a row, from west to east, and the openings of the walls between them."""

    cells: list[Box]
    openings: list[list[DrawnGap]]


def drawn_doors(seed: int, noise: float = 0.0) -> RecordedWalk:
    """Return a walk or a push that seems to lead into the next room."""
    random = np.random.default_rng([29, seed])
    carries = random.random() < 0.5
    plan = next(plan for plan in (_plan(random, carries) for _ in range(MAX_DRAWN_PLANS)) if _is_clear(plan))
    height, width = plan.cells[0][3] + OUTER_WALL, plan.cells[-1][2] + OUTER_WALL
    floor = shapely.union_all([shapely.box(*cell) for cell in plan.cells])
    things = []
    for (_, _, west, _), (east, *_), openings in zip(plan.cells, plan.cells[1:], plan.openings, strict=False):
        for opening in openings:
            floor |= shapely.box(west, opening.low, east, opening.high)
            things += [Thing(f"y{len(things)}", "y", shapely.box(*opening.thing))] if opening.thing else []
    verge = shapely.box(0, 0, math.ceil(width), math.ceil(height)) - floor
    wide = [cell for cell in plan.cells if _wide(cell) >= LEAST_BEGINNING]
    cell = wide[int(random.integers(len(wide)))]
    x, y = (round(float(random.uniform(low + 2.5, high - 3.5))) for low, high in (cell[::2], cell[1::2]))
    if carries:
        sides = (float(n) for n in (random.integers(1, 4), random.integers(1, 3)))
        things.append(Thing("k1", "k", shapely.box(x, y, *(a + b for a, b in zip((x, y), sides, strict=True)))))
    start = x - 0.5, y + 0.5
    world = World(math.ceil(width), math.ceil(height), verge, tuple(things), (), start, int(random.choice(HEADINGS)))
    way = _way(random, plan, cell, start, things[-1].polygon.bounds if carries else None)
    rooms = _true_rooms(plan)
    if random.random() < 0.5:
        world, way, rooms = _transposed(world, way, rooms)
    goal = "through" if random.random() < 0.3 else "in"
    what = "x" if carries else "utak"
    goals = [f"{goal}({what},{'d' if goal == 'through' else 'room(next)'})"]
    commands = _commands(world, way, carries)
    walk = recorded_walk(world, commands, goals, parameters=("x", "y"), doors=("d",), noise=(noise, seed))
    return replace(walk, rooms=rooms)


def _plan(random: np.random.Generator, carries: bool) -> RowOfCells:
    """Return cells of one height, and one or two openings between each two of them."""
    off = float(random.choice([0.0, 0.0, 0.0, 0.0, 0.0, 0.3]))  # beside the lines of the grid
    height, at = float(random.integers(7, 15)), OUTER_WALL
    cells, openings = list[Box](), list[list[DrawnGap]]()
    for number in range(int(random.integers(2, 4))):
        at += float(random.choice([1.0, 1.0, 2.0, 2.0, 1.4])) if number else 0.0
        long = float(random.integers(5, 15)) + (off if number == 0 else 0.0)
        cells.append((at, OUTER_WALL, at + long, OUTER_WALL + height))
        at += long
    for (_, _, west, _), (east, *_) in pairwise(cells):
        wide = float(random.integers(3 if carries else 1, 7))
        low = OUTER_WALL + float(random.integers(0, max(int(height - wide), 1)))
        thing, found = None, list[DrawnGap]()
        if random.random() < 0.15 and low + wide + 2 <= OUTER_WALL + height:
            thing, wide = (math.ceil(west), low + wide, math.floor(east), low + wide + 2.0), wide + 2.0
            thing = thing if thing[2] > thing[0] else None
        found.append(DrawnGap(low + off, low + wide, thing))
        if random.random() < 0.25 and low + wide + 3 <= OUTER_WALL + height:
            found.append(DrawnGap(low + wide + 2, low + wide + 3, None))
        openings.append(found)
    return RowOfCells(cells, openings)


def _wide(cell: Box) -> float:
    return min(cell[2] - cell[0], cell[3] - cell[1])


def _is_clear(plan: RowOfCells) -> bool:
    """Return whether a walk can begin, and no cell but the first and the last is too narrow for a door of its own."""
    return any(_wide(cell) >= LEAST_BEGINNING for cell in plan.cells) and all(
        2 * (opening.high - opening.low) <= _wide(cell)
        for number, cell in enumerate(plan.cells[1:-1], 1)
        for opening in plan.openings[number - 1] + plan.openings[number]
    )


def _true_rooms(plan: RowOfCells) -> TrueRooms:
    """Return the rooms: cells, and what is joined by more than a door; and which of them a door joins."""
    parts: list[shapely.Geometry] = [shapely.box(*plan.cells[0])]
    doors, are_parted = set[tuple[int, int]](), True
    for one, other, openings in zip(plan.cells, plan.cells[1:], plan.openings, strict=False):
        widths = [opening.high - opening.low for opening in openings]
        if 2 * max(widths) <= min(_wide(one), _wide(other)):
            parts.append(shapely.box(*other))
            doors.add((len(parts) - 2, len(parts) - 1))
        else:
            between = [shapely.box(one[2], opening.low, other[0], opening.high) for opening in openings]
            parts[-1] = shapely.union_all([parts[-1], shapely.box(*other), *between])
            are_parted &= len(openings) == 1  # beside what is no door there may be one, with one room on both sides
    return TrueRooms(tuple(parts), frozenset(doors), are_parted)


def _way(random: np.random.Generator, plan: RowOfCells, cell: Box, start: XY, thing: Box | None) -> list[XY]:
    """Return points, from waking on: to the height of an opening, through it, and perhaps through the next."""
    here, number = start, plan.cells.index(cell)
    points = [here]
    for _ in range(int(random.choice([1, 1, 1, 2]))):
        ways = [way for way in (-1, 1) if 0 <= number + way < len(plan.cells)]
        way = int(random.choice(ways))
        openings = plan.openings[min(number, number + way)]
        opening = openings[int(random.integers(len(openings)))]
        number += way
        middle = (opening.low + opening.high) / 2
        middle += here[1] - (thing[1] + thing[3]) / 2 if thing and len(points) == 1 else 0.0
        middle = round(2 * middle) / 2 + (
            0.0 if random.random() < (0.8 if thing else 0.5) else float(random.uniform(-0.4, 0.4))
        )
        x0, _, x1, _ = plan.cells[number]
        long = thing[2] - thing[0] if thing else 0.0
        deep = float(random.uniform(1.0, max(x1 - x0 - 1.0 - long, 1.0)))
        end = x0 + deep if way > 0 else x1 - deep - long
        edge = plan.cells[number - way][2] - 1 - long if way > 0 else plan.cells[number - way][0] + 1
        points += [(edge if thing is None else here[0], middle), (end, middle)]
        here = points[-1]
    return points


def _transposed(world: World, way: list[XY], rooms: TrueRooms) -> tuple[World, list[XY], TrueRooms]:
    """Return all with x and y exchanged."""

    def swapped(shape: shapely.Geometry) -> shapely.Geometry:
        return affine_transform(shape, [0, 1, 1, 0, 0, 0])

    things = tuple(replace(thing, polygon=swapped(thing.polygon)) for thing in world.movable)
    verge = swapped(world.verge)
    (x, y), heading = world.utak, world.heading
    turned = World(world.height, world.width, verge, things, (), (y, x), heading)
    return turned, [(y, x) for x, y in way], rooms._replace(parts=tuple(map(swapped, rooms.parts)))


def _commands(world: World, way: Sequence[XY], carries: bool) -> list[Command]:
    """Return the commands along points of the table frame, with the thing in hand where one is carried."""
    c, s = math.cos(math.radians(world.heading)), math.sin(math.radians(world.heading))
    touches = Tabletop(world).look()[1]
    hands = [TOUCH_NAMES[k] for k, letter in enumerate(touches) if letter not in (None, VERGE_LETTER)]
    commands: list[Command] = [Grasp(hands[0] if hands else "north")] if carries else []
    steps = [(b[0] - a[0], b[1] - a[1]) for a, b in pairwise(way)]
    turned = [(x * c + y * s, -x * s + y * c) for x, y in steps if (x, y) != (0, 0)]
    commands += [(Push if carries else Move)(east, north) for east, north in turned]
    if carries:
        east, north = turned[-1]
        long = math.hypot(east, north) or 1.0
        back = [(-3 * east / long, -3 * north / long), (2 * north / long, -2 * east / long)]
        commands += [Release(), *(Move(*step) for step in back)]
    return commands
