"""Trials: what seems one thing may be several that touch, and what did not move one way may move another way.

Checks: whether geometry is right in what it refuses. A passage may be wider than it seems, an object smaller.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from utak.geometry.cspace.bottleneck import least_gap
from utak.geometry.manipulation.goals import At, End
from utak.geometry.motion.se2 import Pose
from utak.kb.language.terms import Fact
from utak.kb.objects.movability import square_ways
from utak.kb.world.model import Node
from utak.planner.advice import Act
from utak.planner.carrying.infeasibility import Infeasibility
from utak.planner.carrying.plan_executor import Advice
from utak.planner.deciding.bringing import ASIDE_TARGET, another_way, bring_to_end, carry_on
from utak.planner.deciding.feeling import feel_rims, feeling_scope, walls_to_feel
from utak.planner.deciding.stage_turn import ROBOT_ITSELF, StageTurn
from utak.planner.decision import Decision, TaskVerdict, impossible, nothing_to_do
from utak.planner.goals.placement import NEGLIGIBLE_LENGTH, end_away_from, lies_clear_of
from utak.planner.navigation.subgoals import Subgoal
from utak.planner.screen.moves import move_to
from utak.planner.screen.projection import dilate
from utak.planner.sights.things import things_in_question, unfelt_rims
from utak.planner.situation import Situation
from utak.planner.skills.measure_gap import GapMeasurer, PassageRow
from utak.planner.skills.measure_size import SizeEstimator, least_outline
from utak.planner.skills.try_passage import PassageTrials
from utak.planner.subgoal_kind import SubgoalKind

SHARE_TARGET = "share"  # the ends of pushes that give each side of a passage its share of what is missing
SIZE_TARGET = "size"  # the end of a push whose only purpose is to measure an object
ROOM_BEFORE = 2  # squares about a passage that are cleared for the robot to come into it; a convention
GAP_REASON = "how wide a passage is shows where its walls stop the robot"


class Trials:
    """Finds out whether what seems one thing is several, and remembers which thing is moved for that."""

    def __init__(self) -> None:
        """Make one that moves nothing."""
        self._moving = ""

    def is_pushing(self, situation: Situation) -> bool:
        """Return whether a thing is in hand that is to be moved, to see whether it moves another way."""
        return bool(self._moving) and situation.model.held == self._moving

    def go_on(self, turn: StageTurn) -> Decision:
        """Return the next command for the thing in hand that is moved by a square; nothing when that is done."""
        node = turn.situation.model.object(self._moving)
        carried = node and (carry_on(node, turn) or another_way(node, turn))
        if not carried:
            gone, self._moving = self._moving, ""
        return carried or nothing_to_do(f"{gone} is no longer tried")

    def next(self, goals: Sequence[Fact], turn: StageTurn) -> Decision:
        """Return the next command to find out whether what seems one thing is several; nothing when nothing is left."""
        situation, scope = turn.situation, feeling_scope(turn)
        if felt := feel_rims(unfelt_rims(situation.cost_maps, scope), turn):
            return felt
        # While walls are left that were never felt, the verdict rests on these.
        several = [] if walls_to_feel(turn).any() else things_in_question(situation.cost_maps, scope)
        meant = situation.named_by(goals)
        ways = {way: At(Pose(float(x), float(y), 0.0)) for way, (x, y) in square_ways(situation.model.frame).items()}
        for node in situation.model.objects:
            moved = None if node.name in meant else another_way(node, turn)
            if node in several and node.name not in situation.binding.values() and not (node.moved or node.resisted):
                moved = bring_to_end(node, ways, turn)  # by a square: it is seen to be one thing, or to be several
            if moved:
                self._moving = node.name
                return moved
        return nothing_to_do("no thing is left to try")


class Refusal(NamedTuple):
    """The answer of geometry that an object cannot be brought to any of several ends."""

    node: Node
    ends: Mapping[str, End]  # by name, in squares, view frame; {} where none is known
    refused: Infeasibility


class RefusalChecks:
    """Seeks what settles whether geometry is right in what it refuses, and remembers what was tried and measured."""

    def __init__(self) -> None:
        """Make one that sought nothing."""
        self._refusals: dict[Fact, Refusal] = {}  # by the goals for objects, in the present decision
        self._sizes, self._passages, self._gaps = SizeEstimator(), PassageTrials(), GapMeasurer()
        self._alike = ""  # the thing that was measured last to know whether goals are about it

    def begin(self, turn: StageTurn) -> None:
        """Begin a decision, and note what the newest walk against a side of a passage showed."""
        self._refusals = {}
        self._gaps.note(len(turn.track), turn.situation.model)

    def noted(self, goal: Fact, refusal: Refusal, decision: Decision) -> Decision:
        """Note why a goal is refused; return the decision that says so, with what would overturn it."""
        self._refusals[goal] = refusal
        return replace(decision, unless=refusal.refused.unless(), near=refusal.refused.neck())

    def facts(self, turn: StageTurn) -> Iterator[str]:
        """Yield which goals are refused, which for a passage that may be wider, and what may be measured, as facts."""
        for name, goal in turn.goals.items():
            refusal = self._refusals.get(goal)
            if refusal is not None:
                yield f"infeasible({name})"
                if refusal.refused.unless():
                    yield f"narrow({name})"
        subjects = (*turn.goals, ROBOT_ITSELF)
        yield from (f"measurable({subject})" for subject in subjects if _alike(turn.goals_of(subject), turn))

    def is_at_wall(self, situation: Situation) -> bool:
        """Return whether the robot has just walked against a side of a passage: nothing comes before the step back."""
        return self._gaps.is_at_wall(len(situation.track))

    def step_back(self, turn: StageTurn) -> Decision:
        """Return the move of a robot that has walked against a side of a passage a little back from it."""
        model = turn.situation.model
        return Decision(move_to(self._gaps.step_back(len(turn.track), model), model), f"{GAP_REASON}; {turn.stage}")

    def is_probing(self, node: Node, turn: StageTurn) -> bool:
        """Return whether the robot holds an object with which it has begun to probe a passage."""
        return self._passages.begun(node, turn.situation.model)

    def recheck(self, goals: Sequence[Fact], turn: StageTurn) -> Decision:
        """Return the next command to look again from close by at the passage for which a goal is refused."""
        refused = self._refusals[goals[0]].refused
        return turn.look_if_reached(turn.verifier.recheck_passage(refused, turn.situation))

    def measure(self, goals: Sequence[Fact], turn: StageTurn) -> Decision:
        """Return the next command to measure what goals are about; `limit` where it may be smaller than it seems."""
        if push := self._measure(_alike(goals, turn), turn):
            return push
        if goals[0] not in self._refusals:
            return nothing_to_do("nothing is left to measure")
        node, ends, _ = self._refusals[goals[0]]
        if push := self._push_to_measure(node, turn):
            return push
        least = least_outline(node)
        refused = least and ends and turn.executor.infeasibility(replace(node, polygon=least), ends, turn.situation)
        if not ends or (refused and refused.proved):
            return nothing_to_do(f"{node.name} is too large in any case")
        why = f"it cannot be told whether {turn.stage} can be attained: the size of {node.name} is not known well"
        return Decision(None, why, TaskVerdict.LIMIT)

    def is_measuring(self, situation: Situation) -> bool:
        """Return whether a thing is in hand that is measured to know whether goals are about it."""
        return bool(self._alike) and situation.model.held == self._alike

    def measure_on(self, turn: StageTurn) -> Decision:
        """Return the next command to measure the thing in hand; nothing when that is done, or not asked any more."""
        return self._measure([one for one in _alike(turn.stage.goals, turn) if one.name == self._alike], turn)

    def _measure(self, things: Sequence[Node], turn: StageTurn) -> Decision:
        """Return the next command to measure one of some things that goals may be about; nothing when that is done."""
        for thing in things:
            if push := self._push_to_measure(thing, turn):
                self._alike = thing.name
                return push
        self._alike = ""
        return nothing_to_do("nothing more can be measured of what may be meant")

    def _push_to_measure(self, node: Node, turn: StageTurn) -> Decision:
        """Return the next command to push an object by a part of a square, to measure it; nothing when that is done."""
        for pose in self._sizes.poses(node):
            why = f"the size of {node.name} is not sure, so it is measured"
            if begun := _begun(turn.executor.advise(node, {SIZE_TARGET: pose}, turn.situation), why, turn):
                return begun
        return nothing_to_do(f"no push tells more of the size of {node.name}")

    def probe(self, goals: Sequence[Fact], turn: StageTurn) -> Decision:
        """Return the next command to push the object of a goal where a passage may be wide enough."""
        return self.probed(self._refusals[goals[0]], turn)

    def probed(self, refusal: Refusal, turn: StageTurn) -> Decision:
        """Return the next command to push an object where a passage may be wide enough; nothing for no such place."""
        node, ends, refused = refusal
        if refused.refutation is None or not refused.unless() or not ends:
            return nothing_to_do(f"no passage may be wide enough for {node.name}")
        closest, why = refused.refutation.closest, f"the passage for {node.name} may be wider than it seems"
        assert closest.passage is not None
        while trial := self._passages.next(node, closest.passage, closest.missing, turn.situation.model):
            if trial.aside:
                poses = {f"{SHARE_TARGET}{n}": At(pose) for n, pose in enumerate(trial.aside)}
                return _begun(turn.executor.advise(node, poses, turn.situation), why, turn)
            if begun := _begun(turn.executor.try_through(node, ends, trial.opened, turn.situation), why, turn):
                return begun
        return nothing_to_do(f"the passage for {node.name} was probed")

    def gauge(self, goals: Sequence[Fact], turn: StageTurn) -> Decision:
        """Return the next command to walk against the sides of a passage; `impossible` where other passages count."""
        # Nothing where no passage can be measured, or its measure says nothing more.
        (goal,), refusal = goals, self._refusals[goals[0]]
        node, ends, first = refusal
        situation, outline = turn.situation, least_outline(node)
        model, least = situation.model, least_gap(outline)
        stays = outline.area if outline.minimum_rotated_rectangle.area - outline.area < NEGLIGIBLE_LENGTH**2 else 0.0
        shut = np.zeros_like(model.space)
        while refusal.refused.unless():
            if refusal.refused is not first and (probe := self.probed(refusal, turn)):
                return probe
            gap = self._gaps.gap_of(refusal.refused.passage, model)
            width = math.inf if gap is None else gap.width / math.cos(model.spread)
            if gap is None or width >= least:
                break
            exact = self._gaps.is_exact(gap)
            if exact is None:
                return self._walk_against(gap, node, turn)
            # Of a rectangle no more comes through a gap that is narrower than a corner whose longest side it is.
            shut, stays = shut | model.squares(gap.squares), stays - width**2 / 4
            if not exact or not lies_clear_of(shut, stays, node, ends, situation):
                break
            again = turn.executor.infeasibility(node, ends, situation.with_too_narrow(node.name, shut))
            if again is None or not again.proved:
                break
            refusal = refusal._replace(refused=again)
        if refusal.refused is first:
            return nothing_to_do("no passage is left to measure")
        # With the passages shut that were measured geometry names none.
        why = f"{turn.stage} cannot be attained: {first.reason()}"
        return self.noted(goal, refusal, impossible(why, *refusal.refused.proof()))

    def _walk_against(self, gap: PassageRow, node: Node, turn: StageTurn) -> Decision:
        """Return the next command to measure a gap, or to bring away what stands before it; nothing for no way."""
        model = turn.situation.model
        end = self._gaps.end_of_walk(gap, len(turn.track), model) if model.held is None else None
        if end is not None:
            return Decision(move_to(end, model), f"{GAP_REASON}; {turn.stage}")
        squares = model.squares(gap.squares)
        there = turn.look_if_reached([Subgoal(SubgoalKind.ATTAIN, np.flatnonzero(squares), GAP_REASON)])
        near = dilate(squares, ROOM_BEFORE)
        if there or not (near & model.mask(node.patch)).any():
            return there
        away = end_away_from(near, node, turn.situation)
        return bring_to_end(node, {ASIDE_TARGET: away}, turn, f"{GAP_REASON}, and {node.name} stands before it: ")


def _begun(advice: Advice, why: str, turn: StageTurn) -> Decision:
    """Return the next command of some advice, for a push with a reason of its own; nothing where there is none."""
    if isinstance(advice, Act):
        return turn.act(advice, why)
    return turn.prepare(advice)


def _alike(goals: Sequence[Fact], turn: StageTurn) -> list[Node]:
    """Return the things that may be what some goals are about and was not found, once their size is known better."""
    terms = {str(term) for goal in goals for term in goal.args}
    unfound = {term for term in terms if turn.situation.object_of(term) is None}
    like = {name for parameter, name in turn.reconciled.measurable if parameter in unfound}
    return [thing for thing in turn.situation.model.objects if thing.name in like]
