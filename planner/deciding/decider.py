"""The decider: from the world model to the next command, one stage of the task after the other until all are attained.

planner.deciding.transport brings objects where they shall be; planner.deciding.pursuit leads the robot itself.
"""

from collections.abc import Mapping, Sequence
from copy import deepcopy
from dataclasses import replace
from pathlib import Path

import numpy as np

from geometry.kernels.arrays import XY
from kb.body import Grasp, Release
from kb.language.terms import Fact
from kb.language.vocabulary import ROBOT, TRACK_GOALS
from kb.task.binding import Reconciliation, as_well_by_parameter, reconcile
from kb.task.task import Task
from kb.tracing.decisions import record_decisions
from kb.world.corners import Corner, corners
from kb.world.model import WorldModel
from kb.world.rooms import NO_ROOMS, Rooms, rooms_of
from planner.carrying.open_facts import qualify, verdict_if_not_found
from planner.carrying.plan_executor import PlanExecutor
from planner.deciding.clearing import ObstacleClearer
from planner.deciding.errands import ErrandRunner
from planner.deciding.feeling import feeling_scope
from planner.deciding.keeping import ConstraintKeeper
from planner.deciding.pursuit import Pursuer
from planner.deciding.search import subgoals_towards
from planner.deciding.tools import Tools
from planner.deciding.transport import Transporter
from planner.deciding.verification import Verifier, check_elsewhere, look_at_contradiction, robot_square
from planner.decision import Decision, TaskVerdict
from planner.goals.joint import opposite_corners_reason
from planner.goals.robot_goals import destination, robot_stands_on, unknown_destination, unreachable_reason
from planner.navigation.encircle import encircled_point, encircling_routes, winding_number
from planner.navigation.subgoals import Subgoal
from planner.per_model import PerModel
from planner.screen.moves import next_move
from planner.screen.projection import CostMaps, costs_to_objects
from planner.sights.viewpoints import TO_REACH
from planner.situation import Situation, regions_kept_off
from planner.skills.into_corner import IntoCorner, halt_beside_walls
from planner.stages import ORIGIN_GOALS, Stage, parameters_that_keep_meaning, stages
from planner.subgoal_kind import SubgoalKind
from planner.tasking.task_plan import TaskPlan

PROOFS = (TaskVerdict.IMPOSSIBLE, TaskVerdict.POSSIBLE_IF)  # verdicts that something cannot be, as things are


