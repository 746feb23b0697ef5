"""Where the furthest corner may lie: in rooms that are not seen, as far as they are looked for."""

import pytest

from planner.destinations import CARRIED, ROOM, rooms_to_see
from tests.kb.drawings import seen_whole
from tests.planner.situations import situation_of

DOOR = 2  # columns west of it


def looks(wide: int, high: int, carried: bool) -> int:
    """How many rooms are looked for in the northeast of a room with a door in its south wall, beyond which all is
    unseen."""
    wall = "b" * (1 + DOOR) + "..." + "b" * (wide - DOOR - 2)
    rows = ["b" * (wide + 2), *["b" + "." * wide + "b"] * (high - 1), "b....U" + "." * (wide - 5) + "b"]
    model = seen_whole([*rows, wall, wall, *["?" * len(wall)] * 3])
    situation = situation_of(model)
    assert len(situation.rooms.doors) == 1
    return len(rooms_to_see("northeast", situation, carried))


@pytest.mark.parametrize(("wide", "high"), [(12, 8), (16, 8), (22, 12), (26, 14), (34, 24)])
def test_rooms_are_looked_for_further_away_once_a_thing_lies_in_the_corner(wide: int, high: int) -> None:
    short = wide - DOOR - 3 + high + 1  # from the door's near end to the corner, east and north added
    assert looks(wide, high, carried=False) == (short <= ROOM)
    assert looks(wide, high, carried=True) == (short <= CARRIED)
