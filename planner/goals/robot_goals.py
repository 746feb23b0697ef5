"""Destinations: the squares on which a goal holds for the robot, or what is missing to tell.

The side of a corner is northeast, northwest, southeast or southwest in the robot's own frame.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import reduce
from typing import Any

import numpy as np
import shapely

from utak.geometry.kernels.arrays import XY, Bools
from utak.geometry.raster.components import with_edge_neighbours
from utak.kb.language.terms import Fact, Symbol
from utak.kb.world.corners import Corner
from utak.kb.world.model import WorldModel
from utak.kb.world.rooms import Rooms
from utak.planner.screen.projection import SquareIndices, dilate, square_index
from utak.planner.sights.frontiers import (
    VIEW_SPACING,
    Viewpoint,
    door_jambs,
    find_frontiers,
    likely_gaps,
    look_ahead_squares,
    unreached_rooms,
    with_chances,
)
from utak.planner.situation import Situation
from utak.planner.stages import is_at_start

# How much further towards a corner (east and north added, in squares) unseen floor may go. All were tuned on random
# worlds (benchmarks.campaign).
MAX_UNSEEN_REACH = 45  # at most, wherever it goes on
MIN_CHANCE, REACH_PER_PERCENT = 12, 2  # so many squares for each percent of a frontier's chance over MIN_CHANCE
NARROW_REACH, MAX_DOOR_SQUARES = 36, 6  # at least so much behind a frontier less than MAX_DOOR_SQUARES wide
WIDE_REACH = 24  # at least so much behind a wider frontier of another room
UNREACHED_REACH = 30  # behind floor that no way leads to yet
ONWARD_REACH = 30  # straight on behind a frontier
SIDEWARD_REACH = 28  # to either side behind a frontier
DOOR_SIDEWARD_REACH = 41  # to either side behind a frontier no wider than a door: over a room, and most of the next one
LINE_SAMPLES = 192  # places along a line of sight at which it may meet the verge (convention)


@dataclass(frozen=True)
class Destination:
    """The squares on which a goal holds for the robot, and what must be known first."""

    # Flat indices (row * columns + column) on the arrays of the view, (n,) int64; empty while it is not known where
    squares: SquareIndices
    # In words, what must be known first; "" when nothing is missing. With squares, it may hold elsewhere, too.
    missing: str = ""
    # Where just that may be seen; when there are none, any place worth a look may show it
    viewpoints: tuple[Viewpoint, ...] = ()
    # All squares where it holds, those included that count only where another goal leaves no better ones; None for no
    # others
    also: SquareIndices | None = None


def jointly(where: Sequence[Destination]) -> Sequence[Destination]:
    """Return the destinations of goals that shall hold at once: with all squares where the best ones do not meet."""
    if len(where) < 2 or any(one.missing for one in where) or reduce(np.intersect1d, [d.squares for d in where]).size:
        return where
    return [one if one.also is None else replace(one, squares=one.also) for one in where]


def unreachable_reason(where: Sequence[Destination]) -> str:
    """Return in words why goals cannot be attained although it is known where each of them holds."""
    both = [set(d.squares.tolist()) for d in where]
    return "no way leads there" if set.intersection(*both) else "there is no place where all of it holds at once"


def unknown_destination(missing: str, viewpoints: tuple[Viewpoint, ...] = ()) -> Destination:
    """Return the destination of a goal of which it is not known yet where it holds: without squares."""
    return Destination(np.zeros(0, np.int64), missing, viewpoints)


def corner_side(goal: Fact) -> str:
    """Return the side of the corner that a goal is about, as in at(utak, corner(northeast)); "" for no corner."""
    where = goal.args[1] if len(goal.args) > 1 else None
    is_corner = goal.name == "at" and isinstance(where, Symbol) and where.name == "corner"
    return str(where.args[0]) if is_corner and isinstance(where, Symbol) else ""


def wall_sides(corner: Corner) -> tuple[int, int]:
    """Return on which sides of its square the walls of a corner are, (x, y): 1 for the greater coordinate, else -1."""
    return (1 if corner.point[0] > corner.square[0] else -1), (1 if corner.point[1] > corner.square[1] else -1)


def destination(goal: Fact, situation: Situation) -> Destination:
    """Compute the squares on which a goal of place holds for the robot."""
    return DESTINATIONS[goal.name](goal, situation)


def _place_destination(goal: Fact, situation: Situation) -> Destination:
    """Return where the robot is at a corner, at its start or at a thing."""
    side = corner_side(goal)
    if not side:
        return Destination(_start_squares(situation.model)) if is_at_start(goal) else _thing(goal, situation)
    unknown = missing_for_corner(side, situation, situation.cost_maps.floor)
    if unknown is not None:
        return unknown
    rooms = rooms_to_see(side, situation)
    return Destination(_corner_square(side, situation), rooms[0].what if rooms else "", rooms)


def missing_for_corner(side: str, situation: Situation, floor: Bools) -> Destination | None:
    """Return what is missing to tell where the corner towards a side is; None when that is known."""
    model, cost_maps = situation.model, situation.cost_maps
    (column, row), best = situation.corners[side].square, _corner_square(side, situation)
    if not floor[row, column]:
        rooms = tuple(room for room in unreached_rooms(cost_maps) if best in room.squares)
        return unknown_destination(f"the floor towards the {side} lies beyond a passage that is not seen yet", rooms)
    around = (slice(max(row - 1, 0), row + 2), slice(max(column - 1, 0), column + 2))
    if not model.view.seen[around].all():
        viewpoint = Viewpoint(look_ahead_squares(cost_maps, best), f"the floor goes on to the {side}, unseen")
        return unknown_destination(viewpoint.what, (viewpoint,))
    return None


def rooms_to_see(side: str, situation: Situation) -> tuple[Viewpoint, ...]:
    """Find the unseen rooms that may go further towards a side than all floor that is seen."""
    cost_maps, model = situation.cost_maps, situation.model
    known = _furthest_towards(side, _corner_square(side, situation), model)

    def short(view: Viewpoint) -> float:
        """Return how much less far than the known corner a viewpoint lies towards the side, in squares."""
        # East and north are added, so a diagonal step counts twice; negative when the viewpoint lies further.
        return known - _furthest_towards(side, view.squares, model)

    unreached = [view for view in unreached_rooms(cost_maps) if short(view) <= UNREACHED_REACH]
    found = [view for view in unreached if cost_maps.nearest(view.squares) is not None]
    open_ends = [view for view in find_frontiers(cost_maps, VIEW_SPACING) if short(view) <= MAX_UNSEEN_REACH]
    gaps = [view for view in likely_gaps(cost_maps) if short(view) <= MAX_UNSEEN_REACH and _is_narrow(view, model)]
    ends = with_chances(cost_maps, [*open_ends, *gaps])
    for view in ends[: len(open_ends)]:
        limits = _reach_limits(side, view, situation)
        if limits is not None and short(view) <= _unseen_reach(side, view, *limits, model):
            found.append(view)
    for view in ends[len(open_ends) :]:
        near = look_ahead_squares(cost_maps, view.squares)
        if len(near) and short(view) <= _unseen_reach(side, view, MAX_UNSEEN_REACH, DOOR_SIDEWARD_REACH, model):
            found.append(view._replace(squares=near))
    what = f"a room is not seen that may go further to the {side}"
    return tuple(view._replace(what=what) for view in found)


def _corner_square(side: str, situation: Situation) -> SquareIndices:
    """Return the square of the known corner towards a side, as a flat index on the arrays of the view, (1,) int64."""
    column, row = situation.corners[side].square
    return np.array([row * situation.model.labels.shape[1] + column])


def _reach_limits(side: str, view: Viewpoint, situation: Situation) -> tuple[int, int] | None:
    """Return the least reach and the sideward reach of the unseen floor behind a frontier, in squares."""
    # Returns None where the frontier leads to no other room: it is neither in a doorway, nor as narrow as a door, nor
    # in another room than the known corner.
    rooms = (situation.rooms, situation.rooms_by_sure_walls)
    if any(one.doorways.ravel()[view.squares].any() for one in rooms):
        return MAX_UNSEEN_REACH, DOOR_SIDEWARD_REACH
    if _is_narrow(view, situation.model):
        return NARROW_REACH, DOOR_SIDEWARD_REACH
    partitions = (one.labels.ravel() for one in rooms if one.doors)
    best = _corner_square(side, situation)
    if any((labels[view.squares] != labels[best]).any() for labels in partitions):
        return WIDE_REACH, SIDEWARD_REACH
    return None


def _is_narrow(view: Viewpoint, model: WorldModel) -> bool:
    """Return whether the squares of a viewpoint span less than MAX_DOOR_SQUARES rows and columns."""
    return bool(max(np.ptp(v) for v in np.divmod(view.squares, model.labels.shape[1])) < MAX_DOOR_SQUARES)


def _unseen_reach(side: str, view: Viewpoint, least: int, sideward: int, model: WorldModel) -> float:
    """Estimate how much further towards a corner the floor behind a frontier may go east and north added."""
    promise = max(REACH_PER_PERCENT * (view.chance - MIN_CHANCE), least)
    onward = _onward(side, view.squares, model)
    sideways = math.sqrt(max(2 - onward**2, 0.0))
    return min(promise, MAX_UNSEEN_REACH, ONWARD_REACH * max(onward, 0.0) + sideward * sideways)


def _onward(side: str, squares: SquareIndices, model: WorldModel) -> float:
    """Compute how much further towards a corner one step into the unseen leads, in squares, east and north added."""
    rows, columns = np.divmod(squares, model.labels.shape[1])
    unseen = np.pad(~model.view.seen, 1, constant_values=True)
    steps = np.array([(x, y) for x in (-1, 0, 1) for y in (-1, 0, 1)])
    x, y = np.array([unseen[rows + 1 + y, columns + 1 + x].sum() for x, y in steps]) @ steps
    far = math.hypot(x, y)
    return float(along(side, *model.frame.to_utak(x / far, y / far))) if far else 1.0


def along(side: str, east: Any, north: Any) -> Any:
    """Return how far (east, north) leads towards a corner: for "northeast" east + north, else with signs changed."""
    return (east if "east" in side else -east) + (north if "north" in side else -north)


def _furthest_towards(side: str, squares: SquareIndices, model: WorldModel) -> float:
    """Return how far the furthest of some squares lies towards a corner of the robot's own frame, in squares."""
    rows, columns = np.divmod(squares, model.labels.shape[1])
    points = np.stack([columns + model.view.west + 0.5, rows + model.view.south + 0.5])
    east, north = np.column_stack(model.frame.place_to_utak(*points)).T
    return float(along(side, east, north).max())


