"""Doorways that movable things fill from jamb to jamb, and closed rooms without a door, everything on whole squares.

python -m benchmarks.worlds.filled.doorplugs --kind flush,two --task next --seed 0 --count 3 -o FOLDER
"""

import argparse
import zlib
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from shapely import Polygon, box
from shapely.affinity import affine_transform

from benchmarks.worlds.odd import tasks
from benchmarks.worlds.odd.houses import House, OddNeck, one_room, straight, two_rooms
from benchmarks.worlds.odd.lying import place, rounded, stand
from benchmarks.worlds.odd.tasks import OddScene, OddWorld
from benchmarks.worlds.placing import colour
from benchmarks.worlds.scenes import PlacedThing, write

# flush: the thing ends with the wall on both sides. recessed: it leaves a niche on one side or both. out: it sticks
# out. two: two things fill the doorway, one behind the other. half: the thing sticks out on one side and ends within
# the doorway, where another thing may stand behind it. closed: a room without any door.
PLUG_KINDS = ("flush", "recessed", "out", "two", "half", "closed")
# Kinds whose doorway only a pull opens: the first thing reaches from jamb to jamb and stands against the second, so it
# cannot be pushed on or aside, nor turned.
PULL_KINDS = ("two",)
PLUG_TASKS = ("next", "carry_next")
ROOM_SIZES = (9, 17)  # squares, the least and one more than the most
WALL_SIZES, DOOR_SIZES = (2, 5), (3, 6)  # squares, likewise
CLOSED_SIZES = (10, 21)  # squares, likewise
MAX_PLUG_TRIES = 500


def plugged_world(kind: str, task: str, seed: int) -> OddWorld:
    """Return the world of a kind, a task and a seed from 0 on; the same three give the same world.

    Raises ValueError when there is no such kind, task or seed.
    """
    if kind not in PLUG_KINDS or task not in PLUG_TASKS or seed < 0:
        raise ValueError(f"no world {kind}, {task}, {seed}: kinds {PLUG_KINDS}, tasks {PLUG_TASKS}, seeds from 0")
    rng = np.random.default_rng([zlib.crc32(f"{kind} {task}".encode()), seed])
    for _ in range(MAX_PLUG_TRIES):
        made = _closed(rng, task, seed) if kind == "closed" else _plugged(rng, kind, task, seed)
        if made is not None:
            return made
    raise RuntimeError(f"no world found of kind {kind}, task {task}, seed {seed}")


def _plugged(rng: np.random.Generator, kind: str, task: str, seed: int) -> OddWorld | None:
    wall, door = int(rng.integers(*WALL_SIZES)), int(rng.integers(*DOOR_SIZES))
    depths, high = (int(rng.integers(*ROOM_SIZES)), int(rng.integers(*ROOM_SIZES))), int(rng.integers(*ROOM_SIZES))
    if 2 * door >= min(*depths, high) or (kind == "recessed" and wall < 3):
        return None
    at = int(rng.integers(1, high - door))
    west, east, neck = straight(depths, (high, high), wall, door, at)
    plan = two_rooms(west, east, [neck], 90.0 * int(rng.integers(4)))
    home = int(rng.integers(2))
    spans = _spans(rng, kind, wall)
    if task != "next" and any(last - first == door for first, last in spans):
        return None  # it would be a square, as x is
    plugs = [PlacedThing(f"p{n}", colour(rng), "polygon", _across(plan, wall, *s)) for n, s in enumerate(spans, 1)]
    taken = [*(plug.polygon for plug in plugs), *(neck.polygon.buffer(2.0) for neck in plan.necks)]
    return _scene(rng, kind, task, seed, plan, home, plugs, taken)


def _closed(rng: np.random.Generator, task: str, seed: int) -> OddWorld | None:
    size = (int(rng.integers(*CLOSED_SIZES)), int(rng.integers(*CLOSED_SIZES)))
    plan = one_room(box(0, 0, *size), 90.0 * int(rng.integers(4)))
    return _scene(rng, "closed", task, seed, plan, 0, [], [])


def _scene(
    rng: np.random.Generator,
    kind: str,
    task: str,
    seed: int,
    plan: House,
    home: int,
    plugs: list[PlacedThing],
    taken: list[Polygon],
) -> OddWorld | None:
    """Return a floor with what fills its door as a world with a task; None when no place is left for x or the robot."""
    things = list(plugs)
    if task != "next":
        polygon = place(rng, box(0, 0, 2, 2), plan.rooms[home], taken, True)
        if polygon is None:
            return None
        things = [PlacedThing("t1", colour(rng), "square", polygon), *plugs]
    utak = stand(rng, plan.rooms[home], [*taken, *(thing.polygon for thing in things)], True)
    if utak is None:
        return None
    scene = OddScene(plan, home, tuple(things), utak, tasks.heading(rng, True))
    possible = tasks.NO if kind == "closed" else tasks.YES
    return tasks.given(f"plug_{kind}", seed, task, kind, scene, possible, "there is one room" if not plugs else "")


def _spans(rng: np.random.Generator, kind: str, wall: int) -> list[tuple[float, float]]:
    """Return what the things fill of the way through the door: 0 at the first room's wall, `wall` at the second's."""
    if kind == "recessed":
        gaps = ((1, 0), (0, 1), (1, 1))[int(rng.integers(3 if wall > 3 else 2))]
        return [(float(gaps[0]), float(wall - gaps[1]))]
    if kind == "out":
        more = float(rng.integers(1, 4))
        return [(-more, float(wall))] if rng.random() < 0.5 else [(0.0, wall + more)]
    if kind == "half":
        more, middle = float(rng.integers(1, 4)), float(rng.integers(1, wall))
        spans = [(-more, middle), (middle, float(wall))][: 1 + int(rng.integers(2))]
        return spans if rng.random() < 0.5 else [(wall - last, wall - first) for first, last in spans]
    if kind == "two":
        middle = float(rng.integers(1, wall))
        return [(0.0, middle), (middle, float(wall))]
    return [(0.0, float(wall))]


def _across(plan: House, wall: int, low: float, high: float) -> Polygon:
    """Return the box that fills the door from one distance from the first room's wall to another."""
    neck: OddNeck = plan.necks[0]
    along, aside = np.subtract(neck.b0, neck.a0) / wall, np.subtract(neck.a1, neck.a0)
    return rounded(affine_transform(box(low, 0, high, 1), [along[0], aside[0], along[1], aside[1], *neck.a0]))


def main(arguments: Sequence[str] | None = None) -> None:
    """Write scenario folders and print their names."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.worlds.filled.doorplugs", description="Write scenarios with filled doorways."
    )
    parser.add_argument("--kind", default=",".join(PLUG_KINDS), help="kinds with commas between (all)")
    parser.add_argument("--task", default=",".join(PLUG_TASKS), help="tasks with commas between (all)")
    parser.add_argument("--seed", type=int, default=0, help="the first seed (%(default)s)")
    parser.add_argument("--count", type=int, default=1, help="how many of each kind and task (%(default)s)")
    parser.add_argument("-o", "--output", type=Path, default=Path("doorplugs"), help="folder (%(default)s)")
    given = parser.parse_args(arguments)
    for kind in given.kind.split(","):
        for task in given.task.split(","):
            for seed in range(given.seed, given.seed + given.count):
                made = plugged_world(kind, task, seed)
                print(write(made, given.output / f"{kind}-{task}-{seed:04d}"))


if __name__ == "__main__":
    main()
