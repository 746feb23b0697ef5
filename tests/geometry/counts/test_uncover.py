"""Squares that an object covers are taken out of the fields that sample them."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from utak.geometry.counts.uncover import remove_covered_squares

SIDE = 5
masks = st.lists(st.booleans(), min_size=SIDE * SIDE, max_size=SIDE * SIDE).map(
    lambda bits: np.array(bits).reshape(SIDE, SIDE)
)


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1), masks, masks, st.integers(-6, 6), st.integers(-6, 6))
def test_possible_squares_are_not_sampled_and_certain_ones_not_counted(seed, possible, certain, x, y) -> None:
    rng = np.random.default_rng(seed)
    columns, rows = rng.integers(-3, 4, (2, 8, 4), np.int32)
    weight, ranges = rng.integers(0, 3, (8, 4), np.int16), rng.integers(0, 9, (8, 2), np.int16)
    left, counts = weight.copy(), ranges.copy()
    remove_covered_squares(columns, rows, left, counts, possible, certain, x, y, x + 1, y - 1)

    def on(mask, dx, dy):
        column, row = columns + dx, rows + dy
        inside = (column >= 0) & (column < SIDE) & (row >= 0) & (row < SIDE)
        return inside & mask[row.clip(0, SIDE - 1), column.clip(0, SIDE - 1)]

    may_cover, must_cover = on(possible, x, y), on(certain, x + 1, y - 1)
    assert (left == np.where(may_cover, 0, weight)).all()
    assert (counts[:, 0] == ranges[:, 0] - (weight * may_cover).sum(1)).all()
    assert (counts[:, 1] == ranges[:, 1] - (weight * must_cover).sum(1)).all()