def _thing(goal: Fact, situation: Situation) -> Destination:
    """Return the floor that is at most one square away from the object that a goal names."""
    parameter = str(goal.args[1])
    node = situation.object_of(parameter)
    if node is None:
        return unknown_destination(situation.nothing_is(parameter))
    mask = situation.model.mask(node.patch)
    around = dilate(mask, 1)
    near = around & situation.cost_maps.floor
    touching = near & with_edge_neighbours(mask)
    squares = np.flatnonzero(touching if touching.any() else near)
    if not len(squares):
        what = f"no way is seen yet that leads to {parameter}"
        return unknown_destination(what, (Viewpoint(np.flatnonzero(around & situation.model.space), what),))
    if node.polygon is None:
        return Destination(squares)
    view = situation.model.view

    def in_reach(found: SquareIndices) -> SquareIndices:
        """Return those of some squares that are at most one square from the believed outline, or nearest."""
        rows, columns = np.divmod(found, near.shape[1])
        away = shapely.distance(node.polygon, shapely.points(columns + view.west + 0.5, rows + view.south + 0.5))
        kept: SquareIndices = found[away <= max(1.0, float(away.min()))]
        return kept

    return Destination(in_reach(squares), also=in_reach(np.flatnonzero(near)))


def _room(goal: Fact, situation: Situation) -> Destination:
    """Return the reachable floor of the rooms that are meant: where nothing tells, those next to that of waking."""
    beyond, viewpoints = situation.rooms_beyond(goal, situation.model.frame.origin)
    if viewpoints:
        return unknown_destination(viewpoints[0].what, viewpoints)
    squares = np.flatnonzero(beyond & situation.cost_maps.floor)
    if len(squares):
        return Destination(squares)
    what = next_room_missing(goal, situation)
    likely = _likely_rooms(goal, situation)
    return unknown_destination(what, (*likely, *door_viewpoints(situation, tried=bool(likely))))


