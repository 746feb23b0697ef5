"""Wide openings: wider than half the floor on one of their sides, so that they are no doors; and narrower ones."""

import numpy as np
from shapely import box

from benchmarks.worlds.odd import tasks
from benchmarks.worlds.odd.houses import House, straight, two_rooms
from benchmarks.worlds.odd.offgrid import furnished
from benchmarks.worlds.odd.tasks import OddWorld

WIDE_OPENING_KIND = "wide"
WIDE_OPENING_TASKS = ("next", "next", "carry_next", "next", "carry_door")
WIDE_OPENING_VARIANTS = ("door", "no_door", "half", "no_door")
BEYOND_DOUBT = 0.7  # squares by which an opening is wider than half the widest circle's diameter beside it


def world(rng: np.random.Generator, seed: int) -> OddWorld | None:
    """Return the world of a seed; None when the things find no place by these random numbers."""
    variant, task = (
        WIDE_OPENING_VARIANTS[seed % len(WIDE_OPENING_VARIANTS)],
        WIDE_OPENING_TASKS[seed % len(WIDE_OPENING_TASKS)],
    )
    depths = tuple(float(rng.integers(9, 19)) for _ in range(2))
    high = float(rng.integers(12, 23))
    floor = min(*depths, high)
    if variant == "door":
        wide = float(np.floor(floor / 2 - 0.5))
    elif variant == "half":
        wide = float(np.floor(floor / 2))
    else:
        wide = float(np.ceil(floor / 2 + 0.5))
        while wide < widest(floor, wide) / 2 + BEYOND_DOUBT:
            wide += 1
    if wide > high - 4 or wide < 4:
        return None
    at = float(rng.integers(2, int(high - wide) - 1))
    first, second, neck = straight((depths[0], depths[1]), (high, high), float(rng.integers(1, 4)), wide, at)
    plan = two_rooms(first, second, [neck], 90.0 * int(rng.integers(2)))
    possible = tasks.NO if variant == "no_door" else tasks.YES
    side = float(rng.integers(2, 4))
    made = furnished(
        rng,
        WIDE_OPENING_KIND,
        seed,
        task,
        variant,
        plan,
        "square",
        box(0, 0, side, side),
        possible,
        quarter=True,
        whole=True,
    )
    if made is None or variant != "no_door":
        return made
    texts = made.texts
    why = "the opening is wider than half the floor on one of its sides: no door"
    return tasks.asked(made, texts.start, texts.goal, texts.expect, tasks.NO, why)


def widest(floor: float, opening: float) -> float:
    """Return the diameter of the widest circle before an opening in a wall of a room so deep, drawn into the opening.

    It touches the wall opposite and both jambs, which leaves it more than the room's depth.
    """
    return floor + opening**2 / (4 * floor)


def is_door(plan: House) -> bool:
    """Return whether the opening of a plan is at most half as wide as both of its rooms."""
    sides = [side for room in plan.rooms for side in np.subtract(room.bounds[2:], room.bounds[:2])]
    return plan.necks[0].clear <= min(sides) / 2
