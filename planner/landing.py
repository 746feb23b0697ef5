"""Where something that is carried must end for a goal to hold, or what must be seen first to tell.

Goals of geometry.carrying are in the frame of the view's arrays, as all of planning on a screen is.
"""

import itertools
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from geometry.carrying import At, InCorner, Inside
from geometry.components import components
from geometry.ends import End, met, moved, placed
from geometry.reach import UNREACHED, reach
from geometry.rigid import Pose
from kb.facts import Fact, Number, Symbol, Text
from kb.rooms import Rooms
from kb.wkt import parse_wkt
from kb.worldmodel import CLEAR, Node
from planner.destinations import Situation, doorsteps, numbers, out_of_sight, rooms_to_see, unknown_corner
from planner.exploring import Lookout, short_of, sight_of
from planner.hoping import BEYOND, spread
from planner.screen import grown

Mask = NDArray[np.bool_]
Place = tuple[float, float]
Ends = Callable[[], Mapping[str, End]]  # by their names, worked out when asked
Looks = Callable[[], tuple[Lookout, ...]]  # worked out when asked
IN_SIGHT = 6  # squares from a corner within which it is seen well
FLUSH = 0.1  # squares between an object and walls that it touches
RIM = 1.0  # squares from the edge of a region within which he is not sure that something is in it
LEANING = 1.25  # squares that what lies askew in a corner may reach further from its walls than it is long
PRESS = 0.25  # squares that a thing is pressed on into a corner: it shows, then, how far in its sides lie
HAIR = 0.01  # squares that do not matter
NOOK = 2  # squares about a thing that are no room to go
ABOUT = 0.5  # squares from its walls at which an object is brought to a corner that is settled
RATHER = 0.4  # that a square is occupied which is rather floor than not
MOST_FURTHER, BROAD = 2, 3  # squares that a corner may lie further than what surely is floor, and as broad as that is
BESIDE = 1.0  # squares from a thing within which it is reached
POSED, TURNED = 0.25, 2.0  # squares and degrees within which a pose is attained


@dataclass(frozen=True)
class Landing:
    """Where a goal holds for an object.

    Attributes
    ----------
    ends : target's name -> where the object must lie; empty while that is not known.
    missing, lookouts : what must be known first, in words, and where just that may be seen (as of a Destination).
    approach : places near to where it must end, from which it can be told better where that is; the best first.
    holds : the goal holds as the object lies now. there : it does, but for what must be known first.
    shut_in : likewise, and he cannot leave the object where it is, for it shuts him in.
    loose : where it may lie if it cannot be brought to any of the ends.
    must_reach : what it must come to lie on wherever it must end, while that is not known: squares that were not seen,
    and those of the one end that may be it. Worked out when asked.
    hoped : the ends, if the floor goes on as it is hoped to (planner.hoping); worked out when asked.
    by_the_way : what must be seen before it holds, where it does not yet: to come back for that takes longer. Likewise.
    """

    ends: Mapping[str, End]
    missing: str = ""
    lookouts: tuple[Lookout, ...] = ()
    approach: Mapping[str, End] = field(default_factory=dict)
    holds: bool = False
    there: bool = False
    shut_in: bool = False
    loose: Mapping[str, End] = field(default_factory=dict)
    must_reach: Ends = dict
    hoped: Ends = dict
    by_the_way: Looks = tuple


def landing(goal: Fact, node: Node, began: Place, situation: Situation) -> Landing:
    """Where an object must end. began : the point of the lattice where its middle lay at first."""
    found = _landing(goal, node, began, situation)
    if not situation.model.view.sure:
        found = replace(found, ends={name: _well_in(end) for name, end in found.ends.items()})
    in_corner = any(isinstance(end, InCorner) for end in found.ends.values())  # of which it is told already
    return replace(found, holds=found.holds or (not in_corner and _lies_in(found.ends, node, situation)))


def _well_in(end: End) -> End:
    """A region without its rim: for one who may be a little elsewhere than he believes."""
    if not isinstance(end, Inside):
        return end
    inner = Inside(end.polygon.buffer(-RIM, join_style="mitre"))
    return end if inner.polygon.is_empty else inner


def _landing(goal: Fact, node: Node, began: Place, situation: Situation) -> Landing:
    where = goal.args[1]
    if goal.name == "at" and isinstance(where, Symbol) and where.name == "corner":
        return _cornered(str(where.args[0]), node, situation)
    if goal.name == "at" and str(where) == "start":
        return _around_start(node, situation)
    if goal.name in ("at", "beside"):
        return _beside(str(where), node, situation)
    if goal.name in ("in", "through"):
        return _next_room(began, node, situation)
    if goal.name == "around":
        return _around_corner(began, node, situation)
    if goal.name == "pose":
        return _posed(goal, node, situation)
    raise ValueError(f"not a goal for something carried: {goal}")


