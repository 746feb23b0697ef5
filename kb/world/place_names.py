"""The names of doors and rooms, kept from one impression to the next: by place, and never given to another one.

Rules of users, questions and plans that name d2 mean the same door in the whole run.
"""

from collections.abc import Container, Mapping, Sequence
from dataclasses import replace

import numpy as np
from shapely import LineString

from utak.geometry.kernels.arrays import Longs
from utak.kb.world.model import WorldModel
from utak.kb.world.rooms import NO_ROOM, SAME_DOOR, Door, Rooms

WAKING_ROOM = 1  # the number of the room in which the robot woke, as kb/asp/belief.lp says
MIN_SHARE = 0.25  # of a room's squares that are in another one, for it to be the same room; a convention
CODE_BASE = 1 << 20  # more than the squares of any table's side: a square's (east, north) as one number


class PlaceNames:
    """Remembers where each door and each room was believed last, in the robot frame, and names new ones."""

    def __init__(self) -> None:
        self._doors: dict[int, LineString] = {}  # by the number of a door: its neck, from wall to wall
        self._rooms: dict[int, Longs] = {}  # by the number of a room: its squares, each as one number, sorted

    def named(self, rooms: Rooms, model: WorldModel) -> Rooms:
        """Return rooms and doors under the names that they have for good; remember where they are."""
        found = {int(n): _squares_of(int(n), rooms, model) for n in np.unique(rooms.labels) if n != NO_ROOM}
        home = int(rooms.labels[model.view.locate(*model.frame.origin)])
        numbers = {NO_ROOM: NO_ROOM} | self._same_rooms(found, {home: WAKING_ROOM} if home in found else {})
        for number in found:
            numbers.setdefault(number, max([WAKING_ROOM, *self._rooms, *numbers.values()]) + 1)
        for number in sorted({side for door in rooms.doors for side in door.sides} - numbers.keys()):
            numbers[number] = max([*self._rooms, *numbers.values()]) + 1
        self._rooms |= {numbers[number]: squares for number, squares in found.items()}
        doors = tuple(
            replace(door, sides=(numbers[door.sides[0]], numbers[door.sides[1]]))
            for door in self.doors_named(rooms.doors, model)
        )
        table = np.zeros(max(numbers) + 1, np.int32)
        table[list(numbers)] = list(numbers.values())
        return replace(rooms, doors=doors, labels=table[rooms.labels])

    def doors_named(self, doors: Sequence[Door], model: WorldModel, others: Sequence[Door] = ()) -> tuple[Door, ...]:
        """Return doors under the names that they have for good, none that of others; remember where they are."""
        necks = [LineString([model.place_to_utak(*door.a), model.place_to_utak(*door.b)]) for door in doors]
        known = self._same_doors(necks, {door.name for door in others})
        for index, neck in enumerate(necks):
            self._doors[known.setdefault(index, max(self._doors, default=0) + 1)] = neck
        return tuple(replace(door, name=f"d{known[index]}") for index, door in enumerate(doors))

    def _same_rooms(self, found: Mapping[int, Longs], same: dict[int, int]) -> dict[int, int]:
        """Return the numbers that rooms had before, by their present ones; each at most once."""
        shares = [
            (-np.isin(squares, now, assume_unique=True).mean(), known, number)
            for known, squares in self._rooms.items()
            for number, now in found.items()
        ]
        for share, known, number in sorted(shares):
            if -share >= MIN_SHARE and number not in same and known not in same.values():
                same[number] = known
        return same

    def _same_doors(self, necks: Sequence[LineString], taken: Container[str]) -> dict[int, int]:
        """Return the numbers that doors at some places had before, by the index of the neck; each at most once."""
        # What was seen of its walls since may have made a neck narrower or wider.
        away = [
            (neck.centroid.distance(known.centroid), number, index)
            for index, neck in enumerate(necks)
            for number, known in self._doors.items()
            if f"d{number}" not in taken
            and min(neck.distance(known.centroid), known.distance(neck.centroid)) <= SAME_DOOR
        ]
        same: dict[int, int] = {}
        for _, number, index in sorted(away):
            if index not in same and number not in same.values():
                same[index] = number
        return same


def _squares_of(number: int, rooms: Rooms, model: WorldModel) -> Longs:
    """Return the squares of a room in the robot frame, each once as one number, sorted."""
    points = np.argwhere(rooms.labels == number)[:, ::-1] + 0.5
    east, north = model.place_to_utak(*points.T)
    squares: Longs = np.unique(np.floor(east).astype(np.int64) * CODE_BASE + np.floor(north).astype(np.int64))
    return squares
