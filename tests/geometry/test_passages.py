"""Necks of the floor, the parts they cut it into, and ways that avoid them."""

import numpy as np
import pytest
from hypothesis import given, settings

from geometry import Screen
from tests.geometry import oracles

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


def picture(text):
    return np.array([[c == "." for c in row] for row in text.split()[::-1]])


def doors(screen):
    return [p for p in screen.passages() if p.width <= min(p.sides)]


def test_a_door_in_a_thick_wall_is_one_passage():
    screen = Screen(picture(TWO_ROOMS))
    (door,) = doors(screen)
    assert door.width == 3.0
    assert door.clearance == 1.5
    assert 10 <= door.place[0] <= 12
    assert {door.a[1], door.b[1]} == {3.0, 6.0}
    assert door.sides == (4.0, 4.0)


def test_rooms_are_the_parts_between_doors():
    screen = Screen(picture(THREE_ROOMS))
    found = doors(screen)
    assert [door.width for door in found] == [2.0, 2.0, 2.0]
    label = screen.parts(found)
    assert label.max() == 4
    assert (label > 0).tolist() == screen.free.tolist()
    for door in found:
        (x, y), (u, v) = door.gates
        assert label[int(y), int(x)] != label[int(v), int(u)]
        assert abs(x - u) + abs(y - v) == 1
    rooms = [label[int(y), int(x)] for x, y in ((4.5, 10.5), (13.5, 10.5), (22.5, 10.5), (13.5, 3.5))]
    assert sorted(rooms) == [1, 2, 3, 4]


def test_routes_avoid_a_passage():
    screen = Screen(picture(THREE_ROOMS))
    found = doors(screen)
    assert screen.routes((4.5, 10.5), (13.5, 10.5))
    label = screen.parts(found)
    for door in found:
        ends = {label[int(y), int(x)] for x, y in door.gates}
        cut = screen.parts([door])
        for start, goal in (((4.5, 10.5), (13.5, 10.5)), ((13.5, 10.5), (22.5, 10.5)), ((4.5, 10.5), (13.5, 3.5))):
            reachable = cut[int(start[1]), int(start[0])] == cut[int(goal[1]), int(goal[0])]
            assert bool(screen.routes(start, goal, avoid=[door])) == reachable
        assert len(ends) == 2


@settings(max_examples=100, deadline=None)
@given(oracles.screens(most=14))
def test_cutting_every_neck_leaves_every_free_square_in_one_part(free):
    screen = Screen(free)
    passages = screen.passages()
    label = screen.parts(passages)
    assert ((label > 0) == free).all()
    assert sorted(set(label[free].tolist())) == list(range(1, label.max() + 1))
    assert (screen.parts([]).max()) == oracles.components_and_holes(free)[0]
    for passage in passages:
        assert passage.width >= 1.0 - 1e-9
        assert passage.clearance == screen.clearance[int(passage.place[1]), int(passage.place[0])]
        assert min(passage.sides) >= passage.clearance
        assert all(free[int(y), int(x)] for x, y in passage.gates)


@settings(max_examples=100, deadline=None)
@given(oracles.screens(most=14))
def test_a_passage_avoided_is_a_neck_cut(free):
    screen = Screen(free)
    nodes = [(node["x"], node["y"]) for _, node in screen.pathgraph.nodes(data=True)]
    start, goal = nodes[0], nodes[-1]  # on the skeleton: elsewhere a square may lie on the cut itself
    ends = {start, goal}
    chains = [{tuple(point) for point in data["points"]} for _, _, data in screen.pathgraph.edges(data=True)]
    for passage in doors(screen):
        if sum(not chain.isdisjoint(passage.cut) for chain in chains) > 1:
            continue  # other chains run where the floor is cut, as at lesser necks
        label = screen.parts([passage])
        ways = screen.routes(start, goal, avoid=[passage])
        if not ends & {passage.place, passage.towards}:  # a junction in the cut's way may lose other chains to it
            same = label[int(start[1]), int(start[0])] == label[int(goal[1]), int(goal[0])]
            assert bool(ways) == same


@pytest.mark.parametrize("wide", [2, 3, 4, 5])
@pytest.mark.parametrize("thick", [1, 2, 3, 6])
def test_one_door_for_every_width_and_thickness(wide, thick):
    free = np.zeros((18, 30 + thick), bool)
    free[1:17, 1:15] = True
    free[1:17, 15 + thick : 29 + thick] = True
    free[6 : 6 + wide, 15 : 15 + thick] = True
    screen = Screen(free)
    (door,) = doors(screen)
    assert door.width == wide
    label = screen.parts([door])
    assert label[3, 3] != label[3, 20 + thick]
    assert label.max() == 2


@pytest.mark.parametrize("turn", range(4))
@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("wide", [2, 3, 4, 5, 6, 7])
def test_a_door_flush_with_a_wall_is_a_door(wide, mirrored, turn):
    """Along that wall the clearance is the same to both sides of the neck as in it."""
    free, mark = np.zeros((20, 36), bool), np.zeros((20, 36), int)
    free[2:18, 2:17] = free[2:18, 19:34] = True
    free[2 : 2 + wide, 17:19] = True
    mark[10, 7], mark[10, 31] = 1, 2
    free, mark = (np.ascontiguousarray(np.rot90(a[:, ::-1] if mirrored else a, turn)) for a in (free, mark))
    screen = Screen(free)
    (door,) = doors(screen)
    assert door.width == wide
    label = screen.parts([door])
    assert label.max() == 2
    assert label[mark == 1] != label[mark == 2]
    start, goal = ((x + 0.5, y + 0.5) for ((y, x),) in (np.argwhere(mark == n) for n in (1, 2)))
    assert screen.routes(start, goal)
    assert not screen.routes(start, goal, avoid=[door])
