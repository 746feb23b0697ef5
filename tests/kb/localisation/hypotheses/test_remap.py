"""Observations and held objects in another frame lie where they truly are, by shapely and eyes.py."""

import math

import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.affinity import rotate, translate

from tests.kb.eyes import Occupied, retina, world_of
from utak.kb.localisation.hypotheses.frames import ObjectPose, Observation
from utak.kb.localisation.hypotheses.remap import (
    MapReplay,
    RemapCache,
    ReplayPrefixes,
    object_at,
    object_pose,
    remap,
)
from utak.kb.objects.held_object import HeldObject, snap_to_grid
from utak.kb.perception.frame import CENTRE, Frame
from utak.kb.perception.retina import count_ranges

ELL = shapely.Polygon([(0, 0), (5, 0), (5, 2), (2, 2), (2, 5), (0, 5)])
ROOM = [
    "b" * 34,
    *["b" + "." * 32 + "b"] * 9,
    "b" + "." * 20 + "ggg" + "." * 9 + "b",
    *["b" + "." * 32 + "b"] * 14,
    "b" * 34,
]
MAX_ERROR = 1e-6  # squares between two polygons that count as equal
within = st.floats(0.02, 0.98)


def around(polygon: shapely.Polygon, room: Occupied) -> Occupied:
    """Return a room with an object in it. polygon : table frame."""
    x0, y0, x1, y1 = (math.floor(v) for v in polygon.bounds)
    own = {
        (i, j)
        for i in range(x0, x1 + 1)
        for j in range(y0, y1 + 1)
        if shapely.box(i, j, i + 1, j + 1).intersection(polygon).area > 1e-9
    }
    return lambda i, j: (i, j) in own or room(i, j)


@settings(max_examples=60, deadline=None)
@given(within, within, st.lists(st.tuples(st.integers(-180, 180), st.integers(-4, 4), st.integers(-4, 4)), max_size=4))
def test_the_place_of_a_turned_object_depends_on_the_origin(
    fx: float, fy: float, motions: list[tuple[int, int, int]]
) -> None:
    believed = true = translate(ELL, 2, -1)
    here, truly, turned = CENTRE, (fx, fy), 0.0
    for degrees, dx, dy in motions:
        believed, true = rotate(believed, degrees, origin=here), rotate(true, degrees, origin=truly)
        believed, true = translate(believed, dx, dy), translate(true, dx, dy)
        here, truly = (here[0] + dx, here[1] + dy), (truly[0] + dx, truly[1] + dy)
        turned += degrees
    held = HeldObject("o1", believed, translate(ELL, 2, -1), turned=turned)
    found = object_at(held, object_pose(held, Frame()), Frame(0, (fx, fy)))
    assert found.polygon.hausdorff_distance(true) < MAX_ERROR


@pytest.mark.parametrize("heading", [1, 2, 88, 359])
@pytest.mark.parametrize(("fx", "fy"), [(0.5, 0.5), (0.3, 0.8)])
def test_a_carried_object_lies_right_in_the_true_frame(heading: int, fx: float, fy: float) -> None:
    """The frame is believed to lie along Utak's own axes, a degree or two wrong, while an object is carried."""
    start, thing = (9 + fx, 9 + fy), translate(ELL, 11, 8)
    observations, held, new, truth = carried(thing, _felt(thing, start, heading), start, heading)
    found = remap(new, Frame(), observations, [held])
    assert found.residual == 0
    told = [new.place_to_utak(x, y) for x, y in found.held_objects["o1"].polygon.exterior.coords]
    assert shapely.Polygon(told).hausdorff_distance(truth) < MAX_ERROR


