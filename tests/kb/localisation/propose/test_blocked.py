"""Where a motion came to a halt that may have been stopped: by a wall seen from afar, or by one that nobody saw."""

import math

import pytest
import shapely
from shapely.affinity import translate

from geometry.motion.se2 import Translate
from kb.body import Move, Push
from kb.localisation.accommodation import Memory
from kb.localisation.hypotheses.frames import CENTRED
from kb.localisation.propose.blocked import RISK, halts
from kb.mapping.completions import NO_COMPLETIONS, draw_completions, ground_of
from kb.mapping.occupancy import FREE
from kb.objects.held_object import HeldObject
from kb.perception.retina import count_ranges
from tests.kb.drawings import LARGE_ROOM
from tests.kb.eyes import Occupied, impression, world_of
from tests.kb.localisation.hypotheses.test_remap import around

CORRIDOR = ["b" * 60, *["b" * 6 + "." * 5 + "b" * 49] * 6, *["b" * 6 + "." * 50 + "bbbb"] * 8, "b" * 60]
BRICK = shapely.box(0, 0, 2, 4)


def looking(room: Occupied, square: tuple[int, int], thing: shapely.Polygon | None = None) -> Memory:
    """One who wakes on a square of the table and knows how the lattice lies, with a thing in hand if there is one."""
    occupied = room if thing is None else around(thing, room)
    memory = Memory(hypotheses=CENTRED[:1])
    memory.wake(impression(occupied, square))
    if thing is not None:
        lies = translate(thing, -square[0], -square[1])
        memory.grasp(HeldObject("o1", lies, lies, proven=True))
    view = memory.occupancy.view()
    memory.pictures = draw_completions(view, ground_of(view), NO_COMPLETIONS)
    return memory


def test_a_motion_that_comes_upon_nothing_is_not_asked_about() -> None:
    memory = looking(world_of(LARGE_ROOM), (20, 20))
    surprise = memory._surprise(Move(3.0, 0.0), count_ranges(impression(world_of(LARGE_ROOM), (23, 20)).retina))
    assert halts(surprise, None, Translate(3.0, 0.0)) == []


@pytest.mark.parametrize("far", [18.0, 21.0, 24.0])
def test_the_halts_of_a_motion_are_all_there_may_be(far: float) -> None:
    memory = looking(world_of(LARGE_ROOM), (20, 20))
    surprise = memory._surprise(Move(far, 0.0), count_ranges(impression(world_of(LARGE_ROOM), (42, 20)).retina))
    whole, *others = halts(surprise, None, Translate(far, 0.0))
    assert whole.how == "predicted" and {other.how for other in others} == {"blocked"}
    assert whole.place == (0.5 + far, 0.5) and not whole.against
    assert 0.95 < whole.chance + sum(halt.chance for halt in others) <= 1 + 1e-9
    assert whole.chance < 1 - RISK
    assert [halt.chance for halt in others] == sorted((halt.chance for halt in others), reverse=True)
    for halt in others:
        assert abs(halt.place[0] - round(halt.place[0])) < 1e-5  # on a line, to either side of it
        assert halt.against == {(round(halt.place[0]), 0)}


def test_who_is_stopped_right_beyond_the_eye_knows_where() -> None:
    """A wall that he did not see stops him; by a pillar that he had seen before he knows how far he came."""
    rows = ["b" * 60, *["b" + "." * 50 + "b" * 9] * 12, "b" * 60]
    rows[2:6] = ["b" + "." * 36 + "bbb" + "." * 11 + "b" * 9] * 4
    room = world_of(rows)
    for begun in (30, 31, 32):
        memory = looking(room, (begun, 7))
        memory.accommodate(Move(26.0, 0.0), impression(room, (50, 7)))
        assert memory.place == pytest.approx((51 - begun, 0.5), abs=1e-5)
        assert memory.square == (50 - begun, 0)
        assert memory.occupancy.state[memory.occupancy.index(49 - begun, 0)] == FREE


@pytest.mark.parametrize("side", [-1, 1])
def test_who_leads_what_he_pulls_looks_from_either_side_of_the_line_that_stops_him(side: int) -> None:
    """At the end of a corridor that goes on to the side: he stands between what he pulls and the wall."""
    mirrored = CORRIDOR if side < 0 else [row[::-1] for row in CORRIDOR]
    room = world_of(mirrored)
    wall = 6 if side < 0 else len(CORRIDOR[0]) - 6
    stands = wall - side * 18.5  # where he begins
    square = (math.floor(stands), 4)
    thing = translate(BRICK, square[0] + 1 if side < 0 else square[0] - 2, 3)
    memory = looking(room, square, thing)
    moved = translate(thing, side * 18.5, 0)
    at_line = (wall if side < 0 else wall - 1, 4)
    for view in (at_line, (at_line[0] + side, 4)):  # how the table is turned he does not know
        again = looking(room, square, thing)
        again.accommodate(Push(side * 21.0, 0.0), impression(around(moved, room), view))
        assert again.place[0] == pytest.approx(wall - square[0], abs=1e-5)
        assert again.loads["o1"].polygon.hausdorff_distance(translate(moved, -square[0], -square[1])) < 1e-5
    assert memory.place == (0.5, 0.5)


def test_a_long_push_along_a_wall_is_not_rather_taken_for_a_shorter_one() -> None:
    """The wall goes on straight: that more of it is seen from further on makes that no less likely."""
    room = world_of(["b" * 90, *["b" + "." * 88 + "b"] * 14, "b" * 90])
    thing = translate(BRICK, 21, 5)
    memory = looking(room, (20, 6), thing)
    memory.accommodate(Push(24.0, 0.0), impression(around(translate(thing, 24, 0), room), (44, 6)))
    assert memory.place == (24.5, 0.5)
