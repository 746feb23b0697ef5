"""State of a held object after a motion: where it lies, and against what when it was blocked.

After slips an object lies a little beside its believed place. If it was blocked where there seemed to be room,
something known blocked it all the same. So it lies where it touches that, as near as possible to its believed place.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from utak.geometry.motion.first_contact import ContactBody, Obstacles
from utak.geometry.motion.se2 import Motion, Rotate, Translate
from utak.kb.body import Push, Turn
from utak.kb.localisation.hypotheses.carry_outcomes import CarryOutcome
from utak.kb.localisation.hypotheses.contacts import Obstructions
from utak.kb.localisation.hypotheses.explanation import Explanation
from utak.kb.localisation.hypotheses.frames import FieldRanges, Hypothesis, grid_cell_size
from utak.kb.localisation.hypotheses.remap import RemapCache
from utak.kb.localisation.known.situation import ObservedSituation, count_clashes
from utak.kb.localisation.known.state import TrackerState
from utak.kb.objects.held_object import COMMAND_ROUNDING, HeldObject, Square, outline_tolerance
from utak.kb.objects.movability import way_of

MIN_THWARTED_MOTIONS = 2  # motions without effect or reason from which the place of an object is inexact; tuned
MIN_MOVED_DISTANCE = 0.2  # squares: an object blocked before this did not move; tuned
MAX_LEANING_DISTANCE = 0.8  # squares from its believed place within which an object may touch what blocked it; tuned
LEANING_STEP = 0.1  # squares between the tried places
TOUCHING_DISTANCE = 0.02  # squares from an obstacle within which an object touches it; tuned


def object_after(
    held: HeldObject, outcome: CarryOutcome | None, residual: int, way: str, suspected: bool = False
) -> HeldObject:
    """Return an object in hand after a motion some way: with its new outline (shapely Polygon, squares, map frame)."""
    held = replace(held, unexplained=max(held.unexplained, residual))
    if outcome is None or outcome.how == "stuck" or outcome.polygon.equals(held.polygon):
        thwarted = held.thwarted + (held.proven and not suspected)
        inexact = held.inexact or thwarted >= MIN_THWARTED_MOTIONS
        return replace(held, resisted=(*held.resisted, way), thwarted=thwarted, inexact=inexact)
    if outcome.insets is not None:
        held = held.inset(outcome.insets) or held
    slack = held.slack if outcome.as_commanded else max(held.slack, outline_tolerance(outcome.polygon))
    moved = held.moved(outcome.polygon, slack, outcome.degrees, outcome.as_commanded)
    whole = held.whole or not (residual or outcome.stopped)
    moved = replace(moved, empty=moved.empty | outcome.contact_squares, whole=whole)
    unmoved = outcome.how == "blocked" and held.polygon.hausdorff_distance(outcome.polygon) < MIN_MOVED_DISTANCE
    return replace(moved, resisted=(*held.resisted, way)) if unmoved else moved


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


def moved_object(situation: ObservedSituation, chosen: Explanation, suspected: frozenset[Square]) -> HeldObject:
    """Return the object in hand after the chosen outcome of a motion: its outline, map frame, and what else changed."""
    state, held, place = situation.state, situation.held, chosen.place
    inexact = replace(held, inexact=held.inexact or state.slipped)
    assert isinstance(situation.command, Push | Turn)
    way = way_of(situation.command)
    carried = object_after(inexact, chosen.outcome, chosen.unexplained, way, bool(suspected))
    if carried.inexact and carried.proven and not suspected and chosen.outcome and chosen.outcome.stopped:
        known = Obstructions(state.occupancy, place, carried.polygon, situation.motion).known

        def clashes(lying: HeldObject) -> int:
            return count_clashes(state.frame, state.occupancy, [*state.others(held), lying], place, situation.ranges)

        carried = lean_on_obstacle(carried, situation.motion, known, clashes)
    return carried


def agreeing_origins(state: TrackerState, ranges: FieldRanges) -> tuple[Hypothesis, ...]:
    """Return the frame hypotheses left by an observation of objects that were turned, in their order."""
    # Where several exact origins (hypotheses that name one point) of the believed orientation are left, those are
    # returned that agree with the observation, or all of them when none does; otherwise all hypotheses, unchanged.
    within = _exact_origins(state)
    if len(within) <= 1:
        return state.frames
    own, error = state.frame.place_to_utak(*state.place), math.hypot(*grid_cell_size(within)) / 2
    agree, maps = [], RemapCache(state.frame, state.occupancy, state.observations, state.held_objects)
    for hypothesis in within:
        other = hypothesis.frame
        under = maps.remapped(other)
        lying = [held.woken(error) for held in under.held_objects.values()]
        clashes = count_clashes(other, under.occupancy, lying, other.place_from_utak(*own), ranges)
        if not under.residual and not clashes:
            agree.append(hypothesis)
    return tuple(agree) or within


def objects_astray(state: TrackerState) -> dict[str, HeldObject]:
    """Return all held objects, by name, with `astray` set: how far each may lie from its believed place, in squares."""
    # Every turn was about the true place of Utak, so an origin that is open leaves the place of a turned object open.
    origins = [hypothesis.frame.origin for hypothesis in _exact_origins(state)]
    away = np.array(origins).reshape(-1, 2) - np.array(state.frame.origin)
    held_objects = {}
    for name, held in state.held_objects.items():
        far = np.hypot(*(away - Rotate(held.turned, (0.0, 0.0)).points(away)).T)
        least = COMMAND_ROUNDING if state.beside_line and held.turned % 360 else 0.0
        least = max(least, turned_astray(state, held.turned))
        held_objects[name] = replace(held, astray=float(far.max(initial=least)))
    return held_objects


def turned_astray(state: TrackerState, degrees: float) -> float:
    """Return how far a turn leads an object astray, in squares, whose centre is known as well as the robot's place."""
    return 2 * state.place_doubt * abs(math.sin(math.radians(degrees / 2)))


def _exact_origins(state: TrackerState) -> tuple[Hypothesis, ...]:
    """Return the hypotheses of the believed orientation that name an exact origin, in their order; empty for none."""
    return tuple(h for h in state.frames if h.angle == state.frame.angle and h.is_point)
