"""The neck that stops a body."""

import math

import numpy as np
import pytest
import shapely
from hypothesis import example, given, settings
from hypothesis import strategies as st
from shapely import affinity, box

from geometry.cspace.bottleneck import NEARLY, Bottleneck, helps, missing_width, neck_near
from geometry.cspace.plan_motion import plan_motion
from geometry.manipulation.goals import Inside
from geometry.motion.obstacle_field import ObstacleField
from geometry.motion.se2 import Pose

ELL = shapely.Polygon([(0, 0), (6, 0), (6, 2), (2, 2), (2, 6), (0, 6)])
BRICK = box(0, 0, 6, 4)


@pytest.mark.parametrize("came_to", [(12.0, 20.0), (12.0, 40.0), (20.0, 48.0)])
def test_where_there_is_room_all_round_nothing_stopped_it(came_to: tuple[float, float]) -> None:
    rooms = shapely.union_all([box(2, 2, 25, 52), box(27, 2, 48, 52), box(25, 47, 27, 50)])
    floor = ObstacleField(box(-2, -2, 52, 56).difference(rooms), (-2.0, -2.0, 52.0, 56.0))
    rows, columns = floor.raster.shape
    across = floor.frame[0] + (np.arange(columns) + 0.5) * floor.frame[2]
    goals = np.broadcast_to(across > 35.0, (rows, columns)) & (floor.raster > 0.0)
    neck = neck_near(floor, goals, np.array([(12.0, 20.0), came_to]), 6.0)
    assert neck is not None
    assert neck.width == pytest.approx(3.0, abs=0.01)
    assert math.dist(neck.place, (26.0, 48.5)) < 1.5


sides = st.integers(14, 60)
share = st.integers(0, 1000).map(lambda number: number / 1000)


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
    """However large the rooms, however coarse their raster, and wherever it stands before it."""
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
def test_what_a_few_cells_do_not_decide_is_asked_at_length(lacking: float) -> None:
    solid, gap, radius = box(0, 0, 30, 10).union(box(0, 12, 30, 22)), 2.0, 3.0
    neck = Bottleneck((15.0, 11.0), ((15.0, 10.0), (15.0, 12.0)), gap)
    asked = []

    def answer(walls: shapely.Geometry, at_length: bool) -> str:
        asked.append(at_length)
        opened = (
            shapely.LineString([(15.0, -9.0), (15.0, 31.0)]).intersection(box(0, 0, 30, 22).difference(walls)).length
        )
        return "limit" if not at_length else "found" if opened >= gap + lacking else "impossible"

    assert helps(solid, neck, radius, answer)
    assert asked == [False, True]
    assert missing_width(solid, neck, radius, answer) == pytest.approx(lacking, abs=NEARLY / 2)
    assert not asked[-1]  # what is not decided then is what is sought
    assert not helps(solid, neck, radius, lambda walls, at_length: "limit")
