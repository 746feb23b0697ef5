"""The probability that something stands on a square, and that a motion meets it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from utak.geometry.counts import gibbs
from utak.geometry.counts.gibbs import DRAWN
from utak.kb.mapping.completions import MAX_COMPLETIONS, Completions
from utak.kb.mapping.obstacle_chance import (
    ERROR_PROBABILITY,
    ERROR_PROBABILITY_AT_EDGE,
    UNSEEN_PROBABILITY,
    ObstacleChance,
)
from utak.kb.mapping.occupancy import FREE, OCCUPIED, OPEN, OccupancyMap

SIDE = 5
images = arrays(np.int8, (MAX_COMPLETIONS, SIDE, SIDE), elements=st.integers(0, 1))
squares = st.tuples(st.integers(0, SIDE - 1), st.integers(0, SIDE - 1))


def of(shown: np.ndarray, unseen: list[tuple[int, int]] = []) -> Completions:  # noqa: B006
    """Return completions of the squares (0, 0) to (4, 4) of the map frame, all of which are open."""
    ground = np.full((SIDE, SIDE), DRAWN, np.int8)
    for x, y in unseen:
        ground[y, x] = gibbs.UNSEEN_SQUARE
    return Completions(0, 0, ground, shown, {})


@given(images, st.lists(squares, min_size=1, max_size=6, unique=True))
def test_the_probabilities_of_first_obstacles_add_up_to_at_most_one(
    shown: np.ndarray, way: list[tuple[int, int]]
) -> None:
    met = ObstacleChance(OccupancyMap(), of(shown)).met([[square] for square in way])
    assert all(0 <= chance <= 1 for chance in met)
    free = 1 - np.mean(
        [any(image[y, x] for x, y in way) for image in shown]
    )  # the share of completions that show nothing there
    assert 1 - sum(met) == pytest.approx(free, abs=1.01 * ERROR_PROBABILITY_AT_EDGE * len(way))


def test_squares_of_one_completion_go_together() -> None:
    shown = np.zeros((MAX_COMPLETIONS, SIDE, SIDE), np.int8)
    shown[: MAX_COMPLETIONS // 2, 2, :] = 1  # a wall, in half of them
    along = ObstacleChance(OccupancyMap(), of(shown)).met([[(x, 2)] for x in range(SIDE)])
    assert along[0] == pytest.approx(0.5, abs=0.02)
    assert sum(along[1:]) < 0.05
    assert ObstacleChance(OccupancyMap(), of(shown)).met([[(x, 2) for x in range(SIDE)]])[0] == pytest.approx(
        0.5, abs=0.06
    )


def test_completions_do_not_change_settled_squares() -> None:
    occupancy, shown = OccupancyMap(), np.ones((MAX_COMPLETIONS, SIDE, SIDE), np.int8)
    occupancy.state[occupancy.index(1, 1)] = FREE
    occupancy.state[occupancy.index(3, 3)] = OCCUPIED
    assert ObstacleChance(occupancy, of(shown * 0)).met([[(1, 1)], [(3, 3)]]) == [0.0, 1.0]
    assert ObstacleChance(occupancy, of(shown)).met([[(1, 1)], [(3, 3)]]) == [0.0, 1.0]


def test_squares_that_no_completion_shows_are_nearly_free() -> None:
    shown = np.zeros((MAX_COMPLETIONS, SIDE, SIDE), np.int8)
    shown[0, 2, 2] = 1
    outlook = ObstacleChance(OccupancyMap(), of(shown, [(4, 4)]))
    assert outlook.occupied((0, 0)).tolist() == [ERROR_PROBABILITY] * MAX_COMPLETIONS
    assert outlook.occupied((1, 2)).tolist() == [ERROR_PROBABILITY_AT_EDGE] * MAX_COMPLETIONS
    assert outlook.occupied((4, 4)).tolist() == outlook.occupied((40, 40)).tolist() == UNSEEN_PROBABILITY.tolist()
    assert outlook.odds((2, 2)) > outlook.odds((1, 2)) > outlook.odds((0, 0))


def test_without_completions_the_counts_give_the_probability() -> None:
    occupancy = OccupancyMap()
    at = occupancy.index(2, 1)
    assert occupancy.state[at] == OPEN
    occupancy.logit[at] = 1.5
    outlook = ObstacleChance(occupancy)
    assert outlook.odds((2, 1)) == pytest.approx(1.5)
    assert outlook.met([[(2, 1)]]) == [pytest.approx(1 / (1 + np.exp(-1.5)))]


def test_unseen_squares_of_a_group_count_as_one() -> None:
    outlook = ObstacleChance(OccupancyMap(), of(np.zeros((MAX_COMPLETIONS, SIDE, SIDE), np.int8)))
    one, four = outlook.met([[(9, 0)]]), outlook.met([[(9, y) for y in range(4)]])
    assert one == four == UNSEEN_PROBABILITY.tolist()
    assert outlook.met([[(9, 0)], [(10, 0)]])[1] == pytest.approx(
        float(UNSEEN_PROBABILITY[0] * (1 - UNSEEN_PROBABILITY[0]))
    )
