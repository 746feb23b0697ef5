"""Placements in a corner of the known floor: where a carried object must end, or what must be seen first to tell.

The side of a corner is northeast, northwest, southeast or southwest in the robot's own frame. Ends, and the outlines of
objects (`shape`, shapely Polygons), are in squares, view frame.
"""

import itertools
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from utak.geometry.kernels.arrays import Bools
from utak.geometry.manipulation.goals import End, shape_at_pose
from utak.geometry.manipulation.plan_carrying import Between, InCorner, Inside
from utak.geometry.motion.se2 import Pose, Translate
from utak.geometry.raster.components import components
from utak.geometry.raster.geodesic import GEODESIC_UNREACHED, reach
from utak.geometry.raster.runs import mask_to_polygon
from utak.kb.language.terms import Fact
from utak.kb.world.model import MAX_CLEAR_PROBABILITY, Node
from utak.planner.goals.placement import (
    NEGLIGIBLE_LENGTH,
    KnownEnds,
    Placement,
    RegionEnds,
    is_off_quarter_turn,
    meets_end,
    robot_can_leave,
    to_view_frame,
)
from utak.planner.goals.robot_goals import corner_side, missing_for_corner, rooms_to_see, wall_sides
from utak.planner.screen.projection import dilate
from utak.planner.sights.frontiers import Viewpoint, look_ahead_squares, viewpoint_of
from utak.planner.sights.viewpoints import TO_TAKE, Approach
from utak.planner.situation import Situation

CORNER_VIEW_RANGE = 6  # squares from a corner within which it is seen well (tuned on random worlds)
CONTACT_GAP = 0.1  # squares between an object and walls that it touches, at most (convention)
ROTATED_ALLOWANCE = 1.25  # squares that a rotated object may reach further from its walls than a straight one (tuned)
WALL_DEPTH = 1.0  # squares: so deep a wall may lie in the squares in which it was seen (derived)
STAIR_DEPTH = math.sqrt(2)  # squares: so far behind its stairs of squares a slanted wall may be (derived: a diagonal)
WALL_RELEASE = 0.4  # squares away from a slanted wall, which would stop it, while pressed on the other one (tuned)
PRESS_DISTANCE = 0.25  # squares that an object is pressed on into a corner; what stops it shows its extent (tuned)
APPROACH_GAP = 0.5  # squares from its walls at which an object is brought to a corner that is settled (tuned)
MAX_LIKELY_FREE = 0.4  # a square occupied with at most this probability is rather floor than not (tuned)
MAX_CORNER_SHIFT = 2  # squares that a corner may lie beyond sure floor
CORNER_SHIFT_WIDTH = 3  # squares of likely floor beside each other that are asked for there


@dataclass(frozen=True, eq=False)
class RoomsByTheWay:
    """Deferred viewpoints: rooms that are not seen and may hold another corner further towards a side."""

    side: str  # of the corner in the robot frame, such as northeast
    situation: Situation  # what is believed

    def viewpoints(self) -> tuple[Viewpoint, ...]:
        """Compute where these rooms can be seen: one Viewpoint for each (squares on the view's arrays); () for none."""
        return _room_viewpoints(self.side, self.situation)


def corner_placement(side: str, node: Node, situation: Situation) -> Placement:
    """Return where an object is in the furthest corner towards a side."""
    # Whether an unseen room has a corner further on is looked at last, for mostly there is none; or on the way, with
    # the object in hand.
    column, row = situation.corners[side].square
    if not situation.model.mask(node.patch)[row, column]:
        floor = _reachable_floor(node, situation)
        unknown = missing_for_corner(side, situation, floor)
        if unknown is not None:
            near = _near(side, node, situation, floor)
            must_reach = RegionEnds({side: _region_of_corner(side, node, situation)})
            hoped = KnownEnds(_further_corner(side, next(iter(near), ""), situation))
            return Placement({}, unknown.missing, unknown.viewpoints, near, must_reach=must_reach, hoped=hoped)
    found = _in_corner(side, node, situation)
    if not found.holds:
        held = situation.model.held == node.name
        return replace(found, by_the_way=RoomsByTheWay(side, situation)) if held else found
    viewpoints = _room_viewpoints(side, situation)
    shut_in = not viewpoints and not robot_can_leave(node, situation)
    if shut_in:
        viewpoints = _room_viewpoints(side, situation.along_with(node.patch))
    if not viewpoints:
        return found
    # What is in hand is pressed first: the robot lets it go for a look.
    return Placement({}, viewpoints[0].what, viewpoints, there=not shut_in, shut_in=shut_in, presses=found.presses)


def corner_may_move(goal: Fact, situation: Situation) -> bool:
    """Return whether a goal is about a corner that rooms not seen yet may put elsewhere."""
    side = corner_side(goal)
    return bool(side and rooms_to_see(side, situation))


