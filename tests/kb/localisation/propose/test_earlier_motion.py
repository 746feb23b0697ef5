"""Re-estimation of an earlier motion once objects were moved: the truth is among the proposals."""

import math
from collections.abc import Iterator

import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from shapely.affinity import translate

from tests.kb.eyes import Occupied, random_room, retina, world_of
from tests.kb.localisation.hypotheses.test_remap import around
from tests.kb.localisation.test_tracker import first_contact
from utak.geometry.motion.first_contact import ContactBody, Obstacles
from utak.geometry.motion.se2 import Translate
from utak.kb.body import Move, Push
from utak.kb.localisation.hypotheses.explanation import Explanation
from utak.kb.localisation.hypotheses.frames import CENTRED_HYPOTHESES, Observation
from utak.kb.localisation.hypotheses.remap import object_pose, remap
from utak.kb.localisation.hypotheses.walk_outcomes import StraightMotion
from utak.kb.localisation.known.situation import ObservedSituation
from utak.kb.localisation.known.state import TrackerState
from utak.kb.localisation.propose.earlier_motion import reestimate_motions
from utak.kb.objects.held_object import HeldObject
from utak.kb.perception.frame import CENTRE, Frame
from utak.kb.perception.retina import count_ranges

SIDE = 34
BRICK = shapely.box(0, 0, 3, 2)
Point = tuple[float, float]
Scene = tuple[
    ObservedSituation, StraightMotion, Point, shapely.Polygon
]  # the situation, the motion to re-estimate, its true shift, and the true outline of the object
seeds = st.integers(0, 2**32 - 1)


def free_about(occupied: Occupied, x: float, y: float, reach: int) -> bool:
    """Return whether all squares within `reach` of a point are free."""
    about = range(-reach, reach + 1)
    return not any(occupied(math.floor(x) + i, math.floor(y) + j) for i in about for j in about)


def observe(occupied: Occupied, here: Point, own: Point) -> Observation:
    """Return what is seen from a point of the table. own : the believed place, Utak's own frame."""
    return Observation(count_ranges(retina(occupied, square_of(here))), own)


def plus(point: Point, way: Point) -> Point:
    return point[0] + way[0], point[1] + way[1]


def square_of(point: Point) -> tuple[int, int]:
    return math.floor(point[0]), math.floor(point[1])


def right(
    situation: ObservedSituation,
    motion: StraightMotion,
    shift: Point,
    thing: shapely.Polygon,
) -> list[Explanation]:
    """Return the proposals that are right about both the shift of the motion and the place of the object."""
    found = reestimate_motions(situation.supposing(motions=(motion,)), kept=False)
    for one in found:
        assert one.residual == 0
        assert one.correction is not None and one.correction.since == motion.number
    near = [one for one in found if one.correction and math.dist(one.correction.shift, shift) < 5e-3]
    state = situation.state
    proposed = [
        (one, one.outcome.polygon)
        if one.outcome is not None
        else (one, one.correction.held_objects(state.held_objects, state.frame)["o1"].polygon)
        for one in near
        if one.correction is not None
    ]
    return [one for one, polygon in proposed if polygon.hausdorff_distance(thing) < 5e-3]


def situated(
    command: Move | Push, after: Observation, observations: list[Observation], held: HeldObject, in_hand: bool
) -> ObservedSituation:
    frame = Frame()
    occupancy = remap(frame, frame, observations, [held]).occupancy
    place = frame.place_from_utak(*observations[-1].place)
    name = held.name if in_hand else None
    held_objects, seen = {held.name: held}, tuple(observations)
    state = TrackerState(occupancy, frame, place, seen, CENTRED_HYPOTHESES[:1], held_objects=held_objects, in_hand=name)
    return ObservedSituation(state, command, after.ranges)


def room_with_a_thing(rng: np.random.Generator) -> tuple[Occupied, shapely.Polygon, tuple[int, int]]:
    """Return a room, an object that may lie in it, and its southwest square."""
    room = world_of(random_room(rng, SIDE, SIDE, 8))
    x, y = (int(v) for v in rng.integers(4, SIDE - 7, 2))
    return room, translate(BRICK, x, y), (x, y)


def first_of(attempts: Iterator[Scene | None]) -> Scene:
    """Return the first scene that could be made; skip the test in the rare case that none could."""
    scene = next((one for one in attempts if one is not None), None)
    assume(scene is not None)
    assert scene is not None
    return scene


