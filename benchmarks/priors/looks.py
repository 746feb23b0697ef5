"""Looks for a thing that nobody saw, at the moments at which one is chosen, with what they would show in truth."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from benchmarks.calibration.runs import LookedAt
from benchmarks.claims.asked import Asked
from utak.kb.task.alternatives import may_be
from utak.planner.deciding.search import looks_at_the_unseen
from utak.planner.screen.projection import CostMaps
from utak.planner.screen.unseen_gain import GAIN_REACH
from utak.planner.sights.frontiers import FOVEA_RANGE, gain_of, nearest_square
from utak.planner.sights.viewpoints import TO_TAKE
from utak.planner.subgoal_kind import SubgoalKind

THING_TASKS = (3, 5, 6, 9)  # of benchmarks.worlds.makers: they name a thing


class LookSeen(NamedTuple):
    """A look that was offered."""

    kind: str  # explore, settle or pass
    gain: int  # squares never seen that come into sight
    shows: bool


def with_things(count: int, seed: int) -> Iterator[tuple[Asked, float]]:
    """Yield `count` worlds without noise, of the tasks that name things in turn."""
    yield from (
        (Asked("own_wide", seed + number // len(THING_TASKS), THING_TASKS[number % len(THING_TASKS)]), 0.0)
        for number in range(count)
    )


def _chose_subgoal(look: LookedAt) -> bool:
    """Return whether the robot chose among subgoals at a moment."""
    return any(fact.startswith("aim(") for _, facts in look.decisions for fact in facts)


def looks_seen(look: LookedAt) -> Iterator[LookSeen]:
    """Yield the looks that were offered for a thing that is none of those that were seen."""
    truth, model = look.moment.alternatives, look.model
    sought = sorted(may_be(look.moment.facts)) if _chose_subgoal(look) else []
    if truth is None or not sought or (thing := truth.thing_meant(sought[0])) is None:
        return
    if truth.place(sought[0]) in {node.name for node in model.objects}:
        return
    view, squares = model.view, truth.truth.about(thing)
    never = squares - {look.frame.square(c + view.west, r + view.south) for r, c in np.argwhere(view.seen).tolist()}
    cost_maps = CostMaps(model)
    for kind, one in looks_at_the_unseen(cost_maps, TO_TAKE):
        row, column = divmod(int(nearest_square(cost_maps, one.squares)), view.seen.shape[1])
        x, y = look.frame.square(column + view.west, row + view.south)
        within, reach = (squares, FOVEA_RANGE) if kind == SubgoalKind.SETTLE else (never, GAIN_REACH)
        shows = any(max(abs(a - x), abs(b - y)) <= reach for a, b in within)
        yield LookSeen(kind, int(gain_of(cost_maps, one)), shows)
