"""A thing has left its room by a door that was believed, or nothing is said of that."""

from dataclasses import replace

import pytest

from kb.rooms import Rooms
from planner.destinations import Situation
from planner.leaving import Leaving
from tests.kb.drawings import seen_whole
from tests.planner.situations import situation_of

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
    found = situation_of(replace(model, objects=(replace(node, moved=moved),), shaken=shaken))
    return replace(found, rooms=rooms or found.rooms)


def missed(leaving: Leaving, situation: Situation) -> bool:
    (node,) = situation.model.objects
    began = node.patch.west + 1.5, node.patch.south + 1.5
    return leaving.misses_a_door("x", node, began, situation)


@pytest.mark.parametrize("shaken", [False, True])
def test_a_door_that_is_lost_when_looks_contradict_is_missed(shaken: bool) -> None:
    leaving, before = Leaving(), now(shaken=False, moved=False)
    (door,) = before.rooms.doors
    assert door.sure
    assert not missed(leaving, before)
    assert not missed(leaving, now(shaken))
    assert missed(leaving, now(shaken, replace(before.rooms, doors=()))) == shaken
    unsure = replace(before.rooms, doors=(replace(door, confidence=30),))
    assert missed(leaving, now(shaken, unsure)) == shaken


def test_doors_are_remembered_as_they_are_when_a_thing_is_taken() -> None:
    none, leaving = replace(now(shaken=False).rooms, doors=()), Leaving()
    assert not missed(leaving, now(shaken=True, rooms=none))
    assert not missed(leaving, now(shaken=True, moved=False))
    assert missed(leaving, now(shaken=True, rooms=none))
    assert not missed(leaving, now(shaken=True, rooms=none, moved=False))
    assert not missed(leaving, now(shaken=True, rooms=none))


@pytest.mark.parametrize(("aside", "lost"), [(2.0, False), (5.0, True)])
def test_a_door_may_come_to_lie_a_little_elsewhere(aside: float, lost: bool) -> None:
    leaving, before = Leaving(), now(shaken=False, moved=False)
    missed(leaving, before)
    (door,) = before.rooms.doors
    (ax, ay), (bx, by) = door.a, door.b
    elsewhere = replace(door, a=(ax + aside, ay), b=(bx + aside, by))
    assert missed(leaving, now(shaken=True, rooms=replace(before.rooms, doors=(elsewhere,)))) == lost
