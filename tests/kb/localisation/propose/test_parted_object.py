"""Of two things that look one, only the one in hand moves; eyes.py makes the impressions."""

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from shapely.affinity import translate

from tests.kb.eyes import Occupied, impression, world_of
from tests.kb.localisation.hypotheses.test_remap import around
from utak.geometry.raster.components import components
from utak.kb.body import Move, Push
from utak.kb.localisation.tracker import Tracker
from utak.kb.mapping.occupancy import OCCUPIED
from utak.kb.objects.held_object import HeldObject
from utak.kb.perception.seams import halves

HERE = (17, 12)  # table frame: (0, 0) of the map frame
ROOM = world_of(["b" * 40, *["b" + "." * 38 + "b"] * 24, "b" * 40])
NEAR, FAR = shapely.box(18, 11, 21, 14), shapely.box(21, 10, 23, 14)  # the robot stands beside the near one


def pushed(room: Occupied, held: shapely.Polygon, rest: shapely.Polygon | None, by: tuple[float, float]) -> Tracker:
    """Return the tracker after a thing was pushed that was taken for one with the rest. by : in squares, (x, y)."""
    both = held if rest is None else held.union(rest)
    tracker = Tracker()
    tracker.wake(impression(around(both, room), HERE))
    tracker.accommodate(Move(0.0, 1.0), impression(around(both, room), (HERE[0], HERE[1] + 1)))
    tracker.accommodate(Move(0.0, -1.0), impression(around(both, room), HERE))
    seen = translate(both, -HERE[0], -HERE[1])
    tracker.grasp(HeldObject("o1", seen, seen))
    moved = translate(held, *by)
    after = around(moved if rest is None else moved.union(rest), room)
    tracker.accommodate(Push(*by), impression(after, (round(HERE[0] + by[0]), round(HERE[1] + by[1]))))
    return tracker


@pytest.mark.parametrize("by", [(0.0, 1.0), (0.0, -1.0), (0.0, 2.0), (-1.0, 0.0)])
def test_only_what_is_in_hand_moves_and_the_rest_stays(by: tuple[float, float]) -> None:
    tracker = pushed(ROOM, NEAR, FAR, by)
    held, occupancy = tracker.state.held_objects["o1"], tracker.state.occupancy
    assert held.first.equals(translate(NEAR, -HERE[0], -HERE[1]))
    assert held.polygon.equals(translate(NEAR, by[0] - HERE[0], by[1] - HERE[1]))
    assert held.proven and held.whole
    rest = {(x - HERE[0], y - HERE[1]) for x in (21, 22) for y in range(10, 14)}
    assert {int(occupancy.state[occupancy.index(*square)]) for square in rest} == {OCCUPIED}


@pytest.mark.parametrize("by", [(0.0, 1.0), (1.0, 0.0), (-1.0, 0.0)])
def test_what_moves_as_one_is_one_thing(by: tuple[float, float]) -> None:
    whole = NEAR.union(FAR)
    held = pushed(ROOM, whole, None, by).state.held_objects["o1"]
    assert held.polygon.equals(translate(whole, by[0] - HERE[0], by[1] - HERE[1]))
    assert held.whole


@given(st.lists(st.lists(st.booleans(), min_size=4, max_size=4), min_size=3, max_size=5))
def test_halves_are_connected_and_together_the_region(rows: list[list[bool]]) -> None:
    labels = components(np.array(rows)).labels
    region = labels == 1
    found = list(halves(region)) if region.any() else []
    for one, other in zip(found[::2], found[1::2], strict=True):
        assert (one ^ other == region).all() and not (one & other).any()
        assert all(components(half).labels.max() == 1 for half in (one, other))


def test_a_cut_between_inner_corners_comes_first() -> None:
    region = np.zeros((5, 5), np.bool_)
    region[1:4, :3] = region[:, 3:] = True
    assert int(next(halves(region)).sum()) in (9, 10)
