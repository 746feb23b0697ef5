"""From a route to the next command: the longest straight move along it that is safe.

A robot that only walks (WALKING_PACE) makes short moves, and so looks often.
One that carries objects (CARRYING_PACE) counts commands, and makes long moves.
"""

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from utak.geometry.kernels.arrays import XY, Bools, Square
from utak.geometry.raster.line_of_sight import straight
from utak.geometry.raster.winding import crossings_by_step
from utak.kb.body import Move
from utak.kb.localisation.hypotheses.walk_outcomes import GRID_LINE_TOLERANCE, snap_to_line
from utak.kb.perception.frame import turned
from utak.kb.world.model import WorldModel
from utak.planner.screen.projection import CostMaps, dilate
from utak.planner.screen.sweeps import line_sweep_is_free, sweep_is_free
from utak.planner.subgoal_kind import SubgoalKind

TIGHT_MOVE_LENGTH = 6  # squares up to which a move keeps no clearance, even while the orientation is uncertain (tuned)
ORIENTATION_TOLERANCE = math.radians(5)  # radians up to which the map frame's orientation counts as settled (tuned)
OFF_CENTRE_KINDS = (SubgoalKind.EXPLORE, SubgoalKind.INSPECT, SubgoalKind.SETTLE)  # may end off a square's centre
EDGE_OFFSET = 0.4618  # squares from a centre to a place just inside the edge of the same square (convention)
LEEWAY_TOLERANCE = 0.1  # squares by which the origin may still lie elsewhere before the robot tests it (tuned)
PLACE_TOLERANCE = 1e-6  # squares within which the robot is where a plan says: rounding only
COMMAND_DIGITS = 12  # decimals of a command
UNAMBIGUOUS_OFFSET = (0.0618, 0.0341)  # squares from a centre, from where no whole-degree turn leads to a grid line


def orientation_is_uncertain(model: WorldModel) -> bool:
    """Return whether the angle of the map frame may likely be wrong by more than ORIENTATION_TOLERANCE."""
    return model.likely_spread > ORIENTATION_TOLERANCE


def orientation_is_settled(model: WorldModel) -> bool:
    """Return whether the angle of the map frame is known within ORIENTATION_TOLERANCE beyond all doubt."""
    return model.spread <= ORIENTATION_TOLERANCE


class Pace(NamedTuple):
    """Limits on one straight move."""

    # The greatest length of a move in squares, by the kind of the subgoal (SubgoalKind)
    longest_by_kind: Mapping[str, int]
    # The greatest length in squares while the orientation of the map frame is uncertain, and with it where a move leads
    longest_uncertain: int
    # Whether a move crosses squares that are only believed to be free, right up to what is not settled. A move that is
    # stopped ends beside what stopped it, and that is mostly where the robot wants to be.
    bold: bool

    def most(self, kind: str, model: WorldModel) -> int:
        """Return the greatest length of a move now, in squares: the greater of its rows and its columns."""
        return (
            min(self.longest_by_kind[kind], self.longest_uncertain)
            if orientation_is_uncertain(model)
            else self.longest_by_kind[kind]
        )

    def passable(self, cost_maps: CostMaps, kind: str) -> Bools:
        """Return the squares that a move at this pace may cross, (rows, columns) bool, on the arrays of the view."""
        if not self.bold:
            return cost_maps.safe
        return cost_maps.approachable if kind == SubgoalKind.INSPECT else cost_maps.believed


_WALKING_LENGTHS: Mapping[str, int] = {
    SubgoalKind.ATTAIN: 48,
    SubgoalKind.INSPECT: 16,
    SubgoalKind.EXPLORE: 12,
    SubgoalKind.PASS: 8,
    SubgoalKind.SETTLE: 12,
    SubgoalKind.FEEL: 48,
}
WALKING_PACE = Pace(_WALKING_LENGTHS, 9, bold=False)  # of a robot that only walks (lengths tuned on random worlds)
CARRYING_PACE = Pace(
    {**_WALKING_LENGTHS, SubgoalKind.INSPECT: 48, SubgoalKind.EXPLORE: 48}, 48, bold=True
)  # of one that carries


def next_move(
    cost_maps: CostMaps,
    path: Sequence[Square],
    level: int,
    kind: str,
    pace: Pace = WALKING_PACE,
    off_centre: bool = True,
) -> Move:
    """Choose the longest straight move that stays on passable squares and in the class of a path."""
    # It ends at the next square where no longer move is allowed, even if that one is not passable.
    here, longest = path[0], pace.most(kind, cost_maps.model)
    passable, roomy = pace.passable(cost_maps, kind), None if pace.bold else _roomy(cost_maps)
    there = path[min(1, len(path) - 1)]
    blocked = ~(cost_maps.free(level) | passable)
    for number in range(len(path) - 1, 1, -1):
        square = path[number]
        far = max(abs(square[0] - here[0]), abs(square[1] - here[1]))
        free = far <= longest and sweep_is_free(passable, here, square) and _is_roomy(roomy, here, square)
        if free and _same_class(path[: number + 1], blocked):
            there = square
            break
    view, (dx, dy) = cost_maps.model.view, _end_offset(cost_maps, there, kind if off_centre else SubgoalKind.ATTAIN)
    place = view.west + there[0] + 0.5 + dx, view.south + there[1] + 0.5 + dy
    return move_to(place, cost_maps.model)


