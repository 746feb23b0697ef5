"""Transport: towards a goal for an object. Find it, look at it, carry it, look where it must end, or give up.

planner.carrying.plan_executor says what to do with the object. Here it is settled what must be known first, and what an
infeasibility certificate proves.
"""

from collections.abc import Callable, Collection, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from utak.geometry.kernels.arrays import XY, Bools
from utak.geometry.manipulation.goals import Inside
from utak.kb.body import Grasp, Move, Push, Release, Turn
from utak.kb.language.terms import Fact
from utak.kb.task.binding import rules_on_what_fits, rules_that_deny
from utak.kb.world.model import Node
from utak.planner.advice import Act, Go, See
from utak.planner.carrying.infeasibility import Infeasibility
from utak.planner.carrying.open_facts import proof_if_not_found
from utak.planner.carrying.plan_executor import Advice
from utak.planner.carrying.preconditions import doubt_of_frame, doubts_of_thing, resistance
from utak.planner.deciding.search import subgoals_towards
from utak.planner.deciding.stage_turn import StageTurn
from utak.planner.deciding.trials import Refusal, RefusalChecks
from utak.planner.decision import Decision, TaskVerdict, command_or_nothing, done, impossible, nothing_to_do
from utak.planner.goals.corner_goal import approach_for_goals
from utak.planner.goals.joint import conflict
from utak.planner.goals.object_goals import goal_placement
from utak.planner.goals.origins import Origins
from utak.planner.goals.placement import Placement, meets_any_end, robot_can_leave, to_view_frame
from utak.planner.goals.robot_goals import unknown_destination
from utak.planner.navigation.subgoals import Subgoal
from utak.planner.per_model import PerModel
from utak.planner.screen.moves import orientation_is_uncertain
from utak.planner.situation import Situation
from utak.planner.skills.press import Presser
from utak.planner.stages import Stage

MAX_MISSED_PLANS = 2  # plans that miss their end, after which that end is looked at first; tuned on random worlds


