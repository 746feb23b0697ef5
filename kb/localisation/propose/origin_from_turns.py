"""Origin estimation: where in the square of waking the origin of the frame lies, as turned objects tell it.

A turn goes about Utak, so it leaves an object elsewhere when Utak is elsewhere in the square than believed. A turn that
was blocked tells two things at once, how far it went and what it was about. Both are sought together, by subdivision of
the cells of a grid over the turn and the square.
"""

import itertools
import math
from collections.abc import Sequence
from functools import cache
from typing import NamedTuple

import numpy as np
import shapely

from utak.geometry.motion.se2 import Rotate
from utak.kb.localisation.hypotheses.carry_outcomes import motion_length, partial_outcome
from utak.kb.localisation.hypotheses.contacts import likeliest_contact_near
from utak.kb.localisation.hypotheses.explanation import Explanation
from utak.kb.localisation.hypotheses.frames import (
    Hypothesis,
    OriginBox,
    Position,
    exact_hypothesis,
    grid_cell_size,
    origin_grid,
)
from utak.kb.localisation.known.situation import ObservedSituation
from utak.kb.perception.frame import Frame

COARSE_ARC = 0.5  # squares that the outermost point of an object goes in one coarse cell of a turn; tuned
COARSE_CUTS = 4  # coarse cells along either side of the square; tuned
SUBDIVISION = (2, 2, 2)  # parts into which a cell is cut: of the turn, west to east, south to north
MAX_COMPARED_CELLS = 2048
# Cells that are compared with an observation in one go. It bounds the work of a command by a count: each costs one
# comparison of an observation with the map. Nothing is given up where there are more: the larger cells stay, which are
# less exact.
MAX_SUBDIVISIONS = 2  # times that cells are cut; tuned
MAX_CHANCE_RATIO = 10  # of the likeliest contact to one that is kept; tuned
Interval = tuple[float, float]


class TurnOriginCell(NamedTuple):
    """A cell of a grid over the ends of a turn and the origins of a frame."""

    turn: Interval  # from and to which fraction of the turn, 0 to 1
    columns: Interval  # west and east bound of the origin in the square of waking, in squares, map frame, 0 to 1
    rows: Interval  # its south and north bound, likewise

    @property
    def origin(self) -> Position:
        """Return the origin in the middle of the cell, (x, y) in squares, map frame."""
        return sum(self.columns) / 2, sum(self.rows) / 2

    @property
    def radius(self) -> float:
        """Return the greatest distance of an origin of the cell from its middle, in squares."""
        (west, east), (south, north) = self.columns, self.rows
        return math.hypot(east - west, north - south) / 2

    def cut(self, *times: int) -> "list[TurnOriginCell]":
        """Return the parts of the cell, its sides cut into so many equal parts: the product of `times` cells."""
        sides = [np.linspace(*side, n + 1).tolist() for side, n in zip(self, times, strict=True)]
        return [TurnOriginCell(*spans) for spans in itertools.product(*map(itertools.pairwise, sides))]


def origin_from_turn(situation: ObservedSituation, simple: bool) -> Explanation | None:
    """Return the origin, with the outcome of a turn, so that nothing contradicts them; None when there is none."""
    points = _origins_left(situation)
    error = math.hypot(*grid_cell_size(points)) / 2
    tried = (situation.by_frame(point.frame, (point,), origin_error=error) for point in points)
    fitting = [one for one in tried if one is not None]
    if not fitting and not (simple and len(situation.state.frames) == 1):
        fitting = _blocked_turns(situation, _bounds(points))
    return _middle(fitting) if fitting else None


def _origins_left(situation: ObservedSituation) -> tuple[Hypothesis, ...]:
    """Return the exact origins that are left; if fewer than two are, a grid of all that observations leave."""
    given = tuple(h for h in situation.state.frames if h.angle == situation.state.frame.angle and h.is_point)
    return given if len(given) > 1 else origin_grid(situation.state.frame, situation.state.observations)


