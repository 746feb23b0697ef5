"""Explanations of an observation after a push or a turn with an object in hand, and the object's state after it."""

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import numpy as np

from geometry.motion.se2 import Motion, Rotate
from kb.localisation.hypotheses.carry_outcomes import CarryOutcome, other_outcomes, predicted_outcome
from kb.localisation.hypotheses.contacts import (
    NO_SQUARES,
    ContactHypothesis,
    Obstructions,
    contact_outcomes,
    suspected_squares,
)
from kb.localisation.hypotheses.explanation import Explanation
from kb.localisation.hypotheses.frames import FieldRanges, FrameHypothesis, Position
from kb.localisation.hypotheses.what_if import Surprise, agreeing_hypotheses, count_clashes
from kb.localisation.propose.blocked import has_whole_way, possible_ends
from kb.localisation.propose.contradicted_motion import overlooked_contact
from kb.localisation.propose.held_object_state import lean_on_obstacle, object_after
from kb.localisation.propose.larger_object import larger_objects
from kb.localisation.propose.parted_object import parted_objects
from kb.localisation.score import (
    Judgement,
    SearchBudget,
    choose,
    consistent_ends,
    is_simple,
    propose_blocked_push_and_origin,
    propose_earlier_motions,
    propose_frame,
    residual_at,
)
from kb.localisation.state import TrackerState
from kb.mapping.patch import patch_of_polygon
from kb.objects.held_object import COMMAND_ROUNDING, HeldObject, Square

MAX_CLEAR_CHANCE = 0.25  # probability of a contact up to which a motion counts as clear of obstacles; tuned


def explain_carry(state: TrackerState, surprise: Surprise, held: HeldObject, motion: Motion) -> Judgement:
    """Return the explanation chosen for the observation after a push or a turn.

    Parameters
    ----------
    state : what was believed before the observation; it is not changed.
    surprise : the observation, with what it is judged by.
    held : the object in hand, before the motion, map frame.
    motion : as commanded, map frame.

    Returns
    -------
    Judgement
        `explanation` is the choice: its kind, Utak's place (x, y) in squares, map frame of its frame, the outcome for
        the object, and the number of fields left unexplained (its residual). `blocked` is where a push may have ended,
        `searches` the number of slow searches spent so far. Where nothing explains the observation without residual,
        the cheapest explanation is chosen all the same.
    """
    whole = _outcome(state, surprise, predicted_outcome(state.place, held.polygon, motion))
    blocked = _blocked_push(state, surprise, held, motion)
    budget = SearchBudget(state.search_count)
    if has_whole_way(blocked):
        return Judgement(choose(state, list(blocked)), budget.spent, blocked)
    if not whole.unexplained and not blocked:
        contact = overlooked_contact(surprise, held, motion)
        if contact is None:
            return Judgement(whole, budget.spent)
        doubtful = whole._replace(contradicted=True)
        return Judgement(choose(state, [doubtful, _outcome(state, surprise, contact)]), budget.spent)
    if not whole.unexplained:
        whole = whole._replace(contradicted=True)
    contacts = surprise.obstructions.contacts(state.place, held.polygon, motion)
    explanations = [whole, *_outcomes(state, surprise, held, motion, whole, blocked, contacts)]
    simple = any(not one.unexplained for one in explanations[1:] if one.how != "slipped" or state.slipped)
    explanations += propose_frame(state, surprise, whole.unexplained, budget, simple)
    explanations += propose_earlier_motions(state, surprise, explanations, budget)
    if not any(is_simple(state, one) for one in explanations):
        explanations += propose_blocked_push_and_origin(surprise, budget)
    chosen = choose(state, explanations, _facts(state, surprise, held, contacts))
    return Judgement(chosen, budget.spent, blocked)


def _outcomes(
    state: TrackerState,
    surprise: Surprise,
    held: HeldObject,
    motion: Motion,
    whole: Explanation,
    blocked: Iterable[Explanation],
    contacts: Iterable[ContactHypothesis],
) -> list[Explanation]:
    """Return what else may have come of the motion in the believed frame: blocked, stuck, slipped, smaller, and so on.

    Each has its kind (`how`), Utak's place (x, y) and the object's outline, map frame, in squares, and the number of
    fields left unexplained. Blocked by a contact comes first, then stuck, blocked anywhere on the way (the furthest
    first), slipped (the nearest first), smaller, larger and parted.

    Parameters
    ----------
    state : what was believed before the observation.
    surprise : the observation.
    held : the object before the motion, map frame.
    motion : as commanded, map frame.
    whole : the explanation that the motion went as commanded.
    blocked : where a push may have ended, by the observation; if there are none, contacts without residual are taken.
    contacts : all contacts that may have blocked the motion, each a fraction (0 to 1) of the motion and its chance.
    """
    ends = contact_outcomes(contacts, state.place, held.polygon, motion)
    outcomes = [*blocked] or [one for one in (_outcome(state, surprise, end) for end in ends) if not one.residual]
    outcomes += [_outcome(state, surprise, other) for other in other_outcomes(state.place, held.polygon, motion)]
    outcomes += [*_smaller(state, surprise.ranges, held, whole), *larger_objects(surprise, held, motion)]
    outcomes += parted_objects(surprise, held, motion)
    return outcomes


