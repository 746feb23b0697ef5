"""What stands in Utak's own way and can be moved: navigation among movable obstacles (Stilman and Kuffner 2005).

Asked only when nothing else is left to do: who meant that it stays where it is will not find it there.
"""

from collections.abc import Iterator, Sequence
from itertools import product
from typing import NamedTuple

import numpy as np

from geometry.manipulation.goals import End
from geometry.manipulation.plan_carrying import At, Inside
from geometry.raster.geodesic import UNREACHED
from kb.language.terms import Fact
from kb.localisation.propose.larger_object import DEEPEST, SIDES
from kb.world.model import Node, WorldModel
from planner.advice import Act
from planner.carrying.plan_executor import PlanExecutor
from planner.deciding.pursuit import Pursuer
from planner.deciding.verification import Verifier
from planner.decision import Decision
from planner.goals.placement import LIKELY, SURELY, hidden_behind, leads_away, out_of_wall, region_of
from planner.navigation.routes import PlannedRoute, ways
from planner.navigation.subgoals import Subgoal
from planner.screen.projection import UNSEEN, CostMaps, Mask
from planner.sights.frontiers import by_touch
from planner.situation import Situation
from planner.stages import Stage

ASIDE = "aside"  # the target of what he moves out of his way


class Obstacle(NamedTuple):
    """A thing that shuts him off from somewhere. aside : where it shall lie to see, or so that his way is free."""

    node: Node
    aside: End


def obstacles(things: Sequence[Node], situation: Situation) -> Iterator[Obstacle]:
    """Which of some things shut him off from floor, known or not seen yet, that he would come to without them.

    The one with the shortest way first. Each alone, or where that does not help the first of several that stand behind
    each other; else what stands in a door, and goes on in what seems to be wall.
    """
    model = situation.model
    under = [model.mask(thing.patch) for thing in things]
    found = [(thing, way) for thing, mask in zip(things, under, strict=True) for way in _ways(mask, situation)]
    if not found and things:
        found = [(_first_on(way, things, model), way) for way in _ways(np.any(under, axis=0), situation)]
    for thing, way in sorted(found, key=lambda pair: pair[1].length):
        columns, rows = np.array(way.squares).T
        room = situation.cost_maps.free(0) | model.mask(thing.patch)
        room[rows, columns] = False
        yield Obstacle(thing, Inside(region_of(room)))
    for depth, thing in product(range(1, 1 + DEEPEST), things if not found else []):
        yield from _in_doors(thing, depth, situation)


def _ways(under: Mask, situation: Situation) -> list[PlannedRoute]:
    """The way to where he would come were some squares free, and cannot now; none where they shut off but a nook."""
    without, cost_maps = CostMaps(situation.model, under), situation.cost_maps
    beyond = (without.distances[UNSEEN] != UNREACHED) & (cost_maps.distances[UNSEEN] == UNREACHED) & ~under
    if not leads_away(beyond, under):
        return []
    return ways(without, UNSEEN, np.flatnonzero(beyond), "grid")


def _first_on(way: PlannedRoute, things: Sequence[Node], model: WorldModel) -> Node:
    """The first of some things that a way over their squares comes to."""
    masks = [(thing, model.mask(thing.patch)) for thing in things]
    return next(thing for column, row in way.squares for thing, mask in masks if mask[row, column])


def _in_doors(thing: Node, depth: int, situation: Situation) -> Iterator[Obstacle]:
    """A thing that was never moved, where it shuts him off if it goes on so deep in what seems to be wall.

    It is drawn out by so much and one square more, or as far as that is free: so it is seen whole.
    """
    model, mask = situation.model, situation.model.mask(thing.patch)
    for side in SIDES:
        behind = hidden_behind(thing, side, depth, model)
        pose = out_of_wall(thing, side, depth, situation) if behind.any() and _ways(mask | behind, situation) else None
        if pose is not None:
            yield Obstacle(thing, At(pose))


class ObstacleClearer:
    """Moves things out of Utak's way, and remembers which one he is moving, and what is to stay meanwhile."""

    def __init__(self, carrier: PlanExecutor, pursuer: Pursuer, verifier: Verifier) -> None:
        self._carrier, self._pursuer, self._verifier = carrier, pursuer, verifier
        self._moving = ""
        self._stays: frozenset[str] = frozenset()

    def going_on(self, stage: Stage, situation: Situation) -> Decision | None:
        """The next command for what he is moving aside; None when that is nothing, or it shuts him off no more."""
        node, held = situation.model.object(self._moving), situation.model.held
        if node is not None and held is None:
            instead = self._first_moved(self._movable(self._stays, situation), stage, situation, node.name)
            if instead is not None:
                return instead
        act = self._carrier.gone_on(node, situation) if node is not None and held == node.name else None
        if act is None or self._pursuer.noticed(situation.model, act.command):
            self._moving = ""
            return None
        return Decision(act.command, f"{act.why}; {stage}")

    def cleared(self, decision: Decision, goals: Sequence[Fact], stage: Stage, situation: Situation) -> Decision:
        """What is decided towards some goals; rather than give up, to move aside what shuts him off.

        What the goals speak of stays. While something stands there, that he cannot come further proves nothing; nor
        where it did not move, for it may be wedged in between walls.
        """
        if not decision.verdict:
            return decision
        self._stays = frozenset(situation.binding.get(str(term), "") for goal in goals for term in goal.args)
        instead = self._first_moved(self._movable(self._stays, situation), stage, situation)
        if instead is not None or decision.verdict != "impossible":
            return instead or decision
        things = [node for node in situation.model.objects if node.confidence >= LIKELY]
        shut_off = next((node.name for node, _ in obstacles(things, situation)), "")
        why = f"{decision.why}; {shut_off} shuts him off, and was not moved aside"
        return Decision(None, why, "limit") if shut_off else decision

    def _movable(self, stays: frozenset[str], situation: Situation) -> list[Node]:
        """What may be moved aside. stays : names of what is not."""
        things = (node for node in situation.model.objects if node.movable > 0 and node.confidence >= LIKELY)
        return [node for node in things if node.name not in stays]

    def _first_moved(
        self, things: Sequence[Node], stage: Stage, situation: Situation, name: str = ""
    ) -> Decision | None:
        """The next command to move one of some things aside that shut him off. name : of that one alone."""
        for node, aside in obstacles(things, situation):
            instead = self._moved_aside(node, aside, stage, situation) if name in ("", node.name) else None
            if instead is not None:
                self._moving = node.name
                return instead
        return None

    def _moved_aside(self, node: Node, aside: End, stage: Stage, situation: Situation) -> Decision | None:
        """The next command to move a thing aside, if it is one; None when none is known."""
        if node.confidence < SURELY:
            touch = by_touch(situation.cost_maps, node)
            look = self._pursuer.look(Subgoal("inspect", *touch), stage, situation)
            return None if look is None or look.command is None else look
        if node.polygon is None or node.vague:
            look = self._pursuer.look(self._verifier.inspection(node, situation), stage, situation)
            if look is not None and look.command is not None:
                return look
        if node.polygon is None:
            return None
        self._carrier.keep_to(node.name)
        advice = self._carrier.advise(node, {ASIDE: aside}, situation)
        if not isinstance(advice, Act):
            return self._pursuer.prepared(advice, stage, situation)
        if self._pursuer.noticed(situation.model, advice.command):
            return None
        return Decision(advice.command, f"{node.name} shuts him off: {advice.why}; {stage}")
