"""Runs along rows, against a walk over each row, and the polygon of a mask against its squares."""

from itertools import groupby

import numpy as np
import shapely
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays

from utak.geometry.raster.runs import mask_to_polygon, runs_along_rows

MASKS = arrays(np.bool_, array_shapes(min_dims=2, max_dims=2, max_side=6), elements=st.booleans())


@given(MASKS)
def test_runs_are_those_of_a_walk_over_each_row(mask: np.ndarray) -> None:
    walked = []
    for number, row in enumerate(mask.tolist()):
        column = 0
        for value, squares in groupby(row):
            length = len(list(squares))
            walked += [(number, column, column + length)] * value
            column += length
    assert list(runs_along_rows(mask).each()) == walked


@given(MASKS)
def test_the_polygon_of_a_mask_covers_its_squares_alone(mask: np.ndarray) -> None:
    rows, columns = np.nonzero(mask)
    squares = shapely.union_all(shapely.box(columns, rows, columns + 1, rows + 1))
    assert mask_to_polygon(mask).symmetric_difference(squares).area == 0
