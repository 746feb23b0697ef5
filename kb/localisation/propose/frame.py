"""Proposals of another frame, when an observation contradicts what is believed after objects have been moved.

Hypotheses that are left are tried first, then those that were given up. That the motion was blocked by something
unknown comes last.
"""

import math
from collections.abc import Iterator
from typing import NamedTuple

from utak.kb.localisation.hypotheses.carry_outcomes import partial_outcome
from utak.kb.localisation.hypotheses.contacts import Obstructions
from utak.kb.localisation.hypotheses.frames import (
    OFF_CENTRE_COST,
    FrameHypothesis,
    any_origin,
    consistent_hypotheses,
    exact_hypothesis,
    frames_to_try,
)
from utak.kb.localisation.hypotheses.walk_outcomes import observation_places
from utak.kb.localisation.hypotheses.what_if import Surprise, WhatIf
from utak.kb.localisation.propose.blocked import likeliest_ends
from utak.kb.localisation.propose.origin import frames_of_coarse_origins, origin_cost
from utak.kb.localisation.propose.origin_from_turns import origin_from_turn
from utak.kb.objects.held_object import Square
from utak.kb.perception.frame import CENTRE, Frame

SEARCHED_ANGLE_MARGIN = 2  # degrees around the hypotheses left in which orientations are taken up again; tuned
MAX_SEARCHED_SPAN = 8  # degrees between the hypotheses left up to which all of them are searched around; tuned
MAX_EVALUATED_FRAMES = 12  # frames in which everything is remapped, at most: bounds the time; tuned
MIN_EVALUATED_FRAMES = 4  # the same, at least, however many observations there are; tuned
MAX_REMAPPED_OBSERVATIONS = 200  # observations replayed in all for that: bounds the time; tuned
MAX_BLOCKED_FRAMES = 3  # of those, the best ones in which the motion may have been blocked by something unknown; tuned
MIN_ORIGIN_AREA = 0.02  # squares^2 of origins left below which a blocked motion is likelier; tuned


def best_frame(surprise: Surprise, reconsider: bool, simple: bool) -> WhatIf | None:
    """Return the evaluation of the frame that explains an observation best; None when no frame is left."""
    if surprise.any_turned:
        found = _other_orientation(surprise) or origin_from_turn(surprise, simple)
        if found is not None:
            return found
    return _least_residual(surprise, reconsider)


def _other_orientation(surprise: Surprise) -> WhatIf | None:
    """Return a frame of another orientation that was never given up and nothing contradicts; None if there is none."""
    angle = surprise.frame.angle
    others = [other for other in surprise.hypotheses if other.is_centred and other.angle != angle]
    left = consistent_hypotheses(surprise.judging_observations, others, surprise.unsettled_discs)
    frames = frames_to_try(left, surprise.frame)[:MAX_EVALUATED_FRAMES]
    tried = (surprise.evaluate_frame(frame, left, only_whether=True) for frame in frames)
    return next((one for one in tried if not one.residual), None)


def _least_residual(surprise: Surprise, reconsider: bool) -> WhatIf | None:
    """Return the evaluation of the least residual; None when no frame is left."""
    found: list[WhatIf] = []
    affordable = MAX_REMAPPED_OBSERVATIONS // (len(surprise.observations) + 1)
    few = max(MIN_EVALUATED_FRAMES, min(MAX_EVALUATED_FRAMES, affordable))
    for hypotheses, searched in _batches(surprise, reconsider):
        if searched and sum(hypothesis.area for hypothesis in hypotheses) < MIN_ORIGIN_AREA:
            short = _blocked_motion(surprise, few)
            if short is not None:
                return short
        for frame in frames_to_try(hypotheses, surprise.frame)[:few]:
            found.append(surprise.evaluate_frame(frame, hypotheses, searched))
            if not found[-1].residual:
                return found[-1]
    if found or surprise.carried is None:
        found.sort(key=lambda one: one.residual)
        others = [one for one in found if one.frame != surprise.frame][:MAX_BLOCKED_FRAMES]
        found += [surprise.evaluate_frame(one.frame, one.hypotheses, one.searched, cut_short=True) for one in others]
    else:  # in none of them the motion went on to its end
        before = surprise.hypotheses_before
        for frame in frames_to_try(before, surprise.frame)[:few]:
            found += [surprise.evaluate_frame(frame, before, cut_short=cut_short) for cut_short in (False, True)]
    return min(found, key=lambda one: one.residual, default=None)


