"""Pursuit: the best of some subgoals, the route there, and the next move on it.

A route is kept while it holds: its subgoal is still wanted, and the squares ahead are still believed free.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

from utak.geometry.raster.geodesic import GEODESIC_UNREACHED
from utak.kb.body import Command, Release
from utak.kb.language.vocabulary import ROBOT
from utak.kb.world.model import WorldModel
from utak.planner.advice import Go, See
from utak.planner.carrying.plan_executor import Advice
from utak.planner.deciding.search import contact_subgoals
from utak.planner.decision import Decision, TaskVerdict, impossible, with_command
from utak.planner.goals.bounds import telling_squares
from utak.planner.navigation.fewest_moves import MOVE_COST, FewestMoves
from utak.planner.navigation.loop_guard import LoopGuard
from utak.planner.navigation.routes import PlannedRoute, choose_route, find_routes
from utak.planner.navigation.sticky_route import StickyRoute, to_map_squares
from utak.planner.navigation.subgoals import Subgoal, choose
from utak.planner.screen.moves import CARRYING_PACE, WALKING_PACE, halt_exactly_at, next_move
from utak.planner.screen.projection import SquareIndices
from utak.planner.situation import Situation
from utak.planner.stages import ORIGIN_GOALS, Stage
from utak.planner.subgoal_kind import SubgoalKind


class Pursuer:
    """Walks after subgoals, and remembers the present route and the commands that led round in circles."""

    def __init__(
        self,
        paths: str,
        contacts: Callable[[Situation], Sequence[Subgoal]] = contact_subgoals,
        circles: LoopGuard | None = None,
    ) -> None:
        """Make a pursuer that has no route yet."""
        self._paths = paths
        self._contacts = contacts
        self._kept = StickyRoute()
        self._circles = circles or LoopGuard()
        self._feeling = False  # whether the robot is about to feel what may stand against a wall

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
        along: Callable[[Subgoal], Decision | None] | None = None,
    ) -> Decision:
        """Return the next command towards the best of some subgoals, or the verdict when none can be reached."""
        # None when no object is to be taken along.
        model = situation.model
        rests = any(goal.name in ORIGIN_GOALS for goal in stage.carried)
        telling = telling_squares(situation) if rests else None
        fewest = FewestMoves(situation.cost_maps, telling) if stage.carried else None
        round_doors = without_priced_doors(situation)
        while True:
            offered = [_priced(one, situation, round_doors)[0] for one in self._circles.priced(subgoals, model)]
            if fewest is not None:
                offered = fewest.priced(offered)
            subgoal = choose(offered, situation.cost_maps, self._kept.subgoal(model))
            if subgoal is None:
                return _given_up(stage, missing(), proof, in_circles=len(offered) < len(subgoals))
            taken = None if along is None else along(subgoal)
            if taken is not None:
                return taken
            if model.held is not None:
                return Decision(Release(), f"{model.held} is released, because the robot must walk; {stage}")
            _, within = _priced(subgoal, situation, round_doors)
            ways = fewest if fewest is None or within is situation else FewestMoves(within.cost_maps, telling)
            decision = self._walk(subgoal, stage, within, ways)
            if decision.command is None or not self._circles.noticed(model, decision.command):
                return decision
            self._circles.tire(to_map_squares(subgoal.squares, model))

    def pursue_look(self, look: Subgoal | None, stage: Stage, situation: Situation) -> Decision | None:
        """Return the next command towards a look, or the verdict `limit` when no way leads there; None for no look."""
        # None when nothing is to be looked at.
        if look is None:
            return None
        return self.pursue([look], stage, situation, lambda: look.what)

    def go(self, go: Go, stage: Stage, situation: Situation) -> Decision:
        """Return the next command to a square where an object is grasped, so that the last move halts at its place."""
        subgoal = Subgoal(SubgoalKind.ATTAIN, go.square, go.why)
        walk = self.pursue([subgoal], stage, situation, lambda: "no way leads there")
        return replace(walk, command=halt_exactly_at(walk.command, go.place, situation.model))

    def prepare(self, advice: Advice, stage: Stage, situation: Situation) -> Decision | None:
        """Return the next command to where an object is grasped, or to see what must be seen first."""
        # Returns None when the advice is neither (an Act or an Infeasibility), or cannot be followed: never a verdict.
        # For a Go the way to the square, so that the last move halts at its place; for a See the way to one of its
        # squares.
        walk: Decision | None = None
        if isinstance(advice, Go):
            walk = self.go(advice, stage, situation)
        elif isinstance(advice, See):
            walk = self.pursue_look(Subgoal(SubgoalKind.INSPECT, *advice.viewpoint), stage, situation)
        return with_command(walk)

    def feel_before_verdict(self, ask: Callable[[], Decision], stage: Stage, situation: Situation) -> Decision:
        """Return what is decided; before a verdict, feel what may be an object against a wall, or part of a wall."""
        decision = None if self._feeling else ask()
        if decision is None or decision.verdict:
            subgoals = self._contacts(situation)
            felt = [self.pursue(subgoals, stage, situation, lambda: "")] if subgoals else []
            self._feeling = any(not instead.verdict for instead in felt)
            return felt[0] if self._feeling else decision or ask()
        return decision

    def _walk(self, subgoal: Subgoal, stage: Stage, situation: Situation, fewest: FewestMoves | None) -> Decision:
        """Return the next command towards a subgoal, and remember the route."""
        # None for short routes.
        model, cost_maps = situation.model, situation.cost_maps
        reached = cost_maps.nearest(subgoal.squares)
        assert reached is not None
        straight = None if fewest is None else fewest.way(subgoal)
        route = None if straight is None else self.choose_route([straight], situation)
        route = route or self._route_left(subgoal, reached.level, situation)
        route = route or self.choose_route(
            find_routes(cost_maps, reached.level, subgoal.squares, self._paths), situation
        )
        if route is None:
            why = f"{stage} cannot be attained: every route there leads through a forbidden door"
            return impossible(why, "every route there leads through a forbidden door")
        self.keep_route(route, model, subgoal.squares)
        kind = subgoal.kind if straight is not None or reached.level == 0 else SubgoalKind.PASS
        pace = WALKING_PACE if fewest is None else CARRYING_PACE
        move = next_move(cost_maps, route.squares, route.level, kind, pace)
        return Decision(move, f"{subgoal.what}; {stage}")

    def _route_left(self, subgoal: Subgoal, level: int, situation: Situation) -> PlannedRoute | None:
        """Return what is left of the present route, if it leads to a subgoal and through no forbidden door."""
        # Else None.
        rest = self._kept.rest(subgoal, level, situation.model, situation.cost_maps)
        return self.choose_route([rest], situation) if rest is not None and situation.shut(ROBOT) else rest

    def keep_route(self, route: PlannedRoute, model: WorldModel, towards: SquareIndices | None = None) -> None:
        """Remember the present route."""
        self._kept.keep(route, frozenset() if towards is None else to_map_squares(towards, model), model)

    def choose_route(self, offered: Sequence[PlannedRoute], situation: Situation) -> PlannedRoute | None:
        """Return the route that planner/asp/routes.lp chooses; None when all lead through forbidden doors."""
        if not offered:
            return None
        before = frozenset(self._kept.path(situation.model))
        forbidden = frozenset(door.name for door in situation.shut(ROBOT))
        prices = {name: MOVE_COST * commands for name, commands in situation.door_prices.items()}
        return choose_route(offered, situation.cost_maps, before, situation.doors, forbidden, prices)


def without_priced_doors(situation: Situation) -> Situation:
    """Return the situation in which the doors that users' rules price are shut; the same one where there are none."""
    priced = [door for door in situation.doors if door.name in situation.door_prices]
    return situation.within_shut_doors(priced) if priced else situation


def _priced(subgoal: Subgoal, situation: Situation, within: Situation) -> tuple[Subgoal, Situation]:
    """Return a subgoal with what its way costs by the prices of doors, and the situation in which that way leads."""
    through = None if within is situation else situation.cost_maps.nearest(subgoal.squares)
    if through is None:
        return subgoal, situation
    most = MOVE_COST * min(situation.door_prices.values())
    otherwise = within.cost_maps.nearest(subgoal.squares)
    if otherwise is None or otherwise.cost - through.cost > most:
        return subgoal._replace(price=subgoal.price + most), situation
    reached = within.cost_maps.distances[otherwise.level].ravel()[subgoal.squares] != GEODESIC_UNREACHED
    price = subgoal.price + max(0.0, otherwise.cost - through.cost)
    return subgoal._replace(squares=subgoal.squares[reached], price=price), within


def _given_up(stage: Stage, missing: str, proof: Sequence[str], in_circles: bool) -> Decision:
    """Return the verdict when no subgoal can be reached."""
    end = "the robot goes round in circles" if in_circles else "nothing is left to look at"
    why = f"{stage} cannot be attained: {missing}, and {end}"
    return impossible(why, *proof) if proof and not in_circles else Decision(None, why, TaskVerdict.LIMIT)
