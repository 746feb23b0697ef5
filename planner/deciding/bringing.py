"""Bringing an object to an end that no goal of its own asks for: out of the way, or to a spot of the task plan."""

from geometry.manipulation.goals import End
from kb.world.model import Node
from planner.advice import Act
from planner.deciding.tools import Tools
from planner.deciding.verification import look_for_more
from planner.decision import Decision
from planner.goals.placement import CERTAIN_OBJECT
from planner.navigation.subgoals import Subgoal
from planner.sights.frontiers import touch_viewpoint
from planner.situation import Situation
from planner.stages import Stage
from planner.subgoal_kind import SubgoalKind


def bring_to_end(
    node: Node, name: str, end: End, stage: Stage, situation: Situation, tools: Tools, purpose: str = ""
) -> Decision | None:
    """Return the next command to bring an object to an end, or to find out what it is; None when there is none.

    Parameters
    ----------
    node : the object.
    name : the name of the end.
    end : where it shall lie, in squares, view frame.
    stage : of the task: the goals that shall hold now.
    situation : what is believed (world model, rooms, doors, corners, track).
    tools : executor, pursuer and verifier, with which the command is worked out.
    purpose : words before the reason of a command for the object itself; "" for none.
    """
    if node.confidence < CERTAIN_OBJECT:
        touch = Subgoal(SubgoalKind.INSPECT, *touch_viewpoint(situation.cost_maps, node))
        look = tools.pursuer.pursue_look(touch, stage, situation)
        return None if look is None or look.command is None else look
    if node.polygon is None or node.vague:
        look = tools.pursuer.pursue_look(tools.verifier.next_look(node, situation), stage, situation)
        if look is not None and look.command is not None:
            return look
    if node.polygon is None:
        return None
    more = tools.pursuer.pursue_look(look_for_more(node, situation), stage, situation)
    if more is not None and more.command is not None:
        return more
    tools.executor.drop_other_plan(node.name)
    advice = tools.executor.advise(node, {name: end}, situation)
    if not isinstance(advice, Act):
        return tools.pursuer.prepare(advice, stage, situation)
    if tools.pursuer.closes_loop(situation.model, advice.command):
        return None
    return Decision(advice.command, f"{purpose}{advice.why}; {stage}")
