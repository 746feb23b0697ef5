"""Things that may be several that touch, and the floor from which all of their rims are felt."""

from kb.world.model import Node, WorldModel
from planner.screen.projection import CostMaps, dilate
from planner.sights.frontiers import Viewpoint, wall_touch_viewpoint
from planner.sights.walls import MIN_LIKELY_OBJECT, FeelingScope


def things_in_question(model: WorldModel, cost_maps: CostMaps, scope: FeelingScope) -> list[Node]:
    """Return the objects that were never moved, and may be several things, in the order of the model.

    Where neither a wall between two parts of the floor matters nor the task speaks of objects, those all around which
    the floor is reached are left out.

    Parameters
    ----------
    model : what is believed.
    cost_maps : of that model.
    scope : what matters for the task.
    """
    unmoved = [node for node in model.objects if not node.moved and node.confidence >= MIN_LIKELY_OBJECT]
    if scope.parting or scope.things:
        return unmoved
    masks = {node.name: model.mask(node.patch) for node in unmoved}
    return [node for node in unmoved if (dilate(masks[node.name], 1) & ~masks[node.name] & ~cost_maps.floor).any()]


def rims_to_feel(cost_maps: CostMaps, scope: FeelingScope) -> list[Viewpoint]:
    """Return, for each thing that may be several and was not felt all round, the floor from which more of it is felt.

    Viewpoints without squares are left out.

    Parameters
    ----------
    cost_maps : the present world model on arrays of squares, with the ways from where the robot stands.
    scope : what matters for the task.
    """
    model, (column, row) = cost_maps.model, cost_maps.here
    felt, here = model.squares(model.felt), row * cost_maps.floor.shape[1] + column
    found = []
    for node in things_in_question(model, cost_maps, scope):
        beside = wall_touch_viewpoint(cost_maps, model.mask(node.patch) & ~felt).squares
        what = f"{node.name} may be more than one thing, so it is felt all round"
        found.append(Viewpoint(beside[beside != here], what))
    return [look for look in found if len(look.squares)]
