"""Walls, doors and things off the grid: doors end between squares, walls have any thickness.

A convex thing passes a door if and only if its least width is at most the door's (G. Strang, The width of a chair,
1982), so for squares and bricks it is known whether they can be carried through.
"""

import numpy as np
from shapely import Polygon, box

from benchmarks.worlds.odd import tasks
from benchmarks.worlds.odd.houses import House, OddNeck, one_room, straight, two_rooms
from benchmarks.worlds.odd.lying import place, stand
from benchmarks.worlds.odd.tasks import OddScene, OddWorld
from benchmarks.worlds.placing import colour
from benchmarks.worlds.scenes import PlacedThing

OFFGRID_KIND = "off_grid"
OFFGRID_TASKS = (
    "carry_next",
    "next",
    "carry_corner",
    "carry_door",
    "corner",
    "carry_next",
    "at_x",
    "slit",
    "circle",
    "both",
)
OFFGRID_MARGINS = (
    -1.2,
    -0.6,
    -0.3,
    -0.1,
    0.05,
    0.1,
    0.3,
    0.6,
    0.9,
    1.4,
)  # squares by which a door is wider than the thing
SLIT_WIDTHS = (0.3, 1.9)  # squares: widths of doors that only a point passes


def real(rng: np.random.Generator, low: float, high: float) -> float:
    """Return a number of two decimals that is not whole."""
    value = round(float(rng.uniform(low, high)), 2)
    return value if value != round(value) else value + 0.37


def load(rng: np.random.Generator, whole: bool) -> tuple[str, Polygon, float]:
    """Return a square or a brick to carry: its class, its outline and its least width."""
    thin = float(rng.integers(2, 5)) if whole else real(rng, 1.8, 4.2)
    if rng.random() < 0.6:
        return "square", box(0, 0, thin, thin), thin
    return "brick", box(0, 0, thin, round(1.7 * thin + 1, 0 if whole else 2)), thin


def real_rooms(rng: np.random.Generator, door: float, wall: float | None = None) -> House:
    """Return two rooms with a door of a width, everything of real sizes; along x or along y."""
    depths, high = (real(rng, 12, 17), real(rng, 12, 17)), real(rng, max(13, 2 * door + 3), max(17, 2 * door + 5))
    thick = real(rng, 0.3, 3.2) if wall is None else wall
    at = real(rng, 2, high - door - 2)
    first, second, neck = straight(depths, (high, high), thick, door, at)
    margin = (real(rng, 1.1, 2.4), real(rng, 1.1, 2.4))
    return two_rooms(first, second, [neck], 90.0 * int(rng.integers(2)), margin)


def world(rng: np.random.Generator, seed: int) -> OddWorld | None:
    """Return the world of a seed; None when the things find no place by these random numbers."""
    task = OFFGRID_TASKS[seed % len(OFFGRID_TASKS)]
    variant = task
    shape, outline, least = load(rng, bool(rng.random() < 0.5))
    margin = OFFGRID_MARGINS[int(rng.integers(len(OFFGRID_MARGINS)))]
    if task in ("carry_next", "carry_door", "both"):
        door = round(least + margin, 2)
        possible = tasks.NO if margin < 0 else tasks.YES
        variant = f"door {margin:+.2f}"
    else:
        door, possible = real(rng, *(SLIT_WIDTHS if task == "slit" else (2.2, 5.5))), tasks.YES
    if task in ("corner", "carry_corner"):
        room = box(0, 0, real(rng, 14, 26), real(rng, 14, 26))
        plan = one_room(room, 0.0, (real(rng, 1.1, 2.4), real(rng, 1.1, 2.4)))
    else:
        plan = real_rooms(rng, door)
    task = "next" if task == "slit" else task
    return furnished(rng, OFFGRID_KIND, seed, task, variant, plan, shape, outline, possible)


def furnished(
    rng: np.random.Generator,
    kind: str,
    seed: int,
    task: str,
    variant: str,
    plan: House,
    shape: str,
    outline: Polygon,
    possible: str,
    angle: float = 0.0,
    quarter: bool = False,
    whole: bool = False,
) -> OddWorld | None:
    """Return a world in which x, unless the task needs none, and the robot are anywhere in a room of a floor."""
    home = int(rng.integers(len(plan.rooms)))
    room, things = plan.rooms[home], ()
    if task not in tasks.WITHOUT_THING:
        polygon = place(rng, outline, room, doorways(plan), whole, angle)
        if polygon is None:
            return None
        things = (PlacedThing("t1", colour(rng), shape, polygon),)
    utak = stand(rng, room, [thing.polygon for thing in things], whole or bool(rng.random() < 0.7))
    facing = tasks.heading(rng, quarter)
    compass = tasks.choose_corner(rng, plan, facing) if task in tasks.TO_CORNER else ""
    if utak is None or compass is None:
        return None
    scene = OddScene(plan, home, things, utak, facing)
    why = "the door is too narrow" if possible == tasks.NO else ""
    return tasks.given(kind, seed, task, variant, scene, possible, why, compass)


def doorways(plan: House) -> list[Polygon]:
    """Return the necks of a floor as shapes to keep clear of."""
    return [neck.polygon for neck in plan.necks]


def squeezed(neck: OddNeck, least: float) -> str:
    """Return whether a convex object of a least width passes a door, where that is beyond doubt."""
    if neck.gap < least - 1e-6:
        return tasks.NO
    return tasks.YES if neck.clear > least + 0.3 else tasks.NOT_KNOWN
