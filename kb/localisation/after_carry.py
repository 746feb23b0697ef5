"""Explanations of an observation after a push or a turn with an object in hand, and the object's state after it."""

import math
from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from utak.geometry.motion.se2 import Motion, Rotate
from utak.kb.localisation.hypotheses.carry_outcomes import CarryOutcome, other_outcomes, predicted_outcome
from utak.kb.localisation.hypotheses.contacts import (
    ContactHypothesis,
    Obstructions,
    contact_outcomes,
    suspected_squares,
)
from utak.kb.localisation.hypotheses.explanation import Explanation
from utak.kb.localisation.hypotheses.frames import FieldRanges, FrameHypothesis
from utak.kb.localisation.hypotheses.what_if import Surprise, agreeing_hypotheses
from utak.kb.localisation.propose.blocked import has_whole_way, possible_ends
from utak.kb.localisation.propose.contradicted_motion import overlooked_contact
from utak.kb.localisation.propose.held_object_state import lean_on_obstacle, object_after
from utak.kb.localisation.propose.larger_object import larger_objects
from utak.kb.localisation.propose.parted_object import parted_objects
from utak.kb.localisation.propose.smaller_object import smaller_objects
from utak.kb.localisation.score import (
    Judgement,
    LookedFrom,
    SearchBudget,
    choose,
    consistent_ends,
    is_simple,
    propose_blocked_push_and_origin,
    propose_earlier_motions,
    propose_frame,
    residual_at,
    with_others,
)
from utak.kb.localisation.state import TrackerState
from utak.kb.objects.held_object import COMMAND_ROUNDING, HeldObject, Square

MAX_CLEAR_CHANCE = 0.25  # probability of a contact up to which a motion counts as clear of obstacles; tuned


def explain_carry(state: TrackerState, surprise: Surprise, held: HeldObject, motion: Motion) -> Judgement:
    """Return the explanation chosen for the observation after a push or a turn."""
    judged = _explain_carry(state, surprise, held, motion)
    end = predicted_outcome(state.place, held.polygon, motion)
    carried = held.moved(end.polygon, held.slack, end.degrees, commanded=True)
    after = replace(surprise, held_objects={**state.held_objects, held.name: carried})
    looked_from = [LookedFrom(surprise, [state.place]), LookedFrom(after, [end.place], end)]
    return judged._replace(explanation=with_others(state, surprise, judged.explanation, looked_from))


def _explain_carry(state: TrackerState, surprise: Surprise, held: HeldObject, motion: Motion) -> Judgement:
    """Return the explanation chosen for the observation after a push or a turn, if nothing else moved things."""
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
    """Return what else may have come of the motion in the believed frame."""
    ends = contact_outcomes(contacts, state.place, held.polygon, motion)
    outcomes = [*blocked] or [one for one in (_outcome(state, surprise, end) for end in ends) if not one.residual]
    outcomes += [_outcome(state, surprise, other) for other in other_outcomes(state.place, held.polygon, motion)]
    assert whole.outcome is not None
    outcomes += [*smaller_objects(surprise, held, motion, whole.outcome), *larger_objects(surprise, held, motion)]
    outcomes += parted_objects(surprise, held, motion)
    return outcomes


def _facts(
    state: TrackerState, surprise: Surprise, held: HeldObject, contacts: Iterable[ContactHypothesis]
) -> list[str]:
    """Return the facts about the motion on which the choice depends, for kb/asp/accommodation.lp."""
    facts = {
        "unchanged": np.array_equal(surprise.ranges, state.observations[-1].ranges),
        "clear": sum(contact.chance for contact in contacts) <= MAX_CLEAR_CHANCE,
        "uneven": held.insets is not None and any(held.insets.believed),
    }
    return [fact for fact, holds in facts.items() if holds]


def _blocked_push(state: TrackerState, surprise: Surprise, held: HeldObject, motion: Motion) -> tuple[Explanation, ...]:
    """Return where a push may have ended, its whole way included, as far as the observation agrees."""
    # Empty for a turn, when the push can hardly have met anything, or when the observation agrees with none.
    ended = []
    for end in possible_ends(surprise, held, motion):
        assert end.outcome is not None
        ended.append((end, _outcome(state, surprise, end.outcome)))
    return consistent_ends(surprise, ended)


def _outcome(state: TrackerState, surprise: Surprise, outcome: CarryOutcome) -> Explanation:
    """Return the explanation that the motion of the object in hand had an outcome, in the believed frame."""
    residual = residual_at(state, surprise.ranges, outcome.place, surprise.objects_after(outcome))
    return Explanation(outcome.how, outcome.place, state.frame, residual, outcome.distance, outcome)


def contact_suspects(state: TrackerState, held: HeldObject, chosen: Explanation, motion: Motion) -> frozenset[Square]:
    """Return the open squares one of which probably stopped an object, (column, row) of the map frame."""
    # Else empty when nothing was stopped, when what stopped it is known, or when the object was never seen to move.
    return suspected_squares(chosen.outcome, motion, held, state.others(held), state.occupancy)


def moved_object(
    state: TrackerState,
    held: HeldObject,
    chosen: Explanation,
    motion: Motion,
    ranges: FieldRanges,
    suspected: frozenset[Square],
) -> HeldObject:
    """Return the object in hand after the chosen outcome of a motion: its outline, map frame, and what else changed."""
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
    """Return the frame hypotheses left by an observation of objects that were turned, in their order."""
    # Where several exact origins (hypotheses that name one point) of the believed orientation are left, those are
    # returned that agree with the observation, or all of them when none does; otherwise all hypotheses, unchanged.
    within = _exact_origins(state)
    if len(within) <= 1:
        return state.hypotheses
    return agreeing_hypotheses(
        within, state.frame, state.place, state.occupancy, state.observations, state.held_objects, ranges
    )


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


def _exact_origins(state: TrackerState) -> tuple[FrameHypothesis, ...]:
    """Return the hypotheses of the believed orientation that name an exact origin, in their order; empty for none."""
    return tuple(h for h in state.hypotheses if h.angle == state.frame.angle and h.is_point)
