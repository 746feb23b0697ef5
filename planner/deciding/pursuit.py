"""Pursuit: the best of some subgoals, the route there, and the next move on it.

A route is kept while it holds: its subgoal is still wanted, and the squares ahead are still believed free.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from math import inf
from typing import NamedTuple

import numpy as np

from utak.geometry.kernels.arrays import XY, Square
from utak.geometry.raster.geodesic import GEODESIC_UNREACHED
from utak.kb.body import Command, Release
from utak.kb.language.goal_words import ROBOT
from utak.kb.world.model import WorldModel
from utak.planner.decision import Decision, TaskVerdict, impossible
from utak.planner.goals.bounds import telling_squares
from utak.planner.navigation.fewest_moves import MOVE_COST, FewestMoves
from utak.planner.navigation.loop_guard import LoopGuard
from utak.planner.navigation.sticky_route import StickyRoute, to_map_squares
from utak.planner.navigation.subgoals import NoSubgoal, Subgoal, choose
from utak.planner.navigation.walks import (
    WALK_PREDICATES,
    NoWalk,
    PlannedRoute,
    WalkChoice,
    WalkRules,
    Walks,
    choose_walk,
    find_walks,
    walks_along,
)
from utak.planner.screen.moves import CARRYING_PACE, WALKING_PACE, next_move
from utak.planner.screen.projection import SquareIndices
from utak.planner.sights.frontiers import VIEW_SPACING
from utak.planner.situation import Situation
from utak.planner.stages import ORIGIN_GOALS, Stage
from utak.planner.steps import are_ruled, forbidden_by, refusal, towards
from utak.planner.subgoal_kind import SubgoalKind


class RefusedEnd(NamedTuple):
    """The end of a walk that users' rules refuse."""

    what: str  # the reason for the walk, in words
    end: Square  # (column, row) on the arrays of the view
    why: str  # the rules, in words


class Pursuer:
    """Walks after subgoals, and remembers the present route and the commands that led back to the same state."""

    def __init__(self, paths: str) -> None:
        """Make a pursuer that has no route yet."""
        self._paths = paths
        self._kept = StickyRoute()
        self._circles = LoopGuard()

    def closes_loop(self, model: WorldModel, command: Command) -> bool:
        """Record a command that is about to be given, and return whether it was given before in the same state."""
        return self._circles.noticed(model, command)

    def pursue(
        self,
        subgoals: Sequence[Subgoal],
        stage: Stage,
        situation: Situation,
        missing: Callable[[], str],
        proof: Sequence[str] = (),
        along: Callable[[Subgoal], Decision] | None = None,
    ) -> Decision:
        """Return the next command towards the best of some subgoals, or the verdict when none can be reached."""
        model = situation.model
        rests = any(goal.name in ORIGIN_GOALS for goal in stage.carried)
        telling = telling_squares(situation) if rests else None
        fewest = FewestMoves(situation.cost_maps, telling) if stage.carried else None
        ways_by_price = by_dearest_door(situation)
        ruled, refused = are_ruled(situation), list[RefusedEnd]()
        while True:
            offered = [_priced(one, ways_by_price)[0] for one in self._circles.told(subgoals, model)]
            if fewest is not None:
                offered = fewest.priced(offered)
            if refused:
                offered = [one for one in (_without(one, refused, model) for one in offered) if len(one.squares)]
            last, question = self._kept.subgoal(model), situation.question
            chosen = choose(offered, situation.cost_maps, last, question, situation.rooms)
            if isinstance(chosen, NoSubgoal):
                missed, circled = missing(), any(one.in_vain for one in offered) and not refused
                whys = [one.why for one in refused]
                whys += [forbidden_by(chosen.rules, "every place to go to")] * bool(chosen.rules)
                if whys:
                    missed, proof = f"{missed}, and {' and '.join(dict.fromkeys(whys))}", ()
                return _given_up(stage, missed, proof, in_circles=circled)
            subgoal, question = chosen
            if along is not None and (taken := along(subgoal)):
                return taken
            if model.held is not None:
                return Decision(Release(), f"{model.held} is released, because the robot must walk; {stage}")
            _, within = _priced(subgoal, ways_by_price)
            ways = fewest if fewest is None or within is situation else FewestMoves(within.cost_maps, telling)
            decision = self._walk(subgoal, stage, replace(within, question=question), ways)
            if isinstance(decision, RefusedEnd):
                refused.append(decision)
                continue
            if ruled and (why := refusal(decision.steps, situation, decision.question)):
                refused.append(RefusedEnd(subgoal.what, self._kept.path(model)[-1], why))
                continue
            if decision.command is None or not self._circles.noticed(model, decision.command):
                return decision
            self._circles.give_up(subgoal, model)

    def _walk(
        self, subgoal: Subgoal, stage: Stage, situation: Situation, fewest: FewestMoves | None
    ) -> Decision | RefusedEnd:
        """Return the next command towards a subgoal, and remember the route; or how users' rules forbid every way."""
        model, cost_maps = situation.model, situation.cost_maps
        reached = cost_maps.nearest(subgoal.squares)
        assert reached is not None
        straight = None if fewest is None or _speaks_of_links(situation) else fewest.way(subgoal)
        walked = None if straight is None else self.choose_route([straight], situation)
        walked = walked or self._route_left(subgoal, reached.level, situation)
        walk = walked or self._choose(find_walks(cost_maps, reached.level, subgoal.squares, self._paths), situation)
        if isinstance(walk, NoWalk) and walk.rules:
            there = cost_maps.nearest_at(reached.level, subgoal.squares)
            return RefusedEnd(subgoal.what, there, forbidden_by(walk.rules, "every way there"))
        if isinstance(walk, NoWalk):
            why = f"{stage} cannot be attained: every route there leads through a forbidden door"
            return impossible(why, "every route there leads through a forbidden door")
        route, question = walk
        self.keep_route(route, model, subgoal.squares)
        kind = subgoal.kind if straight is not None or reached.level == 0 else SubgoalKind.PASS
        pace = WALKING_PACE if fewest is None else CARRYING_PACE
        move = next_move(cost_maps, route.squares, route.level, kind, pace)
        steps = towards(subgoal.kind, end_of(route, model), model)
        return Decision(move, f"{subgoal.what}; {stage}", steps=steps, question=question)

    def _route_left(self, subgoal: Subgoal, level: int, situation: Situation) -> WalkChoice | None:
        """Return what is left of the present route, if it leads to a subgoal and through no forbidden door."""
        if _speaks_of_links(situation):  # which the rest of a route does not name
            return None
        rest = self._kept.rest(subgoal, level, situation.model, situation.cost_maps)
        if rest is None or not situation.shut(ROBOT):
            return None if rest is None else WalkChoice(rest, situation.question)
        return self.choose_route([rest], situation)

    def keep_route(self, route: PlannedRoute, model: WorldModel, towards: SquareIndices | None = None) -> None:
        """Remember the present route."""
        self._kept.keep(route, frozenset() if towards is None else to_map_squares(towards, model), model)

    def choose_route(self, offered: Sequence[PlannedRoute], situation: Situation) -> WalkChoice | None:
        """Return which of some routes is chosen; None when all are forbidden."""
        walk = self._choose(walks_along(offered), situation) if offered else None
        return None if isinstance(walk, NoWalk) else walk

    def _choose(self, walks: Walks, situation: Situation) -> WalkChoice | NoWalk:
        """Return the walk that is chosen."""
        before = frozenset(self._kept.path(situation.model))
        forbidden = frozenset(door.name for door in situation.shut(ROBOT))
        prices = {name: MOVE_COST * commands for name, commands in situation.door_prices.items()}
        rules = WalkRules(forbidden, prices)
        if _speaks_of_links(situation):
            rules = rules._replace(ruled=True, track=situation.track, rooms=situation.rooms)
        return choose_walk(walks, situation.cost_maps, before, situation.doors, rules, situation.question)


