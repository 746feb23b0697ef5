"""What is remembered of the rooms in which things began, for goals that hold once they have left them.

Where something is next to depends on the doors of the room where it began. When looks contradict what is believed, one
of these may be lost from the map: then the room behind it seems to be one with the first, and the next one is another.
"""

import math

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
        model, rooms = situation.model, situation.rooms
        if not node.moved:
            room = int(rooms.labels[model.view.locate(*began)])
            self._doors[parameter] = [model.place_to_utak(*door.place) for door in rooms.leading(room)]
            return False
        if not model.shaken:
            return False
        known = [model.place_to_utak(*door.place) for door in rooms.sure]
        return any(all(math.dist(was, now) > SAME for now in known) for was in self._doors.get(parameter, ()))
