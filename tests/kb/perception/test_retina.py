"""The plan of the retina against its definition, and gray levels against brute force."""

from fractions import Fraction
from math import floor

import numpy as np
import pytest

from utak.geometry.counts.retina import FIELDS, OWN_FIELD, RETINA_REACH, field_plan
from utak.kb.perception.retina import count_ranges, level_counts

LEVELS = {1: [0, 7], 2: [0, 2, 4, 5, 7], 4: range(8)}  # by side of a field: the levels that it can show


def shown(side: int, occupied: int) -> int:
    """Return the gray level of a field with n occupied squares, in exact arithmetic."""
    return floor(Fraction(7 * occupied, side * side) + Fraction(1, 2))


@pytest.mark.parametrize("side", [1, 2, 4])
def test_counts_are_those_that_show_the_level(side: int) -> None:
    for level in LEVELS[side]:
        fitting = [n for n in range(side * side + 1) if shown(side, n) == level]
        assert level_counts(side, level) == (fitting[0], fitting[-1])
        assert fitting == list(range(fitting[0], fitting[-1] + 1))


@pytest.mark.parametrize("side", [1, 2, 4])
def test_a_level_that_no_count_shows_is_refused(side: int) -> None:
    possible = {shown(side, n) for n in range(side * side + 1)}
    assert possible == set(LEVELS[side])
    for level in set(range(-1, 10)) - possible:
        with pytest.raises(ValueError, match="never shows"):
            level_counts(side, level)


def test_the_fields_cover_every_offset_once() -> None:
    covered = [
        (east, north)
        for field in FIELDS
        for east in range(field.east, field.east + field.side)
        for north in range(field.north, field.north + field.side)
    ]
    assert sorted(covered) == [
        (e, n) for e in range(-RETINA_REACH, RETINA_REACH) for n in range(-RETINA_REACH, RETINA_REACH)
    ]
    assert [sum(f.side == side for f in FIELDS) for side in (1, 2, 4)] == [64, 48, 48]


def test_the_order_is_by_zones_from_north_west_on() -> None:
    keys = [(field.side, -field.north, field.east) for field in FIELDS]
    assert keys == sorted(keys)


def test_the_plan_names_the_field_of_each_offset() -> None:
    numbers = field_plan()
    for number, (east, north, side) in enumerate(FIELDS):
        rows, columns = np.nonzero(numbers == number)
        assert len(rows) == side * side
        assert (rows.min() - RETINA_REACH, columns.min() - RETINA_REACH) == (north, east)


def test_the_own_field_says_nothing() -> None:
    assert FIELDS[OWN_FIELD] == (0, 0, 1)
    ranges = count_ranges((7,) * 160)
    assert tuple(ranges[OWN_FIELD]) == (0, 1)
    others = np.delete(ranges, OWN_FIELD, axis=0)
    assert (others[:, 1] == np.delete([f.side**2 for f in FIELDS], OWN_FIELD)).all()
