"""Tasks of odd worlds: the facts of start.lp and goal.lp, and of expect.lp for what must be true at the end.

Regions of expect.lp are a little larger than the words of a goal say, never smaller: a robot that
misses them was wrong.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from shapely import Point, Polygon, box, union_all
from shapely.geometry.base import BaseGeometry

from benchmarks.worlds.odd.houses import COMPASS, House
from benchmarks.worlds.placing import digital
from benchmarks.worlds.scenes import PlacedThing, TaskTexts, wkt, world_text

EMPTY_REGION = Polygon()
YES, NO, NOT_KNOWN = "yes", "no", "unknown"
CORNER_DISTANCE = 1.5  # squares: one in each axis, at any angle of the axes
AT_THING = 1.05  # squares from the squares of a thing
THING_NEAR = 3  # squares from a corner to what is within one square of both its walls, however it is turned
ODD_GOALS = {
    "next": "in(utak, room(next)).\n",
    "corner": "at(utak, corner({compass})).\n",
    "at_x": "at(utak, x).\n",
    "circle": "circled(utak, x).\nat(utak, start).\n",
    "carry_next": "in(x, room(next)).\n",
    "carry_corner": "at(x, corner({compass})).\n",
    "carry_door": "through(x, d).\n",
    "both": "in(x, room(next)).\nat(utak, start).\n",
}
TO_OTHER_ROOM = ("next", "carry_next", "carry_door", "both")
TO_CORNER = ("corner", "carry_corner")
WITHOUT_THING = ("next", "corner")


@dataclass(frozen=True)
class OddWorld:
    """An odd world with a task.

    Attributes
    ----------
    possible : whether the task can be done, by construction: "yes", "no" or "unknown".
    why : why it cannot be done.
    variant : what the world is within its kind.
    avoid : where the robot must never be, by the goal's constraints.
    """

    kind: str
    seed: int
    task: str
    variant: str
    plan: House
    things: tuple[PlacedThing, ...]
    utak: Point
    heading: int
    texts: TaskTexts
    possible: str
    avoid: BaseGeometry = EMPTY_REGION

    @property
    def name(self) -> str:
        """The name of its folder."""
        return f"{self.kind}-{self.seed:04d}"

    @property
    def world(self) -> str:
        """The text of world.lp."""
        return world_text(self.plan, self.utak, self.heading, self.things)


@dataclass(frozen=True)
class OddScene:
    """The scene of a world: a floor, the room (0 or 1) where all begins, objects (the first is x), the robot."""

    plan: House
    home: int
    things: tuple[PlacedThing, ...]
    utak: Point
    heading: int


def given(
    kind: str,
    seed: int,
    task: str,
    variant: str,
    scene: OddScene,
    possible: str = YES,
    why: str = "",
    compass: str = "",
) -> OddWorld:
    """Return a scene as a world with one of the tasks; a corner task needs the compass corner."""
    start = "" if task in WITHOUT_THING else f"object(x).\nshape(x, {scene.things[0].shape}).\n"
    start += "door(d).\n" if task == "carry_door" else ""
    expect = "fails.\n" if possible == NO else _expected(task, scene, compass)
    texts = TaskTexts(start, ODD_GOALS[task].format(compass=compass), expect, why)
    return OddWorld(kind, seed, task, variant, scene.plan, scene.things, scene.utak, scene.heading, texts, possible)


def asked(world: OddWorld, start: str, goal: str, expect: str, possible: str, why: str = "") -> OddWorld:
    """Return a world with other texts; of an impossible task nothing is expected but that it fails."""
    return replace(
        world, texts=TaskTexts(start, goal, "fails.\n" if possible == NO else expect, why), possible=possible
    )


def choose_corner(rng: np.random.Generator, plan: House, heading: int) -> str | None:
    """Return a compass corner towards which one corner of the floor is the furthest beyond doubt; or None."""
    for compass in rng.permutation(sorted(COMPASS)):
        if plan.furthest_corner(str(compass), heading) is not None:
            return str(compass)
    return None


def heading(rng: np.random.Generator, quarter: bool) -> int:
    """Return a direction to face in degrees: a quarter turn, or half of the time any."""
    return int(rng.integers(4)) * 90 if quarter or rng.random() < 0.5 else int(rng.integers(360))


def beside(things: Sequence[Polygon], plan: House) -> BaseGeometry:
    """Return the region that is at one of some objects: within a square of the squares that it covers."""
    squares = []
    for thing in things:
        rows, columns = np.nonzero(digital(thing, plan.width, plan.height))
        squares += [box(i, j, i + 1, j + 1) for i, j in zip(columns.tolist(), rows.tolist(), strict=True)]
    return union_all(squares).buffer(AT_THING, quad_segs=4)


def _expected(task: str, scene: OddScene, compass: str) -> str:
    plan = scene.plan
    subject = "t1" if task.startswith("carry") or task == "both" else "utak"
    back = f'near(utak, "{wkt(scene.utak)}", 2).\n'
    if task in TO_OTHER_ROOM:
        return f'inside({subject}, "{wkt(plan.beyond(scene.home))}").\n' + (back if task == "both" else "")
    if task == "at_x":
        return f'inside(utak, "{wkt(beside([scene.things[0].polygon], plan))}").\n'
    if task == "circle":
        return "circles(utak, t1).\n" + back
    corner = plan.furthest_corner(compass, scene.heading)
    if corner is None:
        raise ValueError(f"no corner is the furthest to the {compass}")
    if task == "corner":
        return f'inside(utak, "{wkt(corner.buffer(CORNER_DISTANCE))}").\n'
    thing = scene.things[0].polygon
    reach = Point(thing.centroid).hausdorff_distance(thing) * 2 + CORNER_DISTANCE
    return f'near(t1, "{wkt(corner)}", {THING_NEAR}).\ninside(t1, "{wkt(corner.buffer(reach))}").\n'
