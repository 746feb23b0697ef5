"""A blocked walk and an origin off the middle are found together."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from tests.kb.eyes import impression, random_room, world_of
from tests.kb.localisation.hypotheses.test_walk_outcomes import passes_corner
from utak.kb.localisation.hypotheses.explanation import Explanation
from utak.kb.localisation.hypotheses.frames import (
    CENTRED_HYPOTHESES,
    OFF_CENTRE_COST,
    Observation,
    count_contradictions,
    observation_squares,
)
from utak.kb.localisation.hypotheses.walk_outcomes import LINE_DISTANCE, StraightMotion, line_crossings
from utak.kb.localisation.propose.origin import COARSE_ORIGINS, blocked_walks_with_origin
from utak.kb.perception.frame import Frame, turned
from utak.kb.perception.retina import count_ranges

Point = tuple[float, float]


def corrected(one: Explanation, observations: list[Observation]) -> list[Observation]:
    """Return the observations where they were made by an explanation."""
    assert one.correction is not None
    *before, newest = one.correction.observations(observations)
    return [*before, newest._replace(place=one.frame.place_to_utak(*one.place))]


@pytest.mark.long
@settings(max_examples=15, deadline=None)
@given(st.integers(0, 2**32 - 1), st.sampled_from(COARSE_ORIGINS))
def test_the_true_origin_and_contact_are_among_the_proposals(seed: int, origin: Point) -> None:
    """A wall blocks a walk unnoticed; the next motion goes back some of the way."""
    rng = np.random.default_rng(seed)
    occupied, heading = world_of(random_room(rng, 26, 26, 8)), int(rng.integers(-44, 46))
    free = [(i, j) for i in range(3, 23) for j in range(3, 23) if not occupied(i, j)]
    x, y = free[int(rng.integers(len(free)))]
    way = (float(rng.uniform(-14, 14)), float(rng.uniform(-14, 14)))
    met = line_crossings((x + origin[0], y + origin[1]), turned(*way, heading))
    stop = next((crossing for crossing in met if occupied(*crossing.entered)), None)
    assume(stop is not None and not passes_corner(*origin, *turned(*way, heading)))
    assert stop is not None
    true, held = Frame(heading, origin), Frame(heading)
    own = true.place_to_utak(stop.before[0] - x, stop.before[1] - y)
    assume(math.dist(own, way) > 2 * LINE_DISTANCE)
    places = [(0.0, 0.0), own, (0.5 * own[0], 0.5 * own[1])]
    observations, astray = [], (way[0] - own[0], way[1] - own[1])
    for place, (east, north) in zip(places, [(0.0, 0.0), astray, astray], strict=True):
        i, j = (math.floor(v) for v in true.place_from_utak(*place))
        seen = count_ranges(impression(occupied, (i + x, j + y), heading).retina)
        observations.append(Observation(seen, (place[0] + east, place[1] + north)))
    found = blocked_walks_with_origin([StraightMotion(1, way, CENTRED_HYPOTHESES)], held, observations)
    squares = [observation_squares(one.frame, corrected(one, observations)).tolist() for one in found]
    assert (
        observation_squares(
            true, [observation._replace(place=place) for observation, place in zip(observations, places, strict=True)]
        ).tolist()
        in squares
    )
    for one in found:
        assert one.frame.angle == heading and one.residual == 0
        assert one.how == "misled" and one.prior_cost >= 0
        assert not count_contradictions(one.frame, corrected(one, observations))


def test_a_larger_part_of_the_square_is_a_likelier_origin() -> None:
    """A wall blocked the walk two squares early; nothing tells the row from which the last observation was made."""
    room = world_of(["b" * 40, *["b" + "." * 30 + "b" * 9] * 70, "b" * 40])
    seen = [count_ranges(impression(room, square).retina) for square in ((20, 35), (30, 35), (26, 35))]
    observations = [
        Observation(ranges, place) for ranges, place in zip(seen, [(0.0, 0.0), (12.0, 0.0), (7.6, 0.3)], strict=True)
    ]
    found = blocked_walks_with_origin([StraightMotion(1, (12.0, 0.0), CENTRED_HYPOTHESES)], Frame(), observations)
    shares = [len(one.hypotheses) / len(COARSE_ORIGINS) for one in found]
    assert len(set(shares)) > 1
    for one, share in zip(found, shares, strict=True):
        assert one.prior_cost == pytest.approx(OFF_CENTRE_COST - math.log(share))
    again = blocked_walks_with_origin(
        [StraightMotion(1, (12.0, 0.0), CENTRED_HYPOTHESES)], Frame(0, (0.4, 0.5)), observations
    )  # the origin is known
    assert [one.prior_cost for one in again] == pytest.approx([one.prior_cost - OFF_CENTRE_COST for one in found])


def test_a_walk_that_met_nothing_is_not_reestimated() -> None:
    occupied = world_of(["." * 80] * 80)
    seen = [count_ranges(impression(occupied, (x, 40)).retina) for x in (30, 35)]
    observations = [Observation(seen[0], (0.0, 0.0)), Observation(seen[1], (5.0, 0.0))]
    assert (
        blocked_walks_with_origin([StraightMotion(1, (5.0, 0.0), CENTRED_HYPOTHESES[:1])], Frame(), observations) == []
    )
