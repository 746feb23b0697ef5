"""Odds that are computed late are the same as odds computed at once."""

import numpy as np
import pytest

from tests.kb.eyes import random_room, retina, world_of
from utak.kb.mapping.occupancy import OccupancyMap
from utak.kb.perception.frame import Frame
from utak.kb.perception.retina import count_ranges


@pytest.mark.parametrize("seed", [1, 2])
def test_it_does_not_matter_when_odds_are_computed(seed: int) -> None:
    rng = np.random.default_rng(seed)
    rows = random_room(rng, 60, 12, things=6)
    occupied, late, soon = world_of(rows), OccupancyMap(), OccupancyMap()
    for number, square in enumerate([(5, 5), (9, 6), (50, 5), (12, 4)]):  # the map grows on the way
        for occupancy in (late, soon):
            occupancy.observe(Frame(0).samples(), count_ranges(retina(occupied, square)), *square, number)
        if number == 1:
            for occupancy in (late, soon):
                occupancy.withdraw(np.flatnonzero(occupancy.seen)[::7].astype(np.int32))
        assert soon.logit.any()
    other = late.copy()
    other.observe(Frame(0).samples(), count_ranges(retina(occupied, (20, 5))), 20, 5, 4)
    assert (late.logit == soon.logit).all()
    assert not np.array_equal(other.logit, late.logit)
