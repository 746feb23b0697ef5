"""Subgoals: go where a goal holds; while that is not known, look where what is missing may be."""

from collections.abc import Sequence

import numpy as np

from utak.geometry.kernels.arrays import Floats
from utak.kb.reasoning.encodings import encoding_facts
from utak.kb.task.binding import Reconciliation
from utak.kb.world.rooms import rooms_of
from utak.planner.goals.robot_goals import Destination
from utak.planner.navigation.fewest_moves import MOVE_COST, SQUARE_COST
from utak.planner.navigation.subgoals import Subgoal
from utak.planner.question import PLANNER_ASP
from utak.planner.screen.moves import one_move_squares
from utak.planner.screen.projection import CostMaps, SquareIndices
from utak.planner.sights import frontiers
from utak.planner.sights.frontiers import Viewpoint
from utak.planner.sights.viewpoints import MOST_LIKELY, TO_TAKE, Approach, inspection, sightings
from utak.planner.situation import Situation
from utak.planner.subgoal_kind import SubgoalKind

PRIORS_OF_LOOKS = PLANNER_ASP / "priors_of_looks.lp"


def subgoals_towards(
    where: Sequence[Destination], situation: Situation, reconciled: Reconciliation, to: Approach = TO_TAKE
) -> list[Subgoal]:
    """Return the subgoals that may lead to where all of some goals hold."""
    cost_maps = situation.cost_maps
    missing = [d for d in where if d.missing]
    if not missing:
        squares: SquareIndices = where[0].squares
        for other in where[1:]:
            squares = np.intersect1d(squares, other.squares)
        return [Subgoal(SubgoalKind.ATTAIN, squares, "the way to the goal is known")]
    things = _doubtful_objects(situation, reconciled, to)
    subgoals = [Subgoal(SubgoalKind.EXPLORE, *look) for d in missing for look in d.viewpoints]
    if any(_is_surely_reached(subgoal, cost_maps) for subgoal in subgoals):
        return [*subgoals, *things]
    unseen = _unseen_share(situation, reconciled)
    likely = _object_heat(situation, reconciled, unseen)
    places = [] if likely is None else _likely_places(cost_maps, likely, to)
    for kind, look in looks_at_the_unseen(cost_maps, to):
        chance = unseen * _chance_of_look(kind, frontiers.gain_of(cost_maps, look))
        places.append(Subgoal(kind, look.squares, look.what, max(1, round(100 * chance))))
    return [*subgoals, *things, *places]


def contact_subgoals(situation: Situation) -> list[Subgoal]:
    """Return where to feel what may be an object against a wall; if there is no such, what may be part of a wall."""
    return wall_contacts(situation) or island_contacts(situation)


def wall_contacts(situation: Situation) -> list[Subgoal]:
    """Return, for each part of a wall that may be an object standing against it, where it can be felt."""
    looks = [frontiers.wall_touch_viewpoint(situation.cost_maps, mask) for mask in situation.model.protruding]
    return [Subgoal(SubgoalKind.INSPECT, *look) for look in looks if len(look.squares)]


def island_contacts(situation: Situation) -> list[Subgoal]:
    """Return, for each free-standing object that would make more doors if it were wall, where it can be felt."""
    # Wall would join what bounds the floor, and so make necks of the floor beside it.
    model = situation.model
    subgoals = []
    for node in model.objects:
        if node.colour is None and not node.moved:
            rooms = rooms_of(model, situation.rules, model.verge | model.mask(node.patch))
            if len(rooms.doors) > len(situation.rooms.doors):
                look = frontiers.touch_viewpoint(situation.cost_maps, node)
                subgoals += [Subgoal(SubgoalKind.INSPECT, *look)] if len(look.squares) else []
    return subgoals


