"""The origins of things are remembered, and their loss is noticed."""

from dataclasses import replace

import pytest
import shapely
import shapely.affinity

from tests.kb.drawings import known_model
from tests.planner.situations import BESIDE_A_THING, situation_of
from utak.kb.language.reader import facts_from_text
from utak.kb.world.rooms import Rooms
from utak.planner.goals.origins import Origins
from utak.planner.situation import Situation

TWO_ROOMS = [
    "b" * 33,
    *["b" + "." * 15 + "b" + "." * 15 + "b"] * 5,
    "b" + "." * 4 + "ggg" + "." * 24 + "b",
    "b" + "." * 4 + "ggg" + "." * 3 + "U" + "." * 20 + "b",
    "b" + "." * 4 + "ggg" + "." * 24 + "b",
    *["b" + "." * 15 + "b" + "." * 15 + "b"] * 5,
    "b" * 33,
]
(NEXT_ROOM,) = facts_from_text("in(x, room(next)).")


def now(shaken: bool, rooms: Rooms | None = None, moved: bool = True) -> Situation:
    """Return the situation of two rooms with an object in one. rooms : replace the true ones."""
    model = known_model(TWO_ROOMS)
    (node,) = model.objects
    west, south = node.patch.west, node.patch.south
    node = replace(node, polygon=shapely.box(west, south, west + 3, south + 3), moved=moved)
    found = situation_of(replace(model, objects=(node,), shaken=shaken))
    return replace(found, rooms=rooms or found.rooms)


def missed(origins: Origins, situation: Situation) -> bool:
    (node,) = situation.model.objects
    origins.at("x", node, situation)
    return bool(origins.lost(NEXT_ROOM, node, situation))


@pytest.mark.parametrize("shaken", [False, True])
def test_a_door_lost_while_observations_contradict_is_missed(shaken: bool) -> None:
    origins, before = Origins(), now(shaken=False, moved=False)
    (door,) = before.rooms.doors
    assert door.sure
    assert not missed(origins, before)
    assert not missed(origins, now(shaken))
    assert missed(origins, now(shaken, replace(before.rooms, doors=()))) == shaken
    unsure = replace(before.rooms, doors=(replace(door, confidence=30),))
    assert missed(origins, now(shaken, unsure)) == shaken


def test_doors_are_remembered_as_they_were_when_the_object_was_taken() -> None:
    none, origins = replace(now(shaken=False).rooms, doors=()), Origins()
    assert not missed(origins, now(shaken=True, rooms=none))
    assert not missed(origins, now(shaken=True, moved=False))
    assert missed(origins, now(shaken=True, rooms=none))
    assert not missed(origins, now(shaken=True, rooms=none, moved=False))
    assert not missed(origins, now(shaken=True, rooms=none))


@pytest.mark.parametrize(("aside", "lost"), [(2.0, False), (5.0, True)])
def test_a_door_may_move_a_little_on_the_map(aside: float, lost: bool) -> None:
    origins, before = Origins(), now(shaken=False, moved=False)
    missed(origins, before)
    (door,) = before.rooms.doors
    (ax, ay), (bx, by) = door.a, door.b
    elsewhere = replace(door, a=(ax + aside, ay), b=(bx + aside, by))
    assert missed(origins, now(shaken=True, rooms=replace(before.rooms, doors=(elsewhere,)))) == lost


def test_an_origin_is_remembered_when_the_name_changes() -> None:
    origins, situation = Origins(), situation_of(known_model(BESIDE_A_THING))
    (node,) = situation.model.objects

    def began(name: str, east: int, moved: bool, others: tuple[str, ...] = ()) -> float:
        there = replace(node, name=name, polygon=shapely.box(east, 0, east + 2, 2), moved=moved)
        objects = (there, *(replace(node, name=other) for other in others))
        x, y = origins.at("x", there, situation_of(replace(situation.model, objects=objects)))
        assert y == pytest.approx(1.0)
        return x

    assert began("o1", 0, False) == pytest.approx(1.0)
    assert began("o1", 1, False) == pytest.approx(1.0)  # the same object, seen better
    assert began("o2", 5, False, ("o1",)) == pytest.approx(6.0)  # another object is meant
    assert began("o2", 9, True) == pytest.approx(6.0)
    assert began("o3", 10, False) == pytest.approx(6.0)  # the same object, after all names were lost
    assert began("o4", 12, False, ("o3",)) == pytest.approx(13.0)


@pytest.mark.parametrize(("before", "lost"), [(False, "the robot was lost since o1 was grasped"), (True, "")])
def test_an_origin_noted_before_a_localisation_failure_is_lost(before: bool, lost: str) -> None:
    origins, model = Origins(), situation_of(known_model(BESIDE_A_THING)).model
    (node,) = model.objects
    node = replace(node, polygon=shapely.box(5, 0, 7, 2))
    origins.at("x", node, situation_of(replace(model, anew=before)))

    def said(parameter: str, anew: bool) -> str:
        situation = situation_of(replace(model, anew=anew))
        origins.at(parameter, node, situation)
        (goal,) = facts_from_text(f"in({parameter}, room(next)).")
        return origins.lost(goal, node, situation)

    assert not said("x", anew=False)
    assert said("x", anew=True) == lost
    assert not said("y", anew=True)
