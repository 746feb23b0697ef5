"""Corners of rooms whose walls lie anywhere between the lines of the grid, for a robot that wakes at any heading."""

import numpy as np
from shapely import Polygon, box
from shapely.affinity import rotate

from benchmarks.worlds.odd import tasks
from benchmarks.worlds.odd.houses import one_room
from benchmarks.worlds.odd.lying import place, rounded, stand
from benchmarks.worlds.odd.offgrid import doorways, real, real_rooms
from benchmarks.worlds.odd.tasks import OddScene, OddWorld
from benchmarks.worlds.placing import colour
from benchmarks.worlds.scenes import PlacedThing

HEADING_KIND = "heading"
HEADING_SHAPES = {
    "triangle": Polygon([(0, 0), (6, 0), (0, 6)]),
    "square": box(0, 0, 3, 3),
    "brick": box(0, 0, 5, 2),
}


def world(rng: np.random.Generator, seed: int) -> OddWorld | None:
    """Return the world of a seed; None when the things find no place by these random numbers."""
    margin = (real(rng, 1.1, 2.4), real(rng, 1.1, 2.4))
    if seed % 3 == 0:
        plan = one_room(box(0, 0, real(rng, 14, 24), real(rng, 14, 24)), 0.0, margin)
    else:
        plan = real_rooms(rng, real(rng, 4, 6.5))
    home = int(rng.integers(len(plan.rooms)))
    things: list[PlacedThing] = []
    for _ in range(int(rng.integers(0, 3))):
        shape = str(rng.choice(sorted(HEADING_SHAPES)))
        outline = rotate(HEADING_SHAPES[shape], float(rng.uniform(0, 360)), origin=(0, 0))
        taken = [*(door.buffer(1.5) for door in doorways(plan)), *(thing.polygon for thing in things)]
        lain = place(rng, rounded(outline), plan.rooms[int(rng.integers(len(plan.rooms)))], taken, False)
        if lain is not None:
            things.append(PlacedThing(f"d{len(things)}", colour(rng), shape, lain))
    utak = stand(rng, plan.rooms[home], [thing.polygon for thing in things], bool(rng.random() < 0.5))
    facing = int(rng.integers(360)) if seed % 2 else int(rng.integers(4)) * 90
    compass = tasks.choose_corner(rng, plan, facing)
    if utak is None or compass is None:
        return None
    corner = plan.furthest_corner(compass, facing)
    if corner is None or not plan.rooms[home].buffer(0.1).covers(corner):
        return None
    scene = OddScene(plan, home, tuple(things), utak, facing)
    return tasks.given(HEADING_KIND, seed, "corner", f"facing {facing}", scene, compass=compass)
