"""A movable C or U about the robot, and things that lean on walls and are to be circled."""

import numpy as np
from shapely import Polygon, box
from shapely.affinity import rotate, translate

from benchmarks.worlds.furniture import horseshoe
from benchmarks.worlds.odd import tasks
from benchmarks.worlds.odd.houses import House, one_room, straight, two_rooms
from benchmarks.worlds.odd.lying import place, rounded, stand
from benchmarks.worlds.odd.offgrid import doorways
from benchmarks.worlds.odd.tasks import OddScene, OddWorld
from benchmarks.worlds.placing import colour
from benchmarks.worlds.scenes import PlacedThing

ENCLOSED_KIND, LEANING_KIND = "enclosed", "leaning"
ENCLOSED_VARIANTS = ("c", "u", "c off the grid", "u carried")
ENCLOSED_GAP = 3.0  # squares from what is about the robot to the walls
MOUTH_WIDTHS = (1.0, 2.0)  # squares


def enclosed(rng: np.random.Generator, seed: int) -> OddWorld | None:
    """Return a world with a C or a U about the robot; None when it finds no place by these random numbers."""
    variant = ENCLOSED_VARIANTS[seed % len(ENCLOSED_VARIANTS)]
    depths, high, door = _sides(rng, 23, 29), float(rng.integers(21, 26)), float(rng.integers(8, 10))
    first, second, neck = straight(depths, (high, high), 2.0, door, float(rng.integers(2, int(high - door) - 1)))
    plan = two_rooms(first, second, [neck], 90.0 * int(rng.integers(2)))
    home = int(rng.integers(2))
    outline = (
        horseshoe(2, 2, int(rng.integers(3, 5))) if variant.startswith("u") else _c(rng, variant == "c off the grid")
    )
    outline = rotate(outline, 90.0 * int(rng.integers(4)), origin=(0, 0))
    about = place(rng, outline, plan.rooms[home], doorways(plan), True, gap=ENCLOSED_GAP)
    if about is None:
        return None
    hollow = about.envelope.difference(about)
    inside = max(getattr(hollow, "geoms", [hollow]), key=lambda part: part.area)
    utak = stand(rng, inside, [], True, 0.5)
    if utak is None:
        return None
    things = (PlacedThing("t1", colour(rng), "u_shape" if variant.startswith("u") else "polygon", about),)
    scene = OddScene(plan, home, things, utak, tasks.heading(rng, True))
    return tasks.given(ENCLOSED_KIND, seed, "carry_next" if variant == "u carried" else "next", variant, scene)


def leaning(rng: np.random.Generator, seed: int) -> OddWorld | None:
    """Return a room with a thing against a wall, or in a corner, that is to be circled; None when it cannot stand."""
    variant, side = ("wall", "corner")[seed % 2], float(rng.integers(2, 5))
    depths, high = _sides(rng, 17, 23), float(rng.integers(17, 23))
    plan = one_room(box(0, 0, depths[0], high)) if rng.random() < 0.5 else _joined(rng, depths, high)
    home = int(rng.integers(len(plan.rooms)))
    room = plan.rooms[home]
    west, south, east, north = room.bounds
    x, y = float(rng.choice([west, east - side])), float(rng.choice([south, north - side]))
    if variant == "wall":
        along = float(rng.integers(3, int(min(east - west, north - south) - side - 3)))
        x, y = (x, south + along) if rng.random() < 0.5 else (west + along, y)
    thing = rounded(translate(box(0, 0, side, side), x, y))
    if any(thing.distance(door) < 3 for door in doorways(plan)):
        return None
    utak = stand(rng, room, [thing.buffer(2.0)], True)
    if utak is None:
        return None
    things = (PlacedThing("t1", colour(rng), "square", thing),)
    return tasks.given(
        LEANING_KIND, seed, "circle", variant, OddScene(plan, home, things, utak, tasks.heading(rng, True))
    )


def _sides(rng: np.random.Generator, low: int, high: int) -> tuple[float, float]:
    return float(rng.integers(low, high)), float(rng.integers(low, high))


def _joined(rng: np.random.Generator, depths: tuple[float, float], high: float) -> House:
    door = float(rng.integers(4, 7))
    first, second, neck = straight(depths, (high, high), 2.0, door, float(rng.integers(2, int(high - door) - 1)))
    return two_rooms(first, second, [neck], 90.0 * int(rng.integers(2)))


def _c(rng: np.random.Generator, off_grid: bool) -> Polygon:
    """Return a ring with walls of two squares and a mouth in its east side, on whole squares or beside them."""
    inner = float(rng.integers(4, 7))
    wide = inner + 4
    mouth = float(rng.integers(1, 3)) if not off_grid else round(float(rng.uniform(*MOUTH_WIDTHS)), 2)
    low = float(rng.integers(2, int(2 + inner - mouth) + 1))
    if off_grid:
        low = min(low + round(float(rng.uniform(0.2, 0.8)), 2), 2 + inner - mouth)
    ring = box(0, 0, wide, wide).difference(box(2, 2, wide - 2, wide - 2))
    left = ring.difference(box(wide - 2, low, wide, low + mouth))
    assert isinstance(left, Polygon)
    return left