def _facts(
    state: TrackerState, surprise: Surprise, held: HeldObject, contacts: Iterable[ContactHypothesis]
) -> list[str]:
    """Return the facts about the motion on which the choice depends, for kb/asp/accommodation.lp.

    They are predicates without arguments and without a full stop: unchanged (the observation equals the one before),
    clear (the motion hardly met anything), uneven (the object is known not to fill its squares). Those that do not hold
    are left out; [] when none holds.

    Parameters
    ----------
    state : what was believed; its newest observation is compared with the new one.
    surprise : the new observation.
    held : the object in hand, before the motion.
    contacts : the contacts that the motion may have met, each with its probability.
    """
    facts = {
        "unchanged": np.array_equal(surprise.ranges, state.observations[-1].ranges),
        "clear": sum(contact.chance for contact in contacts) <= MAX_CLEAR_CHANCE,
        "uneven": held.insets is not None and any(held.insets.believed),
    }
    return [fact for fact, holds in facts.items() if holds]


def _blocked_push(state: TrackerState, surprise: Surprise, held: HeldObject, motion: Motion) -> tuple[Explanation, ...]:
    """Return where a push may have ended, its whole way included, as far as the observation agrees.

    One explanation for each end, the whole way first (kind predicted), then contacts (kind blocked), the likeliest
    first. Each has Utak's place (x, y) in squares, map frame, the object's outline there, and its chance (0 to 1)
    before the observation. Empty for a turn, when the push can hardly have met anything, or when the observation agrees
    with none.

    Parameters
    ----------
    state : what was believed before the observation.
    surprise : the observation after the push.
    held : the object before the push, map frame.
    motion : as commanded, map frame.
    """
    ended = []
    for end in possible_ends(surprise, held, motion):
        assert end.outcome is not None
        ended.append((end, _outcome(state, surprise, end.outcome)))
    return consistent_ends(surprise, ended)


def _smaller(state: TrackerState, ranges: FieldRanges, held: HeldObject, whole: Explanation) -> list[Explanation]:
    """Return the explanation that the object does not fill its squares, in a list; [] when that explains nothing.

    It is of kind smaller, without residual (no field contradicts it), at the place of `whole`; its outcome has the
    smaller outline (shapely Polygon, map frame) and the narrowed sub-cell extent (how far each side lies within the
    squares in which the object was seen).

    Parameters
    ----------
    state : what was believed before the observation.
    ranges : (160, 2) int16, least and greatest count of occupied squares under each field.
    held : the object before the motion, map frame.
    whole : the explanation that the motion went as commanded; it has an outcome.
    """
    outcome = whole.outcome
    assert outcome is not None
    lying = held.moved(outcome.polygon, held.slack, outcome.degrees, commanded=True)
    less = refined_extent(state, lying, ranges, outcome.place)
    if less is None:
        return []
    smaller = outcome._replace(how="smaller", polygon=less.polygon, insets=less.insets)
    return [whole._replace(how="smaller", residual=0, contradicted=False, outcome=smaller)]


def _outcome(state: TrackerState, surprise: Surprise, outcome: CarryOutcome) -> Explanation:
    """Return the explanation that the motion of the object in hand had an outcome, in the believed frame.

    It is of the kind and at the place (x, y in squares, map frame) of the outcome. Its residual is the number of fields
    that contradict that outcome, 0 when none does.

    Parameters
    ----------
    state : what was believed before the observation.
    surprise : the observation, whose counts are compared.
    outcome : where Utak and the object ended, map frame.
    """
    residual = residual_at(state, surprise.ranges, outcome.place, surprise.objects_after(outcome))
    return Explanation(outcome.how, outcome.place, state.frame, residual, outcome.distance, outcome)


def refined_extent(state: TrackerState, held: HeldObject, ranges: FieldRanges, place: Position) -> HeldObject | None:
    """Return an object with the sub-cell extent that an observation at `place` shows; None when none agrees with it.

    The sub-cell extent is how far, by less than a square, each side lies within the squares in which the object was
    seen. The result is `held` with narrower `insets` (the possible distances of each side from the outer line of those
    squares, inwards, in squares) and with its outline `polygon` (shapely Polygon, map frame) drawn accordingly; all
    else is as in `held`, which is not changed. Squares that the object may leave free are taken for floor, not for
    something that happens to fill them.

    Parameters
    ----------
    state : what is believed; its map and the other held objects are used.
    held : the object where it lies at the time of the observation, map frame.
    ranges : (160, 2) int16, least and greatest count of occupied squares under each field.
    place : where the observation was made, (x, y) in squares, map frame.

    Returns
    -------
    HeldObject or None
        None as well when its sides are not parallel to the grid, or its place is known only roughly.
    """
    frame, others, nothing = state.frame, state.others(held), NO_SQUARES
    floor = state.occupancy.supposing(patch_of_polygon(held.polygon).squares())

    def agrees(outline: Any) -> bool:
        lying = replace(held, polygon=outline, slack=0.0, full=nothing, empty=nothing)
        return not count_clashes(frame, floor, [*others, lying], place, ranges)

    return held.told(agrees)


