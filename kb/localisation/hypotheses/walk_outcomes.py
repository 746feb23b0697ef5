"""Walk outcomes: where a straight motion may have ended otherwise than commanded.

Utak is a point, so a contact stops it on a grid line. In the believed frame contacts are rare, for motions lead over
squares that are believed free. In a wrong frame they are common, and neither the contact nor the frame is explained
without the other. What the first observation after a motion leaves open a later one may tell, so motions are remembered
(kb.localisation.hypotheses.reestimation).
"""

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from utak.kb.localisation.hypotheses.frames import Hypothesis, Position
from utak.kb.objects.held_object import Square

MAX_WALK_SLIP = 2  # squares from the predicted end within which a slipped walk is looked for; tuned
LINE_DISTANCE = 1e-6  # squares from a grid line to a place right beside it: contacts of the physics are that exact
MIN_PASSED = 0.1  # squares of way through a square that tell that it was passed; less may be an error of the place
GRID_LINE_TOLERANCE = 1e-3  # squares from a grid line that count as on it (convention)
MAX_KEPT_WAYS = 1024  # ways whose squares are kept: bounds memory


class Crossing(NamedTuple):
    """A crossing of a grid line by a motion, and the square that is entered there, map frame."""

    # How the table is turned is unknown, so it may be either side.

    # The place LINE_DISTANCE (1e-6 squares) this side of the line, as the motion comes; (x, y) in squares
    before: Position
    after: Position  # the place LINE_DISTANCE beyond it
    entered: Square  # the square (column, row) beyond, that of `after`


class StraightMotion(NamedTuple):
    """A straight motion as it was commanded."""

    number: int  # of the observation after it; the first observation has the number 0
    shift: Position  # the commanded motion, (east, north) in squares, Utak's own frame
    hypotheses: tuple[Hypothesis, ...]  # the frame hypotheses before that observation
    in_hand: str | None = None  # the name of the object in hand; None when there was none


def blocked_ends(start: Position, shift: Position) -> tuple[Position, ...]:
    """Return where a motion may have been blocked: both sides of each grid line on the way, the last line first."""
    lines = reversed(line_crossings(start, shift))
    found = [place for crossing in lines for place in (crossing.after, crossing.before)]
    return (*found, start) if any(shift) else ()


def slipped_ends(place: Position) -> tuple[Position, ...]:
    """Return the places whole squares away from `place`, up to MAX_WALK_SLIP (2) in each axis, the nearest first."""
    reach = range(-MAX_WALK_SLIP, MAX_WALK_SLIP + 1)
    offsets = sorted((i * i + j * j, i, j) for i in reach for j in reach if i or j)
    return tuple((place[0] + i, place[1] + j) for _, i, j in offsets)


def line_crossings(start: Position, shift: Position) -> tuple[Crossing, ...]:
    """Return where a motion crosses grid lines, in the order of the way; empty where it crosses none."""
    found: list[tuple[float, int, Crossing]] = []
    signs = [math.copysign(LINE_DISTANCE, v) for v in shift]
    for axis in (0, 1):
        low, high = sorted((start[axis], start[axis] + shift[axis]))
        for line in range(math.floor(low) + 1, math.ceil(high)):
            part = (line - start[axis]) / shift[axis]
            across = start[1 - axis] + shift[1 - axis] * part
            other, when = round(across), round(part, 9)
            if (
                shift[1 - axis] and abs(across - other) < LINE_DISTANCE
            ):  # at a corner: still this side of the other line
                across = other - signs[1 - axis]
                if axis == 1:
                    found.append((when, 2, _crossing(line, other + signs[0], axis, signs[1])))
            found.append((when, axis, _crossing(line, across, axis, signs[axis])))
    return tuple(crossing for *_, crossing in sorted(found))


@lru_cache(MAX_KEPT_WAYS)
def squares_passed(start: Position, end: Position) -> tuple[Square, ...]:
    """Return the squares (column, row) that a straight way crosses by at least MIN_PASSED squares of its length."""
    way, begin = np.subtract(end, start), np.array(start)
    lines = (np.arange(np.floor(min(ab)) + 1, np.ceil(max(ab))) for ab in zip(start, end, strict=True))
    parts = [(line - begin[axis]) / way[axis] for axis, line in enumerate(lines) if way[axis]]
    cuts = np.unique(np.concatenate([[0.0, 1.0], *parts]))
    middles = begin + way * ((cuts[1:] + cuts[:-1]) / 2)[:, None]
    off_lines = (abs(middles - np.round(middles)) > GRID_LINE_TOLERANCE).all(axis=1)
    inside = off_lines & (np.diff(cuts) * math.hypot(*way) >= MIN_PASSED)
    return tuple((int(x), int(y)) for x, y in np.floor(middles[inside]))


def snap_to_line(place: Position) -> Position:
    """Return `place` with each coordinate within 2e-6 squares of a grid line moved onto it."""
    # A contact stopped the motion there, so the robot is on the line.
    x, y = (float(round(v)) if abs(v - round(v)) <= 2 * LINE_DISTANCE else v for v in place)
    return x, y


def snap_to_middle(place: Position) -> Position:
    """Return `place` with each coordinate within 2e-6 squares of the middle of a square moved onto it."""
    x, y = (math.floor(v) + 0.5 if abs(v - math.floor(v) - 0.5) <= 2 * LINE_DISTANCE else v for v in place)
    return x, y


def observation_places(place: Position) -> tuple[Position, ...]:
    """Return the places from which the observation at `place` may be made, one for each square that it touches."""
    columns, rows = (
        (v,) if abs(v - round(v)) > 2 * LINE_DISTANCE else (round(v) - LINE_DISTANCE, round(v) + LINE_DISTANCE)
        for v in place
    )
    return tuple((x, y) for x in columns for y in rows)


def entered_square(place: Position, towards: Position) -> Square | None:
    """Return the square (column, row) that a motion from a grid line at `place` towards a point enters, map frame."""
    # None off all grid lines: nothing stops a point there.
    if len(observation_places(place)) == 1:
        return None
    x, y = (a + math.copysign(3 * LINE_DISTANCE, b - a) if a != b else a for a, b in zip(place, towards, strict=True))
    return math.floor(x), math.floor(y)


def add(place: Position, shift: Position) -> Position:
    """Return the sum of a place and a shift of the same frame: (x, y) or (east, north) in squares."""
    return place[0] + shift[0], place[1] + shift[1]


def _crossing(line: int, across: float, axis: int, onward: float) -> Crossing:
    """Return the crossing of a grid line by a motion, map frame: the places right before and after it."""
    before, after = ((at, across) if axis == 0 else (across, at) for at in (line - onward, line + onward))
    return Crossing(before, after, (math.floor(after[0]), math.floor(after[1])))
