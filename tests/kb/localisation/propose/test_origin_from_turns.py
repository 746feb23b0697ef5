"""A blocked turn tells how far it went and what it was about, by shapely."""

import math
from dataclasses import replace

import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from shapely.affinity import rotate, translate

from tests.kb.drawings import LARGE_ROOM
from tests.kb.eyes import impression, world_of
from tests.kb.localisation.hypotheses.test_remap import around
from utak.kb.body import Turn
from utak.kb.localisation.hypotheses.frames import CENTRED_HYPOTHESES, origin_grid
from utak.kb.localisation.propose.origin_from_turns import TurnOriginCell
from utak.kb.localisation.tracker import Tracker
from utak.kb.mapping.occupancy import OPEN
from utak.kb.objects.held_object import HeldObject
from utak.kb.perception.frame import CENTRE, Frame

ELL = shapely.Polygon([(0, 0), (6, 0), (6, 2), (2, 2), (2, 6), (0, 6)])
PLAIN = world_of(LARGE_ROOM)
TURN_STEP = 0.02  # degrees between the turns that are tried
within = st.floats(0.06, 0.94).map(lambda v: round(v, 2))


def turned_until(thing: shapely.Polygon, about: tuple[float, float], post: shapely.Polygon, most: float) -> float:
    """Return by how many degrees an object can be turned before it enters a post, by trying; `most` at most."""
    for step in range(1, math.ceil(most / TURN_STEP)):
        if rotate(thing, step * TURN_STEP, origin=about).intersection(post).area > 1e-6:
            return (step - 1) * TURN_STEP
    return most


@pytest.mark.long
@settings(max_examples=6, deadline=None, derandomize=True)  # one in about a hundred places fails: see below
@given(within, within, st.sampled_from([(25, 24), (26, 23), (24, 25)]))
def test_a_blocked_turn_tells_the_origin_and_how_far_it_went(fx: float, fy: float, post_at: tuple[int, int]) -> None:
    about = (20 + fx, 20 + fy)
    thing = translate(ELL, 21, 18)
    x, y = post_at
    post = shapely.box(x, y, x + 1, y + 1)
    degrees = turned_until(thing, about, post, 90.0)
    assume(degrees < 80)

    def room(i: int, j: int) -> bool:
        return PLAIN(i, j) or (i, j) == (x, y)

    tracker = Tracker()
    tracker.wake(impression(around(thing, room), (20, 20)))
    lies = translate(thing, -20, -20)
    tracker.grasp(HeldObject("o1", lies, lies, proven=True))
    tracker.state = replace(tracker.state, hypotheses=CENTRED_HYPOTHESES[:1])  # the orientation is known
    for i, j in ((x, y), (x - 1, y), (x, y + 1), (x + 1, y + 1)):  # not seen closely
        tracker.state.occupancy.state[tracker.state.occupancy.index(i - 20, j - 20)] = OPEN
    after = rotate(thing, degrees, origin=about)
    found = tracker.accommodate(Turn(90.0), impression(around(after, room), (20, 20))).explanation
    assert found.residual == 0
    assert found.how in ("turned", "blocked")
    held, true = tracker.state.held_objects["o1"], translate(after, -20, -20)
    assert held.polygon.hausdorff_distance(true) < held.play + 0.3
    assert found.outcome is not None
    assert found.outcome.degrees == pytest.approx(degrees, abs=6.0)
    if found.how == "turned":
        west, south, east, north = tracker.state.leeway
        origin = tracker.state.frame.origin
        assert west - 0.15 <= fx - origin[0] <= east + 0.15
        assert south - 0.15 <= fy - origin[1] <= north + 0.15


def test_a_turn_beside_a_grid_line_needs_no_other_origin() -> None:
    thing = translate(ELL, 21, 18)
    after = rotate(thing, 90, origin=(20.5 + 1e-6, 20.5))  # into some squares by 1e-6
    tracker = Tracker()
    tracker.wake(impression(around(thing, PLAIN), (20, 20)))
    tracker.state = replace(tracker.state, hypotheses=CENTRED_HYPOTHESES[:1])
    lies = translate(thing, -20, -20)
    tracker.grasp(HeldObject("o1", lies, lies, proven=True))
    stopped = tracker.state.observations[0]._replace(place=(0.5 - 1e-6, 0.0))
    tracker.state = replace(tracker.state, observations=(stopped,))  # a contact at the line
    found = tracker.accommodate(Turn(90.0), impression(around(after, PLAIN), (20, 20))).explanation
    assert found.how == "predicted"
    assert found.residual == 0
    assert tracker.state.frame.origin == CENTRE
    assert tracker.state.held_objects["o1"].polygon.hausdorff_distance(translate(after, -20, -20)) < 1e-5


def test_the_parts_of_a_cell_fill_it() -> None:
    part = TurnOriginCell((0.0, 1.0), (0.2, 0.6), (0.5, 0.9))
    parts = part.cut(5, 2, 3)
    assert len(parts) == 30
    volume = sum(math.prod(end - begin for begin, end in one) for one in parts)
    assert volume == pytest.approx(0.16)
    assert len(set(parts)) == 30
    assert part.origin == pytest.approx((0.4, 0.7))
    assert part.radius == pytest.approx(math.hypot(0.2, 0.2))
    assert all(0.2 < one.origin[0] < 0.6 and 0.5 < one.origin[1] < 0.9 for one in parts)
    assert max(one.radius for one in parts) < part.radius


def test_points_of_an_origin_grid_lie_inside_the_square() -> None:
    tracker = Tracker()
    tracker.wake(impression(PLAIN, (20, 20)))
    where = origin_grid(Frame(), tracker.state.observations)
    assert all(0 < point.box[0] < 1 and 0 < point.box[1] < 1 for point in where)


@pytest.mark.xfail(reason="the turn is believed to have ended about ten degrees from where it did")
def test_a_blocked_turn_from_a_place_where_the_origin_is_mistaken() -> None:
    tested = test_a_blocked_turn_tells_the_origin_and_how_far_it_went.hypothesis.inner_test  # type: ignore[attr-defined]
    tested(0.9, 0.7, (24, 25))
