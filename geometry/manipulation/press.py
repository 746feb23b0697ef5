"""Pressing a body into a corner: the last push is made longer where whole squares leave it too far from the walls.

Utak may stand between body and wall: then whole squares leave a square free, and what he can still go is less than one.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from itertools import product

from geometry.manipulation.goals import CLOSE, InCorner
from geometry.manipulation.legs import Leg, only_pushes, rounded, verified
from geometry.manipulation.query import ManipulationQuery
from geometry.motion.se2 import Motion, Rotate, Translate


def pressed(errand: ManipulationQuery, legs: Sequence[Leg] | None) -> Sequence[Leg] | None:
    """Legs after which the body lies in a corner, of such as bring it nearly there; the same where that is not free.

    The last push is made longer, or else another one is made.
    """
    goal, shape = errand.goal, errand.shape
    if legs is None or not isinstance(goal, InCorner) or not goal.press or not (legs or errand.held):
        return legs
    legs = legs or [Leg(errand.utak, (0, 0), (), errand.hold_from(errand.utak), taken=True)]
    end = verified(errand.yard, shape, legs)
    if end is None or goal.admits(end.bounds):
        return legs
    motions: list[Motion]
    last: Motion
    *motions, last = [Translate(0.0, 0.0), *legs[-1].motions]
    presses = [
        Translate(goal.sx * x, goal.sy * y) for x, y in product(*map(partial(_steps, goal), goal.gaps(end.bounds)))
    ]
    ways: list[list[Motion]] = [[*motions, last, press] for press in presses]
    if isinstance(last, Translate):
        ways = [[*motions, Translate(last.dx + press.dx, last.dy + press.dy)] for press in presses] + ways
    for way in ways:
        longer = [*legs[:-1], replace(legs[-1], motions=tuple(rounded(motion) for motion in way if _moves(motion)))]
        there = verified(errand.yard, shape, longer)
        if there is not None and goal.admits(there.bounds) and _may(errand, longer):
            return longer
    return legs


def _steps(goal: InCorner, gap: float) -> list[float]:
    """How far to press on towards a wall that is so far away: up to it, or else as far as must be."""
    if gap <= goal.slack:
        return [0.0]
    return [gap, gap - goal.slack] if gap <= goal.slack + goal.press + CLOSE else []


def _moves(motion: Motion) -> bool:
    """Whether a motion is one at all."""
    return isinstance(motion, Rotate) or any(motion)


def _may(errand: ManipulationQuery, legs: Sequence[Leg]) -> bool:
    """Whether no push of the last leg goes backwards where that is forbidden."""
    if errand.pull:
        return True
    shape = errand.shape
    for leg in legs[:-1]:
        for motion in leg.motions:
            shape = motion.carry(shape)
    return only_pushes(shape, legs[-1].place, legs[-1].motions)
