"""State of a held object after a motion: where it lies, and against what when it was blocked.

After slips an object lies a little beside its believed place. If it was blocked where there seemed to be room,
something known blocked it all the same. So it lies where it touches that, as near as possible to its believed place.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

from geometry.motion.first_contact import ContactBody, Obstacles
from geometry.motion.se2 import Motion, Translate
from kb.localisation.hypotheses.carry_outcomes import CarryOutcome
from kb.objects.held_object import HeldObject, slack_of

MIN_THWARTED_MOTIONS = 2  # motions without effect or reason from which the place of an object is inexact; tuned
MIN_MOVED_DISTANCE = 0.2  # squares: an object blocked before this did not move; tuned
MAX_LEANING_DISTANCE = 0.8  # squares from its believed place within which an object may touch what blocked it; tuned
LEANING_STEP = 0.1  # squares between the tried places
TOUCHING_DISTANCE = 0.02  # squares from an obstacle within which an object touches it; tuned


def object_after(load: HeldObject, outcome: CarryOutcome | None, residual: int, suspected: bool = False) -> HeldObject:
    """Return an object in hand after a motion.

    load : before the motion. outcome : the chosen one. residual : fields that it leaves unexplained. suspected :
    whether an open square is suspected to have blocked the motion.
    """
    load = replace(load, unexplained=max(load.unexplained, residual))
    if outcome is None or outcome.how == "stuck" or outcome.polygon.equals(load.polygon):
        thwarted = load.thwarted + (load.proven and not suspected)
        inexact = load.inexact or thwarted >= MIN_THWARTED_MOTIONS
        return replace(load.resisted(), thwarted=thwarted, inexact=inexact)
    if outcome.insets is not None:
        load = load.inset(outcome.insets) or load
    slack = load.slack if outcome.as_commanded else max(load.slack, slack_of(outcome.polygon))
    moved = load.moved(outcome.polygon, slack, outcome.degrees, outcome.as_commanded)
    moved = replace(moved, empty=moved.empty | outcome.contact_squares)
    unmoved = outcome.how == "blocked" and load.polygon.hausdorff_distance(outcome.polygon) < MIN_MOVED_DISTANCE
    return replace(moved, stuck=load.stuck + 1) if unmoved else moved


def lean_on_obstacle(
    load: HeldObject, motion: Motion, known: Obstacles, count_clashes: Callable[[HeldObject], int]
) -> HeldObject:
    """Return an object that a straight motion left blocked, at the nearest place where it touches a known obstacle.

    It stays where it is when it touches something there, or when every touching place contradicts more of what is seen.

    load : after the motion. motion : as commanded, map frame. known : the obstacles. count_clashes : returns how many
    fields contradict an object where it lies.
    """
    if not isinstance(motion, Translate):
        return load
    most = count_clashes(load)
    for far, there in sorted(_touching_places(load.polygon, motion, known), key=lambda place: place[0]):
        if far <= TOUCHING_DISTANCE:
            return load
        lying = load.lying(there, load.slack)
        if count_clashes(lying) <= most:
            return lying
    return load


def _touching_places(polygon: Any, motion: Translate, known: Obstacles) -> Iterator[tuple[float, Any]]:
    """Yield outlines that touch an obstacle on the motion or beside it, each with its distance in squares."""
    if not any(motion):
        return
    onward = motion.steered(2 * MAX_LEANING_DISTANCE, 0.0)
    number = round(MAX_LEANING_DISTANCE / LEANING_STEP)
    for step in range(-number, number + 1):
        aside = step * LEANING_STEP
        back = motion.steered(-MAX_LEANING_DISTANCE, aside).carry(polygon)
        fraction = known.first_contact(ContactBody(back), onward).fraction
        far = math.hypot(aside, (2 * fraction - 1) * MAX_LEANING_DISTANCE)
        if 0 < fraction < 1 and far <= MAX_LEANING_DISTANCE:
            yield far, onward.part(fraction).carry(back)
