"""Measures of all that claims of start.lp speak of: where things are at first, their sizes, doors and rooms.

These are facts for kb/asp/reconciliation.lp, without full stops; none where the task claims no such thing.
"""

import re
from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
from shapely.affinity import translate

from utak.geometry.raster.components import with_edge_neighbours
from utak.geometry.raster.runs import mask_to_polygon
from utak.kb.language.arguments import decimal_value
from utak.kb.task.task import APPEARANCES, Claim, Task
from utak.kb.world.corners import Corner
from utak.kb.world.facts import Places
from utak.kb.world.model import Node, WorldModel, hundredths
from utak.kb.world.place_names import WAKING_ROOM
from utak.kb.world.rooms import NO_ROOM, Rooms

# What a claim is about, in words.
IN_WORDS = {"in": "room", "at": "corner", "against": "place", "beside": "neighbour", "joins": "room"}
NAME_OF_THING = re.compile(r"\bo[0-9]+\b")
NO_NAMES: Mapping[str, str] = MappingProxyType({})
SIZE_TOLERANCE = 0.1  # the share, besides one square, by which a size may be otherwise than counted; a convention
ROUNDING = 50  # hundredths: whoever says a width in squares means it to the nearest half of one; a convention
BESIDE_DISTANCE = 1.0  # squares between two things that are beside each other, at most (docs/files.md)
AT_CORNER_DISTANCE = 1.0  # squares between a thing and both walls of the corner at which it is (docs/files.md)


class _Said(NamedTuple):
    """A fact about where something is, and the things whose moving would change it."""

    fact: str
    about: frozenset[str]

    def renamed(self, names: Mapping[str, str]) -> "_Said":
        """Return the same of things that have other names now."""
        if not self.about & names.keys():
            return self
        fact = NAME_OF_THING.sub(lambda name: names.get(name[0], name[0]), self.fact)
        return _Said(fact, frozenset(names.get(name, name) for name in self.about))


class FirstPlaces:
    """The places of things as they were seen at first: they stay when the robot has moved the things."""

    def __init__(self) -> None:
        """Know nothing yet."""
        self._seen: frozenset[_Said] = frozenset()

    def facts(
        self, task: Task, model: WorldModel, places: Places, renamed: Mapping[str, str] = NO_NAMES
    ) -> tuple[str, ...]:
        """Return what the claims of a task are compared with, as it was before anything was moved."""
        # renamed : the next name of things that were moved, by the one before
        if all(claim.fact.name in APPEARANCES for claim in task.claims):
            return ()
        moved = {node.name for node in model.objects if node.moved}
        now = {said for said in _where_things_are(model, places) if not said.about & moved}
        before = {said.renamed(renamed) for said in self._seen}
        self._seen = frozenset({said for said in before if said.about & moved} | now)
        return (*sorted(said.fact for said in self._seen), *_doors_and_rooms(task, places.rooms))


def claim_facts(task: Task) -> Iterator[str]:
    """Yield the claims of a task, and the doors and rooms of which something is claimed."""
    for name, parameter in task.parameters.items():
        if name in task.described:
            yield f"described({name},{parameter.kind})"
    for claim in task.claims:
        yield from (f"{fact[:-1]},{claim.confidence})" for fact in _claimed(claim, task))


def _claimed(claim: Claim, task: Task) -> Iterator[str]:
    """Yield a claim in the words of the encoding, its confidence left out."""
    fact, (x, *values) = claim.fact, claim.fact.args
    if fact.name == "connects":
        yield from (f"related(joins,{x},{room})" for room in values)
    elif fact.name == "width":
        yield f"claim({x},width,{hundredths(decimal_value(values[0]))})"
    elif not values:
        yield f"claim({x},{fact.name},verge)"
    elif task.parameters.keys() & claim.named[1:]:
        yield f"related({fact.name},{x},{values[0]})"
    else:
        yield f"claim({x},{fact.name},{values[0]})"


def _size(node: Node) -> Iterator[str]:
    """Yield how many squares a thing covers where it lies, and whether no impression can change that."""
    covered = int(node.patch.mask.sum())
    least, most = (round(covered * (1 + side * SIZE_TOLERANCE) + side) for side in (-1, 1))
    yield f"measure({node.name},size,{max(least, 0)},{most},{100 * covered // max(covered + node.open, 1)})"
    yield from [f"settled({node.name},size)"] if node.open == 0 else []


def _doors_and_rooms(task: Task, rooms: Rooms) -> Iterator[str]:
    """Yield the doors and rooms that there are, and which doors join which rooms."""
    if not task.described:
        return
    for door in rooms.doors:
        yield f"place({door.name},door,{door.confidence})"
        least, most = hundredths(door.width) - ROUNDING, hundredths(door.width_bound) + ROUNDING
        yield f"measure({door.name},width,{least},{most},100)"
        yield f"settled({door.name},width)"
        yield from (f"holds(joins,{door.name},r{side})" for side in sorted(set(door.sides)))
    for room in np.unique(rooms.labels).tolist():
        sure = 100 if room == WAKING_ROOM else max((door.confidence for door in rooms.leading(room, 0)), default=0)
        yield from (f"place(r{room},room,{sure})",) if room != NO_ROOM else ()


def _where_things_are(model: WorldModel, places: Places) -> Iterator[_Said]:
    """Yield in which room each thing is, at which corners, beside what, and whether it stands against the verge."""
    rooms, verge = places.rooms, with_edge_neighbours(model.verge)
    doors = sorted(rooms.leading(WAKING_ROOM), key=lambda door: door.confidence)
    next_door = {side: door.confidence for door in doors for side in door.sides}
    outlines = {node.name: _outline(node, model) for node in model.objects}
    for node in model.objects:
        name = node.name
        own = frozenset({name})
        yield from (_Said(fact, own) for fact in _size(node))
        yield from (_Said(f"settled({name},{claim})", own) for claim in ("in", "at", "against"))
        row, column = model.view.locate(*node.patch.centre)
        room = int(rooms.labels[row, column])
        if room != NO_ROOM:
            yield _Said(f"holds(in,{name},r{room})", own)
            if room != WAKING_ROOM and room in next_door:
                yield _Said(f"has({name},in,room(next),{next_door[room]})", own)
        if (model.mask(node.patch) & verge).any():
            yield _Said(f"has({name},against,verge,100)", own)
        at = _corners_at(node, places.corners, model)
        yield from (_Said(f"has({name},at,corner({side}),100)", own) for side in at)
        yield from (
            _Said(f"holds(beside,{name},{other})", own | {other})
            for other, outline in outlines.items()
            if other != name and outline.distance(outlines[name]) <= BESIDE_DISTANCE
        )


def _outline(node: Node, model: WorldModel) -> Any:
    """Return the believed outline of a thing; while there is none, that of its squares; map frame."""
    if node.polygon is not None:
        return node.polygon
    return translate(mask_to_polygon(model.mask(node.patch)), model.view.west, model.view.south)


def _corners_at(node: Node, corners: Mapping[str, Corner], model: WorldModel) -> Iterator[str]:
    """Yield the corners both walls of which a thing is close to."""
    if node.polygon is None:
        return
    west, south, east, north = node.polygon.bounds
    for side, corner in sorted(corners.items()):
        x, y = corner.point[0] + model.view.west, corner.point[1] + model.view.south
        column, row = corner.square
        near = east if corner.point[0] > column else west, north if corner.point[1] > row else south
        if max(abs(near[0] - x), abs(near[1] - y)) <= AT_CORNER_DISTANCE:
            yield side
