"""Placements: where an object is, and where a goal holds for it.

Shapes and ends (geometry.manipulation.goals) are in the view frame, in squares, as all manipulation planning is.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import product
from typing import Any, Protocol

import numpy as np
import shapely

from utak.geometry.kernels.arrays import Bools
from utak.geometry.manipulation.goals import At, Between, End, InCorner, Inside, is_goal_met, shape_at_pose
from utak.geometry.motion.se2 import Pose, Translate
from utak.geometry.raster.components import components
from utak.geometry.raster.runs import mask_to_polygon
from utak.kb.language.goal_words import ROBOT
from utak.kb.localisation.propose.larger_object import MAX_HIDDEN_DEPTH, SIDE_DIRECTIONS
from utak.kb.world.model import Node, WorldModel
from utak.planner.screen.projection import dilate, shift_mask
from utak.planner.sights.frontiers import Viewpoint
from utak.planner.situation import Situation, neck_squares

NEGLIGIBLE_LENGTH = 0.01  # squares that do not matter (convention)
POSSIBLE_OBJECT = 20  # percent: what is an object with less hardly is one (tuned on random worlds)
NOOK_RANGE = 2  # squares around an object within which floor leads nowhere (tuned on random worlds)
ANGLE_TOLERANCE = 2.0  # degrees within which an object has the orientation that it shall have (meaning of the goal)


class DeferredEnds(Protocol):
    """The ingredients of some ends. To compute these takes time, so it is done only when they are asked for."""

    def ends(self) -> Mapping[str, End]:
        """Compute the ends, by name, in squares, view frame; {} for none."""


class DeferredViewpoints(Protocol):
    """The ingredients of some viewpoints. To compute these takes time, so it is done only when asked for."""

    def viewpoints(self) -> tuple[Viewpoint, ...]:
        """Compute the viewpoints, on the arrays of the view; () for none."""


@dataclass(frozen=True)
class KnownEnds:
    """Deferred ends that are known already."""

    by_name: Mapping[str, End] = field(default_factory=dict)  # the ends, in squares, view frame; none by default

    def ends(self) -> Mapping[str, End]:
        """Return the ends, by name, in squares, view frame."""
        return self.by_name


@dataclass(frozen=True, eq=False)
class RegionEnds:
    """Deferred ends inside some squares."""

    masks: Mapping[str, Bools]  # (rows, columns) bool on the arrays of the view, by the name of the end

    def ends(self) -> Mapping[str, End]:
        """Compute the region of each mask as an end, by the same names, in squares, view frame."""
        return {name: Inside(mask_to_polygon(mask)) for name, mask in self.masks.items()}


@dataclass(frozen=True)
class NoViewpoints:
    """Deferred viewpoints of which there are none."""

    def viewpoints(self) -> tuple[Viewpoint, ...]:
        """Return (): no viewpoint."""
        return ()


@dataclass(frozen=True)
class Placement:
    """The places where a goal holds for an object, and what must be known first."""

    ends: Mapping[str, End]  # by name, where the object must end; empty while that is not known
    missing: str = ""  # in words, what must be known first; "" when nothing is missing
    # Where just that may be seen; when there are none, any place worth a look may show it
    viewpoints: tuple[Viewpoint, ...] = ()
    # By name, places near the end from which the robot sees better where the end is; the best one first
    approach: Mapping[str, End] = field(default_factory=dict)
    holds: bool = False  # whether the goal holds as the object is now
    there: bool = False  # whether the goal holds but for what must be known first
    shut_in: bool = False  # as `there`, and the robot cannot leave the object where it is, for it shuts the robot in
    # By name, where the object may end if none of `ends` can be reached
    loose: Mapping[str, End] = field(default_factory=dict)
    # Deferred, while the end is not known, regions that the object must reach wherever it is: unseen squares, and the
    # squares of the one end that may be it
    must_reach: DeferredEnds = KnownEnds()
    # Deferred, the ends that follow if the floor goes on as optimistic planning assumes
    hoped: DeferredEnds = KnownEnds()
    # Deferred, what must be seen before the goal holds and is better seen on the way: coming back takes longer
    by_the_way: DeferredViewpoints = NoViewpoints()
    # By name, pushes (dx, dy) in squares along the axes of the map, in the order in which they are made, after which
    # the object touches walls that may be further away than believed. After them a goal that is believed to hold surely
    # holds.
    presses: Mapping[str, Translate] = field(default_factory=dict)
    # Whether the object may end elsewhere, too. Then it proves nothing that none of `ends` can be reached.
    some: bool = False


def meets_end(end: End, shape: Any) -> bool:
    """Return whether a shape (shapely Polygon) meets an end as it is now; both in squares, view frame."""
    return is_goal_met(end, shape, shape)


def meets_any_end(ends: Mapping[str, End], shape: Any) -> bool:
    """Return whether a shape (shapely Polygon) meets any of some ends as it is now; all in squares, view frame."""
    return any(meets_end(end, shape) for end in ends.values())


def is_off_quarter_turn(node: Node) -> bool:
    """Return whether an object has been turned by more than ANGLE_TOLERANCE from a whole number of quarter turns."""
    # What counts is `node.turned`, the degrees since it was first held.
    over = node.turned % 90.0
    return min(over, 90.0 - over) > ANGLE_TOLERANCE


def to_view_frame(shape: Any, situation: Situation) -> Any:
    """Convert a shape (shapely geometry, in squares) from the map frame to the view frame; the shape is not changed."""
    west, south = situation.model.view.west, situation.model.view.south
    return shapely.transform(shape, lambda points: points - np.array([west, south]))


def forbidden_squares(node: Node, situation: Situation, margin: int = 0) -> Bools:
    """Compute the squares over which an object may not be carried."""
    # Necks of doors, and regions that the task forbids.
    # The robot holds the object wherever that goes, so what is forbidden to either is forbidden to both.
    doors = (*situation.shut(ROBOT), *situation.shut(node.name))
    mask = situation.region_kept_off(node.name, margin)
    if not situation.lenient:
        mask |= situation.region_kept_off(ROBOT, margin)
    mask |= neck_squares(doors, situation.model.labels.shape, margin)
    if node.name in situation.too_narrow:
        mask |= np.pad(situation.too_narrow[node.name], margin)
    return mask & ~np.pad(situation.model.mask(node.patch), margin)


def lies_clear_of(mask: Bools, stays: float, node: Node, ends: Mapping[str, End], situation: Situation) -> bool:
    """Return whether an object lies on none of some squares, (rows, columns) bool, now and wherever it meets an end."""
    # The squares fill gaps that it does not pass. stays : the area of it that surely does not come through any of them.
    rows, columns = np.nonzero(mask)
    squares = shapely.union_all(shapely.box(columns, rows, columns + 1, rows + 1))
    shape = to_view_frame(node.polygon, situation)
    reach = math.dist(shape.bounds[:2], shape.bounds[2:])
    thing = situation.model.mask(node.patch)
    labels = components((situation.model.space | thing) & ~mask).labels
    beyond = mask_to_polygon(situation.model.space & ~mask & ~np.isin(labels, labels[thing]))

    def is_clear(end: End) -> bool:
        """Return whether the object touches none of the squares wherever it meets an end."""
        if isinstance(end, Inside):
            return bool(
                shapely.area(end.polygon.difference(beyond)) < stays
                or shapely.area(end.polygon.intersection(squares)) == 0
            )
        if isinstance(end, At):
            return not shapely.intersects(shape_at_pose(shape, end.pose), squares)
        if isinstance(end, InCorner | Between):
            return bool(squares.distance(shapely.Point(end.x, end.y)) > 2 * end.slack + reach)
        return False

    return not shapely.intersects(shape, squares) and all(map(is_clear, ends.values()))


def possible_extension(node: Node, side: tuple[int, int], depth: int, model: WorldModel) -> Bools:
    """Compute the squares straight behind an object that seem to be wall and may belong to the object."""
    mask = model.mask(node.patch)
    found, last = np.zeros_like(mask), mask
    for _ in range(depth if not node.moved else 0):
        last = shift_mask(last, *side) & model.verge & ~mask
        if not last.any():
            break
        found |= last
    return found


def pull_out_pose(node: Node, side: tuple[int, int], depth: int, situation: Situation) -> Pose | None:
    """Compute how an object that may go on in a wall is pulled straight out of it, so that it is seen whole."""
    # None when the object cannot be moved at all that way.
    mask, (dx, dy) = situation.model.mask(node.patch), side
    room = np.pad(situation.cost_maps.free(0) | mask, depth + 1)
    rows, columns = np.nonzero(np.pad(mask, depth + 1))
    blocked = (step for step in range(1, depth + 2) if not room[rows - step * dy, columns - step * dx].all())
    far = next(blocked, depth + 2) - 1
    return Pose(-float(far * dx), -float(far * dy), 0.0) if far else None


def pull_out_end(node: Node, needed: Bools, situation: Situation) -> At | None:
    """Return the pose to which an object is pulled out of a wall, when squares are needed that it may cover there."""
    # Returns None when none of the squares may belong to the object, or when it cannot be pulled.
    for depth, side in product(range(MAX_HIDDEN_DEPTH, 0, -1), SIDE_DIRECTIONS):
        if (possible_extension(node, side, depth, situation.model) & needed).any():
            pose = pull_out_pose(node, side, depth, situation)
            if pose is not None:
                return At(pose)
    return None


def end_away_from(squares: Bools, node: Node, situation: Situation) -> Inside:
    """Return the end of an object that is moved off some squares, (rows, columns) bool, over surely free ones."""
    room = situation.cost_maps.free(0) | situation.model.mask(node.patch)
    return Inside(mask_to_polygon(room & ~squares))


def robot_can_leave(node: Node, situation: Situation) -> bool:
    """Return whether the robot can walk away from an object: it does not hold it, or stands in no nook behind it."""
    held = situation.model.held == node.name
    return not held or floor_leads_away(situation.cost_maps.floor, situation.model.mask(node.patch))


def floor_leads_away(floor: Bools, thing: Bools) -> bool:
    """Return whether reachable floor leads further than NOOK_RANGE rows and columns from the squares of an object."""
    return bool((floor & ~dilate(thing, NOOK_RANGE)).any())
