"""Frontiers, and other places worth a look: where the floor borders on unseen squares, or something is not settled.

A frontier is floor that borders on squares that were never seen (Yamauchi 1997). All functions give candidates only;
planner/asp/deciding/subgoals.lp chooses among them. Several viewpoints come in
the order in which a scan meets them, row by row from the south; the squares of each ascend.
"""

import math
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from utak.geometry.counts.retina import RETINA_ZONES
from utak.geometry.kernels.arrays import Bools, Labels
from utak.geometry.raster.components import components, with_edge_neighbours
from utak.geometry.raster.geodesic import FIFTHS_PER_SQUARE, GEODESIC_UNREACHED
from utak.kb.world.model import Node
from utak.kb.world.rooms import Door
from utak.planner.screen.projection import (
    CostMaps,
    SquareIndices,
    dilate,
    indices_to_mask,
    square_index,
)
from utak.planner.screen.unseen_gain import VERGE_WEIGHT

WHAT_IS_FELT = "it was not felt whether something stands against the wall"
FOVEA_RANGE = 3  # squares, in rows and columns, from which a square lies within the fovea (derived: -4..3)
# Squares from which a square lies within the middle zone of the retina (derived: offsets -8..7)
MIDDLE_ZONE_RANGE = RETINA_ZONES[1][0] - 1
JAMB_RANGE = 8  # squares around the end of a door's neck within which its walls are looked at (tuned on random worlds)
VIEW_SPACING = 2  # squares from earlier viewpoints beyond which a new one is sought first (tuned on random worlds)
GAP_LEVEL = 2  # certainty level at which a way leads through a likely gap (tuned on random worlds)
LOOK_AHEAD_RANGE = 5  # squares before a place from which what lies behind it comes into sight (tuned on random worlds)
MIN_UNREACHED_SQUARES = 6  # squares of floor for which a hidden passage is assumed (tuned on random worlds)
EQUAL_VALUE_SHARE = 0.9  # viewpoints worth at least this share of the best one count as equal (tuned on random worlds)
SQUARES_PER_OBJECT = 800  # squares of unseen floor among which one wanted object is expected (tuned on random worlds)
FRONTIER_REASON = "the floor goes on unseen"


class Viewpoint(NamedTuple):
    """A set of squares from each of which the same unknown thing is seen or felt."""

    # They are the squares where the robot would stand, not those that it would look at.

    # Flat indices (row * columns + column) on the arrays of the view, (n,) int64; empty when there is no such square
    squares: SquareIndices
    what: str  # what is not known, in words
    chance: int = 100  # percent of belief that it is what is looked for; 100 when nothing tells that it is less


def find_frontiers(cost_maps: CostMaps, apart: int) -> list[Viewpoint]:
    """Find the reachable floor that borders on unseen squares: one Viewpoint for each frontier, a connected stretch."""
    border = unlooked_floor(cost_maps, apart) & dilate(~cost_maps.model.view.seen, 1)
    return [Viewpoint(squares, FRONTIER_REASON) for squares in group_by_label(_stretches(border))]


def likely_gaps(cost_maps: CostMaps) -> list[Viewpoint]:
    """Find likely gaps in what bounds the floor, through which it would go on unseen."""
    # Its squares are those of the gap itself: a way leads to them at certainty level GAP_LEVEL, and from them the robot
    # would see beyond.
    view = cost_maps.model.view
    edge = view.seen & dilate(~view.seen, 1)
    border = edge & (cost_maps.distances[GAP_LEVEL] != GEODESIC_UNREACHED)
    surely = dilate(edge & cost_maps.floor, 1).ravel()
    stretches = [squares for squares in group_by_label(_stretches(border)) if not surely[squares].any()]
    return [Viewpoint(squares, "there may be a gap in what bounds the floor") for squares in stretches]


def unsettled_boundaries(cost_maps: CostMaps, apart: int) -> list[Viewpoint]:
    """Find floor close to unsettled boundaries: squares beside the floor that were seen only coarsely."""
    open_ = cost_maps.unsettled & dilate(cost_maps.floor, 1)
    near = np.where(unlooked_floor(cost_maps, apart), _grown_labels(_stretches(open_), FOVEA_RANGE), 0)
    what = "what bounds the floor is not clear"
    return [Viewpoint(squares, with_place(cost_maps, squares, what)) for squares in group_by_label(near)]


