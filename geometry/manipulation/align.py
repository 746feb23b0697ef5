"""Laying a body straight first: a turn that brings its sides along the axes, and a push that brings it to the lattice.

What lies askew covers more squares than it need. Laid straight it passes where its shape passes, and its place is known
for certain.
"""

import math
from collections.abc import Iterator
from itertools import product

import shapely

from geometry.cspace.fewest_motions import askew
from geometry.kernels.arrays import XY
from geometry.manipulation.grasps import holds_about
from geometry.manipulation.lattice_planner import carry_squarewise
from geometry.manipulation.legs import Leg, commands, grip_square, may_push, rounded
from geometry.manipulation.query import ManipulationQuery, after, joined
from geometry.motion.se2 import Motion, Rotate, Translate

LEAST = 1e-6  # degrees or squares: less is no motion
TRIES = 4  # holds with which the rest is planned


def carry_straightened(errand: ManipulationQuery, tries: int = TRIES) -> list[Leg] | None:
    """Legs of which the first lays the body straight and the others go by whole squares; None when none are found."""
    best: list[Leg] | None = None
    for _, first in zip(range(tries), _ways(errand), strict=False):
        rest = carry_squarewise(after(errand, [first]))
        if rest is not None:
            legs = joined([first], rest)
            best = min([legs, best] if best else [legs], key=commands)
    return best


def _ways(errand: ManipulationQuery) -> Iterator[Leg]:
    """The ways to lay the body straight, those with short walks first."""
    over = askew(errand.shape)
    for hold in holds_about(errand):
        relative = errand.hold_from(hold.place)
        square = grip_square(errand.shape, hold.place)
        if square is None and not hold.taken:
            continue
        for degrees in sorted((-over, 90.0 - over), key=abs):
            motions = _straight(errand, hold.place, degrees)
            if motions:
                yield Leg(hold.place, square or (0, 0), motions, relative, hold.walk, hold.taken)
                break


def _straight(errand: ManipulationQuery, utak: XY, degrees: float) -> tuple[Motion, ...]:
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