class Transporter:
    """Brings objects where goals hold, and remembers where they began and what the robot looked at for that."""

    def __init__(self) -> None:
        """Make a transporter that remembers nothing."""
        self.place: Callable[[Fact, Node, XY, Situation], Placement] = PerModel(goal_placement)
        self.search: Callable[..., Sequence[Subgoal]] = subgoals_towards
        self._origins = Origins()
        self._presser, self.checks = Presser(), RefusalChecks()
        # How many squares had been looked from when the robot went to see where an object must end, until one is added.
        self._looked_before = 0
        self._is_measuring = False  # whether the last command was to measure what a parameter may mean
        self._has_taken_along = False  # whether an object that shut the robot in was taken along to look

    def origin_of(self, parameter: str, node: Node, situation: Situation) -> XY:
        """Return where the object that a parameter means lay at first: the middle (x, y), in squares, map frame."""
        return self._origins.at(parameter, node, situation)

    def towards(self, goal: Fact, turn: StageTurn, end: str = "") -> Decision:
        """Return the next command towards a goal for an object, or the verdict; done when the goal holds."""
        node = turn.situation.object_of(str(goal.args[0]))
        if node is None:
            return self._find(goal, turn)
        examined = self._examine(goal, node, turn)
        return self._carry(goal, node, turn, end) if examined.result == "idle" else examined

    def _examine(self, goal: Fact, node: Node, turn: StageTurn) -> Decision:
        """Return the next look at the object of a goal of which something is not clear; nothing when all is clear."""
        if node.polygon is not None and self._presser.is_pressed(goal, node, turn.situation):
            pressed = self._press_on(node, turn)
            if pressed or not self._land(goal, node, turn).viewpoints:
                return pressed or done(f"{goal} holds")
        due = (f"due({node.name})",)
        if look := turn.make_sure(doubts_of_thing(node, due, turn.situation, must=True)):
            return look
        if node.polygon is None:
            why = f"{turn.stage} is not attempted: the outline of {node.name} is not known"
            return Decision(None, why, TaskVerdict.LIMIT)
        return nothing_to_do(f"{node.name} is clear")

    def _carry(self, goal: Fact, node: Node, turn: StageTurn, end: str) -> Decision:
        """Return the next command to carry the object of a goal, or the verdict; done when the goal holds."""
        assert node.polygon is not None
        land = self._land(goal, node, turn)
        if end in land.ends:
            land = replace(land, ends={end: land.ends[end]})
        lost = self._origins.lost(goal, node, turn.situation)
        if lost and (land.holds or meets_any_end(land.loose, to_view_frame(node.polygon, turn.situation))):
            return Decision(None, f"it cannot be told whether {turn.stage} holds: {lost}", TaskVerdict.LIMIT)
        if land.holds:
            self._presser.begin(goal, node, land, turn.situation)
            return self._press_on(node, turn) or done(f"{goal} holds")
        if land.presses and not self._presser.has_begun(goal, node):
            self._presser.begin(goal, node, land, turn.situation)
            if pressed := self._press_on(node, turn):
                return pressed
        advice = self._advice(node, land, turn)
        if isinstance(advice, Infeasibility) and land.loose:
            if meets_any_end(land.loose, to_view_frame(node.polygon, turn.situation)):
                return done(f"{goal} holds")
            advice = turn.executor.advise(node, land.loose, turn.situation)
        if isinstance(advice, Infeasibility) and land.some:
            advice = replace(advice, proved=False)
        if isinstance(advice, Act):
            return _look_by_the_way(advice, node, land, turn) or self._act(advice, node, turn)
        if isinstance(advice, Go):
            walk = turn.go(advice)
            if walk.command is not None:
                return walk
            advice = Infeasibility(False, f"no place from which {node.name} can be grasped can be reached")
        turn = turn.within(turn.situation.along_with(node.patch)) if land.shut_in else turn
        if isinstance(advice, See):
            facts = [f"end_known({node.name})", *[f"minds_doors({node.name})"] * turn.situation.minds_doors(node.name)]
            return turn.see(advice, partial(_take_along, node, facts, turn))
        # What a stopped trial showed is looked at after the other trials: the robot would let the object go for it.
        if self.checks.is_probing(node, turn):
            refusal = Refusal(node, land.must_reach.ends() or land.ends, advice)
            if probe := self.checks.probed(refusal, turn):
                return probe
        unknown = unknown_destination(land.missing or "no way is known to carry it there", land.viewpoints)
        subgoals = self.search([unknown], turn.situation, turn.reconciled)
        decision = self._look_for_way(advice, node, land, subgoals, turn)
        return self._check_proof(Refusal(node, land.ends, advice), decision, goal, land, turn)

    def may_bring(self, goal: Fact, turn: StageTurn, supposed: Situation) -> bool:
        """Return whether the object of a goal may be brought in another situation to where the goal holds now."""
        node = turn.situation.object_of(str(goal.args[0]))
        if node is None or node.polygon is None:
            return True
        ends = self._land(goal, node, turn).ends
        refused = turn.executor.infeasibility(node, ends, supposed) if ends else None
        return refused is None or not refused.proved

    def _land(self, goal: Fact, node: Node, turn: StageTurn) -> Placement:
        """Return where a goal for an object holds."""
        return self.place(goal, node, self.origin_of(str(goal.args[0]), node, turn.situation), turn.situation)

    def conflict(self, stage: Stage, situation: Situation) -> Decision:
        """Return the verdict `impossible` when two goals of a stage cannot hold for one object at once."""
        return conflict(stage, situation, self.place, self.origin_of)

    def _find(self, goal: Fact, turn: StageTurn) -> Decision:
        """Return the next command to find what the parameter of a goal means, or the verdict if nothing can be."""
        x = str(goal.args[0])
        immovable = dict(turn.reconciled.unmovable).get(x)
        unseen = unknown_destination(f"{immovable} cannot be moved" if immovable else turn.situation.nothing_is(x))
        goals = [goal for goal in turn.stage.goals if str(goal.args[0]) == x]
        subgoals = self.search([unseen], turn.situation, turn.reconciled, approach_for_goals(goals, turn.situation))
        stating = rules_on_what_fits(x, turn.situation.task, turn.situation.rules)
        proof = () if stating else proof_if_not_found(turn.situation.model, bool(immovable))

        def missing() -> str:
            """Return in words what is missing, with users' rules because of which nothing may be meant."""
            denying = "" if immovable else rules_that_deny(x, turn.reconciled, turn.situation.rules)
            if stating and not denying:
                return f"{unseen.missing}, and what things are is said by the rule at {stating}"
            return unseen.missing + (f", by the rule at {denying}" if denying else "")

        decision = turn.seek(subgoals, missing, proof)
        if immovable and decision.verdict:
            unless = f"{immovable} is more than one thing, or moves another way than it was pushed"
            decision = replace(decision, unless=unless)
        return self.measured([x], decision, turn)

    def measured(self, parameters: Collection[str], decision: Decision, turn: StageTurn) -> Decision:
        """Return a decision; in place of a verdict the next push to measure what parameters may mean."""
        goes_on = self._is_measuring and isinstance(decision.command, Release)
        push = nothing_to_do("nothing is to be measured")
        if decision.verdict not in (None, TaskVerdict.DONE) or goes_on:
            like = [name for parameter, name in turn.reconciled.measurable if parameter in parameters]
            seen = (thing for thing in turn.situation.model.objects if thing.name in like)
            push = next(filter(None, (self.checks.push_to_measure(thing, turn) for thing in seen)), push)
        self._is_measuring = bool(push)
        return push or decision

    def _act(self, advice: Act, node: Node, turn: StageTurn) -> Decision:
        """Return the command of a plan, unless it closes a loop, or a look at the map should come before it."""
        if isinstance(advice.command, Push | Turn) and turn.closes_loop(advice.command):
            looping = turn.executor.release_looping
            let_go = turn.react(
                [f"circles({node.name})"], {"let_go": lambda now: now.act(looping(now.situation.model))}
            )
            if let_go:
                return let_go
        grasps = isinstance(advice.command, Move | Grasp)
        if grasps and (look := turn.make_sure(doubt_of_frame(node, turn.executor.turns, turn.situation))):
            return look
        if isinstance(advice.command, Push | Turn):
            self._presser.forget()
        return turn.act(advice)

    def _look_for_way(
        self,
        refused: Infeasibility,
        node: Node,
        land: Placement,
        subgoals: Sequence[Subgoal],
        turn: StageTurn,
    ) -> Decision:
        """Return the next command to see where an object shall end, or another way there; or the verdict."""
        # Where a door may be is looked at from places where the object would be in the way, and another way is looked
        # for without it.
        end_known = bool(land.viewpoints or land.ends) or orientation_is_uncertain(turn.situation.model)
        given = {
            "in_place": land.there,
            "minds_doors": turn.situation.minds_doors(node.name),
            "end_known": end_known,
            "shuts_in": land.shut_in,
            "taken_before": land.shut_in and self._has_taken_along,
        }
        along = partial(_take_along, node, [f"{fact}({node.name})" for fact, is_so in given.items() if is_so], turn)
        decision = turn.seek(subgoals, refused.reason, refused.proof(), along)
        self._has_taken_along |= land.shut_in and isinstance(decision.command, Push)
        if land.shut_in and not isinstance(decision.command, Push | Turn):
            why = f"it cannot be told whether {turn.stage} holds: {land.missing}, and {node.name} shuts the robot in"
            decision = Decision(None, why, TaskVerdict.LIMIT)
        return decision

    def _check_proof(
        self, refusal: Refusal, decision: Decision, goal: Fact, land: Placement, turn: StageTurn
    ) -> Decision:
        """Return a decision whose verdict is `impossible` only where that is proved, and note what proves it."""
        if decision.verdict and (must_reach := land.must_reach.ends()):
            refusal = refusal._replace(ends=must_reach)
            shut_off = turn.executor.infeasibility(refusal.node, must_reach, turn.situation)
            if shut_off is not None and shut_off.proved:
                why = f"{turn.stage} cannot be attained: {shut_off.reason()}"
                refusal, decision = refusal._replace(refused=shut_off), impossible(why, *shut_off.proof())
        if decision.verdict != TaskVerdict.IMPOSSIBLE:
            return decision
        return self.checks.noted(goal, refusal, decision)

    def _advice(self, node: Node, land: Placement, turn: StageTurn) -> Advice:
        """Return what to do to carry an object to where its goal holds; while that is not known, to near it."""
        executor, situation = turn.executor, turn.situation
        looked = len(situation.model.looked_from)
        missed = land.ends and executor.missed >= MAX_MISSED_PLANS
        if land.viewpoints and (looked == self._looked_before or missed):
            executor.forget_misses()
            self._looked_before = looked
            return Infeasibility(not situation.model.shaken, land.missing)
        if land.ends:
            return executor.advise(node, land.ends, situation, land.hoped.ends)
        onward = executor.continue_plan(node, situation)
        if isinstance(onward, Act):
            return onward
        for name, end in land.approach.items() if not situation.minds_doors(node.name) else ():
            advice = executor.advise(node, {name: end}, situation, land.hoped.ends)
            if isinstance(advice, Act | Go):
                return advice
        self._looked_before = looked
        return Infeasibility(not situation.model.shaken, land.missing)

    def led_out(self, decision: Decision, turn: StageTurn) -> Decision:
        """Return a decision; in place of a release, or of giving up, the push after which the robot is not shut in."""
        model = turn.situation.model
        held = model.object(model.held or "")
        gives_up = decision.verdict not in (None, TaskVerdict.DONE)
        if not (gives_up or isinstance(decision.command, Release)) or model.lost or held is None or not held.polygon:
            return decision
        if robot_can_leave(held, turn.situation):
            return decision

        def out(turn: StageTurn) -> Decision:
            """Return the push; nothing where geometry finds none, or where it would close a loop."""
            push = turn.executor.lead_out(held, turn.situation)
            if not isinstance(push, Act) or turn.closes_loop(push.command):
                return nothing_to_do(f"no push leads {held.name} out")
            self._presser.forget()
            return turn.act(push)

        return turn.react([f"lets_go({held.name})", f"shuts_in({held.name})"], {"lead_out": out}) or decision

    def _press_on(self, node: Node, turn: StageTurn) -> Decision:
        """Return the next press of a held object against a wall; nothing where none is left."""
        if self._presser.has_next(node):
            return turn.act(self._presser.next(node, turn.situation.model))
        return nothing_to_do(f"{node.name} is pressed")


