"""The corners of drawn floors against the definition, square by square."""

from dataclasses import replace

import numpy as np
import pytest
import shapely
import shapely.affinity
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.kb.drawings import known_model
from tests.kb.eyes import random_room
from utak.kb.language.goal_words import CORNER_NAMES
from utak.kb.mapping.occupancy import OCCUPIED, OPEN
from utak.kb.mapping.patch import patch_of
from utak.kb.world.corners import corners, known_floor
from utak.kb.world.model import Node
from utak.planner.screen.projection import dilate

SIGNS = {"northeast": (1, 1), "northwest": (-1, 1), "southeast": (1, -1), "southwest": (-1, -1)}


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_a_corner_is_the_furthest_point_of_the_known_floor(seed: int) -> None:
    rng = np.random.default_rng(seed)
    rows = random_room(rng, *rng.integers(8, 24, 2), things=5)
    n, i = next((n, row.index(".")) for n, row in enumerate(rows) if "." in row)
    rows[n] = rows[n][:i] + "U" + rows[n][i + 1 :]
    model = known_model(rows)
    floor = known_floor(model)
    found = corners(model)
    assert set(found) == set(CORNER_NAMES)
    for side, (dx, dy) in SIGNS.items():
        r, c = np.nonzero(floor)
        best = max(float((dx * (c + a) + dy * (r + b)).max()) for a in (0, 1) for b in (0, 1))
        (x, y), (column, row) = found[side].point, found[side].square
        assert dx * x + dy * y == best
        assert floor[row, column]
        assert x - column in (0, 1)
        assert y - row in (0, 1)


def test_an_empty_rectangular_room_has_four_corners() -> None:
    rows = ["bbbbbbbb", "b......b", "b......b", "b..U...b", "bbbbbbbb"]
    found = corners(known_model(rows))
    assert {side: corner.square for side, corner in found.items()} == {
        "northeast": (6, 3),
        "northwest": (1, 3),
        "southeast": (6, 1),
        "southwest": (1, 1),
    }


def test_the_walls_of_a_corner_are_those_beside_it_whatever_other_rooms_there_are() -> None:
    rows = ["b" * 40, *["b" + "." * 16 + "b" * 23] * 6, *["b" + "." * 16 + "b" + "." * 21 + "b"] * 4]
    rows += ["b" + "." * 8 + "U" + "." * 29 + "b"] + ["b" + "." * 38 + "b"] * 4
    rows += [*["b" + "." * 16 + "b" + "." * 21 + "b"] * 4, "b" * 40]
    found = corners(known_model(rows))["northeast"]  # the hull of both rooms leads from one northern wall to the other
    assert found.square == (38, 13)
    assert found.walls is None


def test_the_walls_of_a_corner_may_lie_askew() -> None:
    rows = ["b" * 40, *["b" + "." * (8 + 3 * n) + "b" * (31 - 3 * n) for n in range(8)]]
    rows += [*["b" + "." * 29 + "b" * 10] * 9, "b" + "." * 8 + "U" + "." * 20 + "b" * 10, "b" * 40]
    walls = corners(known_model(rows))["northeast"].walls
    assert walls is not None
    assert np.allclose(sorted(walls), [(0.32, 0.95), (1.0, 0.0)], atol=0.1)  # it falls by one in three


@pytest.mark.parametrize(("pocket", "counts"), [(2, False), (8, True)])
def test_a_few_squares_of_floor_are_no_corner_yet(pocket: int, counts: bool) -> None:
    rows = ["b" * 24] * 2 + ["b" * 12 + "." * pocket + "b" * (12 - pocket)] + ["b" * 24] * 3
    rows += ["b......bbbbbbbbbbbbbbbbb"] * 3 + ["b..U...bbbbbbbbbbbbbbbbb", "b" * 24]
    found = corners(known_model(rows))
    assert (found["northeast"].square[1] > 6) == counts


def test_floor_is_known_under_a_moved_object_but_not_under_the_wall_that_it_may_enter() -> None:
    rows = ["bbbbbbbb", "b.....gb", "b.....gb", "b..U...b", "bbbbbbbb"]
    model = known_model(rows)
    under, label = np.array([list(row) for row in reversed(rows)]) == "g", int(model.labels.max()) + 1
    thing = Node("o1", "object", 100, f"part{label}", patch_of(under, model.view), 0, moved=True)
    moved = replace(model, labels=np.where(under, label, model.labels).astype(np.int32), objects=(thing,))
    assert corners(moved)["northeast"].square == (6, 3)
    state = np.where(under, OPEN, model.view.state).astype(np.int8)  # it may cover these squares or not
    loose = replace(moved, view=model.view._replace(state=state))
    assert corners(loose)["northeast"].square == (5, 3)
    assert corners(replace(loose, floor_under_moved=under))["northeast"].square == (
        6,
        3,
    )  # they were floor before it came there


def test_a_wall_seen_where_a_moved_thing_may_reach_is_not_floor_under_it() -> None:
    rows = ["bbbbbbbb", "b.....gb", "b.....gb", "b..U...b", "bbbbbbbb"]
    model = known_model(rows)
    drawn = np.array([list(row) for row in reversed(rows)])
    under, label = drawn == "g", int(model.labels.max()) + 1
    reach = under | ((drawn == "b") & dilate(under, 1))  # within its tolerance it may cover the wall around it, too
    outline = shapely.box(6, 2, 7, 4)
    west, south = model.view.west, model.view.south
    outline = shapely.affinity.translate(outline, west, south)
    thing = Node("o1", "object", 100, f"part{label}", patch_of(reach, model.view), 0, moved=True, polygon=outline)
    labels = np.where(reach, label, model.labels).astype(np.int32)
    moved = replace(model, labels=labels, objects=(thing,))
    assert (moved.view.state[reach] == OCCUPIED).all()
    assert corners(moved)["northeast"].square == (6, 3)
    assert not (known_floor(moved) & (drawn == "b")).any()
    askew = replace(moved, objects=(replace(thing, polygon=None),))
    assert (known_floor(askew) & (drawn == "b")).any()  # without an outline it lies on all squares that it may cover
