"""Walk outcomes: crossings of grid lines, and the squares on either side."""

import math
from itertools import pairwise

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from utak.kb.localisation.hypotheses.walk_outcomes import LINE_DISTANCE, entered_square, line_crossings

AWAY = st.floats(-9, 9, allow_nan=False).map(lambda v: round(v, 3))
POINT = st.floats(0.05, 0.95).map(lambda v: round(v, 3) + 0.0003)


def passes_corner(x: float, y: float, east: float, north: float) -> bool:
    """Return whether a motion crosses two grid lines nearly at once."""
    parts = [(line - x) / east for line in range(-12, 13) if east] + [
        (line - y) / north for line in range(-12, 13) if north
    ]
    parts = sorted(part for part in parts if 0 < part < 1)
    return any(b - a < 1e-3 for a, b in pairwise(parts))


@given(POINT, POINT, AWAY, AWAY)
def test_squares_are_entered_in_the_order_of_the_way(x: float, y: float, east: float, north: float) -> None:
    assume(not passes_corner(x, y, east, north))
    met = [(0, 0)]
    for part in (n / 20000 for n in range(1, 20001)):
        square = math.floor(x + part * east), math.floor(y + part * north)
        if square != met[-1]:
            met.append(square)
    entered = [(0, 0)] + [crossing.entered for crossing in line_crossings((x, y), (east, north))]
    steps = [abs(a[0] - b[0]) + abs(a[1] - b[1]) for a, b in pairwise(entered)]
    assert set(steps) <= {1}
    assert set(met) <= set(entered)
    assert len(entered) <= abs(math.floor(x + east)) + abs(math.floor(y + north)) + 1


@given(POINT, POINT, AWAY, AWAY)
def test_a_crossing_has_a_place_on_either_side_of_the_line(x: float, y: float, east: float, north: float) -> None:
    assume(not passes_corner(x, y, east, north))
    here = (0, 0)
    for crossing in line_crossings((x, y), (east, north)):
        assert (math.floor(crossing.before[0]), math.floor(crossing.before[1])) == here
        assert (math.floor(crossing.after[0]), math.floor(crossing.after[1])) == crossing.entered
        assert math.dist(crossing.before, crossing.after) <= 2.1 * LINE_DISTANCE
        here = crossing.entered


def test_a_motion_within_a_square_crosses_nothing() -> None:
    assert line_crossings((0.5, 0.5), (0.4, -0.4)) == ()
    assert line_crossings((0.5, 0.5), (0.0, 0.0)) == ()


@pytest.mark.parametrize("way", [(0.0, 9.0), (-4.0, 0.0), (3.0, -7.0), (5.0, 5.0)])
def test_both_places_at_a_line_enter_the_square_beyond_it(way: tuple[float, float]) -> None:
    end = (0.3 + way[0], 0.7 + way[1])
    for crossing in line_crossings((0.3, 0.7), way):
        assert entered_square(crossing.before, end) == entered_square(crossing.after, end) == crossing.entered


def test_no_square_is_entered_off_all_lines() -> None:
    assert entered_square((0.5, 0.5), (0.5, 9.5)) is None


@given(st.sampled_from([(1, 1), (1, -1), (-1, 1), (-1, -1)]), st.integers(1, 9))
def test_at_a_corner_the_observation_may_be_made_from_four_squares(way: tuple[int, int], far: int) -> None:
    met = line_crossings((0.5, 0.5), (way[0] * far, way[1] * far))
    assert len(met) == 3 * far
    for number in range(far):
        corner = [0.5 + side * (number + 0.5) for side in way]
        there = met[3 * number : 3 * number + 3]
        assert all(
            math.dist(place, corner) < 2 * LINE_DISTANCE
            for crossing in there
            for place in (crossing.before, crossing.after)
        )
        squares = {(math.floor(x), math.floor(y)) for crossing in there for x, y in (crossing.before, crossing.after)}
        beyond = number * way[0] + way[0], number * way[1] + way[1]
        assert squares == {(x, y) for x in (beyond[0] - way[0], beyond[0]) for y in (beyond[1] - way[1], beyond[1])}
        assert there[2].entered == beyond
        assert there[0].before == there[1].before
