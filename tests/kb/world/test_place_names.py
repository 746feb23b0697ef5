"""Names of doors and rooms: they last as long as the thing, and are never given to another one."""

from dataclasses import replace

import numpy as np

from tests.planner.situations import known_situation
from tests.planner.tasking.test_rules import WALKER
from utak.kb.world.place_names import PlaceNames
from utak.kb.world.rooms import Door, Rooms, rooms_of


def test_a_door_keeps_its_name_and_gives_it_to_no_other() -> None:
    """The west door is not believed for a while; meanwhile the east one is not called d1, whatever its number."""
    model = known_situation(WALKER).model
    both = rooms_of(model)
    first, second = both.doors
    names = PlaceNames()

    def called(*doors: Door) -> dict[Door, str]:
        """Return the names that some of the two doors get, by the door as it is numbered afresh."""
        fresh = [replace(door, name=f"d{number}") for number, door in enumerate(doors, 1)]
        rooms: Rooms = names.named(replace(both, doors=tuple(fresh)), model)
        return {door: one.name for door, one in zip(doors, rooms.doors, strict=True)}

    assert called(second) == {second: "d1"}
    assert called(first, second) == {first: "d2", second: "d1"}
    assert called(first) == {first: "d2"}
    assert called(second, first) == {first: "d2", second: "d1"}


def test_a_door_that_may_be_one_has_the_name_that_it_bears_later() -> None:
    """What may be a door gets no name of another door, and is called the same once it is one."""
    model = known_situation(WALKER).model
    both = rooms_of(model)
    first, second = both.doors
    names = PlaceNames()
    (sure,) = names.named(replace(both, doors=(second,)), model).doors
    (possible,) = names.doors_named((first,), model, (sure,))
    (other,) = names.doors_named((second,), model, (sure,))
    assert (sure.name, possible.name, other.name) == ("d1", "d2", "d3")
    assert [door.name for door in names.named(both, model).doors] == ["d2", "d1"]


def test_rooms_keep_their_numbers_when_they_are_parted_and_joined() -> None:
    """A room that was joined with another one for a while has its own number again."""
    model = known_situation(WALKER).model
    apart = rooms_of(model)
    numbers = {side for door in apart.doors for side in door.sides}
    low, high = min(numbers), max(numbers)
    joined = apart.labels.copy()
    joined[joined == high] = low
    together = replace(apart, labels=joined, doors=())
    names = PlaceNames()
    assert (names.named(apart, model).labels == apart.labels).all()
    assert set(names.named(together, model).labels.ravel().tolist()) == {0} | numbers - {high}
    swapped = apart.labels.copy()
    swapped[apart.labels == high], swapped[apart.labels == low] = low, high
    sides = {low: high, high: low}
    doors = tuple(replace(one, sides=tuple(sides.get(n, n) for n in one.sides)) for one in apart.doors)
    again = names.named(replace(apart, labels=swapped, doors=doors), model)
    assert (again.labels == apart.labels).all()
    assert [door.sides for door in again.doors] == [door.sides for door in apart.doors]


def test_the_room_of_waking_is_r1_and_a_door_that_was_seen_wider_is_the_same() -> None:
    """The room of waking is small beside what it was joined with; a wall was seen that makes a door narrower."""
    situation = known_situation(WALKER)
    model, apart = situation.model, situation.rooms
    joined = apart.labels.copy()
    joined[joined > 0] = 1
    home = int(apart.labels[model.view.locate(*model.frame.origin)])
    names = PlaceNames()
    # All is one room at first, and then the part in which the robot woke is the smaller one.
    small = np.where(apart.labels > 0, 2, 0)
    row, column = model.view.locate(*model.frame.origin)
    small[row, column] = 1
    names.named(replace(apart, labels=joined, doors=()), model)
    assert names.named(replace(apart, labels=small, doors=()), model).labels[row, column] == home == 1
    (door, *_) = apart.doors
    (ax, ay), (bx, by) = door.a, door.b
    wide = replace(door, b=(bx + 1.5 * (bx - ax), by + 1.5 * (by - ay)))
    (first,) = names.named(replace(apart, doors=(wide,)), model).doors
    (then,) = names.named(replace(apart, doors=(door,)), model).doors
    assert first.name == then.name
