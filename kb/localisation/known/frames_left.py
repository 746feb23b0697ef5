"""Another frame that the observations leave, where they refute the believed one, before any object was moved."""

import math
from collections.abc import Sequence

from utak.kb.localisation.hypotheses.explanation import Explanation
from utak.kb.localisation.hypotheses.frames import (
    MAX_CHECKED_OBSERVATIONS,
    PLAUSIBLE_COST,
    FrameHypothesis,
    Observation,
    any_origin,
    consistent_hypotheses,
    frames_to_try,
    is_cramped,
)
from utak.kb.localisation.hypotheses.map_prior import weigh_hypotheses
from utak.kb.localisation.hypotheses.remap import remap
from utak.kb.localisation.known.state import TrackerState
from utak.kb.perception.frame import Frame

MAX_REPLAYED_OBSERVATIONS = 120  # observations replayed to try frames, for one choice: bounds its time; tuned
MIN_TRIED_FRAMES = 6  # frames that are tried at least, however many observations there are; tuned
NO_FRAME_RESIDUAL = 10**6  # residual fields when no frame is left: more than any frame can have
SETTLED_SPREAD = math.radians(5)  # orientations that differ by less hardly cause contradictions; tuned


def another_frame(
    state: TrackerState, left: tuple[FrameHypothesis, ...], observations: Sequence[Observation]
) -> Explanation | None:
    """Return the explanation by the best frame that all observations leave; None when they leave none."""
    recent = observations[-MAX_CHECKED_OBSERVATIONS - 1 :]
    if state.likely_spread <= SETTLED_SPREAD:  # another origin is likelier than another orientation
        beside = consistent_hypotheses(recent, any_origin((state.frame.angle,)))
        left = weigh_hypotheses((*beside, *(h for h in left if h.angle != state.frame.angle)), recent)
    frame, residual = _best_frame(state, left, observations)
    if residual or state.prior_cost(frame.angle) > PLAUSIBLE_COST:
        found = tuple(one._replace(prior_cost=state.prior_cost(one.angle)) for one in consistent_hypotheses(recent))
        another, fewer = _best_frame(state, found, observations)
        if (fewer, state.prior_cost(another.angle)) < (residual, state.prior_cost(frame.angle)):
            left, frame, residual = found, another, fewer
    if not left:
        return None
    place = frame.place_from_utak(*observations[-1].place)
    cost, cramped = state.prior_cost(frame.angle), is_cramped(left, len(state.observations))
    return Explanation("turned", place, frame, residual, 0.0, None, left, prior_cost=cost, cramped=cramped)


def _best_frame(
    state: TrackerState, left: tuple[FrameHypothesis, ...], observations: Sequence[Observation]
) -> tuple[Frame, int]:
    """Return the frame of the least residual among those left, and that residual (a count of fields)."""
    if not left:
        return state.frame, NO_FRAME_RESIDUAL
    tried: list[tuple[int, int]] = []
    most = max(MIN_TRIED_FRAMES, MAX_REPLAYED_OBSERVATIONS // len(observations))
    frames = frames_to_try(left, state.frame)[:most]
    for number, frame in enumerate(frames):
        tried.append((remap(frame, state.frame, observations, ()).residual, number))
        if tried[-1][0] == 0:
            break
    residual, number = min(tried)
    return frames[number], residual
