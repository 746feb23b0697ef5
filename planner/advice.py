"""What an executor of plans advises: a command to give, a square to walk to, or squares to see first."""

from dataclasses import dataclass

from geometry.kernels.arrays import XY
from geometry.motion.se2 import Translate
from kb.body import Command
from planner.screen.projection import Squares
from planner.sights.frontiers import Viewpoint


@dataclass(frozen=True)
class Act:
    """A command to give now. departs : the push that it is, when no plan asks for it (Carrier.depart)."""

    command: Command
    why: str
    departs: Translate | None = None


@dataclass(frozen=True)
class Go:
    """A square to walk to (a flat index on the view's arrays). place : its middle, on the lattice, where to halt."""

    square: Squares
    place: XY
    why: str


@dataclass(frozen=True)
class See:
    """Squares that must be seen before the way over them is relied upon."""

    viewpoint: Viewpoint
