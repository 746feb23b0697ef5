"""How plain a table looks: by that it is told at the first look how the lattice lies under him."""

import math

import numpy as np
import pytest

from geometry.counts.gibbs import CORNER
from kb.localisation.hypotheses.frames import (
    ALL_HYPOTHESES,
    CENTRED_HYPOTHESES,
    FrameHypothesis,
    Observation,
    consistent_hypotheses,
    prune_hypotheses,
)
from kb.localisation.hypotheses.map_prior import (
    LOG_ODDS_PER_COST,
    REWEIGHED_ANGLES,
    UNTRIED_COST,
    MapDescription,
    relative_costs,
    weigh_hypotheses,
)
from kb.mapping.occupancy import OccupancyMap
from kb.perception.frame import CENTRE, Frame
from kb.perception.retina import count_ranges
from tests.kb.drawings import LARGE_ROOM, drawing, looked
from tests.kb.eyes import impression, random_room, world_of

LOOKS = [(20, 20), (21, 22), (25, 24)]
LONG_ROOM = ["b" * 80, *["b" * 2 + "." * 76 + "b" * 2] * 20, "b" * 80]
Point = tuple[float, float]


def a_look(rng: np.random.Generator, heading: int) -> Observation:
    occupied = world_of(random_room(rng, 36, 36, 6))
    free = [(i, j) for i in range(8, 28) for j in range(8, 28) if not occupied(i, j)]
    square = free[int(rng.integers(len(free)))]
    return Observation(count_ranges(impression(occupied, square, heading).retina), (0.0, 0.0))


def cost(occupancy: OccupancyMap) -> float:
    sketch = MapDescription(occupancy)
    sketch.draw()
    return sketch.cost(0.0)


def likeliest(hypotheses: tuple[FrameHypothesis, ...]) -> int:
    return min(hypotheses, key=lambda h: h.prior_cost).angle


def test_the_first_look_mostly_tells_how_the_lattice_lies() -> None:
    rng, off = np.random.default_rng(4), []
    for _ in range(24):
        heading = int(rng.integers(-44, 46))
        found = likeliest(weigh_hypotheses(CENTRED_HYPOTHESES, [a_look(rng, heading)]))
        off.append(abs((found - heading + 45) % 90 - 45))
    assert sum(angle <= 2 for angle in off) >= 21


def test_one_is_the_plainest_and_what_was_not_tried_is_not_likely() -> None:
    found = weigh_hypotheses(CENTRED_HYPOTHESES, [a_look(np.random.default_rng(2), 31)])
    assert [h.angle for h in found] == [h.angle for h in CENTRED_HYPOTHESES]
    assert min(h.prior_cost for h in found) == 0.0
    assert sum(h.prior_cost == UNTRIED_COST for h in found) > 25
    assert sum(h.is_plausible for h in found) <= 8


def test_only_the_likely_ones_are_weighed_again_until_they_are_given_up() -> None:
    rng = np.random.default_rng(3)
    observation = a_look(rng, -20)
    first = weigh_hypotheses(CENTRED_HYPOTHESES, [observation])
    assert abs(likeliest(first) + 20) <= 2
    told = tuple(h._replace(prior_cost=0.0 if h.angle == 7 else 40.0) for h in first)
    again = weigh_hypotheses(told, [observation])  # he was sure, and nothing else is asked
    assert abs(likeliest(again) - 7) <= REWEIGHED_ANGLES
    assert {h.angle for h in again if h.prior_cost < 40.0} <= {
        7 + step for step in range(-REWEIGHED_ANGLES, REWEIGHED_ANGLES + 1)
    }
    without = tuple(h for h in told if abs(h.angle - 7) > REWEIGHED_ANGLES)
    assert abs(likeliest(weigh_hypotheses(without, [observation])) + 20) <= 2


def strolled(heading: int, origin: Point, seed: int) -> list[Observation]:
    """Looks from here and there in a long room. woke : where in his square."""
    room, rng = world_of(LONG_ROOM), np.random.default_rng(seed)
    true = Frame(heading, origin)
    places = [(0.0, 0.0), *(true.place_to_utak(*rng.uniform((-34, -8), (34, 8))) for _ in range(9))]
    observations = []
    for place in places:
        i, j = (math.floor(v) for v in true.place_from_utak(*place))
        observations.append(Observation(count_ranges(impression(room, (i + 40, j + 11), heading).retina), place))
    return observations


@pytest.mark.parametrize("heading", [-2, -1, 0, 1, 2])
def test_a_degree_shows_by_and_by_however_sure_he_was_at_first(heading: int) -> None:
    for seed in range(3):
        observations = strolled(heading, CENTRE, seed)
        left: tuple[FrameHypothesis, ...] = tuple(
            h._replace(prior_cost=40.0 * (h.angle != 0)) for h in CENTRED_HYPOTHESES
        )
        for number in range(1, len(observations) + 1):
            left = weigh_hypotheses(prune_hypotheses(left, observations[:number]), observations[:number])
        assert likeliest(left) == heading


def test_where_in_his_square_he_woke_is_nothing_to_a_single_look() -> None:
    observation = strolled(-7, (0.8, 0.3), 1)[0]._replace(place=(3.3, -2.2))
    left = consistent_hypotheses([observation], [h for h in ALL_HYPOTHESES if -12 < h.angle < 0])
    found = weigh_hypotheses(left, [observation])
    assert [h._replace(prior_cost=0.0) for h in found] == list(left)
    assert len(left) > 30
    assert len({h.prior_cost for h in found}) == len({h.angle for h in found}) == 11
    assert likeliest(found) in (-8, -7, -6)


def test_the_less_is_left_of_his_square_the_less_likely_he_woke_elsewhere_than_amid_it() -> None:
    observations = strolled(1, CENTRE, 0)[:4]
    own = FrameHypothesis(1, CENTRE * 2, prior_cost=1.0)
    half, whole = (
        weigh_hypotheses([FrameHypothesis(0, (0.4, 0.4, east, 0.6), prior_cost=1.0), own], observations)[0].prior_cost
        for east in (0.5, 0.6)
    )
    assert half == pytest.approx(whole + math.log(2))


@pytest.mark.parametrize("room", [LARGE_ROOM, drawing(24, 24, 5, 5)])
def test_straight_walls_cost_nothing_however_far_they_are_seen(room: list[str]) -> None:
    near, far = cost(looked(room, LOOKS[:1])), cost(looked(room, LOOKS))
    corners = 4 + 4 * (room != LARGE_ROOM)
    assert near <= far + 1e-9
    assert far <= LOG_ODDS_PER_COST * CORNER * corners + 1e-9


def test_a_look_from_elsewhere_than_believed_makes_a_table_crooked() -> None:
    room = drawing(24, 24, 5, 5)
    seen = count_ranges(impression(world_of(room), (25, 22)).retina)
    sketches = []
    for aside in (0, 1, 2):
        occupancy = looked(room, LOOKS[:2])
        occupancy.observe(Frame().samples(), seen, 5 + aside, 2, 2)
        sketches.append((MapDescription(occupancy), 0.0))
    prices = relative_costs(sketches)
    assert prices[0] == 0.0
    assert min(prices[1:]) > 2
