"""The names of doors and rooms, kept from one impression to the next: by place, and never given to another one.

Rules of users, questions and plans that name d2 mean the same door in the whole run.
"""

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from geometry.kernels.arrays import XY, Longs
from kb.world.model import WorldModel
from kb.world.rooms import NO_ROOM, Rooms

SAME_DOOR = 1.5  # squares between the middles of what is one door, as it was and as it is believed now; a convention
MIN_SHARE = 0.25  # of a room's squares that are in another one, for it to be the same room; a convention
CODE_BASE = 1 << 20  # more than the squares of any table's side: a square's (east, north) as one number


class PlaceNames:
    """Remembers where each door and each room was believed last, in the robot frame, and names new ones."""

    def __init__(self) -> None:
        self._doors: dict[int, XY] = {}  # by the number of a door: the middle of its neck
        self._rooms: dict[int, Longs] = {}  # by the number of a room: its squares, each as one number, sorted

    def named(self, rooms: Rooms, model: WorldModel) -> Rooms:
        """Return rooms and doors under the names that they have for good; remember where they are."""
        found = {int(n): _squares_of(int(n), rooms, model) for n in np.unique(rooms.labels) if n != NO_ROOM}
        numbers = {NO_ROOM: NO_ROOM} | self._same_rooms(found)
        for number in found:
            numbers.setdefault(number, max([*self._rooms, *numbers.values()], default=0) + 1)
        for number in sorted({side for door in rooms.doors for side in door.sides} - numbers.keys()):
            numbers[number] = max([*self._rooms, *numbers.values()]) + 1
        self._rooms |= {numbers[number]: squares for number, squares in found.items()}
        places = [model.place_to_utak(*door.place) for door in rooms.doors]
        known = self._same_doors(places)
        for index, place in enumerate(places):
            self._doors[known.setdefault(index, max(self._doors, default=0) + 1)] = place
        doors = tuple(
            replace(door, name=f"d{known[index]}", sides=(numbers[door.sides[0]], numbers[door.sides[1]]))
            for index, door in enumerate(rooms.doors)
        )
        table = np.zeros(max(numbers) + 1, np.int32)
        table[list(numbers)] = list(numbers.values())
        return replace(rooms, doors=doors, labels=table[rooms.labels])

    def _same_rooms(self, found: Mapping[int, Longs]) -> dict[int, int]:
        """Return the numbers that rooms had before, by their present ones; each at most once."""
        shares = [
            (-np.isin(squares, now, assume_unique=True).mean(), known, number)
            for known, squares in self._rooms.items()
            for number, now in found.items()
        ]
        same: dict[int, int] = {}
        for share, known, number in sorted(shares):
            if -share >= MIN_SHARE and number not in same and known not in same.values():
                same[number] = known
        return same

    def _same_doors(self, places: list[XY]) -> dict[int, int]:
        """Return the numbers that doors at some places had before, by the index of the place; each at most once."""
        away = [
            (math.dist(place, known), number, index)
            for index, place in enumerate(places)
            for number, known in self._doors.items()
        ]
        same: dict[int, int] = {}
        for distance, number, index in sorted(away):
            if distance <= SAME_DOOR and index not in same and number not in same.values():
                same[index] = number
        return same


def _squares_of(number: int, rooms: Rooms, model: WorldModel) -> Longs:
    """Return the squares of a room in the robot frame, each once as one number, sorted."""
    points = np.argwhere(rooms.labels == number)[:, ::-1] + 0.5
    east, north = model.place_to_utak(*points.T)
    squares: Longs = np.unique(np.floor(east).astype(np.int64) * CODE_BASE + np.floor(north).astype(np.int64))
    return squares
