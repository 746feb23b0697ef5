"""What a motion left of what is believed of a thing in hand: where it lies, and against what when it was stopped.

Who slips believes a thing a little beside where it is. Stopped where there seemed to be room, something known
stands in its way all the same: so it lies where it touches that, as near as may be to where it was believed to lie.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

from geometry.motion.first_contact import ContactBody, Obstacles
from geometry.motion.se2 import Motion, Translate
from kb.localisation.hypotheses.carry_outcomes import Outcome
from kb.objects.held_object import HeldObject, slack_of

OFTEN = 2  # times that a thing did not move for no reason, before it rather lies elsewhere
NOWHERE = 0.2  # squares: what was stopped sooner than this did not move
FURTHEST = 0.8  # squares beside where it is believed to lie in which something stands that stopped it
STEP = 0.1  # squares between the places that are tried
TOUCHING = 0.02  # squares from what stopped it


def after(load: HeldObject, outcome: Outcome | None, misfits: int, suspected: bool = False) -> HeldObject:
    """A thing after a motion with it in hand.

    misfits : fields that the motion, as it is believed, leaves as noise. suspected : is there something that may have
    stopped it?
    """
    load = replace(load, unexplained=max(load.unexplained, misfits))
    if outcome is None or outcome.how == "stuck" or outcome.polygon.equals(load.polygon):
        thwarted = load.thwarted + (load.proven and not suspected)
        return replace(load.resisted(), thwarted=thwarted, inexact=load.inexact or thwarted >= OFTEN)
    if outcome.insets is not None:
        load = load.inset(outcome.insets) or load
    slack = load.slack if outcome.as_commanded else max(load.slack, slack_of(outcome.polygon))
    moved = load.moved(outcome.polygon, slack, outcome.degrees, outcome.as_commanded)
    moved = replace(moved, empty=moved.empty | outcome.against)
    nowhere = outcome.how == "blocked" and load.polygon.hausdorff_distance(outcome.polygon) < NOWHERE
    return replace(moved, stuck=load.stuck + 1) if nowhere else moved


def leaning(load: HeldObject, motion: Motion, walls: Obstacles, clashes: Callable[[HeldObject], int]) -> HeldObject:
    """A thing that was stopped on a straight motion, where it touches what is known to stand in its way.

    clashes : how much of what is seen contradicts where it lies. It stays where it is when that is so of every place
    near, or when it touches something already.
    """
    if not isinstance(motion, Translate):
        return load
    most = clashes(load)
    for far, there in sorted(_touching(load.polygon, motion, walls), key=lambda place: place[0]):
        if far <= TOUCHING:
            return load
        lying = load.lying(there, load.slack)
        if clashes(lying) <= most:
            return lying
    return load


def _touching(polygon: Any, motion: Translate, walls: Obstacles) -> Iterator[tuple[float, Any]]:
    """How far away, and where, a thing touches what stops it on a motion, for ways to either side of it."""
    if not any(motion):
        return
    onward = motion.steered(2 * FURTHEST, 0.0)
    for step in range(-round(FURTHEST / STEP), round(FURTHEST / STEP) + 1):
        aside = step * STEP
        back = motion.steered(-FURTHEST, aside).carry(polygon)
        part = walls.first_contact(ContactBody(back), onward).fraction
        far = math.hypot(aside, (2 * part - 1) * FURTHEST)
        if 0 < part < 1 and far <= FURTHEST:
            yield far, onward.part(part).carry(back)
