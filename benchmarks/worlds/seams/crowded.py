"""Rooms packed with boxes: many things between which the robot and what it carries must find a way."""

import numpy as np
from shapely import box

from benchmarks.worlds.odd import tasks
from benchmarks.worlds.odd.houses import one_room, straight, two_rooms
from benchmarks.worlds.odd.lying import place, stand
from benchmarks.worlds.odd.offgrid import doorways
from benchmarks.worlds.odd.tasks import OddScene, OddWorld
from benchmarks.worlds.placing import colour
from benchmarks.worlds.scenes import PlacedThing

PACKED_KIND = "packed"
PACKED_TASKS = ("next", "carry_next", "at_x", "carry_corner", "next")
PACKED_COUNTS = (8, 17)  # boxes
PACKED_GAP = 1.2  # squares between boxes, and from them to walls: the robot passes everywhere


def world(rng: np.random.Generator, seed: int) -> OddWorld | None:
    """Return the world of a seed; None when the things find no place by these random numbers."""
    task = PACKED_TASKS[seed % len(PACKED_TASKS)]
    depths, high = (float(rng.integers(18, 25)), float(rng.integers(18, 25))), float(rng.integers(18, 25))
    if task == "carry_corner":
        plan = one_room(box(0, 0, depths[0], high + 4))
    else:
        door = float(rng.integers(5, 8))
        first, second, neck = straight(depths, (high, high), 2.0, door, float(rng.integers(3, int(high - door) - 2)))
        plan = two_rooms(first, second, [neck], 90.0 * int(rng.integers(2)))
    home = int(rng.integers(len(plan.rooms)))
    taken = [door.buffer(1.5) for door in doorways(plan)]
    things: list[PlacedThing] = []
    wanted = int(rng.integers(*PACKED_COUNTS))
    for number in range(wanted):
        own = number == 0 and task != "next"
        outline = box(0, 0, 3, 3) if own else box(0, 0, 2, float(rng.integers(4, 6)))
        room = plan.rooms[home] if own or len(plan.rooms) == 1 or rng.random() < 0.75 else plan.rooms[1 - home]
        lain = place(
            rng,
            outline,
            room,
            [*taken, *(t.polygon for t in things)],
            bool(rng.random() < 0.8),
            90.0 * int(rng.integers(2)),
            PACKED_GAP,
        )
        if lain is None:
            if own:
                return None
            continue
        things.append(PlacedThing(f"t{len(things) + 1}", colour(rng), "square" if own else "brick", lain))
    utak = stand(rng, plan.rooms[home], [thing.polygon for thing in things], True, 1.0)
    facing = tasks.heading(rng, True)
    compass = tasks.choose_corner(rng, plan, facing) if task in tasks.TO_CORNER else ""
    if utak is None or compass is None or len(things) < PACKED_COUNTS[0]:
        return None
    scene = OddScene(plan, home, tuple(things), utak, facing)
    possible = tasks.YES if task in ("next", "at_x") else tasks.NOT_KNOWN
    return tasks.given(PACKED_KIND, seed, task, f"{len(things)} things", scene, possible, compass=compass)
