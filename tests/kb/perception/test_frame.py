"""Rigid-motion laws of the frames, and the sampled squares against the formula of the senses."""

import math
from collections import Counter

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.kb.eyes import sampled
from utak.geometry.counts.retina import FIELDS, OWN_FIELD
from utak.kb.body import DIRECTIONS
from utak.kb.perception.frame import MAX_SAMPLED_SQUARES, SAMPLING_TIE_TOLERANCE, Frame, turned
from utak.simulator.world.senses import Senses

length = st.floats(-100, 100).map(lambda v: round(v, 6))
vector = st.tuples(length, length)
degrees = st.integers(-720, 720)
frames = st.builds(Frame, st.integers(-44, 45), st.tuples(st.floats(0, 1), st.floats(0, 1)))


@given(vector, degrees, degrees)
def test_turns_add_up(v: tuple[float, float], a: int, b: int) -> None:
    assert turned(*turned(*v, a), b) == pytest.approx(turned(*v, a + b), abs=1e-9)


@given(vector, vector, degrees)
def test_a_turn_keeps_lengths_and_sense(v: tuple[float, float], w: tuple[float, float], a: int) -> None:
    p, q = turned(*v, a), turned(*w, a)
    assert math.hypot(*p) == pytest.approx(math.hypot(*v), abs=1e-9)
    assert p[0] * q[1] - p[1] * q[0] == pytest.approx(v[0] * w[1] - v[1] * w[0], abs=1e-8)


@given(st.integers(-50, 50), st.integers(-50, 50), st.integers(-8, 8))
def test_quarter_turns_are_exact(x: int, y: int, quarters: int) -> None:
    want = complex(x, y) * (1j) ** (quarters % 4)
    assert turned(x, y, 90 * quarters) == (round(want.real), round(want.imag))


@given(vector, frames)
def test_a_vector_and_its_way_back_are_the_same(v: tuple[float, float], frame: Frame) -> None:
    assert frame.to_utak(*frame.to_map(*v)) == pytest.approx(v, abs=1e-9)
    assert frame.place_to_utak(*frame.place_from_utak(*v)) == pytest.approx(v, abs=1e-9)


@given(vector, vector, frames)
def test_places_differ_by_vectors(p: tuple[float, float], v: tuple[float, float], frame: Frame) -> None:
    x, y = frame.place_from_utak(*p)
    dx, dy = frame.to_map(*v)
    assert frame.place_from_utak(p[0] + v[0], p[1] + v[1]) == pytest.approx((x + dx, y + dy), abs=1e-9)
    assert frame.place_from_utak(0, 0) == pytest.approx(frame.origin)


def is_tie(east: int, north: int, angle: int) -> bool:
    """Return whether an offset falls so close to the line between two squares that either may be sampled."""
    c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    return any(abs(abs(v) % 1 - 0.5) < SAMPLING_TIE_TOLERANCE for v in (east * c - north * s, east * s + north * c))


@pytest.mark.parametrize("angle", range(-44, 46))
def test_samples_are_those_of_the_senses(angle: int) -> None:
    samples = Frame(angle).samples()
    for number, (east, north, side) in enumerate(FIELDS):
        offsets = [(e, n) for e in range(east, east + side) for n in range(north, north + side)]
        ties = [offset for offset in offsets if is_tie(*offset, angle)]
        want = Counter(sampled(*offset, angle) for offset in offsets if offset not in ties)
        row = zip(samples.columns[number], samples.rows[number], samples.weight[number], strict=True)
        found = {(int(c), int(r)): int(w) for c, r, w in row if w}
        assert found == ({} if number == OWN_FIELD else want)
        assert samples.slack[number] == (0 if number == OWN_FIELD else len(ties))


@pytest.mark.parametrize("angle", [0, 45, -30])
def test_every_field_is_accounted_for(angle: int) -> None:
    samples = Frame(angle).samples()
    assert samples.columns.shape == samples.rows.shape == samples.weight.shape == (160, MAX_SAMPLED_SQUARES)
    area = np.array([field.side**2 for field in FIELDS])
    area[OWN_FIELD] = 0
    assert (samples.weight.sum(1) + samples.slack == area).all()


def test_without_rotation_every_square_is_sampled_once() -> None:
    samples = Frame(0).samples()
    assert samples.weight.max() == 1
    assert samples.weight.sum() == 32 * 32 - 1


@pytest.mark.long
@pytest.mark.parametrize("angle", range(-44, 46))
def test_a_direction_names_the_square_that_the_senses_mean_at_any_orientation(angle: int) -> None:
    frame = Frame(angle)
    for direction in DIRECTIONS:
        meant = set()
        for quarters in range(4):
            senses = Senses((angle + 90 * quarters) % 360)
            i, j = senses.adjacent((0.5, 0.5), direction)
            for _ in range(quarters):
                i, j = j, -i
            meant.add((i, j))
        named = frame.beside(direction)
        assert meant == {named} if named is not None else len(meant) > 1 or abs(angle) == 30
    assert all(frame.beside(direction) == square for square, direction in frame.directions().items())
    assert {(1, 0), (0, 1), (-1, 0), (0, -1)} <= frame.directions().keys()
