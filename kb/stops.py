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

from kb.evidence import FREE, FULL, OPEN, Evidence
from kb.heading import MEMORY, Hypothesis, Look, contradictions
from kb.lattice import Lattice
from kb.relaying import relaid

Place = tuple[float, float]
HAIR = 1e-6  # squares from a line between two squares to what counts as beside it


class Crossing(NamedTuple):
    """Where a motion crosses a line between two squares, and the square that it enters there.

    before, after : a hair this side of the line and beyond it. Who is stopped there looks from either square: from the
    one further north and east on the table, and how the table is turned he does not know.
    """

    before: Place
    after: Place
    entered: tuple[int, int]


class Stop(NamedTuple):
    """That the lattice lies as a hypothesis says, and a motion ended at a place of Utak's own frame.

    misfits : fields that contradict it, of all looks.
    """

    hypothesis: Hypothesis
    own: Place
    misfits: int


def ends(start: Place, shift: Place) -> tuple[Place, ...]:
    """Places at which a motion may have been stopped, the last first: beside lines between squares; where it began."""
    lines = reversed(crossings(start, shift))
    found = [place for crossing in lines for place in (crossing.after, crossing.before)]
    return (*found, start) if any(shift) else ()


def crossings(start: Place, shift: Place) -> tuple[Crossing, ...]:
    """Where a motion crosses the lines between squares, in this order."""
    found = []
    for axis in (0, 1):
        low, high = sorted((start[axis], start[axis] + shift[axis]))
        sign = math.copysign(1.0, shift[axis])
        for line in range(math.floor(low) + 1, math.ceil(high)):
            part = (line - start[axis]) / shift[axis]
            across = start[1 - axis] + shift[1 - axis] * part
            before, after = (
                (line + side, across) if axis == 0 else (across, line + side) for side in (-sign * HAIR, sign * HAIR)
            )
            found.append((part, Crossing(before, after, (math.floor(after[0]), math.floor(after[1])))))
    return tuple(crossing for _, crossing in sorted(found))


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
    Until then he came over no square that is occupied, and into none that is free; rather before one that is occupied
    than before one of which it is open.
    """
    for hypothesis in hypotheses:
        lattice = hypothesis.lattice
        if lattice == held:
            continue
        shift = lattice.to_lattice(end[0] - start[0], end[1] - start[1])
        passed: list[tuple[int, int]] = []
        found: list[tuple[int, Stop]] = []
        for crossing in crossings(lattice.place_from_utak(*start), shift):
            for place in (crossing.before, crossing.after):
                look = Look(ranges, lattice.place_to_utak(*place))
                if contradictions(lattice, [*looks[-MEMORY:], look]):
                    continue
                under = relaid(lattice, held, [*looks, look], ())
                free = all(_state(under.evidence, square) != FULL for square in passed)
                ahead = _state(under.evidence, crossing.entered)
                if free and ahead != FREE:
                    found.append((ahead, Stop(hypothesis, look.place, under.misfits)))
            passed.append(crossing.entered)
        surest = max((ahead for ahead, _ in found), default=OPEN)
        yield from (stop for ahead, stop in found if ahead == surest)


def _state(evidence: Evidence, square: tuple[int, int]) -> int:
    row, column = evidence.index(*square)
    return int(evidence.state[row, column])