def approach_for_goals(goals: Iterable[Fact], situation: Situation) -> Approach:
    """Choose how the robot goes up to an object that it shall carry to where some goals for it hold."""
    for goal in goals:
        side = corner_side(goal)
        if side in situation.corners:
            end = _corner_end(side, situation)
            return TO_TAKE._replace(corner=(end.sx, end.sy))
    return TO_TAKE


def _room_viewpoints(side: str, situation: Situation) -> tuple[Viewpoint, ...]:
    """Return the viewpoints of unseen rooms that may go further towards a side, with the floor short of them."""
    rooms = rooms_to_see(side, situation)
    return tuple(
        r._replace(squares=np.union1d(r.squares, look_ahead_squares(situation.cost_maps, r.squares))) for r in rooms
    )


def _in_corner(side: str, node: Node, situation: Situation) -> Placement:
    """Return the placement in a corner of the known floor, at its very point."""
    corner, end, model = situation.corners[side], _corner_end(side, situation), situation.model
    (column, row), view = corner.square, model.view
    around = dilate(model.squares([(column + view.west, row + view.south)]), 1)
    under = model.mask(node.patch)  # what lies under the object cannot be seen; the squares around it must do
    if (around & under).any():
        around = dilate(around, 1) & ~under
    unclear = around & ~model.told
    shape = to_view_frame(node.polygon, situation)
    may_go_on = unclear & (view.probability < 1 - MAX_CLEAR_PROBABILITY)
    if corner.walls is not None and not may_go_on.any():
        return _between_placement(side, Between(*corner.point, corner.walls), shape)
    hoped = KnownEnds(_further_corner(side, side, situation))
    if not unclear.any():
        return replace(_settled_placement(side, end, node, shape), hoped=hoped)
    near = replace(end, slack=CONTACT_GAP if view.sure else APPROACH_GAP)
    viewpoint = viewpoint_of(situation.cost_maps, unclear, f"it is not clear where exactly the {side} corner is")
    if len(viewpoint.squares) and (not view.sure or (may_go_on.any() and meets_end(near, shape))):
        return Placement({}, viewpoint.what, (viewpoint,), there=True)
    return Placement({side: near}, viewpoint.what, (viewpoint,), holds=meets_end(near, shape), hoped=hoped)


def _settled_placement(side: str, end: InCorner, node: Node, shape: Any) -> Placement:
    """Return the placement in a corner with settled walls that lie along rows and columns."""
    # A rotated object may reach hardly further from the walls than it would straight; where that is not possible, it
    # may end there rotated.
    close = replace(end, slack=APPROACH_GAP)
    if not is_off_quarter_turn(node):
        if node.inexact and not (node.insets and node.insets.uneven):  # what is uneven on one side may be on another
            return Placement({side: close}, holds=meets_end(close, shape), loose={side: end})
        goals = [_pressed(end), replace(close, press=APPROACH_GAP), replace(end, slack=CONTACT_GAP, press=1.0)]
        goal = next((one for one in goals if not meets_end(one, shape)), goals[-1])
        holds = _surely(end, node, shape) or meets_end(goals[-1], shape)
        return Placement({side: goal}, holds=holds, presses=_wall_pushes(end, node, shape) if holds else {})
    x0, y0, x1, y1 = shape_at_pose(shape, Pose(0.0, 0.0, -node.turned % 90.0)).bounds
    near, far = sorted((x1 - x0, y1 - y0))
    flat = replace(close if node.inexact else end, within=(near + ROTATED_ALLOWANCE, far + ROTATED_ALLOWANCE))
    loose = {} if meets_end(flat, shape) else {side: close}
    return Placement({side: replace(flat, slack=APPROACH_GAP)}, holds=meets_end(flat, shape), loose=loose)


def _between_placement(side: str, end: Between, shape: Any) -> Placement:
    """Return the placement between slanted walls, at any angle: brought near to both, and then pressed against them."""
    one, two = end.gaps(shape)
    gaps = {
        "into": (max(one, 0.0) + STAIR_DEPTH, max(two, 0.0) + STAIR_DEPTH),
        "one": (one + STAIR_DEPTH, -WALL_RELEASE),
        "two": (-WALL_RELEASE, two + STAIR_DEPTH),
    }
    holds = meets_end(end, shape)
    presses = {name: Translate(*end.move(gap)) for name, gap in gaps.items() if holds}
    return Placement({side: end}, holds=holds, presses=presses)


def _pressed(end: InCorner) -> InCorner:
    """Return an end in a corner to which the object is pressed on, where moves by whole squares leave a gap."""
    return replace(end, slack=end.slack - PRESS_DISTANCE, press=PRESS_DISTANCE)


