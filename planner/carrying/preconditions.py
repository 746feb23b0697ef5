"""Preconditions of a manipulation plan: what must be seen or felt before it is begun, and what its turns cost."""

from collections.abc import Iterable

from utak.kb.mapping.occupancy import OPEN
from utak.kb.world.model import MAX_FREE_PROBABILITY, Node, WorldModel
from utak.planner.advice import See
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


def needed_view(found: ManipulationPlan, node: Node, situation: Situation) -> See | None:
    """Return what of the way of a plan must be seen before it is begun; None when no look tells more of it."""
    # To release the object, walk, come back and grasp it again costs more than to be stopped, so a plan that goes on
    # with the present grasp is trusted, and so is one over hoped squares.
    model, is_long = situation.model, found.plan.commands > LONG_PLAN
    if found.hopes or (found.plan.goes_on and not is_long):
        return None
    unsure = found.swept & ~situation.cost_maps.free(0)
    if is_long:
        unsure |= (
            dilate(found.swept, DETOUR_ROOM)
            & (model.view.state == OPEN)
            & (model.view.probability > MAX_FREE_PROBABILITY)
        )
    unsure &= ~model.mask(node.patch)
    if not unsure.any():
        return None
    viewpoint = viewpoint_of(situation.cost_maps, unsure, f"it is not clear whether the way for {node.name} is free")
    return See(viewpoint) if len(viewpoint.squares) else None


def touch_of_obstacle(found: ManipulationPlan, situation: Situation) -> See | None:
    """Return where to feel the first obstacle of a plan that may be a piece of wall; None when there is none."""
    # Also None when there is no floor beside it from which the robot did not feel it yet.
    things = [thing for thing in situation.model.objects if thing.name in found.aside]
    unsure = (touch_viewpoint(situation.cost_maps, thing) for thing in things if thing.felt_first)
    ends = (rim_viewpoint(situation.cost_maps, thing) for thing in things)
    return _first_see(unsure) or _first_see(look for look in ends if look is not None)


def look_at_obstacle(found: ManipulationPlan, situation: Situation) -> See | None:
    """Return a look at the first obstacle of a plan of which squares are open; None when there is none."""
    # Also None when the robot looked at each of them from everywhere.
    named = (situation.model.object(name) for name in found.aside)
    unclear = (other for other in named if other is not None and other.open)
    return _first_see(inspection(situation.cost_maps, other, chance=1.0, to=TO_TAKE) for other in unclear)


def turn_cost(model: WorldModel) -> float:
    """Return how many commands a turn of a held object counts for: 1.0 or more."""
    if orientation_is_uncertain(model):
        return TURN_COST_OPEN_FRAME
    return TURN_COST_OPEN_PLACE if max(model.leeway) > PLACE_SLACK else 1.0


def _first_see(looks: Iterable[Viewpoint]) -> See | None:
    """Return the advice to use the first of some viewpoints that has squares; None when none has."""
    return next((See(look) for look in looks if len(look.squares)), None)
