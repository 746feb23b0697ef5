"""Whole runs that depend on what is a door, where a room begins, and how close a wall is."""

import json
from itertools import permutations, product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

from tests.tables import few
from utak.simulator.cli.main import main

DOOR_IN_THE_CORNER = """\
bbbbbbbbbbbbbbbbb
b.......b.......b
b.......b.......b
b.......b.......b
b..U....b.......b
b.......b.......b
b.......b.......b
b...............b
bbbbbbbbbbbbbbbbb
"""
SLANTED_ROOM = "POLYGON ((24.3468 8.5556, 8.1211 2, 2 17.1502, 18.2257 23.7058, 24.3468 8.5556))"
SLANTED_DOOR = """\
table(45, 34).
verge("POLYGON ((0 0, 0 34, 45 34, 45 0, 0 0), (24.347 8.556, 23.219 11.346, 25.166 12.133, 26.294 9.342, 42.742 15.988, 36.621 31.138, 20.173 24.492, 23.181 17.047, 21.234 16.261, 18.226 23.706, 2 17.15, 8.121 2, 24.347 8.556))").
utak("POINT (27.4 22.7)", 180).
"""  # noqa: E501
WIDE_OPENING = """\
table(29, 14).
verge("POLYGON ((0 0, 0 14, 29 14, 29 0, 0 0), (17 9, 17 13, 1 13, 1 1, 17 1, 17 4, 19 4, 19 1, 28 1, 28 13, 19 13, 19 9, 17 9))").
utak("POINT (5.5 9.5)", 0).
"""  # noqa: E501
SLANTED_CORNER = """\
table(42, 28).
verge("POLYGON ((0 0, 0 28, 42 28, 42 0, 0 0), (21.961 6.296, 21.396 8.402, 23.087 8.855, 23.651 6.749, 39.695 11.048, 35.769 25.701, 19.725 21.402, 21.456 14.94, 19.766 14.487, 18.034 20.949, 2 16.653, 5.926 2, 21.961 6.296))").
utak("POINT (23.5 13.5)", 180).
object(t1, c, "POLYGON ((29.4375 17.6794, 26.4598 17.3138, 26.0942 20.2915, 29.0719 20.6571, 29.4375 17.6794))").
object(d0, a, "POLYGON ((16.6898 9.9078, 15.4862 8.3105, 12.2916 10.7178, 9.8844 7.5232, 8.2871 8.7269, 11.898 13.5187, 16.6898 9.9078))").
"""  # noqa: E501
IN_THE_NEXT_ROOM = "in(utak, room(next)).\n"