def _lies_in(ends: Mapping[str, End], node: Node, situation: Situation) -> bool:
    """Does an object lie where a goal holds?"""
    return lands_in_one(ends, in_view(node.polygon, situation))


def lands(end: End, shape: Any) -> bool:
    """Does a shape, in the frame of the view's arrays, lie where a goal holds?"""
    return met(end, shape, shape)


def lands_in_one(ends: Mapping[str, End], shape: Any) -> bool:
    """Does a shape, in the frame of the view's arrays, lie where one of some goals holds?"""
    return any(lands(end, shape) for end in ends.values())


def lies_askew(node: Node) -> bool:
    """Was it turned otherwise than by quarter turns?"""
    over = node.turned % 90.0
    return min(over, 90.0 - over) > TURNED


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
    """The corner that Utak would go to; how the floor goes on about it is not asked once the object lies in it.

    Whether there is another one in a room that is not seen he looks only then, for mostly there is none; or by the way
    there with the object in hand.
    """
    column, row = situation.corners[side].square
    if not situation.model.mask(node.patch)[row, column]:
        floor = _floor(node, situation)
        unknown = unknown_corner(side, situation, floor)
        if unknown is not None:
            near = _near(side, node, situation, floor)
            must_reach = partial(_must_reach, side, node, situation)
            hoped = partial(_further, side, next(iter(near), ""), situation)
            return Landing({}, unknown.missing, unknown.lookouts, near, must_reach=must_reach, hoped=hoped)
    land = _in_corner(side, node, situation)
    if not land.holds:
        held = situation.model.held == node.name
        return replace(land, by_the_way=partial(_looks_into_rooms, side, situation)) if held else land
    looks = _looks_into_rooms(side, situation)
    shut_in = not looks and not can_leave(node, situation)
    if shut_in:
        looks = _looks_into_rooms(side, situation.along_with(node.patch))
    if not looks:
        return land
    return Landing({}, looks[0].what, looks, there=not shut_in, shut_in=shut_in)


def can_leave(node: Node, situation: Situation) -> bool:
    """Does Utak, if he has an object in hand, not stand in a nook between that and the walls?"""
    held = situation.model.held == node.name
    return not held or leads_away(situation.screens.floor, situation.model.mask(node.patch))


def leads_away(floor: Mask, thing: Mask) -> bool:
    """Does floor that he reaches lead further from a thing than a nook beside it? Both (rows, columns)."""
    return bool((floor & ~grown(thing, NOOK)).any())


def _looks_into_rooms(side: str, situation: Situation) -> tuple[Lookout, ...]:
    """Looks into rooms that may go further towards a side, for which it will do to come near.

    What lies behind their squares is seen from short of them, too.
    """
    rooms = rooms_to_see(side, situation)
    return tuple(r._replace(squares=np.union1d(r.squares, short_of(situation.screens, r.squares))) for r in rooms)


def _in_corner(side: str, node: Node, situation: Situation) -> Landing:
    """In a corner of the known floor, at the very corner.

    To be within a square of its walls is enough when they are settled; else they may be further away than he believes.
    Who is not sure of where he and the object are looks at the corner first.
    """
    (column, row), end = situation.corners[side].square, _into_corner(side, situation)
    model = situation.model
    view = model.view
    around = grown(model.squares([(column + view.west, row + view.south)]), 1)
    under = model.mask(node.patch)  # no look tells what lies under the thing itself: what lies about that must do
    if (around & under).any():
        around = grown(around, 1) & ~under
    unclear = around & ~model.told
    shape = in_view(node.polygon, situation)
    hoped = partial(_further, side, side, situation)
    if not unclear.any():
        return replace(_flat(side, end, node, shape), hoped=hoped)
    near = replace(end, slack=FLUSH if view.sure else ABOUT)
    lookout = sight_of(situation.screens, unclear, f"where just the {side} corner is is not clear")
    may_go_on = unclear & (view.probability < 1 - CLEAR)
    if len(lookout.squares) and (not view.sure or (may_go_on.any() and lands(near, shape))):
        return Landing({}, lookout.what, (lookout,), there=True)
    return Landing({side: near}, lookout.what, (lookout,), holds=lands(near, shape), hoped=hoped)


