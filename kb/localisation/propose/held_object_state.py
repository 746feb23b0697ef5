"""State of a held object after a motion: where it lies, and against what when it was blocked.

After slips an object lies a little beside its believed place. If it was blocked where there seemed to be room,
something known blocked it all the same. So it lies where it touches that, as near as possible to its believed place.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

from utak.geometry.motion.first_contact import ContactBody, Obstacles
from utak.geometry.motion.se2 import Motion, Translate
from utak.kb.localisation.hypotheses.carry_outcomes import CarryOutcome
from utak.kb.objects.held_object import HeldObject, outline_tolerance

MIN_THWARTED_MOTIONS = 2  # motions without effect or reason from which the place of an object is inexact; tuned
MIN_MOVED_DISTANCE = 0.2  # squares: an object blocked before this did not move; tuned
MAX_LEANING_DISTANCE = 0.8  # squares from its believed place within which an object may touch what blocked it; tuned
LEANING_STEP = 0.1  # squares between the tried places
TOUCHING_DISTANCE = 0.02  # squares from an obstacle within which an object touches it; tuned


def object_after(held: HeldObject, outcome: CarryOutcome | None, residual: int, suspected: bool = False) -> HeldObject:
    """Return an object in hand after a motion: with its new outline (shapely Polygon, in squares, map frame)."""
    held = replace(held, unexplained=max(held.unexplained, residual))
    if outcome is None or outcome.how == "stuck" or outcome.polygon.equals(held.polygon):
        thwarted = held.thwarted + (held.proven and not suspected)
        inexact = held.inexact or thwarted >= MIN_THWARTED_MOTIONS
        return replace(held.resisted(), thwarted=thwarted, inexact=inexact)
    if outcome.insets is not None:
        held = held.inset(outcome.insets) or held
    slack = held.slack if outcome.as_commanded else max(held.slack, outline_tolerance(outcome.polygon))
    moved = held.moved(outcome.polygon, slack, outcome.degrees, outcome.as_commanded)
    whole = held.whole or not (residual or outcome.stopped)
    moved = replace(moved, empty=moved.empty | outcome.contact_squares, whole=whole)
    unmoved = outcome.how == "blocked" and held.polygon.hausdorff_distance(outcome.polygon) < MIN_MOVED_DISTANCE
    return replace(moved, stuck=held.stuck + 1) if unmoved else moved


def lean_on_obstacle(
    held: HeldObject, motion: Motion, known: Obstacles, count_clashes: Callable[[HeldObject], int]
) -> HeldObject:
    """Return an object that a straight motion left blocked, at the nearest place where it touches a known obstacle."""
    if not isinstance(motion, Translate):
        return held
    most = count_clashes(held)
    for far, there in sorted(_touching_places(held.polygon, motion, known), key=lambda place: place[0]):
        if far <= TOUCHING_DISTANCE:
            return held
        lying = held.lying(there, held.slack)
        if count_clashes(lying) <= most:
            return lying
    return held


def _touching_places(polygon: Any, motion: Translate, known: Obstacles) -> Iterator[tuple[float, Any]]:
    """Yield outlines that touch an obstacle on or beside the motion, each with its distance from the believed one."""
    if not any(motion):
        return
    onward = motion.steered(2 * MAX_LEANING_DISTANCE, 0.0)
    number = round(MAX_LEANING_DISTANCE / LEANING_STEP)
    for step in range(-number, number + 1):
        aside = step * LEANING_STEP
        back = motion.steered(-MAX_LEANING_DISTANCE, aside).carry(polygon)
        fraction = known.first_contact(ContactBody(back), onward)
        far = math.hypot(aside, (2 * fraction - 1) * MAX_LEANING_DISTANCE)
        if 0 < fraction < 1 and far <= MAX_LEANING_DISTANCE:
            yield far, onward.part(fraction).carry(back)
