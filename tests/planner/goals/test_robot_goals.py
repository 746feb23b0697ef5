"""The furthest corner may be in unseen rooms; these are looked for within limits."""

import pytest

from tests.kb.drawings import known_model
from tests.planner.situations import situation_of
from utak.planner.goals.robot_goals import DOOR_SIDEWARD_REACH, MAX_UNSEEN_REACH, ONWARD_REACH, rooms_to_see

DOOR = 2  # columns of wall west of the door


def looks(wide: int, high: int, north: bool, side: str = "northeast") -> int:
    """Count the unseen rooms that may go further towards a corner of a room with one door, behind which all is unseen.

    wide, high : the size of the room, in squares. north : whether the door is in its north or its south wall.
    """
    wall = "b" * (1 + DOOR) + "..." + "b" * (wide - DOOR - 2)
    inside = [*["b" + "." * wide + "b"] * (high - 1), "b....U" + "." * (wide - 5) + "b"]
    rows = ["b" * (wide + 2), *inside, wall, wall, *["?" * len(wall)] * 3]
    situation = situation_of(known_model(rows[::-1] if north else rows))
    assert len(situation.rooms.doors) == 1
    return len(rooms_to_see(side, situation))


@pytest.mark.parametrize(("wide", "high"), [(12, 8), (16, 8), (18, 10), (19, 10), (22, 12), (34, 24)])
def test_a_room_behind_a_door_that_leads_away_from_a_corner_may_go_further_sideward_only(wide: int, high: int) -> None:
    short = wide - DOOR - 3 + high + 1  # from the near end of the door to the corner, east and north added
    assert looks(wide, high, north=False) == (short <= DOOR_SIDEWARD_REACH)


@pytest.mark.parametrize("wide", [16, 30, 48, 52, 53, 60])
def test_a_room_behind_a_door_that_leads_towards_a_corner_may_go_further(wide: int) -> None:
    short = wide - DOOR - 3 - 2
    assert looks(wide, 12, north=True) == (short <= min(MAX_UNSEEN_REACH, ONWARD_REACH + DOOR_SIDEWARD_REACH))


@pytest.mark.parametrize("north", [True, False])
def test_the_search_depends_on_the_direction_of_the_door(north: bool) -> None:
    for side in ("northeast", "southeast"):
        assert looks(28, 18, north, side) == (("north" in side) == north)
