"""Where something that is carried must end for a goal to hold, or what must be seen first to tell.

Goals of geometry.carrying are in the frame of the view's arrays, as all of planning on a screen is.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from geometry import ends
from geometry.carrying import At, InCorner, Inside
from geometry.ends import End
from geometry.rigid import Pose
from kb.facts import Fact, Number, Symbol, Text
from kb.wkt import parse_wkt
from kb.worldmodel import Node
from planner.destinations import Situation, corner, out_of_sight
from planner.exploring import Lookout, rooms_beyond

Mask = NDArray[np.bool_]
Place = tuple[float, float]


@dataclass(frozen=True)
class Landing:
    """Where a goal holds for an object.

    Attributes
    ----------
    ends : target's name -> where the object must lie; empty while that is not known.
    missing, lookouts : what must be known first, in words, and where just that may be seen (as of a Destination).
    """

    ends: Mapping[str, End]
    missing: str = ""
    lookouts: tuple[Lookout, ...] = ()


def landing(goal: Fact, node: Node, began: Place, situation: Situation) -> Landing:
    """Where an object must end. began : the point of the lattice where its middle lay at first."""
    where = goal.args[1]
    if goal.name == "at" and isinstance(where, Symbol) and where.name == "corner":
        return _cornered(str(where.args[0]), node, situation)
    if goal.name == "at" and str(where) == "start":
        return _around_start(node, situation)
    if goal.name in ("at", "beside"):
        return _beside(str(where), node, situation)
    if goal.name in ("in", "through"):
        return _next_room(began, situation)
    if goal.name == "around":
        return _around_corner(began, node, situation)
    if goal.name == "pose":
        return _posed(goal, node, situation)
    raise ValueError(f"not a goal for something carried: {goal}")


def met(end: End, node: Node, situation: Situation) -> bool:
    """Does an object lie where a goal holds?"""
    shape = in_view(node.polygon, situation)
    return ends.met(end, shape, shape)


def in_view(shape: Any, situation: Situation) -> Any:
    """A shape of the lattice in the frame of the view's arrays."""
    west, south = situation.model.view.west, situation.model.view.south
    return shapely.transform(shape, lambda points: points - np.array([west, south]))


def region_of(mask: Mask) -> Any:
    """The True squares of a (rows, columns) mask as one geometry."""
    runs = np.diff(np.pad(mask, ((0, 0), (1, 1))).astype(np.int8), axis=1)
    rows, starts = np.nonzero(runs == 1)
    stops = np.nonzero(runs == -1)[1]
    return shapely.union_all(shapely.box(starts, rows, stops, rows + 1))


def _cornered(side: str, node: Node, situation: Situation) -> Landing:
    """The corner that Utak would go to; it need not be looked for once the object lies in it."""
    (x, y), (column, row) = situation.corners[side].point, situation.corners[side].square
    found = corner(side, situation)
    if found.missing and not situation.model.mask(node.patch)[row, column]:
        return Landing({}, found.missing, found.lookouts)
    return Landing({side: InCorner(x, y, 1 if x > column else -1, 1 if y > row else -1)})


def _next_room(began: Place, situation: Situation) -> Landing:
    rooms = situation.rooms
    row, column = situation.model.view.locate(*began)
    beyond = rooms.beyond(int(rooms.labels[row, column]))
    names = [int(number) for number in np.unique(rooms.labels[beyond])]
    if not names:
        return Landing({}, "no next room is seen yet", tuple(rooms_beyond(situation.screens)))
    return Landing({f"r{n}": Inside(region_of(beyond & (rooms.labels == n))) for n in names})


def _around_corner(began: Place, node: Node, situation: Situation) -> Landing:
    model = situation.model
    hidden = out_of_sight(model, began) & (model.space | model.mask(node.patch))
    if not hidden.any():
        return Landing({}, "no corner is seen yet that hides a place")
    return Landing({"hidden": Inside(region_of(hidden))})


def _around_start(node: Node, situation: Situation) -> Landing:
    """At the place where Utak woke: within one square of it."""
    x, y = situation.model.lattice.woke
    place = in_view(shapely.Point(x, y), situation)
    return Landing(dict(_sides(in_view(node.polygon, situation), place.buffer(0.5, cap_style="square"), "start")))


def _beside(other: str, node: Node, situation: Situation) -> Landing:
    """Within one square of another object, on one of its four sides."""
    target = situation.model.object(situation.binding.get(other, ""))
    if target is None:
        return Landing({}, f"nothing seen so far is {other}")
    squares = in_view(
        shapely.union_all([shapely.box(x, y, x + 1, y + 1) for x, y in target.patch.squares()]), situation
    )
    return Landing(dict(_sides(in_view(node.polygon, situation), squares, target.name)))


def _sides(shape: Any, target: Any, name: str) -> Iterator[tuple[str, End]]:
    """Poses with the shape's containing rectangle against the target's, half a square or less away, on each side."""
    west, south, east, north = shape.bounds
    x0, y0, x1, y1 = target.bounds
    level = ((x0 + x1) - (west + east)) / 2, ((y0 + y1) - (south + north)) / 2
    level = (float(np.rint(level[0])), float(np.rint(level[1])))
    shifts = {"east": (x1 - west, level[1]), "north": (level[0], y1 - south)}
    shifts |= {"west": (x0 - east, level[1]), "south": (level[0], y0 - north)}
    for side, (dx, dy) in shifts.items():
        yield f"{name}_{side}", At(Pose(dx, dy, 0.0))


def _posed(goal: Fact, node: Node, situation: Situation) -> Landing:
    """The middle at a point of Utak's frame, turned by so many degrees from how it lay at first."""
    place, degrees = goal.args[1:]
    assert isinstance(place, Text)
    assert isinstance(degrees, Number)
    point = parse_wkt(place.value)
    x, y = situation.model.lattice.place_from_utak(point.x, point.y)
    middle = node.polygon.centroid
    left = (degrees.value - node.turned + 180.0) % 360.0 - 180.0
    return Landing({"pose": At(Pose(x - middle.x, y - middle.y, left))})
