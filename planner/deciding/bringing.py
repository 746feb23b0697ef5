"""Bringing an object to an end that no goal of its own asks for: out of the way, or to a spot of the task plan."""

from collections.abc import Mapping

from utak.geometry.manipulation.goals import End
from utak.kb.world.model import Node
from utak.planner.advice import Act
from utak.planner.carrying.preconditions import doubt_of_kind, doubts_of_thing
from utak.planner.deciding.stage_turn import StageTurn
from utak.planner.decision import Decision, nothing_to_do

ASIDE_TARGET = "aside"  # the end of a plan that moves an object out of the robot's way


def bring_to_end(node: Node, ends: Mapping[str, End], turn: StageTurn, purpose: str = "") -> Decision:
    """Return the next command to bring an object to an end, or to find out what it is; nothing when there is none."""
    # What did not move is moved another way first, where one is left, also for no ends.
    doubts = [*doubt_of_kind(node, turn.situation)]
    look = turn.make_sure(doubts or doubts_of_thing(node, (f"due({node.name})",), turn.situation))
    if look or node.polygon is None or node.felt_first:
        return look
    advice = turn.executor.advise(node, ends, turn.situation)
    if not isinstance(advice, Act):
        return turn.prepare(advice)
    return turn.act_anew(advice, f"{purpose}{advice.why}")


def another_way(node: Node, turn: StageTurn) -> Decision:
    """Return the next command to move an object that did not move in a way that was not tried; nothing for none."""
    return bring_to_end(node, {}, turn) if node.untried else nothing_to_do(f"{node.name} was tried in all ways")


def carry_on(node: Node, turn: StageTurn) -> Decision:
    """Return the next command of the plan under way for an object in hand; nothing where there is none."""
    return turn.act_anew(turn.executor.continue_plan(node, turn.situation))