def _flat(side: str, end: InCorner, node: Node, shape: Any) -> Landing:
    """In a corner, and what was turned askew so that it reaches hardly further from the walls than it would straight.

    Where that cannot be it may lie there askew. What covers some squares in part looks larger than it is, on any side
    by up to one: so it is there when it looks as if it touched the walls, or was seen not to be smaller. One who slips
    knows only about where it is: he brings it nearer if he can.
    """
    close = replace(end, slack=ABOUT)
    if not lies_askew(node):
        if node.inexact:
            return Landing({side: close}, holds=lands(close, shape), loose={side: end})
        goals = [_pressed(end), replace(close, press=ABOUT), replace(end, slack=FLUSH, press=1.0)]
        goal = next((one for one in goals if not lands(one, shape)), goals[-1])
        return Landing({side: goal}, holds=_surely(end, node, shape) or lands(goals[-1], shape))
    x0, y0, x1, y1 = placed(shape, Pose(0.0, 0.0, -node.turned % 90.0)).bounds
    near, far = sorted((x1 - x0, y1 - y0))
    flat = replace(close if node.inexact else end, within=(near + LEANING, far + LEANING))
    loose = {} if lands(flat, shape) else {side: close}
    return Landing({side: replace(flat, slack=ABOUT)}, holds=lands(flat, shape), loose=loose)


def _pressed(end: InCorner) -> InCorner:
    """The same corner, for a thing that is pressed on into it where whole squares leave one free."""
    return replace(end, slack=end.slack - PRESS, press=PRESS)


def _surely(end: InCorner, node: Node, shape: Any) -> bool:
    """Does an object lie in a corner, however far in its sides lie?"""
    west, east, south, north = node.short
    gaps = end.gaps(shape.bounds)
    further = east if end.sx > 0 else west, north if end.sy > 0 else south
    return lands(end, shape) and all(gap + far <= end.slack + HAIR for gap, far in zip(gaps, further, strict=True))


def _into_corner(side: str, situation: Situation) -> InCorner:
    """In the furthest corner of the known floor."""
    (x, y), (column, row) = situation.corners[side].point, situation.corners[side].square
    return InCorner(x, y, 1 if x > column else -1, 1 if y > row else -1)


def _further(side: str, name: str, situation: Situation) -> Mapping[str, End]:
    """The corner of what is rather floor than not, by a name, where that goes further than what surely is."""
    (column, row), end = situation.corners[side].square, _into_corner(side, situation)
    view = situation.model.view
    rather = np.pad(view.seen & (view.probability <= RATHER), MOST_FURTHER)
    along = [step * np.array([-end.sy, -end.sx]) for step in range(BROAD)]
    more = []
    for axis in (1, 0):
        out = np.array([end.sy, end.sx]) * (np.arange(2) == axis)
        back = [step * (np.arange(2) != axis) for step in along]
        there = (all(rather[tuple(np.array([row, column]) + MOST_FURTHER + n * out + b)] for b in back) for n in (1, 2))
        more.append(sum(itertools.takewhile(bool, there)))
    if not any(more):
        return {}
    return {name: _pressed(replace(end, x=end.x + end.sx * more[0], y=end.y + end.sy * more[1]))}


def _near(side: str, node: Node, situation: Situation, floor: Mask) -> Mapping[str, End]:
    """Places from which Utak with the object in hand sees a corner well; none when the object is at one.

    Best in the corner of what is seen: he takes it then so that he does not stand in its way there, and when that is
    the true one it is there already. Else about it. floor : (rows, columns) that he can reach.
    """
    into, shape = _into_corner(side, situation), in_view(node.polygon, situation)
    if lands(into, shape):
        return {}
    mask = situation.model.space & floor | situation.model.mask(node.patch)
    about = Inside(region_of(mask & _about(side, IN_SIGHT, situation)))
    there = about.polygon.is_empty or lands(about, shape)
    return {f"near_{side}": _pressed(into)} | ({} if there else {f"about_{side}": about})


def _must_reach(side: str, node: Node, situation: Situation) -> Mapping[str, End]:
    """On squares that were not seen, or on the floor that a thing in a corner would lie on."""
    column, row = situation.corners[side].square
    x0, y0, x1, y1 = node.polygon.bounds
    about = _about(side, math.ceil(math.hypot(x1 - x0, y1 - y0)) + 1, situation)
    labels = components(situation.model.space & about).labels
    mask = ~situation.model.view.seen | ((labels == labels[row, column]) & (labels > 0))
    return {side: Inside(region_of(mask))}


def _about(side: str, squares: int, situation: Situation) -> Mask:
    """(rows, columns): within so many rows and columns of a corner."""
    column, row = situation.corners[side].square
    high, wide = situation.model.view.seen.shape
    rows, columns = np.ogrid[:high, :wide]
    mask: Mask = (abs(rows - row) <= squares) & (abs(columns - column) <= squares)
    return mask


