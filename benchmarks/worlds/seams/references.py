"""Goals that name two things, or a thing and a place: in both orders, with things that can be moved and fixed ones."""

import numpy as np
from shapely import box

from benchmarks.worlds.odd import tasks
from benchmarks.worlds.odd.houses import House, one_room, straight, two_rooms
from benchmarks.worlds.odd.lying import place, stand
from benchmarks.worlds.odd.offgrid import doorways
from benchmarks.worlds.odd.tasks import OddScene, OddWorld
from benchmarks.worlds.placing import colour
from benchmarks.worlds.scenes import PlacedThing, wkt

REFERENCE_KIND = "reference"
TWO_THINGS_FACTS = "object(x). shape(x, square).\nobject(y). shape(y, brick).\n"
NEAR_OTHER = 2  # squares between two things of which one is within a square of the squares under the other
REFERENCE_GOALS = {
    "beside_xy_fixed": "beside(x, y).\n",
    "beside_yx_fixed": "beside(y, x).\n",
    "beside_xy_corner": "beside(x, y).\nat(x, corner({compass})).\n",
    "beside_yx_corner": "beside(y, x).\nat(x, corner({compass})).\n",
    "beside_xy_room": "beside(x, y).\nin(y, room(next)).\n",
    "beside_yx_room": "beside(y, x).\nin(y, room(next)).\n",
    "utak_x_start": "at(utak, x).\nat(utak, start).\n",
    "utak_start_x": "at(utak, start).\nat(utak, x).\n",
    "utak_x_corner": "at(utak, x).\nat(utak, corner({compass})).\n",
    "utak_corner_x": "at(utak, corner({compass})).\nat(utak, x).\n",
}
NEAR_HOME = 5.5  # squares from the robot's start to a thing that it is at while it is at its start
NEAR_CORNER = 8  # squares from a corner to what is beside a thing in that corner


def world(rng: np.random.Generator, seed: int) -> OddWorld | None:
    """Return the world of a seed; None when the things find no place by these random numbers."""
    variant = list(REFERENCE_GOALS)[seed % len(REFERENCE_GOALS)]
    whole = bool(rng.random() < 0.6)
    plan = _plan(rng, variant.endswith("room"))
    home = int(rng.integers(len(plan.rooms)))
    room = plan.rooms[home]
    taken = [door.buffer(1.5) for door in doorways(plan)]
    x = place(rng, box(0, 0, 3, 3), room, taken, whole)
    if x is None:
        return None
    y = place(rng, box(0, 0, 4, 2), room, [*taken, x], whole, 90.0 * int(rng.integers(2)), 5.0)
    if y is None:
        return None
    far = 7.0 if variant.startswith("utak") else 2.0
    utak = stand(rng, room, [x.buffer(far - 2), y], True, 2.0)
    facing = tasks.heading(rng, True)
    compass = tasks.choose_corner(rng, plan, facing) if "corner" in variant else ""
    if utak is None or compass is None:
        return None
    things = (
        PlacedThing("t1", colour(rng), "square", x),
        PlacedThing("t2", colour(rng), "brick", y, variant.endswith("fixed")),
    )
    made = tasks.given(REFERENCE_KIND, seed, "at_x", variant, OddScene(plan, home, things, utak, facing))
    start = TWO_THINGS_FACTS if "beside" in variant else "object(x). shape(x, square).\n"
    return tasks.asked(
        made, start, REFERENCE_GOALS[variant].format(compass=compass), _expected(made, home, compass), tasks.YES
    )


def _expected(made: OddWorld, home: int, compass: str) -> str:
    plan, variant = made.plan, made.variant
    corner = plan.furthest_corner(compass, made.heading) if compass else None
    if variant.startswith("utak"):
        place = made.utak if corner is None else corner
        return f'near(utak, "{wkt(place)}", 2).\nnear(t1, "{wkt(place)}", "{NEAR_HOME}").\n'
    if corner is not None:
        return f'near(t1, "{wkt(corner)}", {tasks.THING_NEAR}).\nnear(t2, "{wkt(corner)}", {NEAR_CORNER}).\n'
    if variant.endswith("room"):
        beyond = plan.beyond(home)
        return f'inside(t2, "{wkt(beyond)}").\nnear(t1, "{wkt(beyond)}", 2).\n'
    return f'near(t1, "{wkt(made.things[1].polygon)}", "{NEAR_OTHER}").\n'


def _plan(rng: np.random.Generator, doors: bool) -> House:
    """Return one room, or two with a wide door, on whole squares."""
    depths = tuple(float(rng.integers(17, 22)) for _ in range(3))
    if not doors:
        return one_room(box(0, 0, depths[0] + 4, depths[1]))
    door = float(rng.integers(6, 9))
    first, second, neck = straight(
        (depths[0], depths[1]), (depths[2], depths[2]), 2.0, door, float(rng.integers(2, int(depths[2] - door) - 1))
    )
    return two_rooms(first, second, [neck], 90.0 * int(rng.integers(2)))
