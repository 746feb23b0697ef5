"""Transport: towards a goal for an object. Find it, look at it, carry it, look where it must end, or give up.

planner.carrying.plan_executor says what to do with the object. Here it is settled what must be known first, and what an
infeasibility certificate proves.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
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


class Transporter:
    """Brings objects where goals hold, and remembers where they began and what the robot looked at for that."""

    def __init__(self) -> None:
        """Make a transporter that remembers nothing."""
        self.place: Callable[[Fact, Node, XY, Situation], Placement] = PerModel(goal_placement)
        self.search: Callable[..., Sequence[Subgoal]] = subgoals_towards
        self._origins = Origins()
        self.presser, self.checks = Presser(), RefusalChecks()
        # How many squares had been looked from when the robot went to see where an object must end, until one is added.
        self.looked_before = 0
        self.has_taken_along = False  # whether an object that shut the robot in was taken along to look

    def origin_of(self, parameter: str, node: Node, situation: Situation) -> XY:
        """Return where the object that a parameter means lay at first: the middle (x, y), in squares, map frame."""
        return self._origins.at(parameter, node, situation)

    def towards(self, goal: Fact, turn: StageTurn, end: str = "") -> Decision:
        """Return the next command towards a goal for an object, or the verdict; done when the goal holds."""
        node = turn.situation.object_of(str(goal.args[0]))
        return self._find(goal, turn) if node is None else self._bring(goal, node, turn, end)

    def _bring(self, goal: Fact, node: Node, turn: StageTurn, end: str) -> Decision:
        """Return the same for an object that was found, as planner/asp/deciding/bring.lp chooses."""
        name, is_known = node.name, node.polygon is not None
        pressed = is_known and self.presser.is_pressed(goal, node, turn.situation)
        given = {"to_bring": True, "formless": not is_known, "pressed": pressed}
        facts = [f"{fact}({name})" for fact, is_so in given.items() if is_so]
        examine = {"examine": partial(_examine, node)}
        if looked := turn.first_of("bring", "bring", facts, examine):  # before it is noted where it lay at first
            return looked
        land, lost = Placement({}, f"the outline of {name} is not known"), ""
        if is_known:
            land, lost = self._land(goal, node, turn), self._origins.lost(goal, node, turn.situation)
        if end in land.ends:
            land = replace(land, ends={end: land.ends[end]})
        doing = _Bringing(self, goal, node, land, turn)
        attempts: Mapping[str, Callable[[StageTurn], Decision]] = {
            **examine,
            "leave_open": partial(_leave_open, lost or land.missing or f"{name} is not pressed against the walls"),
            "press": doing.press,
            "believe": doing.believe,
            "carry": doing.carry,
            "carry_on": doing.carry_on,
            "carry_near": doing.carry_near,
            "settle_for": doing.believe,
            "carry_loosely": doing.carry_loosely,
            "probe": doing.probe,
            "search": doing.search,
        }
        facts += [*doing.facts(turn), *[f"origin_lost({name})"] * bool(lost), *["vain(examine)"] * (not pressed)]
        why = f"{turn.stage} is not attained as far as is known: users' rules forbid what may be done with {name}"
        return turn.first_of("bring", "bring", facts, attempts) or Decision(None, why, TaskVerdict.LIMIT)

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
        return decision

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
            self.presser.forget()
            return turn.act(push)

        return turn.react([f"lets_go({held.name})", f"shuts_in({held.name})"], {"lead_out": out}) or decision


class _Bringing:
    """Works out what may be done in one decision for an object and a goal, and notes why geometry refused it last."""

    def __init__(self, by: Transporter, goal: Fact, node: Node, land: Placement, turn: StageTurn) -> None:
        """Make one of which nothing was tried."""
        self._by, self._goal, self._node, self._land = by, goal, node, land
        self._refused = Infeasibility(not turn.situation.model.shaken, land.missing)

    def facts(self, turn: StageTurn) -> Iterator[str]:
        """Yield what bring.lp is given of the object and its goal, as facts."""
        node, land, situation, name = self._node, self._land, turn.situation, self._node.name
        presser = self._by.presser
        given = {
            "pressable": land.presses and not presser.has_begun(self._goal, node),
            "attained": land.holds,
            "tolerable": land.loose and meets_any_end(land.loose, to_view_frame(node.polygon, situation)),
            "has_end": land.ends,
            "near_end": land.approach,
            "loose_end": land.loose,
            "end_open": land.viewpoints,
            "going_to_see": len(situation.model.looked_from) == self._by.looked_before,
            "minds_doors": situation.minds_doors(name),
            "probes": self._by.checks.is_probing(node, turn),
        }
        yield from (f"{fact}({name})" for fact, is_so in given.items() if is_so)
        yield f"misses({name},{turn.executor.missed})"

    def press(self, turn: StageTurn) -> Decision:
        """Return the next press of the object against a wall, where it is in hand."""
        presser, node = self._by.presser, self._node
        if not presser.has_begun(self._goal, node):
            presser.begin(self._goal, node, self._land, turn.situation)
        if not presser.has_next(node):
            return nothing_to_do(f"{node.name} is pressed")
        return turn.act(presser.next(node, turn.situation.model))

    def believe(self, _: StageTurn) -> Decision:
        """Return that the goal holds."""
        return done(f"{self._goal} holds")

    def carry(self, turn: StageTurn) -> Decision:
        """Return the next command to carry the object to where it must end."""
        land = self._land
        return self._follow(turn.executor.advise(self._node, land.ends, turn.situation, land.hoped.ends), turn)

    def carry_on(self, turn: StageTurn) -> Decision:
        """Return the next command of the plan under way with the object in hand."""
        onward = turn.executor.continue_plan(self._node, turn.situation)
        return self._act(onward, turn) if isinstance(onward, Act) else nothing_to_do("no plan is under way")

    def carry_near(self, turn: StageTurn) -> Decision:
        """Return the next command to carry the object to where its end is seen better."""
        node, land = self._node, self._land
        for name, end in land.approach.items():
            advice = turn.executor.advise(node, {name: end}, turn.situation, land.hoped.ends)
            if isinstance(advice, Act | Go):
                return self._follow(advice, turn)
        return nothing_to_do(f"{node.name} can be brought no nearer")

    def carry_loosely(self, turn: StageTurn) -> Decision:
        """Return the next command to carry the object to where it will do."""
        return self._follow(turn.executor.advise(self._node, self._land.loose, turn.situation), turn)

    def probe(self, turn: StageTurn) -> Decision:
        """Return the next push of the object where a passage may be wide enough."""
        # What a stopped trial showed is looked at after the other trials: the robot would let the object go for it.
        ends = self._land.must_reach.ends() or self._land.ends
        return self._by.checks.probed(Refusal(self._node, ends, self._refused), self._without(turn))

    def search(self, turn: StageTurn) -> Decision:
        """Return the next command to see where the object must end, or another way there; or the verdict."""
        if "vain(carry)" not in turn.situation.question.facts:  # it goes to see where the object must end
            turn.executor.forget_misses()
            self._by.looked_before = len(turn.situation.model.looked_from)
        turn, land = self._without(turn), self._land
        unknown = unknown_destination(land.missing or "no way is known to carry it there", land.viewpoints)
        subgoals = self._by.search([unknown], turn.situation, turn.reconciled)
        return self._check_proof(self._look_for_way(subgoals, turn), turn)

    def _without(self, turn: StageTurn) -> StageTurn:
        """Return the turn in which the object blocks no way where it shuts the robot in: it is taken along then."""
        return turn.within(turn.situation.along_with(self._node.patch)) if self._land.shut_in else turn

    def _follow(self, advice: Advice, turn: StageTurn) -> Decision:
        """Return the command that some advice asks for; nothing where there is none, and note why."""
        node = self._node
        if isinstance(advice, Act):
            return self._act(advice, turn)
        if isinstance(advice, Go):
            walk = turn.go(advice)
            if walk.command is not None:
                return walk
            advice = Infeasibility(False, f"no place from which {node.name} can be grasped can be reached")
        if isinstance(advice, See):
            return turn.see(advice, partial(_take_along, node, [f"end_known({node.name})"], self._without(turn)))
        self._refused = replace(advice, proved=False) if self._land.some else advice
        return nothing_to_do(self._refused.reason())

    def _act(self, advice: Act, turn: StageTurn) -> Decision:
        """Return the command of a plan, unless it closes a loop, or a look at the map should come before it."""
        node = self._node
        if looked := _look_by_the_way(advice, node, self._land, turn):
            return looked
        if isinstance(advice.command, Push | Turn) and turn.closes_loop(advice.command):
            looping = turn.executor.release_looping
            regrasp = {"regrasp": lambda now: now.act(looping(now.situation.model))}
            if released := turn.react([f"circles({node.name})"], regrasp):
                return released
        grasps = isinstance(advice.command, Move | Grasp)
        if grasps and (look := turn.make_sure(doubt_of_frame(node, turn.executor.turns, turn.situation))):
            return look
        if isinstance(advice.command, Push | Turn):
            self._by.presser.forget()
        return turn.act(advice)

    def _look_for_way(
        self,
        subgoals: Sequence[Subgoal],
        turn: StageTurn,
    ) -> Decision:
        """Return the next command to see where an object shall end, or another way there; or the verdict."""
        refused, node, land = self._refused, self._node, self._land
        end_known = bool(land.viewpoints or land.ends) or orientation_is_uncertain(turn.situation.model)
        given = {
            "in_place": land.there,
            "end_known": end_known,
            "shuts_in": land.shut_in,
            "taken_before": land.shut_in and self._by.has_taken_along,
        }
        along = partial(_take_along, node, [f"{fact}({node.name})" for fact, is_so in given.items() if is_so], turn)
        decision = turn.seek(subgoals, refused.reason, refused.proof(), along)
        self._by.has_taken_along |= land.shut_in and isinstance(decision.command, Push)
        if land.shut_in and not isinstance(decision.command, Push | Turn):
            why = f"it cannot be told whether {turn.stage} holds: {land.missing}, and {node.name} shuts the robot in"
            decision = Decision(None, why, TaskVerdict.LIMIT)
        return decision

    def _check_proof(self, decision: Decision, turn: StageTurn) -> Decision:
        """Return a decision whose verdict is `impossible` only where that is proved, and note what proves it."""
        refusal = Refusal(self._node, self._land.ends, self._refused)
        if decision.verdict and (must_reach := self._land.must_reach.ends()):
            refusal = refusal._replace(ends=must_reach)
            shut_off = turn.executor.infeasibility(refusal.node, must_reach, turn.situation)
            if shut_off is not None and shut_off.proved:
                why = f"{turn.stage} cannot be attained: {shut_off.reason()}"
                refusal, decision = refusal._replace(refused=shut_off), impossible(why, *shut_off.proof())
        if decision.verdict != TaskVerdict.IMPOSSIBLE:
            return decision
        return self._by.checks.noted(self._goal, refusal, decision)


def _examine(node: Node, turn: StageTurn) -> Decision:
    """Return the next look at what is not clear of an object."""
    return turn.make_sure(doubts_of_thing(node, (f"due({node.name})",), turn.situation, must=True))


def _leave_open(missing: str, turn: StageTurn) -> Decision:
    """Return the verdict that it cannot be told whether a stage can be attained."""
    return Decision(None, f"it cannot be told whether {turn.stage} holds: {missing}", TaskVerdict.LIMIT)


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


def push_to_see(node: Node, within: Bools, turn: StageTurn, look: Subgoal) -> Decision:
    """Return the push with which a held object stays within some squares while the robot looks; nothing for none."""
    column, row = turn.situation.cost_maps.here
    rows, columns = np.nonzero(turn.situation.model.mask(node.patch))
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
