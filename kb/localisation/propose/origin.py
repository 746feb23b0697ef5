"""Proposals that a walk was blocked and the origin of the frame lies elsewhere: neither is explained without the other.

A contact stops a walk on a grid line, wherever the origin lies. But how far the walk came, and so where everything
lies that is seen later, depends on the origin.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import cache

from utak.kb.localisation.hypotheses.explanation import Explanation
from utak.kb.localisation.hypotheses.frames import OFF_CENTRE_COST, Observation, exact_hypothesis, observation_squares
from utak.kb.localisation.hypotheses.map_prior import MapDescription, relative_costs
from utak.kb.localisation.hypotheses.reestimation import reestimate_walk
from utak.kb.localisation.hypotheses.remap import MapReplay, ReplayPrefixes, remap
from utak.kb.localisation.hypotheses.walk_outcomes import StraightMotion
from utak.kb.localisation.known.situation import ObservedSituation
from utak.kb.perception.frame import CENTRE, Frame

MAX_WALKS_WITH_ORIGIN = 3  # last walks that are re-estimated together with the origin: bounds the time; tuned
COARSE_GRID = 7  # origins along either side of the square of waking: bounds the time; tuned
COARSE_ORIGINS = tuple(
    ((i + 0.5) / COARSE_GRID, (j + 0.5) / COARSE_GRID) for i in range(COARSE_GRID) for j in range(COARSE_GRID)
)


def propose(situation: ObservedSituation) -> list[Explanation]:
    """Return explanations that one of the last walks was blocked, with another origin, without any contradiction."""
    state = situation.state
    if not situation.walked or state.held_objects:
        return []
    return blocked_walks_with_origin(state.reestimable, state.frame, situation.observations)


def blocked_walks_with_origin(
    motions: Sequence[StraightMotion], believed: Frame, observations: Sequence[Observation]
) -> list[Explanation]:
    """Return explanations that one of the last walks was blocked, with another origin, without any contradiction."""
    origins = tuple(exact_hypothesis(replace(believed, origin=place)) for place in COARSE_ORIGINS)
    alike: dict[tuple[int, bytes], list[Explanation]] = {}
    shared: dict[tuple[int, bytes], MapReplay] = {}
    prefixes = cache(lambda frame: ReplayPrefixes(frame, observations, {}, shared))
    for motion in motions[-MAX_WALKS_WITH_ORIGIN:]:
        for walk in reestimate_walk(motion._replace(hypotheses=origins), believed, observations, prefixes):
            squares = observation_squares(walk.frame, _corrected(walk, observations))
            alike.setdefault((motion.number, squares.tobytes()), []).append(walk)
    shares = (len(walks) / len(COARSE_ORIGINS) for walks in alike.values())
    against = [OFF_CENTRE_COST * (believed.origin == CENTRE) - math.log(share) for share in shares]
    maps = (remap(one.frame, one.frame, _corrected(one, observations), ()) for one, *_ in alike.values())
    costs = relative_costs([MapDescription(one.occupancy, odds) for one, odds in zip(maps, against, strict=True)])
    return [
        _likeliest(same)._replace(prior_cost=cost + odds, origin_weighed=True)
        for same, cost, odds in zip(alike.values(), costs, against, strict=True)
    ]


def _corrected(walk: Explanation, observations: Sequence[Observation]) -> list[Observation]:
    """Return all observations, oldest first, where they were made by a re-estimated walk, Utak's own frame."""
    assert walk.correction is not None
    *before, newest = walk.correction.observations(observations)
    return [*before, newest._replace(place=walk.frame.place_to_utak(*walk.place))]


def _likeliest(alike: Sequence[Explanation]) -> Explanation:
    """Return explanations of the same squares as one: that of a known contact, then of the most central origin."""
    one = min(alike, key=lambda one: (not one.contact_known, math.dist(one.frame.origin, CENTRE)))
    return one._replace(hypotheses=tuple(dict.fromkeys(hypothesis for same in alike for hypothesis in same.hypotheses)))
