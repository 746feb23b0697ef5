"""Subgoals: go where a goal holds; while that is not known, look where what is missing may be."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from utak.geometry.kernels.arrays import Floats
from utak.kb.mapping.object_heat import chance_by_seen_squares
from utak.kb.task.binding import Reconciliation
from utak.kb.world.model import Node, WorldModel
from utak.kb.world.rooms import rooms_of
from utak.planner.goals.robot_goals import Destination
from utak.planner.navigation.fewest_moves import MOVE_COST, SQUARE_COST
from utak.planner.navigation.subgoals import Subgoal
from utak.planner.screen.moves import one_move_squares
from utak.planner.screen.projection import CostMaps, SquareIndices, dilate
from utak.planner.sights import frontiers
from utak.planner.sights.viewpoints import MOST_LIKELY, TO_TAKE, Approach, inspection, sightings
from utak.planner.situation import Situation
from utak.planner.subgoal_kind import SubgoalKind

# All values below were tuned on random worlds (benchmarks.campaign).
UNEXPLAINED_BONUS = -10.0  # squares: price of a look at a boundary that no straight wall explains
UNEXPLAINED_CHANCE = 4  # percent that such a boundary hides what is missing
LIKELY_WALL_CHANCE = 2  # percent that a boundary that is likely wall hides it
PASSAGE_CHANCE = 20  # percent that floor seen beyond an unknown passage holds it
ANY_SHAPE_CHANCE = 0.4  # probability that an object is the one looked for, when its shape is not told
DISTANT_LOOK_SHARE = 0.7  # of the promise of a look that ends right before an object, that of one from afar
MIN_OBJECT_CHANCE = 3  # percent, of every object that is not known to be another one


class Candidate(NamedTuple):
    """Something seen that may be what is looked for."""

    # The flat indices (row * columns + column) on the arrays of the view of the squares where it lies, (n,)
    squares: SquareIndices
    subgoal: Subgoal  # a look at it; its chance is the percent of belief that it is what is looked for


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
    likely = _object_heat(situation, reconciled)
    things = _doubtful_objects(situation, reconciled, likely, to)
    subgoals = [Subgoal(SubgoalKind.EXPLORE, *look) for d in missing for look in d.viewpoints]
    if any(_is_surely_reached(subgoal, cost_maps) for subgoal in subgoals):
        return [*subgoals, *(thing.subgoal for thing in things)]
    places = [] if likely is None else _likely_places(cost_maps, likely, to)
    subgoals += [candidate.subgoal for candidate in (*things, *places)]
    return [*subgoals, *_looks_at_the_unseen(cost_maps, chance_of_none([*things, *places]), to)]


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


def chance_of_none(candidates: Sequence[Candidate]) -> float:
    """Return the probability, 0 to 1, that none of some candidates is what is looked for; 1 for no candidates."""
    none, counted = 1.0, np.zeros(0, np.int64)
    for squares, subgoal in candidates:
        if not np.isin(squares, counted).any():
            none *= 1 - subgoal.chance / 100
        counted = np.union1d(counted, squares)
    return none


def _doubtful_objects(
    situation: Situation, reconciled: Reconciliation, likely: Floats | None, to: Approach
) -> list[Candidate]:
    """Return the objects of the world model that may be what is looked for, each with a look at it or a touch of it."""
    cost_maps, model = situation.cost_maps, situation.model
    found = []
    for x, name in reconciled.doubtful:
        node = model.object(name)
        if node is None or x not in reconciled.hypothesised:
            continue
        chance = ANY_SHAPE_CHANCE if likely is None else _chance(node, likely, model)
        look = inspection(cost_maps, node, chance, to) if node.open else frontiers.touch_viewpoint(cost_maps, node)
        what = f"{look.what}: it may be {x}"
        squares = np.flatnonzero(model.mask(node.patch))
        percent = max(MIN_OBJECT_CHANCE, min(MOST_LIKELY, round(100 * chance)))
        found.append(Candidate(squares, Subgoal(SubgoalKind.INSPECT, look.squares, what, percent)))
    return [candidate for candidate in found if len(candidate.subgoal.squares)]


def _chance(node: Node, likely: Floats, model: WorldModel) -> float:
    """Return the probability, 0 to 1, that an object is what is looked for, by map completions."""
    mask = model.mask(node.patch)
    shown = float(likely[mask].max())
    cut = (dilate(mask, 1) & ~model.view.seen).any()
    return max(shown, float(chance_by_seen_squares(mask.sum()))) if cut else shown


def _likely_places(cost_maps: CostMaps, likely: Floats, to: Approach) -> list[Candidate]:
    """Return the places where map completions show what is looked for, with looks at them; [] for none."""
    seen = sightings(cost_maps, likely, "what is looked for may be there", to)
    return [Candidate(squares, Subgoal(SubgoalKind.INSPECT, *look)) for squares, look in seen]


def _looks_at_the_unseen(cost_maps: CostMaps, unseen: float, to: Approach) -> list[Subgoal]:
    """Return looks at what was never seen, and at what bounds the floor."""
    views = (
        frontiers.best_views(cost_maps, one_move_squares(cost_maps, SubgoalKind.EXPLORE), MOVE_COST, SQUARE_COST)
        if to.take
        else []
    )
    promise = unseen * (DISTANT_LOOK_SHARE if to.take else 1.0)
    for apart in (frontiers.VIEW_SPACING, 0):
        borders = [*views, *frontiers.with_chances(cost_maps, frontiers.find_frontiers(cost_maps, apart))]
        explored = [
            Subgoal(SubgoalKind.EXPLORE, *look)._replace(chance=max(1, round(look.chance * promise)))
            for look in borders
        ]
        odd, plain = (frontiers.unsettled_boundaries(cost_maps, apart, odd=odd) for odd in (True, False))
        settled = [
            Subgoal(SubgoalKind.SETTLE, *look, price=UNEXPLAINED_BONUS)._replace(chance=UNEXPLAINED_CHANCE)
            for look in odd
        ]
        settled += [Subgoal(SubgoalKind.SETTLE, *look)._replace(chance=LIKELY_WALL_CHANCE) for look in plain]
        if explored or settled:
            break
    beyond = frontiers.unreached_rooms(cost_maps)
    passages = [Subgoal(SubgoalKind.PASS, *look)._replace(chance=PASSAGE_CHANCE) for look in beyond]
    return [*explored, *settled, *passages]


def _object_heat(situation: Situation, reconciled: Reconciliation) -> Floats | None:
    """Return the probability that a square belongs to the shape looked for; None when no shape is told."""
    wanted = sorted(
        str(claim.fact.args[1])
        for claim in situation.task.claims
        if claim.fact.name == "shape" and str(claim.fact.args[0]) in reconciled.hypothesised
    )
    if not wanted:
        return None
    return situation.model.imagined.likely(wanted[0])


def _is_surely_reached(subgoal: Subgoal, cost_maps: CostMaps) -> bool:
    """Return whether some square of a subgoal can be reached over squares that are surely free (certainty level 0)."""
    reached = cost_maps.nearest(subgoal.squares)
    return reached is not None and reached.level == 0
