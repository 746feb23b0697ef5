"""What is worth doing: to go where a goal holds, or, while that is not known, to look where what is missing may be."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kb.mapping.object_heat import seen_in_part
from kb.task.binding import Reconciled
from kb.world.model import Node, WorldModel
from kb.world.rooms import rooms_of
from planner.goals.robot_goals import Destination
from planner.navigation.fewest_moves import MOVE, WAY
from planner.navigation.subgoals import Subgoal
from planner.screen.moves import one_move
from planner.screen.projection import CostMaps, Squares, grown
from planner.sights import frontiers
from planner.sights.viewpoints import TAKE, Approach, inspection, sightings
from planner.situation import Situation

ODD = -10.0  # squares: how much rather what no straight wall explains is looked at
ODDLY, HARDLY, PERHAPS = 4, 2, 20  # percent that odd squares, likely walls, floor beyond hold what is missing
ANY_SHAPE = 0.4  # that a thing is the one looked for, when nothing is said of its shape
FROM_AFAR = 0.7  # how much less a look promises that shows a thing, beside one that ends right before it
LEAST = 3  # percent likewise, of whatever is not known to be another
Heat = NDArray[np.float64]


class Candidate(NamedTuple):
    """Something seen that may be what is looked for: the squares (flat indices) where it lies, and a look at it."""

    squares: Squares
    subgoal: Subgoal


def aims_towards(
    where: Sequence[Destination], situation: Situation, reconciled: Reconciled, to: Approach = TAKE
) -> list[Subgoal]:
    """What is worth doing: go there, when it is known where; else look, first where just the missing thing may be.

    to : what he goes up to the missing thing for.
    """
    cost_maps = situation.cost_maps
    missing = [d for d in where if d.missing]
    if not missing:
        squares: Squares = where[0].squares
        for other in where[1:]:
            squares = np.intersect1d(squares, other.squares)
        return [Subgoal("attain", squares, "the way to the goal is known")]
    likely = _likely(situation, reconciled)
    things = _things(situation, reconciled, likely, to)
    subgoals = [Subgoal("explore", *look) for d in missing for look in d.viewpoints]
    if any(_surely_reached(subgoal, cost_maps) for subgoal in subgoals):
        return [*subgoals, *(thing.subgoal for thing in things)]
    places = [] if likely is None else _places(cost_maps, likely, to)
    subgoals += [candidate.subgoal for candidate in (*things, *places)]
    return [*subgoals, *_beyond_all(cost_maps, none_of([*things, *places]), to)]


def against_walls(situation: Situation) -> list[Subgoal]:
    """What may be things that stand against a wall: where each can be felt."""
    looks = [frontiers.against_the_wall(situation.cost_maps, mask) for mask in situation.model.protruding]
    return [Subgoal("inspect", *look) for look in looks if len(look.squares)]


def perhaps_islands(situation: Situation) -> list[Subgoal]:
    """What stands free, and would make more doors were it a piece of wall: where each can be felt."""
    model = situation.model
    subgoals = []
    for node in model.objects:
        if node.colour is None and not node.moved:
            rooms = rooms_of(model, situation.rules, model.verge | model.mask(node.patch))
            if len(rooms.doors) > len(situation.rooms.doors):
                look = frontiers.by_touch(situation.cost_maps, node)
                subgoals += [Subgoal("inspect", *look)] if len(look.squares) else []
    return subgoals


def _things(situation: Situation, reconciled: Reconciled, likely: Heat | None, to: Approach) -> list[Candidate]:
    """The objects of the world model that may be what is looked for. likely : as for approaching.sightings."""
    cost_maps, model = situation.cost_maps, situation.model
    found = []
    for x, name in reconciled.doubtful:
        node = model.object(name)
        if node is None or x not in reconciled.hypothesised:
            continue
        chance = ANY_SHAPE if likely is None else _chance(node, likely, model)
        look = inspection(cost_maps, node, chance, to) if node.open else frontiers.by_touch(cost_maps, node)
        what = f"{look.what}: it may be {x}"
        squares = np.flatnonzero(model.mask(node.patch))
        found.append(Candidate(squares, Subgoal("inspect", look.squares, what, max(LEAST, round(100 * chance)))))
    return [candidate for candidate in found if len(candidate.subgoal.squares)]


def _chance(node: Node, likely: Heat, model: WorldModel) -> float:
    """How likely an object is what is looked for: as pictures show it, or as one of which a part is seen."""
    mask = model.mask(node.patch)
    shown = float(likely[mask].max())
    cut = (grown(mask, 1) & ~model.view.seen).any()
    return max(shown, float(seen_in_part(mask.sum()))) if cut else shown


def _places(cost_maps: CostMaps, likely: Heat, to: Approach) -> list[Candidate]:
    """Where pictures of what is not settled show what is looked for."""
    seen = sightings(cost_maps, likely, "something may be meant there", to)
    return [Candidate(squares, Subgoal("inspect", *look)) for squares, look in seen]


def none_of(candidates: Sequence[Candidate]) -> float:
    """How likely it is none of all that was seen. Of those that share squares the first alone counts."""
    none, counted = 1.0, np.zeros(0, np.int64)
    for squares, subgoal in candidates:
        if not np.isin(squares, counted).any():
            none *= 1 - subgoal.chance / 100
        counted = np.union1d(counted, squares)
    return none


def _beyond_all(cost_maps: CostMaps, unseen: float, to: Approach) -> list[Subgoal]:
    """Looks at what was never seen, and at what bounds the floor.

    unseen : that what is missing was not seen yet. to : as for `aims_towards`. Who is to carry what he finds counts
    moves: he looks from where most comes into sight, and must set out once more to what he sees from there.
    """
    views = frontiers.best_views(cost_maps, one_move(cost_maps, "explore"), MOVE, WAY) if to.take else []
    promise = unseen * (FROM_AFAR if to.take else 1.0)
    for apart in (frontiers.APART, 0):
        borders = [*views, *frontiers.promised(cost_maps, frontiers.frontiers(cost_maps, apart))]
        explored = [Subgoal("explore", *look)._replace(chance=max(1, round(look.chance * promise))) for look in borders]
        odd, plain = (frontiers.vague_places(cost_maps, apart, odd=odd) for odd in (True, False))
        settled = [Subgoal("settle", *look, price=ODD)._replace(chance=ODDLY) for look in odd]
        settled += [Subgoal("settle", *look)._replace(chance=HARDLY) for look in plain]
        if explored or settled:
            break
    passages = [Subgoal("pass", *look)._replace(chance=PERHAPS) for look in frontiers.rooms_beyond(cost_maps)]
    return [*explored, *settled, *passages]


def _likely(situation: Situation, reconciled: Reconciled) -> Heat | None:
    """(rows, columns): how likely each square belongs to a thing that is looked for; None when nothing is."""
    wanted = sorted(
        str(claim.fact.args[1])
        for claim in situation.task.claims
        if claim.fact.name == "shape" and str(claim.fact.args[0]) in reconciled.hypothesised
    )
    if not wanted:
        return None
    return situation.model.imagined.likely(wanted[0])


def _surely_reached(subgoal: Subgoal, cost_maps: CostMaps) -> bool:
    reached = cost_maps.nearest(subgoal.squares)
    return reached is not None and reached.level == 0