class Decider:
    """Decides, and owns everything that remembers earlier decisions.

    The executor, the pursuer and the verifier belong to it alone: it lends them, as Tools, for the time of a call.

    Attributes
    ----------
    task, paths, rules : the task, the name of the path-finder and the user's encodings, as given.
    stages : the stages of the task, in order.
    attained : how many of them are attained.
    bound : what the task's parameters mean: parameter -> name of a node.
    rooms, corners : as last believed, in squares, view frame; none before the first decision.
    pursuer : walks after subgoals.
    executor : follows manipulation plans.
    """

    def __init__(
        self,
        task: Task,
        paths: str = "skeleton",
        rules: tuple[Path, ...] = (),
        pull: bool = True,
        bound: Mapping[str, str] | None = None,
        executor: PlanExecutor | None = None,
        pursuer: Pursuer | None = None,
    ) -> None:
        """Make a decider that has decided nothing.

        Parameters
        ----------
        task : the goals and what is said of their parameters.
        paths : the path-finder of planner.navigation.routes: skeleton, visibility or grid.
        rules : the user's own encodings.
        pull : whether a held object may be pulled.
        bound : what parameters of the task are known to mean: parameter -> name of a node; nothing if None.
        executor : follows manipulation plans; a new one if None. It belongs to this decider from now on.
        pursuer : walks after subgoals; a new one if None. It belongs to this decider from now on.
        """
        self.task, self.paths, self.rules = task, paths, rules
        self.bound: Mapping[str, str] = bound or {}
        self.stages = stages(task)
        self.attained = 0
        self.rooms: Rooms = NO_ROOMS
        self.corners: Mapping[str, Corner] = {}
        self.pursuer = pursuer or Pursuer(paths)
        self.executor = executor or PlanExecutor(pull)
        self._verifier = Verifier()
        self._tools = Tools(self.executor, self.pursuer, self._verifier)
        self._transporter = Transporter()
        self._clearer = ObstacleClearer()
        self._destination = PerModel(destination)
        self._errands = ErrandRunner(self._destination, pull)
        self._into_corner = IntoCorner()
        self._keeper = ConstraintKeeper(task)
        self._lenient = False  # whether regions that the task forbids are taken as small as they surely are
        self._given_up: frozenset[tuple[str, str]] = frozenset()  # parameters with nodes that left no way
        self._turn = 0  # the sign of the turn that was begun about an object

    @property
    def plan(self) -> TaskPlan | None:
        """The task plan under way, from its present errand on; None while there is none."""
        return self._errands.plan

    @property
    def attempt(self) -> TaskPlan | None:
        """The best that was found in place of a plan: it leaves goals unmet; None while there is a plan."""
        return self._errands.attempt

    def decide(self, model: WorldModel, track: Sequence[XY]) -> Decision:
        """Return what to do after an impression.

        Stages that are attained are counted as such for good.

        A Decision holds the next command (in the robot's own frame) and its reason in words; or no command, but a
        verdict and its reason.

        Parameters
        ----------
        model : what is believed.
        track : the places where the robot has been, the present one last: (x, y) in squares, map frame.

        Returns
        -------
        Decision
            The next command, or the verdict.

        Raises
        ------
        BadInputError
            The user's encodings are wrong.
        """
        self._keeper.note(model)
        decision = self._decided(model, track)
        if decision.command is not None or decision.verdict == TaskVerdict.DONE:
            return decision
        return self._blamed_on_constraints(decision, model, track)

    def _decided(self, model: WorldModel, track: Sequence[XY]) -> Decision:
        """Return what to do after an impression, whatever constraints have to do with a verdict.

        Parameters
        ----------
        model, track : as for `decide`.
        """
        kept_off = regions_kept_off(self.task, self.bound, model, "utak", lenient=self._lenient)
        cost_maps = CostMaps(model, kept_off=kept_off if kept_off.any() else None)
        self.rooms = rooms_of(model, self.rules)
        reconciled = self._reconcile(cost_maps)
        self.corners = corners(model, self.rules)
        if model.lost and model.held is not None:
            why = f"{model.held} is released, because the robot does not know where it is: nothing looks as expected"
            return Decision(Release(), why)
        places = tuple((float(x), float(y)) for x, y in track)
        situation = Situation(model, cost_maps, self.bound, self.rooms, self.corners, self.task, self.rules, places)
        situation = replace(situation, lenient=self._lenient, as_well=as_well_by_parameter(reconciled))
        broken = self._keeper.broken_at_start(situation)
        if broken is not None:
            return qualify(broken, situation)
        while self.attained < len(self.stages):
            stage = self.stages[self.attained]
            decision = self._clearer.continue_clearing(stage, situation, self._tools)
            decision = decision or self._towards(stage, situation, reconciled, track)
            decision = decision or self.pursuer.pursue_look(self._doubt(stage, situation), stage, situation)
            if decision is not None:
                if decision.verdict is not None and self._gave_up_meaning(stage, situation):
                    return self._decided(model, track)  # the same is tried with another thing that is meant as well
                if decision.verdict is not None and (vain := self._tried_in_vain(stage)):
                    decision = replace(decision, why=f"{decision.why}; {vain}")
                if isinstance(decision.command, Grasp) and self._errands.blamed_so_far:  # not against rules
                    why = f"{stage} cannot be attained as far as is known"
                    decision = Decision(None, why, TaskVerdict.LIMIT)
                if decision.verdict is not None and self._errands.blamed and not self._errands.is_shut_out:
                    decision = replace(decision, why=f"{decision.why}; {self._errands.blamed}")
                unproved = model.anew and model.shaken and decision.verdict == TaskVerdict.IMPOSSIBLE
                if unproved:
                    decision = replace(decision, verdict=TaskVerdict.LIMIT)
                else:
                    decision = qualify(decision, situation, feeling_scope(stage, situation))
                return self._keeper.guarded(decision, situation)
            self.attained += 1
        if situation.forbidden("utak") and not situation.avoided:
            why = "what the task asks for holds, but the robot went through every door that is sure"
            return Decision(None, why, TaskVerdict.LIMIT)
        doubt = self._keeper.doubt_of_done(situation)
        if doubt:
            return Decision(None, f"what the task asks for holds, but {doubt}", TaskVerdict.LIMIT)
        why = " and ".join(map(str, self.stages)) + " holds"
        wished = [str(wish) for wish, _ in self.stages[-1].wishes] if self.stages else []
        hold = self._errands.wishes_that_hold
        why += "".join(f"; the wish {wish} {'holds' if wish in hold else 'is left'}" for wish in wished)
        return Decision(None, why, TaskVerdict.DONE)

    def is_done_without_wishes(self, model: WorldModel, track: Sequence[XY]) -> bool:
        """Return whether all goals hold as they are, so that nothing but wishes is left.

        Parameters
        ----------
        model, track : as for `decide`.
        """
        if not self.stages or not self.stages[-1].wishes:
            return False
        other = deepcopy(self)
        other.stages = (*self.stages[:-1], replace(self.stages[-1], wishes=()))
        with record_decisions():  # a question about the end, not a decision
            return other.decide(model, track).verdict == TaskVerdict.DONE

    def _blamed_on_constraints(self, decision: Decision, model: WorldModel, track: Sequence[XY]) -> Decision:
        """Return a verdict with the constraints that leave no way, where there would be one without them.

        A verdict that stands without the constraints stands with them. Else it is proved only when it stands for
        regions that are taken as small as they surely are, too; if it does not, it is `limit`.

        Parameters
        ----------
        decision : a verdict, but for `done`.
        model, track : as for `decide`.
        """
        ways = [goal for goal in self.task.goals if goal.name in ("avoid", "carry_nothing_through")]
        if not ways or any(str(goal) in decision.why for goal in ways):
            return decision
        without = self._asked(model, track, ways)
        if without.command is None and without.verdict != TaskVerdict.DONE:
            return without
        alone = [goal for goal in ways if self._asked(model, track, [goal]).command is not None]
        why = f"{decision.why}; {' and '.join(map(str, alone or ways))} leave{'s' * (len(alone or ways) == 1)} no way"
        proof = self._asked(model, track, [], lenient=True)
        if decision.verdict in PROOFS and proof.verdict in PROOFS:
            return replace(decision, why=why, verdict=proof.verdict)
        return replace(decision, why=why, verdict=TaskVerdict.LIMIT)

    def _asked(
        self, model: WorldModel, track: Sequence[XY], without: Sequence[Fact], lenient: bool = False
    ) -> Decision:
        """Return what would be decided without some constraints, or with regions as small as they surely are.

        Parameters
        ----------
        model, track : as for `decide`.
        without : the constraints that are left out.
        lenient : whether regions count only where whole squares lie in them.
        """
        other = deepcopy(self)
        other.task = replace(self.task, goals=tuple(goal for goal in self.task.goals if goal not in without))
        other._keeper.task, other._lenient = other.task, lenient
        with record_decisions():  # a question about the verdict, not a decision
            return other._decided(model, track)

    def _towards(
        self, stage: Stage, situation: Situation, reconciled: Reconciliation, track: Sequence[XY]
    ) -> Decision | None:
        """Return the next command towards a stage, or the verdict when it cannot be attained; None when it is.

        A Decision holds the next command (in the robot's own frame) and its reason in words; or no command, but a
        verdict and its reason.

        Parameters
        ----------
        stage : of the task: the goals that shall hold now.
        situation : what is believed (world model, rooms, doors, corners, track).
        reconciled : what the parameters of the task mean, each the name of an object, and which may be the others.
        track : where the robot has been, (x, y) in squares, map frame.
        """
        conflict = self._transporter.conflict_verdict(stage, situation)
        if conflict is not None:
            return self._clearer.open_walls(conflict, stage.carried, stage, situation, self._tools)
        situation = self._errands.update(stage, situation, self._transporter, self._tools)
        if situation.binding != self.bound:  # the plan chose what parameters mean
            self.bound = situation.binding
            reconciled = self._reconcile(situation.cost_maps)
        if self._errands.is_shut_out:
            why = f"{stage} cannot be attained: {self._errands.blamed}"
            return Decision(None, why, TaskVerdict.IMPOSSIBLE, unless=None)
        errand = self._errands.next(stage, situation, reconciled, self._transporter, self._tools)
        if errand is not None:
            return errand
        for goal in self._ordered(stage, situation):
            decision = self._transporter.towards(goal, stage, situation, reconciled, self._tools)
            if decision is None:
                continue
            decision = self._transporter.free_robot(str(goal.args[0]), stage, situation, self._tools) or decision
            if decision.verdict == TaskVerdict.IMPOSSIBLE:  # proved, whatever is moved that was seen
                return self._clearer.open_walls(decision, (goal,), stage, situation, self._tools)
            return self._clearer.clear_before_verdict(decision, (goal,), stage, situation, self._tools)
        decision = self._go_along_plan(stage, situation, reconciled, track) if stage.own else None
        if decision is None:
            return self._go_for_wish(stage, situation, reconciled, track)
        return self._clearer.clear_before_verdict(decision, stage.own, stage, situation, self._tools)

    def _go_along_plan(
        self, stage: Stage, situation: Situation, reconciled: Reconciliation, track: Sequence[XY]
    ) -> Decision | None:
        """Return the next command of the robot itself through the doors of the task plan; by any way where these fail.

        As `_go`: None when the robot is where it shall be.

        Parameters
        ----------
        stage : of the task; it has a goal for the robot itself.
        situation : what is believed (world model, rooms, doors, corners, track).
        reconciled : what the parameters of the task mean, each the name of an object, and which may be the others.
        track : where the robot has been, (x, y) in squares, map frame.
        """
        along = self._errands.along_plan(situation)
        decision = self._go(stage, along, reconciled, track)
        if decision is None or decision.command is not None or along.closed == situation.closed:
            return decision
        return self._go(stage, situation, reconciled, track)

    def _go_for_wish(
        self, stage: Stage, situation: Situation, reconciled: Reconciliation, track: Sequence[XY]
    ) -> Decision | None:
        """Return the next command for a wish about the robot itself that the plan has; None for none, never a verdict.

        Parameters
        ----------
        stage : of the task; its goals hold.
        situation : what is believed (world model, rooms, doors, corners, track).
        reconciled : what the parameters of the task mean, each the name of an object, and which may be the others.
        track : where the robot has been, (x, y) in squares, map frame.
        """
        found = self._errands.own_wish
        if found is None:
            return None
        errand, wish = found
        goals = tuple(goal for goal in stage.goals if goal.name not in TRACK_GOALS)
        decision = self._go(replace(stage, goals=(*goals, wish)), situation, reconciled, track)
        if decision is not None and decision.command is None:
            self._errands.drop(errand, situation)
            return None
        return decision

    def _ordered(self, stage: Stage, situation: Situation) -> list[Fact]:
        """Return the goals for objects in the order in which they are pursued while there is no task plan.

        Objects that are not known yet come first, while the hand is empty: all must be found, and once they are known
        it can be planned which of them goes first. Else the order is that of the task.
        """
        if situation.model.held is not None:
            return list(stage.carried)

        def is_known(goal: Fact) -> bool:
            """Return whether the outline of the object that a goal is about is known."""
            node = situation.model.object(situation.binding.get(str(goal.args[0]), ""))
            return node is not None and node.polygon is not None

        return sorted(stage.carried, key=is_known)

    def _go(
        self, stage: Stage, situation: Situation, reconciled: Reconciliation, track: Sequence[XY]
    ) -> Decision | None:
        """Return the next command towards where the robot itself shall be, or the verdict; None when it is there.

        A Decision holds the next command (in the robot's own frame) and its reason in words; or no command, but a
        verdict and its reason.

        Parameters
        ----------
        stage : of the task; it has a goal for the robot itself.
        situation : what is believed (world model, rooms, doors, corners, track).
        reconciled : what the parameters of the task mean, each the name of an object, and which may be the others.
        track : where the robot has been, (x, y) in squares, map frame.
        """
        goals = stage.own
        if situation.model.held is not None:
            why = f"{situation.model.held} is released, because the robot must walk; {stage}"
            return Decision(Release(), why)
        if goals[0].name in TRACK_GOALS:
            node = situation.model.object(self.bound.get(str(goals[0].args[1]), ""))
            if node is not None:
                return self._go_round(stage, node.name, situation, track)
            where = [self._destination(goals[0], situation)]
        else:
            where = [self._destination(goal, situation) for goal in goals]
            there = all(not d.missing and robot_stands_on(d.squares, situation.model) for d in where)
            there = there or self._into_corner.is_pressing(stage, situation)
            look = self._make_sure(goals, there, stage, situation)
            if look is None and there and (nearer := self._into_corner.next(stage, situation)) is not None:
                return Decision(nearer, f"the walls of the corner may lie further away; {stage}")
            if there or look is not None:
                return look
        if opposite := opposite_corners_reason(goals, situation):
            why = f"{stage} cannot be attained: {opposite}"
            return Decision(None, why, TaskVerdict.IMPOSSIBLE, unless=None)
        missing = "; ".join(d.missing for d in where if d.missing) or unreachable_reason(where)
        subgoals = subgoals_towards(where, situation, reconciled, TO_REACH)
        unseen = any(str(goal.args[1]) in reconciled.hypothesised for goal in goals)
        verdict = verdict_if_not_found(situation.model) if unseen else TaskVerdict.IMPOSSIBLE

        def ask() -> Decision:
            """Return the next command there, or to look for another way where doors are shut; else the verdict."""
            found = self.pursuer.pursue(subgoals, stage, situation, lambda: missing, verdict)
            if found.command is not None or not situation.shut("utak"):
                return found
            within = situation.within_shut_doors()
            unknown = unknown_destination("every way that is known leads through a forbidden door")
            others = subgoals_towards([unknown], within, reconciled, TO_REACH)
            other = self.pursuer.pursue(others, stage, within, lambda: unknown.missing)
            return found if other.command is None else other

        decision = self.pursuer.feel_before_verdict(ask, stage, situation)
        return replace(decision, command=halt_beside_walls(decision.command, stage, situation))

    def _doubt(self, stage: Stage, situation: Situation) -> Subgoal | None:
        """Return what to look at before a stage is believed to be attained; None for nothing.

        First what the last impression contradicts, then what the origin of a thing depends on (doors, walls).

        A Subgoal holds its kind, the squares to go to (flat indices (row * columns + column) on the arrays of the view;
        any of them will do), the reason in words, its chance in percent, and a price in squares of way.

        Parameters
        ----------
        stage : of the task: the goals that shall hold now.
        situation : what is believed: world model, rooms, doors, corners and track.
        """
        model, doubt = situation.model, look_at_contradiction(situation)
        for goal in (goal for goal in stage.goals if goal.name in ORIGIN_GOALS):
            x = str(goal.args[0])
            node = model.object(self.bound.get(x, ""))
            began = model.frame.origin if node is None else self._transporter.origin_of(x, node, situation)
            covered = robot_square(model) if node is None else model.mask(node.patch)
            doubt = doubt or check_elsewhere(goal.name, began, covered, situation)
        return doubt

    def _make_sure(self, goals: Sequence[Fact], there: bool, stage: Stage, situation: Situation) -> Decision | None:
        """Return a look at the objects of some goals before these are believed to hold; None when all are settled.

        The next command of it, or the verdict `limit` when no way leads to where it is looked from.

        A Decision holds the next command (in the robot's own frame) and its reason in words; or no command, but a
        verdict and its reason.

        Objects are asked about in the order of the goals; the first look that is left is returned.

        Parameters
        ----------
        goals : of the stage, for the robot itself.
        there : whether the goals seem to hold.
        stage : of the task: the goals that shall hold now.
        situation : what is believed (world model, rooms, doors, corners, track).
        """
        nodes = [situation.model.object(self.bound.get(str(goal.args[1]), "")) for goal in goals]
        doubted = [n for n in nodes if n is not None and (self._verifier.is_unsettled(n) or (there and n.vague))]
        subgoals = (self._verifier.next_look(node, situation) for node in doubted)
        looks = (self.pursuer.pursue_look(subgoal, stage, situation) for subgoal in subgoals)
        return next((look for look in looks if look is not None), None)

    def _go_round(self, stage: Stage, name: str, situation: Situation, track: Sequence[XY]) -> Decision | None:
        """Return the next command on the way round an object; None when the robot has gone round it and is back.

        The verdict `impossible` when no way leads round it.

        A Decision holds the next command (in the robot's own frame) and its reason in words; or no command, but a
        verdict and its reason.

        The sense of rotation, once begun, is kept while a route leads that way.

        Parameters
        ----------
        stage : of the task: the goals that shall hold now.
        name : of the object; the model knows it: else AssertionError.
        situation : what is believed (world model, rooms, doors, corners, track).
        track : where the robot has been, (x, y) in squares, map frame; the first point is where the round began.
        """
        model, cost_maps = situation.model, situation.cost_maps
        node = model.object(name)
        assert node is not None
        is_home = (np.floor(track[0]) == np.floor(model.place)).all()
        if is_home and abs(winding_number(track, node)) == 1:
            return None
        offered = encircling_routes(cost_maps, track, node)
        begun = [offered[self._turn]] if self._turn in offered else list(offered.values())
        route = self.pursuer.choose_route(begun, situation)
        if route is None:
            why = f"{stage} cannot be attained: no way leads round {name}"
            return Decision(None, why, TaskVerdict.IMPOSSIBLE)
        self._turn = next(turn for turn, other in offered.items() if other is route)
        self.pursuer.keep_route(route, model)
        x, y = encircled_point(node)
        about = (x - model.view.west, y - model.view.south)
        kind = SubgoalKind.ATTAIN if route.level == 0 else SubgoalKind.EXPLORE
        return Decision(next_move(cost_maps, route.squares, kind, about), f"the way round {name}; {stage}")

    def _gave_up_meaning(self, stage: Stage, situation: Situation) -> bool:
        """Note that a stage cannot be attained with what one parameter means, where it may mean something else as well.

        Returns False when there is nothing else to try.

        Parameters
        ----------
        stage : of the task: the goals that shall hold now.
        situation : what is believed (world model, rooms, doors, corners, track).
        """
        for parameter in (str(goal.args[0]) for goal in stage.carried):
            others = {(parameter, name) for name in situation.as_well.get(parameter, ())}
            meant = parameter, self.bound.get(parameter, "")
            if others - self._given_up and meant not in self._given_up:
                self._given_up |= {meant}
                return True
        return False

    def _tried_in_vain(self, stage: Stage) -> str:
        """Return which things were tried in vain that parameters of a stage may mean as well, in words; "" for none."""
        parameters = dict.fromkeys(str(goal.args[0]) for goal in stage.carried)
        given_up = sorted(self._given_up)
        tried = [(x, [n for p, n in given_up if p == x and n != self.bound.get(x)]) for x in parameters]
        words = (f"{x} may be {' or '.join(names)} as well, and that was no better" for x, names in tried if names)
        return "; ".join(words)

    def _reconcile(self, cost_maps: CostMaps) -> Reconciliation:
        """Return what the parameters of the task mean now (each the name of an object), and remember it as bound.

        A Reconciliation holds the binding (parameter -> name of a node), and the pairs that are doubtful or
        contradicted.

        Parameters
        ----------
        cost_maps : the present world model on arrays of squares, with the ways from where the robot stands.
        """
        wished = [goal for stage in self.stages for goal, _ in stage.wishes]
        goals = [*(goal for stage in self.stages for goal in stage.carried), *wished]
        carried = sorted({str(goal.args[0]) for goal in goals} - {ROBOT})
        known = costs_to_objects(cost_maps)
        kept = parameters_that_keep_meaning(self.task, self.attained) & set(carried)
        reconciled = reconcile(
            self.task,
            cost_maps.model,
            known,
            self.bound,
            self.rules,
            carried,
            self._errands.meanings,
            kept,
            self._given_up,
        )
        self.bound = reconciled.binding
        return reconciled
