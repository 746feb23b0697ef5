"""Where a motion crosses the lines between squares."""

import math
from itertools import pairwise

from hypothesis import assume, given
from hypothesis import strategies as st

from kb.stops import HAIR, crossings, next_square

AWAY = st.floats(-9, 9, allow_nan=False).map(lambda v: round(v, 3))
POINT = st.floats(0.05, 0.95).map(lambda v: round(v, 3) + 0.0003)


def passes_corner(x: float, y: float, east: float, north: float) -> bool:
    """Does a motion cross two lines nearly at once?"""
    parts = [(line - x) / east for line in range(-12, 13) if east] + [
        (line - y) / north for line in range(-12, 13) if north
    ]
    parts = sorted(part for part in parts if 0 < part < 1)
    return any(b - a < 1e-3 for a, b in pairwise(parts))


@given(POINT, POINT, AWAY, AWAY)
def test_the_squares_entered_are_those_on_the_way_in_their_order(x: float, y: float, east: float, north: float) -> None:
    assume(not passes_corner(x, y, east, north))
    met = [(0, 0)]
    for part in (n / 20000 for n in range(1, 20001)):
        square = math.floor(x + part * east), math.floor(y + part * north)
        if square != met[-1]:
            met.append(square)
    entered = [(0, 0)] + [crossing.entered for crossing in crossings((x, y), (east, north))]
    steps = [abs(a[0] - b[0]) + abs(a[1] - b[1]) for a, b in pairwise(entered)]
    assert set(steps) <= {1}
    assert set(met) <= set(entered)
    assert len(entered) <= abs(math.floor(x + east)) + abs(math.floor(y + north)) + 1


@given(POINT, POINT, AWAY, AWAY)
def test_a_line_has_a_square_on_either_side(x: float, y: float, east: float, north: float) -> None:
    assume(not passes_corner(x, y, east, north))
    here = (0, 0)
    for crossing in crossings((x, y), (east, north)):
        assert (math.floor(crossing.before[0]), math.floor(crossing.before[1])) == here
        assert (math.floor(crossing.after[0]), math.floor(crossing.after[1])) == crossing.entered
        assert math.dist(crossing.before, crossing.after) <= 2.1 * HAIR
        here = crossing.entered


def test_who_stays_in_his_square_crosses_nothing() -> None:
    assert crossings((0.5, 0.5), (0.4, -0.4)) == ()
    assert crossings((0.5, 0.5), (0.0, 0.0)) == ()


def test_the_square_ahead_lies_on_the_way() -> None:
    assert next_square((0.5, 0.5), (0.5, 9.5)) == (0, 1)
    assert next_square((0.5, 0.5), (-3.5, 0.5)) == (-1, 0)
