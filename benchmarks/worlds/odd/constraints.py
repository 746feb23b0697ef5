"""Constraints and goals that contradict: doors that must not be used, two corners at once, things that do not exist."""

from typing import NamedTuple

import numpy as np
from shapely import Polygon, box

from benchmarks.worlds.furniture import ell
from benchmarks.worlds.odd import tasks
from benchmarks.worlds.odd.houses import House, OddNeck, one_room, straight, two_rooms
from benchmarks.worlds.odd.lying import place, stand
from benchmarks.worlds.odd.offgrid import doorways
from benchmarks.worlds.odd.tasks import OddScene, OddWorld
from benchmarks.worlds.placing import colour
from benchmarks.worlds.scenes import PlacedThing, TaskTexts, wkt

CONSTRAINT_KIND = "constraint"
X, DOOR_FACTS = "object(x).\nshape(x, square).\n", "door(d).\n"
NEXT, CARRIED = "in(utak, room(next)).\n", "in(x, room(next)).\n"
DOOR_MARGIN = 0.1  # squares beyond the middle of a door at which the robot went through it
NON_SQUARES: dict[str, Polygon] = {
    "brick": box(0, 0, 6, 2),
    "l_shape": ell(6, 6, 2),
}  # nothing that looks like a square


class ConstraintQuestion(NamedTuple):
    """A task: the number of doors (0: one room), whether x exists, its facts, the answer, and why it is impossible."""

    doors: int
    there: bool
    start: str
    goal: str
    possible: str
    why: str = ""


ONLY_DOOR = "the only door must not be used"
NO_SQUARE = "there is no square"
QUESTIONS = {
    "walk_one_door": ConstraintQuestion(1, False, DOOR_FACTS, NEXT + "not_through(utak, d).\n", tasks.NO, ONLY_DOOR),
    "walk_two_doors": ConstraintQuestion(2, False, DOOR_FACTS, NEXT + "not_through(utak, d).\n", tasks.NOT_KNOWN),
    "carry_one_door": ConstraintQuestion(
        1, True, X + DOOR_FACTS, CARRIED + "not_through(x, d).\n", tasks.NO, ONLY_DOOR
    ),
    "carry_two_doors": ConstraintQuestion(2, True, X + DOOR_FACTS, CARRIED + "not_through(x, d).\n", tasks.NOT_KNOWN),
    "walk_at_home": ConstraintQuestion(1, True, X + DOOR_FACTS, "at(utak, x).\nnot_through(utak, d).\n", tasks.YES),
    "carry_on_foot": ConstraintQuestion(1, True, X + DOOR_FACTS, CARRIED + "not_through(utak, d).\n", tasks.NOT_KNOWN),
    "walk_two_corners": ConstraintQuestion(
        0, False, "", "at(utak, corner(northeast)).\nat(utak, corner(southwest)).\n", tasks.NO, "two corners at once"
    ),
    "carry_two_corners": ConstraintQuestion(
        0, True, X, "at(x, corner(northeast)).\nat(x, corner(southwest)).\n", tasks.NO, "two corners at once"
    ),
    "two_places": ConstraintQuestion(
        1, False, "", NEXT + "at(utak, start).\n", tasks.NO, "the start is not in the next room"
    ),
    "walk_nothing": ConstraintQuestion(0, False, X, "at(utak, x).\n", tasks.NO, NO_SQUARE),
    "circle_nothing": ConstraintQuestion(0, False, X, "circled(utak, x).\nat(utak, start).\n", tasks.NO, NO_SQUARE),
    "carry_nothing": ConstraintQuestion(1, False, X, CARRIED, tasks.NO, NO_SQUARE),
    "corner_nothing": ConstraintQuestion(0, False, X, "at(x, corner(northeast)).\n", tasks.NO, NO_SQUARE),
}


def world(rng: np.random.Generator, seed: int) -> OddWorld | None:
    """Return the world of a seed; None when the things find no place by these random numbers."""
    variant = sorted(QUESTIONS)[seed % len(QUESTIONS)]
    question = QUESTIONS[variant]
    plan = _plan(rng, question.doors)
    home = int(rng.integers(len(plan.rooms)))
    taken, things = [neck.buffer(1.5) for neck in doorways(plan)], []
    if question.there:
        x = place(rng, box(0, 0, 3, 3), plan.rooms[home], taken, True)
        if x is None:
            return None
        things.append(PlacedThing("t1", colour(rng), "square", x))
    for number in range(1, int(rng.integers(0, 3)) + 1):
        shape = str(rng.choice(sorted(NON_SQUARES)))
        room = plan.rooms[int(rng.integers(len(plan.rooms)))]
        other = place(
            rng, NON_SQUARES[shape], room, [*taken, *(t.polygon for t in things)], True, 90.0 * int(rng.integers(4))
        )
        if other is not None:
            things.append(PlacedThing(f"d{number}", colour(rng), shape, other))
    blocked = [*(thing.polygon for thing in things), *([] if variant != "two_places" else taken)]
    utak = stand(rng, plan.rooms[home], blocked, True, 3.0 if variant == "two_places" else 1.5)
    if utak is None:
        return None
    facing = tasks.heading(rng, True)
    scene = OddScene(plan, home, tuple(things), utak, facing)
    expect = "fails.\n" if question.possible == tasks.NO else _expected(variant, scene)
    texts = TaskTexts(question.start, question.goal, expect, question.why)
    shut = question.doors == 1 and "not_through(utak, d)" in question.goal
    avoid = plan.beyond(home).buffer(-DOOR_MARGIN) if shut else tasks.EMPTY_REGION
    return OddWorld(
        CONSTRAINT_KIND, seed, variant, variant, plan, scene.things, utak, facing, texts, question.possible, avoid
    )


def _expected(variant: str, scene: OddScene) -> str:
    """Return what is true at the end of the tasks that can be done."""
    if variant == "walk_at_home":
        return f'inside(utak, "{wkt(tasks.beside([scene.things[0].polygon], scene.plan))}").\n'
    subject = "utak" if variant.startswith("walk") else "t1"
    return f'inside({subject}, "{wkt(scene.plan.beyond(scene.home))}").\n'


def _plan(rng: np.random.Generator, doors: int) -> House:
    """Return one room, or two rooms with one door or two."""
    sizes = [float(rng.integers(17, 22)) for _ in range(2)]
    if doors == 0:
        return one_room(box(0, 0, sizes[0], sizes[1] + 2))
    high, wide = float(rng.integers(20, 25)), float(rng.integers(5, 7))
    at = float(rng.integers(2, 4)) if doors == 2 else float(rng.integers(2, int(high - wide) - 1))
    first, second, neck = straight((sizes[0], sizes[1]), (high, high), 2.0, wide, at)
    far = sizes[0] + 2.0
    top = high - 2.0 - wide
    other = OddNeck((sizes[0], top), (sizes[0], high - 2.0), (far, top), (far, high - 2.0))
    return two_rooms(first, second, [neck, other][:doors], 90.0 * int(rng.integers(2)))