def _blocked_turns(situation: ObservedSituation, bounds: OriginBox) -> list[Explanation]:
    """Return what fits if a turn of the held object ended early; [] if there was no turn, or if nothing fits."""
    if not situation.carries or not isinstance(situation.motion, Rotate):
        return []
    place, polygon, motion = situation.motion_in(situation.state.frame)
    length, (west, south, east, north) = motion_length(place, polygon, motion), bounds
    coarse = TurnOriginCell((0.0, 1.0), (west, east), (south, north))
    cells = coarse.cut(math.ceil(length / COARSE_ARC), COARSE_CUTS, COARSE_CUTS)
    for number in range(MAX_SUBDIVISIONS + 1):
        if number and len(cells) * math.prod(SUBDIVISION) > MAX_COMPARED_CELLS:
            break
        if number:
            cells = [part for cell in cells for part in cell.cut(*SUBDIVISION)]
        tried = [(cell, _evaluate_cell(situation, cell, length)) for cell in cells]
        fitting = [(cell, one) for cell, one in tried if one is not None]
        cells = [cell for cell, _ in fitting]
    return _at_contacts(situation, fitting, length)


def _evaluate_cell(situation: ObservedSituation, cell: TurnOriginCell, length: float) -> Explanation | None:
    """Return the explanation by an origin and an end of the turn in a cell; None where something contradicts it."""
    frame = Frame(situation.state.frame.angle, cell.origin)
    if situation.remapped(frame).residual:
        return None
    place, polygon, motion = situation.motion_in(frame)
    outcome = partial_outcome(place, polygon, motion, sum(cell.turn) / 2)
    left, slack = (exact_hypothesis(frame),), _cell_slack(cell, length)
    return situation.by_outcome(frame, left, outcome, slack, cell.radius)


def _at_contacts(
    situation: ObservedSituation, fitting: Sequence[tuple[TurnOriginCell, Explanation]], length: float
) -> list[Explanation]:
    """Return those turns that ended near a likely contact, ended at the contact; all as they are when none has one."""
    contacts = cache(lambda frame: situation.obstructions.contacts(*situation.motion_in(frame)))
    stopped = []
    for cell, one in fitting:
        place, polygon, motion = situation.motion_in(one.frame)
        contact = likeliest_contact_near(contacts(one.frame), place, polygon, motion, sum(cell.turn) / 2)
        if contact is not None:
            there = partial_outcome(place, polygon, motion, contact.fraction, contact.squares)
            slack = _cell_slack(cell, length)
            judged = situation.by_outcome(one.frame, one.hypotheses, there, slack, cell.radius)
            if judged is not None:
                stopped.append((contact.chance, judged))
    best = max((chance for chance, _ in stopped), default=0.0)
    likely = [one for chance, one in stopped if chance >= best / MAX_CHANCE_RATIO]
    return likely or [one for _, one in fitting]


def _cell_slack(cell: TurnOriginCell, length: float) -> float:
    """Return how far an object may lie from where the middle of a cell leaves it, in squares."""
    begin, end = cell.turn
    return length * (end - begin) / 2


def _bounds(points: Sequence[Hypothesis]) -> OriginBox:
    """Return the bounds of the cells for which some points of an origin grid stand: (west, south, east, north)."""
    corners, half = np.array([point.box for point in points]), np.array(grid_cell_size(points)) / 2
    west, south = np.maximum(corners[:, :2].min(0) - half, 0.0).tolist()
    east, north = np.minimum(corners[:, 2:].max(0) + half, 1.0).tolist()
    return west, south, east, north


def _middle(fitting: Sequence[Explanation]) -> Explanation:
    """Return the one whose origin and object lie nearest to the mean of all; the hypotheses of all are left."""
    fits = np.array([[one.frame.origin, *_object_corners(one)] for one in fitting])
    nearest = int(np.linalg.norm(fits - fits.mean(0), axis=2).max(1).argmin())
    left = dict.fromkeys(hypothesis for one in fitting for hypothesis in one.hypotheses)
    return fitting[nearest]._replace(hypotheses=tuple(left))


def _object_corners(one: Explanation) -> list[Position]:
    """Return the corners of the object in hand, (x, y) in squares, map frame of its frame; [] when there is none."""
    if one.outcome is None:
        return []
    return [(float(x), float(y)) for x, y in shapely.get_coordinates(one.outcome.polygon)]