def contact_suspects(state: TrackerState, held: HeldObject, chosen: Explanation, motion: Motion) -> frozenset[Square]:
    """Return the open squares one of which probably stopped an object, (column, row) of the map frame.

    Those that the chosen outcome names, if it does. Else empty when nothing was stopped, when what stopped it is known,
    or when the object was never seen to move.

    Parameters
    ----------
    state : what is believed, with the chosen frame.
    held : the object before the motion, map frame.
    chosen : the chosen explanation of the observation after the motion.
    motion : as commanded, map frame.
    """
    return suspected_squares(chosen.outcome, motion, held, state.others(held), state.occupancy)


def moved_object(
    state: TrackerState,
    held: HeldObject,
    chosen: Explanation,
    motion: Motion,
    ranges: FieldRanges,
    suspected: frozenset[Square],
) -> HeldObject:
    """Return the object in hand after the chosen outcome of a motion: its outline, map frame, and what else changed.

    That is its rotation in degrees, its tolerance `slack` in squares, and the counts of its motions without effect.
    Where it did not move only those counts change, and its place may become inexact. An object whose place is known
    only roughly is moved to touch the known obstacle that seems to have blocked it.

    Parameters
    ----------
    state : what is believed, with the chosen frame.
    held : the object before the motion.
    chosen : the chosen explanation.
    motion : as commanded, map frame.
    ranges : (160, 2) int16, least and greatest count of occupied squares under each field of the observation.
    suspected : the squares that `contact_suspects` returns.
    """
    others, place = state.others(held), chosen.place
    held = replace(held, inexact=held.inexact or state.slipped)
    carried = object_after(held, chosen.outcome, chosen.unexplained, bool(suspected))
    if carried.inexact and carried.proven and not suspected and chosen.outcome and chosen.outcome.stopped:
        known = Obstructions(state.occupancy, place, carried.polygon, motion).known
        carried = lean_on_obstacle(
            carried, motion, known, lambda lying: residual_at(state, ranges, place, [*others, lying])
        )
    return carried


def agreeing_origins(state: TrackerState, ranges: FieldRanges) -> tuple[FrameHypothesis, ...]:
    """Return the frame hypotheses left by an observation of objects that were turned, in their order.

    Each is an angle in degrees and a box of origins (west, south, east, north) in squares, map frame. Where several
    exact origins (hypotheses that name one point) of the believed orientation are left, those are returned that agree
    with the observation, or all of them when none does; otherwise all hypotheses, unchanged.

    Parameters
    ----------
    state : what is believed, with the motion before the observation applied.
    ranges : (160, 2) int16, least and greatest count of occupied squares under each field.
    """
    within = _exact_origins(state)
    if len(within) <= 1:
        return state.hypotheses
    return agreeing_hypotheses(
        within, state.frame, state.place, state.occupancy, state.observations, state.held_objects, ranges
    )


def objects_astray(state: TrackerState) -> dict[str, HeldObject]:
    """Return all held objects, by name, with `astray` set: how far each may lie from its believed place, in squares.

    All else of them stays as it was, map frame; `state` is not changed. Every turn was about the true place of Utak, so
    an origin that is open leaves the place of a turned object open. It is 0, or the rounding of commands, where the
    origin is certain.
    """
    origins = [hypothesis.frame.origin for hypothesis in _exact_origins(state)]
    away = np.array(origins).reshape(-1, 2) - np.array(state.frame.origin)
    held_objects = {}
    for name, held in state.held_objects.items():
        far = np.hypot(*(away - Rotate(held.turned, (0.0, 0.0)).points(away)).T)
        least = COMMAND_ROUNDING if state.beside_line and held.turned % 360 else 0.0
        held_objects[name] = replace(held, astray=float(far.max(initial=least)))
    return held_objects


def _exact_origins(state: TrackerState) -> tuple[FrameHypothesis, ...]:
    """Return the hypotheses of the believed orientation that name an exact origin, in their order; empty for none.

    Each has the believed angle (degrees) and a box that is one point of the square of waking (squares, map frame).

    state : what is believed; its frame and hypotheses are asked.
    """
    return tuple(h for h in state.hypotheses if h.angle == state.frame.angle and h.is_point)
