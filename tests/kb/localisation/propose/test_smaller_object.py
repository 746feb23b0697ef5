"""An object pressed against a wall goes further than its squares would let it; eyes.py makes the impressions."""

import math

import pytest
import shapely
from shapely.affinity import translate

from tests.kb.eyes import impression, world_of
from tests.kb.localisation.hypotheses.test_remap import around
from utak.kb.body import Move, Push
from utak.kb.localisation.tracker import Tracker
from utak.kb.objects.held_object import HeldObject, initial_insets

ROOM = world_of(["b" * 40, *["b" + "." * 38 + "b"] * 28, "b" * 40])
WALL = 39  # column of the east wall, table frame
HERE = (28, 12)  # table frame: (0, 0) of the map frame


def pressed(west: float, north: float) -> tuple[Tracker, str, shapely.Polygon]:
    """Return the tracker, the kind of its explanation and the true outline of an object pressed to the east wall.

    The object is 4 by 4 and lies between the squares. west, north : how far its sides lie within their squares.
    """
    thing = translate(shapely.box(30, 10, 34, 14), west, 1 - north)
    seen = shapely.box(30, 10, 35, 15)
    tracker = Tracker()
    tracker.wake(impression(around(thing, ROOM), HERE))
    at = HERE
    for east, north_by in ((0, 6), (8, 0), (-8, 0), (0, -6)):  # the wall is seen closely
        at = at[0] + east, at[1] + north_by
        tracker.accommodate(Move(east, north_by), impression(around(thing, ROOM), at))
    felt = translate(seen, -HERE[0], -HERE[1])
    tracker.grasp(HeldObject("o1", felt, felt, insets=initial_insets(felt)))
    tracker.accommodate(Push(4.0, 0.0), impression(around(translate(thing, 4.0), ROOM), (HERE[0] + 4, HERE[1])))
    room_left = WALL - (thing.bounds[2] + 4.0)
    last = translate(thing, 4.0 + room_left)
    own = math.floor(HERE[0] + 0.5 + 4.0 + room_left), HERE[1]
    found = tracker.accommodate(Push(2.0, 0.0), impression(around(last, ROOM), own))
    return tracker, found.explanation.how, translate(last, -HERE[0], -HERE[1])


@pytest.mark.parametrize(("west", "north"), [(0.25, 0.5), (0.6, 0.3), (0.9, 0.9), (0.1, 0.5)])
def test_an_object_that_goes_further_than_its_squares_does_not_fill_them(west: float, north: float) -> None:
    tracker, how, true = pressed(west, north)
    held = tracker.state.held_objects["o1"]
    assert how in ("smaller", "blocked")
    assert not tracker.state.residuals[-1]
    assert tracker.state.place[0] == pytest.approx(true.bounds[0] - 30 - west + 28.5, abs=0.5)
    assert held.polygon.buffer(held.play + 1e-6, join_style="mitre").covers(true)
