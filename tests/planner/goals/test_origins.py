"""Where a thing began is remembered, and what is lost of that since is said."""

from dataclasses import replace

import pytest
import shapely
import shapely.affinity

from kb.world.rooms import Rooms
from planner.goals.origins import Origins
from planner.situation import Situation
from tests.kb.drawings import seen_whole
from tests.planner.situations import BESIDE_A_THING, situation_of

TWO_ROOMS = [
    "b" * 33,
    *["b" + "." * 15 + "b" + "." * 15 + "b"] * 5,
    "b" + "." * 4 + "ggg" + "." * 24 + "b",
    "b" + "." * 4 + "ggg" + "." * 3 + "U" + "." * 20 + "b",
    "b" + "." * 4 + "ggg" + "." * 24 + "b",
    *["b" + "." * 15 + "b" + "." * 15 + "b"] * 5,
    "b" * 33,
]


def now(shaken: bool, rooms: Rooms | None = None, moved: bool = True) -> Situation:
    """What is believed of two rooms and a thing in one. rooms : instead of those that are."""
    model = seen_whole(TWO_ROOMS)
    (node,) = model.objects
    west, south = node.patch.west, node.patch.south
    node = replace(node, polygon=shapely.box(west, south, west + 3, south + 3), moved=moved)
    found = situation_of(replace(model, objects=(node,), shaken=shaken))
    return replace(found, rooms=rooms or found.rooms)


def missed(beginnings: Origins, situation: Situation) -> bool:
    (node,) = situation.model.objects
    beginnings.at("x", node, situation)
    return bool(beginnings.lost("x", node, situation))


@pytest.mark.parametrize("shaken", [False, True])
def test_a_door_that_is_lost_when_looks_contradict_is_missed(shaken: bool) -> None:
    beginnings, before = Origins(), now(shaken=False, moved=False)
    (door,) = before.rooms.doors
    assert door.sure
    assert not missed(beginnings, before)
    assert not missed(beginnings, now(shaken))
    assert missed(beginnings, now(shaken, replace(before.rooms, doors=()))) == shaken
    unsure = replace(before.rooms, doors=(replace(door, confidence=30),))
    assert missed(beginnings, now(shaken, unsure)) == shaken


def test_doors_are_remembered_as_they_are_when_a_thing_is_taken() -> None:
    none, beginnings = replace(now(shaken=False).rooms, doors=()), Origins()
    assert not missed(beginnings, now(shaken=True, rooms=none))
    assert not missed(beginnings, now(shaken=True, moved=False))
    assert missed(beginnings, now(shaken=True, rooms=none))
    assert not missed(beginnings, now(shaken=True, rooms=none, moved=False))
    assert not missed(beginnings, now(shaken=True, rooms=none))


@pytest.mark.parametrize(("aside", "lost"), [(2.0, False), (5.0, True)])
def test_a_door_may_come_to_lie_a_little_elsewhere(aside: float, lost: bool) -> None:
    beginnings, before = Origins(), now(shaken=False, moved=False)
    missed(beginnings, before)
    (door,) = before.rooms.doors
    (ax, ay), (bx, by) = door.a, door.b
    elsewhere = replace(door, a=(ax + aside, ay), b=(bx + aside, by))
    assert missed(beginnings, now(shaken=True, rooms=replace(before.rooms, doors=(elsewhere,)))) == lost


def test_where_a_thing_began_is_remembered_though_its_name_is_not() -> None:
    beginnings, situation = Origins(), situation_of(seen_whole(BESIDE_A_THING))
    (node,) = situation.model.objects

    def began(name: str, east: int, moved: bool, others: tuple[str, ...] = ()) -> float:
        there = replace(node, name=name, polygon=shapely.box(east, 0, east + 2, 2), moved=moved)
        objects = (there, *(replace(node, name=other) for other in others))
        x, y = beginnings.at("x", there, situation_of(replace(situation.model, objects=objects)))
        assert y == pytest.approx(1.0)
        return x

    assert began("o1", 0, False) == pytest.approx(1.0)
    assert began("o1", 1, False) == pytest.approx(1.0)  # it is only seen better
    assert began("o2", 5, False, ("o1",)) == pytest.approx(6.0)  # another thing is meant
    assert began("o2", 9, True) == pytest.approx(6.0)
    assert began("o3", 10, False) == pytest.approx(6.0)  # the same, after all names were lost
    assert began("o4", 12, False, ("o3",)) == pytest.approx(13.0)


@pytest.mark.parametrize(("before", "lost"), [(False, "the robot was lost"), (True, "")])
def test_who_was_lost_does_not_know_where_a_thing_began_that_he_took_before(before: bool, lost: str) -> None:
    beginnings, model = Origins(), situation_of(seen_whole(BESIDE_A_THING)).model
    (node,) = model.objects
    node = replace(node, polygon=shapely.box(5, 0, 7, 2))
    beginnings.at("x", node, situation_of(replace(model, anew=before)))

    def said(parameter: str, anew: bool) -> str:
        situation = situation_of(replace(model, anew=anew))
        beginnings.at(parameter, node, situation)
        return beginnings.lost(parameter, node, situation)

    assert not said("x", anew=False)
    assert said("x", anew=True) == lost
    assert not said("y", anew=True)


def test_what_lies_in_another_room_has_left_its_own() -> None:
    beginnings, before = Origins(), now(shaken=False, moved=False)
    (node,) = before.model.objects
    beginnings.at("x", node, before)
    assert not beginnings.left("x", node, before)
    there = replace(node, polygon=shapely.affinity.translate(node.polygon, 16.0))
    assert beginnings.left("x", there, before)
    here = replace(node, polygon=shapely.affinity.translate(node.polygon, 2.0))
    assert not beginnings.left("x", here, before)
