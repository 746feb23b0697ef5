"""Where a motion may have ended that did not end where it should.

Utak is a point, so what stands on the lattice stops him on a line between two squares. On the lattice that he believes
in he rarely runs against anything, for he moves over squares that he believes free; while he believes in a wrong one
he does, and then neither of the two is explained without the other. What the first look afterwards leaves open a later
one may tell: so motions are remembered, and told again when looks contradict each other.
"""

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

from kb.evidence import FREE, FULL, OPEN, Evidence
from kb.heading import MEMORY, Hypothesis, Look, contradictions, fallen
from kb.lattice import Lattice
from kb.relaying import Relaid, relaid

Place = tuple[float, float]
NEAR = 2  # squares about the predicted place in which Utak is looked for first
HAIR = 1e-6  # squares from a line between two squares to what counts as beside it


class Crossing(NamedTuple):
    """Where a motion crosses a line between two squares, and the square that it enters there.

    before, after : a hair this side of the line and beyond it. Who is stopped there looks from either square: from the
    one further north and east on the table, and how the table is turned he does not know.
    """

    before: Place
    after: Place
    entered: tuple[int, int]


class Moved(NamedTuple):
    """A motion as it was commanded.

    number : of the look that followed. shift : east and north, of Utak's own frame. hypotheses : how the lattice might
    lie before that look. stopped : is it believed to have been stopped?
    """

    number: int
    shift: Place
    hypotheses: tuple[Hypothesis, ...]
    stopped: bool = False


class Retold(NamedTuple):
    """That the lattice lies as a hypothesis says, and all looks from one on were received elsewhere than is believed:
    the motion before it had been stopped, or had not.

    since : the number of that look. shift : east and north of where it is believed to have been received, in Utak's own
    frame. known : does something stand there that stopped him? misfits : fields that contradict it, of all looks.
    """

    hypothesis: Hypothesis
    since: int
    shift: Place
    known: bool
    misfits: int

    def looks(self, looks: Sequence[Look]) -> list[Look]:
        """All looks, where they were received."""
        return _shifted(looks, self.since, self.shift)


def ends(start: Place, shift: Place) -> tuple[Place, ...]:
    """Places at which a motion may have been stopped, the last first: beside lines between squares; where it began."""
    lines = reversed(crossings(start, shift))
    found = [place for crossing in lines for place in (crossing.after, crossing.before)]
    return (*found, start) if any(shift) else ()


def around(place: Place) -> tuple[Place, ...]:
    """The places within NEAR squares of a place, by distance; the place itself is not among them."""
    reach = range(-NEAR, NEAR + 1)
    offsets = sorted((i * i + j * j, i, j) for i in reach for j in reach if i or j)
    return tuple((place[0] + i, place[1] + j) for _, i, j in offsets)


def crossings(start: Place, shift: Place) -> tuple[Crossing, ...]:
    """Where a motion crosses the lines between squares, in this order.

    Through a corner of squares it enters those beside it first, one after the other, and then the one beyond.
    """
    found: list[tuple[float, int, Crossing]] = []
    signs = [math.copysign(HAIR, v) for v in shift]
    for axis in (0, 1):
        low, high = sorted((start[axis], start[axis] + shift[axis]))
        for line in range(math.floor(low) + 1, math.ceil(high)):
            part = (line - start[axis]) / shift[axis]
            across = start[1 - axis] + shift[1 - axis] * part
            other, when = round(across), round(part, 9)
            if shift[1 - axis] and abs(across - other) < HAIR:  # at a corner: still this side of the other line
                across = other - signs[1 - axis]
                if axis == 1:
                    found.append((when, 2, _crossing(line, other + signs[0], axis, signs[1])))
            found.append((when, axis, _crossing(line, across, axis, signs[axis])))
    return tuple(crossing for *_, crossing in sorted(found))


def _crossing(line: int, across: float, axis: int, hair: float) -> Crossing:
    """Where a motion crosses a line of one axis, at a place along it. hair : a little further on its way."""
    before, after = ((at, across) if axis == 0 else (across, at) for at in (line - hair, line + hair))
    return Crossing(before, after, (math.floor(after[0]), math.floor(after[1])))


def next_square(place: Place, towards: Place) -> tuple[int, int]:
    """The square that a motion towards a point was about to enter when it was stopped."""
    away = math.dist(place, towards) or 1.0
    ahead = [a + (b - a) / away for a, b in zip(place, towards, strict=True)]
    return math.floor(ahead[0]), math.floor(ahead[1])


def retold(motion: Moved, held: Lattice, looks: Sequence[Look]) -> Iterator[Retold]:
    """What else may have come of a motion, and how the lattice lies then, so that no look contradicts another.

    held : the lattice that is believed. looks : all, where they are believed to have been received, the newest where it
    was commanded. That the newest motion was stopped on the lattice held is not among it, nor what is believed already.

    Until he was stopped he came over no square that is occupied, and into none that is free; rather before one that is
    occupied than before one of which it is open.
    """
    newest = motion.number == len(looks) - 1
    for hypothesis in motion.hypotheses:
        if newest and hypothesis.lattice == held:
            continue
        found = list(_otherwise(motion, hypothesis, looks))
        surest = any(one.known for one in found)
        yield from (one for one in found if one.known == surest)


def _otherwise(motion: Moved, hypothesis: Hypothesis, looks: Sequence[Look]) -> Iterator[Retold]:
    """What else may have come of one motion on one lattice."""
    lattice, number = hypothesis.lattice, motion.number
    (x, y), believed = looks[number - 1].place, looks[number].place
    met = crossings(lattice.place_from_utak(x, y), lattice.to_lattice(*motion.shift))
    beside = [(at, place) for at, crossing in enumerate(met) for place in (crossing.before, crossing.after)]
    halts = [(at, lattice.place_to_utak(*place)) for at, place in beside]
    halts.append((len(met), (x + motion.shift[0], y + motion.shift[1])))
    judged: dict[bytes, Relaid | None] = {}
    for at, own in halts:
        shift = own[0] - believed[0], own[1] - believed[1]
        if math.hypot(*shift) < HAIR:  # as is believed
            continue
        there = _shifted(looks, number, shift)
        key = fallen(lattice, there).tobytes()
        if key not in judged:
            stands = not contradictions(lattice, there[-MEMORY - 1 :])
            judged[key] = relaid(lattice, lattice, there, ()) if stands else None
        under = judged[key]
        if under is None or any(_state(under.evidence, crossing.entered) == FULL for crossing in met[:at]):
            continue
        ahead = _state(under.evidence, met[at].entered) if at < len(met) else OPEN
        if ahead != FREE:
            yield Retold(hypothesis, number, shift, ahead == FULL, under.misfits)


def _shifted(looks: Sequence[Look], since: int, shift: Place) -> list[Look]:
    """Looks, those from one on received so much further east and north."""
    (dx, dy), far = shift, looks[since:]
    return [*looks[:since], *(look._replace(place=(look.place[0] + dx, look.place[1] + dy)) for look in far)]


def _state(evidence: Evidence, square: tuple[int, int]) -> int:
    row, column = evidence.index(*square)
    return int(evidence.state[row, column])
