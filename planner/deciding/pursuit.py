"""Going after what is wanted: the best of some aims, the way there, and the next move on it.

A way is kept while it holds: its aim is still wanted, and the squares ahead are still believed free.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

from kb.body import Command, Release
from kb.world.model import WorldModel
from planner.advice import Go, See
from planner.carrying.plan_executor import Advice
from planner.deciding.search import against_walls, perhaps_islands
from planner.decision import Decision
from planner.navigation.fewest_moves import FewestMoves
from planner.navigation.loop_guard import LoopGuard
from planner.navigation.routes import PlannedRoute, choose_way, ways
from planner.navigation.sticky_route import StickyRoute, lattice_squares
from planner.navigation.subgoals import Subgoal, choose
from planner.screen.moves import HURRY, STROLL, halting, next_move
from planner.screen.projection import Squares
from planner.situation import Situation
from planner.stages import Stage


class Pursuer:
    """Walks after aims, and remembers the way that he is on and the commands that led round in circles.

    paths : how the ways are found that are chosen among (as of planner.navigation.routes).
    """

    def __init__(self, paths: str) -> None:
        self._paths = paths
        self._kept = StickyRoute()
        self._circles = LoopGuard()
        self._feeling = False  # is he about to feel what may stand against a wall?

    def noticed(self, model: WorldModel, command: Command) -> bool:
        """Does a command lead round in circles? Asked of each that is about to be given."""
        return self._circles.noticed(model, command)

    def pursue(
        self,
        subgoals: Sequence[Subgoal],
        stage: Stage,
        situation: Situation,
        missing: Callable[[], str],
        verdict: str = "impossible",
        along: Callable[[Subgoal], Decision | None] | None = None,
    ) -> Decision:
        """The next command towards the best of some aims, or the verdict when none can be reached.

        missing : says in words what is missing; asked only for a verdict. along : how he takes something along there,
        if he can.
        """
        model = situation.model
        fewest = FewestMoves(situation.cost_maps) if stage.carried else None
        while True:
            offered = self._circles.priced(subgoals, model)
            if fewest is not None:
                offered = fewest.priced(offered)
            subgoal = choose(offered, situation.cost_maps, self._kept.subgoal(model))
            if subgoal is None:
                circles = len(offered) < len(subgoals)
                end = "he goes round in circles" if circles else "nothing is left to look at"
                return Decision(
                    None, f"{stage} cannot be attained: {missing()}, and {end}", "limit" if circles else verdict
                )
            taken = None if along is None else along(subgoal)
            if taken is not None:
                return taken
            if model.held is not None:
                return Decision(Release(), f"{model.held} is let go, to walk; {stage}")
            decision = self._walk(subgoal, stage, situation, fewest)
            if decision.command is None or not self._circles.noticed(model, decision.command):
                return decision
            self._circles.tire(lattice_squares(subgoal.squares, model))

    def look(self, subgoal: Subgoal | None, stage: Stage, situation: Situation) -> Decision | None:
        """The next command towards what he wants to make sure of, if there is anything."""
        return None if subgoal is None else self.pursue([subgoal], stage, situation, lambda: subgoal.what, "limit")

    def go(self, go: Go, stage: Stage, situation: Situation) -> Decision:
        """The next command on the way to where something is taken, to halt right there."""
        walk = self.pursue([Subgoal("attain", go.square, go.why)], stage, situation, lambda: "no way leads there")
        return replace(walk, command=halting(walk.command, go.place, situation.model))

    def prepared(self, advice: Advice, stage: Stage, situation: Situation) -> Decision | None:
        """The next command to come to where something is taken, or to see what must be seen before that; or None."""
        if isinstance(advice, Go):
            walk: Decision | None = self.go(advice, stage, situation)
        else:
            walk = (
                self.look(Subgoal("inspect", *advice.viewpoint), stage, situation) if isinstance(advice, See) else None
            )
        return None if walk is None or walk.command is None else walk

    def felt(self, ask: Callable[[], Decision], stage: Stage, situation: Situation) -> Decision:
        """What is decided; rather than give up, to feel what may be a thing that stands against a wall, or a wall.

        What was begun is gone on with: on the way there, too, something else may come to be worth a look.
        """
        decision = None if self._feeling else ask()
        if decision is None or decision.verdict:
            subgoals = against_walls(situation) or perhaps_islands(situation)
            felt = [self.pursue(subgoals, stage, situation, lambda: "")] if subgoals else []
            self._feeling = any(not instead.verdict for instead in felt)
            return felt[0] if self._feeling else decision or ask()
        return decision

    def _walk(self, subgoal: Subgoal, stage: Stage, situation: Situation, fewest: FewestMoves | None) -> Decision:
        """The next command towards an aim. fewest : by the fewest moves where that is wanted."""
        model, cost_maps = situation.model, situation.cost_maps
        reached = cost_maps.nearest(subgoal.squares)
        assert reached is not None
        straight = None if fewest is None else fewest.way(subgoal)
        way = None if straight is None else self.choose([straight], situation)
        way = way or self._rest(subgoal, reached.level, situation)
        way = way or self.choose(ways(cost_maps, reached.level, subgoal.squares, self._paths), situation)
        if way is None:
            return Decision(None, f"{stage} cannot be attained: every way there is forbidden", "impossible")
        self.keep(way, model, subgoal.squares)
        kind = subgoal.kind if straight is not None or reached.level == 0 else "pass"
        move = next_move(cost_maps, way.squares, kind, pace=STROLL if fewest is None else HURRY)
        return Decision(move, f"{subgoal.what}; {stage}")

    def _rest(self, subgoal: Subgoal, level: int, situation: Situation) -> PlannedRoute | None:
        """Return what is left of the way that he is on, if it leads to an aim and through no forbidden door."""
        rest = self._kept.rest(subgoal, level, situation.model, situation.cost_maps)
        return self.choose([rest], situation) if rest is not None and situation.forbidden("utak") else rest

    def keep(self, way: PlannedRoute, model: WorldModel, towards: Squares | None = None) -> None:
        """Remember the way that he is on. towards : flat indices of the squares aimed at; None when none is."""
        self._kept.keep(way, frozenset() if towards is None else lattice_squares(towards, model), model)

    def choose(self, offered: Sequence[PlannedRoute], situation: Situation) -> PlannedRoute | None:
        """The way that planner/asp/routes.lp chooses of some, and not through a door that is forbidden; or None."""
        if not offered:
            return None
        before = frozenset(self._kept.path(situation.model))
        forbidden = frozenset(door.name for door in situation.forbidden("utak"))
        return choose_way(offered, situation.cost_maps, before, situation.rooms.doors, forbidden)
