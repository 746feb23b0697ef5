"""Recognition: where a look fits on a known map, and when that is not decided."""

import math

import numpy as np
import pytest

from utak.kb.localisation.hypotheses.recognition import Look, mean_likelihood, narrowed, places_within, recognise
from utak.kb.mapping.occupancy import OccupancyMap

SHAPE = OccupancyMap().state.shape


def look(*best: tuple[int, int, float], away: tuple[float, float] = (0.0, 0.0)) -> Look:
    """Return a look that favours squares (x, y) of the map frame by some nats, and no other one."""
    scores, occupancy = np.full(SHAPE, -100.0, np.float32), OccupancyMap()
    for x, y, nats in best:
        scores[occupancy.index(x, y)] = nats
    return Look(scores, away)


def test_a_place_that_leads_is_recognised_to_within_its_square() -> None:
    found = recognise(OccupancyMap(), [look((3, -2, 60.0), (9, 9, 40.0))])
    assert found is not None
    assert found.place == (3.5, -1.5) and found.error == (-0.5, -0.5, 0.5, 0.5)


def test_two_places_that_fit_as_well_are_not_decided_and_nor_is_a_poor_one() -> None:
    assert recognise(OccupancyMap(), [look((3, -2, 60.0), (9, 9, 55.0))]) is None
    assert recognise(OccupancyMap(), [look((3, -2, 12.0))]) is None


def test_a_second_look_decides_and_tells_where_in_the_square() -> None:
    first = look((3, -2, 60.0), (9, 9, 60.0))
    second = look((5, -2, 60.0), (9, 0, 60.0), away=(1.75, 0.0))
    found = recognise(OccupancyMap(), [first, second])
    assert found is not None
    west, _, east, _ = found.error
    assert (found.place[0] + west, found.place[0] + east) == pytest.approx((5.0, 5.75))


def test_the_mean_likelihood_is_between_nothing_known_and_the_best_place() -> None:
    assert mean_likelihood(np.zeros((2, 2), np.float32)) == pytest.approx(math.log(0.5))
    assert 50 < mean_likelihood(look((0, 0, 60.0)).scores) < 60


def test_a_place_known_within_an_error_is_narrowed_to_squares_that_fit() -> None:
    error = (-0.5, -0.5, 0.5, 0.5)
    near = places_within((2.25, 3.5), error)
    assert [(math.floor(x), math.floor(y)) for x, y in near] == [(2, 3), (1, 3)]
    place, left = narrowed((2.25, 3.5), error, [near[1]])
    assert place == (1.875, 3.5) and left == (-0.125, -0.5, 0.125, 0.5)
    assert narrowed((2.25, 3.5), error, [(7.5, 3.5)]) == ((7.5, 3.5), (0.0, 0.0, 0.0, 0.0))
