"""Advice of the plan executor: a command to give, a square to walk to, or squares to see first.

The fourth answer, that nothing can be done, is planner.carrying.infeasibility.Infeasibility.
"""

from dataclasses import dataclass

from utak.geometry.kernels.arrays import XY
from utak.geometry.motion.se2 import Motion, Rotate, Translate
from utak.kb.body import Command, Push, Turn
from utak.kb.world.model import WorldModel
from utak.planner.decision import RobotStep
from utak.planner.question import Question
from utak.planner.screen.projection import SquareIndices
from utak.planner.sights.frontiers import Viewpoint


@dataclass(frozen=True)
class Act:
    """A command to give now."""

    command: Command  # what the body shall do, in the robot's own frame
    why: str  # the reason, in words
    # The same push in squares, map frame, when no plan asks for it; None for commands of a plan. The plan executor must
    # be told when such a command is given (PlanExecutor.depart).
    unplanned_push: Translate | None = None
    steps: tuple[RobotStep, ...] = ()  # the steps of the robot that it begins (planner.steps); () for its own alone
    question: Question | None = None  # what was given to planner/asp/deciding for it, where it was chosen there


@dataclass(frozen=True)
class Go:
    """A square to walk to."""

    square: SquareIndices  # one flat index (row * columns + column) into the view's arrays, (1,)
    place: XY  # the point (x, y) at which to halt, in squares, map frame
    why: str  # the reason, in words
    steps: tuple[RobotStep, ...] = ()  # the steps of the robot, that to the square first; () for that one alone


@dataclass(frozen=True)
class See:
    """Squares that must be seen before the way over them is relied upon."""

    # The squares from which they can be seen (flat indices on the arrays of the view), and the reason
    viewpoint: Viewpoint
    question: Question  # what was given to planner/asp/deciding until it was chosen
    steps: tuple[RobotStep, ...] = ()  # the steps of the robot that come after that


def command_of(motion: Motion, model: WorldModel) -> Command:
    """Return the command for a motion of the held object: a Turn for a Rotate, else a Push."""
    if isinstance(motion, Rotate):
        return Turn(motion.degrees)
    return Push(*model.frame.to_utak(motion.dx, motion.dy))


def unplanned_act(push: Translate, why: str, model: WorldModel) -> Act:
    """Return the act of a push that no plan asks for; its `unplanned_push` is that push."""
    return Act(command_of(push, model), why, push)
