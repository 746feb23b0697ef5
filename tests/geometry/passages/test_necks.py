"""Necks of the floor, and the parts into which they cut it."""

import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks import doorways
from tests.geometry import oracles
from utak.geometry import Screen
from utak.geometry.passages.walls import find_walls

TWO_ROOMS = """
######################
#.........##.........#
#.........##.........#
#.........##.........#
#....................#
#....................#
#....................#
#.........##.........#
#.........##.........#
######################
"""

THREE_ROOMS = """
############################
#........#........#........#
#........#........#........#
#.................#........#
#.................#........#
#........#........#........#
#........#.................#
#........#.................#
#........#........#........#
#####..#####################
#..........................#
#..........................#
#..........................#
#..........................#
#..........................#
############################
"""


def floor_of(text):
    return np.array([[c == "." for c in row] for row in text.split()[::-1]])


def doors(screen):
    return screen.passages()


def test_a_door_in_a_thick_wall_is_one_passage():
    screen = Screen(floor_of(TWO_ROOMS))
    (door,) = doors(screen)
    assert door.width == 3.0
    assert 10 <= door.place[0] <= 12
    assert {door.a[1], door.b[1]} == {3.0, 6.0}
    assert door.sides == (4.0, 4.0)


def test_rooms_are_the_parts_between_doors():
    screen = Screen(floor_of(THREE_ROOMS))
    found = doors(screen)
    assert [door.width for door in found] == [2.0, 2.0, 2.0]
    label = screen.parts(found)
    assert label.max() == 4
    between = np.zeros_like(screen.free)
    for door in found:
        (x, y), (u, v) = door.gates
        assert label[int(y), int(x)] != label[int(v), int(u)]
        columns, rows = np.array(door.between).T
        between[rows, columns] = True
    assert (label > 0).tolist() == (screen.free & ~between).tolist()
    rooms = [label[int(y), int(x)] for x, y in ((4.5, 10.5), (13.5, 10.5), (22.5, 10.5), (13.5, 3.5))]
    assert sorted(rooms) == [1, 2, 3, 4]


