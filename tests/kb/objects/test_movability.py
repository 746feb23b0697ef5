"""The ways in which things are moved, as kb/asp/movable.lp is given them."""

import pytest

from utak.kb.body import DIRECTIONS, Push, Turn
from utak.kb.objects.movability import MotionHistory, Movability, movabilities, square_ways, way_of
from utak.kb.perception.frame import Frame


@pytest.mark.parametrize(
    ("command", "way"),
    [
        (Push(0.0, 2.0), "north"),
        (Push(-0.3, 2.0), "north"),
        (Push(1.0, 1.0), "northeast"),
        (Push(-3.0, 0.5), "west"),
        (Push(-1.0, 2.0), "northwest"),
        (Turn(30.0), "left"),
        (Turn(-90.0), "right"),
    ],
)
def test_a_motion_is_named_by_the_nearest_direction_or_the_side_it_turns_to(command: Push | Turn, way: str) -> None:
    assert way_of(command) == way


@pytest.mark.parametrize("angle", range(-44, 46))
def test_pushes_to_the_four_squares_beside_one_go_four_ways(angle: int) -> None:
    ways = square_ways(Frame(angle))
    assert sorted(ways.values()) == [(-1, 0), (0, -1), (0, 1), (1, 0)]
    assert len(ways) == 4 and set(ways) <= set(DIRECTIONS)


def test_a_thing_is_tried_other_ways_before_it_is_taken_for_fixed() -> None:
    tried = MotionHistory("o1", 95, 4, resisted=("north",) * 3, room_on=("north", "south"))
    found = movabilities([tried, tried._replace(name="o2", room_on=("north",)), tried._replace(name="o3", resisted=())])
    assert found["o1"].untried == ("south",) and found["o1"].percent > 0
    assert found["o2"] == Movability(0, False, ())
    assert found["o3"].untried == () and found["o3"].percent > found["o1"].percent
