"""Random rooms with gaps that something may be too wide for, felt all round; and whether it gets out, or to corners."""

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import shapely
from shapely.affinity import translate

from benchmarks.certificates.drawn import HEADINGS
from benchmarks.certificates.recorded import RecordedWalk, recorded_walk
from utak.geometry import Pose, plan_motion
from utak.kb.body import Command, Grasp, Move, Push, Release
from utak.simulator.certificates.checker import CORNERS
from utak.simulator.certificates.courses import TOUCH_NAMES
from utak.simulator.world.world import Thing, World

WALL = 2.0  # squares: how thick walls are
OUTSIDE = 7.0  # squares of floor beyond the room, on each side
FURTHEST_SEEN = 24.0  # squares: no field reaches further
FEELING_STRIDE = 2.0  # squares between halts along the walls, so that each square of them is felt


def drawn_room(seed: int, noise: float = 0.0) -> RecordedWalk:
    """Return a walk along all walls of a room, beside a thing first, and often with something carried at the end."""
    random = np.random.default_rng([23, seed])
    width, height = (int(n) for n in random.integers(7, 12, 2))
    low = OUTSIDE + WALL
    room = shapely.box(low, low, low + width, low + height)
    table = shapely.box(0, 0, 2 * low + width, 2 * low + height)
    off = float(random.choice([0.0, 0.0, 0.0, 0.3]))  # walls beside the lines of the grid
    verge = room.buffer(WALL, join_style="mitre") - shapely.box(low, low, low + width + off, low + height)
    gaps = [_gap(random, width, height, low) for _ in range(int(random.integers(3)))]
    verge = shapely.union_all([table.exterior.buffer(1.0, join_style="mitre") & table, verge - shapely.union_all(gaps)])
    x, y = low + 2 + int(random.integers(width - 5)), low + 2 + int(random.integers(height - 5))
    shape = translate(_shape(random), x + float(random.choice([0.0, 0.0, 0.0, 0.25])), y)
    things = [Thing("k1", "k", shape)]
    if random.random() < 0.3:
        other = shapely.box(low + width - 2, low + height - 2, low + width - 1, low + height - 1)
        things += [Thing("g1", "g", other)] * (other.intersection(shape).area == 0)
    more = np.random.default_rng([29, seed])
    cut = (int(more.integers(1, width - 2)), int(more.integers(1, height - 2))) if more.random() < 0.4 else (0, 0)
    notch = shapely.box(low, low + height - cut[1], low + cut[0], low + height)  # makes an L of the room
    if any(thing.polygon.buffer(1.5).intersects(notch) for thing in things):
        cut = (0, 0)
    verge = verge | notch if cut[0] else verge
    heading = int(random.choice(HEADINGS))
    x0, y0 = shape.bounds[:2]
    start = x0 - 0.5, y0 + 0.5
    world = World(*(int(n) for n in table.bounds[2:]), verge, tuple(things), (), start, heading)
    points = [(low + 0.5, y0 + 0.5), *_ring(low, width, height, cut), (low + 0.5, y0 + 0.5), start]
    commands = _moves(points, start, heading)
    if random.random() < 0.5:
        east, north = (float(n) for n in random.integers(-2, 3, 2))
        commands += [Grasp(str(random.choice(TOUCH_NAMES[1:4]))), Push(east, north), Release(), Move(-east, -north)]
    goals = [str(random.choice(["in(x,room(next))", "in(x,room(next))", "through(x,d)", "in(utak,room(next))"]))]
    if more.random() < 0.5:
        what, names = str(more.choice(["utak", "x"])), more.choice(list(CORNERS), 2, replace=False)
        second = str(more.choice([f"at({what},corner({names[1]}))", f"at({what},start)"]))
        goals = [f"at({what},corner({names[0]}))", second][: int(more.integers(1, 3))]
    return recorded_walk(world, commands, goals, noise=(noise, seed))


def meets_corners(walk: RecordedWalk, name: str, corners: Sequence[str]) -> str:
    """Return whether `utak` or a thing can be at corners at once, "" being where the robot woke: "yes", "no" or "open".

    The corners are those of all floor that may have been seen: none nearer were known. Nothing is said of things.
    """
    world, turn = walk.world, math.radians(walk.world.heading)
    floor = shapely.box(0, 0, world.width, world.height) - world.verge
    own = next(part for part in shapely.get_parts(floor) if part.intersects(shapely.Point(walk.places[0])))
    squares = [(i, j) for i in range(world.width) for j in range(world.height)]
    squares = [(i, j) for i, j in squares if floor.contains(shapely.Point(i + 0.5, j + 0.5))]
    seen = [at for at in squares if any(math.dist(at, place) < FURTHEST_SEEN for place in walk.places)]
    places = [(i + a, j + b) for i, j in squares for a in (0, 0.5, 1) for b in (0, 0.5, 1)]
    places = [at for at in places if own.intersects(shapely.Point(at))]
    outlines = [thing.polygon for thing in world.movable if thing.name == name]
    slack = 2 * sum(map(shapely.minimum_bounding_radius, outlines))
    for corner in corners:
        if not corner:
            away = [max(abs(x - walk.places[0][0]), abs(y - walk.places[0][1])) for x, y in places]
            places = [at for at, far in zip(places, away, strict=True) if far <= 2 + slack]
            continue
        a, b = CORNERS[corner]
        u, v = a * math.cos(turn) - b * math.sin(turn), a * math.sin(turn) + b * math.cos(turn)
        furthest = max(u * (i + (u > 0)) + v * (j + (v > 0)) for i, j in seen)
        places = [(x, y) for x, y in places if u * x + v * y >= furthest - 2 - slack]
    return "no" if not places else "yes" if name == "utak" else "open"


