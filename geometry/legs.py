"""Legs of carrying: Utak walks to a place, takes the body, pushes and turns it, lets go. Nodes of a search made legs.

# Strategy: the search pushes by steps along eight directions. Of the places that a push passes on the board as few as
# can be are kept, those that see each other straight (exact first contact, with the margins wished for).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import shapely

from geometry.digital import areas
from geometry.rigid import Motion, Rotate, Translate
from geometry.stencil import DIRECTIONS, Floats, Ints
from geometry.yard import Yard, broad

Point = tuple[float, float]
STOPS = 40  # of a push that are looked at, or all where it turns
NUMBERS = 9  # digits that commands are given with


@dataclass(frozen=True)
class Leg:
    """What Utak does with the body from taking it to letting go.

    Attributes
    ----------
    place : (x, y) where he stands to take it, the middle of a square, table frame.
    direction_square : (columns, rows) from his own square to the one of the body that he takes, each -1, 0 or 1.
    motions : Translate (push) and Rotate (turn about where he then is), each free by exact first contact.
    hold : (x, y) his place relative to the body's centroid, seen in the frame of the body as it lay when the plan was
        asked for: if the body were turned back to how it lay then. To be given as `avoid` when the grasp fails.
    walk : squares to walk to get to the place, along rows and columns (an estimate).
    """

    place: Point
    direction_square: tuple[int, int]
    motions: tuple[Motion, ...]
    hold: Point = (0.0, 0.0)
    walk: int = 0


def grip_square(shape: Any, place: Point) -> tuple[int, int] | None:
    """Which of the eight squares about Utak's own the body covers most, a straight one first; None when none."""
    column, row = math.floor(place[0]) - 1, math.floor(place[1]) - 1
    near = shapely.transform(shape, lambda p: p - np.array([column, row]))
    covered = areas(near, 3, 3)
    best = max(DIRECTIONS, key=lambda d: (round(float(covered[d[1] + 1, d[0] + 1]), 6), d[0] * d[1] == 0))
    return best if covered[best[1] + 1, best[0] + 1] > 1e-9 else None


def rounded(motion: Motion) -> Motion:
    """A motion with its numbers as they will be commanded."""
    if isinstance(motion, Translate):
        return Translate(round(motion.dx, NUMBERS) + 0.0, round(motion.dy, NUMBERS) + 0.0)
    return Rotate(round(motion.degrees, NUMBERS) + 0.0, motion.about)


def may_push(shape: Any, utak: Point, dx: float, dy: float) -> bool:
    """Whether a push leads away from Utak towards the body: it has a component along the line to its centroid."""
    return bool(dx * (shape.centroid.x - utak[0]) + dy * (shape.centroid.y - utak[1]) > 1e-9)


def straight(yard: Yard, shape: Any, utak: Point, stops: Floats, corners: Ints, margin: float, pull: bool) -> list[int]:
    """Of the stops (n, 2) of a push those to keep so that it has the fewest straight pieces, then the shortest.

    stops : places of Utak, the first where he is. corners : of the stops, those where the push that is known turns.
    """
    if len(corners) <= 2:
        return list(corners)
    some = np.union1d(corners, np.arange(0, len(stops), math.ceil(len(stops) / STOPS)))
    if len(some) < len(stops):
        return [
            int(some[n]) for n in straight(yard, shape, utak, stops[some], np.searchsorted(some, corners), margin, pull)
        ]
    known = {(int(a), int(b)) for a, b in pairwise(corners)}
    best: list[tuple[int, float, int]] = [(0, 0.0, -1)] + [(len(stops), math.inf, -1)] * (len(stops) - 1)
    body = broad(shape, utak, margin)
    for i in range(len(stops) - 1):
        vectors = stops[i + 1 :] - stops[i]
        free = yard.far(body.after(Translate(*(stops[i] - stops[0]))), vectors)
        for n, (dx, dy) in enumerate(vectors.tolist()):
            j = i + 1 + n
            if (i, j) in known or (free[n] and (pull or may_push(shape, utak, dx, dy))):
                told = (best[i][0] + 1, best[i][1] + math.hypot(dx, dy), i)
                best[j] = min(best[j], told)
    kept, at = [], len(stops) - 1
    while at >= 0:
        kept.append(at)
        at = best[at][2]
    return kept[::-1]


def verified(yard: Yard, shape: Any, legs: Sequence[Leg]) -> Any:
    """The shape after all legs; None when one of the motions is not free or a grasp reaches nothing."""
    for leg in legs:
        at = leg.place
        if grip_square(shape, at) is None:
            return None
        for motion in leg.motions:
            if not yard.lets(shape, at, motion):
                return None
            shape = motion.carry(shape)
            if isinstance(motion, Translate):
                at = (at[0] + motion.dx, at[1] + motion.dy)
    return shape
