"""From the world model to the next command: the stages of the task, one after the other, until all are attained.

What must be carried planner.deciding.transport brings there; where Utak himself must be planner.deciding.pursuit
leads him.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path

import numpy as np

from kb.body import Release
from kb.language.terms import Fact
from kb.task.binding import Reconciled, reconcile
from kb.task.task import Task
from kb.world.corners import Corner, corners
from kb.world.model import WorldModel
from kb.world.rooms import NOTHING, Rooms, rooms_of
from planner.carrying.open_facts import qualified, verdict_if_missing
from planner.deciding.clearing import ObstacleClearer
from planner.deciding.pursuit import Pursuer
from planner.deciding.search import aims_towards
from planner.deciding.transport import Transporter
from planner.deciding.verification import Verifier, before_elsewhere, here, misgiving
from planner.decision import Decision
from planner.goals.joint import opposite_corners
from planner.goals.robot_goals import contains, destination, no_way
from planner.navigation.encircle import pivot, ways_round, winding
from planner.navigation.subgoals import Subgoal
from planner.screen.moves import next_move
from planner.screen.projection import CostMaps, ways_to_objects
from planner.sights.viewpoints import ARRIVE
from planner.situation import Situation
from planner.skills.into_corner import IntoCorner, halted
from planner.stages import BY_THE_WAY, FROM_THE_START, Stage, stages

Place = tuple[float, float]


@dataclass
class Decider:
    """Decides, and remembers what it decided.

    track : where he has been, as points of the lattice. bound : what the task's parameters mean. rooms : as last
    believed.
    """

    task: Task
    paths: str = "skeleton"
    rules: tuple[Path, ...] = ()
    pull: bool = True
    bound: Mapping[str, str] = field(default_factory=dict)
    attained: int = 0
    rooms: Rooms = NOTHING
    corners: Mapping[str, Corner] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.stages = stages(self.task)
        self._verifier = Verifier()
        self.pursuer = Pursuer(self.paths)
        self.transporter = Transporter(self.pull, self.pursuer, self._verifier)
        self._clearer = ObstacleClearer(self.transporter.carrier, self.pursuer, self._verifier)
        self._into_corner = IntoCorner()
        self._turn = 0  # the sign of the turn that was begun about an object

    def decide(self, model: WorldModel, track: Sequence[Place]) -> Decision:
        """What to do after an impression. track: the places where Utak has been, this one included."""
        cost_maps = CostMaps(model)
        self.rooms = rooms_of(model, self.rules)
        reconciled = self._reconcile(cost_maps)
        self.corners = corners(model, self.rules)
        if model.lost and model.held is not None:
            return Decision(Release(), f"{model.held} is let go, for nothing looks as it should")
        places = tuple((float(x), float(y)) for x, y in track)
        situation = Situation(model, cost_maps, self.bound, self.rooms, self.corners, self.task, self.rules, places)
        while self.attained < len(self.stages):
            stage = self.stages[self.attained]
            decision = self._clearer.going_on(stage, situation)
            decision = decision or self._towards(stage, situation, reconciled, track)
            decision = decision or self.pursuer.look(self._doubt(stage, situation), stage, situation)
            if decision is not None:
                unproved = model.anew and model.shaken and decision.verdict == "impossible"
                return replace(decision, verdict="limit") if unproved else qualified(decision, model)
            self.attained += 1
        if situation.forbidden("utak") and not situation.avoided:
            return Decision(None, "what the task asks for holds, but every door that is sure was gone through", "limit")
        return Decision(None, " and ".join(map(str, self.stages)) + " holds", "done")

    def _towards(
        self, stage: Stage, situation: Situation, reconciled: Reconciled, track: Sequence[Place]
    ) -> Decision | None:
        """The next command towards a stage, the verdict when it cannot be attained, or None when it is."""
        at_odds = self.transporter.at_odds(stage, situation)
        if at_odds is not None:
            return at_odds
        for goal in stage.carried:
            decision = self.transporter.towards(goal, stage, situation, reconciled)
            if decision is None:
                continue
            decision = self.transporter.freed(str(goal.args[0]), stage, situation) or decision
            proved = decision.verdict == "impossible"  # whatever else is moved, and however deep in a wall it is
            return decision if proved else self._clearer.cleared(decision, (goal,), stage, situation)
        decision = self._going(stage, situation, reconciled, track) if stage.own else None
        return None if decision is None else self._clearer.cleared(decision, stage.own, stage, situation)

    def _going(
        self, stage: Stage, situation: Situation, reconciled: Reconciled, track: Sequence[Place]
    ) -> Decision | None:
        """The next command towards where Utak himself shall be, or the verdict; None when he is there."""
        goals = stage.own
        if situation.model.held is not None:
            return Decision(Release(), f"{situation.model.held} is let go, to walk; {stage}")
        if goals[0].name in BY_THE_WAY:
            node = situation.model.object(self.bound.get(str(goals[0].args[1]), ""))
            if node is not None:
                return self._round(stage, node.name, situation, track)
            where = [destination(goals[0], situation)]
        else:
            where = [destination(goal, situation) for goal in goals]
            there = all(not d.missing and contains(d.squares, situation.model) for d in where)
            there = there or self._into_corner.pressing(stage, situation)
            look = self._made_sure(goals, there, stage, situation)
            if look is None and there and (nearer := self._into_corner.next(stage, situation)) is not None:
                return Decision(nearer, f"the walls of the corner may lie further away; {stage}")
            if there or look is not None:
                return look
        if at_odds := opposite_corners(goals, situation):
            return Decision(None, f"{stage} cannot be attained: {at_odds}", "impossible", unless=None)
        missing = "; ".join(d.missing for d in where if d.missing) or no_way(where)
        subgoals = aims_towards(where, situation, reconciled, ARRIVE)
        unseen = any(str(goal.args[1]) in reconciled.hypothesised for goal in goals)
        verdict = verdict_if_missing(situation.model) if unseen else "impossible"
        ask = partial(self.pursuer.pursue, subgoals, stage, situation, lambda: missing, verdict)
        decision = self.pursuer.felt(ask, stage, situation)
        return replace(decision, command=halted(decision.command, stage, situation))

    def _doubt(self, stage: Stage, situation: Situation) -> Subgoal | None:
        """What to look at before a stage is held for attained."""
        model, doubt = situation.model, misgiving(situation)
        for goal in (goal for goal in stage.goals if goal.name in FROM_THE_START):
            x = str(goal.args[0])
            node = model.object(self.bound.get(x, ""))
            began = model.frame.origin if node is None else self.transporter.beginnings.at(x, node, situation)
            lying = here(model) if node is None else model.mask(node.patch)
            doubt = doubt or before_elsewhere(goal.name, began, lying, situation)
        return doubt

    def _made_sure(self, goals: Sequence[Fact], there: bool, stage: Stage, situation: Situation) -> Decision | None:
        """A look at what goals are about, before they are held for attained; None when all of that is settled.

        there : they seem to hold.
        """
        nodes = [situation.model.object(self.bound.get(str(goal.args[1]), "")) for goal in goals]
        doubted = [n for n in nodes if n is not None and (self._verifier.doubted(n) or (there and n.vague))]
        looks = (self.pursuer.look(self._verifier.inspection(node, situation), stage, situation) for node in doubted)
        return next((look for look in looks if look is not None), None)

    def _round(self, stage: Stage, name: str, situation: Situation, track: Sequence[Place]) -> Decision | None:
        """The next command on the way round an object."""
        model, cost_maps = situation.model, situation.cost_maps
        node = model.object(name)
        assert node is not None
        home = (np.floor(track[0]) == np.floor(model.place)).all()
        if home and abs(winding(track, node)) == 1:
            return None
        offered = ways_round(cost_maps, track, node)
        begun = [offered[self._turn]] if self._turn in offered else list(offered.values())
        way = self.pursuer.choose(begun, situation)
        if way is None:
            return Decision(None, f"{stage} cannot be attained: no way leads round {name}", "impossible")
        self._turn = next(turn for turn, other in offered.items() if other is way)
        self.pursuer.keep(way, model)
        x, y = pivot(node)
        about = (x - model.view.west, y - model.view.south)
        kind = "attain" if way.level == 0 else "explore"
        return Decision(next_move(cost_maps, way.squares, kind, about), f"the way round {name}; {stage}")

    def _reconcile(self, cost_maps: CostMaps) -> Reconciled:
        carried = sorted({str(goal.args[0]) for stage in self.stages for goal in stage.carried})
        known = ways_to_objects(cost_maps)
        reconciled = reconcile(self.task, cost_maps.model, known, self.bound, self.rules, carried)
        self.bound = reconciled.binding
        return reconciled
