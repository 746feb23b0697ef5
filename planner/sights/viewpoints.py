"""Viewpoints for objects: floor from which the robot tells what an object is, or where it can take it.

A robot that wants to take an object counts commands, not squares of way. It goes right up to the object by one straight
move where that is possible, also over squares that are only likely free: if one is not, the object itself stops it.
"""

from typing import NamedTuple

import numpy as np

from utak.geometry.kernels.arrays import Bools, Floats
from utak.geometry.raster.components import components, with_edge_neighbours
from utak.kb.mapping.occupancy import OPEN
from utak.kb.world.model import Node
from utak.planner.screen.moves import one_move_squares
from utak.planner.screen.projection import SURELY_OCCUPIED, CostMaps, SquareIndices, dilate, indices_to_mask, shift_mask
from utak.planner.screen.unseen_gain import window_sums
from utak.planner.sights.frontiers import (
    EQUAL_VALUE_SHARE,
    FOVEA_RANGE,
    MIDDLE_ZONE_RANGE,
    VIEW_SPACING,
    Viewpoint,
    group_by_label,
    unlooked_floor,
)
from utak.planner.subgoal_kind import SubgoalKind

MIN_SIGHTING_PROBABILITY = 0.1  # a place that holds a wanted object with at least this is worth a look (tuned)
MOST_LIKELY = 99  # percent of belief in what may be so, at most: 100 is for what is not in question (convention)
MIN_APPROACH_PROBABILITY = 0.5  # with at least this probability the robot goes right up to it (tuned on random worlds)
RESTART_COST_WALKING = 4.0  # squares of way that setting out anew after a look costs a robot that only walks (tuned)
RESTART_COST_CARRYING = 12.0  # the same for a robot that carries objects and counts commands (tuned on random worlds)
UNSEEN_SQUARE_WEIGHT = 0.03  # worth of an unseen square in sight, where a square of the object counts 1 (tuned)


class Approach(NamedTuple):
    """The purpose for which the robot goes up to an object."""

    take: bool  # whether to take it; else to be beside it is all that is wanted
    # The direction (x, y), each 1 or -1, along the axes of the map, of the corner of walls to which the object shall be
    # brought; None for no corner. On the sides towards these walls the robot would stand in the way.
    corner: tuple[int, int] | None = None


TO_REACH, TO_TAKE = Approach(take=False), Approach(take=True)


def sightings(cost_maps: CostMaps, likely: Floats, what: str, to: Approach) -> list[tuple[SquareIndices, Viewpoint]]:
    """Find the viewpoints for the places that may hold a wanted object not settled yet, with each one's squares."""
    view = cost_maps.model.view
    spots = group_by_label(components(likely >= MIN_SIGHTING_PROBABILITY).labels)
    found = []
    for spot in spots:
        mask = indices_to_mask(spot, likely.shape)
        if not (view.state.ravel()[spot] == OPEN).any():
            continue
        chance = float(likely.ravel()[spot].max())
        near = inspection_squares(cost_maps, mask, chance, to)
        if len(near):
            found.append((spot, Viewpoint(near, what, min(MOST_LIKELY, round(100 * chance)))))
    return found


def inspection(cost_maps: CostMaps, node: Node, chance: float, to: Approach) -> Viewpoint:
    """Return the floor from which an object is seen better than it was."""
    squares = inspection_squares(cost_maps, cost_maps.model.mask(node.patch), chance, to)
    return Viewpoint(squares, f"it is not clear what {node.name} is, or how far it goes")


def inspection_squares(cost_maps: CostMaps, mask: Bools, chance: float, to: Approach) -> SquareIndices:
    """Choose the floor from which something is seen better than it was; none when the robot looked from everywhere."""
    beside = dilate(mask, 1)
    beside_floor = np.flatnonzero(cost_maps.floor & with_edge_neighbours(mask))
    near = _taking_squares(cost_maps, mask, to) if to.take else beside_floor
    worth_it = chance >= MIN_APPROACH_PROBABILITY or to.take
    if worth_it and len(near) and not (beside & cost_maps.looked_from).any():
        return _most_revealing(cost_maps, near, mask, chance, to) if to.take else near
    if not to.take:
        far = dilate(mask, MIDDLE_ZONE_RANGE)
        near = np.flatnonzero(cost_maps.floor & far)
        if len(near) and not (far & cost_maps.looked_from).any():
            return near
    around = dilate(mask, FOVEA_RANGE)
    for apart in (VIEW_SPACING, 0):
        near = np.flatnonzero(unlooked_floor(cost_maps, apart) & around)
        if len(near):
            break
    return _most_revealing(cost_maps, near, mask, chance, to)


def _taking_squares(cost_maps: CostMaps, mask: Bools, to: Approach) -> SquareIndices:
    """List the squares beside an object from which it may be taken. mask : the squares that it may cover."""
    surely = mask & (cost_maps.model.view.probability >= SURELY_OCCUPIED)
    sides = _sides_out_of_the_way(cost_maps, surely, to)
    for candidates in (sides, with_edge_neighbours(mask)):
        met = np.flatnonzero(one_move_squares(cost_maps, SubgoalKind.INSPECT, candidates))
        near = met if len(met) else np.flatnonzero(cost_maps.floor & candidates)
        if len(near):
            break
    return near


def _sides_out_of_the_way(cost_maps: CostMaps, surely: Bools, to: Approach) -> Bools:
    """Return the sides of an object, without those where the robot would be in its way, if others have floor."""
    sides = with_edge_neighbours(surely)
    if to.corner is None:
        return sides
    east, north = to.corner
    free = sides & ~(shift_mask(surely, east, 0) | shift_mask(surely, 0, north))
    return free if (cost_maps.floor & free).any() else sides


def _most_revealing(
    cost_maps: CostMaps, near: SquareIndices, mask: Bools, chance: float, to: Approach
) -> SquareIndices:
    """Choose those of `near` from which most unsettled squares of something are in the fovea for the way there."""
    beside = dilate(mask, 1)
    open_ = beside & ~cost_maps.model.told
    if len(near) < 2 or not open_.any():
        return near
    seen = window_sums(np.pad(open_, FOVEA_RANGE).astype(np.float64), FOVEA_RANGE).ravel()[near]
    if to.take:
        seen = seen + UNSEEN_SQUARE_WEIGHT * cost_maps.information_gain.ravel()[near]
    away = ~beside.ravel()[near]
    restart_cost = RESTART_COST_CARRYING if to.take else RESTART_COST_WALKING
    value = (seen + 1) / (cost_maps.far(near) + restart_cost * (1 + chance * away))
    best: SquareIndices = near[value >= EQUAL_VALUE_SHARE * value.max()]
    return best
