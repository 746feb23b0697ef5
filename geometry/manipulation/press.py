"""Pressing a body into a corner: the last push is made longer where whole squares leave it too far from the walls.

The robot may stand between body and wall. Then whole squares leave a square free, and the free distance left is less
than a square.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from itertools import product

from utak.geometry.manipulation.goals import GOAL_TOLERANCE, InCorner
from utak.geometry.manipulation.legs import Leg, only_pushes, round_motion, verified
from utak.geometry.manipulation.query import ManipulationQuery
from utak.geometry.motion.se2 import Motion, Rotate, Translate


def press_into_corner(query: ManipulationQuery, legs: Sequence[Leg] | None) -> Sequence[Leg] | None:
    """Return legs after which the body lies in the corner, made from legs that bring it nearly there."""
    goal, shape = query.goal, query.shape
    if legs is None or not isinstance(goal, InCorner) or not goal.press or not (legs or query.held):
        return legs
    legs = legs or [Leg(query.utak, (0, 0), (), query.grasp_offset(query.utak), taken=True)]
    end = verified(query.workspace, shape, legs)
    if end is None or goal.admits(end.bounds):
        return legs
    motions: list[Motion]
    last: Motion
    *motions, last = [Translate(0.0, 0.0), *legs[-1].motions]
    presses = [
        Translate(goal.sx * x, goal.sy * y)
        for x, y in product(*map(partial(_press_distances, goal), goal.gaps(end.bounds)))
    ]
    variants: list[list[Motion]] = [[*motions, last, press] for press in presses]
    if isinstance(last, Translate):
        variants = [[*motions, Translate(last.dx + press.dx, last.dy + press.dy)] for press in presses] + variants
    for variant in variants:
        longer = [
            *legs[:-1],
            replace(legs[-1], motions=tuple(round_motion(motion) for motion in variant if _is_motion(motion))),
        ]
        there = verified(query.workspace, shape, longer)
        if there is not None and goal.admits(there.bounds) and _last_leg_may_push(query, longer):
            return longer
    return legs


def _press_distances(goal: InCorner, gap: float) -> list[float]:
    """Return how far, in squares, to press on towards a wall at a distance `gap` (squares), in the order to try."""
    if gap <= goal.slack:
        return [0.0]
    return [gap, gap - goal.slack] if gap <= goal.slack + goal.press + GOAL_TOLERANCE else []


def _is_motion(motion: Motion) -> bool:
    """Return whether a motion is not null; every turn counts as one."""
    return isinstance(motion, Rotate) or any(motion)


def _last_leg_may_push(query: ManipulationQuery, legs: Sequence[Leg]) -> bool:
    """Return whether no motion of the last leg pulls, where pulling is forbidden; True where it is allowed."""
    if query.pull:
        return True
    shape = query.shape
    for leg in legs[:-1]:
        for motion in leg.motions:
            shape = motion.carry(shape)
    return only_pushes(shape, legs[-1].place, legs[-1].motions)