@pytest.mark.parametrize("heading", [1, 2, 358, 359])
@pytest.mark.parametrize("other", [Frame(0, (0.8, 0.2)), Frame(-1), Frame(1, (0.1, 0.9))])
def test_remapping_in_two_steps_equals_remapping_at_once(heading: int, other: Frame) -> None:
    start, thing = (9.3, 9.8), translate(ELL, 11, 8)
    straight = rotate(_felt(thing, start, heading), heading)
    x0, y0 = straight.bounds[:2]
    observations, held, new, truth = carried(
        thing, snap_to_grid(translate(straight, round(x0) - x0, round(y0) - y0)), start, heading
    )
    at_once = remap(new, Frame(), observations, [held])
    later = remap(new, other, observations, remap(other, Frame(), observations, [held]).held_objects.values())
    for found in (at_once, later):
        lies = [new.place_to_utak(x, y) for x, y in found.held_objects["o1"].polygon.exterior.coords]
        assert shapely.Polygon(lies).hausdorff_distance(truth) < MAX_ERROR
        assert found.residual == 0


@pytest.mark.parametrize("heading", [20, 37, 64, 325])
@pytest.mark.parametrize(("east", "told"), [(10, True), (25, False)])
def test_an_outline_from_a_skewed_frame_is_fitted_anew_where_the_object_was_seen(
    heading: int, east: int, told: bool
) -> None:
    """A square of three is taken for one of less than two, and carried. Seen from afar only, it stays so."""
    start, thing = (9.5, 9.5), shapely.box(east, 6, east + 3, 9)
    believed = rotate(_felt(thing.buffer(-0.65, join_style="mitre"), start, heading), 10)
    observations, held, new, truth = carried(thing, believed, start, heading)
    held = remap(new, Frame(), observations, [held]).held_objects["o1"]
    assert held.skewed == (not told)
    assert held.dubious == held.skewed
    if told:
        lies = shapely.Polygon([new.place_to_utak(x, y) for x, y in held.polygon.exterior.coords])
        assert lies.hausdorff_distance(truth) < MAX_ERROR


def carried(
    thing: shapely.Polygon, believed: shapely.Polygon, start: tuple[float, float], heading: int
) -> tuple[list[Observation], HeldObject, Frame, shapely.Polygon]:
    """Return the observations of a walk with an object, the object as believed, the true frame, and the true outline.

    believed : its outline in a frame along Utak's own axes. The true outline is in Utak's own frame.
    """
    room = world_of(ROOM)
    angle = (heading + 44) % 90 - 44
    observations, now, moved, lay = [], start, False, HeldObject("o1", believed, believed, since=2)
    for step, (dx, dy) in enumerate([(0, 0), (1.0, -2.0), (3.0, 4.0)]):
        away = _turned((dx, dy), heading)
        if step == 2:  # with the object in hand
            moved, thing = True, translate(thing, *away)
            lay = HeldObject("o1", translate(lay.polygon, dx, dy), lay.first, since=2)
        now = (now[0] + away[0], now[1] + away[1])
        seen = retina(around(thing, room), (math.floor(now[0]), math.floor(now[1])), heading)
        own = _turned((now[0] - start[0], now[1] - start[1]), -heading)
        there = (object_pose(lay, Frame()),) if moved else ()
        observations.append(Observation(count_ranges(seen), own, there))
    origin = _turned((start[0] % 1 - 0.5, start[1] % 1 - 0.5), angle - heading)
    new = Frame(angle, (origin[0] + 0.5, origin[1] + 0.5))
    truth = translate(_felt(thing, start, heading), -0.5, -0.5)
    return observations, lay, new, truth


def test_the_pose_of_an_object_is_in_utaks_own_frame() -> None:
    frame = Frame(30, (0.2, 0.7))
    held = HeldObject("o1", translate(ELL, 3, 4), ELL, slack=0.3, turned=90.0)
    told = object_pose(held, frame)
    assert told == ObjectPose("o1", told.middle, 90.0, 0.3, told.taken)
    middle = held.polygon.centroid
    assert frame.place_from_utak(*told.middle) == pytest.approx((middle.x, middle.y))
    first = held.first.centroid
    assert frame.place_from_utak(*told.taken) == pytest.approx((first.x, first.y))


def _turned(vector: tuple[float, float], degrees: float) -> tuple[float, float]:
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return vector[0] * c - vector[1] * s, vector[0] * s + vector[1] * c


