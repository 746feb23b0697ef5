"""Slanted walls: houses at any angle, rooms that are trapezoids, doors that go obliquely through a wall."""

import math

import numpy as np
from shapely import Polygon, box

from benchmarks.worlds.odd import tasks
from benchmarks.worlds.odd.houses import House, OddNeck, one_room, two_rooms
from benchmarks.worlds.odd.offgrid import furnished, load, squeezed
from benchmarks.worlds.odd.tasks import OddWorld

SLANTED_KIND = "slanted"
SLANTED_TASKS = (
    "next",
    "carry_corner",
    "carry_next",
    "corner",
    "carry_door",
    "at_x",
    "circle",
    "next",
    "carry_next",
    "both",
)
SLANTED_MARGINS = (-0.8, 0.5, 0.9, 1.4, 2.0, 2.6)  # squares by which a door is wider than the thing
HOUSE_ANGLES = (4, 86)  # degrees
LEAN = 0.15  # squares sideways for a square along a wall: corners of 81 to 99 degrees


def world(rng: np.random.Generator, seed: int) -> OddWorld | None:
    """Return the world of a seed; None when the things find no place by these random numbers."""
    task = SLANTED_TASKS[seed % len(SLANTED_TASKS)]
    shape, outline, least = load(rng, True)
    margin = SLANTED_MARGINS[int(rng.integers(len(SLANTED_MARGINS)))]
    carried = task in ("carry_next", "carry_door", "both")
    door = least + margin if carried else float(rng.uniform(2.6, 6))
    angle = float(rng.uniform(*HOUSE_ANGLES)) if rng.random() < 0.75 else 0.0
    leaning = angle == 0 or rng.random() < 0.5
    if task in tasks.TO_CORNER:
        plan = one_room(trapezoid(rng, leaning), angle)
        possible = tasks.YES
    else:
        plan = askew(rng, door, leaning, angle)
        possible = squeezed(plan.necks[0], least) if carried else tasks.YES
    variant = f"{'leaning' if leaning else 'right-angled'} walls, turned by {angle:.0f}"
    turned = 0.0 if rng.random() < 0.5 else float(rng.uniform(0, 90))
    return furnished(rng, SLANTED_KIND, seed, task, variant, plan, shape, outline, possible, turned)


def trapezoid(rng: np.random.Generator, leaning: bool) -> Polygon:
    """Return a room of which two walls lean, or a rectangle."""
    width, height = float(rng.uniform(15, 22)), float(rng.uniform(15, 22))
    if not leaning:
        return box(0, 0, width, height)
    west, east = (float(v) * height for v in rng.uniform(-LEAN, LEAN, 2))
    return Polygon([(0, 0), (width, 0), (width + east, height), (west, height)])


def askew(rng: np.random.Generator, door: float, leaning: bool, angle: float) -> House:
    """Return two rooms with a slanted common wall, and a door obliquely through it, where walls are to lean."""
    high = max(14.0, 2 * door + 3) + float(rng.uniform(0, 4))
    lean, skew = (float(rng.uniform(-LEAN, LEAN)), float(rng.uniform(-0.4, 0.4))) if leaning else (0.0, 0.0)
    west, east, wall = float(rng.uniform(13, 18)), float(rng.uniform(13, 18)), float(rng.uniform(1, 2.5))
    outer = [float(v) * high for v in rng.uniform(-LEAN, LEAN, 2)] if leaning else [0.0, 0.0]
    far = west + wall
    first = Polygon([(0, 0), (west, 0), (west + lean * high, high), (outer[0], high)])
    second = Polygon([(far, 0), (far + east, 0), (far + east + outer[1], high), (far + lean * high, high)])
    along = door * math.hypot(wall, skew * wall) / wall  # so that the jambs' lines are as far apart as the door is wide
    at = float(rng.uniform(2 + abs(skew * wall), high - along - 2 - abs(skew * wall)))
    low, top = at + skew * wall, at + along + skew * wall
    neck = OddNeck((west + lean * at, at), (west + lean * (at + along), at + along), (0, 0), (0, 0))
    neck = OddNeck(neck.a0, neck.a1, (far + lean * low, low), (far + lean * top, top))
    return two_rooms(first, second, [neck], angle)
