"""Names of doors and rooms: they last as long as the thing, and are never given to another one."""

from dataclasses import replace

from kb.world.place_names import PlaceNames
from kb.world.rooms import Door, Rooms, rooms_of
from tests.planner.situations import known_situation
from tests.planner.tasking.test_rules import WALKER


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