@pytest.mark.long
@settings(max_examples=150, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_doors_do_not_depend_on_the_orientation_of_the_floor_and_cut_it_at_their_mouths(seed):
    assert not doorways.disagreements(doorways.random_floor(np.random.default_rng(seed)))


def polygon_of(free):
    """Return free squares as one geometry."""
    rows, columns = np.nonzero(free)
    return shapely.union_all(shapely.box(columns, rows, columns + 1, rows + 1))


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_the_floor_has_the_stated_width_on_both_sides_of_a_neck(seed):
    """By shapely: reduced by a little more than half the neck, the floor holds those circles in separate parts."""
    free = doorways.random_floor(np.random.default_rng(seed))
    floor = polygon_of(free)
    for door in Screen(free).passages():
        assert door.width == pytest.approx(math.dist(*door.mouths[0])) == pytest.approx(math.dist(*door.mouths[1]))
        assert door.width <= min(door.sides) + 1e-6
        drawn_in = shapely.get_parts(floor.buffer(-door.width / 2 - 0.02, quad_segs=32))
        room = min(door.sides) - door.width / 2 - 0.05
        wide_parts = [
            part for part in drawn_in if shapely.maximum_inscribed_circle(part, tolerance=0.01).length >= room
        ]
        assert wide_parts
        assert not any(shapely.LineString(mouth).intersects(part) for mouth in door.mouths for part in drawn_in)


@settings(max_examples=100, deadline=None)
@given(oracles.screens(most=14))
def test_every_free_square_is_in_one_part_or_in_a_doorway(free):
    screen = Screen(free)
    passages = screen.passages()
    label = screen.parts(passages)
    assert not label[~free].any()
    assert sorted(set(label[label > 0].tolist())) == list(range(1, label.max() + 1))
    assert screen.parts([]).max() == oracles.components_and_holes(free)[0]
    assert ((screen.parts([]) > 0) == free).all()
    for passage in passages:
        assert all(label[int(y), int(x)] for x, y in passage.gates)


@pytest.mark.parametrize("width", [1, 2, 3, 4, 5])
@pytest.mark.parametrize("thickness", [1, 2, 3, 6])
def test_a_door_of_any_width_and_thickness_is_one_door(width, thickness):
    free = np.zeros((18, 30 + thickness), bool)
    free[1:17, 1:15] = True
    free[1:17, 15 + thickness : 29 + thickness] = True
    free[6 : 6 + width, 15 : 15 + thickness] = True
    screen = Screen(free)
    (door,) = doors(screen)
    assert door.width == width
    label = screen.parts([door])
    assert label[3, 3] != label[3, 20 + thickness]
    assert label.max() == 2


@pytest.mark.parametrize("turn", range(4))
@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("width", [1, 2, 3, 4, 5, 6, 7])
def test_a_door_flush_with_a_wall_is_a_door(width, mirrored, turn):
    """Along that wall the clearance on both sides of the neck is the same as in it."""
    free, mark = np.zeros((20, 36), bool), np.zeros((20, 36), int)
    free[2:18, 2:17] = free[2:18, 19:34] = True
    free[2 : 2 + width, 17:19] = True
    mark[10, 7], mark[10, 31] = 1, 2
    free, mark = (np.ascontiguousarray(np.rot90(a[:, ::-1] if mirrored else a, turn)) for a in (free, mark))
    screen = Screen(free)
    (door,) = doors(screen)
    assert door.width == width
    label = screen.parts([door])
    assert label.max() == 2
    assert label[mark == 1] != label[mark == 2]
    start, goal = ((x + 0.5, y + 0.5) for ((y, x),) in (np.argwhere(mark == n) for n in (1, 2)))
    assert screen.routes(start, goal)


L_CORRIDOR = """
####################
#......#############
#......#############
#......#############
#..........#########
#......###.#########
#......###.#########
##########.#########
##########.#########
########........####
########........####
########........####
########........####
########........####
####################
"""

ONE_BEHIND_THE_OTHER = """
####################
#......#....#......#
#......#....#......#
#..................#
#......#....#......#
#......#....#......#
####################
"""

BULGE = """
####################
#......######......#
#......##..##......#
#..................#
#..................#
#......######......#
#......######......#
####################
"""


def test_a_corridor_with_a_bend_is_one_doorway():
    screen = Screen(floor_of(L_CORRIDOR))
    (door,) = screen.passages()
    assert door.width == 1.0
    assert {frozenset(mouth) for mouth in door.mouths} == {
        frozenset({(7.0, 10.0), (7.0, 11.0)}),
        frozenset({(10.0, 6.0), (11.0, 6.0)}),
    }
    assert screen.parts([door]).max() == 2


def test_two_doors_in_a_row_have_a_room_between_them_when_it_is_wide():
    screen = Screen(floor_of(ONE_BEHIND_THE_OTHER))
    assert [door.width for door in screen.passages()] == [1.0, 1.0]
    assert screen.parts(screen.passages()).max() == 3


def test_two_necks_with_nothing_wide_between_them_are_one_doorway():
    screen = Screen(floor_of(BULGE))
    (door,) = screen.passages()
    assert {mouth[0][0] for mouth in door.mouths} == {7.0, 13.0}
    assert screen.parts([door]).max() == 2
    assert not screen.parts([door])[3:6, 9:11].any()


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize(
    ("width", "offset"), [(width, offset) for width in (2, 3, 4, 5) for offset in range(width + 1)]
)
def test_a_door_exactly_half_as_wide_as_the_room_is_a_door_wherever_it_is(width, offset, mirrored):
    room = 2 * width
    free = np.zeros((room + 24, 24), bool)
    free[2 : 2 + room, 2 : 2 + room] = free[room + 4 : room + 22, 2:22] = True
    free[2 + room : 4 + room, 2 + offset : 2 + offset + width] = True
    (door,) = doors(Screen(free.T if mirrored else free))
    assert door.width == width
    assert 2 * min(door.sides) == room
    assert not Screen(free).passages(2.01)


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_the_widest_floor_is_about_as_wide_as_the_largest_free_disc_and_never_wider(seed):
    free = doorways.random_floor(np.random.default_rng(seed))
    floor = polygon_of(free)
    largest = 2 * max(shapely.maximum_inscribed_circle(part, 0.001).length for part in shapely.get_parts(floor))
    widest = math.sqrt(find_walls(free).room.max())
    assert largest**2 - 1 <= widest**2
    assert widest <= largest + 0.002
