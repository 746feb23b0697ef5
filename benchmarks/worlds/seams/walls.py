"""Walls that are things, and openings that are there although no whole square of them is free.

A room is bounded by walls and doors. A row of movable things that leaves a gap divides no room in two, and the end of a
movable screen is no corner of the verge.
"""

from dataclasses import replace

import numpy as np
from shapely import Polygon, box

from benchmarks.worlds.odd import tasks
from benchmarks.worlds.odd.houses import House, one_room, straight, two_rooms
from benchmarks.worlds.odd.lying import place, rounded, stand
from benchmarks.worlds.odd.offgrid import doorways, real
from benchmarks.worlds.odd.tasks import OddScene, OddWorld
from benchmarks.worlds.placing import colour
from benchmarks.worlds.scenes import PlacedThing

THING_WALL_KIND, PART_GAP_KIND = "thing_wall", "part_gap"
THING_WALL_VARIANTS = ("two", "one", "screen", "beyond")
THING_WALL_TASKS = ("next", "next", "carry_next")
PART_GAP_WIDTHS = (0.5, 1.95)  # squares
PARTED_BY_THINGS = "there is no next room: what seems to part it are things"


def thing_wall(rng: np.random.Generator, seed: int) -> OddWorld | None:
    """Return a room that things seem to divide; None when the things find no place by these random numbers.

    Variants: "two", two things with a gap between them; "one", a stub of wall and a thing; "screen", one thing with a
    free end; "beyond", two things, and a true door to another room.
    """
    variant, task = THING_WALL_VARIANTS[seed % 4], THING_WALL_TASKS[seed // 4 % 3]
    whole = bool(rng.random() < 0.5)
    wide, high = (_length(rng, whole, *span) for span in ((27, 34), (13, 17)))
    parted, thick = _length(rng, whole, 10, wide - 15), _length(rng, whole, 1, 3)
    gap = _length(rng, whole, 2.5, 5)
    low = _length(rng, whole, 3, high - gap - 3) if variant != "one" else _length(rng, whole, 2, high / 2 - gap)
    spans = [(0.0, low), (low + gap, high)] if variant != "screen" else [(0.0, high - gap)]
    parts = [box(parted, a, parted + thick, b) for a, b in spans]
    floor = box(0, 0, wide, high)
    if variant == "one":
        floor, parts = floor.difference(parts[0]), parts[1:]
    plan = _house(rng, floor, wide, high) if variant == "beyond" else one_room(floor)
    turned = bool(rng.integers(2))
    by = (2.0, 2.0)
    if turned:
        plan, parts = _turned(plan), [_swapped(part) for part in parts]
    laid = [rounded(Polygon([(x + by[0], y + by[1]) for x, y in part.exterior.coords])) for part in parts]
    things = [PlacedThing(f"w{n}", colour(rng), "polygon", part) for n, part in enumerate(laid, 1)]
    room = plan.rooms[0]
    taken = [thing.polygon for thing in things] + [door.buffer(1.5) for door in doorways(plan)]
    if variant == "screen":
        task = "around"
    if task == "carry_next":
        x = place(rng, box(0, 0, 2, 2), room, taken, whole)
        if x is None:
            return None
        things.insert(0, PlacedThing("t1", colour(rng), "square", x))
    utak = stand(rng, room, [thing.polygon for thing in things], True)
    if utak is None:
        return None
    scene = OddScene(plan, 0, tuple(things), utak, tasks.heading(rng, whole))
    possible = tasks.YES if variant == "beyond" else tasks.NO
    if task != "around":
        return tasks.given(
            THING_WALL_KIND, seed, task, variant, scene, possible, "" if possible == tasks.YES else PARTED_BY_THINGS
        )
    made = tasks.given(THING_WALL_KIND, seed, "next", variant, scene, tasks.NO, PARTED_BY_THINGS)
    return tasks.asked(made, "", "around(utak, corner).\n", "", tasks.NO, "a thing has no corner of the verge")


def part_gap(rng: np.random.Generator, seed: int) -> OddWorld | None:
    """Return two rooms with an opening that covers no whole square; None when this one does."""
    depths, high = (real(rng, 8, 14), real(rng, 8, 14)), real(rng, 8, 14)
    width, wall = real(rng, *PART_GAP_WIDTHS), real(rng, 0.6, 2.6)
    first, second, neck = straight(depths, (high, high), wall, width, real(rng, 2, high - width - 2))
    margin = (real(rng, 1.1, 2.4), real(rng, 1.1, 2.4))
    plan = two_rooms(first, second, [neck], 90.0 * int(rng.integers(4)), margin)
    west, south, east, north = plan.necks[0].polygon.bounds
    low, top = (south, north) if abs(plan.necks[0].a0[0] - plan.necks[0].a1[0]) < 1e-9 else (west, east)
    if np.floor(top) - np.ceil(low) >= 1:
        return None
    home = int(rng.integers(2))
    utak = stand(rng, plan.rooms[home], [], bool(rng.random() < 0.5))
    if utak is None:
        return None
    scene = OddScene(plan, home, (), utak, tasks.heading(rng, False))
    return tasks.given(PART_GAP_KIND, seed, "next", f"{width:.2f} wide", scene)


def _length(rng: np.random.Generator, whole: bool, low: float, high: float) -> float:
    """Return a length between two others: whole, or of two decimals."""
    return (
        float(rng.integers(int(np.ceil(low)), max(int(high), int(np.ceil(low))) + 1))
        if whole
        else real(rng, low, max(low, high))
    )


def _house(rng: np.random.Generator, floor: Polygon, wide: float, high: float) -> House:
    """Return the floor with another room behind a door in its far wall."""
    door = float(rng.integers(3, 6))
    first, second, neck = straight(
        (wide, float(rng.integers(10, 15))), (high, high), 2.0, door, float(rng.integers(2, int(high - door) - 1))
    )
    assert first.equals(floor)
    return two_rooms(first, second, [neck])


def _swapped(shape: Polygon) -> Polygon:
    return Polygon([(y, x) for x, y in shape.exterior.coords])


def _turned(plan: House) -> House:
    """Return a floor with east and north exchanged."""
    necks = tuple(
        replace(neck, a0=neck.a0[::-1], a1=neck.a1[::-1], b0=neck.b0[::-1], b1=neck.b1[::-1]) for neck in plan.necks
    )
    rooms = tuple(_swapped(room) for room in plan.rooms)
    return House(plan.height, plan.width, rooms, necks, _swapped(plan.floor))
