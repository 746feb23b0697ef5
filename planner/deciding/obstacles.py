"""Obstacles: objects that block the robot's way, as they lie or as they may go on in a wall, and where they shall lie.

A thing that fills a doorway is seen by its face alone; it is supposed to go on to the floor behind it.
"""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from utak.geometry.kernels.arrays import Bools
from utak.geometry.manipulation.goals import End
from utak.geometry.manipulation.plan_carrying import At, Inside
from utak.geometry.motion.se2 import Pose
from utak.geometry.raster.components import components, with_edge_neighbours
from utak.geometry.raster.geodesic import FIFTHS_PER_SQUARE, GEODESIC_UNREACHED
from utak.geometry.raster.runs import mask_to_polygon
from utak.kb.world.model import Node, WorldModel
from utak.planner.goals.embedded import Supposition, supposed_in_walls
from utak.planner.goals.placement import NOOK_RANGE, floor_leads_away, pull_out_pose
from utak.planner.navigation.walks import PlannedRoute, single_route
from utak.planner.screen.projection import UNSEEN_LEVEL, CostMaps, dilate
from utak.planner.situation import Situation

MIN_WAY_BEYOND = 6  # squares: an object that is moved just so far within a doorway still blocks it; a convention
TRIAL_PUSH = 1.0  # squares by which a thing is pushed into a wall to see whether it goes; a convention


class Obstacle(NamedTuple):
    """An object that blocks the robot's way to some part of the floor."""

    node: Node  # the object
    aside: End  # where it shall lie so that the way is free, or so that all of it is seen; in squares, view frame
    situation: Situation  # what is believed, with the object as it is in `node`
    # How it is supposed to go on in a wall; None for an object that is as it was seen
    supposed: Supposition | None = None


def obstacles(
    things: Sequence[Node], situation: Situation, walls: Bools | None = None, parting: bool = False
) -> Iterator[Obstacle]:
    """Yield those of some objects that block the way to floor, known or unseen, that is reached without them."""
    model = situation.model
    under = [model.mask(thing.patch) for thing in things]
    found = [
        (thing, way)
        for thing, mask in zip(things, under, strict=True)
        for way in _routes_opened(mask, situation, walls)
    ]
    if not found and things:
        together = np.any(under, axis=0)
        found = [(_first_on(way, things, model), way) for way in _routes_opened(together, situation, walls)]
    for thing, way in sorted(found, key=lambda pair: pair[1].length):
        for route in (*_routes_opened(model.mask(thing.patch), situation, walls, MIN_WAY_BEYOND), way):
            yield Obstacle(thing, _off_route(thing, route, situation), situation)
    if not found:
        yield from hidden_in_walls(things, situation, parting)


def _routes_opened(
    under: Bools, situation: Situation, walls: Bools | None = None, further: int = 0
) -> list[PlannedRoute]:
    """Return the route, if any, to floor that is reached only if some squares are free; [] into a mere nook."""
    cost_maps = situation.cost_maps
    without = CostMaps(situation.model, under, cost_maps.kept_off)
    beyond = (
        (without.distances[UNSEEN_LEVEL] != GEODESIC_UNREACHED)
        & (cost_maps.distances[UNSEEN_LEVEL] == GEODESIC_UNREACHED)
        & ~under
    )
    worth = walls is not None and (with_edge_neighbours(beyond) & walls).any()
    if not worth and not floor_leads_away(beyond, under):
        return []
    far = np.where(beyond, without.distances[UNSEEN_LEVEL], 0)
    least = int(far[beyond].min()) + further * FIFTHS_PER_SQUARE
    return [single_route(without, UNSEEN_LEVEL, np.flatnonzero(far >= min(least, int(far.max()))), "grid")]


def _off_route(thing: Node, way: PlannedRoute, situation: Situation) -> Inside:
    """Return where an object lies off a route: its own squares and surely free ones, in squares, view frame."""
    columns, rows = np.array(way.squares).T
    room = situation.cost_maps.free(0) | situation.model.mask(thing.patch)
    room[rows, columns] = False
    return Inside(mask_to_polygon(room))


def before_walls(things: Sequence[Node], situation: Situation, walls: Bools) -> Iterator[Obstacle]:
    """Yield those of some objects that stand right before walls that are to be felt, so that they cannot be."""
    # An Obstacle holds the object, and an end: where it shall lie so that these walls can be felt, in squares, view
    # frame: on its own squares and surely free ones that touch none of these walls.
    for thing in things:
        mask = situation.model.mask(thing.patch)
        hidden = with_edge_neighbours(mask) & walls
        if hidden.any():
            room = (situation.cost_maps.free(0) | mask) & ~with_edge_neighbours(hidden)
            yield Obstacle(thing, Inside(mask_to_polygon(room)), situation)


def _first_on(way: PlannedRoute, things: Sequence[Node], model: WorldModel) -> Node:
    """Return the first of some objects that a route over their squares comes to."""
    masks = [(thing, model.mask(thing.patch)) for thing in things]
    return next(thing for column, row in way.squares for thing, mask in masks if mask[row, column])


def hidden_in_walls(things: Sequence[Node], situation: Situation, parting: bool) -> Iterator[Obstacle]:
    """Yield those of some objects that block the way if they go on in what seems to be wall."""
    # For each side on which that is so there are up to three Obstacles, the object as it lies then, with their ends:
    # off the route that opens; drawn out of the wall by one square more than it goes on, or as far as there is room, so
    # that all of it is seen; and pushed TRIAL_PUSH squares further in.

    def opens(under: Bools) -> bool:
        """Return whether a way opens when some squares are free, (rows, columns) bool on the arrays of the view."""
        return bool(_routes_opened(under, situation)) or (parting and _joins_floors(under, situation))

    for thing in things:
        for supposed in supposed_in_walls(thing, situation, opens):
            node, side, within = supposed.node, supposed.side, supposed.situation
            routes = _routes_opened(situation.model.mask(node.patch), situation)
            off = [Obstacle(node, _off_route(node, way, within), within, supposed) for way in routes]
            pose = pull_out_pose(thing, side, supposed.depth, situation)
            out = [] if pose is None else [Obstacle(node, At(pose), within, supposed)]
            yield from [*out, *off] if thing.stuck else [*off, *out]
            yield Obstacle(node, At(Pose(TRIAL_PUSH * side[0], TRIAL_PUSH * side[1], 0.0)), within, supposed)


def _joins_floors(under: Bools, situation: Situation) -> bool:
    """Return whether some squares have floor on two sides that do not hang together around them."""
    near = situation.model.space & dilate(under, NOOK_RANGE) & ~under
    beside = components(near).labels[with_edge_neighbours(under) & near]
    return len(np.unique(beside)) > 1
