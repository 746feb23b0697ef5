"""A blocked push and an origin off the middle are found together."""

import math
from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.affinity import translate

from tests.kb.localisation.hypotheses.test_remap import around
from tests.kb.localisation.propose.test_earlier_motion import (
    SIDE,
    free_about,
    observe,
    plus,
    room_with_a_thing,
    situated,
    square_of,
)
from utak.geometry.motion.first_contact import ContactBody, Obstacles
from utak.geometry.motion.se2 import Translate
from utak.kb.body import Move, Push, Turn
from utak.kb.localisation.hypotheses.frames import OFF_CENTRE_COST
from utak.kb.localisation.hypotheses.remap import object_pose
from utak.kb.localisation.known.situation import ObservedSituation
from utak.kb.localisation.propose.origin import COARSE_ORIGINS, blocked_pushes_with_origin, propose
from utak.kb.objects.held_object import HeldObject
from utak.kb.perception.frame import CENTRE, Frame

Point = tuple[float, float]


def blocked_push_of_utak(
    rng: np.random.Generator, beside: Point
) -> tuple[ObservedSituation, Point, shapely.Polygon] | None:
    """Return the situation after a contact of Utak in a push, the true place and outline then; None without a contact.

    beside : the true origin.
    """
    room, thing, (x, y) = room_with_a_thing(rng)
    origin = (x + 1 + beside[0], y - 1 + beside[1])
    way = (float(rng.integers(-14, 15)), float(rng.integers(-14, 15)))
    if not free_about(room, x + 1, y + 1, 3) or not any(way):
        return None
    walls = Obstacles([shapely.box(i, j, i + 1, j + 1) for i in range(SIDE) for j in range(SIDE) if room(i, j)])
    part = walls.first_contact(ContactBody(thing, [origin]), Translate(*way))
    if part in (0.0, 1.0) or part == walls.first_contact(ContactBody(thing, []), Translate(*way)):
        return None
    went = way[0] * part, way[1] * part
    lies = translate(thing, -math.floor(origin[0]), -math.floor(origin[1]))
    held = HeldObject("o1", lies, lies, since=1, proven=True)
    first = observe(around(thing, room), origin, (0.0, 0.0))
    observations = [first, first._replace(moved=(object_pose(held, Frame()),))]
    after = observe(around(translate(thing, *went), room), plus(origin, went), way)
    there = plus(beside, went)
    return situated(Push(*way), after, observations, held, in_hand=True), there, translate(lies, *went)


@pytest.mark.long
@settings(max_examples=15, deadline=None)
@given(st.integers(0, 2**32 - 1), st.sampled_from(COARSE_ORIGINS))
def test_a_contact_of_utak_in_a_push_is_found_with_the_origin(seed: int, beside: Point) -> None:
    rng = np.random.default_rng(seed)
    made = (blocked_push_of_utak(rng, beside) for _ in range(2000))
    situation, there, thing = next(one for one in made if one is not None)
    found = blocked_pushes_with_origin(situation)
    near = []
    for one in found:
        outcome, origin = one.outcome, one.frame.origin
        assert outcome is not None and outcome.how == "blocked"
        assert one.residual == 0 and one.chance is not None and 0 < one.chance <= 1
        assert len(one.hypotheses) <= len(COARSE_ORIGINS) and origin in COARSE_ORIGINS
        assert math.isclose(one.prior_cost, OFF_CENTRE_COST - math.log(len(one.hypotheses) / len(COARSE_ORIGINS)))
        if math.dist(one.place, there) < 1 and outcome.polygon.hausdorff_distance(thing) < 1:
            near += [hypothesis.box[:2] for hypothesis in one.hypotheses]
    assert beside in near, (seed, beside, square_of(there))


def test_turned_objects_and_empty_hands_are_not_asked() -> None:
    rng = np.random.default_rng(1)
    situation, *_ = next(one for one in (blocked_push_of_utak(rng, CENTRE) for _ in range(2000)) if one is not None)
    assert propose(situation)
    for command in (Turn(30.0), Move(1.0, 0.0)):
        held = situation.state.in_hand if isinstance(command, Turn) else None
        other = replace(situation.supposing(in_hand=held), command=command)
        assert propose(other) == []
