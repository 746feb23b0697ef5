"""Things that may be several that touch, and the floor from which their rims are felt all round."""

import numpy as np

from utak.geometry.kernels.arrays import Bools
from utak.geometry.raster.components import with_edge_neighbours
from utak.kb.world.model import Node
from utak.planner.screen.projection import CostMaps
from utak.planner.sights.frontiers import Viewpoint, elsewhere_touch_viewpoint
from utak.planner.sights.walls import MIN_LIKELY_OBJECT, FeelingScope


def things_in_question(cost_maps: CostMaps, scope: FeelingScope) -> list[Node]:
    """Return the objects that were never seen to move as one thing, and so may be several, in model order."""
    model = cost_maps.model
    several = [node for node in model.objects if not node.whole and node.confidence >= MIN_LIKELY_OBJECT]
    if scope.things:
        return several
    known: Bools = (
        cost_maps.floor | model.felt_verge | np.any([model.mask(node.patch) for node in model.objects], axis=0)
    )
    return [node for node in several if (with_edge_neighbours(model.mask(node.patch)) & ~known).any()]


def unfelt_rims(cost_maps: CostMaps, scope: FeelingScope) -> list[Viewpoint]:
    """Return, for each thing that may be several and was not felt all round, floor from which more of it is felt."""
    model = cost_maps.model
    felt = model.squares(model.felt)
    looks = [
        elsewhere_touch_viewpoint(cost_maps, model.mask(node.patch) & ~felt)._replace(
            what=f"{node.name} may be more than one thing, so it is felt all round"
        )
        for node in things_in_question(cost_maps, scope)
    ]
    return [look for look in looks if len(look.squares)]
