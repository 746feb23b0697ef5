"""Stretches of what bounds the floor that were never felt, with floor on both sides."""

from dataclasses import replace

import numpy as np
import pytest

from tests.kb.drawings import known_model
from utak.kb.task.stretches import MAX_THICK_WALL, MAX_WIDTH, stretches
from utak.kb.world.model import WorldModel

# A wall of two rows, in which three columns are four rows thick, and a door.
ROWS = [
    "bbbbbbbbbbbbbbbbbbbb",
    *["b..................b"] * 3,
    "b.....bbb..........b",
    *["bbbbbbbbbbbb...bbbbb"] * 2,
    "b.....bbb..........b",
    "b...U..............b",
    "b..................b",
    "bbbbbbbbbbbbbbbbbbbb",
]


def measured(model: WorldModel) -> list[tuple[str, int, int]]:
    return [(one.name, one.width, one.thickness) for one in stretches(model)]


@pytest.mark.parametrize("turned", [False, True])
def test_where_a_wall_is_thicker_is_a_stretch_and_so_is_what_is_left_beside_it(turned: bool) -> None:
    rows = ["".join(row) for row in zip(*ROWS, strict=True)] if turned else ROWS
    found = stretches(known_model(rows))
    assert sorted((one.width, one.thickness) for one in found) == [(3, 2), (3, 4), (4, 2), (5, 2)]
    assert all(int(one.mask.sum()) == one.width * one.thickness for one in found)
    thick = next(one for one in found if one.thickness == 4)
    assert thick.fact == f"unfelt({thick.name},broad,4)"


def test_stretches_have_names_from_the_southwest_on_and_a_place() -> None:
    model = known_model(ROWS)
    assert measured(model) == [("w1", 3, 4), ("w2", 5, 2), ("w3", 3, 2), ("w4", 4, 2)]
    assert stretches(model)[0].rectangle(model) == "stretch(w1,150,50,450,450)"


def test_what_was_felt_to_be_wall_is_no_stretch() -> None:
    model = replace(known_model(ROWS), felt={(2, 1): "b", (9, 3): "b"})
    assert 4 not in [thickness for _, _, thickness in measured(model)]
    assert len(stretches(model)) == 3
    assert len(stretches(replace(model, felt={(2, 1): "g"}))) == 4


def test_walls_without_floor_behind_them_too_long_or_too_thick_are_none() -> None:
    assert not stretches(known_model(["bbbbbbbb", "b.U....b", "bbbbbbbb"]))
    floor, wall = "b" + "." * (MAX_WIDTH + 3) + "b", "b" * (MAX_WIDTH + 2) + "..b"
    south = [floor.replace(".", "U", 1), "b" * len(floor)]
    assert not stretches(known_model(["b" * len(floor), floor, wall, *south]))
    narrow = "b" * (MAX_WIDTH + 1) + "...b"
    assert measured(known_model(["b" * len(floor), floor, narrow, *south])) == [("w1", MAX_WIDTH, 1)]
    assert not stretches(known_model(["b" * len(floor), floor, *[narrow] * (MAX_THICK_WALL + 1), *south]))


def test_what_floor_surrounds_is_no_stretch() -> None:
    rows = ["bbbbbbbbb", "b.......b", "b..bb...b", "b..bb...b", "b.U.....b", "bbbbbbbbb"]
    assert not stretches(replace(known_model(rows), objects=()))
    leaning = [*rows[:4], "b.Ubb...b", rows[5]]
    assert measured(replace(known_model(leaning), objects=())) == [("w1", 3, 2)]


def test_things_that_were_seen_are_no_stretches() -> None:
    rows = ["bbbbbbbbb", "b.......b", "b..gg...b", "b..gg...b", "b.U.....b", "bbbbbbbbb"]
    assert not np.any([one.mask for one in stretches(known_model(rows))])
