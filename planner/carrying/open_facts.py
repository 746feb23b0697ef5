"""Facts that are open and would overturn that a goal cannot be attained.

`impossible` is claimed only of what holds under every completion of what is open. A wall that was only seen may be a
thing that can be moved; floor may go on where nothing was seen; what was never moved may be more than one thing. While
one of these is so, the verdict is `possible_if`, and its reason names the fact.
"""

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from geometry.raster.components import edged
from kb.perception.protrusions import VERGE
from kb.world.model import WorldModel
from planner.decision import Decision
from planner.goals.placement import LIKELY
from planner.screen.moves import is_settled

Mask = NDArray[np.bool_]
Place = tuple[float, float]


def qualified(decision: Decision, model: WorldModel) -> Decision:
    """Return a decision, with `possible_if` in place of `impossible` where an open fact would overturn that."""
    if decision.verdict != "impossible" or decision.unless is None:
        return decision
    fact = decision.unless or open_fact(model, decision.near or model.place_on_view)
    if not fact:
        return decision
    return replace(decision, why=f"{decision.why}; it may be possible if {fact}", verdict="possible_if")


def verdict_if_missing(model: WorldModel, fixed: bool = False) -> str:
    """Return the verdict when all was looked at and nothing is what the task speaks of; `limit` proves nothing.

    Where looks contradicted each other it may have been seen and lost. fixed : something is just that, and did not
    move; while it is open how the squares lie the robot may have pushed at another thing.
    """
    proved = model.view.sure and is_settled(model) if fixed else not model.shaken
    return "impossible" if proved else "limit"


def open_fact(model: WorldModel, near: Place) -> str:
    """Return the open fact nearest to a place that may open another way, in words; "" when there is none.

    near : (x, y) in the frame of the view's arrays.
    """
    wall = _nearest(unfelt_walls(model), near)
    if wall is not None:
        return f"the wall at {model.point_in_words(wall)}, which was never felt, is a thing that can be moved"
    unseen = _nearest(edged(model.space) & ~model.view.seen, near)
    if unseen is not None:
        return f"the floor goes on at {model.point_in_words(unseen)}, which was never seen"
    whole = [node for node in model.objects if not node.moved and node.confidence >= LIKELY]
    return f"{whole[0].name}, which was never moved, is more than one thing" if whole else ""


def unfelt_walls(model: WorldModel) -> Mask:
    """Return the squares beside known floor on which a wall was seen and never felt: (rows, columns)."""
    felt = model.squares(square for square, colour in model.felt.items() if colour == VERGE)
    things: Mask = np.zeros_like(felt)
    for node in model.objects:
        things |= model.mask(node.patch)
    mask: Mask = edged(model.space) & model.view.seen & ~model.space & ~felt & ~things
    return mask


def width_open(width: float, missing: float, sides: tuple[Place, Place], where: str) -> str:
    """Return how wide a passage may be as far as its squares tell, in words; "" when it is too narrow all the same.

    A wall lies anywhere in the squares in which it was seen, so each side may stand back by up to a square along each
    axis. width, missing : squares. sides : (x, y) of the two walls. where : the passage's place, in words.
    """
    across = np.abs(np.subtract(*sides)) / max(math.dist(*sides), 1e-9)
    most = width + 2 * float(across.sum())
    if width + missing >= most:
        return ""
    return f"the passage at {where}, which is between {width:.2f} and {most:.2f} squares wide, is wide enough"


def _nearest(mask: Mask, near: Place) -> Place | None:
    """Return the middle of the square of a mask that is nearest to a place, the first of several; None for none."""
    rows, columns = np.nonzero(mask)
    if not len(rows):
        return None
    first = int(np.argmin((columns + 0.5 - near[0]) ** 2 + (rows + 0.5 - near[1]) ** 2))
    return columns[first] + 0.5, rows[first] + 0.5
