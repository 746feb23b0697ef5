"""Proposals of another frame, by the map prior, or when observations contradict what is believed.

Hypotheses that are left are tried first, then those that were given up; where these leave hardly any room for the
origin, it is likelier that the motion was blocked by something unknown. Another frame is believed only where nothing
contradicts it.
"""

from collections.abc import Iterable

from utak.geometry.motion.se2 import Translate
from utak.kb.localisation.hypotheses.explanation import Explanation
from utak.kb.localisation.hypotheses.frames import (
    Hypothesis,
    any_origin,
    consistent_hypotheses,
    frames_to_try,
)
from utak.kb.localisation.known.situation import MAX_JUDGING_OBSERVATIONS, ObservedSituation
from utak.kb.localisation.propose.origin_from_turns import origin_from_turn

SEARCHED_ANGLE_MARGIN = 2  # degrees around the hypotheses left in which orientations are taken up again; tuned
MAX_SEARCHED_SPAN = 8  # degrees between the hypotheses left up to which all of them are searched around; tuned
MAX_EVALUATED_FRAMES = 12  # frames in which everything is remapped, at most: bounds the time; tuned
MIN_EVALUATED_FRAMES = 4  # the same, at least, however many observations there are; tuned
MAX_REMAPPED_OBSERVATIONS = 200  # observations replayed in all for that: bounds the time; tuned
MIN_ORIGIN_AREA = 0.02  # squares^2 of origins left below which a blocked motion is likelier; tuned


def propose(situation: ObservedSituation) -> list[Explanation]:
    """Return the explanation by another frame in a list; [] where something contradicts each that is tried."""
    state, whole = situation.state, situation.found[0]
    if not state.held_objects:
        if whole.unexplained:
            return [situation.another] if situation.another is not None else []
        return _best_prior(situation)
    simple = any(not one.unexplained for one in situation.found[1:] if one.how != "slipped" or state.slipped)
    found = _best_frame(situation, simple)
    if found is None:
        return []
    pushed = found.outcome is not None and found.outcome.stopped and isinstance(situation.motion, Translate)
    if simple and pushed and found.frame == state.frame:  # finer proposals of where it was blocked exist already
        return []
    if found.frame != state.frame or set(found.hypotheses) != set(state.frames):
        return [found._replace(prior_cost=state.prior_cost(found.frame.angle))]
    if found.outcome is None or found.outcome.how == "predicted":  # proposed already
        return []
    return [found._replace(how=found.outcome.how, hypotheses=())]


def _best_prior(situation: ObservedSituation) -> list[Explanation]:
    """Return the explanation by the frame of the best map prior in a list; [] where that is the believed one."""
    state, left = situation.state, situation.left
    if not situation.stands or next(h.prior_cost for h in left if h.contains(state.frame)) == 0:
        return []
    best = frames_to_try(left, state.frame)[0]
    return [Explanation("turned", best.place_from_utak(*situation.observation.place), best, 0, 0.0, None, left)]


def _best_frame(situation: ObservedSituation, simple: bool) -> Explanation | None:
    """Return the explanation by the likeliest frame that nothing contradicts; None when there is none."""
    if situation.any_turned:
        found = _other_orientation(situation) or origin_from_turn(situation, simple)
        if found is not None:
            return found
    affordable = MAX_REMAPPED_OBSERVATIONS // (len(situation.state.observations) + 1)
    few = max(MIN_EVALUATED_FRAMES, min(MAX_EVALUATED_FRAMES, affordable))
    left = _left(situation, situation.state.frames)
    found = _first_fitting(situation, left, few)
    if found is not None:
        return found
    given_up = _given_up(situation)
    crowded = sum(hypothesis.area for hypothesis in given_up) < MIN_ORIGIN_AREA
    found = _blocked_motion(situation, few) if crowded else None
    return found or _first_fitting(situation, given_up, few)


def _other_orientation(situation: ObservedSituation) -> Explanation | None:
    """Return a frame of another orientation that was never given up and nothing contradicts; None if there is none."""
    angle = situation.state.frame.angle
    others = [other for other in situation.state.frames if other.is_centred and other.angle != angle]
    return _first_fitting(situation, _left(situation, others), MAX_EVALUATED_FRAMES)


def _left(situation: ObservedSituation, hypotheses: Iterable[Hypothesis]) -> tuple[Hypothesis, ...]:
    """Return what the last observations leave of some hypotheses, in their order; empty when they refute all."""
    return consistent_hypotheses(situation.judging_observations, hypotheses, situation.unsettled_discs)


def _first_fitting(situation: ObservedSituation, hypotheses: tuple[Hypothesis, ...], few: int) -> Explanation | None:
    """Return the explanation by the likeliest frame that nothing contradicts; None if there is none."""
    frames = frames_to_try(hypotheses, situation.state.frame)[:few]
    return next(filter(None, (situation.by_frame(frame, hypotheses) for frame in frames)), None)


def _given_up(situation: ObservedSituation) -> tuple[Hypothesis, ...]:
    """Return all hypotheses that observations leave, of orientations near to those that are left."""
    angles = [situation.state.frame.angle, *(h.angle for h in situation.state.frames)]
    if max(angles) - min(angles) > MAX_SEARCHED_SPAN:
        angles = [situation.state.frame.angle]
    about = range(min(angles) - SEARCHED_ANGLE_MARGIN, max(angles) + SEARCHED_ANGLE_MARGIN + 1)
    return _left(situation, any_origin(about))


def _blocked_motion(situation: ObservedSituation, few: int) -> Explanation | None:
    """Return a frame that was left before the motion, in which the motion was blocked and nothing contradicts."""
    # None when there is none, or when no object was to be moved.
    if not situation.carries:
        return None
    seen, unsettled = situation.state.observations[-MAX_JUDGING_OBSERVATIONS:], situation.unsettled_discs
    before = consistent_hypotheses(seen, situation.state.frames, unsettled)
    frames = frames_to_try(before, situation.state.frame)[:few]
    for cut_short in (False, True):
        tried = (situation.by_frame(frame, before, cut_short) for frame in frames)
        fitting = sorted((one for one in tried if one is not None), key=lambda one: one.frame.angle)
        if fitting:
            return fitting[(len(fitting) - 1) // 2]
    return None
