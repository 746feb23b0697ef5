"""Proposals that a walk was blocked and the origin of the frame lies elsewhere: neither is explained without the other.

A contact stops a walk on a grid line, wherever the origin lies. But how far the walk came, and so where everything
lies that is seen later, depends on the origin.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import cache

from utak.kb.localisation.hypotheses.explanation import Explanation, reestimated_explanation
from utak.kb.localisation.hypotheses.frames import OFF_CENTRE_COST, Observation, exact_hypothesis, observation_squares
from utak.kb.localisation.hypotheses.map_prior import DrawnScenes, MapDescription, relative_costs
from utak.kb.localisation.hypotheses.reestimation import ReestimatedWalk, reestimate_walk
from utak.kb.localisation.hypotheses.remap import MapReplay, ReplayPrefixes, remap
from utak.kb.localisation.hypotheses.walk_outcomes import MotionHypothesis
from utak.kb.perception.frame import CENTRE, Frame

MAX_WALKS_WITH_ORIGIN = 3  # last walks that are re-estimated together with the origin: bounds the time; tuned
COARSE_GRID = 7  # origins along either side of the square of waking: bounds the time; tuned
COARSE_ORIGINS = tuple(
    ((i + 0.5) / COARSE_GRID, (j + 0.5) / COARSE_GRID) for i in range(COARSE_GRID) for j in range(COARSE_GRID)
)


def frames_of_coarse_origins(believed: Frame) -> list[Frame]:
    """Return the frames of the believed orientation with each of the COARSE_ORIGINS: 7 x 7 points of a square."""
    return [replace(believed, origin=place) for place in COARSE_ORIGINS]


def origin_cost(believed: Frame, number: int) -> float:
    """Return the log odds against an origin at one of `number` of the COARSE_ORIGINS, rather than the believed one."""
    return OFF_CENTRE_COST * (believed.origin == CENTRE) - math.log(number / len(COARSE_ORIGINS))


def blocked_walks_with_origin(
    motions: Sequence[MotionHypothesis], believed: Frame, observations: Sequence[Observation]
) -> list[Explanation]:
    """Return explanations that one of the last walks was blocked, with another origin, without any contradiction."""
    origins = tuple(exact_hypothesis(frame) for frame in frames_of_coarse_origins(believed))
    alike: dict[tuple[int, bytes], list[ReestimatedWalk]] = {}
    shared: dict[tuple[int, bytes], MapReplay] = {}
    prefixes = cache(lambda frame: ReplayPrefixes(frame, observations, {}, shared))
    for motion in motions[-MAX_WALKS_WITH_ORIGIN:]:
        for walk in reestimate_walk(motion._replace(hypotheses=origins), believed, observations, prefixes):
            if not walk.residual:
                squares = observation_squares(walk.hypothesis.frame, _corrected(walk, observations))
                alike.setdefault((motion.number, squares.tobytes()), []).append(walk)
    drawn, against = DrawnScenes(), [origin_cost(believed, len(walks)) for walks in alike.values()]
    maps = [_description(walks[0], observations, drawn) for walks in alike.values()]
    costs = relative_costs([*zip(maps, against, strict=True)])
    found = map(_explanation, alike.values())
    return [
        one._replace(prior_cost=cost + odds, origin_weighed=True)
        for one, cost, odds in zip(found, costs, against, strict=True)
    ]


def _corrected(walk: ReestimatedWalk, observations: Sequence[Observation]) -> list[Observation]:
    """Return all observations, oldest first, where they were made by a re-estimated walk, Utak's own frame."""
    *before, newest = walk.correction.observations(observations)
    return [*before, newest._replace(place=walk.newest)]


def _description(walk: ReestimatedWalk, observations: Sequence[Observation], drawn: DrawnScenes) -> MapDescription:
    """Return the map by a re-estimated walk, as one to be completed; nothing is drawn yet."""
    frame = walk.hypothesis.frame
    return MapDescription(remap(frame, frame, _corrected(walk, observations), ()).occupancy, drawn)


def _explanation(alike: Sequence[ReestimatedWalk]) -> Explanation:
    """Return walks of the same squares as one explanation: that of a known contact, then of the most central origin."""
    walk = min(alike, key=lambda one: (not one.contact_known, math.dist(one.hypothesis.frame.origin, CENTRE)))
    return reestimated_explanation(walk, tuple(one.hypothesis for one in alike))
