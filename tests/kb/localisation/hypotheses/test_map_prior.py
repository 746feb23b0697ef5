"""The map prior tells the orientation of the frame by the first observation."""

import math

import numpy as np
import pytest

from tests.kb.drawings import LARGE_ROOM, drawing, looked
from tests.kb.eyes import impression, random_room, world_of
from utak.geometry.counts.gibbs import CORNER_COST
from utak.kb.localisation.hypotheses.frames import (
    ALL_HYPOTHESES,
    CENTRED_HYPOTHESES,
    KEPT_ODDS,
    Hypothesis,
    Observation,
    consistent_hypotheses,
    prune_hypotheses,
)
from utak.kb.localisation.hypotheses.map_prior import (
    LOG_ODDS_PER_COST,
    REWEIGHED_ANGLES,
    UNTRIED_COST,
    MapDescription,
    _simplest,
    relative_costs,
    weigh_hypotheses,
)
from utak.kb.mapping.occupancy import OccupancyMap
from utak.kb.perception.frame import CENTRE, Frame
from utak.kb.perception.retina import count_ranges

LOOKS = [(20, 20), (21, 22), (25, 24)]
LONG_ROOM = ["b" * 80, *["b" * 2 + "." * 76 + "b" * 2] * 20, "b" * 80]
Point = tuple[float, float]


def random_observation(rng: np.random.Generator, heading: int) -> Observation:
    occupied = world_of(random_room(rng, 36, 36, 6))
    free = [(i, j) for i in range(8, 28) for j in range(8, 28) if not occupied(i, j)]
    square = free[int(rng.integers(len(free)))]
    return Observation(count_ranges(impression(occupied, square, heading).retina), (0.0, 0.0))


def cost(occupancy: OccupancyMap) -> float:
    sketch = MapDescription(occupancy)
    sketch.draw()
    return sketch.cost(0.0)


def likeliest(hypotheses: tuple[Hypothesis, ...]) -> int:
    return min(hypotheses, key=lambda h: h.prior_cost).angle


@pytest.mark.long
def test_the_first_observation_mostly_tells_the_orientation() -> None:
    rng, off = np.random.default_rng(4), []
    for _ in range(24):
        heading = int(rng.integers(-44, 46))
        found = likeliest(weigh_hypotheses(CENTRED_HYPOTHESES, [random_observation(rng, heading)]))
        off.append(abs((found - heading + 45) % 90 - 45))
    assert sum(angle <= 2 for angle in off) >= 21


def test_the_best_frame_costs_nothing_and_untried_frames_are_unlikely() -> None:
    found = weigh_hypotheses(CENTRED_HYPOTHESES, [random_observation(np.random.default_rng(2), 31)])
    assert [h.angle for h in found] == [h.angle for h in CENTRED_HYPOTHESES]
    assert min(h.prior_cost for h in found) == 0.0
    assert sum(h.prior_cost == UNTRIED_COST for h in found) > 25
    assert sum(h.prior_cost <= KEPT_ODDS for h in found) <= 8


@pytest.mark.long
def test_only_likely_frames_are_weighed_again_until_they_are_given_up() -> None:
    rng = np.random.default_rng(3)
    observation = random_observation(rng, -20)
    first = weigh_hypotheses(CENTRED_HYPOTHESES, [observation])
    assert abs(likeliest(first) + 20) <= 2
    told = tuple(h._replace(prior_cost=0.0 if h.angle == 7 else 40.0) for h in first)
    again = weigh_hypotheses(told, [observation])  # only the likely one and its neighbours are weighed
    assert abs(likeliest(again) - 7) <= REWEIGHED_ANGLES
    assert {h.angle for h in again if h.prior_cost < 40.0} <= {
        7 + step for step in range(-REWEIGHED_ANGLES, REWEIGHED_ANGLES + 1)
    }
    without = tuple(h for h in told if abs(h.angle - 7) > REWEIGHED_ANGLES)
    assert abs(likeliest(weigh_hypotheses(without, [observation])) + 20) <= 2


