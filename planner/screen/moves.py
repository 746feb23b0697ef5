"""From a way to the next command: a straight move, as far as is safe.

Who just walks wants short ways, and looks about himself often. Who carries things wants few commands.
"""

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from geometry.raster.line_of_sight import straight
from geometry.raster.winding import crossings
from kb.body import Command, Move
from kb.localisation.hypotheses.walk_outcomes import on_line
from kb.perception.frame import turned
from kb.world.model import WorldModel
from planner.screen.projection import CostMaps, grown
from planner.screen.sweeps import Square, clear, clear_line

NARROW = 6  # squares of a move for which no more room is wanted than the way itself takes, however the lattice lies
ASKEW = math.radians(5)  # by which the lattice may lie otherwise before he takes care where he halts
TESTING = ("explore", "inspect", "settle")  # aims that do not mind where in a square he halts
EDGE = 0.4618  # squares from a centre, not far from the line between two squares
LOOSE = 0.1  # squares by which he may have woken elsewhere in his square before he tries it
DIGITS = 12  # of a command
BETWEEN = 1e-3  # squares from the line between two squares that are on it
ASIDE = (0.0618, 0.0341)  # squares from a centre, where no turn by whole degrees leads to the line between two squares


def is_open(model: WorldModel) -> bool:
    """Is it open, by more than a few degrees, how the lattice lies? What is unlikely by all pictures is left out."""
    return model.likely_spread > ASKEW


def is_settled(model: WorldModel) -> bool:
    """Is it beyond doubt, but for a few degrees, how the lattice lies?"""
    return model.spread <= ASKEW


class Pace(NamedTuple):
    """How far one move leads at most, in rows and columns.

    longest : by the kind of its aim. unsure : while it is open how the lattice lies, and so where he goes.
    bold : whether it leads over squares that are only believed floor, right up to what is not settled. A move that is
    stopped ends right beside what stopped it, and that is mostly where he wants to be.
    """

    longest: Mapping[str, int]
    unsure: int
    bold: bool

    def most(self, kind: str, model: WorldModel) -> int:
        """Rows and columns of a move now."""
        return min(self.longest[kind], self.unsure) if is_open(model) else self.longest[kind]

    def ground(self, cost_maps: CostMaps, kind: str) -> NDArray[np.bool_]:
        """(rows, columns): the squares over which a move leads, by the kind of its aim."""
        if not self.bold:
            return cost_maps.safe
        return cost_maps.approached if kind == "inspect" else cost_maps.believed


STROLL = Pace({"attain": 48, "inspect": 16, "explore": 12, "pass": 8, "settle": 12}, 9, bold=False)
HURRY = Pace({**STROLL.longest, "inspect": 48, "explore": 48}, 48, bold=True)


def next_move(
    cost_maps: CostMaps,
    path: Sequence[Square],
    kind: str,
    about: tuple[float, float] | None = None,
    pace: Pace = STROLL,
) -> Move:
    """The longest straight move along a way that leads over the ground of his pace.

    While it is open how the lattice lies, the second half of a longer move that is not bold keeps a square clear of all
    others.

    path : edge-connected squares, the first is Utak's. kind : of the aim.
    about : a point (of the view's frame) about which the move must wind as the way does, when that matters.
    """
    here, most = path[0], pace.most(kind, cost_maps.model)
    ground, roomy = pace.ground(cost_maps, kind), None if pace.bold else _roomy(cost_maps)
    there = path[1]
    for number in range(len(path) - 1, 1, -1):
        square = path[number]
        far = max(abs(square[0] - here[0]), abs(square[1] - here[1]))
        free = far <= most and clear(ground, here, square) and _is_roomy(roomy, here, square)
        if free and _same_side(path[: number + 1], about):
            there = square
            break
    return move_to(cost_maps.model, there, _aside(cost_maps, there, kind if about is None else "attain"))


def one_move(cost_maps: CostMaps, kind: str, among: NDArray[np.bool_] | None = None) -> NDArray[np.bool_]:
    """(rows, columns): the squares to which one straight move in a hurry leads from where Utak stands.

    among : the squares that are asked about; None for all.
    """
    return straight(HURRY.ground(cost_maps, kind), *cost_maps.here, HURRY.most(kind, cost_maps.model), among)


