"""How the lattice of the table may lie under Utak, judged by all looks so far.

Under a wrong angle two looks, or two fields of one look, claim of one square that it is free and that it is occupied.
A lattice that leads to such
a contradiction is given up. One along Utak's own axes is preferred as long as it stands; else the middle of what is
left is believed.
"""

import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kb.lattice import CENTRE, Lattice

ANGLES = tuple(sorted(range(-44, 46), key=lambda angle: (abs(angle), angle)))


class Hypothesis(NamedTuple):
    """How the lattice may lie.

    Its angle in degrees, and a box (west, south, east, north) within the square, in which Utak woke.
    """

    angle: int
    box: tuple[float, float, float, float]

    @property
    def lattice(self) -> Lattice:
        """The lattice, with the middle of the box for the point where he woke.

        The square's centre where that will do.
        """
        west, south, east, north = self.box
        if west <= CENTRE[0] <= east and south <= CENTRE[1] <= north:
            return Lattice(self.angle)
        return Lattice(self.angle, ((west + east) / 2, (south + north) / 2))

    def split(self, place: tuple[float, float]) -> "list[Hypothesis]":
        """Cut the box where the square changes on which he stands at a place of his own frame.

        The part with the centre first.
        """
        west, south, east, north = self.box
        dx, dy = Lattice(self.angle).to_lattice(*place)
        columns = _cut(west, east, math.ceil(dx) - dx)
        rows = _cut(south, north, math.ceil(dy) - dy)
        return [Hypothesis(self.angle, (w, s, e, n)) for w, e in columns for s, n in rows]


CENTRED = tuple(Hypothesis(angle, CENTRE + CENTRE) for angle in ANGLES)
ANYWHERE = tuple(Hypothesis(angle, (0.0, 0.0, 1.0, 1.0)) for angle in ANGLES)


class Look(NamedTuple):
    """One impression's count ranges (160, 2), and where it was received: (east, north) of Utak's own frame."""

    ranges: NDArray[np.int16]
    place: tuple[float, float]


def contradictions(lattice: Lattice, looks: Sequence[Look]) -> int:
    """How many squares and fields contradict each other if the lattice lies like this.

    Squares under fields that are quite full or quite empty are compared with each other, and other fields with them.
    """
    samples = lattice.samples()
    places = [lattice.place_from_utak(*look.place) for look in looks]
    corners = np.floor(np.array(places)).astype(int)
    low = corners.min(0) - 24
    width, height = (corners.max(0) - low + 25).tolist()
    free, full = np.zeros(width * height, bool), np.zeros(width * height, bool)
    under = []
    for look, (x, y) in zip(looks, corners - low, strict=True):
        where = (samples.rows + y) * width + samples.columns + x
        used, weight = samples.weight > 0, samples.weight.sum(1)
        full[where[(look.ranges[:, 0] - samples.slack >= weight)[:, None] & used]] = True
        free[where[(look.ranges[:, 1] == 0)[:, None] & used]] = True
        under.append(where)
    wrong = int((free & full).sum())
    for look, where in zip(looks, under, strict=True):
        surely = (samples.weight * full[where]).sum(1)
        possibly = samples.weight.sum(1) - (samples.weight * (free & ~full)[where]).sum(1)
        wrong += int(((surely > look.ranges[:, 1]) | (possibly < look.ranges[:, 0] - samples.slack)).sum())
    return wrong


def standing(hypotheses: Iterable[Hypothesis], looks: Sequence[Look]) -> tuple[Hypothesis, ...]:
    """What is left of the hypotheses when the last of these looks is taken into account, in order of preference."""
    parts = (part for hypothesis in hypotheses for part in hypothesis.split(looks[-1].place))
    return tuple(part for part in parts if not contradictions(part.lattice, looks))


def search(looks: Sequence[Look]) -> tuple[Hypothesis, ...]:
    """All that these looks leave possible, wherever in his square Utak woke."""
    hypotheses = ANYWHERE
    for number in range(1, len(looks) + 1):
        hypotheses = standing(hypotheses, looks[:number])
    return hypotheses


def candidates(hypotheses: Sequence[Hypothesis], held: Lattice) -> list[Lattice]:
    """The lattices to try, the likeliest first: the one held, one along his own axes, then from the middle outwards."""
    ordered = sorted(hypotheses)
    middle = len(ordered) // 2
    outwards = sorted(range(len(ordered)), key=lambda i: abs(i - middle))
    likely = [held, *(Lattice(h.angle) for h in ordered if h.angle == 0), *(ordered[i].lattice for i in outwards)]
    standing_still = {h.lattice for h in hypotheses}
    return [lattice for lattice in dict.fromkeys(likely) if lattice in standing_still]


def _cut(low: float, high: float, at: float) -> list[tuple[float, float]]:
    """An interval cut in two at a point inside it; the part that holds the middle of a square first."""
    if not low < at < high:
        return [(low, high)]
    parts = [(low, at), (at, high)]
    return parts if at > CENTRE[0] else parts[::-1]
