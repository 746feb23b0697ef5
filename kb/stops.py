"""Where a motion that was stopped may have ended.

Utak is a point, so what stands on the lattice stops him on a line between two squares. On the lattice that he believes
in he rarely runs against anything, for he moves over squares that he believes free; while he believes in a wrong one
he does, and then neither of the two is explained without the other.
"""

import math
from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kb.evidence import FREE, FULL, Evidence
from kb.heading import Hypothesis, Look, contradictions
from kb.lattice import Lattice
from kb.relaying import relaid

Place = tuple[float, float]
RECENT = 12  # looks by which lattices are judged first
HAIR = 1e-6  # squares beyond a line between two squares, to be told from before it: who stands on it looks from there


class Crossing(NamedTuple):
    """Where a motion crosses a line between two squares, and the square that it enters there."""

    place: Place
    entered: tuple[int, int]


class Stop(NamedTuple):
    """That the lattice lies as a hypothesis says, and a motion ended at a place of Utak's own frame.

    misfits : fields that contradict it, of all looks.
    """

    hypothesis: Hypothesis
    own: Place
    misfits: int


def along(start: Place, shift: Place) -> tuple[Place, ...]:
    """Places at which a motion may have been stopped, the last first, a square's side apart."""
    length = math.hypot(*shift)
    steps = math.ceil(length)
    parts = [i / steps for i in range(steps - 1, -1, -1)] if steps else []
    return tuple((start[0] + shift[0] * t, start[1] + shift[1] * t) for t in parts)


def crossings(start: Place, shift: Place) -> tuple[Crossing, ...]:
    """Where a motion crosses the lines between squares, in this order."""
    found = []
    for axis in (0, 1):
        low, high = sorted((start[axis], start[axis] + shift[axis]))
        for line in range(math.floor(low) + 1, math.ceil(high)):
            part = (line - start[axis]) / shift[axis]
            across = start[1 - axis] + shift[1 - axis] * part
            entered = line if shift[axis] > 0 else line - 1
            found.append((part, axis, across, line, entered))
    return tuple(
        Crossing((line + HAIR, across), (entered, math.floor(across)))
        if axis == 0
        else Crossing((across, line + HAIR), (math.floor(across), entered))
        for _, axis, across, line, entered in sorted(found)
    )


def next_square(place: Place, towards: Place) -> tuple[int, int]:
    """The square that a motion towards a point was about to enter when it was stopped."""
    away = math.dist(place, towards) or 1.0
    ahead = [a + (b - a) / away for a, b in zip(place, towards, strict=True)]
    return math.floor(ahead[0]), math.floor(ahead[1])


def misled(
    hypotheses: Iterable[Hypothesis],
    held: Lattice,
    looks: Sequence[Look],
    ranges: NDArray[np.int16],
    start: Place,
    end: Place,
) -> Iterator[Stop]:
    """How the lattice may lie, and where a motion was stopped on it, so that no look contradicts another.

    looks : those before. ranges : what was seen then. start, end : of the motion as commanded, in Utak's own frame.
    Until then he came over no square that is occupied, and into none that is free.
    """
    for hypothesis in hypotheses:
        lattice = hypothesis.lattice
        if lattice == held:
            continue
        shift = lattice.to_lattice(end[0] - start[0], end[1] - start[1])
        passed: list[tuple[int, int]] = []
        for crossing in crossings(lattice.place_from_utak(*start), shift):
            look = Look(ranges, lattice.place_to_utak(*crossing.place))
            if not contradictions(lattice, [*looks[-RECENT:], look]):
                under = relaid(lattice, held, [*looks, look], ())
                free = all(_state(under.evidence, square) != FULL for square in passed)
                if free and _state(under.evidence, crossing.entered) != FREE:
                    yield Stop(hypothesis, look.place, under.misfits)
            passed.append(crossing.entered)


def _state(evidence: Evidence, square: tuple[int, int]) -> int:
    row, column = evidence.index(*square)
    return int(evidence.state[row, column])
