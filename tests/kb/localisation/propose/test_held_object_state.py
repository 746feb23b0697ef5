"""An object blocked where there seemed to be room touches what blocked it, by shapely."""

import math
from dataclasses import replace

import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.affinity import rotate, translate

from utak.geometry.motion.first_contact import Obstacles
from utak.geometry.motion.se2 import Rotate, Translate
from utak.kb.localisation.held_object_state import MAX_LEANING_DISTANCE, lean_on_obstacle, object_after
from utak.kb.localisation.hypotheses.carry_outcomes import predicted_outcome
from utak.kb.objects.held_object import OUTLINE_TOLERANCE, HeldObject

JAMBS = [shapely.box(-6, 4, 0, 6), shapely.box(6, 4, 12, 6)]
WALLS = Obstacles(JAMBS)
BOTH = shapely.union_all(JAMBS)
NORTH = Translate(0.0, 5.0)


def load(polygon: shapely.Polygon) -> HeldObject:
    return HeldObject("o1", polygon, polygon, OUTLINE_TOLERANCE, proven=True, inexact=True)


def no_clash(_: HeldObject) -> int:
    return 0


@given(st.floats(-0.5, 0.5), st.floats(-0.4, 0.4), st.floats(-20, 20))
@settings(max_examples=60, deadline=None)
def test_a_blocked_object_touches_the_obstacle_at_the_nearest_place(x: float, y: float, degrees: float) -> None:
    square = rotate(shapely.box(-2, -2, 2, 2), degrees)
    square = translate(square, 0.3 - square.bounds[2], 4 - square.bounds[3])
    believed = translate(square, x, y)
    found = lean_on_obstacle(load(believed), NORTH, WALLS, no_clash)
    moved = math.dist(believed.centroid.coords[0], found.polygon.centroid.coords[0])
    assert moved <= MAX_LEANING_DISTANCE + 1e-9
    if found.polygon.equals(believed):
        return
    assert found.polygon.intersection(BOTH).area < 1e-6
    assert translate(found.polygon, 0, 0.05).intersection(BOTH).area > 0
    assert found.slack >= OUTLINE_TOLERANCE


def test_the_nearer_side_of_a_door_blocked_it() -> None:
    believed = shapely.box(0.1, -0.5, 4.1, 3.5)
    found = lean_on_obstacle(load(believed), NORTH, WALLS, no_clash).polygon
    assert found.bounds[0] < 0
    assert found.bounds[3] == pytest.approx(4)
    far = lean_on_obstacle(load(shapely.box(1.0, 0.0, 5.0, 4.0)), NORTH, WALLS, no_clash)
    assert far.polygon.bounds == (1.0, 0.0, 5.0, 4.0)  # nothing near can have blocked it


def test_a_place_that_contradicts_the_observation_is_not_believed() -> None:
    believed = load(shapely.box(0.1, 0.0, 4.1, 4.0))
    assert lean_on_obstacle(believed, NORTH, WALLS, lambda lying: lying is not believed) is believed
    right = lean_on_obstacle(believed, NORTH, WALLS, lambda lying: lying.polygon.bounds[0] <= 0.0)
    assert right is believed  # the other jamb is too far away
    assert lean_on_obstacle(believed, Rotate(30.0, (0.0, 0.0)), WALLS, no_clash) is believed


def test_after_slips_an_object_never_lies_exactly_on_squares() -> None:
    exact = replace(load(shapely.box(0, -4, 4, 0)), inexact=False, slack=0.0)
    for thing in (exact, replace(exact, inexact=True)):
        moved = object_after(thing, predicted_outcome((0.5, -4.5), thing.polygon, Translate(0.0, 2.0)), 0, "north")
        assert moved.polygon.bounds == (0, -2, 4, 2)
        assert moved.slack == (OUTLINE_TOLERANCE if thing.inexact else 0.0)


def test_an_object_thwarted_again_for_no_reason_is_inexact() -> None:
    thing = replace(load(shapely.box(0, -4, 4, 0)), inexact=False, slack=0.0)
    once = object_after(thing, None, 0, "north")
    assert (once.resisted, once.inexact) == (("north",), False)
    assert object_after(once, None, 0, "north").inexact
    assert not object_after(once, None, 0, "north", suspected=True).inexact
    moved = object_after(once, predicted_outcome((0.5, -4.5), thing.polygon, Translate(0.0, 2.0)), 0, "north")
    assert object_after(moved, None, 0, "north").inexact
    unproven = object_after(object_after(replace(thing, proven=False), None, 0, "north"), None, 0, "north")
    assert (unproven.resisted, unproven.inexact) == (("north",) * 2, False)  # the hand may be empty
