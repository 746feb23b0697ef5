"""That a walk was stopped, and that he woke elsewhere in his square: neither is told without the other.

Who was stopped stands on a line between two squares, wherever he woke; but how far he came, and so where all lies that
he looks at later, depends on where in his square he began.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import cache

from kb.localisation.hypotheses.explanation import Explanation, told_again
from kb.localisation.hypotheses.frames import ELSEWHERE, Observation, exactly, fallen
from kb.localisation.hypotheses.map_prior import Drawn, MapDescription, plainness
from kb.localisation.hypotheses.remap import Prefixes, relaid
from kb.localisation.hypotheses.walk_outcomes import MotionHypothesis, ReestimatedWalk, retold
from kb.perception.frame import CENTRE, Frame

LAST = 3  # motions one of which may have been stopped where nobody thought so
GRID = 7  # points along either side of the square in which he woke
PLACES = tuple(((i + 0.5) / GRID, (j + 0.5) / GRID) for i in range(GRID) for j in range(GRID))


def frames(held: Frame) -> list[Frame]:
    """The lattices that are turned like the one held, if he woke at one of PLACES."""
    return [replace(held, origin=place) for place in PLACES]


def odds_against(held: Frame, places: int) -> float:
    """Log odds against having woken at one of so many of PLACES, rather than where he is believed to."""
    return ELSEWHERE * (held.origin == CENTRE) - math.log(places / len(PLACES))


def misplaced(
    motions: Sequence[MotionHypothesis], held: Frame, observations: Sequence[Observation]
) -> list[Explanation]:
    """That one of the last motions was stopped, and he woke elsewhere, by which no look contradicts another.

    Those that say the same of every look are told as one, each with what speaks against it: how plain the table looks
    then, and how small the part of the square is in which he woke. held : the lattice that is believed. looks : all,
    where they are believed to have been received, the newest where it was commanded.
    """
    places = tuple(exactly(frame) for frame in frames(held))
    alike: dict[tuple[int, bytes], list[ReestimatedWalk]] = {}
    begun = cache(lambda frame: Prefixes(frame, observations, {}))
    for motion in motions[-LAST:]:
        for told in retold(motion._replace(hypotheses=places), held, observations, begun):
            if not told.misfits:
                key = motion.number, fallen(told.hypothesis.frame, _received(told, observations)).tobytes()
                alike.setdefault(key, []).append(told)
    drawn, against = Drawn(), [odds_against(held, len(told)) for told in alike.values()]
    sketches = [_sketch(told[0], observations, drawn) for told in alike.values()]
    prices = plainness([*zip(sketches, against, strict=True)])
    found = map(_explanation, alike.values())
    return [
        one._replace(crooked=price + odds, weighed=True)
        for one, price, odds in zip(found, prices, against, strict=True)
    ]


def _received(told: ReestimatedWalk, observations: Sequence[Observation]) -> list[Observation]:
    """All looks where they were received then."""
    *before, newest = told.correction.observations(observations)
    return [*before, newest._replace(place=told.newest)]


def _sketch(told: ReestimatedWalk, observations: Sequence[Observation], drawn: Drawn) -> MapDescription:
    frame = told.hypothesis.frame
    return MapDescription(relaid(frame, frame, _received(told, observations), ()).occupancy, drawn)


def _explanation(alike: Sequence[ReestimatedWalk]) -> Explanation:
    """What says the same, as one explanation: by the likeliest of them."""
    told = min(alike, key=lambda one: (not one.known, math.dist(one.hypothesis.frame.origin, CENTRE)))
    return told_again(told, tuple(one.hypothesis for one in alike))
