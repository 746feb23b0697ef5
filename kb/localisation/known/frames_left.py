"""Another frame that the observations leave, where they refute the believed one, before any object was moved."""

import math
from collections.abc import Sequence

from utak.kb.localisation.hypotheses.explanation import Explanation
from utak.kb.localisation.hypotheses.frames import (
    KEPT_ODDS,
    MAX_CHECKED_OBSERVATIONS,
    Hypothesis,
    Observation,
    any_origin,
    consistent_hypotheses,
    frames_to_try,
    is_cramped,
)
from utak.kb.localisation.hypotheses.map_prior import weigh_hypotheses
from utak.kb.localisation.hypotheses.remap import remap
from utak.kb.localisation.known.state import TrackerState

MAX_REPLAYED_OBSERVATIONS = 120  # observations replayed to try frames, for one choice: bounds its time; tuned
MIN_TRIED_FRAMES = 6  # frames that are tried at least, however many observations there are; tuned
SETTLED_SPREAD = math.radians(5)  # orientations that differ by less hardly cause contradictions; tuned


def another_frame(
    state: TrackerState, left: tuple[Hypothesis, ...], observations: Sequence[Observation]
) -> Explanation | None:
    """Return the explanation by the likeliest frame that no observation contradicts; None if there is none."""
    recent = observations[-MAX_CHECKED_OBSERVATIONS - 1 :]
    if state.likely_spread <= SETTLED_SPREAD:  # another origin is likelier than another orientation
        beside = consistent_hypotheses(recent, any_origin((state.frame.angle,)))
        left = weigh_hypotheses((*beside, *(h for h in left if h.angle != state.frame.angle)), recent)
    found = _fitting(state, left, observations)
    if found is None or state.prior_cost(found.frame.angle) > KEPT_ODDS:
        again = tuple(one._replace(prior_cost=state.prior_cost(one.angle)) for one in consistent_hypotheses(recent))
        tried = [one for one in (found, _fitting(state, again, observations)) if one is not None]
        found = min(tried, key=lambda one: one.prior_cost, default=None)
    return found


def _fitting(
    state: TrackerState, left: tuple[Hypothesis, ...], observations: Sequence[Observation]
) -> Explanation | None:
    """Return the explanation by the likeliest frame that nothing contradicts; None if there is none."""
    most = max(MIN_TRIED_FRAMES, MAX_REPLAYED_OBSERVATIONS // len(observations))
    tried = frames_to_try(left, state.frame)[:most]
    fits = (frame for frame in tried if not remap(frame, state.frame, observations, (), only_whether=True).residual)
    frame = next(fits, None)
    if frame is None:
        return None
    place = frame.place_from_utak(*observations[-1].place)
    cost, cramped = state.prior_cost(frame.angle), is_cramped(left, len(state.observations))
    return Explanation("turned", place, frame, 0, 0.0, None, left, prior_cost=cost, cramped=cramped)
