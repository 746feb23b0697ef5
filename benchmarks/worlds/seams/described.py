"""Two rooms in which claims of start.lp tell things, doors and rooms apart that look alike."""

from dataclasses import replace

import numpy as np
from shapely import Polygon, box

from benchmarks.worlds.odd import tasks
from benchmarks.worlds.odd.houses import House, straight, two_rooms
from benchmarks.worlds.odd.lying import place, stand
from benchmarks.worlds.odd.offgrid import doorways
from benchmarks.worlds.odd.tasks import OddScene, OddWorld
from benchmarks.worlds.placing import colour, digital
from benchmarks.worlds.scenes import PlacedThing, wkt
from benchmarks.worlds.seams.doors import NARROW_DOORS, WIDE_DOORS

DESCRIBED_KIND = "described"
# By variant: start.lp beside the square x, and goal.lp.
DESCRIBED_TASKS = {
    "next_room": ("in(x, room(next)).\n", "at(utak, x).\n"),
    "carried": ("in(x, room(next)).\n", "at(x, start).\n"),
    "beside": ("object(y). shape(y, brick).\nbeside(x, y).\n", "at(utak, x).\n"),
    "size": ("size(x, {size}).\n", "at(utak, x).\n"),
    "room_of": ("object(y). shape(y, brick).\nroom(r). in(y, r).\n", "in(x, r).\n"),
    "width": ('door(d). width(d, "{narrow}").\n', "in(utak, room(next)).\nnot_through(utak, d).\n"),
}
SMALL, LARGE, BRICK = box(0, 0, 3, 3), box(0, 0, 4, 4), box(0, 0, 4, 2)
BESIDE_GAP = 0.5  # squares between things that are said to be beside each other, at most
LIKE_GAP = 3.0  # squares between things that are not, at least


def world(rng: np.random.Generator, seed: int) -> OddWorld | None:
    """Return the world of a seed; None when the things find no place by these random numbers."""
    variant = list(DESCRIBED_TASKS)[seed % len(DESCRIBED_TASKS)]
    whole, home = bool(rng.random() < 0.6), int(rng.integers(2))
    plan = _plan(rng, whole, variant == "width")
    things = _things(rng, variant, plan, home, whole)
    utak = None if things is None else stand(rng, plan.rooms[home], [thing.polygon for thing in things], True, 2.0)
    if things is None or utak is None:
        return None
    scene = OddScene(plan, home, things, utak, tasks.heading(rng, bool(rng.random() < 0.7)))
    made = tasks.given(DESCRIBED_KIND, seed, "next" if variant == "width" else "at_x", variant, scene)
    narrow = min(plan.necks, key=lambda neck: neck.clear)
    claims, goal = DESCRIBED_TASKS[variant]
    start = "" if variant == "width" else "object(x). shape(x, square).\n"
    expect = made.texts.expect
    if variant == "carried":
        expect = f'near(t1, "{wkt(utak)}", 2).\n'
    elif variant == "room_of":
        expect = f'inside(t1, "{wkt(plan.beyond(home))}").\n'
    size = int(digital(things[0].polygon, plan.width, plan.height).sum()) if things else 0
    told = start + claims.format(narrow=round(narrow.clear, 2), size=size)
    asked = tasks.asked(made, told, goal, expect, tasks.YES)
    return replace(asked, avoid=narrow.middle) if variant == "width" else asked


def _things(
    rng: np.random.Generator, variant: str, plan: House, home: int, whole: bool
) -> tuple[PlacedThing, ...] | None:
    """Return the things of a variant, t1 the one that is meant; None when they find no place."""
    rooms, taken = plan.rooms, [door.buffer(2.0) for door in doorways(plan)]
    found: list[PlacedThing] = []

    def put(shape: str, outline: Polygon, room: Polygon, gap: float = LIKE_GAP) -> bool:
        there = place(rng, outline, room, [*taken, *(one.polygon for one in found)], whole, gap=gap)
        if there is not None:
            found.append(PlacedThing(f"t{len(found) + 1}", colour(rng), shape, there))
        return there is not None

    far = rooms[1 - home]
    if variant in ("next_room", "carried"):
        return tuple(found) if put("square", SMALL, far) and put("square", SMALL, rooms[home]) else None
    if variant == "size":
        return tuple(found) if put("square", LARGE, rooms[home]) and put("square", SMALL, rooms[home]) else None
    if variant == "room_of":
        return tuple(found) if put("square", SMALL, rooms[home]) and put("brick", BRICK, far) else None
    if variant == "beside":
        if not put("square", SMALL, far):
            return None
        _, south, east, _ = found[0].polygon.bounds
        gap = round(float(rng.uniform(0.0, BESIDE_GAP)), 2) if not whole else 0.0
        brick = box(east + gap, south, east + gap + 2, south + 4)
        found.append(PlacedThing("t2", _other_colour(rng, found[0].colour), "brick", brick))
        clear = far.buffer(-2.0).covers(brick) and all(brick.distance(one) > 0 for one in taken)
        return tuple(found) if clear and put("square", SMALL, rooms[home]) else None
    return ()


def _other_colour(rng: np.random.Generator, taken: str) -> str:
    """Return a colour that is not taken: things that touch are told apart by it."""
    while (found := colour(rng)) == taken:
        pass
    return found


def _plan(rng: np.random.Generator, whole: bool, two: bool) -> House:
    """Return two rooms with a wide door, or with a narrow and a wide one."""
    widths = [int(rng.integers(*span)) / 10 for span in ((NARROW_DOORS, WIDE_DOORS) if two else (WIDE_DOORS,))]
    order = [float(round(widths[n])) if whole else widths[n] for n in rng.permutation(len(widths))]
    starts, at = [], 0.0
    for width in order:
        starts.append(at + float(rng.integers(3, 7)))
        at = starts[-1] + width
    high = max(at + float(rng.integers(3, 6)), 17.0)
    depths = float(rng.integers(17, 21)), float(rng.integers(17, 21))
    made = [straight(depths, (high, high), 2.0, w, s) for w, s in zip(order, starts, strict=True)]
    return two_rooms(made[0][0], made[0][1], [neck for _, _, neck in made], 90.0 * int(rng.integers(4)))
