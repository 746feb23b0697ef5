"""Doors that the task forbids: which one is meant, and whether the robot went through it."""

from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest

import utak
from tests.kb.drawings import known_model
from tests.planner.carrying.test_carrying import run, scene
from tests.planner.goals.test_object_goals import facts_from_text
from tests.planner.situations import known_situation, situation_of
from utak.kb.task.task import Task
from utak.kb.world.rooms import Door, count_crossings, rooms_of, went_through
from utak.planner.deciding.keeping import ConstraintKeeper
from utak.planner.screen.projection import UNSEEN_LEVEL
from utak.planner.situation import Situation, possible_doors

DOOR = Door("d1", (5.0, 2.0), (5.0, 5.0), (1, 2), 99)
WALL = "b" + "." * 11 + "bb" + "." * 11 + "b"
OPEN = "b" + "." * 24 + "b"
BEGUN = "b..U" + "." * 8 + "bb" + "." * 11 + "b"
ONE_DOOR = ["b" * 26, *[WALL] * 4, BEGUN, *[OPEN] * 3, *[WALL] * 4, "b" * 26]
TWO_DOORS = [row[:-1] + ("." if row == OPEN else "b") + row[12:] for row in ONE_DOOR]  # and a third room
NEVER = Task({}, (), facts_from_text("not_through(utak, d)."))


@pytest.mark.parametrize(
    ("track", "through"),
    [
        ([(1, 3), (8, 3)], True),
        ([(1, 3), (8, 3), (1, 3)], True),  # there and back
        ([(1, 3), (4.9, 3)], False),
        ([(1, 8), (8, 8)], False),  # beside it
        ([(1, 3)], False),
        ([], False),
    ],
)
def test_a_track_over_the_neck_of_a_door_goes_through_it(track: list[tuple[float, float]], through: bool) -> None:
    assert went_through(np.array(track, float).reshape(-1, 2), DOOR) == through


def test_a_track_there_and_back_crosses_nothing_in_all() -> None:
    assert count_crossings(np.array([(1, 3), (8, 3), (1, 3)], float), DOOR) == 0


def situation(rows: list[str], confidence: int, *track: tuple[float, float]) -> Situation:
    """Return a situation in a drawn house whose doors all have one confidence. track : squares from the start."""
    found = situation_of(known_model(rows), task=NEVER)
    doors = tuple(replace(door, confidence=confidence) for door in found.rooms.doors)
    return replace(found, rooms=replace(found.rooms, doors=doors), track=((0.5, 0.5), *track))


def names(doors: tuple[Door, ...]) -> list[str]:
    return [door.name for door in doors]


def test_one_door_is_forbidden_and_others_may_be_used() -> None:
    assert len(situation(TWO_DOORS, 99).rooms.doors) == 2
    assert names(situation(TWO_DOORS, 99).forbidden("utak")) == ["d1"]


def test_no_door_may_be_used_while_none_is_sure() -> None:
    assert names(situation(TWO_DOORS, 40).forbidden("utak")) == ["d1", "d2"]
    assert names(situation(TWO_DOORS, 10).forbidden("utak")) == ["d1", "d2"]  # however unlikely


def test_a_door_that_the_robot_went_through_is_not_the_forbidden_one() -> None:
    (middle,) = situation(ONE_DOOR, 99).rooms.doors
    x, y = middle.place
    model = situation(ONE_DOOR, 99).model
    there = (x + model.view.west + 4.0, y + model.view.south)
    here = (x + model.view.west - 4.0, y + model.view.south)
    assert situation(ONE_DOOR, 99, here, there).avoided(NEVER.goals[0]) == ()
    assert names(situation(ONE_DOOR, 99, here).avoided(NEVER.goals[0])) == ["d1"]
    two = situation(TWO_DOORS, 99, here, there)
    left = two.avoided(NEVER.goals[0])
    assert len(left) == 1 and two.forbidden("utak") == left


def test_without_a_constraint_every_door_may_be_used() -> None:
    assert replace(situation(ONE_DOOR, 99), task=Task({}, (), ())).forbidden("utak") == ()


def two_rooms(door: tuple[int, int], mirrored: bool) -> str:
    """Return a world of two rooms, one above the other, and a door between two x; or its mirror image, as facts."""
    across = [
        (23, 21),
        (door[1], 21),
        (door[1], 23),
        (23, 23),
        (23, 43),
        (2, 43),
        (2, 23),
        (door[0], 23),
        (door[0], 21),
    ]
    ring = [*across, (2, 21), (2, 2), (23, 2)]
    utak = (14.5, 29.5)
    if mirrored:
        ring, utak = [(25 - x, y) for x, y in ring], (25 - utak[0], utak[1])
    hole = ", ".join(f"{x} {y}" for x, y in [*ring, ring[0]])
    verge = f'verge("POLYGON ((0 0, 25 0, 25 45, 0 45, 0 0), ({hole}))").'
    return f'table(25, 45).\n{verge}\nutak("POINT ({utak[0]} {utak[1]})", 270).\n'


