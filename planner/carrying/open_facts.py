"""Open facts that would overturn the verdict that a goal cannot be attained.

`impossible` is claimed only of what holds under every completion of what is open. A wall that was only seen may be a
thing that can be moved; the floor may go on where nothing was seen; a thing that was never moved may be more than one
thing; an opening that fills no whole square looks like wall; a thing that others moved lies somewhere. While one of
these is open, the verdict is `possible_if`, and its reason names the fact.
"""

import math
from dataclasses import replace

import numpy as np

from utak.geometry.kernels.arrays import XY, Bools
from utak.geometry.raster.components import with_edge_neighbours
from utak.kb.world.model import WorldModel
from utak.planner.decision import Decision, TaskVerdict, nothing_to_do
from utak.planner.screen.moves import orientation_is_settled
from utak.planner.sights.things import things_in_question
from utak.planner.sights.walls import ALL_WALLS, FeelingScope, floor_apart, walls_in_question
from utak.planner.situation import Situation

NOTHING_LEFT = "nothing is left to look at"  # a fact that proofs name: all floor that can be reached was seen


def open_fact_against(decision: Decision, situation: Situation, scope: FeelingScope = ALL_WALLS) -> Decision:
    """Return the verdict `possible_if` with an open fact that would overturn a verdict; nothing when none is open."""
    near = decision.near or situation.model.place_on_view
    fact = decision.unless or nearest_open_fact(situation, near, scope)
    if not fact:
        return nothing_to_do("no fact is open that would overturn that")
    return replace(decision, why=f"{decision.why}; it may be possible if {fact}", verdict=TaskVerdict.POSSIBLE_IF)


def proof_if_not_found(model: WorldModel, immovable: bool = False) -> tuple[str, ...]:
    """Return what proves, when everything was looked at, that no object fits a parameter of the task."""
    # () for nothing.
    proved = model.view.sure and orientation_is_settled(model) if immovable else not model.shaken
    fact = "what fits did not move when it was pushed" if immovable else "nothing that was seen fits"
    return (fact, NOTHING_LEFT) if proved and not model.missing else ()


def nearest_open_fact(situation: Situation, near: XY, scope: FeelingScope = ALL_WALLS) -> str:
    """Return the open fact nearest to a place that may allow another plan, in words; "" when there is none."""
    model, reached = situation.model, situation.cost_maps.floor
    if model.missing:
        return f"{model.missing[0]}, which is no longer where it lay, lies where the robot has not looked since"
    walls = walls_in_question(model, reached, scope).values()
    wall = _nearest_square(np.any(list(walls), axis=0), near)
    if wall is not None:
        return f"the wall at {model.point_in_words(wall)}, which was never felt, is a thing that can be moved"
    unseen = _nearest_square(with_edge_neighbours(model.space & reached) & ~model.view.seen, near)
    if unseen is not None:
        return f"the floor goes on at {model.point_in_words(unseen)}, which was never seen"
    hidden = None if scope.parting else _nearest_square(floor_apart(model, reached), near)
    if hidden is not None:
        return f"a passage that fills no whole square leads to the floor at {model.point_in_words(hidden)}"
    several = things_in_question(situation.cost_maps, scope)
    if not several:
        return ""
    seen = "was not seen to move as one thing" if several[0].moved else "was never moved"
    return f"{several[0].name}, which {seen}, is more than one thing"


def possible_width(width: float, missing: float, sides: tuple[XY, XY], where: str) -> str:
    """Return the open fact that a passage is wide enough, in words; "" when it is too narrow in any case."""
    across = np.abs(np.subtract(*sides)) / max(math.dist(*sides), 1e-9)
    most = width + 2 * float(across.sum())
    if width + missing >= most:
        return ""
    return f"the passage at {where}, which is between {width:.2f} and {most:.2f} squares wide, is wide enough"


def _nearest_square(mask: Bools, near: XY) -> XY | None:
    """Return the middle (x, y) of the marked square nearest to a place, the first of several."""
    # None for an empty mask.
    rows, columns = np.nonzero(mask)
    if not len(rows):
        return None
    first = int(np.argmin((columns + 0.5 - near[0]) ** 2 + (rows + 0.5 - near[1]) ** 2))
    return columns[first] + 0.5, rows[first] + 0.5
