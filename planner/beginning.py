"""Where things lay when they were first meant, and what is lost of that since.

Some goals hold by where something began. Of that place he may be wrong himself, once he was lost; and where something
is next to depends on the doors of the room where it began. When looks contradict what is believed, one of these may be
lost from the map: then the room behind it seems to be one with the first, and the next one is another.
"""

import math
from typing import NamedTuple

from kb.worldmodel import Node, WorldModel
from planner.destinations import Situation

Place = tuple[float, float]
SAME = 3.0  # squares that a door may have come to lie elsewhere


class Beginning(NamedTuple):
    """Where the middle of something lay at first, in Utak's own frame.

    name : of its node. moved : has he moved it since? anew : had he been lost before then? doors : the middles of those
    of its room, in Utak's own frame, as they were believed before it was moved.
    """

    place: Place
    name: str
    moved: bool = False
    anew: bool = False
    doors: tuple[Place, ...] = ()


class Beginnings:
    """Remembers for each parameter of the task where what it means began."""

    def __init__(self) -> None:
        self._known: dict[str, Beginning] = {}

    def at(self, parameter: str, node: Node, model: WorldModel) -> Place:
        """The point of the lattice where the middle of what a parameter means lay at first.

        What he has moved and then lost sight of is the same thing still when he takes up another one for it.
        """
        known = self._known.get(parameter)
        gone = known is not None and known.moved and model.object(known.name) is None
        if known is None or (known.name != node.name and not gone):
            place = model.lattice.place_to_utak(node.polygon.centroid.x, node.polygon.centroid.y)
            known = Beginning(place, node.name, anew=model.anew, doors=() if known is None else known.doors)
        self._known[parameter] = known = known._replace(name=node.name, moved=known.moved or node.moved)
        return model.lattice.place_from_utak(*known.place)

    def lost(self, parameter: str, node: Node, situation: Situation) -> str:
        """What is lost, in words, since what a parameter means lay where it began; nothing when nothing is.

        Who was lost himself may be squares from where he says.
        """
        began = self.at(parameter, node, situation.model)
        missed = self._misses_a_door(parameter, node, began, situation)
        if situation.model.anew and not self._known[parameter].anew:
            return "he was lost"
        return "a door of its room was lost" if missed else ""

    def _misses_a_door(self, parameter: str, node: Node, began: Place, situation: Situation) -> bool:
        """Is a door of the room where something began believed no more, while looks contradict what is believed?"""
        model, rooms, known = situation.model, situation.rooms, self._known[parameter]
        if not node.moved:
            room = int(rooms.labels[model.view.locate(*began)])
            doors = tuple(model.place_to_utak(*door.place) for door in rooms.leading(room))
            self._known[parameter] = known._replace(doors=doors)
            return False
        if not model.shaken:
            return False
        now = [model.place_to_utak(*door.place) for door in rooms.sure]
        return any(all(math.dist(was, door) > SAME for door in now) for was in known.doors)
