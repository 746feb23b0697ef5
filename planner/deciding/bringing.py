"""Bringing an object to an end that no goal of its own asks for: out of the way, or to a spot of the task plan."""

from collections.abc import Mapping

from utak.geometry.manipulation.goals import End
from utak.kb.world.model import Node
from utak.planner.advice import Act
from utak.planner.deciding.stage_turn import StageTurn
from utak.planner.deciding.verification import look_for_more
from utak.planner.decision import Decision
from utak.planner.navigation.subgoals import Subgoal
from utak.planner.sights.frontiers import touch_viewpoint
from utak.planner.subgoal_kind import SubgoalKind


def bring_to_end(node: Node, ends: Mapping[str, End], turn: StageTurn, purpose: str = "") -> Decision | None:
    """Return the next command to bring an object to an end, or to find out what it is; None when there is none."""
    # What did not move is moved another way first, where one is left, also for no ends.
    if node.felt_first:
        touch = Subgoal(SubgoalKind.INSPECT, *touch_viewpoint(turn.situation.cost_maps, node))
        return turn.look_if_reached(touch)
    if node.polygon is None or node.vague:
        look = turn.look_if_reached(turn.verifier.next_look(node, turn.situation))
        if look is not None:
            return look
    if node.polygon is None:
        return None
    more = turn.look_if_reached(look_for_more(node, turn.situation))
    if more is not None:
        return more
    advice = turn.executor.advise(node, ends, turn.situation)
    if not isinstance(advice, Act):
        return turn.prepare(advice)
    if turn.closes_loop(advice.command):
        return None
    return turn.act(advice, f"{purpose}{advice.why}")


def another_way(node: Node, turn: StageTurn) -> Decision | None:
    """Return the next command to move an object that did not move in a way that was not tried; None for none."""
    return bring_to_end(node, {}, turn) if node.untried else None


def carry_on(node: Node, turn: StageTurn) -> Decision | None:
    """Return the next command of the plan under way for an object in hand."""
    act = turn.executor.continue_plan(node, turn.situation)
    if act is None or turn.closes_loop(act.command):
        return None
    return turn.act(act)