def _felt(thing: shapely.Polygon, origin: tuple[float, float], heading: float) -> shapely.Polygon:
    """Return an object of the table in a frame along Utak's own axes whose origin is the middle of square (0, 0)."""
    return translate(rotate(translate(thing, -origin[0], -origin[1]), -heading, origin=(0, 0)), 0.5, 0.5)


@pytest.mark.parametrize("number", [1, 3, 20])
def test_a_replay_of_first_observations_can_be_continued(number: int) -> None:
    start, thing = (9.5, 9.5), translate(ELL, 11, 8)
    observations, held, new, _ = carried(thing, _felt(thing, start, 0), start, 0)
    number = min(number, len(observations))
    held_objects = {"o1": held}
    at_once, first = remap(new, new, observations, [held]), ReplayPrefixes(new, observations, held_objects)
    for _ in range(2):  # the replay that is copied stays as it is
        found = remap(new, new, observations, [held], first.first(number))
        assert (found.occupancy.state == at_once.occupancy.state).all()
        assert (found.occupancy.logit == at_once.occupancy.logit).all()
        assert found.residual == at_once.residual
        assert found.held_objects["o1"].polygon.equals(at_once.held_objects["o1"].polygon)


def test_frames_in_which_observations_fall_on_the_same_squares_share_a_replay() -> None:
    """The later observations are integrated in the own frame of each, which may lay them to other squares."""
    ranges = count_ranges(retina(world_of(ROOM), (9, 9)))
    observations = [Observation(ranges, place) for place in ((0.0, 0.0), (1.0, 0.0), (1.4, 0.0))]
    alike: dict[tuple[int, bytes], MapReplay] = {}
    for frame in (Frame(0, CENTRE), Frame(0, (0.8, 0.5))):
        found = remap(frame, frame, observations, (), ReplayPrefixes(frame, observations, {}, alike).first(2))
        at_once = remap(frame, frame, observations, ())
        assert (found.occupancy.state == at_once.occupancy.state).all() and found.residual == at_once.residual
    assert len(alike) == 1


def test_a_replay_that_asks_only_whether_stops_at_the_first_contradiction() -> None:
    start, thing = (9.5, 9.5), translate(ELL, 11, 8)
    observations, held, new, _ = carried(thing, _felt(thing, start, 0), start, 0)
    empty = observations[0].ranges * 0
    contradicted = [observations[0], observations[0]._replace(ranges=empty, moved=()), *observations[1:]]
    in_full = remap(new, new, contradicted, [held])
    cut = remap(new, new, contradicted, [held], only_whether=True)
    assert 0 < cut.residual <= in_full.residual
    assert (cut.held_objects.keys(), in_full.held_objects.keys()) == (set(), {"o1"})
    agreeing, at_once = remap(new, new, observations, [held], only_whether=True), remap(new, new, observations, [held])
    assert not agreeing.residual and agreeing.held_objects.keys() == {"o1"}
    assert (agreeing.occupancy.state == at_once.occupancy.state).all()


@pytest.mark.parametrize("aside", [0.3, -0.3])
def test_frames_with_the_same_squares_share_one_map(aside: float) -> None:
    start, thing = (9.5, 9.5), translate(ELL, 11, 8)
    observations, held, believed, _ = carried(thing, _felt(thing, start, 0), start, 0)
    observations = [
        observation._replace(place=(observation.place[0] + 0.1, observation.place[1])) for observation in observations
    ]
    occupancy = remap(believed, believed, observations, [held]).occupancy
    maps = RemapCache(believed, occupancy, observations, {"o1": held})
    one, other = (Frame(3, (CENTRE[0] + part, CENTRE[1])) for part in (aside, aside * 1.01))
    assert maps.remapped(believed).occupancy is occupancy
    found = maps.remapped(one)
    assert found.occupancy is not occupancy
    assert maps.remapped(other).occupancy is found.occupancy
    at_once = remap(one, believed, observations, [held], only_whether=True)
    assert (found.occupancy.state == at_once.occupancy.state).all()
