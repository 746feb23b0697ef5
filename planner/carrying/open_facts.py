"""Open facts that would overturn the verdict that a goal cannot be attained.

`impossible` is claimed only of what holds under every completion of what is open. A wall that was only seen may be a
thing that can be moved; the floor may go on where nothing was seen; a thing that was never moved may be more than one
thing; an opening that fills no whole square looks like wall; a thing that others moved lies somewhere. While one of
these is open, the verdict is `possible_if`, and its reason names the fact.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from utak.geometry.kernels.arrays import XY, Bools, Square
from utak.geometry.raster.components import with_edge_neighbours
from utak.kb.task.stretches import MAX_THICK_WALL
from utak.kb.world.model import WorldModel
from utak.planner.decision import Decision, TaskVerdict, nothing_to_do
from utak.planner.screen.moves import orientation_is_settled
from utak.planner.sights.things import things_in_question
from utak.planner.sights.walls import (
    ALL_WALLS,
    EDGE_STEPS,
    MAX_NICHE_WIDTH,
    FeelingScope,
    floor_apart,
    walls_in_question,
)
from utak.planner.situation import Situation

NOTHING_LEFT = "nothing is left to look at"  # a fact that proofs name: all floor that can be reached was seen


@dataclass(frozen=True, eq=False)
class OpenFact:
    """Something that is not settled, and may allow another plan."""

    words: str  # a clause without full stop
    # (rows, columns) bool on the arrays of the view, the squares that may be free if it is so; None where that is not
    # known
    opens: Bools | None = None


PlanExists = Callable[[Bools], bool]  # whether a plan may exist if some squares, (rows, columns) bool, are free


def open_fact_against(
    decision: Decision, situation: Situation, scope: FeelingScope = ALL_WALLS, plan_exists: PlanExists = np.any
) -> Decision:
    """Return the verdict `possible_if` with the open facts that would overturn a verdict; nothing when none is open."""
    near = decision.near or situation.model.place_on_view
    facts = [OpenFact(decision.unless)] if decision.unless else list(open_facts(situation, near, scope))
    if not facts:
        return nothing_to_do("no fact is open that would overturn that")
    # Where no plan is known to exist even if all of them are so, that proves nothing: the nearest one is named.
    enough = least_that_allow(facts, plan_exists) or facts[:1]
    words = " and ".join(fact.words for fact in enough)
    return replace(decision, why=f"{decision.why}; it may be possible if {words}", verdict=TaskVerdict.POSSIBLE_IF)


def least_that_allow(facts: Sequence[OpenFact], plan_exists: PlanExists) -> list[OpenFact]:
    """Return some open facts with which a plan may exist, and not without any of them, the first ones if possible."""
    # [] where none exists with all of them. What more facts allow is no less, so halves find the last one needed.

    def allow(some: Sequence[OpenFact]) -> bool:
        """Return whether a plan may exist if some facts are so."""
        masks = [fact.opens for fact in some if fact.opens is not None]
        return len(masks) < len(some) or (bool(masks) and plan_exists(np.any(masks, axis=0)))

    needed: list[OpenFact] = []
    left = list(facts)
    if not allow(left):
        return []
    while not (needed and allow(needed)):
        first, last = 0, len(left)  # the first `last` of them are enough, the first `first` are not
        while last - first > 1:
            middle = (first + last) // 2
            first, last = (first, middle) if allow([*needed, *left[:middle]]) else (middle, last)
        needed.insert(0, left[last - 1])
        left = left[: last - 1]
    return needed


def proof_if_not_found(model: WorldModel, immovable: bool = False) -> tuple[str, ...]:
    """Return what proves, when everything was looked at, that no object fits a parameter of the task."""
    # () for nothing.
    proved = model.view.sure and orientation_is_settled(model) if immovable else not model.shaken
    fact = "what fits did not move when it was pushed" if immovable else "nothing that was seen fits"
    return (fact, NOTHING_LEFT) if proved and not model.missing else ()


def open_facts(situation: Situation, near: XY, scope: FeelingScope = ALL_WALLS) -> Iterator[OpenFact]:
    """Yield the open facts that may allow another plan: by their kind, and the nearest to a place first."""
    model, reached = situation.model, situation.cost_maps.floor
    for name in model.missing:
        yield OpenFact(f"{name}, which is no longer where it lay, lies where the robot has not looked since")
    walls = np.any(list(walls_in_question(model, reached, scope).values()), axis=0)
    for square, where in _by_distance(walls, near):
        opens = _filled(square, model.space)
        yield OpenFact(
            f"the wall at {model.point_in_words(where)}, which was never felt, is a thing that can be moved", opens
        )
    unseen = with_edge_neighbours(model.space & reached) & ~model.view.seen
    for _, where in _by_distance(unseen, near):
        yield OpenFact(f"the floor goes on at {model.point_in_words(where)}, which was never seen", ~model.view.seen)
    hidden = np.zeros_like(walls) if scope.parting else floor_apart(model, reached)
    for _, where in _by_distance(hidden, near):
        passage = f"a passage that fills no whole square leads to the floor at {model.point_in_words(where)}"
        yield OpenFact(passage, ~model.space)
    for node in things_in_question(situation.cost_maps, scope):
        seen = "was not seen to move as one thing" if node.moved else "was never moved"
        yield OpenFact(f"{node.name}, which {seen}, is more than one thing")


def possible_width(width: float, missing: float, sides: tuple[XY, XY], where: str) -> str:
    """Return the open fact that a passage is wide enough, in words; "" when it is too narrow in any case."""
    across = np.abs(np.subtract(*sides)) / max(math.dist(*sides), 1e-9)
    most = width + 2 * float(across.sum())
    if width + missing >= most:
        return ""
    return f"the passage at {where}, which is between {width:.2f} and {most:.2f} squares wide, is wide enough"


def _by_distance(mask: Bools, near: XY) -> Iterator[tuple[Square, XY]]:
    """Yield the marked squares (column, row) with their middles (x, y), the nearest to a place first."""
    rows, columns = np.nonzero(mask)
    far = (columns + 0.5 - near[0]) ** 2 + (rows + 0.5 - near[1]) ** 2
    for n in np.argsort(far, kind="stable").tolist():
        column, row = int(columns[n]), int(rows[n])
        yield (column, row), (column + 0.5, row + 0.5)


def _filled(square: Square, space: Bools) -> Bools:
    """Return the squares that are no floor on which a thing may stand that fills a doorway at one (column, row)."""
    (column, row), mask, wide = square, np.zeros_like(space), MAX_NICHE_WIDTH // 2
    floor = np.pad(space, 1)
    for east, north in EDGE_STEPS:  # into the wall, from floor before it
        if floor[row + 1 - north, column + 1 - east]:
            (west, far_east), (south, far_north) = (
                sorted((0, MAX_THICK_WALL * step)) if step else (-wide, wide) for step in (east, north)
            )
            mask[max(row + south, 0) : row + far_north + 1, max(column + west, 0) : column + far_east + 1] = True
    return mask & ~space