def _floor(node: Node, situation: Situation) -> Mask:
    """(rows, columns): the squares that Utak can reach; what is to be carried does not shut him in: it goes along."""
    screens = situation.screens
    mask: Mask = reach(screens.free(0) | situation.model.mask(node.patch), *screens.here) != UNREACHED
    return mask


def _next_room(began: Place, node: Node, situation: Situation) -> Landing:
    """Beyond a door; one that is only likely will do to begin with, for the way there shows whether it is one.

    What goes on unseen, and might make other rooms of these, is only looked at when it is there.
    """
    rooms = situation.rooms
    beyond, looks = situation.beyond(began)
    if beyond.any():
        ends = _insides(rooms, beyond)
        if looks and _lies_in(ends, node, situation):
            return Landing({}, looks[0].what, looks, there=True)
        return Landing(ends, hoped=partial(_insides, rooms, beyond, situation))
    missing, lookouts = "no next room is seen yet", doorsteps(situation)
    likely_rooms = situation.likely_beyond(began)
    likely = _insides(*likely_rooms)
    if _lies_in(likely, node, situation):
        return Landing({}, missing, lookouts, there=True)
    return Landing(likely, missing, lookouts, hoped=partial(_insides, *likely_rooms, situation))


def _hoped(mask: Mask, situation: Situation) -> End:
    """Inside squares of the view, or those never seen that they lead to."""
    return moved(Inside(region_of(spread(mask, situation))), -BEYOND, -BEYOND)


def _insides(rooms: Rooms, beyond: Mask, hoping: Situation | None = None) -> dict[str, End]:
    """Inside each of the rooms that have squares of a mask. hoping : then with what is hoped to be more of them."""
    parts = {f"r{n}": beyond & (rooms.labels == n) for n in numbers(rooms, beyond)}
    return {name: _hoped(part, hoping) if hoping else Inside(region_of(part)) for name, part in parts.items()}


def _around_corner(began: Place, node: Node, situation: Situation) -> Landing:
    model = situation.model
    hidden = out_of_sight(model.verge, model, began) & (model.space | model.mask(node.patch))
    if hidden.sum() < node.polygon.area:
        # Where it ends it lies on what is hidden, as far as that is seen, and on what never was.
        rest = {"hidden": hidden | ~model.view.seen} if hidden.any() else {}
        missing = "no corner is seen yet that hides a place for it"
        return Landing({}, missing, must_reach=lambda: {name: Inside(region_of(mask)) for name, mask in rest.items()})
    return Landing({"hidden": Inside(region_of(hidden))}, hoped=lambda: {"hidden": _hoped(hidden, situation)})


def _around_start(node: Node, situation: Situation) -> Landing:
    """At the place where Utak woke: within one square of it."""
    place = in_view(shapely.Point(*situation.model.lattice.woke), situation)
    return _touching(in_view(node.polygon, situation), place.buffer(0.5, cap_style="square"), "start")


def _beside(other: str, node: Node, situation: Situation) -> Landing:
    """Within one square of another object, on one of its four sides."""
    target = situation.model.object(situation.binding.get(other, ""))
    if target is None:
        return Landing({}, f"nothing seen so far is {other}")
    squares = region_of(situation.model.mask(target.patch))
    return _touching(in_view(node.polygon, situation), squares, target.name)


def _touching(shape: Any, target: Any, name: str) -> Landing:
    """Within one square of a target: best with the containing rectangles against each other, on one of four sides."""
    west, south, east, north = shape.bounds
    x0, y0, x1, y1 = target.bounds
    level = ((x0 + x1) - (west + east)) / 2, ((y0 + y1) - (south + north)) / 2
    level = (float(np.rint(level[0])), float(np.rint(level[1])))
    shifts = {"east": (x1 - west, level[1]), "north": (level[0], y1 - south)}
    shifts |= {"west": (x0 - east, level[1]), "south": (level[0], y0 - north)}
    ends = {f"{name}_{side}": At(Pose(dx, dy, 0.0)) for side, (dx, dy) in shifts.items()}
    return Landing(ends, holds=shape.distance(target) <= BESIDE)


def _posed(goal: Fact, node: Node, situation: Situation) -> Landing:
    """The middle at a point of Utak's frame, turned by so many degrees from how it lay at first."""
    place, degrees = goal.args[1:]
    assert isinstance(place, Text)
    assert isinstance(degrees, Number)
    point = parse_wkt(place.value)
    x, y = situation.model.lattice.place_from_utak(point.x, point.y)
    middle = node.polygon.centroid
    left = (degrees.value - node.turned + 180.0) % 360.0 - 180.0
    holds = math.dist((x, y), (middle.x, middle.y)) <= POSED and abs(left) <= TURNED
    return Landing({"pose": At(Pose(x - middle.x, y - middle.y, left))}, holds=holds)
