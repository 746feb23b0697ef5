"""Towards a goal for something that must be carried: look at it, carry it, look where it must end, or give up.

What to do with the thing planner.carrying.plan_executor says; here it is settled what must be known first, and
what a refusal proves.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial

from geometry.manipulation.goals import End
from kb.body import Grasp, Move, Push, Turn
from kb.language.terms import Fact
from kb.task.binding import Reconciled
from kb.world.model import Node
from planner.advice import Act, Go, See
from planner.carrying.infeasibility import Infeasibility
from planner.carrying.open_facts import verdict_if_missing
from planner.carrying.plan_executor import Advice, PlanExecutor
from planner.deciding.pursuit import Pursuer
from planner.deciding.search import aims_towards
from planner.deciding.verification import Verifier, before_taking, more_of
from planner.decision import Decision
from planner.goals.corner_goal import approach, may_move
from planner.goals.joint import conflict
from planner.goals.object_goals import landing
from planner.goals.origins import Origins
from planner.goals.placement import Placement, can_leave, in_view, lands_in_one
from planner.goals.robot_goals import nowhere
from planner.navigation.subgoals import Subgoal
from planner.screen.moves import is_open
from planner.situation import Situation
from planner.skills.measure_size import SizeEstimator, least_outline
from planner.skills.press import Presser
from planner.stages import FROM_THE_START, Stage

SIZE = "size"  # the target of a push that only tells how large a thing is
MISSED = 2  # plans that miss before where they should lead to is looked at


class Transporter:
    """Brings things where goals hold for them, and remembers where they began and what he looked at for that."""

    def __init__(self, pull: bool, pursuer: Pursuer, verifier: Verifier) -> None:
        self.pursuer, self.verifier = pursuer, verifier
        self.carrier = PlanExecutor(pull)
        self.beginnings = Origins()
        self.sizer = SizeEstimator()
        self._looked = 0  # squares he had looked from when he went to see where it must end, until it is one more
        self.presser = Presser()
        self._led_along = False  # has he taken along what shut him in, to look?

    def towards(self, goal: Fact, stage: Stage, situation: Situation, reconciled: Reconciled) -> Decision | None:
        """The next command towards a goal for something that must be carried, or None when it holds."""
        x = str(goal.args[0])
        node = situation.model.object(situation.binding.get(x, ""))
        if node is None:
            return self._found(x, stage, situation, reconciled)
        if node.polygon is not None and self.presser.is_pressed(goal, node, situation):
            return self._pressed_on(node, stage, situation)
        look = self._clear(node, stage, situation)
        if look is not None:
            return look
        if node.polygon is None:
            return Decision(None, f"{stage} is not attempted: the outline of {node.name} is not known", "limit")
        land = landing(goal, node, self.beginnings.at(x, node, situation), situation)
        lost = self.beginnings.lost(x, node, situation)
        if land.holds:
            why = f"{stage} cannot be told: {lost} since {node.name} was taken"
            if lost and goal.name in FROM_THE_START:
                return Decision(None, why, "limit")
            if self.beginnings.left(x, node, situation) and situation.forbidden(node.name):
                return Decision(None, f"{stage} holds, but {node.name} went through a door that it may not", "limit")
            self.presser.begin(goal, node, land, situation)
            return self._pressed_on(node, stage, situation)
        advice = self._advice(node, land, situation)
        if isinstance(advice, Infeasibility) and land.loose:
            if lands_in_one(land.loose, in_view(node.polygon, situation)):
                return self._led_out(node, stage, situation) if stage.goes_on else None
            advice = self.carrier.advise(node, land.loose, situation)
        if isinstance(advice, Infeasibility) and land.some:
            advice = replace(advice, proved=False)
        if isinstance(advice, Act):
            instead = self._by_the_way(node, land, stage, situation) if isinstance(advice.command, Push) else None
            return instead or self._act(advice, node, stage, situation)
        if isinstance(advice, Go):
            walk = self.pursuer.go(advice, stage, situation)
            if walk.command is not None:
                return walk
            advice = Infeasibility(False, lambda: f"{node.name} cannot be reached to be taken")
        situation = situation.along_with(node.patch) if land.shut_in else situation
        if isinstance(advice, See):
            along = partial(self._taken_along, node, stage, situation)
            return self.pursuer.pursue(
                [Subgoal("inspect", *advice.viewpoint)], stage, situation, lambda: "", along=along
            )
        unknown = nowhere(land.missing or "no way is known to carry it there", land.viewpoints)
        subgoals = aims_towards([unknown], situation, reconciled)
        decision = self._missing(advice, node, land, subgoals, stage, situation)
        return self._proved(advice, decision, node, land, stage, situation)

    def at_odds(self, stage: Stage, situation: Situation) -> Decision | None:
        """Return the verdict when two goals of a stage cannot hold for one thing at once; None otherwise."""
        for x in sorted({str(goal.args[0]) for goal in stage.carried}):
            goals = [goal for goal in stage.carried if str(goal.args[0]) == x]
            node = situation.model.object(situation.binding.get(x, ""))
            if len(goals) < 2 or node is None or node.polygon is None or any(may_move(g, situation) for g in goals):
                continue
            began = self.beginnings.at(x, node, situation)
            lands = [landing(goal, node, began, situation) for goal in goals]
            found = conflict(lands, in_view(node.polygon, situation))
            if found is not None:
                one, other = (goals[number] for number in found)
                why = f"{one} and {other} cannot hold at once: their places are too far apart"
                return Decision(None, why, "impossible")
        return None

    def freed(self, x: str, stage: Stage, situation: Situation) -> Decision | None:
        """The push by which what he holds no longer shuts him in, when he wants something else than that, x."""
        held = situation.model.held
        node = situation.model.object(held or "")
        return None if node is None or held == situation.binding.get(x) else self._led_out(node, stage, situation)

    def _found(self, x: str, stage: Stage, situation: Situation, reconciled: Reconciled) -> Decision:
        """The next command to find what a parameter means, or the verdict when nothing can be that."""
        fixed = dict(reconciled.unmovable).get(x)
        unseen = nowhere(f"{fixed} cannot be moved" if fixed else f"nothing seen so far is {x}")
        goals = [goal for goal in stage.goals if str(goal.args[0]) == x]
        subgoals = aims_towards([unseen], situation, reconciled, approach(goals, situation))
        verdict = verdict_if_missing(situation.model, bool(fixed))
        ask = partial(self.pursuer.pursue, subgoals, stage, situation, lambda: unseen.missing, verdict)
        decision = self.pursuer.felt(ask, stage, situation)
        if fixed and decision.verdict:
            unless = f"{fixed} is more than one thing, or moves another way than it was pushed"
            decision = replace(decision, unless=unless)
        like = [name for parameter, name in reconciled.measurable if parameter == x and decision.verdict]
        seen = (thing for thing in situation.model.objects if thing.name in like)
        gauged = (self._gauged(thing, stage, situation) for thing in seen)
        return next((push for push in gauged if push is not None), decision)

    def _clear(self, node: Node, stage: Stage, situation: Situation) -> Decision | None:
        """A look at what is to be carried, where it is not clear what that is; None when no look tells more."""
        if node.polygon is None or node.vague or self.verifier.doubted(node):
            look = self.pursuer.look(self.verifier.inspection(node, situation), stage, situation)
            if look is not None:
                return look
        look = self.pursuer.look(more_of(node, situation), stage, situation)
        return None if look is None or look.command is None else look

    def _by_the_way(self, node: Node, land: Placement, stage: Stage, situation: Situation) -> Decision | None:
        """Instead of a push of the plan, one by which he sees on the way what he would have to come back for."""
        for look in land.by_the_way():
            act = self.carrier.by_way_of(node, look.squares, situation)
            led = self._led(act, look.what, stage, situation)
            if led is not None:
                return led
        return None

    def _act(self, advice: Act, node: Node, stage: Stage, situation: Situation) -> Decision:
        """A command of the plan, unless it goes round in circles, or a look should come before it."""
        if isinstance(advice.command, Push | Turn) and self.pursuer.noticed(situation.model, advice.command):
            advice = self.carrier.given_up(situation.model)
        if isinstance(advice.command, Move | Grasp):
            look = self.pursuer.look(before_taking(node, self.carrier.turns, situation), stage, situation)
            if look is not None:
                return look
        if isinstance(advice.command, Push | Turn):
            self.presser.forget()
        return Decision(advice.command, f"{advice.why}; {stage}")

    def _missing(
        self,
        refused: Infeasibility,
        node: Node,
        land: Placement,
        subgoals: Sequence[Subgoal],
        stage: Stage,
        situation: Situation,
    ) -> Decision:
        """The next command to see what must be known of where a thing shall end, or of another way there.

        Where a door may be is looked at from places where a thing would be in the way; where it cannot be brought to
        where it shall end, another way there is looked for without it; and what is taken while it is open how the
        squares lie keeps the outline that it seems to have then. What shuts him in he takes along.
        """
        fetched = land.shut_in or not (land.viewpoints or land.ends or is_open(situation.model))
        again = land.shut_in and self._led_along  # he has taken it along, and brought it back
        along = partial(self._taken_along, node, stage, situation, fetched=fetched)
        brought = None if land.there or again else along
        verdict = "impossible" if refused.proved else "limit"
        ask = partial(self.pursuer.pursue, subgoals, stage, situation, refused.reason, verdict, brought)
        decision = self.pursuer.felt(ask, stage, situation)
        self._led_along |= land.shut_in and isinstance(decision.command, Push)
        if land.shut_in and not isinstance(decision.command, Push | Turn):
            why = f"{stage} cannot be told: {land.missing}, and {node.name} shuts him in"
            decision = Decision(None, why, "limit")
        if decision.verdict == "limit":
            decision = self._led_out(node, stage, situation, land.shut_in) or decision
        return decision

    def _proved(
        self,
        refused: Infeasibility,
        decision: Decision,
        node: Node,
        land: Placement,
        stage: Stage,
        situation: Situation,
    ) -> Decision:
        """What was decided; a verdict is "impossible" where a refusal proves that, and nothing is left to check."""
        must_reach = land.must_reach() if decision.verdict else {}
        if must_reach:
            shut_in = self.carrier.refused(node, must_reach, situation)
            if shut_in is not None and shut_in.proved:
                why = f"{stage} cannot be attained: {shut_in.reason()}"
                refused, decision = shut_in, Decision(None, why, "impossible")
        if decision.verdict != "impossible":
            return decision
        narrow = self.verifier.narrow_again(refused, situation)
        if narrow is not None:
            return self.pursuer.pursue([narrow], stage, situation, refused.reason)
        ends = must_reach or land.ends
        instead = self._sized(node, ends, stage, situation) if ends else None
        return instead or replace(decision, unless=refused.unless(), near=refused.neck())

    def _advice(self, node: Node, land: Placement, situation: Situation) -> Advice:
        """What to do to carry something to where its goal holds; while that is not known, to near it."""
        looked = len(situation.model.looked_from)
        if land.viewpoints and (looked == self._looked or (land.ends and self.carrier.missed >= MISSED)):
            self.carrier.missed, self._looked = 0, looked
            return Infeasibility(not situation.model.shaken, lambda: land.missing)
        if land.ends:
            return self.carrier.advise(node, land.ends, situation, land.hoped)
        going_on = self.carrier.gone_on(node, situation)
        if going_on is not None:
            return going_on
        for name, end in land.approach.items():
            advice = self.carrier.advise(node, {name: end}, situation, land.hoped)
            if isinstance(advice, Act | Go):
                return advice
        self._looked = looked
        return Infeasibility(not situation.model.shaken, lambda: land.missing)

    def _taken_along(
        self, node: Node, stage: Stage, situation: Situation, subgoal: Subgoal, fetched: bool = False
    ) -> Decision | None:
        """The next command to take an object along to where he wants to look; None when he had better walk there.

        fetched : also one that he has not got hold of.
        """
        advice = self.carrier.taken_along(node, subgoal.squares, fetched, situation)
        if isinstance(advice, Go):
            walk = self.pursuer.go(replace(advice, why=f"{node.name} is taken along: {subgoal.what}"), stage, situation)
            return None if walk.command is None else walk
        return self._led(advice, subgoal.what, stage, situation)

    def _pressed_on(self, node: Node, stage: Stage, situation: Situation) -> Decision | None:
        """The next push by which what he holds comes to touch a wall that may be further away, or what is left to do
        when it touches all; None when that is nothing.
        """
        act = self.presser.next(node, situation.model)
        if act is None:
            return self._led_out(node, stage, situation) if stage.goes_on else None
        self.carrier.depart(act)
        return Decision(act.command, f"{act.why}; {stage}")

    def _led_out(self, node: Node, stage: Stage, situation: Situation, shut_in: bool = False) -> Decision | None:
        """The push by which what he holds no longer shuts him in, to take it otherwise; None when it does not, or where
        that cannot be. shut_in : it is known to.
        """
        out = self.carrier.led_out(node, situation) if shut_in or not can_leave(node, situation) else None
        if out is None:
            return None
        self.presser.forget()
        self.carrier.depart(out)
        return Decision(out.command, f"{out.why}; {stage}")

    def _led(self, act: Act | None, what: str, stage: Stage, situation: Situation) -> Decision | None:
        """What is done to see something with an object in hand, unless that goes round in circles."""
        if act is None or self.pursuer.noticed(situation.model, act.command):
            return None
        self.carrier.depart(act)
        return Decision(act.command, f"{act.why}: {what}; {stage}")

    def _sized(self, node: Node, ends: Mapping[str, End], stage: Stage, situation: Situation) -> Decision | None:
        """The next command to tell how large a thing is that seems too large; None when it is so for certain.

        ends : those to which it cannot be brought as it is believed to be.
        """
        if (push := self._gauged(node, stage, situation)) is not None:
            return push
        least = least_outline(node)
        refused = least and self.carrier.refused(replace(node, polygon=least), ends, situation)
        if refused and refused.proved:
            return None
        return Decision(None, f"{stage} cannot be told: how large {node.name} is is not known well", "limit")

    def _gauged(self, node: Node, stage: Stage, situation: Situation) -> Decision | None:
        """The next command to push a thing by a part of a square, which tells how large it is; None when it is told."""
        for pose in self.sizer.poses(node):
            advice = self.carrier.advise(node, {SIZE: pose}, situation)
            if isinstance(advice, Act):
                return Decision(advice.command, f"how large {node.name} is is not sure; {stage}")
            walk = self.pursuer.prepared(advice, stage, situation)
            if walk is not None:
                return walk
        return None
