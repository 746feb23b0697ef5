"""Worlds of all kinds, dealt in an order that a seed fixes, so that few worlds already are of many kinds."""

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np
from shapely import Polygon

from benchmarks.claims.asked import ASKED_KINDS, OWN_PREFIX, Asked, all_kinds, worlds_of
from benchmarks.worlds.filled.doorplugs import PLUG_TASKS, plugged_world
from benchmarks.worlds.makers import scenario
from benchmarks.worlds.odd.kinds import odd_world
from benchmarks.worlds.odd.openings import WIDE_OPENING_KIND

PLUG_PREFIX = "filled_"  # before the names of the kinds of benchmarks.worlds.filled.doorplugs; their tasks from 1 on
VARIANTS_WITH_DOORS = ("door",)  # of worlds with wide openings: others have none, or one that may be called so


class DealtWorld(NamedTuple):
    """A world with its doors, as far as the maker of the world says which they are."""

    asked: Asked
    world: Any  # RandomScenario or OddWorld: both have plan, things, utak, heading and texts
    doors: tuple[tuple[Polygon, float], ...] | None  # shape and width in squares, table frame; None: not said


def dealt(count: int, seed: int, noises: Sequence[float]) -> Iterator[tuple[Asked, float]]:
    """Yield `count` worlds, each with a noise.

    Each kind with each of its tasks comes once before any comes again, then with the next seed and the next noise.
    """
    kinds = worlds_of(all_kinds(), 0, 1)
    order = np.random.default_rng(seed).permutation(len(kinds))
    for number in range(count):
        again, place = divmod(number, len(kinds))
        kind = kinds[order[place]]
        yield Asked(kind.kind, seed + again, kind.task), noises[(place + again) % len(noises)]


def made(asked: Asked) -> DealtWorld:
    """Return the world of a kind, a seed and a task."""
    if asked.kind.startswith(OWN_PREFIX):
        own = scenario(asked.task, asked.seed, asked.kind.removeprefix(OWN_PREFIX))
        return DealtWorld(asked, own, tuple((door.polygon, float(door.width)) for door in own.plan.doors))
    if asked.kind.startswith(PLUG_PREFIX):
        kind, task = asked.kind.removeprefix(PLUG_PREFIX), PLUG_TASKS[asked.task - 1]
        return DealtWorld(asked, plugged_world(kind, task, asked.seed), None)
    odd = odd_world(asked.kind, asked.seed, ASKED_KINDS)
    if asked.kind == WIDE_OPENING_KIND and odd.variant not in VARIANTS_WITH_DOORS:
        return DealtWorld(asked, odd, None)
    return DealtWorld(asked, odd, tuple((neck.polygon, float(neck.gap)) for neck in odd.plan.necks))