def _look_by_the_way(planned: Act, node: Node, land: Placement, turn: StageTurn) -> Decision:
    """Return a push, in place of one of the plan, that shows on the way what the robot would have to come back for."""
    looks = land.by_the_way.viewpoints() if isinstance(planned.command, Push) else []
    if not looks:
        return nothing_to_do("nothing is to be seen by the way")

    def detour(turn: StageTurn) -> Decision:
        """Return the push; nothing where geometry finds none."""
        regions = {name: end for name, end in land.ends.items() if isinstance(end, Inside)}
        push = turn.executor.detour(node, [look.squares for look in looks], regions, turn.situation)
        return _push_to_see(push, looks[0].what, turn)

    return turn.react([f"pushed_on({node.name})"], {"detour": detour})


def _take_along(node: Node, facts: Sequence[str], turn: StageTurn, subgoal: Subgoal) -> Decision:
    """Return the next command to take an object to a subgoal; nothing when the robot had better walk there alone."""

    def take(turn: StageTurn) -> Decision:
        """Return the push with the object in hand; nothing where geometry finds none."""
        return _push_to_see(turn.executor.take_along(node, subgoal.squares, turn.situation), subgoal.what, turn)

    def fetch(turn: StageTurn) -> Decision:
        """Return the next command to bring the object near; nothing where geometry finds no simple way."""
        advice = turn.executor.bring_near(node, subgoal.squares, turn.situation)
        if isinstance(advice, Go):
            go = replace(advice, why=f"{node.name} is fetched, to be taken along: {subgoal.what}")
            return command_or_nothing(turn.go(go))
        return _push_to_see(advice, subgoal.what, turn)

    given = [f"looks_away({node.name})", *resistance(node), *facts]
    return turn.react(given, {"take_along": take, "fetch": fetch})


def _push_to_see(advice: Advice, what: str, turn: StageTurn) -> Decision:
    """Return the decision to push a held object in order to see something; nothing when that would close a loop."""
    return turn.act_anew(advice, f"{advice.why}: {what}" if isinstance(advice, Act) else "")


def push_to_see(node: Node, look: Subgoal, within: Bools, turn: StageTurn) -> Decision:
    """Return the push with which a held object stays within some squares while the robot looks; nothing for none."""
    model = turn.situation.model
    if model.held != node.name:
        return nothing_to_do(f"{node.name} is not in hand")
    column, row = turn.situation.cost_maps.here
    rows, columns = np.nonzero(model.mask(node.patch))
    targets = [divmod(square, within.shape[1]) for square in look.squares.tolist()]
    moved = [(rows + y - row, columns + x - column) for y, x in targets]
    inside = [
        min(ys.min(), xs.min()) >= 0
        and ys.max() < within.shape[0]
        and xs.max() < within.shape[1]
        and bool(within[ys, xs].all())
        for ys, xs in moved
    ]
    if not any(inside):
        return nothing_to_do(f"{node.name} would not stay where it is")
    near = look._replace(squares=look.squares[np.array(inside)])
    return _take_along(node, [f"end_known({node.name})"], turn, near)
