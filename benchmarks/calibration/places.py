"""The truth about doors, their widths, rooms and corners.

A true room is a part of the floor between doors: those that there are, and those that are believed besides. So a door
that is not one parts no truth in two, and one that is not known does not make two rooms one. A believed room is the
true one that has most of its squares; r1 is the one in which the robot woke.
"""

import math
from collections import Counter
from collections.abc import Sequence

import numpy as np
import shapely
from shapely import LineString, Point
from shapely.geometry.base import BaseGeometry

from benchmarks.calibration.moments import HUNDREDTHS, Moment
from benchmarks.calibration.truth import TrueDoor
from benchmarks.worlds.odd.houses import COMPASS
from utak.kb.world.doors import WIDTH_UNCERTAINTY
from utak.kb.world.place_names import WAKING_ROOM
from utak.kb.world.rooms import SAME_DOOR

DOOR_DISTANCE = SAME_DOOR  # squares from the middle of a believed door to the true one
WIDTH_ROUNDING = 0.02  # squares: facts are whole hundredths
LINE_CUT = 0.05  # squares on either side of a believed door that part no truth: less than any wall
AT_MOUTH = 0.5  # squares from a door to the rooms that it joins


def true_door(moment: Moment, door: str) -> TrueDoor | None:
    """Return the true door where a believed one is; None where there is none."""
    line = _line(moment, door)
    near = [] if line is None else [one for one in moment.truth.doors if _is_at(one, line)]
    return min(near, key=lambda one: one[0].distance(_middle(line)), default=None)


def is_door(moment: Moment, arguments: tuple[str, ...]) -> bool | None:
    """Return whether a true door is where one is believed."""
    return None if _line(moment, arguments[0]) is None else true_door(moment, arguments[0]) is not None


def is_width(moment: Moment, arguments: tuple[str, ...]) -> bool | None:
    """Return whether the width of a door is between two bounds; None for what is no door."""
    found = true_door(moment, arguments[0])
    if found is None:
        return None
    least, most = (int(value) / HUNDREDTHS for value in arguments[1:3])
    return least - WIDTH_ROUNDING <= found[1] <= most + WIDTH_ROUNDING


def does_connect(moment: Moment, arguments: tuple[str, ...]) -> bool | None:
    """Return whether a door leads from one room to another: whether it is one, and these are the rooms on its sides."""
    door, *rooms = arguments[:3]
    if is_door(moment, arguments) is not True:
        return is_door(moment, arguments)
    found = true_door(moment, door)
    parts = true_rooms(moment)
    sides = {number for number, part in enumerate(parts) if found and part.distance(found[0]) < AT_MOUTH}
    return {room_in_truth(moment, room, parts) for room in rooms} == sides


def is_in(moment: Moment, arguments: tuple[str, ...]) -> bool | None:
    """Return whether the middle of a thing, or the robot, is in a room; None in a doorway, which is of both rooms."""
    node, room = arguments[:2]
    if node != "org" and node not in moment.nodes:
        return None
    if node == "org":
        middle = Point(moment.truth.utak)
    elif (thing := moment.nodes[node].thing) is not None:
        middle = moment.truth.polygons[thing].centroid
    else:  # what is no thing has no middle
        return None
    if any(door.distance(middle) < AT_MOUTH for door, _ in moment.truth.doors):
        return None
    parts = true_rooms(moment)
    away = [part.distance(middle) for part in parts]
    true = room_in_truth(moment, room, parts)
    if true is None or away[true] > min(away) + 2 * LINE_CUT:
        return False
    stated = [(-int(share), other) for name, other, share in moment.rows("in", 3) if name == node]
    same = [one for one in stated if room_in_truth(moment, one[1], parts) == true]
    return None if min(same) != (-int(arguments[2]), room) else True  # several that are one true room: the likeliest


def is_corner(moment: Moment, arguments: tuple[str, ...]) -> bool:
    """Return whether of the four squares about a corner the inner one is floor, and the others are wall, or things."""
    east, north = COMPASS[arguments[0]]
    c, s = math.cos(math.radians(moment.truth.heading)), math.sin(math.radians(moment.truth.heading))
    way = np.array([east * c - north * s, east * s + north * c])
    x, y = (round(value) for value in moment.on_grid(*map(int, arguments[1:3])))
    about = [(x + i, y + j) for i in (-1, 0) for j in (-1, 0)]
    along = {square: round(float(np.dot(square, way)), 6) for square in about}
    inmost = [square for square in about if along[square] == min(along.values())]  # two where it looks along the grid
    others = {inner: [square for square in about if square != inner] for inner in inmost}
    return any(
        moment.truth.is_floor(inner) and all(moment.truth.seems(square, True) for square in beside)
        for inner, beside in others.items()
    )


def true_rooms(moment: Moment) -> Sequence[BaseGeometry]:
    """Return the parts of the true floor between doors, true and believed ones."""
    doors = moment.truth.doors
    lines = (_line(moment, arguments[0]) for arguments in moment.rows("threshold", 5))
    false = [line for line in lines if line is not None and not any(_is_at(door, line) for door in doors)]
    cuts = [*(door for door, _ in doors), *(line.buffer(LINE_CUT) for line in false)]
    floor = moment.truth.floor.difference(shapely.union_all(cuts)) if cuts else moment.truth.floor
    parts: Sequence[BaseGeometry] = shapely.get_parts(floor).tolist()
    return [part for part in parts if part.area > LINE_CUT]


def room_in_truth(moment: Moment, room: str, parts: Sequence[BaseGeometry]) -> int | None:
    """Return the number of the part of the floor that is nearest to most squares of a believed room; None for none."""
    squares = moment.rooms.get(room)
    if not squares or not parts:
        return None
    points = shapely.points(np.array(sorted(squares)) + 0.5)
    if room == f"r{WAKING_ROOM}":
        points = shapely.points([moment.truth.woke])
    nearest = np.argmin([shapely.distance(part, points) for part in parts], axis=0)
    return Counter(nearest.tolist()).most_common(1)[0][0]


def _line(moment: Moment, door: str) -> LineString | None:
    """Return the narrowest line across a believed door, table frame; None where none is stated."""
    for name, *ends in moment.rows("threshold", 5):
        if name == door:
            return LineString([moment.place(*map(int, ends[i : i + 2])) for i in (0, 2)])
    return None


def _middle(line: LineString) -> Point:
    return line.interpolate(0.5, normalized=True)


def _is_at(door: TrueDoor, line: LineString) -> bool:
    """Return whether a true door is at the narrowest line of a believed one, and that leads across all of it."""
    return bool(door[0].distance(_middle(line)) <= DOOR_DISTANCE and door[1] <= line.length + WIDTH_UNCERTAINTY)
