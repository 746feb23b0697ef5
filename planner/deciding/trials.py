"""Trials: what seems one thing may be several that touch, and what did not move one way may move another way.

A passage may be wider than it seems: the robot walks against its sides.
"""

import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from utak.geometry.cspace.bottleneck import least_gap
from utak.geometry.manipulation.goals import At, End
from utak.geometry.motion.se2 import Pose
from utak.kb.language.terms import Fact
from utak.kb.objects.movability import square_ways
from utak.kb.world.model import Node
from utak.planner.carrying.infeasibility import Infeasibility
from utak.planner.deciding.bringing import ASIDE_TARGET, another_way, bring_to_end, carry_on
from utak.planner.deciding.feeling import feel_rims, feeling_scope, walls_to_feel
from utak.planner.deciding.stage_turn import StageTurn
from utak.planner.decision import Decision, nothing_to_do
from utak.planner.goals.placement import NEGLIGIBLE_LENGTH, end_away_from, lies_clear_of
from utak.planner.navigation.subgoals import Subgoal
from utak.planner.screen.moves import move_to
from utak.planner.screen.projection import dilate
from utak.planner.sights.things import things_in_question, unfelt_rims
from utak.planner.situation import Situation
from utak.planner.skills.measure_gap import GapMeasurer, PassageRow
from utak.planner.skills.measure_size import least_outline
from utak.planner.subgoal_kind import SubgoalKind

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


def measure_gaps(
    gaps: GapMeasurer,
    refused: Infeasibility,
    node: Node,
    ends: Mapping[str, End],
    turn: StageTurn,
    try_passage: Callable[[Infeasibility, Node, Mapping[str, End], StageTurn], Decision],
) -> tuple[Infeasibility, Decision]:
    """Return a refusal that counts with passages measured too narrow, and the next command to try or measure one."""
    # An object is pushed against a passage before that is measured: in the squares of a wall the robot's place is less
    # sure, and then pushes by parts of a square are.
    situation, outline = turn.situation, least_outline(node)
    model, least = situation.model, least_gap(outline)
    stays = outline.area if outline.minimum_rotated_rectangle.area - outline.area < NEGLIGIBLE_LENGTH**2 else 0.0
    shut = np.zeros_like(model.space)
    while refused.unless():
        if trial := try_passage(refused, node, ends, turn):
            return refused, trial
        gap = gaps.gap_of(refused.passage, model)
        width = math.inf if gap is None else gap.width / math.cos(model.spread)
        if gap is None or width >= least:
            break
        exact = gaps.is_exact(gap)
        if exact is None:
            return refused, _measure(gap, gaps, node, turn)
        # No more of a rectangle comes through a gap that is narrower than it than a corner whose longest side it is.
        shut, stays = shut | model.squares(gap.squares), stays - width**2 / 4
        if not exact or not lies_clear_of(shut, stays, node, ends, situation):
            break
        again = turn.executor.infeasibility(node, ends, situation.with_too_narrow(node.name, shut))
        if again is None or not again.proved:
            break
        refused = again
    return refused, nothing_to_do("no passage is left to measure")


def step_back(gaps: GapMeasurer, turn: StageTurn) -> Decision:
    """Return the move of a robot that has walked against a side of a gap a little back from it."""
    model = turn.situation.model
    return Decision(move_to(gaps.step_back(len(turn.track), model), model), f"{GAP_REASON}; {turn.stage}")


def _measure(gap: PassageRow, gaps: GapMeasurer, node: Node, turn: StageTurn) -> Decision:
    """Return the next command to measure a gap, or to bring away what stands before it; nothing for no way there."""
    model = turn.situation.model
    end = gaps.end_of_walk(gap, len(turn.track), model) if model.held is None else None
    if end is not None:
        return Decision(move_to(end, model), f"{GAP_REASON}; {turn.stage}")
    squares = model.squares(gap.squares)
    there = turn.look_if_reached([Subgoal(SubgoalKind.ATTAIN, np.flatnonzero(squares), GAP_REASON)])
    near = dilate(squares, ROOM_BEFORE)
    if there or not (near & model.mask(node.patch)).any():
        return there
    away = end_away_from(near, node, turn.situation)
    return bring_to_end(node, {ASIDE_TARGET: away}, turn, f"{GAP_REASON}, and {node.name} stands before it: ")
