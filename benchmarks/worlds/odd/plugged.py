"""Doors that one or two objects fill from jamb to jamb, so that no way leads through until they are moved."""

import numpy as np
from shapely import Polygon, box, union_all
from shapely.affinity import affine_transform

from benchmarks.worlds.odd import tasks
from benchmarks.worlds.odd.houses import House, OddNeck, straight, two_rooms
from benchmarks.worlds.odd.lying import place, rounded, stand
from benchmarks.worlds.odd.offgrid import real
from benchmarks.worlds.odd.tasks import OddScene, OddWorld
from benchmarks.worlds.placing import colour
from benchmarks.worlds.scenes import PlacedThing

PLUGGED_KIND = "plugged"
PLUGGED_VARIANTS = ("flush", "recessed", "out", "two", "flush", "fixed", "two_apart", "off_grid", "anchor", "out")
PLUGGED_TASKS = ("next", "carry_next", "next", "at_x", "carry_door", "both", "next")
FLANGE = 1.0  # squares by which an anchor is wider than the door, on both sides of the wall


def world(rng: np.random.Generator, seed: int) -> OddWorld | None:
    """Return the world of a seed; None when the things find no place by these random numbers."""
    variant, task = PLUGGED_VARIANTS[seed % len(PLUGGED_VARIANTS)], PLUGGED_TASKS[seed % len(PLUGGED_TASKS)]
    whole = variant != "off_grid"
    door = float(rng.integers(3, 6)) if whole else real(rng, 2.5, 5)
    wall = float(rng.integers(2, 5)) if whole else real(rng, 1.5, 3.5)
    depths = tuple(float(rng.integers(13, 18)) for _ in range(2))
    high = float(rng.integers(14, 19))
    at = float(rng.integers(2, int(high - door) - 1)) if whole else real(rng, 2, high - door - 2)
    first, second, neck = straight((depths[0], depths[1]), (high, high), wall, door, at)
    plan = two_rooms(first, second, [neck], 90.0 * int(rng.integers(2)))
    home = int(rng.integers(2))
    plugs = tuple(
        PlacedThing(f"p{n}", colour(rng), "polygon", polygon, variant == "fixed")
        for n, polygon in enumerate(_plugs(rng, plan, variant, wall, home), 1)
    )
    room = plan.rooms[1 - home] if task == "at_x" else plan.rooms[home]
    taken = [thing.polygon for thing in plugs] + [neck.polygon.buffer(1.0) for neck in plan.necks]
    things: tuple[PlacedThing, ...] = ()
    if task != "next":
        side = 2.0 if door < 4 else 3.0
        triangle = Polygon([(0, 0), (side, 0), (0, side)])
        polygon = place(rng, triangle, room, taken, True, 90.0 * int(rng.integers(4)))
        if polygon is None:
            return None
        things = (PlacedThing("t1", colour(rng), "triangle", polygon),)
    utak = stand(rng, plan.rooms[home], [*taken, *(thing.polygon for thing in things)], True)
    if utak is None:
        return None
    shut = variant in ("fixed", "anchor")
    scene = OddScene(plan, home, things + plugs, utak, tasks.heading(rng, True))
    why = "what fills the door cannot be moved out of it" if shut else ""
    return tasks.given(PLUGGED_KIND, seed, task, variant, scene, tasks.NO if shut else tasks.YES, why)


def _plugs(rng: np.random.Generator, plan: House, variant: str, wall: float, home: int) -> list[Polygon]:
    """Return what fills the door: spans of the way through it, 0 at the first room's wall, `wall` at the second's."""
    neck = plan.necks[0]
    if variant in ("flush", "off_grid", "fixed"):
        spans = [(0.0, wall)]
    elif variant == "recessed":
        spans = [(1.0, wall)] if home == 0 else [(0.0, wall - 1.0)]
    elif variant == "out":
        more = float(rng.integers(1, 4))
        spans = [(-more, wall)] if rng.random() < 0.5 else [(0.0, wall + more)]
    elif variant == "two":
        spans = [(0.0, wall / 2), (wall / 2, wall)]
    elif variant == "two_apart":
        spans = [(-2.0, 0.0), (wall, wall + 2.0)] if wall < 3 else [(0.0, 1.0), (wall - 1.0, wall)]
    else:
        return [_anchor(neck, wall)]
    return [_across(neck, wall, *span) for span in spans]


def _across(neck: OddNeck, wall: float, low: float, high: float, wider: float = 0.0) -> Polygon:
    """Return the box that fills a door from one distance from the first room's wall to another."""
    width = float(np.hypot(*np.subtract(neck.a1, neck.a0)))
    along, aside = np.subtract(neck.b0, neck.a0) / wall, np.subtract(neck.a1, neck.a0) / width
    part = box(low, -wider, high, width + wider)
    return rounded(affine_transform(part, [along[0], aside[0], along[1], aside[1], *neck.a0]))


def _anchor(neck: OddNeck, wall: float) -> Polygon:
    """Return an I whose stem fills the door and whose ends, on both sides of the wall, are wider than it."""
    ends = [_across(neck, wall, -1.0, 0.0, FLANGE), _across(neck, wall, wall, wall + 1.0, FLANGE)]
    return rounded(union_all([_across(neck, wall, -0.5, wall + 0.5), *ends]).simplify(0))
