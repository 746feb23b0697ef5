"""Preconditions of a manipulation plan: what must be seen or felt before it is begun, and what its turns cost."""

from collections.abc import Iterator

from utak.kb.mapping.occupancy import OPEN
from utak.kb.world.model import MAX_FREE_PROBABILITY, Node, WorldModel
from utak.planner.carrying.manipulation_oracle import ManipulationPlan
from utak.planner.screen.moves import orientation_is_uncertain
from utak.planner.screen.projection import dilate
from utak.planner.sights.frontiers import Viewpoint, rim_viewpoint, touch_viewpoint, viewpoint_of
from utak.planner.sights.viewpoints import TO_TAKE, inspection
from utak.planner.situation import Situation

PLACE_SLACK = 0.02  # squares by which the robot may stand elsewhere in its square before a turn needs more room; tuned
TURN_COST_OPEN_FRAME = 2.5  # commands that a turn counts for while the orientation of the frame is open; tuned
TURN_COST_OPEN_PLACE = 1.5  # commands that it counts for while the place within the square is open; tuned
LONG_PLAN = 8  # commands of a plan above which everything unclear about its way is looked at first; tuned
DETOUR_ROOM = 2  # squares beside the way of a long plan within which more room would help; tuned


def needed_views(found: ManipulationPlan, node: Node, situation: Situation) -> list[Viewpoint]:
    """Return what of the way of a plan must be seen before it is begun; [] when no look tells more of it."""
    # To release the object, walk, come back and grasp it again costs more than to be stopped, so a plan that goes on
    # with the present grasp is trusted, and so is one over hoped squares.
    model, is_long = situation.model, found.plan.commands > LONG_PLAN
    if found.hopes or (found.plan.goes_on and not is_long):
        return []
    unsure = found.swept & ~situation.cost_maps.free(0)
    if is_long:
        unsure |= (
            dilate(found.swept, DETOUR_ROOM)
            & (model.view.state == OPEN)
            & (model.view.probability > MAX_FREE_PROBABILITY)
        )
    unsure &= ~model.mask(node.patch)
    if not unsure.any():
        return []
    viewpoint = viewpoint_of(situation.cost_maps, unsure, f"it is not clear whether the way for {node.name} is free")
    return [viewpoint] if len(viewpoint.squares) else []


def touches_of_obstacles(found: ManipulationPlan, situation: Situation) -> Iterator[Viewpoint]:
    """Yield where to feel the obstacles of a plan that may be pieces of wall, then how far they go."""
    # Nothing when there is no floor beside them from which the robot did not feel them yet.
    things = [thing for thing in situation.model.objects if thing.name in found.aside]
    unsure = (touch_viewpoint(situation.cost_maps, thing) for thing in things if thing.felt_first)
    yield from (look for look in unsure if len(look.squares))
    ends = (rim_viewpoint(situation.cost_maps, thing) for thing in things)
    yield from (look for look in ends if look is not None and len(look.squares))


def looks_at_obstacles(found: ManipulationPlan, situation: Situation) -> Iterator[Viewpoint]:
    """Yield looks at the obstacles of a plan of which squares are open."""
    # Nothing when the robot looked at each of them from everywhere.
    named = (situation.model.object(name) for name in found.aside)
    unclear = (other for other in named if other is not None and other.open)
    looks = (inspection(situation.cost_maps, other, chance=1.0, to=TO_TAKE) for other in unclear)
    yield from (look for look in looks if len(look.squares))


def turn_cost(model: WorldModel) -> float:
    """Return how many commands a turn of a held object counts for: 1.0 or more."""
    if orientation_is_uncertain(model):
        return TURN_COST_OPEN_FRAME
    return TURN_COST_OPEN_PLACE if max(model.leeway) > PLACE_SLACK else 1.0