def _doubtful_objects(situation: Situation, reconciled: Reconciliation, to: Approach) -> list[Subgoal]:
    """Return a look at each object of the world model that may be what is looked for, or a touch of it."""
    cost_maps, model = situation.cost_maps, situation.model
    found = []
    for x, name in reconciled.doubtful:
        node = model.object(name)
        if node is None or x not in reconciled.hypothesised:
            continue
        percent = max(1, min(MOST_LIKELY, situation.may_be.get(x, {}).get(name, 0)))
        look = (
            inspection(cost_maps, node, percent / 100, to) if node.open else frontiers.touch_viewpoint(cost_maps, node)
        )
        found.append(Subgoal(SubgoalKind.INSPECT, look.squares, f"{look.what}: it may be {x}", percent))
    return [subgoal for subgoal in found if len(subgoal.squares)]


def _unseen_share(situation: Situation, reconciled: Reconciliation) -> float:
    """Return the probability, 0 to 1, that what is looked for is none of the objects that were seen."""
    objects = {node.name for node in situation.model.objects}
    may_be = (situation.may_be[x] for x in reconciled.hypothesised if x in situation.may_be)
    shares = [sum(percent for place, percent in places.items() if place not in objects) for places in may_be]
    return max(shares, default=100) / 100


def _likely_places(cost_maps: CostMaps, likely: Floats, to: Approach) -> list[Subgoal]:
    """Return looks at the places where map completions show what is looked for; [] for none."""
    seen = sightings(cost_maps, likely, "what is looked for may be there", to)
    return [Subgoal(SubgoalKind.INSPECT, *look) for _, look in seen]


def looks_at_the_unseen(cost_maps: CostMaps, to: Approach) -> list[tuple[SubgoalKind, Viewpoint]]:
    """Return looks at what was never seen (explore), at what bounds the floor (settle), and at floor beyond (pass)."""
    reachable = one_move_squares(cost_maps, SubgoalKind.EXPLORE) if to.take else None
    views = [] if reachable is None else frontiers.best_views(cost_maps, reachable, MOVE_COST, SQUARE_COST)
    for apart in (frontiers.VIEW_SPACING, 0):
        explore = [*views, *frontiers.find_frontiers(cost_maps, apart)]
        settle = frontiers.unsettled_boundaries(cost_maps, apart)
        if explore or settle:
            break
    kinds = {
        SubgoalKind.EXPLORE: explore,
        SubgoalKind.SETTLE: settle,
        SubgoalKind.PASS: frontiers.unreached_rooms(cost_maps),
    }
    return [(kind, look) for kind, looks in kinds.items() for look in looks]


def _chance_of_look(kind: SubgoalKind, gain: float) -> float:
    """Return how often looks of a kind that show `gain` squares never seen showed what no look had shown, 0 to 1."""
    counted = encoding_facts(PRIORS_OF_LOOKS, "counted_look", 4)
    return next(
        int(w) / 1000 for case, least, most, w in counted if case == kind and int(least) <= int(gain) <= int(most)
    )


def _object_heat(situation: Situation, reconciled: Reconciliation, unseen: float) -> Floats | None:
    """Return the probability that a square belongs to the shape looked for; None when no shape is told."""
    wanted = sorted(
        (str(claim.fact.args[1]), str(claim.fact.args[0]))
        for claim in situation.task.claims
        if claim.fact.name == "shape" and str(claim.fact.args[0]) in reconciled.hypothesised
    )
    if not wanted:
        return None
    (shape, x), model = wanted[0], situation.model
    likely = unseen * model.likely(shape)
    for node in model.objects:
        likely[model.mask(node.patch)] = situation.may_be.get(x, {}).get(node.name, 0) / 100
    return likely


def _is_surely_reached(subgoal: Subgoal, cost_maps: CostMaps) -> bool:
    """Return whether some square of a subgoal can be reached over squares that are surely free (certainty level 0)."""
    reached = cost_maps.nearest(subgoal.squares)
    return reached is not None and reached.level == 0
