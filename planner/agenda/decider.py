"""The decider: from the world model to the next command, one stage of the task after the other until all are attained.

What is done for a stage is chosen by planner/asp/deciding/activities.lp (planner.agenda.activities).
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from utak.geometry.kernels.arrays import XY
from utak.kb.language.goal_words import ROBOT
from utak.kb.reasoning.user_rules import rules_reach
from utak.kb.task.alternatives import alternatives, may_be
from utak.kb.task.binding import Reconciliation, as_well_by_parameter, reconcile
from utak.kb.task.described import FirstPlaces
from utak.kb.task.task import Task
from utak.kb.tracing.decisions import record_decisions
from utak.kb.world.corners import Corner, corners
from utak.kb.world.facts import Places, facts_for_rules
from utak.kb.world.model import WorldModel
from utak.kb.world.place_names import PlaceNames
from utak.kb.world.rooms import NO_ROOMS, Rooms, rooms_of
from utak.planner.agenda.activities import Activities
from utak.planner.carrying.plan_executor import PlanExecutor
from utak.planner.deciding.pursuit import Pursuer
from utak.planner.deciding.stage_turn import StageTurn
from utak.planner.deciding.verification import Verifier
from utak.planner.decision import Decision, TaskVerdict
from utak.planner.goals.references import as_meant, is_moved_for_others_only
from utak.planner.screen.projection import CostMaps, costs_to_objects
from utak.planner.situation import Situation, possible_doors, regions_kept_off
from utak.planner.stages import Stage, constraints, parameters_that_keep_meaning, stages
from utak.planner.tasking.proposal import TASK_ENCODING
from utak.planner.tasking.rule_effects import rules_about_doors
from utak.planner.tasking.task_plan import TaskPlan

PROOFS = (TaskVerdict.IMPOSSIBLE, TaskVerdict.POSSIBLE_IF)  # verdicts that something cannot be, as things are


class Decider:
    """Decides, and owns everything that remembers earlier decisions."""

    def __init__(
        self,
        task: Task,
        paths: str = "skeleton",
        rules: tuple[Path, ...] = (),
        pull: bool = True,
        bound: Mapping[str, str] | None = None,
    ) -> None:
        """Make a decider that has decided nothing."""
        self.task, self.paths, self.rules = task, paths, rules
        self.bound: Mapping[str, str] = bound or {}
        self.stages = stages(task)
        self.attained = 0
        self.rooms: Rooms = NO_ROOMS
        self.place_names = PlaceNames()
        self.corners: Mapping[str, Corner] = {}
        self.pursuer = Pursuer(paths)
        self.executor = PlanExecutor(pull)
        self._verifier = Verifier()
        self.alternatives: tuple[str, ...] = ()  # what may be besides the tree of nodes, as facts
        self._first_places = FirstPlaces()
        self._activities = Activities(task, pull)
        self._intention = self._activities.errands.intention
        self._given_up: frozenset[tuple[str, str]] = frozenset()  # parameters with nodes that left no way
        # By parameters with nodes that they do not all mean at once in any plan: because of what, in words
        self._refused: dict[frozenset[tuple[str, str]], str] = {}
        self._unmoved: frozenset[str] = frozenset()  # parameters of things that cannot be moved, and need not be
        self._turned: dict[Stage, Decision] = {}  # the verdicts of stages of which the other of two things is moved

    @property
    def plan(self) -> TaskPlan:
        """The task plan under way, from its present step on; else the step as which the newest command is given."""
        return self._activities.stated

    @property
    def attempt(self) -> TaskPlan | None:
        """The best that was found in place of a plan: it leaves goals unmet; None while there is a plan."""
        return self._intention.attempt

    @property
    def blamed(self) -> str:
        """The users' rules because of which there is no plan for all goals, in words; "" for none, or with a plan."""
        return self._activities.errands.blamed if self._intention.plan is None else ""

    def decide(self, model: WorldModel, track: Sequence[XY]) -> Decision:
        """Return what to do after an impression."""
        self._activities.keeper.note(model)
        kept_off = regions_kept_off(self.task, self.bound, model, ROBOT)
        cost_maps = CostMaps(model, kept_off=kept_off if kept_off.any() else None)
        self.rooms = self.place_names.named(rooms_of(model, self.rules), model)
        self.corners = corners(model, self.rules)
        reconciled = self._reconcile(cost_maps)
        places = tuple((float(x), float(y)) for x, y in track)
        situation = Situation(model, cost_maps, self.bound, self.rooms, self.corners, self.task, self.rules, places)
        keeper, as_well = self._activities.keeper, as_well_by_parameter(reconciled)
        carried, renamed = keeper.middles(model), dict(keeper.renamed)
        situation = replace(
            situation,
            as_well=as_well,
            carried=carried,
            renamed=renamed,
            near_misses=reconciled.near_misses,
            may_be=may_be(self.alternatives),
        )
        if any(goal.name == "not_through" for goal in self.task.goals) or rules_reach(TASK_ENCODING.stem, self.rules):
            possible = possible_doors(model, self.rooms, self.rules)
            situation = replace(
                situation, possible_doors=self.place_names.doors_named(possible, model, self.rooms.doors)
            )
        ruled = rules_about_doors(situation)
        situation = replace(situation, closed=ruled.closed, door_prices=ruled.prices, door_reliefs=ruled.reliefs)
        situation = situation.within_shut_doors()
        for stage in self.stages[self.attained :]:
            turn = self._turn(stage, situation, reconciled, track)
            decision = self._for_stage(turn)
            meant = self._intention.meanings
            if any(self.bound.get(parameter) != name for parameter, name in meant.items()):
                self.bound = {**self.bound, **meant}  # the plan chose what parameters mean
                self._reconcile(cost_maps)
            if decision.verdict not in (None, TaskVerdict.DONE):
                if self._refused_meaning(decision, stage, situation):
                    return self.decide(model, track)  # the next thing that matches is meant, or looked for
                if self._gave_up_meaning(stage, situation):
                    return self.decide(model, track)  # the same is tried with another thing that is meant as well
                vain = self._tried_in_vain(stage)
                decision = replace(decision, why=f"{decision.why}; {vain}") if vain else decision
                decision = self._blamed_on_constraints(decision, turn)
            if decision.verdict != TaskVerdict.DONE:
                return self._activities.keeper.guarded(decision, situation)
            self.attained += 1
        ended = self._activities.decide(self._turn(Stage(()), situation, reconciled, track))
        return replace(ended, why=self._done_in_words()) if ended.verdict == TaskVerdict.DONE else ended

    def _for_stage(self, turn: StageTurn) -> Decision:
        """Return what is decided for a stage, as its goals are met: see planner.goals.references."""
        holds = self._activities.holds(turn.situation)
        stage, other = (as_meant(turn.stage, turn.situation, holds, other_way) for other_way in (False, True))
        first = self._turned.get(turn.stage)
        if first is None:
            decision = self._whole(stage, turn)
            if stage == other or decision.verdict in (None, TaskVerdict.DONE):
                return decision
            first = self._turned.setdefault(turn.stage, decision)
        decision = self._whole(other, turn)
        if decision.verdict in PROOFS and first.verdict != TaskVerdict.IMPOSSIBLE:
            why = f"{first.why}; the other way round, {decision.why}"
            return replace(decision, why=why, verdict=first.verdict)  # it is not proved for both
        refuses = first.refuses | decision.refuses if first.refuses and decision.refuses else frozenset()
        return replace(decision, refuses=refuses)

    def _whole(self, stage: Stage, turn: StageTurn) -> Decision:
        """Return what is decided for a stage; for all of its goals where those that come first hold."""
        decision = self._activities.decide(replace(turn, stage=stage))
        if decision.verdict != TaskVerdict.DONE or not stage.later:
            return decision
        whole = replace(stage, goals=(*stage.goals, *stage.later), later=())
        return self._activities.decide(replace(turn, stage=whole))

    def _turn(self, stage: Stage, situation: Situation, reconciled: Reconciliation, track: Sequence[XY]) -> StageTurn:
        """Return what a decision for a stage is worked out with."""
        return StageTurn(stage, situation, reconciled, track, self.executor, self.pursuer, self._verifier)

    def _done_in_words(self) -> str:
        """Return that all stages hold, and which wishes do, in words."""
        goals = [str(goal) for stage in self.stages for goal in stage.goals]
        why = f"{' and '.join(goals) or 'all that the task asks for'} {'hold' if len(goals) > 1 else 'holds'}"
        wished = [str(wish) for wish, _ in self.stages[-1].wishes] if self.stages else []
        hold = self._intention.wishes_that_hold()
        return why + "".join(f"; the wish {wish} {'holds' if wish in hold else 'is left'}" for wish in wished)

    def is_done_without_wishes(self, model: WorldModel, track: Sequence[XY]) -> bool:
        """Return whether all goals hold as they are, so that nothing but wishes is left."""
        if not self.stages or not self.stages[-1].wishes:
            return False
        before = self.stages, self.attained
        self.stages = (*self.stages[:-1], replace(self.stages[-1], wishes=()))
        with record_decisions():  # a question about the end, not a decision
            decision = self.decide(model, track)
        self.stages, self.attained = before
        return decision.verdict == TaskVerdict.DONE

    def _blamed_on_constraints(self, decision: Decision, turn: StageTurn) -> Decision:
        """Return a verdict with the constraints that leave no way, where there may be one without them."""
        ways, situation = list(constraints(self.task)), turn.situation

        def helps(supposed: Situation) -> bool:
            """Return whether more may be done in another situation."""
            return self._activities.may_do_more(turn, turn.within(supposed))

        if not ways or any(str(goal) in decision.why for goal in ways) or not helps(situation.without(ways)):
            return decision
        alone = [goal for goal in ways if helps(situation.without([goal]))] or ways
        why = f"{decision.why}; {' and '.join(map(str, alone))} leave{'s' * (len(alone) == 1)} no way"
        proved = decision.verdict in PROOFS and not helps(situation.as_lenient())
        return replace(decision, why=why, verdict=decision.verdict if proved else TaskVerdict.LIMIT)

    def _refused_meaning(self, decision: Decision, stage: Stage, situation: Situation) -> bool:
        """Note where a verdict or users' rules leave no plan with what parameters mean; return whether that is new."""
        by_rules = self._intention.refused_meanings(stage, situation)
        proved = decision.refuses if decision.verdict == TaskVerdict.IMPOSSIBLE else frozenset()
        refused = by_rules or proved
        if not refused or refused in self._refused:
            return False
        self._refused[refused] = "users' rules leave no plan" if by_rules else decision.why
        self._turned.pop(stage, None)
        named = {str(term) for before in self.stages[: self.attained] for goal in before.goals for term in goal.args}
        if any(parameter in named for parameter, _ in refused):
            self.attained = 0  # by what is meant no longer
        return True

    def _gave_up_meaning(self, stage: Stage, situation: Situation) -> bool:
        """Note that a stage cannot be attained with what one parameter means, where it may mean something else."""
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
        means = {refused: " and ".join(f"{x} means {n}" for x, n in sorted(refused)) for refused in self._refused}
        named = [f"{why} where {means[refused]}" for refused, why in self._refused.items()]
        words = (f"{x} may be {' or '.join(names)} as well, and that was no better" for x, names in tried if names)
        return "; ".join([*named, *words])

    def _reconcile(self, cost_maps: CostMaps) -> Reconciliation:
        """Return what the parameters of the task mean now (each the name of an object), and remember it as bound."""
        wished = [goal for stage in self.stages for goal, _ in stage.wishes]
        goals = [*(goal for stage in self.stages for goal in stage.carried), *wished]
        carried = sorted({str(goal.args[0]) for goal in goals} - {ROBOT} - self._unmoved)
        known = costs_to_objects(cost_maps)
        kept = parameters_that_keep_meaning(self.task, self.attained) & set(carried)
        planned, before, given_up = self._intention.meanings, self.bound, self._given_up
        model, rules = cost_maps.model, self.rules
        places = Places(self.rooms, self.corners)
        world = facts_for_rules("reconciliation", rules, model, places)
        first = self._first_places.facts(self.task, model, places, self._activities.keeper.renamed)
        reconciled = reconcile(
            self.task, model, known, before, rules, carried, planned, kept, given_up, self._refused, world, first
        )
        unmoved = {x for x, _ in reconciled.unmovable if is_moved_for_others_only(x, goals, self.task.parameters)}
        if unmoved:  # the other one of two things is moved
            self._unmoved |= unmoved
            return self._reconcile(cost_maps)
        self.bound = reconciled.binding
        self.alternatives = alternatives(self.task, model, places, reconciled, rules)
        return reconciled
