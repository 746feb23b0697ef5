"""Navigation among movable obstacles (NAMO, Stilman and Kuffner 2005): what blocks the robot is moved aside.

It is asked only when nothing else is left to do, for an object that was moved no longer is where it was meant to be.
"""

from collections.abc import Iterable, Sequence

from geometry.manipulation.goals import End
from kb.language.terms import Fact
from kb.world.model import Node
from planner.deciding.bringing import bring_to_end
from planner.deciding.feeling import feel_rim, feel_walls, feeling_scope, walls_to_feel
from planner.deciding.obstacles import Obstacle, before_walls, hidden_in_walls, obstacles
from planner.deciding.tools import Tools
from planner.decision import Decision, TaskVerdict
from planner.goals.embedded import Supposition, suppose
from planner.goals.placement import POSSIBLE_OBJECT
from planner.situation import Situation
from planner.stages import Stage

ASIDE_TARGET = "aside"  # the end of a plan that moves an obstacle out of the robot's way


class ObstacleClearer:
    """Moves obstacles out of the robot's way, and remembers which one it is moving and what must stay meanwhile.

    An obstacle is an object that blocks the robot's way to some part of the floor.
    """

    def __init__(self) -> None:
        """Make a clearer that is moving nothing."""
        self._moving = ""
        self._supposed: Supposition | None = None  # how the object that is being moved is supposed to lie in a wall
        self._stays: frozenset[str] = frozenset()
        self._feeling = False  # whether the robot is feeling walls, because nothing else was left to do

    def continue_clearing(self, stage: Stage, situation: Situation, tools: Tools) -> Decision | None:
        """Return the next command for the obstacle that is being moved; None when there is none that blocks still.

        Also None when its command would close a loop: then it is no longer being moved. Feeling that was begun is gone
        on with first, until something is found or nothing is left to feel.

        A Decision holds the next command (in the robot's own frame) and its reason in words; or no command, but a
        verdict and its reason.

        Parameters
        ----------
        stage : of the task: the goals that shall hold now.
        situation : what is believed (world model, rooms, doors, corners, track).
        tools : executor, pursuer and verifier, with which the command is worked out.
        """
        node, held = situation.model.object(self._moving), situation.model.held
        if self._feeling and held is None:
            instead = self._feel_on(stage, situation, tools)
            if instead is not None:
                return instead
        if node is not None and held is None:
            instead = self._move_first(self._movable(self._stays, situation), stage, situation, tools, node.name)
            if instead is not None:
                return instead
        act = None
        if node is not None and held == node.name:
            last = self._supposed
            again = None if last is None else suppose(node, last.side, last.depth, situation)
            act = tools.executor.continue_plan(node, situation if again is None else again.situation)
        if act is None or tools.pursuer.closes_loop(situation.model, act.command):
            self._moving = ""
            return None
        return Decision(act.command, f"{act.why}; {stage}")

    def clear_before_verdict(
        self, decision: Decision, goals: Sequence[Fact], stage: Stage, situation: Situation, tools: Tools
    ) -> Decision:
        """Return a decision; in place of a verdict, the next command to move aside what blocks the robot.

        What the goals speak of stays where it is. While an obstacle is left, because it must stay or did not move, the
        verdict is `limit`, not `impossible`: nothing is proved of what lies behind it.

        A Decision holds the next command (in the robot's own frame) and its reason in words; or no command, but a
        verdict and its reason.

        Parameters
        ----------
        decision : what was decided towards the goals; one with a command is returned unchanged.
        goals : the goals that the decision is about.
        stage : of the task: the goals that shall hold now.
        situation : what is believed (world model, rooms, doors, corners, track).
        tools : executor, pursuer and verifier, with which the command is worked out.
        """
        if not decision.verdict:
            return decision
        self._stays = frozenset(situation.binding.get(str(term), "") for goal in goals for term in goal.args)
        movable = self._movable(self._stays, situation)
        instead = self._move_first(movable, stage, situation, tools)
        if instead is not None or decision.verdict != TaskVerdict.IMPOSSIBLE:
            return instead or decision
        decision = self._feel(decision, movable, stage, situation, tools)
        if not decision.verdict:
            return decision
        things = [node for node in situation.model.objects if node.confidence >= POSSIBLE_OBJECT]
        blocking = next((one.node.name for one in obstacles(things, situation)), "")
        why = f"{decision.why}; {blocking} blocks the robot's way, and was not moved aside"
        return Decision(None, why, TaskVerdict.LIMIT) if blocking else decision

    def open_walls(
        self, decision: Decision, goals: Sequence[Fact], stage: Stage, situation: Situation, tools: Tools
    ) -> Decision:
        """Return a decision; in place of `impossible`, the next command to feel walls, or to clear what fills them.

        It is for a verdict that is proved whatever objects are moved aside, as far as these were seen: only what may go
        on in walls is moved, and what stands before walls that were never felt.

        A Decision holds the next command (in the robot's own frame) and its reason in words; or no command, but a
        verdict and its reason.

        Parameters
        ----------
        decision : what was decided towards the goals; one that no open fact can overturn is returned unchanged.
        goals : the goals that the decision is about; what they speak of stays where it is.
        stage : of the task: the goals that shall hold now.
        situation : what is believed (world model, rooms, doors, corners, track).
        tools : executor, pursuer and verifier, with which the command is worked out.
        """
        if decision.verdict != TaskVerdict.IMPOSSIBLE or decision.unless is None:
            return decision
        self._stays = frozenset(situation.binding.get(str(term), "") for goal in goals for term in goal.args)
        movable = self._movable(self._stays, situation)
        hidden = hidden_in_walls(movable, situation, feeling_scope(stage, situation).parting)
        instead = self._move_first_of(hidden, stage, tools)
        return instead or self._feel(decision, movable, stage, situation, tools)

    def _feel(
        self, decision: Decision, movable: Sequence[Node], stage: Stage, situation: Situation, tools: Tools
    ) -> Decision:
        """Return a decision; in place of `impossible`, the next command to feel walls, or to move what hides them.

        A Decision holds the next command (in the robot's own frame) and its reason in words; or no command, but a
        verdict and its reason.

        Parameters
        ----------
        decision : what was decided.
        movable : the objects that may be moved.
        stage : of the task: the goals that shall hold now.
        situation : what is believed (world model, rooms, doors, corners, track).
        tools : executor, pursuer and verifier, with which the command is worked out.
        """
        if decision.verdict == TaskVerdict.IMPOSSIBLE and decision.unless is not None:
            felt = feel_walls(stage, situation, tools.pursuer)
            if felt is not None:
                self._feeling = True
                return felt
            hidden = before_walls(movable, situation, walls_to_feel(stage, situation))
            return self._move_first_of(hidden, stage, tools) or decision
        return decision

    def _feel_on(self, stage: Stage, situation: Situation, tools: Tools) -> Decision | None:
        """Return the next command to clear what was found in a wall, or to feel on; None when nothing is left.

        A Decision holds the next command (in the robot's own frame) and its reason in words; or no command, but a
        verdict and its reason.

        Parameters
        ----------
        stage : of the task: the goals that shall hold now.
        situation : what is believed (world model, rooms, doors, corners, track).
        tools : executor, pursuer and verifier, with which the command is worked out.
        """
        hidden = hidden_in_walls(
            self._movable(self._stays, situation), situation, feeling_scope(stage, situation).parting
        )
        found = self._move_first_of(hidden, stage, tools)
        felt = None if found is not None else feel_walls(stage, situation, tools.pursuer)
        self._feeling = felt is not None
        return found or felt

    def _movable(self, stays: frozenset[str], situation: Situation) -> list[Node]:
        """Return the objects that may be moved aside, in the order of the model; [] for none.

        Only those that are objects with at least POSSIBLE_OBJECT percent, and not known to be immovable.

        stays : the names of those that must stay where they are.
        situation : what is believed: world model, rooms, doors, corners and track.
        """
        things = (node for node in situation.model.objects if node.movable > 0 and node.confidence >= POSSIBLE_OBJECT)
        return [node for node in things if node.name not in stays]

    def _move_first(
        self, things: Sequence[Node], stage: Stage, situation: Situation, tools: Tools, name: str = ""
    ) -> Decision | None:
        """Return the next command to move aside the first object that blocks, and remember which it is; None for none.

        A Decision holds the next command (in the robot's own frame) and its reason in words; or no command, but a
        verdict and its reason.

        Parameters
        ----------
        things : the objects in question.
        stage : of the task: the goals that shall hold now.
        situation : what is believed (world model, rooms, doors, corners, track).
        tools : executor, pursuer and verifier, with which the command is worked out.
        name : only the object of that name is moved; "" for any of `things`.
        """
        walls, parting = walls_to_feel(stage, situation), feeling_scope(stage, situation).parting
        found = obstacles(things, situation, walls, parting)
        return self._move_first_of((one for one in found if name in ("", one.node.name)), stage, tools)

    def _move_first_of(self, found: Iterable[Obstacle], stage: Stage, tools: Tools) -> Decision | None:
        """Return the next command to move aside the first obstacle that can be, and remember it; None for none.

        A Decision holds the next command (in the robot's own frame) and its reason in words; or no command, but a
        verdict and its reason.

        Parameters
        ----------
        found : the obstacles, in the order in which they are tried.
        stage : of the task: the goals that shall hold now.
        tools : executor, pursuer and verifier, with which the command is worked out.
        """
        for one in found:
            instead = _move_aside(one.node, one.aside, stage, one.situation, tools)
            if instead is not None:
                self._moving, self._supposed = one.node.name, one.supposed
                return instead
        return None


def _move_aside(node: Node, aside: End, stage: Stage, situation: Situation, tools: Tools) -> Decision | None:
    """Return the next command to move an object aside, or to find out what it is; None when there is none.

    A Decision holds the next command (in the robot's own frame) and its reason in words; or no command, but a verdict
    and its reason.

    Parameters
    ----------
    node : the object.
    aside : where it shall lie, in squares, view frame.
    stage : of the task: the goals that shall hold now.
    situation : what is believed (world model, rooms, doors, corners, track).
    tools : executor, pursuer and verifier, with which the command is worked out.
    """
    rim = feel_rim(node, stage, situation, tools.pursuer)
    if rim is not None:
        return rim
    purpose = f"{node.name} blocks the robot's way: "
    return bring_to_end(node, ASIDE_TARGET, aside, stage, situation, tools, purpose)
