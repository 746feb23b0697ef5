"""Alignment: a first leg that turns a body until its sides lie along the axes, and pushes it onto the lattice.

A body at an angle covers more squares than it need. Aligned, it passes where its shape passes, and its place is known
for certain.
"""

import math
from collections.abc import Iterator
from itertools import product
from typing import Any

import numpy as np
import shapely

from utak.geometry.cspace.fewest_motions import longest_edge_tilt
from utak.geometry.kernels.arrays import XY
from utak.geometry.manipulation.grasps import grasp_candidates
from utak.geometry.manipulation.lattice_planner import plan_on_lattice
from utak.geometry.manipulation.legs import Leg, commands, direction_to_grasp, may_push, round_motion
from utak.geometry.manipulation.query import ManipulationQuery, join_legs, query_after
from utak.geometry.motion.se2 import Motion, Rotate, Translate

MIN_ALIGNMENT = 1e-6  # degrees or squares; rounding: less is no motion
MAX_ALIGNMENTS = 4  # first legs for which the rest is planned; convention, for time


def plan_aligned(query: ManipulationQuery) -> list[Leg] | None:
    """Return legs of which the first aligns the body and the others go by whole squares; None when none are found."""
    if _is_aligned(query.shape):
        return None
    best: list[Leg] | None = None
    for _, first in zip(range(MAX_ALIGNMENTS), _aligning_legs(query), strict=False):
        rest = plan_on_lattice(query_after(query, [first]))
        if rest is not None:
            legs = join_legs([first], rest)
            best = min([legs, best] if best else [legs], key=commands)
    return best


def _is_aligned(shape: Any) -> bool:
    """Return whether the longest side of a shape lies along an axis, and its first corner on whole squares."""
    tilt, corner = longest_edge_tilt(shape), shapely.get_coordinates(shape)[0]
    off = float(np.abs(np.round(corner) - corner).max())
    return max(off, min(abs(tilt), abs(90.0 - tilt))) <= MIN_ALIGNMENT


def _aligning_legs(query: ManipulationQuery) -> Iterator[Leg]:
    """Yield the legs that align the body, at most one for each grasp, those with short walks first."""
    tilt = longest_edge_tilt(query.shape)
    for candidate in grasp_candidates(query):
        relative = query.grasp_offset(candidate.place)
        square = direction_to_grasp(query.shape, candidate.place)
        if square is None and not candidate.taken:
            continue
        for degrees in sorted((-tilt, 90.0 - tilt), key=abs):
            motions = _aligning_motions(query, candidate.place, degrees)
            if motions:
                yield Leg(candidate.place, square or (0, 0), motions, relative, candidate.walk, candidate.taken)
                break


def _aligning_motions(query: ManipulationQuery, utak: XY, degrees: float) -> tuple[Motion, ...]:
    """Return the turn by `degrees` and the push that align the body; () when not free or nothing is to be done."""
    motions: list[Motion] = []
    shape = query.shape
    if MIN_ALIGNMENT < abs(degrees) < 90.0 - MIN_ALIGNMENT:
        motions.append(round_motion(Rotate(degrees, utak)))
        if not query.workspace.lets(shape, utak, motions[0]):
            return ()
        shape = motions[0].carry(shape)
    x, y = shapely.get_coordinates(shape)[0]
    across, up = (
        [v, v - math.copysign(1.0, v)] if abs(v) > MIN_ALIGNMENT else [0.0] for v in (round(x) - x, round(y) - y)
    )
    for dx, dy in sorted(product(across, up), key=lambda move: math.hypot(*move)):
        push = round_motion(Translate(float(dx), float(dy)))
        if math.hypot(dx, dy) < MIN_ALIGNMENT:
            return tuple(motions)
        if query.workspace.lets(shape, utak, push) and (query.pull or may_push(shape, utak, dx, dy)):
            return (*motions, push)
    return ()
