"""How plain a table looks: by that it is told at the first look how the lattice lies under him."""

import numpy as np
import pytest

from geometry.sketch import CORNER
from kb.evidence import Evidence
from kb.heading import CENTRED, Hypothesis, Look
from kb.lattice import Lattice
from kb.plainness import LESS_LIKELY, UNTRIED, Sketch, plainness, weighed
from kb.retina import count_ranges
from tests.kb.drawings import LARGE_ROOM, drawing, looked
from tests.kb.eyes import impression, random_room, world_of

LOOKS = [(20, 20), (21, 22), (25, 24)]


def a_look(rng: np.random.Generator, heading: int) -> Look:
    occupied = world_of(random_room(rng, 36, 36, 6))
    free = [(i, j) for i in range(8, 28) for j in range(8, 28) if not occupied(i, j)]
    square = free[int(rng.integers(len(free)))]
    return Look(count_ranges(impression(occupied, square, heading).retina), (0.0, 0.0))


def cost(evidence: Evidence) -> float:
    sketch = Sketch(evidence)
    sketch.draw()
    return sketch.cost(0.0)


def likeliest(hypotheses: tuple[Hypothesis, ...]) -> int:
    return min(hypotheses, key=lambda h: h.dear).angle


def test_the_first_look_mostly_tells_how_the_lattice_lies() -> None:
    rng, off = np.random.default_rng(4), []
    for _ in range(24):
        heading = int(rng.integers(-44, 46))
        found = likeliest(weighed(CENTRED, [a_look(rng, heading)]))
        off.append(abs((found - heading + 45) % 90 - 45))
    assert sum(angle <= 2 for angle in off) >= 21


def test_one_is_the_plainest_and_what_was_not_tried_is_not_likely() -> None:
    found = weighed(CENTRED, [a_look(np.random.default_rng(2), 31)])
    assert [h.angle for h in found] == [h.angle for h in CENTRED]
    assert min(h.dear for h in found) == 0.0
    assert sum(h.dear == UNTRIED for h in found) > 25
    assert sum(h.is_plausible for h in found) <= 8


def test_only_the_likely_ones_are_weighed_again_until_they_are_given_up() -> None:
    rng = np.random.default_rng(3)
    look = a_look(rng, -20)
    first = weighed(CENTRED, [look])
    assert abs(likeliest(first) + 20) <= 2
    told = tuple(h._replace(dear=0.0 if h.angle == 7 else 40.0) for h in first)
    assert likeliest(weighed(told, [look])) == 7  # he was sure, and nothing else is asked
    without = tuple(h for h in told if h.angle != 7)
    assert abs(likeliest(weighed(without, [look])) + 20) <= 2


@pytest.mark.parametrize("room", [LARGE_ROOM, drawing(24, 24, 5, 5)])
def test_straight_walls_cost_nothing_however_far_they_are_seen(room: list[str]) -> None:
    near, far = cost(looked(room, LOOKS[:1])), cost(looked(room, LOOKS))
    corners = 4 + 4 * (room != LARGE_ROOM)
    assert near <= far + 1e-9
    assert far <= LESS_LIKELY * CORNER * corners + 1e-9


def test_a_look_from_elsewhere_than_believed_makes_a_table_crooked() -> None:
    room = drawing(24, 24, 5, 5)
    seen = count_ranges(impression(world_of(room), (25, 22)).retina)
    sketches = []
    for aside in (0, 1, 2):
        evidence = looked(room, LOOKS[:2])
        evidence.look(Lattice().samples(), seen, 5 + aside, 2, 2)
        sketches.append((Sketch(evidence), 0.0))
    prices = plainness(sketches)
    assert prices[0] == 0.0
    assert min(prices[1:]) > 2
