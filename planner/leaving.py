"""What is remembered of the rooms in which things began, for goals that hold once they have left them.

Where something is next to depends on the doors of the room where it began. When looks contradict what is believed, one
of these may be lost from the map: then the room behind it seems to be one with the first, and the next one is another.
"""

import math

from kb.rooms import Door
from kb.worldmodel import Node
from planner.destinations import Situation

Place = tuple[float, float]
SAME = 3.0  # squares that a door may have come to lie elsewhere


class Leaving:
    """Remembers the doors of the rooms in which things began, as they were believed before those were moved."""

    def __init__(self) -> None:
        self._doors: dict[str, list[Place]] = {}  # by what means the thing: their middles, in Utak's own frame

    def misses_a_door(self, parameter: str, node: Node, began: Place, situation: Situation) -> bool:
        """Is a door of the room where something began believed no more, while looks contradict what is believed?

        parameter : of the task, that means the object. began : a point of the lattice.
        """
        model = situation.model
        if not node.moved:
            row, column = model.view.locate(*began)
            room = int(situation.rooms.labels[row, column])
            leading = (door for door in situation.rooms.doors if door.sure and room in door.sides)
            self._doors[parameter] = [_own(door, situation) for door in leading]
        if not (node.moved and model.shaken):
            return False
        known = [_own(door, situation) for door in situation.rooms.doors if door.sure]
        return any(all(math.dist(was, now) > SAME for now in known) for was in self._doors.get(parameter, ()))


def _own(door: Door, situation: Situation) -> Place:
    """The middle of a door, in Utak's own frame."""
    model = situation.model
    return model.lattice.place_to_utak(door.place[0] + model.view.west, door.place[1] + model.view.south)
