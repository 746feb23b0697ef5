"""From the world model to the next command: what is attained, what to aim at, which way, which move.

A way is kept while it holds: its aim is still wanted, and the squares ahead are still believed free.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path

import numpy as np

from geometry.ends import End
from kb.body import Command, Grasp, Move, Push, Release, Turn
from kb.corners import Corner, corners
from kb.facts import Fact
from kb.reconciliation import Reconciled, reconcile
from kb.rooms import NOTHING, Rooms, rooms_of
from kb.task import Task
from kb.worldmodel import Node, WorldModel
from planner.aims import Aim, choose
from planner.carrier import Act, Advice, Carrier, Go, See
from planner.circling import pivot, ways_round, winding
from planner.destinations import Situation, contains, destination, nowhere
from planner.fewest import FewestMoves
from planner.goals import BY_THE_WAY, FROM_THE_START, Stage, constraints, stages
from planner.keeping import Kept, lattice_squares
from planner.landing import Landing, can_leave, in_view, landing, lands_in_one
from planner.refusing import Refusal
from planner.repeating import Circles
from planner.screen import Screens, ways_to_objects
from planner.searching import against_walls, aims_towards
from planner.sizing import Sizer, least_outline
from planner.verifying import Verifier, before_elsewhere, before_taking, here, misgiving, more_of
from planner.walking import HURRY, STROLL, halting, is_open, is_settled, next_move
from planner.ways import Way, choose_way, ways

Place = tuple[float, float]
SIZE = "size"  # the target of a push that only tells how large a thing is
MISSED = 2  # plans that miss before where they should lead to is looked at


@dataclass(frozen=True)
class Decision:
    """The next command and why; or no command, and the verdict."""

    command: Command | None
    why: str
    verdict: str = ""


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
        self.constraints = constraints(self.task)
        self.carrier = Carrier(self.pull)
        self.verifier = Verifier()
        self.sizer = Sizer()
        self._kept = Kept()
        self._circles = Circles()
        self._looked = 0  # squares he had looked from when he went to see where it must end, until it is one more
        self._led_along = False  # has he taken along what shut him in, to look?
        self._feeling = False  # is he about to feel what may stand against a wall?
        self._turn = 0  # the sign of the turn that was begun about an object

    def decide(self, model: WorldModel, track: Sequence[Place]) -> Decision:
        """What to do after an impression. track: the places where Utak has been, this one included."""
        screens = Screens(model)
        self.rooms = rooms_of(model, self.rules)
        reconciled = self._reconcile(screens)
        self.corners = corners(model, self.rules)
        if model.lost and model.held is not None:
            return Decision(Release(), f"{model.held} is let go, for nothing looks as it should")
        situation = Situation(model, screens, self.bound, self.rooms, self.corners, self.task, self.rules)
        while self.attained < len(self.stages):
            stage = self.stages[self.attained]
            decision = self._towards(stage, situation, reconciled, track)
            decision = decision or self._look(self._doubt(stage, situation), stage, situation)
            if decision is not None:
                unproved = model.anew and model.shaken and decision.verdict == "impossible"
                return replace(decision, verdict="limit") if unproved else decision
            self.attained += 1
        return Decision(None, " and ".join(map(str, self.stages)) + " holds", "done")

    def _towards(
        self, stage: Stage, situation: Situation, reconciled: Reconciled, track: Sequence[Place]
    ) -> Decision | None:
        """The next command towards a stage, the verdict when it cannot be attained, or None when it is."""
        for goal in stage.carried:
            decision = self._carry(goal, stage, situation, reconciled)
            if decision is not None:
                return decision
        goals = stage.own
        if not goals:
            return None
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
            look = self._made_sure(goals, there, stage, situation)
            if there or look is not None:
                return look
        missing = "; ".join(d.missing for d in where if d.missing) or "no way leads there"
        aims = aims_towards(where, situation, reconciled, arrive=True)
        return self._felt(lambda: self._pursue(aims, stage, situation, lambda: missing), stage, situation)

    def _doubt(self, stage: Stage, situation: Situation) -> Aim | None:
        """What to look at before a stage is held for attained."""
        model, doubt = situation.model, misgiving(situation)
        for goal in (goal for goal in stage.goals if goal.name in FROM_THE_START):
            x = str(goal.args[0])
            node = model.object(self.bound.get(x, ""))
            began = model.lattice.woke if node is None else self.carrier.began_at(x, node, model)
            lying = here(model) if node is None else model.mask(node.patch)
            doubt = doubt or before_elsewhere(goal.name, began, lying, situation)
        return doubt

    def _made_sure(self, goals: Sequence[Fact], there: bool, stage: Stage, situation: Situation) -> Decision | None:
        """A look at what goals are about, before they are held for attained; None when all of that is settled.

        there : they seem to hold.
        """
        nodes = [situation.model.object(self.bound.get(str(goal.args[1]), "")) for goal in goals]
        doubted = [n for n in nodes if n is not None and (self.verifier.doubted(n) or (there and n.vague))]
        looks = (self._look(self.verifier.inspection(node, situation), stage, situation) for node in doubted)
        return next((look for look in looks if look is not None), None)

    def _felt(self, ask: Callable[[], Decision], stage: Stage, situation: Situation) -> Decision:
        """What is decided; rather than give up, to feel what may be a thing that stands against a wall.

        What was begun is gone on with: on the way there, too, something else may come to be worth a look.
        """
        decision = None if self._feeling else ask()
        if decision is None or decision.verdict:
            aims = against_walls(situation)
            felt = [self._pursue(aims, stage, situation, lambda: "")] if aims else []
            self._feeling = any(not instead.verdict for instead in felt)
            return felt[0] if self._feeling else decision or ask()
        return decision

    def _pursue(
        self,
        aims: Sequence[Aim],
        stage: Stage,
        situation: Situation,
        missing: Callable[[], str],
        verdict: str = "impossible",
        along: Callable[[Aim], Decision | None] | None = None,
    ) -> Decision:
        """The next command towards the best of some aims, or the verdict when none can be reached.

        missing : says in words what is missing; asked only for a verdict. along : how he takes something along there,
        if he can.
        """
        model = situation.model
        fewest = FewestMoves(situation.screens) if stage.carried else None
        while True:
            offered = self._circles.priced(aims, model)
            if fewest is not None:
                offered = fewest.priced(offered)
            aim = choose(offered, situation.screens, self._kept.aim(model))
            if aim is None:
                circles = len(offered) < len(aims)
                end = "he goes round in circles" if circles else "nothing is left to look at"
                return Decision(
                    None, f"{stage} cannot be attained: {missing()}, and {end}", "limit" if circles else verdict
                )
            taken = None if along is None else along(aim)
            if taken is not None:
                return taken
            if model.held is not None:
                return Decision(Release(), f"{model.held} is let go, to walk; {stage}")
            decision = self._walk(aim, stage, situation, fewest)
            if decision.command is None or not self._circles.noticed(model, decision.command):
                return decision
            self._circles.tire(lattice_squares(aim.squares, model))

    def _taken_along(
        self, node: Node, stage: Stage, situation: Situation, aim: Aim, fetched: bool = False
    ) -> Decision | None:
        """The next command to take an object along to where he wants to look; None when he had better walk there.

        fetched : also one that he has not got hold of.
        """
        advice = self.carrier.taken_along(node, aim.squares, fetched, situation)
        if isinstance(advice, Go):
            walk = self._go(replace(advice, why=f"{node.name} is taken along: {aim.what}"), stage, situation)
            return None if walk.command is None else walk
        if advice is None or self._circles.noticed(situation.model, advice.command):
            return None
        return Decision(advice.command, f"{advice.why}: {aim.what}; {stage}")

    def _go(self, go: Go, stage: Stage, situation: Situation) -> Decision:
        """The next command on the way to where something is taken, to halt right there."""
        walk = self._pursue([Aim("attain", go.square, go.why)], stage, situation, lambda: "no way leads there")
        return replace(walk, command=halting(walk.command, go.place, situation.model))

    def _carry(self, goal: Fact, stage: Stage, situation: Situation, reconciled: Reconciled) -> Decision | None:
        """The next command towards a goal for something that must be carried, or None when it holds."""
        x = str(goal.args[0])
        node = situation.model.object(self.bound.get(x, ""))
        if node is None:
            fixed = dict(reconciled.unmovable).get(x)
            unseen = nowhere(f"{fixed} cannot be moved" if fixed else f"nothing seen so far is {x}")
            aims = aims_towards([unseen], situation, reconciled)
            # No proof that there is none: it may stand against a wall, and look like a piece of that; and who does not
            # know how the squares lie may have pushed at another thing.
            proved = fixed and situation.model.view.sure and is_settled(situation.model)
            verdict = "impossible" if proved else "limit"
            ask = partial(self._pursue, aims, stage, situation, lambda: unseen.missing, verdict)
            decision = self._felt(ask, stage, situation)
            like = [name for parameter, name in reconciled.measurable if parameter == x and decision.verdict]
            seen = (thing for thing in situation.model.objects if thing.name in like)
            gauged = (self._gauged(thing, stage, situation) for thing in seen)
            return next((push for push in gauged if push is not None), decision)
        doubted = node.polygon is None or node.vague or self.verifier.doubted(node)
        if doubted and (look := self._look(self.verifier.inspection(node, situation), stage, situation)) is not None:
            return look
        if (look := self._look(more_of(node, situation), stage, situation)) is not None and look.command is not None:
            return look
        if node.polygon is None:
            return Decision(None, f"{stage} is not attempted: the outline of {node.name} is not known", "limit")
        began = self.carrier.began_at(x, node, situation.model)
        land, lost = landing(goal, node, began, situation), self.carrier.lost(x, node, began, situation)
        if land.holds:
            why = f"{stage} cannot be told: {lost} since {node.name} was taken"
            return Decision(None, why, "limit") if lost and goal.name in FROM_THE_START else None
        advice = self._advice(node, land, situation)
        if isinstance(advice, Refusal) and land.loose:
            if lands_in_one(land.loose, in_view(node.polygon, situation)):
                return None
            advice = self.carrier.advise(node, land.loose, situation)
        if isinstance(advice, Act):
            if isinstance(advice.command, Push | Turn) and self._circles.noticed(situation.model, advice.command):
                advice = self.carrier.given_up(situation.model)
            taking = isinstance(advice.command, Move | Grasp)
            look = self._look(before_taking(node, self.carrier.turns, situation), stage, situation) if taking else None
            if look is not None:
                return look
            return Decision(advice.command, f"{advice.why}; {stage}")
        if isinstance(advice, Go):
            walk = self._go(advice, stage, situation)
            if walk.command is not None:
                return walk
            advice = Refusal(False, lambda: f"{node.name} cannot be reached to be taken")
        situation = situation.along_with(node.patch) if land.shut_in else situation
        along = partial(self._taken_along, node, stage, situation)
        if isinstance(advice, See):
            return self._pursue([Aim("inspect", *advice.lookout)], stage, situation, lambda: "", along=along)
        unknown = nowhere(land.missing or "no way is known to carry it there", land.lookouts)
        verdict = "impossible" if advice.proved else "limit"
        aims = aims_towards([unknown], situation, reconciled)
        # Where a door may be is looked at from places where a thing would be in the way; where it cannot be brought to
        # where it shall end, another way there is looked for without it; and what is taken while it is open how the
        # squares lie keeps the outline that it seems to have then. What shuts him in he takes along.
        fetched = land.shut_in or not (land.lookouts or land.ends or is_open(situation.model))
        again = land.shut_in and self._led_along  # he has taken it along, and brought it back
        brought = None if land.there or again else partial(along, fetched=fetched)
        ask = partial(self._pursue, aims, stage, situation, advice.reason, verdict, brought)
        decision = self._felt(ask, stage, situation)
        self._led_along |= land.shut_in and isinstance(decision.command, Push)
        if land.shut_in and not isinstance(decision.command, Push | Turn):
            why = f"{stage} cannot be told: {land.missing}, and {node.name} shuts him in"
            decision = Decision(None, why, "limit")
        if decision.verdict == "limit" and (land.shut_in or not can_leave(node, situation)):
            out = self.carrier.led_out(node, situation)
            decision = decision if out is None else Decision(out.command, f"{out.why}; {stage}")
        must_reach = land.must_reach() if decision.verdict else {}
        if must_reach:
            shut_in = self.carrier.refused(node, must_reach, situation)
            if shut_in is not None and shut_in.proved:
                why = f"{stage} cannot be attained: {shut_in.reason()}"
                advice, decision = shut_in, Decision(None, why, "impossible")
        if decision.verdict != "impossible":
            return decision
        narrow = self.verifier.narrow_again(advice, situation)
        if narrow is not None:
            return self._pursue([narrow], stage, situation, advice.reason)
        return self._sized(node, must_reach or land.ends, stage, situation) or decision

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
            walk = self._go(advice, stage, situation) if isinstance(advice, Go) else None
            if isinstance(advice, See):
                walk = self._look(Aim("inspect", *advice.lookout), stage, situation)
            if walk is not None and walk.command is not None:
                return walk
        return None

    def _advice(self, node: Node, land: Landing, situation: Situation) -> Advice:
        """What to do to carry something to where its goal holds; while that is not known, to near it."""
        looked = len(situation.model.looked_from)
        if land.lookouts and (looked == self._looked or (land.ends and self.carrier.missed >= MISSED)):
            self.carrier.missed, self._looked = 0, looked
            return Refusal(False, lambda: land.missing)
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
        return Refusal(not self.carrier.begun, lambda: land.missing)

    def _look(self, aim: Aim | None, stage: Stage, situation: Situation) -> Decision | None:
        """The next command towards what he wants to make sure of, if there is anything."""
        return None if aim is None else self._pursue([aim], stage, situation, lambda: aim.what, "limit")

    def _round(self, stage: Stage, name: str, situation: Situation, track: Sequence[Place]) -> Decision | None:
        """The next command on the way round an object."""
        model, screens = situation.model, situation.screens
        node = model.object(name)
        assert node is not None
        home = (np.floor(track[0]) == np.floor(model.place)).all()
        if home and abs(winding(track, node)) == 1:
            return None
        offered = ways_round(screens, track, node)
        begun = [offered[self._turn]] if self._turn in offered else list(offered.values())
        way = self._choose(begun, situation)
        if way is None:
            return Decision(None, f"{stage} cannot be attained: no way leads round {name}", "impossible")
        self._turn = next(turn for turn, other in offered.items() if other is way)
        self._kept.keep(way, frozenset(), model)
        x, y = pivot(node)
        about = (x - model.view.west, y - model.view.south)
        kind = "attain" if way.level == 0 else "explore"
        return Decision(next_move(screens, way.squares, kind, about), f"the way round {name}; {stage}")

    def _walk(self, aim: Aim, stage: Stage, situation: Situation, fewest: FewestMoves | None) -> Decision:
        """The next command towards an aim. fewest : by the fewest moves where that is wanted."""
        model, screens = situation.model, situation.screens
        reached = screens.nearest(aim.squares)
        assert reached is not None
        straight = fewest.way(aim) if fewest is not None and reached.level == 0 else None
        way = None if straight is None else self._choose([straight], situation)
        way = way or self._kept.rest(aim, reached.level, model, screens)
        way = way or self._choose(ways(screens, reached.level, aim.squares, self.paths), situation)
        if way is None:
            return Decision(None, f"{stage} cannot be attained: every way there is forbidden", "impossible")
        self._kept.keep(way, lattice_squares(aim.squares, model), model)
        kind = aim.kind if reached.level == 0 else "pass"
        move = next_move(screens, way.squares, kind, pace=STROLL if fewest is None else HURRY)
        return Decision(move, f"{aim.what}; {stage}")

    def _choose(self, offered: Sequence[Way], situation: Situation) -> Way | None:
        if not offered:
            return None
        before = frozenset(self._kept.path(situation.model))
        doors = situation.rooms.sure
        forbidden = frozenset(doors[0].name for goal in self.constraints if doors and str(goal.args[0]) == "utak")
        return choose_way(offered, situation.screens, before, doors, forbidden)

    def _reconcile(self, screens: Screens) -> Reconciled:
        carried = sorted({str(goal.args[0]) for stage in self.stages for goal in stage.carried})
        known = ways_to_objects(screens)
        reconciled = reconcile(self.task, screens.model, known, self.bound, self.rules, carried)
        self.bound = reconciled.binding
        return reconciled
