"""How an impression that differs from the predicted one is explained."""

import pytest

from kb.accommodation import CellStatus, Memory
from kb.body import Move, Turn
from kb.evidence import FREE
from kb.lattice import CENTRE
from tests.kb.drawings import walked
from tests.kb.eyes import impression, utak_in, world_of

ROOM = [
    "b" * 30,
    *["b" + "." * 28 + "b"] * 6,
    *["b" + "." * 6 + "gggg" + "." * 18 + "b"] * 2,
    *["b" + "." * 28 + "b"] * 5,
    "b" + "." * 12 + "U" + "." * 15 + "b",
    *["b" + "." * 28 + "b"] * 6,
    "b" * 30,
]


def test_exact_moves_are_predicted() -> None:
    walk = walked(ROOM, [(2, 0), (0, 3), (-4, 1)])
    assert walk.poses == ("predicted",) * 4
    assert walk.model.place == pytest.approx((-1.5, 4.5))


def test_every_new_cell_is_explained_and_every_old_one_predicted() -> None:
    memory, occupied, square = Memory(), world_of(ROOM), utak_in(ROOM)
    first = memory.wake(impression(occupied, square))
    assert set(first.cells) <= {CellStatus.EXPLAINED, CellStatus.PREDICTED}
    again = memory.accommodate(Move(0.0, 0.0), impression(occupied, square))
    assert CellStatus.NOISE not in again.cells
    fovea = again.cells[:64]
    assert set(fovea) == {CellStatus.PREDICTED}


def test_a_motion_that_was_stopped_is_understood() -> None:
    walk = walked(ROOM, [(2, 0), (0, 3)])
    x, y = utak_in(ROOM)
    memory, occupied = walk.knowledge.memory, world_of(ROOM)
    found = memory.accommodate(Move(0.0, -9.0), impression(occupied, (x + 2, y - 3)))  # stopped after 6 of 9
    assert found.explanation.how == "blocked"
    assert memory.place == pytest.approx((2.5, -2.5))
    assert (2, -4) in memory.barred


def test_a_slip_of_one_who_slips_is_understood() -> None:
    walk = walked(ROOM, [(2, 0), (0, 3), (1, 0), (0, 1), (-1, 0), (0, -1)])
    x, y = utak_in(ROOM)
    memory = walk.knowledge.memory
    memory.slipped = True
    found = memory.accommodate(Move(-3.0, 0.0), impression(world_of(ROOM), (x - 1, y + 4)))
    assert found.explanation.how == "slipped"
    assert memory.place == pytest.approx((-0.5, 4.5))


def test_a_turned_table_is_noticed() -> None:
    memory, occupied, (x, y) = Memory(), world_of(ROOM), utak_in(ROOM)
    memory.wake(impression(occupied, (x, y), heading=30))
    hows = []
    for n in range(1, 7):  # north in his frame: 30 degrees from the table's north
        px, py = x + 0.5 - 0.5 * n, y + 0.5 + 0.8660254 * n
        hows.append(
            memory.accommodate(Move(0.0, 1.0), impression(occupied, (int(px), int(py)), heading=30)).explanation.how
        )
    assert "turned" in hows
    assert abs(memory.lattice.angle - 30) <= 8
    assert memory.evidence.overruled == 0


def test_where_a_motion_ends_need_not_be_floor() -> None:
    memory, occupied, (x, y) = Memory(), world_of(ROOM), utak_in(ROOM)
    memory.wake(impression(occupied, (x, y)))
    wall = len(ROOM[0]) - 1
    found = memory.accommodate(Move(wall - x, 0.0), impression(occupied, (wall, y)))  # stopped as he touched it
    assert found.explanation.how == "predicted"
    assert memory.evidence.state[memory.evidence.index(wall - x, 0)] != FREE
    assert memory.evidence.state[memory.evidence.index(0, 0)] == FREE


def test_turning_what_is_held_moves_nobody() -> None:
    memory, occupied, square = Memory(), world_of(ROOM), utak_in(ROOM)
    memory.wake(impression(occupied, square))
    found = memory.accommodate(Turn(90.0), impression(occupied, square))
    assert found.explanation.how == "predicted"
    assert memory.place == CENTRE
