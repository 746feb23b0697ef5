"""Re-estimation of blocked walks: the truth is among the proposals, and nothing contradicts any of them."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from tests.kb.eyes import impression, random_room, world_of
from tests.kb.localisation.hypotheses.test_walk_outcomes import passes_corner
from utak.kb.localisation.hypotheses.frames import CENTRED_HYPOTHESES, Observation, count_contradictions
from utak.kb.localisation.hypotheses.reestimation import reestimate_walk
from utak.kb.localisation.hypotheses.walk_outcomes import LINE_DISTANCE, StraightMotion, line_crossings
from utak.kb.perception.frame import Frame, turned
from utak.kb.perception.retina import count_ranges


@pytest.mark.long
@settings(max_examples=15, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_the_true_end_of_a_blocked_walk_is_among_its_reestimations(seed: int) -> None:
    """A wall blocked a motion that is believed to have gone as commanded; another motion follows."""
    rng = np.random.default_rng(seed)
    occupied, heading = world_of(random_room(rng, 26, 26, 8)), int(rng.integers(-44, 46))
    squares = [(i, j) for i in range(3, 23) for j in range(3, 23)]
    free = [(i, j) for i, j in squares if not occupied(i, j)]
    x, y = free[int(rng.integers(len(free)))]
    way = (float(rng.uniform(-14, 14)), float(rng.uniform(-14, 14)))
    met = line_crossings((x + 0.5, y + 0.5), turned(*way, heading))
    stop = next((crossing for crossing in met if occupied(*crossing.entered)), None)
    assume(stop is not None and not passes_corner(0.5, 0.5, *turned(*way, heading)))
    assert stop is not None
    frame = Frame(heading)
    own = frame.place_to_utak(stop.before[0] - x, stop.before[1] - y)  # of a frame with the true origin
    back = (-own[0], -own[1])
    truth = [(0.0, 0.0), own, (own[0] + 0.5 * back[0], own[1] + 0.5 * back[1])]
    observations = []
    for place, shift in zip(truth, [(0.0, 0.0), *[(way[0] - own[0], way[1] - own[1])] * 2], strict=True):
        i, j = (math.floor(v) for v in frame.place_from_utak(*place))
        seen = count_ranges(impression(occupied, (i + x, j + y), heading).retina)
        observations.append(Observation(seen, (place[0] + shift[0], place[1] + shift[1])))
    assume(math.dist(own, way) > 2 * LINE_DISTANCE)
    found = list(reestimate_walk(StraightMotion(1, way, CENTRED_HYPOTHESES), Frame(), observations))
    told = [(one, one.correction.observations(observations)) for one in found if one.correction is not None]
    assert len(told) == len(found)
    right = [one for one, there in told if one.frame.angle == heading and math.dist(there[1].place, own) < 1e-3]
    assert right
    assert all(one.correction and one.correction.since == 1 and one.residual == 0 for one in right)
    for one, there in told:
        assert not count_contradictions(one.frame, there)
        assert there[0] == observations[0]
        assert math.dist(there[2].place, observations[2].place) > LINE_DISTANCE


def test_a_walk_that_met_nothing_is_not_reestimated() -> None:
    occupied = world_of(["." * 80] * 80)
    seen = [count_ranges(impression(occupied, (x, 40)).retina) for x in (30, 35)]
    observations = [Observation(seen[0], (0.0, 0.0)), Observation(seen[1], (5.0, 0.0))]
    told = list(reestimate_walk(StraightMotion(1, (5.0, 0.0), CENTRED_HYPOTHESES[:1]), Frame(), observations))
    assert told == []
