"""Where things lay when they were first meant, and what is lost of that since.

Some goals hold by where something began. Of that place he may be wrong himself, once he was lost; and where something
is next to depends on the doors of the room where it began. When looks contradict what is believed, one of these may be
lost from the map: then the room behind it seems to be one with the first, and the next one is another.
"""

import math
from typing import NamedTuple

from kb.world.model import Node
from planner.situation import Situation

Place = tuple[float, float]
SAME = 3.0  # squares that a door may have come to lie elsewhere


class Origin(NamedTuple):
    """Where the middle of something lay at first, in Utak's own frame.

    name : of its node. moved : has he moved it since? anew : had he been lost before then? doors : the middles of those
    of its room, in Utak's own frame, as they were believed before it was moved.
    """

    place: Place
    name: str
    moved: bool = False
    anew: bool = False
    doors: tuple[Place, ...] = ()


class Origins:
    """Remembers for each parameter of the task where what it means began."""

    def __init__(self) -> None:
        self._known: dict[str, Origin] = {}

    def at(self, parameter: str, node: Node, situation: Situation) -> Place:
        """The point of the lattice where the middle of what a parameter means lay at first: noted now, or before.

        What he has moved and then lost sight of is the same thing still when he takes up another one for it.
        """
        model, known = situation.model, self._known.get(parameter)
        gone = known is not None and known.moved and model.object(known.name) is None
        if known is None or (known.name != node.name and not gone):
            place = model.frame.place_to_utak(node.polygon.centroid.x, node.polygon.centroid.y)
            known = Origin(place, node.name, anew=model.anew, doors=() if known is None else known.doors)
        began = model.frame.place_from_utak(*known.place)
        doors = known.doors if node.moved else _doors_of_its_room(began, situation)
        self._known[parameter] = known._replace(name=node.name, moved=known.moved or node.moved, doors=doors)
        return began

    def lost(self, parameter: str, node: Node, situation: Situation) -> str:
        """What is lost, in words, since what a parameter means lay where it was noted; nothing when nothing is.

        Who was lost himself may be squares from where he says. A door may be believed no more only where looks
        contradict what is believed.
        """
        known, model = self._known[parameter], situation.model
        if model.anew and not known.anew:
            return "he was lost"
        now = [model.place_to_utak(*door.place) for door in situation.rooms.sure]
        gone = any(all(math.dist(was, door) > SAME for door in now) for was in known.doors)
        return "a door of its room was lost" if gone and node.moved and model.shaken else ""

    def left(self, parameter: str, node: Node, situation: Situation) -> bool:
        """Does what a parameter means lie in another room than where it was noted?"""
        rooms, view = situation.rooms.labels, situation.model.view
        began = situation.model.frame.place_from_utak(*self._known[parameter].place)
        now = node.polygon.centroid.x, node.polygon.centroid.y
        return bool(rooms[view.locate(*began)] != rooms[view.locate(*now)])


def _doors_of_its_room(began: Place, situation: Situation) -> tuple[Place, ...]:
    """The middles of the doors of the room where something lies, in Utak's own frame."""
    model, rooms = situation.model, situation.rooms
    room = int(rooms.labels[model.view.locate(*began)])
    return tuple(model.place_to_utak(*door.place) for door in rooms.leading(room))
