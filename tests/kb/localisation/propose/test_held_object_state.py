"""Where a thing lies that was stopped though there seemed to be room: it touches what stopped it, says shapely."""

import math
from dataclasses import replace

import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.affinity import rotate, translate

from geometry.motion.first_contact import Obstacles
from geometry.motion.se2 import Rotate, Translate
from kb.localisation.hypotheses.carry_outcomes import predicted
from kb.localisation.propose.held_object_state import FURTHEST, after, leaning
from kb.objects.held_object import OUTLINE_TOLERANCE, HeldObject

JAMBS = [shapely.box(-6, 4, 0, 6), shapely.box(6, 4, 12, 6)]
WALLS = Obstacles(JAMBS)
BOTH = shapely.union_all(JAMBS)
NORTH = Translate(0.0, 5.0)


def load(polygon: shapely.Polygon) -> HeldObject:
    return HeldObject("o1", polygon, polygon, OUTLINE_TOLERANCE, proven=True, inexact=True)


def anywhere(_: HeldObject) -> int:
    return 0


@given(st.floats(-0.5, 0.5), st.floats(-0.4, 0.4), st.floats(-20, 20))
@settings(max_examples=60, deadline=None)
def test_it_touches_what_stopped_it_and_lies_no_further_off_than_it_must(x: float, y: float, degrees: float) -> None:
    square = rotate(shapely.box(-2, -2, 2, 2), degrees)
    square = translate(square, 0.3 - square.bounds[2], 4 - square.bounds[3])
    believed = translate(square, x, y)
    found = leaning(load(believed), NORTH, WALLS, anywhere)
    moved = math.dist(believed.centroid.coords[0], found.polygon.centroid.coords[0])
    assert moved <= FURTHEST + 1e-9
    if found.polygon.equals(believed):
        return
    assert found.polygon.intersection(BOTH).area < 1e-6
    assert translate(found.polygon, 0, 0.05).intersection(BOTH).area > 0
    assert found.slack >= OUTLINE_TOLERANCE


def test_the_side_of_a_door_that_is_nearer_stopped_it() -> None:
    believed = shapely.box(0.1, -0.5, 4.1, 3.5)
    found = leaning(load(believed), NORTH, WALLS, anywhere).polygon
    assert found.bounds[0] < 0
    assert found.bounds[3] == pytest.approx(4)
    far = leaning(load(shapely.box(1.0, 0.0, 5.0, 4.0)), NORTH, WALLS, anywhere)
    assert far.polygon.bounds == (1.0, 0.0, 5.0, 4.0)  # nothing near can have stopped it


def test_what_does_not_agree_with_what_is_seen_is_not_believed() -> None:
    believed = load(shapely.box(0.1, 0.0, 4.1, 4.0))
    assert leaning(believed, NORTH, WALLS, lambda lying: lying is not believed) is believed
    right = leaning(believed, NORTH, WALLS, lambda lying: lying.polygon.bounds[0] <= 0.0)
    assert right is believed  # the other jamb is too far away
    assert leaning(believed, Rotate(30.0, (0.0, 0.0)), WALLS, anywhere) is believed


def test_what_is_moved_by_one_who_slips_never_lies_exactly_on_squares() -> None:
    exact = replace(load(shapely.box(0, -4, 4, 0)), inexact=False, slack=0.0)
    for thing in (exact, replace(exact, inexact=True)):
        moved = after(thing, predicted((0.5, -4.5), thing.polygon, Translate(0.0, 2.0)), 0)
        assert moved.polygon.bounds == (0, -2, 4, 2)
        assert moved.slack == (OUTLINE_TOLERANCE if thing.inexact else 0.0)


def test_what_is_stopped_again_and_again_for_no_reason_lies_elsewhere() -> None:
    thing = replace(load(shapely.box(0, -4, 4, 0)), inexact=False, slack=0.0)
    once = after(thing, None, 0)
    assert (once.stuck, once.inexact) == (1, False)
    assert after(once, None, 0).inexact
    assert not after(once, None, 0, suspected=True).inexact
    moved = after(once, predicted((0.5, -4.5), thing.polygon, Translate(0.0, 2.0)), 0)
    assert after(moved, None, 0).inexact
    unproven = after(after(replace(thing, proven=False), None, 0), None, 0)
    assert (unproven.stuck, unproven.inexact) == (2, False)  # the hand may be empty
