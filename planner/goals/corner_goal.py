"""In a corner: where something that is carried must end, or what must be seen first to tell."""

import itertools
import math
from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from geometry.manipulation.goals import End, placed
from geometry.manipulation.plan_carrying import Between, InCorner, Inside
from geometry.motion.se2 import Pose, Translate
from geometry.raster.components import components
from geometry.raster.geodesic import UNREACHED, reach
from kb.language.terms import Fact
from kb.world.model import CLEAR, Node
from planner.goals.placement import HAIR, Mask, Placement, can_leave, in_view, lands, lies_askew, region_of
from planner.goals.robot_goals import corner_side, rooms_to_see, unknown_corner
from planner.screen.projection import grown
from planner.sights.frontiers import Viewpoint, short_of, sight_of
from planner.sights.viewpoints import TAKE, Approach
from planner.situation import Situation

IN_SIGHT = 6  # squares from a corner within which it is seen well
FLUSH = 0.1  # squares between an object and walls that it touches
LEANING = 1.25  # squares that what lies askew in a corner may reach further from its walls than it is long
WALL = 1.0  # squares: so deep in the squares in which it was seen a wall may lie
STAIR = math.sqrt(2)  # squares: as far behind its stairs a wall that lies askew may be
LEAN = 0.4  # squares by which it goes away from the other wall meanwhile, which would hold it else
PRESS = 0.25  # squares that a thing is pressed on into a corner: it shows, then, how far in its sides lie
ABOUT = 0.5  # squares from its walls at which an object is brought to a corner that is settled
RATHER = 0.4  # that a square is occupied which is rather floor than not
MOST_FURTHER, BROAD = 2, 3  # squares that a corner may lie further than what surely is floor, and as broad as that is


def cornered(side: str, node: Node, situation: Situation) -> Placement:
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
            return Placement({}, unknown.missing, unknown.viewpoints, near, must_reach=must_reach, hoped=hoped)
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
    return Placement({}, looks[0].what, looks, there=not shut_in, shut_in=shut_in)


def may_move(goal: Fact, situation: Situation) -> bool:
    """Return whether a goal is about a corner that rooms not seen yet may put elsewhere."""
    side = corner_side(goal)
    return bool(side and rooms_to_see(side, situation))


def approach(goals: Iterable[Fact], situation: Situation) -> Approach:
    """How he goes up to what he shall carry to where some goals hold for it."""
    for goal in goals:
        side = corner_side(goal)
        if side in situation.corners:
            end = _into_corner(side, situation)
            return TAKE._replace(corner=(end.sx, end.sy))
    return TAKE


def _looks_into_rooms(side: str, situation: Situation) -> tuple[Viewpoint, ...]:
    """Looks into rooms that may go further towards a side, for which it will do to come near.

    What lies behind their squares is seen from short of them, too.
    """
    rooms = rooms_to_see(side, situation)
    return tuple(r._replace(squares=np.union1d(r.squares, short_of(situation.cost_maps, r.squares))) for r in rooms)


def _in_corner(side: str, node: Node, situation: Situation) -> Placement:
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
    between = _between_walls(side, situation)
    if between is not None and not (unclear & (view.probability < 1 - CLEAR)).any():
        return _aslant(side, between, shape)
    if not unclear.any():
        return replace(_flat(side, end, node, shape), hoped=hoped)
    near = replace(end, slack=FLUSH if view.sure else ABOUT)
    viewpoint = sight_of(situation.cost_maps, unclear, f"where just the {side} corner is is not clear")
    may_go_on = unclear & (view.probability < 1 - CLEAR)
    if len(viewpoint.squares) and (not view.sure or (may_go_on.any() and lands(near, shape))):
        return Placement({}, viewpoint.what, (viewpoint,), there=True)
    return Placement({side: near}, viewpoint.what, (viewpoint,), holds=lands(near, shape), hoped=hoped)