def _speaks_of_links(situation: Situation) -> bool:
    """Return whether users' rules speak of the links of walks."""
    return situation.question.speaks_of(WALK_PREDICATES)


def end_of(route: PlannedRoute, model: WorldModel) -> XY:
    """Return the middle of the last square of a route, (x, y) in squares, map frame."""
    column, row = route.squares[-1]
    return column + model.view.west + 0.5, row + model.view.south + 0.5


def by_dearest_door(situation: Situation) -> list[tuple[int, Situation]]:
    """Return for each price of a pass, from 0 on, the situation in which all doors are shut that rules price higher."""
    *lower, highest = sorted({0, *situation.door_prices.values()})
    dearer = ([door for door in situation.doors if situation.door_prices.get(door.name, 0) > price] for price in lower)
    return [*zip(lower, map(situation.within_shut_doors, dearer), strict=True), (highest, situation)]


def _priced(subgoal: Subgoal, ways: Sequence[tuple[int, Situation]]) -> tuple[Subgoal, Situation]:
    """Return a subgoal with what its way costs by the prices of doors, and the situation in which that way leads."""
    *_, (_, situation) = ways
    through = None if len(ways) == 1 else situation.cost_maps.nearest(subgoal.squares)
    if through is None:
        return subgoal, situation
    reached = [(price, within, within.cost_maps.nearest(subgoal.squares)) for price, within in ways]
    more = [inf if end is None else MOVE_COST * price + max(0.0, end.cost - through.cost) for price, _, end in reached]
    _, within, nearest = reached[more.index(min(more))]
    squares = subgoal.squares
    if within is not situation and nearest is not None:
        squares = squares[within.cost_maps.distances[nearest.level].ravel()[squares] != GEODESIC_UNREACHED]
    return subgoal._replace(squares=squares, price=subgoal.price + min(more)), within


def _without(subgoal: Subgoal, refused: Sequence[RefusedEnd], model: WorldModel) -> Subgoal:
    """Return a subgoal without the squares near to those at which users' rules refuse it."""
    rows, columns = np.unravel_index(subgoal.squares, model.labels.shape)
    far = np.ones(len(subgoal.squares), np.bool_)
    for one in refused:
        column, row = one.end
        if one.what == subgoal.what:
            far &= np.maximum(abs(rows - row), abs(columns - column)) > VIEW_SPACING
    return subgoal._replace(squares=subgoal.squares[far])


def _given_up(stage: Stage, missing: str, proof: Sequence[str], in_circles: bool) -> Decision:
    """Return the verdict when no subgoal can be reached."""
    vain = "what is left to look at was tried from the same place, knowing the same, and in vain"
    end = vain if in_circles else "nothing is left to look at"
    why = f"{stage} cannot be attained: {missing}, and {end}"
    return impossible(why, *proof) if proof and not in_circles else Decision(None, why, TaskVerdict.LIMIT)
