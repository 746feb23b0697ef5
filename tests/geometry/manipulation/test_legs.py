"""Legs of manipulation plans."""

import numpy as np
import pytest
import shapely

from utak.geometry.manipulation.legs import direction_to_grasp
from utak.geometry.raster.rasterize import squares


@pytest.mark.parametrize("depth", [0.5, 1e-5, 4.5e-8, 0.0])
@pytest.mark.parametrize("east", [0.0, 0.3])
def test_a_direction_to_grasp_is_that_of_a_covered_neighbour_and_there_is_one_wherever_any_is_covered(
    depth: float, east: float
) -> None:
    """A body that covers a sliver of a row of squares can be grasped there, as the raster tells it."""
    body = shapely.box(2 + east, 3 - depth, 5 + east, 6)
    covered = squares(body, 8, 8)
    for column, row in np.argwhere(~covered[1:7, 1:7])[:, ::-1] + 1:
        direction = direction_to_grasp(body, (column + 0.5, row + 0.5))
        if direction is None:
            assert not covered[row - 1 : row + 2, column - 1 : column + 2].any()
        else:
            assert covered[row + direction[1], column + direction[0]]
