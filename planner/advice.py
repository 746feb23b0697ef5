"""What the plan executor advises: a command to give, a square to walk to, or squares to see first.

The fourth answer, that nothing can be done, is planner.carrying.infeasibility.Infeasibility.
"""

from dataclasses import dataclass

from geometry.kernels.arrays import XY
from geometry.motion.se2 import Translate
from kb.body import Command
from planner.screen.projection import Squares
from planner.sights.frontiers import Viewpoint


@dataclass(frozen=True)
class Act:
    """A command to give now.

    Attributes
    ----------
    command : what the body shall do.
    why : the reason, in words.
    unplanned_push : the same push in squares, map frame, when no plan asks for it; None for commands of a plan. The
        plan executor must be told when such a command is given (PlanExecutor.depart).
    """

    command: Command
    why: str
    unplanned_push: Translate | None = None


@dataclass(frozen=True)
class Go:
    """A square to walk to.

    Attributes
    ----------
    square : one flat index into the view's arrays.
    place : the point (x, y) at which to halt, in squares, map frame.
    why : the reason, in words.
    """

    square: Squares
    place: XY
    why: str


@dataclass(frozen=True)
class See:
    """Squares that must be seen before the way over them is relied upon.

    Attributes
    ----------
    viewpoint : the squares from which they can be seen, and the reason.
    """

    viewpoint: Viewpoint