@pytest.mark.long
@pytest.mark.parametrize(("door", "mirrored"), list(product([(5, 10), (8, 11), (16, 20)], [False, True])))
def test_the_robot_never_goes_through_the_only_door(door: tuple[int, int], mirrored: bool, tmp_path: Path) -> None:
    goals = "in(utak, room(next)). not_through(utak, d)."
    found = run(scene(tmp_path, two_rooms(door, mirrored), "door(d).", goals))
    assert found.result.verdict == "possible_if" and "not_through(utak,d) leaves no way" in found.result.reason
    assert found.session.table.utak[1] > 22.0


def test_no_way_leads_through_a_closed_door() -> None:
    found = replace(situation(ONE_DOOR, 99), task=Task({}, (), ()))
    (door,) = found.rooms.doors
    after = found.with_closed(frozenset({door.name}))
    beyond = found.rooms.beyond(1)
    assert (beyond & found.cost_maps.floor).any() and names(after.shut("utak")) == ["d1"]
    assert not (beyond & (after.cost_maps.distances[UNSEEN_LEVEL] >= 0)).any()


def test_a_thing_is_kept_from_one_door_too_and_from_done_when_it_went_through_all() -> None:
    task = Task({}, (), facts_from_text("not_through(x, d)."))
    found = replace(situation(ONE_DOOR, 99), task=task, binding={"x": "o1"})
    (door,) = found.rooms.doors
    x, y = door.place[0] + found.model.view.west, door.place[1] + found.model.view.south
    through = replace(found, carried={"o1": ((x - 4.0, y), (x + 4.0, y))})
    keeper = ConstraintKeeper(task)
    assert names(found.forbidden("o1")) == ["d1"] and found.forbidden("utak") == ()
    assert keeper.doubt_of_done(found) == ""
    assert "not_through(x,d)" in keeper.doubt_of_done(through) and "o1 went through" in keeper.doubt_of_done(through)


def test_who_went_through_a_door_that_rules_close_is_told_of_the_robot_and_of_things() -> None:
    found = replace(situation(ONE_DOOR, 99), task=Task({}, (), ()), closed=frozenset({"d1"}))
    (door,) = found.rooms.doors
    x, y = door.place[0] + found.model.view.west, door.place[1] + found.model.view.south
    assert found.closed_doors_passed == ()
    through = ((x - 4.0, y), (x + 4.0, y))
    assert replace(found, track=through).closed_doors_passed == (("utak", door),)
    assert replace(found, carried={"o1": through}).closed_doors_passed == (("o1", door),)
    assert replace(found, carried={"o1": through}, closed=frozenset()).closed_doors_passed == ()


def test_of_two_doors_the_narrower_one_is_left_alone_by_a_thing() -> None:
    task = Task({}, (), facts_from_text("not_through(x, d)."))
    found = replace(situation(TWO_DOORS, 99), task=task, binding={"x": "o1"})
    first, second = found.rooms.doors
    narrow = replace(
        second, b=(second.a[0] + (second.b[0] - second.a[0]) / 2, second.a[1] + (second.b[1] - second.a[1]) / 2)
    )
    found = replace(found, rooms=replace(found.rooms, doors=(first, narrow)))
    assert found.forbidden("o1") == (narrow,) and narrow.width < first.width


@pytest.mark.long
def test_what_must_not_go_through_one_of_two_doors_is_carried_through_the_other() -> None:
    """The thing stays where it is until the doors are known; the narrower one is kept shut to it."""
    world = (
        """table(42, 26).
verge("MULTIPOLYGON (((0 0, 0 26, 42 26, 42 0, 0 0), (22 6, 24 6, 24 2, 41 2, 41 25, 24 25, 24 22, 22 22, 22 25, """
        """2 25, 2 2, 22 2, 22 6)), ((22 10, 22 16, 24 16, 24 10, 22 10)))").
utak("POINT (28.5 6.5)", 0).
object(t1, n, "POLYGON ((29 16, 29 18, 31 18, 31 16, 29 16))").
"""
    )
    scenario = utak.Scenario.from_text(
        world=world,
        start="object(x). shape(x, square). door(d).",
        goal="in(x, room(next)). not_through(x, d).",
        expect='inside(t1, "POLYGON ((2 2, 22 2, 22 25, 2 25, 2 2))").'
        ' avoids(t1, "POLYGON ((22 6, 24 6, 24 10, 22 10, 22 6))").',
    )
    episode = utak.Run(scenario).finish()
    assert (episode.verdict, episode.achieved) == ("done", True)


@pytest.mark.parametrize("probability", [0.4, 0.9])
def test_what_is_hardly_seen_and_what_was_never_felt_may_bound_a_door(probability: float) -> None:
    """A rule about doors is broken for good by a walk through one that nobody thought of."""
    thing = [ONE_DOOR[0], OPEN, *[row.replace("bb.", "gg.") for row in ONE_DOOR[2:6]]]
    model = known_situation([*thing, *ONE_DOOR[6:]]).model
    view, sure = model.view, model.view.probability.copy()
    sure[1:5, 12:14] = probability  # the wall between the rooms, south of the door
    model = replace(model, view=view._replace(probability=sure))
    assert 3.0 in [door.width for door in possible_doors(model, rooms_of(model), ())]
