"""Passages of the true floor: found, measured, and made wider by exactly so much."""

import math

import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import affinity

from utak.simulator.explaining.fixing.gaps import (
    WIDTH_STEP,
    GapSide,
    floor_of,
    new_doors_of,
    passages_of,
    widened,
)
from utak.simulator.world.world import Thing, World

TABLE = shapely.box(0, 0, 24, 14)


def rooms(low: float, high: float, thickness: int = 2) -> World:
    """Return two rooms with a door from y = low to y = high in the wall between them; no door when they are equal."""
    floor = [shapely.box(1, 1, 11, 13), shapely.box(11 + thickness, 1, 23, 13)]
    if high > low:
        floor.append(shapely.box(11, low, 11 + thickness, high))
    return World(24, 14, TABLE.difference(shapely.union_all(floor)), (), (), (4.5, 4.5), 0)


def opening_at(world: World, x: float) -> tuple[float, float]:
    """Return from where to where the floor is open along a line x = constant: measured without the code under test."""
    line = floor_of(world).intersection(shapely.LineString([(x, 0), (x, 14)]))
    return line.bounds[1], line.bounds[3]


@given(st.integers(3, 9), st.integers(1, 3), st.sampled_from(list(GapSide)), st.integers(1, 6), st.integers(1, 3))
@settings(max_examples=25, deadline=None)
def test_a_door_is_wider_by_exactly_so_much(low: int, width: int, side: GapSide, steps: int, thickness: int) -> None:
    world = rooms(low, low + width, thickness)
    (gap,) = passages_of(world)
    assert gap.width == width
    assert gap.place == (11 + thickness / 2, low + width / 2)
    by = steps * WIDTH_STEP
    changed = widened(world, gap, side, by)
    up = {GapSide.BOTH: by / 2}.get(side, by if (side == GapSide.LEFT) == (gap.along[1] > 0) else 0.0)
    south, north = low - (by - up), low + width + up
    if south < 1 or north > 13:  # the door would reach beyond the rooms: then the floor beside it bounds it
        return
    assert changed is not None
    for x in (11.01, 11 + thickness / 2, 10.99 + thickness):
        assert opening_at(changed, x) == pytest.approx((south, north))
    added = floor_of(changed).difference(floor_of(world))
    assert added.area == pytest.approx(by * thickness)


@pytest.mark.long
@given(st.floats(-40, 40), st.integers(1, 8))
@settings(max_examples=10, deadline=None)
def test_a_door_in_a_wall_askew_is_measured_and_widened(degrees: float, steps: int) -> None:
    square = shapely.box(2, 2, 28, 28)
    wall = shapely.union_all([shapely.box(14, 0, 16, 12.5), shapely.box(14, 16.5, 16, 30)])
    floor = affinity.rotate(square.difference(wall), degrees, (15, 15))
    floor = affinity.translate(floor, 8, 8)
    world = World(46, 46, shapely.box(0, 0, 46, 46).difference(floor), (), (), (15.0, 23.0), 0)
    gap = passages_of(world)[0]
    assert gap.width == pytest.approx(4.0, abs=1e-6)
    for side in GapSide:
        changed = widened(world, gap, side, steps * WIDTH_STEP)
        assert changed is not None
        assert passages_of(changed)[0].width == pytest.approx(4.0 + steps * WIDTH_STEP, abs=1e-6)
        assert floor_of(changed).covers(floor_of(world).buffer(-1e-6))


def test_only_the_verge_gives_way() -> None:
    post = Thing("p", "p", shapely.box(11, 6, 13, 9))
    world = World(24, 14, rooms(4, 9).verge, (), (post,), (4.5, 4.5), 0)
    gap, between_walls = passages_of(world)
    assert (gap.width, between_walls.width) == (2, 5)
    north = GapSide.LEFT if gap.along[1] > 0 else GapSide.RIGHT
    south = GapSide.RIGHT if north == GapSide.LEFT else GapSide.LEFT
    assert widened(world, gap, north, 1.0) is None
    assert widened(world, gap, south, 1.0) is not None


def test_a_gap_does_not_open_a_second_way() -> None:
    floor = shapely.union_all([shapely.box(1, 1, 11, 13), shapely.box(13, 1, 23, 13)])
    doors = shapely.union_all([shapely.box(11, 3, 13, 5), shapely.box(11, 6, 13, 10)])
    world = World(24, 14, TABLE.difference(floor.union(doors)), (), (), (4.5, 4.5), 0)
    narrow = passages_of(world)[0]
    north = GapSide.LEFT if narrow.along[1] > 0 else GapSide.RIGHT
    assert narrow.width == 2
    assert widened(world, narrow, north, 0.75) is not None
    assert widened(world, narrow, north, 1.0) is None  # the two doors would be one


def test_a_neck_without_depth_is_widened() -> None:
    floor = shapely.union_all([shapely.box(1, 1, 11, 8), shapely.box(10, 6, 23, 13)])
    world = World(24, 14, TABLE.difference(floor), (), (), (4.5, 4.5), 0)
    (gap,) = passages_of(world)
    assert gap.width == pytest.approx(math.dist((11, 6), (10, 8)))
    changed = widened(world, gap, GapSide.BOTH, 1.0)
    assert changed is not None
    assert passages_of(changed) == [] or passages_of(changed)[0].width >= gap.width + 1.0 - 1e-6


def test_a_new_door_joins_two_rooms() -> None:
    world = rooms(5, 5)
    assert passages_of(world) == []
    (gap,) = new_doors_of(world)
    changed = widened(world, gap, GapSide.LEFT, 2.0)
    assert changed is not None
    assert len(shapely.get_parts(floor_of(changed))) == 1
    south, north = opening_at(changed, 12.0)
    assert (south, north - south) == (7.0, 2.0)
    assert new_doors_of(changed) == []


def test_a_wall_of_fixed_things_gets_no_door() -> None:
    wall = Thing("w", "w", shapely.box(11, 1, 13, 13))
    room = shapely.box(1, 1, 23, 13)
    world = World(24, 14, TABLE.difference(room), (), (wall,), (4.5, 4.5), 0)
    assert all(widened(world, gap, GapSide.LEFT, 2.0) is None for gap in new_doors_of(world))


def test_a_table_without_floor_has_no_gaps() -> None:
    world = World(24, 14, TABLE, (), (), (4.5, 4.5), 0)
    assert passages_of(world) == []
    assert new_doors_of(world) == []