def next_room_missing(goal: Fact, situation: Situation) -> str:
    """Return in words why no such room is known: none can be reached, no neck is a door, or none is as claimed."""
    model, opening = situation.model, situation.rooms.opening
    if parameter := situation.described_by(goal):
        return situation.nothing_is(parameter)
    if situation.rooms.sure:
        return "no next room is seen yet that can be reached"
    if opening is None:
        return "no door is seen yet"
    origin = model.frame.origin[0] - model.view.west, model.frame.origin[1] - model.view.south
    where = "behind" if math.dist(origin, opening.narrow) > math.dist(origin, opening.wide) else "before"
    at = model.point_in_words(opening.place)
    return (
        f"no door is seen yet: the opening {opening.width:.1f} squares wide at {at} is none, "
        f"for the floor {where} it is nowhere wider than {opening.least:.1f}, less than twice as wide"
    )


def _likely_rooms(goal: Fact, situation: Situation) -> list[Viewpoint]:
    """List the rooms beyond likely doors, none once the robot looked from one: the way there tests the doors."""
    model = situation.model
    rooms, beyond = situation.likely_rooms_beyond(goal, model.frame.origin)
    beyond &= situation.cost_maps.floor
    if (beyond & situation.cost_maps.looked_from).any():
        return []
    found = [np.flatnonzero(beyond & (rooms.labels == n)) for n in room_numbers(rooms, beyond)]
    return [Viewpoint(squares, "a door seems to lead there") for squares in found]


