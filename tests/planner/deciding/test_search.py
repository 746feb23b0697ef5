"""Subgoals while it is not known where something is."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from tests.planner.sights.test_viewpoints import distance_from, room
from utak.geometry.raster.components import with_edge_neighbours
from utak.planner.screen.projection import dilate, indices_to_mask
from utak.planner.sights.frontiers import LOOK_AHEAD_RANGE, look_ahead_squares


@given(st.integers(1, 12), st.integers(1, 12), st.integers(0, 2**32 - 1))
def test_an_edged_mask_has_all_squares_that_share_an_edge_with_it(rows: int, columns: int, seed: int) -> None:
    mask = np.random.default_rng(seed).random((rows, columns)) < 0.2
    indices_to_mask = np.argwhere(mask)
    want = [np.abs(indices_to_mask - square).sum(1).min(initial=9) <= 1 for square in np.ndindex(rows, columns)]
    assert with_edge_neighbours(mask).ravel().tolist() == want
    assert not (with_edge_neighbours(mask) & ~dilate(mask, 1)).any()


def test_squares_behind_a_place_are_seen_from_short_of_it() -> None:
    cost_maps, _ = room()
    model = cost_maps.model
    row, column = model.view.locate(*model.place)
    ahead = int(row) * model.labels.shape[1] + int(column) + 20
    squares = look_ahead_squares(cost_maps, np.array([ahead]))
    mask = indices_to_mask(np.array([ahead]), model.labels.shape)
    assert ahead in squares
    assert distance_from(squares, mask).max() == LOOK_AHEAD_RANGE
    assert cost_maps.floor.ravel()[squares].all()