def episode(tmp_path: Path, world: str, start: str, goal: str) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the last step and the result of a run; `world` is a picture or facts."""
    (tmp_path / ("world.lp" if "verge(" in world else "world.txt")).write_text(world)
    (tmp_path / "start.lp").write_text(start)
    (tmp_path / "goal.lp").write_text(goal)
    log = tmp_path / "episode.jsonl"
    assert main(["run", str(tmp_path), "--log", str(log)]) in (0, 1, 75)
    *_, last, result = map(json.loads, log.read_text().splitlines())
    return last, result["result"]


@pytest.mark.parametrize(("mirrored", "south_up"), few(product([False, True], repeat=2), [(True, False)]))
def test_a_door_in_the_corner_of_a_room_leads_to_the_next(mirrored: bool, south_up: bool, tmp_path: Path) -> None:
    rows = [row[:: -1 if mirrored else 1] for row in DOOR_IN_THE_CORNER.splitlines()][:: -1 if south_up else 1]
    last, result = episode(tmp_path, "\n".join(rows) + "\n", "", IN_THE_NEXT_ROOM)
    assert result["verdict"] == "done"
    assert last["utak"][0] < 8 if mirrored else last["utak"][0] > 9


@pytest.mark.long
def test_a_robot_before_a_slanted_door_is_not_in_the_next_room(tmp_path: Path) -> None:
    last, result = episode(tmp_path, SLANTED_DOOR, "", IN_THE_NEXT_ROOM)
    assert result["verdict"] == "done"
    assert shapely.from_wkt(SLANTED_ROOM).covers(shapely.Point(last["utak"]))


def slanted_rooms(seed: int) -> tuple[str, Any]:
    """Return a world of two rooms with a door, rotated by any angle, and the polygon of the next room."""
    rng = np.random.default_rng(seed)
    high, left, right = (float(v) for v in rng.uniform(11, 15, size=3))
    wall, door = float(rng.uniform(1.0, 3.0)), float(rng.uniform(3.6, 4.8))
    south = float(rng.uniform(0, high - door))
    degrees, turn = float(rng.uniform(5, 85)), int(rng.integers(4))

    def placed(shape: Any) -> Any:
        turned = shapely.affinity.rotate(shape, degrees, origin=(0, 0))
        return shapely.affinity.translate(turned, 20, 8)

    rooms = [shapely.box(0, 0, left, high), shapely.box(left + wall, 0, left + wall + right, high)]
    floor = placed(shapely.union_all([*rooms, shapely.box(left, south, left + wall, south + door)]))
    x0, y0, x1, y1 = floor.bounds
    floor, there = (shapely.affinity.translate(s, 2 - x0, 2 - y0) for s in (floor, placed(rooms[1])))
    size = int(np.ceil(x1 - x0)) + 4, int(np.ceil(y1 - y0)) + 4
    x, y = shapely.affinity.translate(placed(shapely.Point(left / 2, high / 2)), 2 - x0, 2 - y0).coords[0]
    verge = shapely.box(0, 0, *size).difference(floor)
    return (
        f'table({size[0]}, {size[1]}).\nverge("{verge.wkt}").\nutak("POINT ({x:.2f} {y:.2f})", {90 * turn}).\n',
        there,
    )


@pytest.mark.long
@pytest.mark.parametrize("seed", range(5))
def test_done_is_never_claimed_before_a_slanted_door(seed: int, tmp_path: Path) -> None:
    world, there = slanted_rooms(seed)
    last, result = episode(tmp_path, world, "", IN_THE_NEXT_ROOM)
    assert result["verdict"] == "done"
    assert there.buffer(1e-6).covers(shapely.Point(last["utak"]))


@pytest.mark.long
def test_an_opening_that_is_no_door_is_named(tmp_path: Path) -> None:
    _, result = episode(tmp_path, WIDE_OPENING, "", IN_THE_NEXT_ROOM)
    assert result["verdict"] == "impossible"  # all its walls were felt
    assert "the opening 5.0 squares wide at POINT (12.5 -3.0) is none" in result["reason"]
    assert "for the floor behind it is nowhere wider than 9.7, less than twice as wide" in result["reason"]


@pytest.mark.long
@pytest.mark.parametrize("seed", [3, 7, 11, 28])
def test_an_object_in_a_corner_is_within_a_square_of_its_walls_wherever_these_lie_in_their_squares(
    seed: int, tmp_path: Path
) -> None:
    rng = np.random.default_rng(1000 + seed)
    x0, y0 = (float(v) for v in rng.uniform(1.05, 1.95, 2).round(2))
    x1, y1 = round(float(rng.uniform(15.05, 19.95)), 2), round(float(rng.uniform(13.05, 15.95)), 2)
    size, x, y = int(rng.integers(2, 4)), int(rng.integers(6, 10)), int(rng.integers(5, 9))
    room, thing = shapely.box(x0, y0, x1, y1), shapely.box(x, y, x + size, y + size)
    verge = shapely.box(0, 0, 22, 18).difference(room)
    side = ("northeast", "northwest", "southeast", "southwest")[seed % 4]
    world = f'table(22, 18).\nverge("{verge.wkt}").\nobject(t1, g, "{thing.wkt}").\nutak("POINT (3.5 3.5)", 0).\n'
    last, result = episode(tmp_path, world, "object(x). shape(x, square).\n", f"at(x, corner({side})).\n")
    ring = np.array(last["objects"]["t1"])
    gaps = (
        x1 - ring[:, 0].max() if "east" in side else ring[:, 0].min() - x0,
        y1 - ring[:, 1].max() if "north" in side else ring[:, 1].min() - y0,
    )
    assert result["verdict"] == "done"
    assert max(gaps) <= 1.0


@pytest.mark.long
def test_an_object_is_brought_into_a_corner_of_slanted_walls(tmp_path: Path) -> None:
    goal = "at(x, corner(northeast)).\n"
    last, result = episode(tmp_path, SLANTED_CORNER, "object(x). shape(x, square).\n", goal)
    assert result["verdict"] == "done"
    assert shapely.Polygon(last["objects"]["t1"]).distance(shapely.Point(5.926, 2.0)) <= 2.0


WITHIN_REACH_OF_A_CORNER = """\
table(27, 21).
verge("POLYGON ((0 0, 0 21, 27 21, 27 0, 0 0), (26 2, 26 20, 2 20, 2 2, 26 2))").
utak("POINT (23.5 14.5)", 90).
object(t1, x, "POLYGON ((5 10, 5 13, 8 13, 8 10, 5 10))").
object(t2, o, "POLYGON ((21 8, 19 8, 19 12, 21 12, 21 8))").
"""


@pytest.mark.parametrize(("first", "second"), few(permutations(["at(utak, x)", "at(utak, corner(northeast))"]), 1))
def test_a_thing_is_brought_beside_a_corner_and_not_into_it(tmp_path: Path, first: str, second: str) -> None:
    """The robot itself is to stand there, so the corner stays free."""
    start = "object(x). shape(x, square).\n"
    last, result = episode(tmp_path, WITHIN_REACH_OF_A_CORNER, start, f"{first}.\n{second}.\n")
    assert result["verdict"] == "done"
    assert last["step"] <= 10
    assert shapely.Point(last["utak"]).distance(shapely.Point(2, 20)) <= 2  # the corner, seen from the table


PULLED_THROUGH_ITS_PLACE = """\
table(24, 25).
verge("POLYGON ((0 0, 0 25, 24 25, 24 0, 0 0), (23 2, 23 24, 2 24, 2 2, 23 2))").
utak("POINT (7.5 8.5)", 180).
object(t1, q, "POLYGON ((21 22, 21 24, 23 24, 23 22, 21 22))").
"""


@pytest.mark.long
def test_half_a_turn_whose_sense_is_not_known_is_gone_round_once_more(tmp_path: Path) -> None:
    """The robot pulls the thing out of the corner over the place where it stood itself, and then goes round it."""
    (tmp_path / "expect.lp").write_text("circles(utak, t1).\n")
    start, goal = "object(x). shape(x, square).\n", "circled(utak, x).\nat(utak, start).\n"
    last, result = episode(tmp_path, PULLED_THROUGH_ITS_PLACE, start, goal)
    assert (result["verdict"], result["achieved"]) == ("done", True)
    assert last["step"] <= 20