@pytest.mark.long
@settings(max_examples=15, deadline=None)
@given(seeds)
def test_a_walk_blocked_before_a_grasp_is_reestimated_with_the_object(seed: int) -> None:
    rng = np.random.default_rng(seed)
    assert right(*first_of(walked_and_pushed(rng) for _ in range(300)))


def walked_and_pushed(rng: np.random.Generator) -> Scene | None:
    """Return a scene: a walk was blocked, and an object was reached, grasped and pushed. None if nothing blocks it."""
    room, thing, (x, y) = room_with_a_thing(rng)
    occupied = around(thing, room)
    origin = (float(rng.integers(2, SIDE - 2)) + 0.5, float(rng.integers(2, SIDE - 2)) + 0.5)
    way = (float(rng.uniform(-14, 14)), float(rng.uniform(-14, 14)))
    far = (float(rng.integers(-2, 3)), float(rng.integers(-2, 3)))
    if not free_about(room, x + 1, y + 1, 4) or occupied(*square_of(origin)) or not any(far):
        return None
    stopped = first_contact(occupied, origin, way, 0)
    shift = stopped[0] - origin[0] - way[0], stopped[1] - origin[1] - way[1]
    onward = round(x + 1.5 - stopped[0]) + 0.0, round(y - 0.5 - stopped[1]) + 0.0  # to about where it is grasped
    truly = plus(stopped, onward)
    if not 0.2 < math.hypot(*shift) < 6 or occupied(*square_of(truly)):
        return None
    frame, believed = Frame(), plus(way, onward)
    place = square_of(frame.place_from_utak(*believed))
    lies = translate(thing, place[0] - math.floor(truly[0]), place[1] - math.floor(truly[1]))
    held = HeldObject("o1", lies, lies, since=3, proven=True)
    observations = [
        observe(occupied, origin, (0.0, 0.0)),
        observe(occupied, stopped, way),
        observe(occupied, truly, believed),
    ]
    observations.append(observations[-1]._replace(moved=(object_pose(held, frame),)))
    after = observe(around(translate(thing, *far), room), plus(truly, far), plus(believed, far))
    situation = situated(Push(*far), after, observations, held, in_hand=True)
    true = translate(thing, far[0] + CENTRE[0] - origin[0], far[1] + CENTRE[1] - origin[1])
    return situation, StraightMotion(1, way, CENTRED_HYPOTHESES[:1]), shift, true


@pytest.mark.long
@settings(max_examples=6, deadline=None)
@given(seeds)
def test_a_push_blocked_unnoticed_is_reestimated_with_the_object_in_hand(seed: int) -> None:
    rng = np.random.default_rng(seed)
    assert right(*first_of(pushed_and_walked(rng) for _ in range(300)))


def pushed_and_walked(rng: np.random.Generator) -> Scene | None:
    """Return a scene: a push was blocked, and the robot walked on alone."""
    room, thing, (x, y) = room_with_a_thing(rng)
    origin = (x + 1 + CENTRE[0], y - 1 + CENTRE[1])
    way = (float(rng.integers(-14, 15)), float(rng.integers(-14, 15)))
    walk = (float(rng.integers(-3, 4)), float(rng.integers(-3, 4)))
    if not free_about(room, x + 1, y + 1, 3) or not any(way):
        return None
    walls = [shapely.box(i, j, i + 1, j + 1) for i in range(SIDE) for j in range(SIDE) if room(i, j)]
    part = Obstacles(walls).first_contact(ContactBody(thing, [origin]), Translate(*way))
    went = way[0] * part, way[1] * part
    shift = went[0] - way[0], went[1] - way[1]
    there = around(translate(thing, *went), room)
    end = plus(plus(origin, went), walk)
    if not 0.2 < math.hypot(*shift) < 6 or part == 0 or there(*square_of(end)):
        return None
    frame = Frame()
    lies = translate(thing, -math.floor(origin[0]), -math.floor(origin[1]))
    held = HeldObject("o1", translate(lies, *way), lies, since=1, proven=True)
    first = observe(around(thing, room), origin, (0.0, 0.0))
    taken = first._replace(moved=(object_pose(HeldObject("o1", lies, lies, since=1), frame),))
    pushed = observe(there, plus(origin, went), way)._replace(moved=(object_pose(held, frame),))
    situation = situated(Move(*walk), observe(there, end, plus(way, walk)), [first, taken, pushed], held, in_hand=False)
    return situation, StraightMotion(2, way, CENTRED_HYPOTHESES[:1], in_hand="o1"), shift, translate(lies, *went)
