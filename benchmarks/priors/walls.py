"""Walls that the robot feels because nothing else is left, with what begins there in truth (planner/asp/deciding)."""

from collections.abc import Iterator
from itertools import chain, islice, product
from typing import NamedTuple

from benchmarks.calibration.dealt import PLUG_PREFIX, dealt
from benchmarks.calibration.runs import LookedAt
from benchmarks.claims.asked import Asked
from benchmarks.worlds.filled.doorplugs import PLUG_TASKS
from utak.planner.screen.projection import CostMaps
from utak.planner.sights.walls import DOORWAY_WIDTH, stretches_in_question, walls_in_question

WIDTHS = ("doorway", "square")
COUNTED_PLUGS = ("flush", "recessed", "out", "two", "closed")  # kinds with which the shipped counts were made


class WallSeen(NamedTuple):
    """A place of a wall where a thing may begin."""

    kind: str  # planner.sights.walls.WallKind
    width: str  # of WIDTHS
    begins: bool


def with_plugs(count: int, seed: int) -> Iterator[tuple[Asked, float]]:
    """Yield `count` worlds without noise: two of three with doorways that things fill, the others of all kinds."""
    kinds, tasks = (PLUG_PREFIX + kind for kind in COUNTED_PLUGS), range(1, len(PLUG_TASKS) + 1)
    filled = (Asked(kind, one, task) for one, kind, task in product(range(seed, seed + count), [*kinds], tasks))
    first = 2 * count // 3
    yield from chain(((asked, 0.0) for asked in islice(filled, first)), dealt(count - first, seed, [0.0]))


def walls_seen(look: LookedAt) -> Iterator[WallSeen]:
    """Yield the places of walls in question at a moment at which the robot decides where to feel; none at others."""
    if (
        not any(fact.startswith("halt(") for _, facts in look.decisions for fact in facts)
        or look.moment.alternatives is None
    ):
        return
    things = look.moment.alternatives.thing_squares()
    offered = [*stretches_in_question(walls_in_question(look.model, CostMaps(look.model).floor))]
    unfelt = {stretch[0] for _, stretch in offered if len(stretch) == 1} & things
    wide = {square for _, stretch in offered if len(stretch) > 1 and unfelt.issuperset(stretch) for square in stretch}
    for kind, stretch in offered:
        (row, column), own = stretch[0], unfelt - wide if len(stretch) == 1 else unfelt
        south, west = (row - 1, column), (row, column - 1)
        before = (south, west) if len(stretch) == 1 else (south,) if stretch[1][0] > row else (west,)
        begins = own.issuperset(stretch) and not unfelt.intersection(before)
        yield WallSeen(kind, WIDTHS[len(stretch) < DOORWAY_WIDTH], begins)
