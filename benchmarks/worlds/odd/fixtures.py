"""Isolated things that cannot be moved beside movable ones of the same shape, or with none that can be moved."""

import numpy as np
from shapely import Polygon, box

from benchmarks.worlds.furniture import ell
from benchmarks.worlds.odd import tasks
from benchmarks.worlds.odd.houses import one_room, straight, two_rooms
from benchmarks.worlds.odd.lying import place, stand
from benchmarks.worlds.odd.offgrid import doorways
from benchmarks.worlds.odd.tasks import OddScene, OddWorld
from benchmarks.worlds.placing import colour
from benchmarks.worlds.scenes import PlacedThing, wkt

FIXED_KIND = "fixed"
FIXED_VARIANTS = ("both", "both", "only_fixed", "two_fixed", "both")
FIXED_TASKS = ("carry_next", "carry_corner", "carry_corner", "at_x", "carry_door", "carry_next")
FIXTURE_SHAPES: dict[str, Polygon] = {"square": box(0, 0, 3, 3), "brick": box(0, 0, 5, 2), "l_shape": ell(5, 5, 2)}


def world(rng: np.random.Generator, seed: int) -> OddWorld | None:
    """Return the world of a seed; None when the things find no place by these random numbers."""
    variant, task = FIXED_VARIANTS[seed % len(FIXED_VARIANTS)], FIXED_TASKS[seed % len(FIXED_TASKS)]
    sizes = [float(rng.integers(18, 24)) for _ in range(3)]
    if task in tasks.TO_CORNER:
        plan = one_room(box(0, 0, sizes[0] + 2, sizes[1]))
    else:
        door = float(rng.integers(6, 8))
        at = float(rng.integers(3, int(sizes[2] - door) - 2))
        plan = two_rooms(*_with_neck(sizes, door, at), 90.0 * int(rng.integers(2)))
    home = int(rng.integers(len(plan.rooms)))
    shape = str(rng.choice(["square", "brick"] if task == "carry_corner" else sorted(FIXTURE_SHAPES)))
    stuck = {"both": 1, "only_fixed": 1, "two_fixed": 2}[variant]
    movable = 0 if variant == "only_fixed" else 1
    taken, things = [neck.buffer(1.5) for neck in doorways(plan)], []
    for number in range(movable + stuck):
        turn = 90.0 * int(rng.integers(4))
        polygon = place(
            rng, FIXTURE_SHAPES[shape], plan.rooms[home], [*taken, *(t.polygon for t in things)], True, turn
        )
        if polygon is None:
            return None
        fixed = number >= movable
        things.append(PlacedThing(f"{'f' if fixed else 't'}{number + 1}", colour(rng), shape, polygon, fixed))
    utak = stand(rng, plan.rooms[home], [thing.polygon for thing in things], True)
    facing = tasks.heading(rng, True)
    compass = tasks.choose_corner(rng, plan, facing) if task in tasks.TO_CORNER else ""
    if utak is None or compass is None:
        return None
    scene = OddScene(plan, home, tuple(things), utak, facing)
    stays = not movable and task != "at_x"
    why = "nothing of that shape can be moved" if stays else ""
    made = tasks.given(FIXED_KIND, seed, task, variant, scene, tasks.NO if stays else tasks.YES, why, compass)
    if task != "at_x":
        return made
    any_of = wkt(tasks.beside([thing.polygon for thing in things], plan))
    return tasks.asked(made, made.texts.start, made.texts.goal, f'inside(utak, "{any_of}").\n', tasks.YES)


def _with_neck(sizes: list[float], door: float, at: float) -> tuple:
    first, second, neck = straight((sizes[0], sizes[1]), (sizes[2], sizes[2]), 2.0, door, at)
    return first, second, [neck]
