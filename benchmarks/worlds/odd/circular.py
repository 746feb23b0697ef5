"""Round rooms: polygons of many sides, with a door between two of them."""

import math

import numpy as np
from shapely import Polygon

from benchmarks.worlds.odd import tasks
from benchmarks.worlds.odd.houses import House, OddNeck, two_rooms
from benchmarks.worlds.odd.offgrid import furnished, load, squeezed
from benchmarks.worlds.odd.tasks import OddWorld

ROUND_KIND = "round"
ROUND_TASKS = ("next", "carry_next", "at_x", "carry_door", "circle", "both")
ROUND_MARGINS = (-0.7, 0.6, 1.0, 1.5, 2.2)  # squares by which a door is wider than the thing
ROUND_ROOM_RADII = (7.5, 10.5)  # squares
POLYGON_SIDES = (16, 41)


def world(rng: np.random.Generator, seed: int) -> OddWorld | None:
    """Return the world of a seed; None when the things find no place by these random numbers."""
    task = ROUND_TASKS[seed % len(ROUND_TASKS)]
    shape, outline, least = load(rng, True)
    margin = ROUND_MARGINS[int(rng.integers(len(ROUND_MARGINS)))]
    carried = task in ("carry_next", "carry_door", "both")
    door = least + margin if carried else float(rng.uniform(2.5, 5))
    plan = circles(rng, door)
    possible = squeezed(plan.necks[0], least) if carried else tasks.YES
    return furnished(rng, ROUND_KIND, seed, task, f"door {door:.1f}", plan, shape, outline, possible)


def circles(rng: np.random.Generator, door: float) -> House:
    """Return two round rooms with a door of a given width between them, in any direction."""
    radii = [max(float(rng.uniform(*ROUND_ROOM_RADII)), door + 2.5) for _ in range(2)]
    sides = int(rng.integers(*POLYGON_SIDES))
    depth = [radius * math.cos(math.asin(door / 2 / radius)) * math.cos(math.pi / sides) - 0.1 for radius in radii]
    far = depth[0] + float(rng.uniform(1.5, 4.5))
    second = far + depth[1]
    rooms = [_round(0, radii[0], sides), _round(second, radii[1], sides)]
    neck = OddNeck((depth[0], -door / 2), (depth[0], door / 2), (far, -door / 2), (far, door / 2))
    return two_rooms(rooms[0], rooms[1], [neck], float(rng.uniform(0, 360)))


def _round(x: float, radius: float, sides: int) -> Polygon:
    turns = [2 * math.pi * (n + 0.5) / sides for n in range(sides)]
    return Polygon([(x + radius * math.cos(turn), radius * math.sin(turn)) for turn in turns])