def touch_viewpoint(cost_maps: CostMaps, node: Node) -> Viewpoint:
    """Return the floor beside an object from which the robot feels its colour and did not look yet."""
    beside = dilate(cost_maps.model.mask(node.patch), 1)
    return Viewpoint(np.flatnonzero(unlooked_floor(cost_maps, 0) & beside), f"the colour of {node.name} is not known")


def wall_touch_viewpoint(cost_maps: CostMaps, mask: Bools) -> Viewpoint:
    """Return the floor from which the robot feels whether something is part of a wall, and where not yet."""
    beside = np.flatnonzero(unlooked_floor(cost_maps, 0) & with_edge_neighbours(mask))
    return Viewpoint(beside, with_place(cost_maps, np.flatnonzero(mask), WHAT_IS_FELT))


def elsewhere_touch_viewpoint(cost_maps: CostMaps, mask: Bools) -> Viewpoint:
    """Return the same without the robot's own square: what is beside it is felt already."""
    look, model = wall_touch_viewpoint(cost_maps, mask), cost_maps.model
    return look._replace(squares=look.squares[look.squares != square_index(model.place, model)])


def rim_viewpoint(cost_maps: CostMaps, node: Node) -> Viewpoint | None:
    """Return the floor from which the robot feels how far an object goes; None when nothing about it is to be felt."""
    # That is so for an object that was never moved, is not in hand, and touches a wall or another object, or did not
    # move when it was pushed: that may be more than one thing, or a thing and a wall, so all of its rim is felt.
    model = cost_maps.model
    if node.moved or model.held == node.name:
        return None
    own = model.mask(node.patch)
    rim = with_edge_neighbours(own)
    standing = [model.verge, *(model.mask(other.patch) for other in model.objects if other.name != node.name)]
    touches = any((rim & mask).any() for mask in standing)
    unfelt = own & ~model.squares(model.felt)
    resisting = [unfelt] if node.stuck and model.held is None else []
    for mask in (*((*model.unsettled_seams, *model.protruding) if touches else ()), *resisting):
        look = elsewhere_touch_viewpoint(cost_maps, mask)
        if (mask & rim).any() and len(look.squares):
            return look
    return None


def viewpoint_of(cost_maps: CostMaps, mask: Bools, what: str) -> Viewpoint:
    """Return the floor from which some squares are seen best, where the robot did not look yet."""
    # It is reachable floor within the range of the fovea of any of them, or else of the middle zone.
    what = with_place(cost_maps, np.flatnonzero(mask), what)
    for reach, apart in ((FOVEA_RANGE, VIEW_SPACING), (FOVEA_RANGE, 0), (MIDDLE_ZONE_RANGE, VIEW_SPACING)):
        near = np.flatnonzero(unlooked_floor(cost_maps, apart) & dilate(mask, reach))
        if len(near):
            return Viewpoint(near, what)
    return Viewpoint(np.zeros(0, np.int64), what)


def with_place(cost_maps: CostMaps, squares: SquareIndices, what: str) -> str:
    """Return what is not known, in words, with about where it is."""
    if not len(squares):
        return what
    rows, columns = np.divmod(squares, cost_maps.floor.shape[1])
    return f"{what}, near {cost_maps.model.point_in_words((columns.mean() + 0.5, rows.mean() + 0.5))}"


def fovea_squares(cost_maps: CostMaps, x: float, y: float) -> SquareIndices:
    """Return the floor from which all squares around a point lie within the fovea, whether looked from or not."""
    mask = cost_maps.model.squares([(math.floor(x), math.floor(y))])
    return np.flatnonzero(cost_maps.floor & dilate(mask, FOVEA_RANGE - 1))


def look_ahead_squares(cost_maps: CostMaps, squares: SquareIndices) -> SquareIndices:
    """Return the floor from which the robot sees what lies behind some squares."""
    mask = indices_to_mask(squares, cost_maps.floor.shape)
    near = unlooked_floor(cost_maps, VIEW_SPACING) & dilate(mask, LOOK_AHEAD_RANGE)
    return np.flatnonzero(near | (mask & cost_maps.floor))


def door_jambs(cost_maps: CostMaps, doors: Iterable[Door]) -> list[Viewpoint]:
    """Find the floor from which the unsettled walls beside each door are seen closely."""
    found = []
    for door in (one for one in doors if not one.sure):
        ends = np.zeros(cost_maps.unsettled.shape, np.bool_)
        for x, y in (door.a, door.b):
            row, column = round(y), round(x)
            rows = slice(max(row - JAMB_RANGE, 0), row + JAMB_RANGE)
            columns = slice(max(column - JAMB_RANGE, 0), column + JAMB_RANGE)
            ends[rows, columns] = True
        found.append(viewpoint_of(cost_maps, cost_maps.unsettled & ends, "whether there is a door is not clear"))
    return [view for view in found if len(view.squares)]