def _flat(side: str, end: InCorner, node: Node, shape: Any) -> Placement:
    """In a corner, and what was turned askew so that it reaches hardly further from the walls than it would straight.

    Where that cannot be it may lie there askew. What covers some squares in part looks larger than it is, on any side
    by up to one: so it is there when it looks as if it touched the walls, or was seen not to be smaller. One who slips
    knows only about where it is: he brings it nearer if he can.
    """
    close = replace(end, slack=ABOUT)
    if not lies_askew(node):
        if node.inexact:
            return Placement({side: close}, holds=lands(close, shape), loose={side: end})
        goals = [_pressed(end), replace(close, press=ABOUT), replace(end, slack=FLUSH, press=1.0)]
        goal = next((one for one in goals if not lands(one, shape)), goals[-1])
        holds = _surely(end, node, shape) or lands(goals[-1], shape)
        return Placement({side: goal}, holds=holds, presses=_presses(end, node, shape) if holds else {})
    x0, y0, x1, y1 = placed(shape, Pose(0.0, 0.0, -node.turned % 90.0)).bounds
    near, far = sorted((x1 - x0, y1 - y0))
    flat = replace(close if node.inexact else end, within=(near + LEANING, far + LEANING))
    loose = {} if lands(flat, shape) else {side: close}
    return Placement({side: replace(flat, slack=ABOUT)}, holds=lands(flat, shape), loose=loose)


def _between_walls(side: str, situation: Situation) -> Between | None:
    """In the furthest corner of the known floor, where that is formed by walls that lie askew to the squares."""
    corner = situation.corners[side]
    return None if corner.walls is None else Between(*corner.point, corner.walls)


def _aslant(side: str, end: Between, shape: Any) -> Placement:
    """Between walls that lie askew to the squares, at any angle: brought near to both, and then pressed on into there.

    They are seen as stairs, and lie somewhere behind these: only what is stopped tells where.
    """
    one, two = end.gaps(shape)
    ways = {
        "into": (max(one, 0.0) + STAIR, max(two, 0.0) + STAIR),
        "one": (one + STAIR, -LEAN),
        "two": (-LEAN, two + STAIR),
    }
    holds = lands(end, shape)
    presses = {name: Translate(*end.move(way)) for name, way in ways.items() if holds}
    return Placement({side: end}, holds=holds, presses=presses)


def _pressed(end: InCorner) -> InCorner:
    """The same corner, for a thing that is pressed on into it where whole squares leave one free."""
    return replace(end, slack=end.slack - PRESS, press=PRESS)


def _presses(end: InCorner, node: Node, shape: Any) -> Mapping[str, Translate]:
    """Pushes towards the walls of a corner that something may not touch, as far as these may be away.

    A wall lies anywhere in the squares in which it was seen, and a side that is not told lies anywhere in its own. What
    lies right beside these squares is within a square of the wall wherever that is, if its side is told; with a part
    of a square free in between, by what is seen or by what is not, it may not be.
    """
    x, y = (gap + far for gap, far in zip(end.gaps(shape.bounds), _further_in(end, node), strict=True))
    pushes = {"across": (x, Translate(end.sx * (x + WALL), 0.0)), "up": (y, Translate(0.0, end.sy * (y + WALL)))}
    return {name: push for name, (gap, push) in pushes.items() if gap > FLUSH}


def _further_in(end: InCorner, node: Node) -> tuple[float, float]:
    """By how much the sides of a thing towards the walls of a corner may lie further in than is believed."""
    west, east, south, north = node.short
    return east if end.sx > 0 else west, north if end.sy > 0 else south


def _surely(end: InCorner, node: Node, shape: Any) -> bool:
    """Does an object lie in a corner, however far in its sides lie? Where walls lie deeper in their squares than these
    begin, it may lie in these, too.
    """
    gaps, further = end.gaps(shape.bounds), _further_in(end, node)
    return all(gap >= -WALL and gap + far <= end.slack + HAIR for gap, far in zip(gaps, further, strict=True))


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
    cost_maps = situation.cost_maps
    mask: Mask = reach(cost_maps.free(0) | situation.model.mask(node.patch), *cost_maps.here) != UNREACHED
    return mask
