"""What lies on squares that fields sample is taken out of them."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from geometry.counts.uncover import uncover

WIDE = 5
masks = st.lists(st.booleans(), min_size=WIDE * WIDE, max_size=WIDE * WIDE).map(
    lambda told: np.array(told).reshape(WIDE, WIDE)
)


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1), masks, masks, st.integers(-6, 6), st.integers(-6, 6))
def test_what_may_lie_there_is_not_sampled_and_what_surely_does_is_not_counted(seed, possible, sure, x, y) -> None:
    rng = np.random.default_rng(seed)
    columns, rows = rng.integers(-3, 4, (2, 8, 4), np.int32)
    weight, ranges = rng.integers(0, 3, (8, 4), np.int16), rng.integers(0, 9, (8, 2), np.int16)
    left, counts = weight.copy(), ranges.copy()
    uncover(columns, rows, left, counts, possible, sure, x, y, x + 1, y - 1)

    def on(mask, dx, dy):
        column, row = columns + dx, rows + dy
        inside = (column >= 0) & (column < WIDE) & (row >= 0) & (row < WIDE)
        return inside & mask[row.clip(0, WIDE - 1), column.clip(0, WIDE - 1)]

    may, does = on(possible, x, y), on(sure, x + 1, y - 1)
    assert (left == np.where(may, 0, weight)).all()
    assert (counts[:, 0] == ranges[:, 0] - (weight * may).sum(1)).all()
    assert (counts[:, 1] == ranges[:, 1] - (weight * does).sum(1)).all()
