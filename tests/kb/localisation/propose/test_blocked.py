"""Possible ends of a motion: at a wall seen from afar, or at one never seen."""

import math

import pytest
import shapely
from shapely.affinity import translate

from tests.kb.drawings import LARGE_ROOM
from tests.kb.eyes import Occupied, impression, world_of
from tests.kb.localisation.hypotheses.test_remap import around
from utak.kb.body import Move, Push
from utak.kb.localisation.hypotheses.frames import CENTRED_HYPOTHESES
from utak.kb.localisation.known.situation import ObservedSituation
from utak.kb.localisation.known.state import TrackerState
from utak.kb.localisation.propose.blocked import NEGLIGIBLE_CONTACT_CHANCE, possible_ends
from utak.kb.localisation.tracker import Tracker
from utak.kb.mapping.completions import NO_COMPLETIONS, draw_completions, given_squares
from utak.kb.mapping.occupancy import FREE
from utak.kb.objects.held_object import HeldObject
from utak.kb.perception.retina import count_ranges

CORRIDOR = ["b" * 60, *["b" * 6 + "." * 5 + "b" * 49] * 6, *["b" * 6 + "." * 50 + "bbbb"] * 8, "b" * 60]
BRICK = shapely.box(0, 0, 2, 4)


def awake(room: Occupied, square: tuple[int, int], thing: shapely.Polygon | None = None) -> Tracker:
    """Return a tracker that woke on a square of the table, knows the orientation, and holds `thing` if there is one."""
    occupied = room if thing is None else around(thing, room)
    tracker = Tracker(TrackerState(hypotheses=CENTRED_HYPOTHESES[:1]))
    tracker.wake(impression(occupied, square))
    if thing is not None:
        lies = translate(thing, -square[0], -square[1])
        tracker.grasp(HeldObject("o1", lies, lies, proven=True))
    view = tracker.state.occupancy.view()
    tracker.keep_completions(draw_completions(view, given_squares(view), NO_COMPLETIONS))
    return tracker


def test_a_motion_that_meets_nothing_has_no_ends_to_propose() -> None:
    tracker = awake(world_of(LARGE_ROOM), (20, 20))
    situation = ObservedSituation(
        tracker.state, Move(3.0, 0.0), count_ranges(impression(world_of(LARGE_ROOM), (23, 20)).retina)
    )
    assert possible_ends(situation) == []


@pytest.mark.parametrize("far", [18.0, 21.0, 24.0])
def test_the_chances_of_all_ends_sum_to_one(far: float) -> None:
    tracker = awake(world_of(LARGE_ROOM), (20, 20))
    situation = ObservedSituation(
        tracker.state, Move(far, 0.0), count_ranges(impression(world_of(LARGE_ROOM), (42, 20)).retina)
    )
    whole, *others = possible_ends(situation)
    assert whole.how == "predicted" and {other.how for other in others} == {"blocked"}
    assert whole.place == (0.5 + far, 0.5) and not whole.contact_squares
    assert 0.95 < whole.chance + sum(end.chance for end in others) <= 1 + 1e-9
    assert whole.chance < 1 - NEGLIGIBLE_CONTACT_CHANCE
    assert [end.chance for end in others] == sorted((end.chance for end in others), reverse=True)
    for end in others:
        assert abs(end.place[0] - round(end.place[0])) < 1e-5  # on either side of a grid line
        assert end.contact_squares == {(round(end.place[0]), 0)}


@pytest.mark.long
def test_a_contact_with_an_unseen_wall_is_placed_right() -> None:
    """An unseen wall blocks the walk; a pillar seen before tells how far it came."""
    rows = ["b" * 60, *["b" + "." * 50 + "b" * 9] * 12, "b" * 60]
    rows[2:6] = ["b" + "." * 36 + "bbb" + "." * 11 + "b" * 9] * 4
    room = world_of(rows)
    for begun in (30, 31, 32):
        tracker = awake(room, (begun, 7))
        tracker.accommodate(Move(26.0, 0.0), impression(room, (50, 7)))
        assert tracker.state.place == pytest.approx((51 - begun, 0.5), abs=1e-5)
        assert tracker.state.square == (50 - begun, 0)
        assert tracker.state.occupancy.state[tracker.state.occupancy.index(49 - begun, 0)] == FREE


@pytest.mark.long
@pytest.mark.parametrize("side", [-1, 1])
def test_utak_blocked_before_a_pulled_object_observes_from_either_side_of_the_line(side: int) -> None:
    """At the end of a corridor that goes on to the side Utak is between the pulled object and the wall."""
    mirrored = CORRIDOR if side < 0 else [row[::-1] for row in CORRIDOR]
    room = world_of(mirrored)
    wall = 6 if side < 0 else len(CORRIDOR[0]) - 6
    stands = wall - side * 18.5  # where Utak begins
    square = (math.floor(stands), 4)
    thing = translate(BRICK, square[0] + 1 if side < 0 else square[0] - 2, 3)
    tracker = awake(room, square, thing)
    moved = translate(thing, side * 18.5, 0)
    at_line = (wall if side < 0 else wall - 1, 4)
    for view in (at_line, (at_line[0] + side, 4)):  # how the table is turned is unknown
        again = awake(room, square, thing)
        again.accommodate(Push(side * 21.0, 0.0), impression(around(moved, room), view))
        assert again.state.place[0] == pytest.approx(wall - square[0], abs=1e-5)
        assert (
            again.state.held_objects["o1"].polygon.hausdorff_distance(translate(moved, -square[0], -square[1])) < 1e-5
        )
    assert tracker.state.place == (0.5, 0.5)


def test_a_long_push_along_a_wall_is_not_taken_for_a_shorter_one() -> None:
    """The wall goes on straight, so seeing more of it from further on is no less likely."""
    room = world_of(["b" * 90, *["b" + "." * 88 + "b"] * 14, "b" * 90])
    thing = translate(BRICK, 21, 5)
    tracker = awake(room, (20, 6), thing)
    tracker.accommodate(Push(24.0, 0.0), impression(around(translate(thing, 24, 0), room), (44, 6)))
    assert tracker.state.place == (24.5, 0.5)


def test_no_end_of_a_long_push_is_left_out_before_the_look() -> None:
    """There are more than two dozen; which of them the look agrees with tells them apart, not their number."""
    rows = ["b" * 90, *["b" + "." * 88 + "b"] * 14, "b" * 90]
    rows[3:12] = ["b" + "." * 65 + "ccc" + "." * 20 + "b"] * 9
    thing, room = translate(BRICK, 21, 5), world_of(rows)
    look = count_ranges(impression(around(translate(thing, 43, 0), room), (63, 6)).retina)
    situation = ObservedSituation(awake(room, (20, 6), thing).state, Push(60.0, 0.0), look)
    ends = possible_ends(situation)
    assert len(ends) > 40
    assert sum(end.chance or 0.0 for end in ends) > 0.999
    assert any(end.place == pytest.approx((43.5, 0.5)) for end in ends)  # where it was stopped
