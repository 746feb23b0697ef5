"""The surroundings of a square, compared with plain loops."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from utak.geometry.raster.surroundings import survey_square


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(-6, 12), st.integers(-6, 12), st.sampled_from([0, 2]))
def test_counts_and_values_are_those_of_plain_loops(seed: int, column: int, row: int, outside: int) -> None:
    draw = np.random.default_rng(seed)
    raster = draw.integers(0, 4, (7, 9), np.uint8) * draw.integers(0, 2, (7, 9), np.uint8)
    members = np.column_stack([draw.integers(-5, 6, (40, 2)), draw.integers(0, 3, 40)])
    others = draw.integers(-3, 4, (5, 2))
    counts, values = np.full(3, 7, np.uint8), np.full(5, 7, np.uint8)
    survey_square(raster, column, row, members, others, outside, counts, values)

    def at(east: int, north: int) -> int:
        i, j = column + east, row + north
        return int(raster[j, i]) if 0 <= i < 9 and 0 <= j < 7 else outside

    expected = [sum(at(e, n) != 0 for e, n, group in members.tolist() if group == k) for k in range(3)]
    assert counts.tolist() == expected
    assert values.tolist() == [at(e, n) for e, n in others.tolist()]
