"""Where in his square Utak woke, told by what he turned.

A turn goes about him, so it leaves a thing elsewhere when he stands elsewhere in his square than he thinks. A turn that
was stopped tells of two things at once, of how far it went and of what it was about: both are sought together.
"""

import itertools
import math
from collections.abc import Sequence
from functools import cache
from typing import NamedTuple

import numpy as np
import shapely

from kb.localisation.hypotheses.carry_outcomes import length_of, part_way
from kb.localisation.hypotheses.contacts import near
from kb.localisation.hypotheses.frames import Box, FrameHypothesis, cells, exactly, points
from kb.localisation.hypotheses.what_if import Place, Surprise, WhatIf
from kb.perception.frame import Frame

COARSE = 0.5  # squares that a thing goes in parts of a turn that are tried first
CUTS = 4  # parts of either side of his square that are tried first
EIGHTS = (2, 2, 2)  # into which a part is cut
MOST_PARTS = 2048
# Parts that are held against a look in one go. It bounds the work of a command by a count: each costs one comparison
# of a look with the map. Nothing is given up where there are more: the larger parts stay, which are less exact.
FINER = 2  # times that parts are cut in half
UNLIKELIER = 10  # times that what may have stopped a thing is less likely than what is likeliest, at most
Span = tuple[float, float]


class Part(NamedTuple):
    """A part of a turn, from 0 to 1, and of his square, from west to east and from south to north."""

    turn: Span
    columns: Span
    rows: Span

    @property
    def origin(self) -> Place:
        """The middle of that part of his square."""
        return sum(self.columns) / 2, sum(self.rows) / 2

    @property
    def far(self) -> float:
        """Squares from there to its corners."""
        (west, east), (south, north) = self.columns, self.rows
        return math.hypot(east - west, north - south) / 2

    def cut(self, *times: int) -> "list[Part]":
        """It, each side cut so many times: of the turn, and of his square."""
        sides = [np.linspace(*side, n + 1).tolist() for side, n in zip(self, times, strict=True)]
        return [Part(*spans) for spans in itertools.product(*map(itertools.pairwise, sides))]


def pivoted(surprise: Surprise, simple: bool) -> WhatIf | None:
    """The point of his square at which he woke, and what came of a turn, so that nothing contradicts; None if none.

    The lattice is turned as it is believed to be. A turn went to its end, or as far as what is known to stand in its
    way let it go; else it ended anywhere. What is left are all points that do. simple : is the look explained if the
    motion ended early, the lattice being as believed?
    """
    where = _points(surprise)
    far = math.hypot(*cells(where)) / 2
    tried = (surprise.tried(point.frame, (point,), far=far, whether=True) for point in where)
    fitting = [one for one in tried if not one.misfits]
    if not fitting and not (simple and len(surprise.hypotheses) == 1):
        fitting = _halted(surprise, _room(where))
    return _middle(fitting) if fitting else None


def _points(surprise: Surprise) -> tuple[FrameHypothesis, ...]:
    """The points that are left; if there is but one, all of them that looks leave."""
    given = tuple(h for h in surprise.hypotheses if h.angle == surprise.frame.angle and h.is_point)
    return given if len(given) > 1 else points(surprise.frame, surprise.observations)


def _halted(surprise: Surprise, room: Box) -> list[WhatIf]:
    """What fits, if a turn of what is in his hand ended early; nothing, if there was none.

    Parts of his square, and of the turn, are cut smaller as long as nothing contradicts them, and they are not too
    many; larger ones leave more room for where the thing lies.
    """
    if surprise.degrees == 0.0:
        return []
    place, polygon, motion = surprise.begun(surprise.frame)
    length, (west, south, east, north) = length_of(place, polygon, motion), room
    parts = Part((0.0, 1.0), (west, east), (south, north)).cut(math.ceil(length / COARSE), CUTS, CUTS)
    for number in range(FINER + 1):
        if number and len(parts) * math.prod(EIGHTS) > MOST_PARTS:
            break
        if number:
            parts = [cut for part in parts for cut in part.cut(*EIGHTS)]
        tried = [(part, _ended(surprise, part, length)) for part in parts]
        fitting = [(part, one) for part, one in tried if not one.misfits]
        parts = [part for part, _ in fitting]
    return _stoppable(surprise, fitting, length)


def _ended(surprise: Surprise, part: Part, length: float) -> WhatIf:
    """What contradicts that he woke in a part of his square, and that a turn ended in a part of it."""
    frame = Frame(surprise.frame.angle, part.origin)
    refused = surprise.refused(frame, (exactly(frame),))
    if refused is not None:
        return refused
    place, polygon, motion = surprise.begun(frame)
    outcome = part_way(place, polygon, motion, sum(part.turn) / 2)
    return surprise.judged(frame, (exactly(frame),), outcome, _slack(part, length), part.far, whether=True)


def _stoppable(surprise: Surprise, fitting: Sequence[tuple[Part, WhatIf]], length: float) -> list[WhatIf]:
    """Of turns that ended early those that something stopped about there, the likelier, ended where it did.

    All, when nothing is known that may have stopped any.
    """
    stopped, stops = [], cache(lambda frame: surprise.hindrances.stops(*surprise.begun(frame)))
    for part, one in fitting:
        place, polygon, motion = surprise.begun(one.frame)
        stop = near(stops(one.frame), place, polygon, motion, sum(part.turn) / 2)
        if stop is not None:
            there = part_way(place, polygon, motion, stop.part, stop.against)
            judged = surprise.judged(one.frame, one.hypotheses, there, _slack(part, length), part.far, whether=True)
            if not judged.misfits:
                stopped.append((stop.chance, judged))
    best = max((chance for chance, _ in stopped), default=0.0)
    return [one for chance, one in stopped if chance >= best / UNLIKELIER] or [one for _, one in fitting]


def _slack(part: Part, length: float) -> float:
    """Squares by which a thing may lie otherwise than in the middle of a part of a turn. length : of all of it."""
    begin, end = part.turn
    return length * (end - begin) / 2


def _room(where: Sequence[FrameHypothesis]) -> Box:
    """The box about some points of a grid at which he may have woken, each of which stands for a cell of it."""
    corners, half = np.array([point.box for point in where]), np.array(cells(where)) / 2
    west, south = np.maximum(corners[:, :2].min(0) - half, 0.0).tolist()
    east, north = np.minimum(corners[:, 2:].max(0) + half, 1.0).tolist()
    return west, south, east, north


def _middle(fitting: Sequence[WhatIf]) -> WhatIf:
    """Of what fits that where Utak woke amid where he may have, and the thing in hand lies amid where it may.

    All points are left.
    """
    fits = np.array([[one.frame.origin, *_corners(one)] for one in fitting])
    nearest = int(np.linalg.norm(fits - fits.mean(0), axis=2).max(1).argmin())
    left = dict.fromkeys(hypothesis for one in fitting for hypothesis in one.hypotheses)
    return fitting[nearest]._replace(hypotheses=tuple(left))


def _corners(one: WhatIf) -> list[Place]:
    """The corners of the thing in hand, if there is one."""
    if one.outcome is None:
        return []
    return [(float(x), float(y)) for x, y in shapely.get_coordinates(one.outcome.polygon)]
