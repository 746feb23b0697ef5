"""Proposals that a motion was blocked and the origin of the frame lies elsewhere, which explain it together alone.

A contact stops a walk on a grid line, wherever the origin lies. But how far the walk came, and so where everything
lies that is seen later, depends on the origin.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cache

from utak.kb.localisation.hypotheses.carry_outcomes import partial_outcome
from utak.kb.localisation.hypotheses.contacts import Obstructions, likeliest_ends
from utak.kb.localisation.hypotheses.explanation import Explanation
from utak.kb.localisation.hypotheses.frames import OFF_CENTRE_COST, Observation, exact_hypothesis, observation_squares
from utak.kb.localisation.hypotheses.map_prior import DrawnScenes, MapDescription, relative_costs
from utak.kb.localisation.hypotheses.reestimation import reestimate_walk
from utak.kb.localisation.hypotheses.remap import MapReplay, ReplayPrefixes, remap
from utak.kb.localisation.hypotheses.walk_outcomes import MotionHypothesis, observation_places
from utak.kb.localisation.known.situation import ObservedSituation
from utak.kb.objects.held_object import Square
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


def propose(situation: ObservedSituation) -> list[Explanation]:
    """Return explanations that a motion was blocked, with another origin, without any contradiction."""
    state = situation.state
    if situation.walked and not state.held_objects:
        return blocked_walks_with_origin(state.reestimable, state.frame, situation.observations)
    return blocked_pushes_with_origin(situation) if situation.carried is not None and not situation.any_turned else []


def blocked_walks_with_origin(
    motions: Sequence[MotionHypothesis], believed: Frame, observations: Sequence[Observation]
) -> list[Explanation]:
    """Return explanations that one of the last walks was blocked, with another origin, without any contradiction."""
    origins = tuple(exact_hypothesis(frame) for frame in frames_of_coarse_origins(believed))
    alike: dict[tuple[int, bytes], list[Explanation]] = {}
    shared: dict[tuple[int, bytes], MapReplay] = {}
    prefixes = cache(lambda frame: ReplayPrefixes(frame, observations, {}, shared))
    for motion in motions[-MAX_WALKS_WITH_ORIGIN:]:
        for walk in reestimate_walk(motion._replace(hypotheses=origins), believed, observations, prefixes):
            squares = observation_squares(walk.frame, _corrected(walk, observations))
            alike.setdefault((motion.number, squares.tobytes()), []).append(walk)
    drawn, against = DrawnScenes(), [origin_cost(believed, len(walks)) for walks in alike.values()]
    first = (walks[0] for walks in alike.values())
    costs = relative_costs([_description(*one, observations, drawn) for one in zip(first, against, strict=True)])
    return [
        _likeliest(same)._replace(prior_cost=cost + odds, origin_weighed=True)
        for same, cost, odds in zip(alike.values(), costs, against, strict=True)
    ]


def _corrected(walk: Explanation, observations: Sequence[Observation]) -> list[Observation]:
    """Return all observations, oldest first, where they were made by a re-estimated walk, Utak's own frame."""
    assert walk.correction is not None
    *before, newest = walk.correction.observations(observations)
    return [*before, newest._replace(place=walk.frame.place_to_utak(*walk.place))]


def _description(
    walk: Explanation, against: float, observations: Sequence[Observation], drawn: DrawnScenes
) -> MapDescription:
    """Return the map by a re-estimated walk, as one to be completed; nothing is drawn yet."""
    return MapDescription(remap(walk.frame, walk.frame, _corrected(walk, observations), ()).occupancy, drawn, against)


def blocked_pushes_with_origin(situation: ObservedSituation) -> list[Explanation]:
    """Return how a push may have been blocked, with another origin on a coarse grid, so that nothing contradicts it."""
    alike: dict[tuple[int, int, frozenset[Square]], list[Explanation]] = {}
    believed = situation.state.frame
    for one in (one for frame in frames_of_coarse_origins(believed) for one in _blocked_pushes(situation, frame)):
        key = math.floor(one.place[0]), math.floor(one.place[1]), one.contact_squares
        alike.setdefault(key, []).append(one)
    found = map(_likeliest, alike.values())
    against = ((one, origin_cost(believed, len(one.hypotheses))) for one in found)
    return [one._replace(prior_cost=cost, origin_weighed=True) for one, cost in against]


def _blocked_pushes(situation: ObservedSituation, frame: Frame) -> Iterator[Explanation]:
    """Yield how a push may have been blocked in a frame so that nothing contradicts it, each with its probability."""
    under = situation.remapped(frame)
    if under.residual:
        return
    place, polygon, motion = situation.motion_in(frame)
    contacts = Obstructions(under.occupancy, place, polygon, motion).contacts(place, polygon, motion)
    for contact in likeliest_ends(contacts):
        end = partial_outcome(place, polygon, motion, contact.fraction, contact.squares)
        for view in observation_places(end.place):
            one = situation.by_outcome(frame, (exact_hypothesis(frame),), end._replace(place=view))
            if one is not None:
                yield one._replace(chance=contact.chance, contact_squares=contact.squares)


def _likeliest(alike: Sequence[Explanation]) -> Explanation:
    """Return explanations of the same squares as one: that of a known contact, then of the most central origin."""
    one = min(alike, key=lambda one: (not one.contact_known, math.dist(one.frame.origin, CENTRE)))
    return one._replace(hypotheses=tuple(dict.fromkeys(hypothesis for same in alike for hypothesis in same.hypotheses)))
