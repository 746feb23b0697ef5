"""Laying a body straight first: a turn that brings its sides along the axes, and a push that brings it to the lattice.

What lies askew covers more squares than it need. Laid straight it passes where its shape passes, and its place is known
for certain.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import numpy as np
import shapely

from geometry.ends import At, End, placed
from geometry.errand import Errand
from geometry.held import holds_about, slant
from geometry.legs import Leg, Point, grip_square, may_push, rounded
from geometry.rigid import Motion, Pose, Rotate, Translate, turned
from geometry.squarewise import carry_squarewise

LEAST = 1e-6  # degrees or squares: less is no motion
TRIES = 4  # holds with which the rest is planned


@dataclass(frozen=True)
class Straightened:
    """The leg that lays a body straight, and the errand that is then left."""

    leg: Leg
    degrees: float
    errand: Errand


def carry_straightened(errand: Errand, tries: int = TRIES) -> list[Leg] | None:
    """Legs of which the first lays the body straight and the others go by whole squares; None when none are found."""
    best: list[Leg] | None = None
    for _, first in zip(range(tries), _ways(errand), strict=False):
        rest = carry_squarewise(first.errand)
        if rest is not None:
            legs = [first.leg, *(replace(leg, hold=_turned(leg.hold, -first.degrees)) for leg in rest)]
            best = min([legs, best] if best else [legs], key=lambda told: sum(3 + len(leg.motions) for leg in told))
    return best


def _ways(errand: Errand) -> Iterator[Straightened]:
    """The ways to lay the body straight, those with short walks first."""
    askew = math.degrees(slant(errand.shape)) % 90.0
    middle = errand.shape.centroid
    for hold in sorted(holds_about(errand, errand.shape, errand.utak), key=lambda hold: (hold.walk, hold.place)):
        relative = (hold.place[0] - middle.x, hold.place[1] - middle.y)
        square = grip_square(errand.shape, hold.place)
        if square is None or errand.avoids(*relative):
            continue
        for degrees in sorted((-askew, 90.0 - askew), key=abs):
            motions = _straight(errand, hold.place, degrees)
            if motions:
                yield _after(errand, Leg(hold.place, square, motions, relative, hold.walk))
                break


def _straight(errand: Errand, utak: Point, degrees: float) -> tuple[Motion, ...]:
    """The turn and the push that lay the body straight; () when they are not free, or nothing is to be done."""
    motions: list[Motion] = []
    shape = errand.shape
    if LEAST < abs(degrees) < 90.0 - LEAST:
        motions.append(rounded(Rotate(degrees, utak)))
        if not errand.yard.lets(shape, utak, motions[0]):
            return ()
        shape = motions[0].carry(shape)
    x, y = shapely.get_coordinates(shape)[0]
    across, up = ([v, v - math.copysign(1.0, v)] if abs(v) > LEAST else [0.0] for v in (round(x) - x, round(y) - y))
    for dx, dy in sorted(product(across, up), key=lambda move: math.hypot(*move)):
        push = rounded(Translate(float(dx), float(dy)))
        if math.hypot(dx, dy) < LEAST:
            return tuple(motions)
        if errand.yard.lets(shape, utak, push) and (errand.pull or may_push(shape, utak, dx, dy)):
            return (*motions, push)
    return ()


def _after(errand: Errand, leg: Leg) -> Straightened:
    """What is left to be done after a first leg."""
    shape, utak, degrees = errand.shape, leg.place, 0.0
    for motion in leg.motions:
        shape = motion.carry(shape)
        utak = (utak[0] + motion.dx, utak[1] + motion.dy) if isinstance(motion, Translate) else utak
        degrees += motion.degrees if isinstance(motion, Rotate) else 0.0
    avoid = tuple(_turned(hold, degrees) for hold in errand.avoid)
    goal = _goal_after(errand.goal, errand.shape, shape, degrees)
    return Straightened(leg, degrees, replace(errand, shape=shape, utak=utak, goal=goal, avoid=avoid))


def _goal_after(goal: End, before: Any, after: Any, degrees: float) -> End:
    """The same goal for a shape that has been moved."""
    if not isinstance(goal, At):
        return goal
    there, here = placed(before, goal.pose).centroid, after.centroid
    return At(Pose(there.x - here.x, there.y - here.y, round(goal.pose.degrees - degrees, 7)))


def _turned(hold: Point, degrees: float) -> Point:
    """A hold in a frame turned by some degrees."""
    x, y = turned(np.array([hold]), degrees)[0]
    return float(x), float(y)
