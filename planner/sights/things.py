"""Things that may be several that touch, and the floor from which their rims are felt all round."""

import math
from typing import NamedTuple

import numpy as np

from geometry.raster.components import with_edge_neighbours
from kb.world.model import Node, WorldModel
from planner.screen.projection import CostMaps, dilate
from planner.sights.frontiers import Viewpoint, wall_touch_viewpoint
from planner.sights.walls import DOORWAY_WIDTH, MIN_LIKELY_OBJECT, FeelingScope


def things_in_question(model: WorldModel, cost_maps: CostMaps, scope: FeelingScope) -> list[Node]:
    """Return the objects that were never seen to move as one thing, and so may be several, in the order of the model.

    Where neither a wall between two parts of the floor matters nor the task speaks of objects, those all around which
    the floor is reached are left out.

    Parameters
    ----------
    model : what is believed.
    cost_maps : of that model.
    scope : what matters for the task.
    """
    several = [node for node in model.objects if not node.whole and node.confidence >= MIN_LIKELY_OBJECT]
    if scope.parting or scope.things:
        return several
    masks = {node.name: model.mask(node.patch) for node in several}
    return [node for node in several if (dilate(masks[node.name], 1) & ~masks[node.name] & ~cost_maps.floor).any()]


class UnfeltRim(NamedTuple):
    """The part of the rim of a thing that was not felt yet, and can be.

    Attributes
    ----------
    node : the thing.
    look : the floor from which more of it is felt.
    halts : about how many halts it takes to feel all of it: three squares in a row are felt at once.
    """

    node: Node
    look: Viewpoint
    halts: int


def unfelt_rims(cost_maps: CostMaps, scope: FeelingScope) -> list[UnfeltRim]:
    """Return the rims of things that may be several, as far as they were not felt yet, in the order of the model.

    Parameters
    ----------
    cost_maps : the present world model on arrays of squares, with the ways from where the robot stands.
    scope : what matters for the task.
    """
    model, (column, row) = cost_maps.model, cost_maps.here
    felt, here = model.squares(model.felt), row * cost_maps.floor.shape[1] + column
    found = []
    for node in things_in_question(model, cost_maps, scope):
        unfelt = model.mask(node.patch) & ~felt
        beside = wall_touch_viewpoint(cost_maps, unfelt).squares
        look = Viewpoint(beside[beside != here], f"{node.name} may be more than one thing, so it is felt all round")
        rim = np.count_nonzero(unfelt & with_edge_neighbours(cost_maps.floor))
        found.append(UnfeltRim(node, look, math.ceil(rim / DOORWAY_WIDTH)))
    return [rim for rim in found if len(rim.look.squares)]
