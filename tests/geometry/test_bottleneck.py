"""The neck that stops a body."""

import math

import numpy as np
import pytest
import shapely
from shapely import box

from geometry.bottleneck import neck_near
from geometry.floor import Floor


@pytest.mark.parametrize("came_to", [(12.0, 20.0), (12.0, 40.0), (20.0, 48.0)])
def test_where_there_is_room_all_round_nothing_stopped_it(came_to: tuple[float, float]) -> None:
    rooms = shapely.union_all([box(2, 2, 25, 52), box(27, 2, 48, 52), box(25, 47, 27, 50)])
    floor = Floor(box(-2, -2, 52, 56).difference(rooms), (-2.0, -2.0, 52.0, 56.0))
    rows, columns = floor.raster.shape
    across = floor.frame[0] + (np.arange(columns) + 0.5) * floor.frame[2]
    goals = np.broadcast_to(across > 35.0, (rows, columns)) & (floor.raster > 0.0)
    neck = neck_near(floor, goals, np.array([(12.0, 20.0), came_to]), 6.0)
    assert neck is not None
    assert neck.width == pytest.approx(3.0, abs=0.01)
    assert math.dist(neck.place, (26.0, 48.5)) < 1.5
