"""Origins: where the things of the task were at first, and when that knowledge is lost.

Some goals depend on where something was at first, or on where the robot woke. The robot may be wrong about that place
itself, once it was lost. What is the next room depends on the doors of the room where the thing was. When observations
contradict what is believed, a door may disappear from the map. Then two rooms seem to be one, and another room seems to
be the next one.
"""

import math
from typing import NamedTuple

from utak.geometry.kernels.arrays import XY
from utak.kb.language.terms import Fact
from utak.kb.world.model import Node
from utak.planner.situation import Situation
from utak.planner.stages import ORIGIN_GOALS, rests_on_waking

DOOR_TOLERANCE = 3.0  # squares by which the believed place of a door may change while it counts as the same (tuned)


class Origin(NamedTuple):
    """The place where the middle of a thing was at first."""

    place: XY  # the point (east, north), in squares, in the robot's own frame (east and north of where it woke)
    name: str  # the name of the node
    moved: bool = False  # whether the robot has moved it since
    anew: bool = False  # whether the robot had been lost, and had begun its map anew, before the place was noted
    # The middles of the doors of its room, as points of the robot's own frame in squares, as believed before it was
    # moved
    doors: tuple[XY, ...] = ()


class Origins:
    """Remembers for each parameter of the task where the thing that it means was at first (see `Origin`)."""

    # `lost` raises KeyError unless `at` was asked about the parameter before.

    def __init__(self) -> None:
        """Remember no origin yet."""
        self._known: dict[str, Origin] = {}

    def at(self, parameter: str, node: Node, situation: Situation) -> XY:
        """Return where the middle of a thing was at first, and note it when the thing is new."""
        model, known = situation.model, self._known.get(parameter)
        gone = known is not None and known.moved and model.object(known.name) is None
        if known is None or (known.name != node.name and not gone):
            place = model.frame.place_to_utak(node.polygon.centroid.x, node.polygon.centroid.y)
            known = Origin(place, node.name, anew=model.anew, doors=() if known is None else known.doors)
        began = model.frame.place_from_utak(*known.place)
        doors = known.doors if node.moved else _doors_of_its_room(began, situation)
        self._known[parameter] = known._replace(name=node.name, moved=known.moved or node.moved, doors=doors)
        return began

    def lost(self, goal: Fact, node: Node, situation: Situation) -> str:
        """Return in words why it is not reliable any more where a goal for a thing holds; "" while it is."""
        known, model = self._known[str(goal.args[0])], situation.model
        if rests_on_waking(goal) and model.anew:
            return "the robot was lost since it woke"
        if goal.name not in ORIGIN_GOALS:
            return ""
        if model.anew and not known.anew:
            return f"the robot was lost since {node.name} was grasped"
        now = [model.place_to_utak(*door.place) for door in situation.rooms.sure]
        gone = any(all(math.dist(was, door) > DOOR_TOLERANCE for door in now) for was in known.doors)
        doubtful = gone and node.moved and model.shaken
        return f"a door of its room was lost since {node.name} was grasped" if doubtful else ""


def _doors_of_its_room(place: XY, situation: Situation) -> tuple[XY, ...]:
    """Return the middles of the doors of the room that holds a place, (east, north) in the robot's own frame."""
    model, rooms = situation.model, situation.rooms
    room = int(rooms.labels[model.view.locate(*place)])
    return tuple(model.place_to_utak(*door.place) for door in rooms.leading(room))
