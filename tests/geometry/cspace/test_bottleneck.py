"""The bottleneck that stops a body, and the width that is missing."""

import math

import numpy as np
import pytest
import shapely
from hypothesis import example, given, settings
from hypothesis import strategies as st
from shapely import affinity, box

from tests.tables import few
from utak.geometry.cspace.bottleneck import (
    WIDENING_CELLS,
    WIDTH_PRECISION,
    Bottleneck,
    find_bottleneck,
    missing_width,
    status_when_wide,
)
from utak.geometry.cspace.plan_motion import plan_motion
from utak.geometry.manipulation.goals import Inside
from utak.geometry.motion.obstacle_field import ObstacleField
from utak.geometry.motion.se2 import Pose

ELL = shapely.Polygon([(0, 0), (6, 0), (6, 2), (2, 2), (2, 6), (0, 6)])
BRICK = box(0, 0, 6, 4)


@pytest.mark.parametrize("reached", few([((12.0, 20.0),), ((12.0, 40.0),), ((20.0, 48.0),)], 1))
def test_a_body_with_room_all_round_was_not_stopped_there(reached: tuple[float, float]) -> None:
    rooms = shapely.union_all([box(2, 2, 25, 52), box(27, 2, 48, 52), box(25, 47, 27, 50)])
    field = ObstacleField(box(-2, -2, 52, 56).difference(rooms), (-2.0, -2.0, 52.0, 56.0))
    rows, columns = field.raster.shape
    across = field.frame[0] + (np.arange(columns) + 0.5) * field.frame[2]
    goals = np.broadcast_to(across > 35.0, (rows, columns)) & (field.raster > 0.0)
    bottleneck = find_bottleneck(field, goals, np.array([(12.0, 20.0), reached]), 6.0)
    assert bottleneck is not None
    assert bottleneck.width == pytest.approx(3.0, abs=0.01)
    assert math.dist(bottleneck.place, (26.0, 48.5)) < 1.5


sides = st.integers(14, 60)
share = st.integers(0, 1000).map(lambda number: number / 1000)


@pytest.mark.long
@settings(max_examples=20, deadline=None)
@example(ELL, (48, 57, 54, 27), (0.2, 0.3, 0.6), 1.8, 1.0, 0)
@example(BRICK, (46, 55, 57, 36), (0.5, 0.4, 1.0), 2.0, 2.0, 1)
@example(ELL, (50, 50, 54, 54), (0.8, 0.6, 0.6), 1.6, 2.0, 2)
@given(
    st.sampled_from([ELL, BRICK]),
    st.tuples(sides, sides, sides, sides),
    st.tuples(share, share, share),
    share.map(lambda part: 1.0 + 1.8 * part),
    share.map(lambda part: 0.5 + 2.5 * part),
    st.integers(0, 3),
)
def test_the_passage_between_two_rooms_is_the_door(
    shape: shapely.Polygon,
    rooms: tuple[int, int, int, int],
    where: tuple[float, float, float],
    gap: float,
    thick: float,
    quarters: int,
) -> None:
    """Rooms of many sizes, rasters coarse for them, and starts anywhere in the room."""
    west, east, tall, high = rooms
    south = where[0] * (min(tall, high) - gap)
    door = box(west, south, west + thick, south + gap)
    there, here = box(0, 0, west, tall), box(west + thick, 0, west + thick + east, high)
    walls = box(-3, -3, west + thick + east + 3, max(tall, high) + 3).difference(shapely.union_all([there, here, door]))
    start = Pose(west + thick + where[1] * (east - 6), where[2] * (high - 6))

    def turned(geometry: shapely.Geometry) -> shapely.Geometry:
        return affinity.rotate(geometry, 90 * quarters, origin=(0, 0))

    x, y = shapely.get_coordinates(turned(shapely.Point(start[:2])))[0]
    plan = plan_motion(shape, turned(walls), Pose(x, y, 90.0 * quarters), Inside(turned(there)))
    assert plan.status == "impossible"
    assert plan.passage is not None
    assert plan.passage.width == pytest.approx(gap, abs=0.05)
    assert turned(door).buffer(0.5).covers(shapely.Point(plan.passage.place))


@pytest.mark.parametrize("lacking", [0.4, 1.3, 2.6])
@pytest.mark.parametrize("hard", [0.0, 0.3])
def test_the_missing_width_lies_between_what_is_refuted_and_what_is_found(lacking: float, hard: float) -> None:
    """However much about the true width stays undecided, and within the cells allowed."""
    obstacles, gap, radius = box(0, 0, 30, 10).union(box(0, 12, 30, 22)), 2.0, 3.0
    bottleneck = Bottleneck((15.0, 11.0), ((15.0, 10.0), (15.0, 12.0)), gap)
    taken = []

    def status_with(walls: shapely.Geometry, cells: int) -> tuple[str, int]:
        line = shapely.LineString([(15.0, -9.0), (15.0, 31.0)])
        more = line.intersection(box(0, 0, 30, 22).difference(walls)).length - gap - lacking
        taken.append(cells if abs(more) < hard else 100)
        return "limit" if abs(more) < hard else "found" if more >= 0.0 else "impossible", taken[-1]

    assert status_when_wide(obstacles, bottleneck, radius, status_with) == "found"
    taken.clear()
    least, likely, most = missing_width(obstacles, bottleneck, radius, status_with)
    assert least < lacking <= most + 1e-9
    assert likely == pytest.approx(lacking, abs=hard or WIDTH_PRECISION)
    assert most - least < 2 * (hard + WIDTH_PRECISION) + 0.3 * bool(hard)
    assert sum(taken) <= WIDENING_CELLS
    undecided = status_when_wide(obstacles, bottleneck, radius, lambda walls, cells: ("limit", cells))
    assert undecided == "limit"