def one_move_squares(cost_maps: CostMaps, kind: str, candidates: Bools | None = None) -> Bools:
    """Compute the squares that one straight move at the pace CARRYING_PACE reaches from where the robot stands."""
    longest = CARRYING_PACE.most(kind, cost_maps.model)
    return straight(CARRYING_PACE.passable(cost_maps, kind), *cost_maps.here, longest, candidates)


def _roomy(cost_maps: CostMaps) -> Bools | None:
    """Return the safe squares with safe squares all around, (rows, columns) bool on the arrays of the view."""
    return ~dilate(~cost_maps.safe, 1) if orientation_is_uncertain(cost_maps.model) else None


def _is_roomy(roomy: Bools | None, here: Square, there: Square) -> bool:
    """Return whether a straight move between two squares (column, row) keeps enough room."""
    far = max(abs(there[0] - here[0]), abs(there[1] - here[1]))
    halfway = (here[0] + there[0]) // 2, (here[1] + there[1]) // 2
    return roomy is None or far <= TIGHT_MOVE_LENGTH or sweep_is_free(roomy, halfway, there)


def move_to(place: XY, model: WorldModel) -> Move:
    """Return the move from the robot's believed place to a point of the map frame, (x, y) in squares."""
    here = snap_to_line(model.place)
    east, north = model.frame.to_utak(place[0] - here[0], place[1] - here[1])
    return Move(round(east, COMMAND_DIGITS) + 0.0, round(north, COMMAND_DIGITS) + 0.0)


def _end_offset(cost_maps: CostMaps, square: Square, kind: str) -> tuple[float, float]:
    """Choose how far from the centre of a square a move into it ends, (x, y) in squares, map frame."""
    # While the orientation is uncertain, a move whose end some whole-degree turn would put on a grid line ends a little
    # off the centre. On a grid line it would be chance in which square the robot sees itself, which no hypothesis could
    # explain.
    model = cost_maps.model
    if orientation_is_uncertain(model):
        return UNAMBIGUOUS_OFFSET if _may_end_on_grid_line(model, square) else (0.0, 0.0)
    west, south, east, north = model.leeway
    test = tuple(
        EDGE_OFFSET if up > LEEWAY_TOLERANCE else -EDGE_OFFSET if -down > LEEWAY_TOLERANCE else 0.0
        for down, up in ((west, east), (south, north))
    )
    here = model.place_on_view
    there = (square[0] + 0.5 + test[0], square[1] + 0.5 + test[1])
    if kind not in OFF_CENTRE_KINDS or not line_sweep_is_free(cost_maps.safe, here, there):
        return (0.0, 0.0)
    return test[0], test[1]


def _may_end_on_grid_line(model: WorldModel, square: Square) -> bool:
    """Return whether a move to a square's centre, turned by some whole number of degrees, ends on a grid line."""
    x, y = model.view.west + square[0] + 0.5 - model.place[0], model.view.south + square[1] + 0.5 - model.place[1]
    ends = np.array([turned(x, y, degrees) for degrees in range(90)]) + model.place
    return bool((np.abs(ends % 1.0 - 0.5) > 0.5 - GRID_LINE_TOLERANCE).any())


def is_at(model: WorldModel, place: XY) -> bool:
    """Return whether the robot stands exactly at a point (x, y) of the map frame, in squares, but for rounding."""
    return math.dist(model.place, place) < PLACE_TOLERANCE


def halt_exactly_at(move: Move, place: XY, model: WorldModel) -> Move:
    """Return a move with its end moved to exactly `place`, if it leads into the square of `place`."""
    dx, dy = model.frame.to_map(move.east, move.north)
    if model.view.locate(model.place[0] + dx, model.place[1] + dy) != model.view.locate(*place):
        return move
    return move_to(place, model)


def _same_class(part: Sequence[Square], blocked: Bools) -> bool:
    """Return whether part of a path, (column, row), can be pulled straight without crossing a blocked square."""
    ring = np.array([*part, part[0]])
    (west, south), (east, north) = ring.min(axis=0), ring.max(axis=0)
    rows, columns = np.nonzero(blocked[south : north + 1, west : east + 1])
    centres = np.column_stack([columns + west, rows + south]).astype(float)
    return not len(centres) or not crossings_by_step(ring, centres).sum(axis=1).any()