def unreached_rooms(cost_maps: CostMaps) -> list[Viewpoint]:
    """Find connected floor that is seen and cannot be reached yet: one Viewpoint for each such part."""
    # All floor is connected, so a passage that is not seen yet must lead there.
    apart = components(cost_maps.model.space & ~cost_maps.floor).labels
    what = "floor is seen beyond, so a passage must lead there"
    return [Viewpoint(squares, what) for squares in group_by_label(apart) if len(squares) >= MIN_UNREACHED_SQUARES]


def with_chances(cost_maps: CostMaps, viewpoints: list[Viewpoint]) -> list[Viewpoint]:
    """Return the viewpoints, in order, with the chance that a wanted object is seen from their nearest square."""
    if not viewpoints:
        return []
    return [view._replace(chance=_chance(gain_of(cost_maps, view))) for view in viewpoints]


def gain_of(cost_maps: CostMaps, view: Viewpoint) -> float:
    """Return the weighted number of squares never seen that come into sight from the nearest square of a viewpoint."""
    return float(cost_maps.information_gain.ravel()[nearest_square(cost_maps, view.squares)])


def best_views(cost_maps: CostMaps, reachable: Bools, move_cost: float, square_cost: float) -> list[Viewpoint]:
    """Choose, of the squares that one straight move reaches, those of most information gain for their cost."""
    # They need not border on unseen squares: a long move along a frontier often shows more than a short one up to it.
    candidates = np.flatnonzero(reachable & unlooked_floor(cost_maps, VIEW_SPACING))
    gain = cost_maps.information_gain.ravel()[candidates]
    if gain.max(initial=0.0) < VERGE_WEIGHT:
        return []
    far = cost_maps.distances[0].ravel()[candidates] / FIFTHS_PER_SQUARE
    value = gain / (move_cost + square_cost * far)
    return [Viewpoint(candidates[value >= EQUAL_VALUE_SHARE * value.max()], FRONTIER_REASON)]


def _chance(gain: float) -> int:
    """Estimate the chance that a wanted object is among `gain` unseen squares, in percent, 1 to 90."""
    return max(1, min(90, round(100 * gain / SQUARES_PER_OBJECT)))


def nearest_square(cost_maps: CostMaps, squares: SquareIndices) -> int:
    """Return that of `squares` with the shortest way for the robot, at the surest level at which any is reached."""
    reached = cost_maps.nearest(squares)
    if reached is None:
        return int(squares[0])
    column, row = cost_maps.nearest_at(reached.level, squares)
    return row * int(cost_maps.floor.shape[1]) + column


def unlooked_floor(cost_maps: CostMaps, apart: int) -> Bools:
    """Return the reachable floor from which the robot did not look yet, (rows, columns) bool."""
    mask: Bools = cost_maps.floor & ~dilate(cost_maps.looked_from, apart)
    return mask


def _stretches(mask: Bools) -> Labels:
    """Label the connected stretches of a mask, (rows, columns) int32: 1 and up, 0 outside the mask."""
    # Squares are connected when the squares around them (3 x 3) overlap or share an edge, so also across small gaps.
    labels: Labels = np.where(mask, components(dilate(mask, 1)).labels, 0)
    return labels


def group_by_label(labels: Labels) -> list[SquareIndices]:
    """Group the flat indices of a (rows, columns) array by label, in ascending order of labels, without label 0."""
    flat = labels.ravel()
    squares = np.flatnonzero(flat)
    ordered = squares[np.argsort(flat[squares], kind="stable")]
    cuts = np.flatnonzero(np.diff(flat[ordered])) + 1
    return [group for group in np.split(ordered, cuts) if len(group)]


def _grown_labels(labels: Labels, squares: int) -> Labels:
    """Return labels grown by `squares` rows and columns; where two labels meet the greater one wins."""
    for _ in range(squares):
        for axis in (0, 1):
            padded = np.pad(labels, [(1, 1) if a == axis else (0, 0) for a in (0, 1)])
            lower, upper = (padded[:-2], padded[2:]) if axis == 0 else (padded[:, :-2], padded[:, 2:])
            labels = np.maximum(labels, np.maximum(lower, upper))
    return labels
