"""Retina and touch, compared with a literal implementation of their definition."""

import math
from fractions import Fraction

import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.affinity import rotate

from utak.geometry.counts.retina import FIELDS
from utak.simulator.world.physics import Tabletop
from utak.simulator.world.senses import NEIGHBOUR_OFFSETS
from utak.simulator.world.world import Thing, World


def room(things: list[Thing], heading: int = 0, utak: tuple[float, float] = (8.5, 8.5)) -> World:
    verge = shapely.box(0, 0, 20, 18).difference(shapely.box(2, 2, 18, 16))
    return World(20, 18, verge, tuple(things), (), utak, heading)


def test_the_fields_tile_the_retina() -> None:
    fields = FIELDS
    assert [side for _, _, side in fields] == [1] * 64 + [2] * 48 + [4] * 48
    squares = [(e + i, n + j) for e, n, side in fields for i in range(side) for j in range(side)]
    assert sorted(squares) == [(e, n) for e in range(-16, 16) for n in range(-16, 16)]
    assert (fields[0], fields[63]) == ((-4, 3, 1), (3, -4, 1))
    assert (fields[64], fields[111]) == ((-8, 6, 2), (6, -8, 2))
    assert (fields[112], fields[159]) == ((-16, 12, 4), (12, -16, 4))


def slow_impression(world: World) -> tuple[list[int], list[str | None]]:
    """Return the impression by definition, square by square and with exact fractions."""
    shapes = [(t.polygon, t.colour) for t in world.movable] + [(world.verge, "b")]
    cosine, sine = math.cos(math.radians(world.heading)), math.sin(math.radians(world.heading))

    def seen(east: int, north: int) -> str | None:
        i = math.floor(world.utak[0]) + round(east * cosine - north * sine)
        j = math.floor(world.utak[1]) + round(east * sine + north * cosine)
        if not (0 <= i < world.width and 0 <= j < world.height):
            return "b"
        square = shapely.box(i, j, i + 1, j + 1)
        return next((colour for shape, colour in shapes if shape.intersection(square).area > 1e-9), None)

    levels = []
    for east, north, side in FIELDS:
        offsets = [(east + i, north + j) for i in range(side) for j in range(side)]
        count = sum(offset == (0, 0) or seen(*offset) is not None for offset in offsets)
        levels.append(math.floor(Fraction(7 * count, side * side) + Fraction(1, 2)))
    return levels, [seen(*offset) for offset in NEIGHBOUR_OFFSETS.values()]


@settings(max_examples=12, deadline=None)
@given(
    st.integers(0, 359),
    st.floats(3, 15),
    st.floats(3, 13),
    st.floats(0, 360),
    st.sampled_from([(8.5, 8.5), (4.2, 3.9)]),
)
def test_the_impression_is_as_defined(heading: int, x: float, y: float, turn: float, utak: tuple[float, float]) -> None:
    thing = Thing("t", "g", rotate(shapely.box(x - 1, y - 1, x + 2, y + 1), turn))
    world = room([thing], heading, utak)
    levels, touch = slow_impression(world)
    got_levels, got_touch = Tabletop(world).look()
    assert (list(got_levels), list(got_touch)) == (levels, touch)


@pytest.mark.parametrize(("heading", "felt"), [(0, 2), (90, 4), (180, 6), (270, 0)])
def test_touch_turns_with_the_heading(heading: int, felt: int) -> None:
    world = room([Thing("t", "g", shapely.box(9, 8, 10, 9))], heading)  # to the table's east of Utak
    assert [n for n, colour in enumerate(Tabletop(world).look()[1]) if colour] == [felt]


def test_the_first_by_name_is_felt_where_two_share_a_square() -> None:
    things = [Thing("a", "g", shapely.box(9.5, 8, 10, 9)), Thing("z", "c", shapely.box(9, 8, 9.5, 9))]
    assert Tabletop(room(things)).look()[1][2] == "g"


def test_sensing_leaves_the_world_equal() -> None:
    table = Tabletop(room([Thing("a", "g", shapely.box(9, 8, 10, 9))]))
    before = (table.utak, table.held, dict(table.polygons), table.motion)
    assert table.look() == table.look()
    assert (table.utak, table.held, dict(table.polygons), table.motion) == before
