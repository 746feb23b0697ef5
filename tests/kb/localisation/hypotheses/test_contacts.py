"""Contacts are where shapely says, in the order of the way."""

import itertools

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.affinity import rotate, translate

from utak.geometry.motion.se2 import Motion, Rotate, Translate
from utak.kb.localisation.hypotheses.contacts import Obstructions, contact_outcomes, likeliest_contact_near
from utak.kb.mapping.occupancy import FREE, OCCUPIED, OPEN, OccupancyMap

ELL = shapely.Polygon([(1, 0), (6, 0), (6, 2), (3, 2), (3, 5), (1, 5)])
UTAK = (0.5, 1.5)
STEPS = 400
Square = tuple[int, int]


def map_with(open_: dict[Square, float], full: list[Square]) -> OccupancyMap:
    """Return a map on which all is free but some open squares (with their log odds) and some occupied ones."""
    occupancy = OccupancyMap()
    occupancy.state[:] = FREE
    for square, odds in open_.items():
        occupancy.state[occupancy.index(*square)] = OPEN
        occupancy.logit[occupancy.index(*square)] = odds
    for square in full:
        occupancy.state[occupancy.index(*square)] = OCCUPIED
    return occupancy


def contact_by_steps(square: Square, motion: Motion) -> float:
    """Return the fraction of a motion after which the object enters a square, by trying with shapely alone."""
    box = shapely.box(square[0], square[1], square[0] + 1, square[1] + 1)
    for step in range(1, STEPS + 1):
        part = motion.part(step / STEPS)
        if isinstance(part, Rotate):
            moved, utak = rotate(ELL, part.degrees, origin=part.about), UTAK
        else:
            moved, utak = translate(ELL, part.dx, part.dy), (UTAK[0] + part.dx, UTAK[1] + part.dy)
        inside = square[0] < utak[0] < square[0] + 1 and square[1] < utak[1] < square[1] + 1
        if moved.intersection(box).area > 1e-7 or inside:
            return step / STEPS
    return 1.0


def apart(square: Square) -> bool:
    """Return whether a square lies neither under the object nor under Utak."""
    box = shapely.box(square[0], square[1], square[0] + 1, square[1] + 1)
    return not box.relate_pattern(ELL, "T********") and square != (0, 1)


SQUARES = st.tuples(st.integers(-8, 9), st.integers(-8, 9)).filter(apart)
MOTIONS = st.one_of(
    st.integers(-180, 180).filter(bool).map(lambda degrees: Rotate(float(degrees), UTAK)),
    st.tuples(st.integers(-6, 6), st.integers(-6, 6)).filter(any).map(lambda way: Translate(*map(float, way))),
)


@pytest.mark.long
@settings(max_examples=60, deadline=None)
@given(MOTIONS, st.dictionaries(SQUARES, st.floats(-4, 4), max_size=6), st.lists(SQUARES, max_size=2))
def test_a_motion_may_end_at_every_square_that_is_not_free(
    motion: Motion, open_: dict[Square, float], full: list[Square]
) -> None:
    open_ = {square: odds for square, odds in open_.items() if square not in full}
    stops = Obstructions(map_with(open_, full), UTAK, ELL, motion).contacts(UTAK, ELL, motion)
    end = min((contact_by_steps(square, motion) for square in full), default=1.0)
    for stop in stops:
        for square in stop.squares:
            assert stop.fraction == pytest.approx(contact_by_steps(square, motion), abs=1.5 / STEPS)
    before = {square for square in open_ if contact_by_steps(square, motion) < end - 2 / STEPS}
    assert {square for stop in stops for square in stop.squares} <= set(open_)
    assert len(before) >= len({stop.fraction for stop in stops if stop.fraction < end - 2 / STEPS}) >= bool(before)
    assert [stop.fraction for stop in stops] == sorted(stop.fraction for stop in stops)
    assert all(0.0 <= stop.fraction < 1.0 and 0.0 < stop.chance <= 1.0 for stop in stops)
    total, gone_on = sum(stop.chance for stop in stops), 1.0
    for square in open_:
        if contact_by_steps(square, motion) < end:
            gone_on /= 1.0 + np.exp(open_[square])
    assert total <= 1.0 + 1e-9
    if end < 1.0:
        assert total == pytest.approx(1.0)
    elif not any(abs(contact_by_steps(square, motion) - 1.0) < 2 / STEPS for square in open_):
        assert total == pytest.approx(1.0 - gone_on, abs=1e-6)


def test_the_likelier_contact_comes_first() -> None:
    squares = {(8, 0): -2.0, (9, 1): 2.0}
    motion = Translate(6.0, 0.0)
    obstructions = Obstructions(map_with(squares, []), UTAK, ELL, motion)
    first, second = contact_outcomes(obstructions.contacts(UTAK, ELL, motion), UTAK, ELL, motion)
    assert (first.contact_squares, second.contact_squares) == (frozenset({(9, 1)}), frozenset({(8, 0)}))
    assert first.polygon.bounds[2] == pytest.approx(9.0)
    assert second.polygon.bounds[2] == pytest.approx(8.0)
    assert first.distance == pytest.approx(3.0)
    assert {one.how for one in (first, second)} == {"blocked"}


def test_the_contact_near_an_end_is_found() -> None:
    motion = Translate(6.0, 0.0)
    obstructions = Obstructions(map_with({(8, 0): -2.0, (9, 1): 2.0}, []), UTAK, ELL, motion)
    for part, square in ((2 / 6, (8, 0)), (2.2 / 6, (8, 0)), (2.8 / 6, (9, 1))):
        stop = likeliest_contact_near(obstructions.contacts(UTAK, ELL, motion), UTAK, ELL, motion, part)
        assert stop is not None
        assert stop.squares == {square}
    assert likeliest_contact_near(obstructions.contacts(UTAK, ELL, motion), UTAK, ELL, motion, 2.5 / 6) is None
    assert Obstructions(map_with({}, []), UTAK, ELL, motion).contacts(UTAK, ELL, motion) == []


def test_squares_met_at_once_are_one_contact() -> None:
    flush = {(8, y): 0.0 for y in (0, 1)} | {(8, 5): 0.0}
    motion = Translate(3.0, 0.0)
    stops = Obstructions(map_with(flush, []), UTAK, ELL, motion).contacts(UTAK, ELL, motion)
    assert [(stop.squares, stop.chance) for stop in stops] == [(frozenset({(8, 0), (8, 1)}), pytest.approx(0.75))]
    assert all(a.fraction < b.fraction for a, b in itertools.pairwise(stops))
