"""Parts that stick out into the floor are found wherever they touch a wall, and touch separates things from walls."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from utak.geometry.raster.components import components
from utak.kb.perception.protrusions import (
    MAX_THING_LENGTH,
    joined_through_walls,
    protrusions,
    separate_things,
    untouched_parts,
    with_embedded_things,
)

Mask = NDArray[np.bool_]
WIDE, HIGH = 24, 20


def room() -> Mask:
    """Return the squares of the walls of a room, two squares thick."""
    walls = np.ones((HIGH, WIDE), np.bool_)
    walls[2:-2, 2:-2] = False
    return walls


def with_thing(row: int, column: int, shape: Mask) -> tuple[Mask, Mask]:
    """Return the squares that are occupied, and those of the thing alone."""
    thing = np.zeros((HIGH, WIDE), np.bool_)
    thing[row : row + shape.shape[0], column : column + shape.shape[1]] = shape
    return room() | thing, thing


def sticking_out(occupied: Mask) -> list[Mask]:
    return protrusions(~occupied, occupied, np.ones_like(occupied))


def full(high: int, wide: int) -> Mask:
    return np.ones((high, wide), np.bool_)


ELL = np.array([[1, 1, 1, 1], [1, 0, 0, 0], [1, 0, 0, 0]], np.bool_)


def among(masks: list[Mask], thing: Mask) -> bool:
    return any(np.array_equal(mask, thing) for mask in masks)


@given(st.integers(1, MAX_THING_LENGTH), st.integers(1, MAX_THING_LENGTH), st.integers(3, 10), st.sampled_from("nesw"))
@settings(max_examples=80, deadline=None)
def test_a_thing_against_a_wall_is_found(high: int, wide: int, along: int, wall: str) -> None:
    row = {"n": HIGH - 2 - high, "s": 2}.get(wall, along)
    column = {"e": WIDE - 2 - wide, "w": 2}.get(wall, along)
    row, column = min(row, HIGH - 2 - high), min(column, WIDE - 2 - wide)
    occupied, thing = with_thing(row, column, full(high, wide))
    assert among(sticking_out(occupied), thing)


@given(st.integers(1, MAX_THING_LENGTH), st.integers(1, MAX_THING_LENGTH), st.booleans(), st.booleans())
@settings(max_examples=40, deadline=None)
def test_a_thing_in_a_corner_is_found(high: int, wide: int, up: bool, on: bool) -> None:
    occupied, thing = with_thing(HIGH - 2 - high if up else 2, WIDE - 2 - wide if on else 2, full(high, wide))
    assert among(sticking_out(occupied), thing)


@pytest.mark.parametrize("quarter", range(4))
def test_an_ell_against_a_wall_is_found(quarter: int) -> None:
    shape = np.rot90(ELL, quarter)
    occupied, thing = with_thing(2, 8, shape)
    assert among(sticking_out(occupied), thing)


@given(st.integers(0, 3), st.booleans(), st.booleans(), st.integers(1, 4), st.integers(1, 3))
@settings(max_examples=60, deadline=None)
def test_an_ell_in_a_corner_is_found(quarter: int, up: bool, on: bool, arm: int, thick: int) -> None:
    shape = np.zeros((thick + arm, thick + arm + 1), np.bool_)
    shape[:thick] = shape[:, :thick] = True
    shape = np.rot90(shape, quarter)
    high, wide = shape.shape
    occupied, thing = with_thing(HIGH - 2 - high if up else 2, WIDE - 2 - wide if on else 2, shape)
    assume(components(~occupied).number == 1)  # else a part of the floor is enclosed, which is never seen
    assert among(sticking_out(occupied), thing)


def test_free_standing_and_long_parts_do_not_stick_out() -> None:
    occupied, _ = with_thing(8, 8, full(3, 3))
    occupied[2:15, 18:20] = True  # a wall into the room
    assert sticking_out(occupied) == []


def test_touch_separates_a_thing_from_a_piece_of_wall() -> None:
    occupied, thing = with_thing(2, 6, full(3, 4))
    occupied[2:5, 16:18] = True
    parts = sticking_out(occupied)
    assert len(parts) == 2
    (told,) = separate_things(parts, {(4, 7): "g", (3, 9): "g", (1, 5): "b", (4, 16): "b"})
    assert np.array_equal(told, thing)
    assert separate_things(parts, {(4, 7): "b", (4, 16): "b"}) == []
    assert separate_things(parts, {}) == []


def test_the_smallest_part_with_a_felt_square_is_the_thing() -> None:
    occupied, thing = with_thing(4, 2, full(3, 3))
    occupied[7:9, 2:5] = True  # a piece of wall next to it
    parts = sticking_out(occupied)
    assert among(separate_things([thing, *parts], {(5, 4): "g"}), thing)
    both = [part for part in parts if part[5, 4] and part[8, 4]]
    assert both and not among(separate_things(both, {(5, 4): "g", (8, 4): "b"}), both[0])


def test_a_larger_part_is_the_thing_if_more_of_it_was_felt() -> None:
    shape = np.zeros((6, 7), np.bool_)
    shape[3:, :] = shape[:, :3] = True  # steps down from the wall to the north to that to the west
    occupied, thing = with_thing(HIGH - 8, 2, shape)
    parts, on_stem, on_foot = sticking_out(occupied), (HIGH - 8, 3), (HIGH - 4, 8)
    (stem,) = separate_things(parts, {on_stem: "g"})
    assert stem.sum() < thing.sum()
    rest = untouched_parts(parts, {on_stem: "g"})
    assert among(rest, thing & ~stem)
    (whole,) = separate_things(parts, {on_stem: "g", on_foot: "g"})
    assert np.array_equal(whole, thing)
    assert not among(untouched_parts(parts, {on_stem: "g", on_foot: "g"}), thing)
    (alone,) = separate_things(parts, {on_stem: "g", on_foot: "b"})
    assert np.array_equal(alone, stem)
    assert len(separate_things(parts, {on_stem: "g", on_foot: "h"})) == 2


def test_a_slanted_thing_sticks_out_between_open_squares() -> None:
    occupied, thing = with_thing(2, 8, np.array([[1, 1, 1, 1], [0, 1, 1, 1], [0, 1, 1, 0]], np.bool_))
    vague = np.zeros_like(occupied)
    vague[3, 8] = vague[4, 11] = vague[2, 12] = True
    parts = protrusions(~occupied & ~vague, occupied, np.ones_like(occupied))
    assert among(parts, thing)


def test_a_thing_in_a_corner_is_separated_from_the_thin_wall_that_it_touches() -> None:
    shape = np.zeros((6, 5), np.bool_)
    shape[:3, :] = shape[:, 2:] = True
    occupied, thing = with_thing(2, 2, shape)
    occupied = np.pad(occupied, ((9, 0), (0, 0)))
    occupied[:2] = occupied[:, :2] = occupied[:, -2:] = True  # another room to the south, and the wall between
    occupied[9:11, 12:16] = False
    parts = sticking_out(occupied)
    assert among(parts, np.pad(thing, ((9, 0), (0, 0))))


def test_what_was_felt_in_a_straight_wall_is_a_thing_of_the_felt_squares() -> None:
    felt = {(5, 1): "b", (6, 1): "g", (7, 1): "g", (8, 1): "k", (10, 1): "g"}
    found = with_embedded_things([], felt, room())
    assert [sorted(map(tuple, np.argwhere(thing).tolist())) for thing in found] == [
        [(6, 1), (7, 1)],
        [(10, 1)],
        [(8, 1)],
    ]


def test_what_was_felt_on_three_sides_of_a_thing_before_a_wall_is_all_of_it() -> None:
    occupied, thing = with_thing(6, 2, full(3, 3))
    felt = {(row, column): "g" for row, column in np.argwhere(thing).tolist() if row != 7 or column != 3}
    (whole,) = with_embedded_things([], felt, occupied)
    assert (whole == thing).all()
    (part,) = with_embedded_things([], {**felt, (7, 3): "k"}, occupied)[:1]  # another thing is within it
    assert not part[7, 3]


def test_what_was_felt_beside_a_thing_of_its_colour_belongs_to_it() -> None:
    occupied, thing = with_thing(6, 2, full(4, 3))
    felt = {(6, 4): "g", (6, 1): "g", (9, 1): "g", (5, 1): "b"}
    (whole,) = with_embedded_things([thing], felt, occupied)
    assert sorted({tuple(s) for s in np.argwhere(whole & ~thing).tolist()}) == [(row, 1) for row in range(6, 10)]
    (part,) = with_embedded_things([thing], {**felt, (7, 1): "b"}, occupied)  # verge was felt between
    assert sorted({tuple(s) for s in np.argwhere(part & ~thing).tolist()}) == [(6, 1), (9, 1)]
    assert len(with_embedded_things([thing], {(6, 4): "k", (6, 1): "g"}, occupied)) == 2  # of another colour


def through_wall(high: int, low: int, wide: int, other_wide: int, shift: int) -> tuple[Mask, Mask]:
    """Return the squares of a room with a wall across it and things on both sides; and the things, the wall between.

    high, low : how far they stick out to the north and to the south. wide, other_wide : their widths.
    shift : how far the northern one lies further east.
    """
    occupied = room()
    occupied[8:11] = True
    upper, lower = np.zeros_like(occupied), np.zeros_like(occupied)
    lower[8 - low : 8, 8 : 8 + wide] = True
    upper[11 : 11 + high, 8 + shift : 8 + shift + other_wide] = True
    between = np.zeros_like(occupied)
    between[8:11, 8 : 8 + wide] = True
    return occupied | upper | lower, lower | upper | between


@given(st.integers(1, 4), st.integers(1, 4), st.integers(1, 5), st.sampled_from([None, "c", "d", "b"]), st.booleans())
@settings(max_examples=60, deadline=None)
def test_what_matches_across_a_wall_is_one_thing(
    high: int, low: int, wide: int, behind: str | None, turn: bool
) -> None:
    occupied, whole = through_wall(high, low, wide, wide, 0)
    felt = {(8 - low, 8): "c"} | ({} if behind is None else {(10 + high, 8): behind})
    if turn:
        occupied, whole = np.ascontiguousarray(occupied.T), np.ascontiguousarray(whole.T)
        felt = {(column, row): colour for (row, column), colour in felt.items()}
    parts = sticking_out(occupied)
    joined = joined_through_walls(separate_things(parts, felt), parts, felt, occupied)
    assert among(joined, whole) == (behind in (None, "c"))


@pytest.mark.parametrize(("wide", "other", "shift"), [(2, 3, 0), (3, 2, 0), (3, 3, 1), (3, 3, -2), (2, 2, 6)])
def test_what_does_not_match_across_a_wall_stays_apart(wide: int, other: int, shift: int) -> None:
    occupied, _ = through_wall(3, 3, wide, other, shift)
    felt = {(6, 8): "c", (12, 9 + shift): "c"}
    parts = sticking_out(occupied)
    things = separate_things(parts, felt)
    assert len(things) == 2
    assert len(joined_through_walls(things, parts, felt, occupied)) == 2


def test_a_long_thing_is_parted_from_the_wall_once_it_was_felt() -> None:
    thing = np.zeros((HIGH, WIDE), np.bool_)
    thing[2:16, 6:9] = True  # longer than what is taken for a thing unfelt
    occupied = room() | thing
    floor, seen = ~occupied, np.ones_like(occupied)
    assert not among(protrusions(floor, occupied, seen), thing)
    assert not among(protrusions(floor, occupied, seen, {(9, 6): "b"}), thing)
    assert among(protrusions(floor, occupied, seen, {(9, 6): "c"}), thing)