def observations_in_a_long_room(heading: int, origin: Point, seed: int) -> list[Observation]:
    """Return observations from random places of a long room. origin : within the square of waking."""
    room, rng = world_of(LONG_ROOM), np.random.default_rng(seed)
    true = Frame(heading, origin)
    places = [(0.0, 0.0), *(true.place_to_utak(*rng.uniform((-34, -8), (34, 8))) for _ in range(9))]
    observations = []
    for place in places:
        i, j = (math.floor(v) for v in true.place_from_utak(*place))
        observations.append(Observation(count_ranges(impression(room, (i + 40, j + 11), heading).retina), place))
    return observations


@pytest.mark.long
@pytest.mark.parametrize("heading", [-2, -1, 0, 1, 2])
def test_later_observations_correct_an_orientation_by_one_degree(heading: int) -> None:
    for seed in range(3):
        observations = observations_in_a_long_room(heading, CENTRE, seed)
        left: tuple[Hypothesis, ...] = tuple(h._replace(prior_cost=40.0 * (h.angle != 0)) for h in CENTRED_HYPOTHESES)
        for number in range(1, len(observations) + 1):
            left = weigh_hypotheses(prune_hypotheses(left, observations[:number]), observations[:number])
        assert likeliest(left) == heading


def test_a_single_observation_does_not_depend_on_the_origin() -> None:
    observation = observations_in_a_long_room(-7, (0.8, 0.3), 1)[0]._replace(place=(3.3, -2.2))
    left = consistent_hypotheses([observation], [h for h in ALL_HYPOTHESES if -12 < h.angle < 0])
    found = weigh_hypotheses(left, [observation])
    assert [h._replace(prior_cost=0.0) for h in found] == list(left)
    assert len(left) > 30
    assert len({h.prior_cost for h in found}) == len({h.angle for h in found}) == 11
    assert likeliest(found) in (-8, -7, -6)


def test_a_smaller_part_of_the_square_is_a_less_likely_origin() -> None:
    observations = observations_in_a_long_room(1, CENTRE, 0)[:4]
    own = Hypothesis(1, CENTRE * 2, prior_cost=1.0)
    half, whole = (
        weigh_hypotheses([Hypothesis(0, (0.4, 0.4, east, 0.6), prior_cost=1.0), own], observations)[0].prior_cost
        for east in (0.5, 0.6)
    )
    assert half == pytest.approx(whole + math.log(2))


@pytest.mark.parametrize("room", [LARGE_ROOM, drawing(24, 24, 5, 5)])
def test_straight_walls_cost_nothing_at_any_length(room: list[str]) -> None:
    near, far = cost(looked(room, LOOKS[:1])), cost(looked(room, LOOKS))
    corners = 4 + 4 * (room != LARGE_ROOM)
    assert near <= far + 1e-9
    assert far <= LOG_ODDS_PER_COST * CORNER_COST * corners + 1e-9


def test_an_observation_at_a_wrong_place_raises_the_cost_of_the_map() -> None:
    room = drawing(24, 24, 5, 5)
    seen = count_ranges(impression(world_of(room), (25, 22)).retina)
    maps = []
    for aside in (0, 1, 2):
        occupancy = looked(room, LOOKS[:2])
        occupancy.observe(Frame().samples(), seen, 5 + aside, 2, 2)
        maps.append(MapDescription(occupancy))
    costs = relative_costs(maps)
    assert costs[0] == 0.0
    assert min(costs[1:]) > 2


def test_a_scene_that_was_drawn_is_drawn_no_second_time() -> None:
    price = MapDescription(looked(LARGE_ROOM, LOOKS)).draw()
    drawn = _simplest.cache_info().misses
    assert MapDescription(looked(LARGE_ROOM, LOOKS)).draw() == price
    assert _simplest.cache_info().misses == drawn