def gets_out(walk: RecordedWalk, name: str) -> str:
    """Return whether `utak` or a thing can leave the room, by true geometry: "yes", "no", or "open": not known."""
    world = walk.world
    low = OUTSIDE + WALL
    inside = shapely.box(low - 0.5, low - 0.5, world.width - low + 0.5, world.height - low + 0.5)
    if name == "utak":
        floor = shapely.box(0, 0, world.width, world.height) - world.verge
        return (
            "no"
            if all(inside.contains(part) for part in shapely.get_parts(floor) if part.intersects(inside))
            else "yes"
        )
    (shape,) = (thing.polygon for thing in world.movable if thing.name == name)
    centre = shape.centroid
    body = translate(shape, -centre.x, -centre.y)
    for side in ((-1, 0), (1, 0), (0, -1), (0, 1)):
        x = {-1: OUTSIDE / 2 + 0.5, 0: centre.x, 1: world.width - OUTSIDE / 2 - 0.5}[side[0]]
        y = {-1: OUTSIDE / 2 + 0.5, 0: centre.y, 1: world.height - OUTSIDE / 2 - 0.5}[side[1]]
        bounds = (0.0, 0.0, float(world.width), float(world.height))
        plan = plan_motion(body, world.verge, Pose(centre.x, centre.y, 0), Pose(x, y, 0), bounds, 0.01)
        if plan.status != "impossible":
            return "yes" if plan.status == "found" else "open"
    return "no"


def _gap(random: np.random.Generator, width: int, height: int, low: float) -> shapely.Polygon:
    """Return what is left out of a wall."""
    wide = float(random.choice([1.0, 2.0, 3.0, 1.5]))
    if random.random() < 0.5:
        x, y = low + int(random.integers(1, width - 3)), (low - WALL, low + height)[int(random.integers(2))]
        return shapely.box(x, y, x + wide, y + WALL)
    x, y = (low - WALL, low + width)[int(random.integers(2))], low + int(random.integers(1, height - 3))
    return shapely.box(x, y, x + WALL + 0.5, y + wide)


def _shape(random: np.random.Generator) -> shapely.Polygon:
    """Return the outline of a thing: a rectangle or an L of squares, or a square that is a little smaller."""
    a, b = (int(n) for n in random.integers(1, 4, 2))
    kind = random.random()
    if kind < 0.6:
        return shapely.box(0, 0, a, b)
    if kind < 0.85:
        return shapely.box(0, 0, a + 1, 1) | shapely.box(0, 0, 1, b + 1)
    return shapely.box(0, 0, a - 0.2, a - 0.2)


def _ring(low: float, width: int, height: int, cut: tuple[int, int]) -> list[tuple[float, float]]:
    """Return halts along all walls, counter-clockwise; cut : how much is cut off in the northwest."""
    (x0, y0), (x1, y1), (a, b) = (low + 0.5, low + 0.5), (low + width - 0.5, low + height - 0.5), cut
    corners = [(x0, y0), (x1, y0), (x1, y1), (x0 + a, y1), (x0 + a, y1 - b), (x0, y1 - b), (x0, y0)]
    found = []
    for (ax, ay), (bx, by) in pairwise(corners):
        parts = max(math.ceil(max(abs(bx - ax), abs(by - ay)) / FEELING_STRIDE), 1)
        found += [(ax + (bx - ax) * k / parts, ay + (by - ay) * k / parts) for k in range(parts + 1)]
    return found


def _moves(points: list[tuple[float, float]], start: tuple[float, float], heading: int) -> list[Command]:
    """Return the moves along points of the table frame."""
    c, s, commands, here = math.cos(math.radians(heading)), math.sin(math.radians(heading)), list[Command](), start
    for there in points:
        dx, dy = there[0] - here[0], there[1] - here[1]
        if math.hypot(dx, dy) > 0:
            commands.append(Move(dx * c + dy * s, -dx * s + dy * c))
        here = there
    return commands
