"""Which angles of the lattice are still possible, judged by all looks so far.

Under a wrong angle two looks, or two fields of one look, claim of one square that it is free and that it is occupied. An angle that leads to such
a contradiction is given up. Along the lattice (angle 0) is preferred as long as it stands; else the middle of what is left is believed.
"""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kb.lattice import Lattice

ANGLES = tuple(sorted(range(-44, 46), key=lambda angle: (abs(angle), angle)))


class Look(NamedTuple):
    """One impression's count ranges (160, 2), and where it was received: (east, north) of Utak's own frame."""

    ranges: NDArray[np.int16]
    place: tuple[float, float]


def contradictions(angle: int, looks: Sequence[Look]) -> int:
    """How many squares and fields contradict each other if the lattice lies at this angle.

    Squares seen by themselves are compared with each other, and coarser fields with them.
    """
    lattice = Lattice(angle)
    samples = lattice.samples()
    places = [lattice.place_from_utak(*look.place) for look in looks]
    corners = np.floor(np.array(places)).astype(int)
    low = corners.min(0) - 24
    width, height = (corners.max(0) - low + 25).tolist()
    free, full = np.zeros(width * height, bool), np.zeros(width * height, bool)
    under = []
    for look, (x, y) in zip(looks, corners - low, strict=True):
        where = (samples.rows + y) * width + samples.columns + x
        single = (samples.weight.sum(1) == 1) & (samples.slack == 0)
        square = where[single, 0]
        occupied = look.ranges[single, 0] > 0
        full[square[occupied]] = True
        free[square[~occupied]] = True
        under.append(where)
    wrong = int((free & full).sum())
    for look, where in zip(looks, under, strict=True):
        surely = (samples.weight * full[where]).sum(1)
        possibly = samples.weight.sum(1) - (samples.weight * (free & ~full)[where]).sum(1)
        wrong += int(((surely > look.ranges[:, 1]) | (possibly < look.ranges[:, 0] - samples.slack)).sum())
    return wrong


def standing(angles: Iterable[int], looks: Sequence[Look]) -> tuple[int, ...]:
    """Those of the angles that no look contradicts, in order of preference."""
    return tuple(angle for angle in angles if not contradictions(angle, looks))


def believed(angles: Sequence[int], held: int) -> int:
    """The angle to believe: the one held so far while it stands, else the middle of those left."""
    if not angles or held in angles:
        return held
    ordered = sorted(angles)
    return ordered[len(ordered) // 2]
