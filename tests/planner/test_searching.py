"""What is looked at first while it is not known where something is."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from geometry.components import edged
from planner.aims import Aim
from planner.exploring import CLOSE, FURTHER, SHORT_OF, close, short_of
from planner.screen import Screens, grown, marked
from planner.searching import Candidate, none_of
from tests.kb.drawings import drawing, seen_whole

ROOM = [row[:4] + "U" + row[5:] if k == 38 else row for k, row in enumerate(drawing(30, 20, 4, 4))]


def distance_from(squares: np.ndarray, mask: np.ndarray) -> np.ndarray:
    """Rows or columns from each square (flat) to the nearest of a mask."""
    at = np.stack(np.divmod(squares, mask.shape[1]), axis=1)
    apart = np.abs(at[:, None] - np.argwhere(mask)[None]).max(2)
    return np.asarray(apart.min(1))


def room(looked_from: frozenset[tuple[int, int]] = frozenset()) -> tuple[Screens, np.ndarray]:
    """Screens of a room with one thing, and the squares of that. looked_from : squares of the lattice."""
    model = replace(seen_whole(ROOM), looked_from=looked_from)
    return Screens(model), model.mask(model.objects[0].patch)


def test_what_is_hardly_what_is_looked_for_is_seen_from_afar_first() -> None:
    screens, mask = room()
    away = distance_from(close(screens, mask, 0.2, arrive=True), mask)
    assert away.max() == FURTHER > CLOSE
    assert distance_from(close(screens, mask, 0.2, arrive=False), mask).max() <= CLOSE
    row, column = np.argwhere(mask).min(0)
    view = screens.model.view
    screens, mask = room(frozenset({(int(column) + view.west - FURTHER, int(row) + view.south)}))
    away = distance_from(close(screens, mask, 0.2, arrive=True), mask)
    assert away.max() == CLOSE


@pytest.mark.parametrize("arrive", [False, True])
def test_what_is_likely_looked_for_is_gone_up_to(arrive: bool) -> None:
    screens, mask = room()
    squares = close(screens, mask, 0.8, arrive)
    assert (distance_from(squares, mask) == 1).all()
    assert edged(mask).ravel()[squares].all()


def test_what_he_shall_take_is_gone_up_to_where_it_surely_is() -> None:
    screens, mask = room()
    column = int(np.argwhere(mask)[:, 1].min())
    rim = mask & (np.arange(mask.shape[1]) == column)[None]  # may be part of the thing, and may be floor
    view = screens.model.view
    doubtful = np.where(rim, 0.5, view.probability).astype(np.float32)
    screens = Screens(replace(screens.model, view=view._replace(probability=doubtful)))
    squares = close(screens, mask, 0.8, arrive=False)
    assert edged(mask & ~rim).ravel()[squares].all()
    only = Screens(replace(screens.model, view=view._replace(probability=np.where(mask, 0.5, doubtful))))
    assert edged(mask).ravel()[close(only, mask, 0.8, arrive=False)].all()


@given(st.integers(1, 12), st.integers(1, 12), st.integers(0, 2**32 - 1))
def test_edged_is_what_shares_an_edge(rows: int, columns: int, seed: int) -> None:
    mask = np.random.default_rng(seed).random((rows, columns)) < 0.2
    marked = np.argwhere(mask)
    want = [np.abs(marked - square).sum(1).min(initial=9) <= 1 for square in np.ndindex(rows, columns)]
    assert edged(mask).ravel().tolist() == want
    assert not (edged(mask) & ~grown(mask, 1)).any()


def candidate(squares: list[int], chance: int) -> Candidate:
    return Candidate(np.array(squares), Aim("inspect", np.array([0]), "", chance))


@given(st.lists(st.integers(1, 100), max_size=6))
def test_what_is_missing_was_not_seen_yet_if_it_is_none_of_all_that_was_seen(chances: list[int]) -> None:
    none = none_of([candidate([k], chance) for k, chance in enumerate(chances)])
    assert none == pytest.approx(float(np.prod([1 - chance / 100 for chance in chances])))


def test_a_thing_and_a_picture_of_it_count_once() -> None:
    assert none_of([candidate([1, 2], 40), candidate([2, 3], 90)]) == pytest.approx(0.6)


def test_what_lies_behind_a_place_is_seen_short_of_it() -> None:
    screens, _ = room()
    model = screens.model
    row, column = model.view.locate(*model.place)
    ahead = int(row) * model.labels.shape[1] + int(column) + 20
    squares = short_of(screens, np.array([ahead]))
    mask = marked(np.array([ahead]), model.labels.shape)
    assert ahead in squares
    assert distance_from(squares, mask).max() == SHORT_OF
    assert screens.floor.ravel()[squares].all()