def room_numbers(rooms: Rooms, mask: Bools) -> list[int]:
    """Return the numbers of the rooms that have squares of a mask, in ascending order."""
    return [int(number) for number in np.unique(rooms.labels[mask])]


def door_viewpoints(situation: Situation, tried: bool = False) -> tuple[Viewpoint, ...]:
    """Find where a door may come into sight: at possible doors, and at floor that is seen and cannot be reached yet."""
    doors = [door for door in situation.rooms.doors if not (tried and door.likely)]
    return (*door_jambs(situation.cost_maps, doors), *unreached_rooms(situation.cost_maps))


def around_corner_destination(goal: Fact, situation: Situation) -> Destination:
    """Return the floor wholly out of sight of the place where the robot woke: a corner of the verge lies in between."""
    model = situation.model
    squares = np.flatnonzero(hidden_from(model.verge, model, model.frame.origin) & situation.cost_maps.floor)
    return Destination(squares) if len(squares) else unknown_destination("no corner is seen yet that hides a place")


def hidden_from(verge: Bools, model: WorldModel, place: XY) -> Bools:
    """Compute the squares none of whose corners is seen from a point past a verge, the squares that block the sight."""
    height, width = verge.shape
    x, y = place[0] - model.view.west, place[1] - model.view.south
    corners = np.stack(np.meshgrid(np.arange(width + 1), np.arange(height + 1)), axis=-1).astype(float)
    hidden = np.zeros(corners.shape[:2], np.bool_)
    for part in (np.arange(LINE_SAMPLES) + 0.5) / LINE_SAMPLES:
        columns, rows = np.moveaxis(np.floor((1 - part) * np.array([x, y]) + part * corners).astype(int), -1, 0)
        hidden |= verge[np.clip(rows, 0, height - 1), np.clip(columns, 0, width - 1)]
    mask: Bools = hidden[:-1, :-1] & hidden[1:, :-1] & hidden[:-1, 1:] & hidden[1:, 1:]
    return mask


def _start_squares(model: WorldModel) -> SquareIndices:
    """Return the squares whose centres are less than a square in each axis from where the robot woke, and that one."""
    (x, y), view = model.frame.origin, model.view
    rows, columns = np.ogrid[: model.labels.shape[0], : model.labels.shape[1]]
    near = (abs(columns + 0.5 - (x - view.west)) < 1.0) & (abs(rows + 0.5 - (y - view.south)) < 1.0)
    near[view.locate(x, y)] = True
    return np.flatnonzero(near)


def robot_stands_on(squares: SquareIndices, model: WorldModel) -> bool:
    """Return whether the robot stands on one of some squares; False for no squares."""
    return bool((squares == square_index(model.place, model)).any())


# By goal word: where it holds for the robot.
DESTINATIONS: Mapping[str, Callable[[Fact, Situation], Destination]] = {
    "at": _place_destination,
    "beside": _thing,
    "circled": _thing,
    "in": _room,
    "through": _room,
    "around": around_corner_destination,
}