def _batches(surprise: Surprise, reconsider: bool) -> Iterator[tuple[tuple[FrameHypothesis, ...], bool]]:
    """Yield sets of hypotheses to evaluate, the likeliest set first, each with whether given up before."""
    recent, unsettled = surprise.judging_observations, surprise.unsettled_discs
    left = consistent_hypotheses(recent, surprise.hypotheses, unsettled)
    plainest = tuple(hypothesis for hypothesis in left if hypothesis.prior_cost <= OFF_CENTRE_COST)
    yield plainest, False
    if len(plainest) < len(left):
        if reconsider:
            yield consistent_hypotheses(recent, any_origin((surprise.frame.angle,)), unsettled), True
        yield tuple(hypothesis for hypothesis in left if hypothesis.prior_cost > OFF_CENTRE_COST), False
    if reconsider:
        yield _reconsidered(surprise), True


def _reconsidered(surprise: Surprise) -> tuple[FrameHypothesis, ...]:
    """Return all hypotheses that observations leave, of orientations near to those that are left."""
    # In the order of their angles, each an angle in degrees and a box of origins in squares, map frame; empty when none
    # is left.
    angles = [surprise.frame.angle, *(h.angle for h in surprise.hypotheses)]
    if max(angles) - min(angles) > MAX_SEARCHED_SPAN:
        angles = [surprise.frame.angle]
    about = any_origin(range(min(angles) - SEARCHED_ANGLE_MARGIN, max(angles) + SEARCHED_ANGLE_MARGIN + 1))
    return consistent_hypotheses(surprise.judging_observations, about, surprise.unsettled_discs)


def _blocked_motion(surprise: Surprise, few: int) -> WhatIf | None:
    """Return a frame that was left before the motion, in which the motion was blocked and nothing contradicts."""
    # None when there is none, or when no object was to be moved.
    if surprise.carried is None:
        return None
    before = surprise.hypotheses_before
    frames = frames_to_try(before, surprise.frame)[:few]
    for cut_short in (False, True):
        tried = [surprise.evaluate_frame(frame, before, cut_short=cut_short, only_whether=True) for frame in frames]
        fitting = sorted((one for one in tried if not one.residual), key=lambda one: one.frame.angle)
        if fitting:
            return fitting[(len(fitting) - 1) // 2]
    return None


class BlockedPushWithOrigin(NamedTuple):
    """A blocked push together with another origin of the frame."""

    what_if: WhatIf  # its evaluation, without residual
    chance: float  # the probability that the push was blocked so, 0 to 1
    # Log odds (natural logarithm) against the part of the square of waking in which the origin lies then
    against: float


def blocked_pushes_with_origin(surprise: Surprise) -> list[BlockedPushWithOrigin]:
    """Return how a push may have been blocked, with another origin on a coarse grid, so that nothing contradicts it."""
    alike: dict[tuple[int, int, frozenset[Square]], list[tuple[WhatIf, float]]] = {}
    asked = surprise.carried is not None and not surprise.any_turned
    for frame in frames_of_coarse_origins(surprise.frame) if asked else ():
        for what_if, chance in _blocked_pushes(surprise, frame):
            assert what_if.outcome is not None
            x, y = what_if.place
            key = math.floor(x), math.floor(y), what_if.outcome.contact_squares
            alike.setdefault(key, []).append((what_if, chance))
    found = []
    for same in alike.values():
        what_if, chance = min(same, key=lambda one: math.dist(one[0].frame.origin, CENTRE))
        left = tuple(dict.fromkeys(hypothesis for one, _ in same for hypothesis in one.hypotheses))
        against = origin_cost(surprise.frame, len(left))
        found.append(BlockedPushWithOrigin(what_if._replace(hypotheses=left), chance, against))
    return found


def _blocked_pushes(surprise: Surprise, frame: Frame) -> Iterator[tuple[WhatIf, float]]:
    """Yield how a push may have been blocked in a frame so that nothing contradicts it, each with its probability."""
    under = surprise.remapped(frame, only_whether=True)
    if under.residual:
        return
    place, polygon, motion = surprise.motion_in(frame)
    left, obstructions = (exact_hypothesis(frame),), Obstructions(under.occupancy, place, polygon, motion)
    for contact in likeliest_ends(obstructions.contacts(place, polygon, motion)):
        end = partial_outcome(place, polygon, motion, contact.fraction, contact.squares)
        for view in observation_places(end.place):
            what_if = surprise.evaluate_outcome(frame, left, end._replace(place=view), only_whether=True)
            if not what_if.residual:
                yield what_if, contact.chance