def _wall_pushes(end: InCorner, node: Node, shape: Any) -> Mapping[str, Translate]:
    """Return the pushes towards the walls of a corner that an object may not touch, as far as these may be away."""
    x, y = (gap + far for gap, far in zip(end.gaps(shape.bounds), _further_in(end, node), strict=True))
    pushes = {
        "across": (x, Translate(end.sx * (x + WALL_DEPTH), 0.0)),
        "up": (y, Translate(0.0, end.sy * (y + WALL_DEPTH))),
    }
    return {name: push for name, (gap, push) in pushes.items() if gap > CONTACT_GAP}


def _further_in(end: InCorner, node: Node) -> tuple[float, float]:
    """Return how much further in than believed the sides towards the walls of a corner may lie, (x, y) in squares."""
    west, east, south, north = node.short
    return east if end.sx > 0 else west, north if end.sy > 0 else south


def _surely(end: InCorner, node: Node, shape: Any) -> bool:
    """Return whether an object is in a corner, however far in its sides lie."""
    # It may lie up to WALL_DEPTH within the wall's squares, for the wall may lie deeper in them.
    gaps, further = end.gaps(shape.bounds), _further_in(end, node)
    return all(
        gap >= -WALL_DEPTH and gap + far <= end.slack + NEGLIGIBLE_LENGTH
        for gap, far in zip(gaps, further, strict=True)
    )


def _corner_end(side: str, situation: Situation) -> InCorner:
    """Return the end in the furthest corner of the known floor towards a side: at most one square from both walls."""
    corner = situation.corners[side]
    return InCorner(*corner.point, *wall_sides(corner))


def _further_corner(side: str, name: str, situation: Situation) -> Mapping[str, End]:
    """Return the corner of likely floor, as an end by `name`, where that goes further than the sure floor; else {}."""
    (column, row), end = situation.corners[side].square, _corner_end(side, situation)
    view = situation.model.view
    likely = np.pad(view.seen & (view.probability <= MAX_LIKELY_FREE), MAX_CORNER_SHIFT)
    along = [step * np.array([-end.sy, -end.sx]) for step in range(CORNER_SHIFT_WIDTH)]
    shifts = []
    for axis in (1, 0):
        out = np.array([end.sy, end.sx]) * (np.arange(2) == axis)
        back = [step * (np.arange(2) != axis) for step in along]
        at = np.array([row, column]) + MAX_CORNER_SHIFT
        free = (all(likely[tuple(at + n * out + b)] for b in back) for n in range(1, MAX_CORNER_SHIFT + 1))
        shifts.append(sum(itertools.takewhile(bool, free)))
    if not any(shifts):
        return {}
    return {name: _pressed(replace(end, x=end.x + end.sx * shifts[0], y=end.y + end.sy * shifts[1]))}


def _near(side: str, node: Node, situation: Situation, floor: Bools) -> Mapping[str, End]:
    """Return places from which the robot with the object in hand sees a corner well; {} when the object is in it."""
    # The robot takes the object so that it does not stand in its way there, and if that is the true corner, the object
    # is there already.
    end, shape = _corner_end(side, situation), to_view_frame(node.polygon, situation)
    if meets_end(end, shape):
        return {}
    mask = situation.model.space & floor | situation.model.mask(node.patch)
    around = Inside(mask_to_polygon(mask & _around(side, CORNER_VIEW_RANGE, situation)))
    there = around.polygon.is_empty or meets_end(around, shape)
    return {f"near_{side}": _pressed(end)} | ({} if there else {f"about_{side}": around})


def _region_of_corner(side: str, node: Node, situation: Situation) -> Bools:
    """Return the squares that an object in a corner must reach: unseen ones, and the floor around the known corner."""
    column, row = situation.corners[side].square
    x0, y0, x1, y1 = node.polygon.bounds
    around = _around(side, math.ceil(math.hypot(x1 - x0, y1 - y0)) + 1, situation)
    labels = components(situation.model.space & around).labels
    mask: Bools = ~situation.model.view.seen | ((labels == labels[row, column]) & (labels > 0))
    return mask


def _around(side: str, squares: int, situation: Situation) -> Bools:
    """Return the squares within `squares` rows and columns of the square of a corner, (rows, columns) bool."""
    column, row = situation.corners[side].square
    high, wide = situation.model.view.seen.shape
    rows, columns = np.ogrid[:high, :wide]
    mask: Bools = (abs(rows - row) <= squares) & (abs(columns - column) <= squares)
    return mask


def _reachable_floor(node: Node, situation: Situation) -> Bools:
    """Return the squares that the robot can reach when the object to be carried moves along, (rows, columns) bool."""
    # Squares under other objects beside them count, for these can be moved aside.
    cost_maps = situation.cost_maps
    model = situation.model
    mask: Bools = reach(cost_maps.free(0) | model.mask(node.patch), *cost_maps.here) != GEODESIC_UNREACHED
    for other in (one for one in model.objects if one.polygon is not None and one.movable > 0):
        under = model.mask(other.patch)
        if not other.felt_first and (dilate(under, 1) & mask).any():
            mask = mask | under
    return mask