def _roomy(cost_maps: CostMaps) -> NDArray[np.bool_] | None:
    """(rows, columns): the squares that longer moves end over; None when it is settled how the lattice lies."""
    return ~grown(~cost_maps.safe, 1) if is_open(cost_maps.model) else None


def _is_roomy(roomy: NDArray[np.bool_] | None, here: Square, there: Square) -> bool:
    """Does a move, if it is a longer one, keep a square clear of all others in its second half?"""
    far = max(abs(there[0] - here[0]), abs(there[1] - here[1]))
    return roomy is None or far <= NARROW or clear(roomy, _halfway(here, there), there)


def _halfway(here: Square, there: Square) -> Square:
    """The square halfway to another one."""
    return (here[0] + there[0]) // 2, (here[1] + there[1]) // 2


def move_to(model: WorldModel, square: Square, aside: tuple[float, float]) -> Move:
    """The move from where Utak believes himself to a square (column, row) of the view, aside from its centre."""
    x, y = model.view.west + square[0] + 0.5 + aside[0], model.view.south + square[1] + 0.5 + aside[1]
    return _straight_to((x, y), model)


def move_by(model: WorldModel, dx: float, dy: float) -> Move:
    """Return the move from where Utak believes himself by so many squares along the axes of the lattice."""
    return _straight_to((model.place[0] + dx, model.place[1] + dy), model)


def _straight_to(place: tuple[float, float], model: WorldModel) -> Move:
    """The move to a place (of the lattice)."""
    here = on_line(model.place)
    east, north = model.frame.to_utak(place[0] - here[0], place[1] - here[1])
    return Move(round(east, DIGITS) + 0.0, round(north, DIGITS) + 0.0)


def _aside(cost_maps: CostMaps, square: Square, kind: str) -> tuple[float, float]:
    """How far from the centre of a square he halts.

    As long as it is open within some degrees how the lattice lies, it is a little beside the centre where some turn by
    whole degrees would lead from there to the line between two squares: such halts, where it would be chance in which
    of them he sees himself, could never be explained. After that he halts, where it costs nothing, near to that line:
    if he woke elsewhere in his square than he thinks, he sees himself in the next one.
    """
    model = cost_maps.model
    if is_open(model):
        return ASIDE if _may_halt_between(model, square) else (0.0, 0.0)
    west, south, east, north = model.leeway
    test = tuple(EDGE if up > LOOSE else -EDGE if -down > LOOSE else 0.0 for down, up in ((west, east), (south, north)))
    here = model.place_on_view
    there = (square[0] + 0.5 + test[0], square[1] + 0.5 + test[1])
    if kind not in TESTING or not clear_line(cost_maps.safe, here, there):
        return (0.0, 0.0)
    return test[0], test[1]


def _may_halt_between(model: WorldModel, square: Square) -> bool:
    """Might the way to a centre end between two squares, did the lattice lie otherwise by whole degrees?"""
    x, y = model.view.west + square[0] + 0.5 - model.place[0], model.view.south + square[1] + 0.5 - model.place[1]
    ends = np.array([turned(x, y, degrees) for degrees in range(90)]) + model.place
    return bool((np.abs(ends % 1.0 - 0.5) > 0.5 - BETWEEN).any())


def halting(command: Command | None, place: tuple[float, float], model: WorldModel) -> Command | None:
    """A command that halts right at a place (of the lattice), if it is a move into the square of that place."""
    if not isinstance(command, Move):
        return command
    dx, dy = model.frame.to_lattice(command.east, command.north)
    if model.view.locate(model.place[0] + dx, model.place[1] + dy) != model.view.locate(*place):
        return command
    return _straight_to(place, model)


def _same_side(part: Sequence[Square], about: tuple[float, float] | None) -> bool:
    """May this part of the way be replaced by a straight line without passing a point on its other side?"""
    return about is None or crossings(np.array([*part, part[0]]) + 0.5, about) == 0
