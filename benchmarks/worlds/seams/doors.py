"""Two rooms with two or three doors: one must not be used by the task's constraint, or by a rule of the user.

The nearer door is mostly the one that a rule closes or prices, so that a robot that goes the shortest way breaks it.
"""

from dataclasses import replace

import numpy as np
from shapely import box

from benchmarks.worlds.odd import tasks
from benchmarks.worlds.odd.houses import House, OddNeck, straight, two_rooms
from benchmarks.worlds.odd.lying import place, stand
from benchmarks.worlds.odd.offgrid import doorways
from benchmarks.worlds.odd.tasks import OddScene, OddWorld
from benchmarks.worlds.placing import colour
from benchmarks.worlds.scenes import PlacedThing

TWO_DOORS_KIND, DOOR_RULE_KIND = "two_doors", "door_rule"
TWO_DOORS_TASKS = ("next", "carry_next", "next")
DOOR_RULES = {
    "closed": ":- occurs(go(D), T), width(D, W), W < 500.\n",
    "priced": ":~ occurs(go(D), T), width(D, W), W < 500. [20@1, narrow(D, T)]\n",
}
RULE_SENTENCE = '%! because "Door {D} is {W/100} squares wide, and narrow doors are to be left alone."\n'
NARROW_DOORS, WIDE_DOORS = (28, 42), (56, 72)  # tenths of squares: narrower than 5 beyond doubt, and wider


def two_doors(rng: np.random.Generator, seed: int) -> OddWorld | None:
    """Return a world whose goal forbids one door of two or three; None when things find no place."""
    task = TWO_DOORS_TASKS[seed % len(TWO_DOORS_TASKS)]
    plan = _plan(rng, [float(rng.integers(4, 7)) for _ in range(2 + int(rng.random() < 0.3))], 0.0)
    made = _furnished(rng, TWO_DOORS_KIND, seed, task, f"{len(plan.necks)} doors", plan, 0)
    if made is None:
        return None
    who = "utak" if task == "next" else "x"
    texts = made.texts
    return tasks.asked(
        made, texts.start + "door(d).\n", texts.goal + f"not_through({who}, d).\n", texts.expect, tasks.YES
    )


def door_rule(rng: np.random.Generator, seed: int) -> OddWorld | None:
    """Return a world with a rule that closes or prices its narrow door; None when things find no place."""
    variant, task = sorted(DOOR_RULES)[seed % 2], ("next", "carry_next", "next")[seed // 2 % 3]
    off = 0.0 if rng.random() < 0.5 else round(float(rng.uniform(0.1, 0.9)), 2)
    widths = [int(rng.integers(*span)) / 10 for span in (NARROW_DOORS, WIDE_DOORS)]
    if not off:
        widths = [float(round(width)) for width in widths]
    plan = _plan(rng, widths, off)
    made = _furnished(rng, DOOR_RULE_KIND, seed, task, variant, plan, int(rng.random() < 0.25))
    if made is None:
        return None
    narrow = min(plan.necks, key=lambda neck: neck.clear)
    return replace(
        made,
        texts=replace(made.texts, rules=RULE_SENTENCE + DOOR_RULES[variant]),
        avoid=narrow.middle,
    )


def _plan(rng: np.random.Generator, widths: list[float], off: float) -> House:
    """Return two rooms with doors of some widths, in random order along the wall between them."""
    order = [widths[n] for n in rng.permutation(len(widths))]
    gaps = [float(rng.integers(3, 7)) + off for _ in order]
    starts, at = [], 0.0
    for gap, width in zip(gaps, order, strict=True):
        starts.append(at + gap)
        at += gap + width
    high = at + float(rng.integers(3, 6))
    depths = tuple(float(rng.integers(16, 21)) + off for _ in range(2))
    wall = float(rng.integers(1, 4))
    made = [straight((depths[0], depths[1]), (high, high), wall, w, s) for w, s in zip(order, starts, strict=True)]
    necks: list[OddNeck] = [neck for _, _, neck in made]
    return two_rooms(made[0][0], made[0][1], necks, 90.0 * int(rng.integers(4)), (2 + off, 2 + off))


def _furnished(
    rng: np.random.Generator, kind: str, seed: int, task: str, variant: str, plan: House, far: int
) -> OddWorld | None:
    """Return the world with the robot nearer to its narrowest door than to others, unless `far`."""
    home = int(rng.integers(2))
    things: tuple[PlacedThing, ...] = ()
    if task == "carry_next":
        x = place(rng, box(0, 0, 2, 2), plan.rooms[home], [door.buffer(1.5) for door in doorways(plan)], True)
        if x is None:
            return None
        things = (PlacedThing("t1", colour(rng), "square", x),)
    utak = stand(rng, plan.rooms[home], [thing.polygon for thing in things], True)
    if utak is None:
        return None
    doors = sorted(plan.necks, key=lambda neck: neck.clear)
    away = [door.polygon.distance(utak) for door in doors]
    if (away[0] == min(away)) == bool(far):
        return None
    scene = OddScene(plan, home, things, utak, tasks.heading(rng, bool(rng.random() < 0.7)))
    return tasks.given(kind, seed, task, variant, scene)
