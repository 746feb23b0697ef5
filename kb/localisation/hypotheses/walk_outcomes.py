"""Where a motion may have ended that did not end where it should.

Utak is a point, so what stands on the lattice stops him on a line between two squares. On the lattice that he believes
in he rarely runs against anything, for he moves over squares that he believes free; while he believes in a wrong one
he does, and then neither of the two is explained without the other. What the first look afterwards leaves open a later
one may tell: so motions are remembered, and told again when looks contradict each other.
"""

import itertools
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from geometry.motion.se2 import Translate
from kb.localisation.hypotheses.frames import (
    MEMORY,
    FrameHypothesis,
    Observation,
    OriginDisc,
    PlacedObservation,
    clashing,
    fallen,
    squares_of,
    stacked,
)
from kb.localisation.hypotheses.remap import Prefixes, RemappedMap, Replay, relaid
from kb.mapping.occupancy import FREE, FULL, OPEN, OccupancyMap
from kb.objects.held_object import HeldObject, Square
from kb.perception.frame import Frame

Place = tuple[float, float]
MOST = 90  # hypotheses on which a motion is told again: as many as there are angles
FEW = 3  # looks, about, that are compared before all: mostly these contradict each other already
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


class MotionHypothesis(NamedTuple):
    """A straight motion as it was commanded.

    number : of the look that followed. shift : east and north, of Utak's own frame. hypotheses : how the lattice might
    lie before that look. stopped : is it believed to have been stopped? load : the name of what was in hand, if any.
    doubts : where else it may have ended by the look after it, in his own frame, each with how likely that is.
    """

    number: int
    shift: Place
    hypotheses: tuple[FrameHypothesis, ...]
    stopped: bool = False
    load: str | None = None
    doubts: tuple[tuple[Place, float], ...] = ()

    def likely(self, least: float) -> list[Place]:
        """Where else it ended with a greater chance than that, by the look after it."""
        return [there for there, chance in self.doubts if chance > least]

    def doubt(self, place: Place) -> float | None:
        """How likely it ended at a place, of his own frame, by the look after it; None when that was not thought of."""
        near = (chance for there, chance in self.doubts if math.dist(there, place) < 4 * HAIR)
        return max(near, default=None)


class WalkCorrection(NamedTuple):
    """That all looks from one on were received elsewhere than is believed, and what lay elsewhere by that.

    since : the number of that look. shift : east and north of where it is believed to have been received, in Utak's own
    frame. seen : the names of things that were first held since, each with how far it lies, and lay when it was first
    held, from where it is believed to. hauled : the name of the thing that he had in hand on the motion before.
    """

    since: int
    shift: Place
    seen: tuple[tuple[str, Place], ...] = ()
    hauled: str | None = None

    def place(self, place: Place) -> Place:
        """A place of his own frame where he is believed to have been since."""
        return plus(place, self.shift)

    def observations(self, observations: Sequence[Observation]) -> list[Observation]:
        """All looks, where they were received."""
        since = [
            observation._replace(place=self.place(observation.place), moved=tuple(map(self._lain, observation.moved)))
            for observation in observations[self.since :]
        ]
        return [*observations[: self.since], *since]

    def loads(self, loads: Mapping[str, HeldObject], frame: Frame) -> dict[str, HeldObject]:
        """What was moved, where it lies and lay. lattice : on which it is believed to."""
        return {name: self._load(load, frame) for name, load in loads.items()}

    def _lain(self, was: PlacedObservation) -> PlacedObservation:
        aside = self._aside(was.name)
        if was.name != self.hauled:
            was = was._replace(taken=plus(was.taken, aside))
        return was._replace(middle=plus(was.middle, aside))

    def _load(self, load: HeldObject, frame: Frame) -> HeldObject:
        aside = Translate(*frame.to_lattice(*self._aside(load.name)))
        if not any(aside):
            return load
        first = load.first if load.name == self.hauled else aside.carry(load.first)
        return replace(load.lying(aside.carry(load.polygon), load.slack), first=first)

    def _aside(self, name: str) -> Place:
        """How far a thing lies from where it is believed to, in his own frame."""
        return self.shift if name == self.hauled else dict(self.seen).get(name, (0.0, 0.0))


class ReestimatedWalk(NamedTuple):
    """That the lattice lies as a hypothesis says, and a motion had been stopped where it is not believed to have been.

    correction : of the looks since. known : does something stand there that stopped him? misfits : fields that
    contradict it, of all looks. newest : where the newest look was received then, in his own frame.
    """

    hypothesis: FrameHypothesis
    correction: WalkCorrection
    known: bool
    misfits: int
    newest: Place = (0.0, 0.0)


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


def on_line(place: Place) -> Place:
    """Where he stands who looks from beside a line: on it, for something stopped him there."""
    x, y = (float(round(v)) if abs(v - round(v)) <= 2 * HAIR else v for v in place)
    return x, y


def amid(place: Place) -> Place:
    """The place itself, but right amid a square where it is not a hair from that: there he came from a line."""
    x, y = (math.floor(v) + 0.5 if abs(v - math.floor(v) - 0.5) <= 2 * HAIR else v for v in place)
    return x, y


def views(place: Place) -> tuple[Place, ...]:
    """The places from which he may look who stands somewhere: either side of a line, all four squares of a corner."""
    columns, rows = ((v,) if abs(v - round(v)) > 2 * HAIR else (round(v) - HAIR, round(v) + HAIR) for v in place)
    return tuple((x, y) for x in columns for y in rows)


def _seen_from(place: Place, frame: Frame) -> list[Place]:
    """The places of his own frame from which he may look who stands at one of them."""
    return [frame.place_to_utak(*view) for view in views(frame.place_from_utak(*place))]


def _crossing(line: int, across: float, axis: int, hair: float) -> Crossing:
    """Where a motion crosses a line of one axis, at a place along it. hair : a little further on its way."""
    before, after = ((at, across) if axis == 0 else (across, at) for at in (line - hair, line + hair))
    return Crossing(before, after, (math.floor(after[0]), math.floor(after[1])))


def next_square(place: Place, towards: Place) -> tuple[int, int]:
    """The square that a motion towards a point was about to enter when it was stopped."""
    away = math.dist(place, towards) or 1.0
    ahead = [a + (b - a) / away for a, b in zip(place, towards, strict=True)]
    return math.floor(ahead[0]), math.floor(ahead[1])


def retold(
    motion: MotionHypothesis,
    held: Frame,
    observations: Sequence[Observation],
    laid: Callable[[Frame], Prefixes] | None = None,
) -> Iterator[ReestimatedWalk]:
    """What else may have come of a motion, and how the lattice lies then, so that no look contradicts another.

    held : the lattice that is believed. looks : all, where they are believed to have been received, the newest where it
    was commanded. laid : the first of them on a lattice. What is believed already is not among it, nor that the newest
    motion was stopped by what is not known, on the lattice held.

    Until he was stopped he came over no square that is occupied, and into none that is free; rather before one that is
    occupied than before one of which it is open.
    """
    newest = motion.number == len(observations) - 1
    for hypothesis in _likeliest(motion.hypotheses):
        begun = Prefixes(hypothesis.frame, observations, {}) if laid is None else laid(hypothesis.frame)
        found = list(_otherwise(motion, hypothesis, observations, begun))
        surest = any(one.known for one in found)
        if surest or not (newest and hypothesis.frame == held):
            yield from (one for one in found if one.known == surest)


def _likeliest(hypotheses: tuple[FrameHypothesis, ...]) -> tuple[FrameHypothesis, ...]:
    """Of hypotheses the MOST that are the least dear, in their order."""
    if len(hypotheses) <= MOST:
        return hypotheses
    likely = sorted(range(len(hypotheses)), key=lambda number: hypotheses[number].dear)[:MOST]
    return tuple(hypotheses[number] for number in sorted(likely))


def _otherwise(
    motion: MotionHypothesis, hypothesis: FrameHypothesis, observations: Sequence[Observation], begun: Prefixes
) -> Iterator[ReestimatedWalk]:
    """What else may have come of one motion on one lattice."""
    frame, number = hypothesis.frame, motion.number
    believed, walk = observations[number].place, Walk(motion, frame, observations)
    judged: dict[bytes, RemappedMap | None] = {}
    ranges, places = stacked(observations), np.array([observation.place for observation in observations])
    for end in walk.ends:
        shift = end.place[0] - believed[0], end.place[1] - believed[1]
        if math.hypot(*shift) < HAIR:  # as is believed
            continue
        correction = WalkCorrection(number, shift)
        newest = correction.place(observations[-1].place)
        there = places.copy()
        there[number:] += shift
        for place in _seen_from(newest, frame) if number < len(observations) - 1 else [newest]:
            there[-1] = place
            squares = squares_of(frame, there)
            key = squares.tobytes()
            if key not in judged:
                judged[key] = None
                if _agree(frame, squares, ranges):
                    *before, last = correction.observations(observations)
                    judged[key] = relaid(frame, frame, [*before, last._replace(place=place)], (), begun.of(number))
            under = judged[key]
            if under is not None and (ahead := walk.ahead(end, under.occupancy)) != FREE:
                yield ReestimatedWalk(hypothesis, correction, ahead == FULL, under.misfits, place)


def retold_both(
    motion: MotionHypothesis, newest: MotionHypothesis, hypothesis: FrameHypothesis, observations: Sequence[Observation]
) -> Iterator[ReestimatedWalk]:
    """That both an earlier motion and the newest were stopped by what is known, so that no look contradicts another.

    looks : as for `retold`. Who goes on against what stopped him does not move at all.
    """
    frame, before, believed = hypothesis.frame, observations[:-1], observations[motion.number].place
    walk = Walk(motion, frame, observations)
    against = sum(a * b for a, b in zip(motion.shift, newest.shift, strict=True)) > 0
    for end in walk.ends[:-1]:
        correction = WalkCorrection(motion.number, (end.place[0] - believed[0], end.place[1] - believed[1]))
        there = correction.observations(before)
        so_far = agreed(frame, there, recent=MEMORY, whether=False)
        if so_far is None or walk.ahead(end, so_far.occupancy) == FREE:
            continue
        onward = Walk(newest, frame, [*there, observations[-1]])
        still = [End(there[-1].place, 0)] * (against and motion.number == newest.number - 1)
        for halt in (*still, *onward.ends[:-1]):
            under = agreed(frame, [*there, observations[-1]._replace(place=halt.place)])
            if under is None or under.misfits or walk.ahead(end, under.occupancy) != FULL:
                continue
            if halt in still or onward.ahead(halt, under.occupancy) == FULL:
                yield ReestimatedWalk(hypothesis, correction, True, 0, halt.place)


def agreed(
    frame: Frame,
    observations: Sequence[Observation],
    loads: Iterable[HeldObject] = (),
    unsettled: Sequence[OriginDisc] = (),
    recent: int = MEMORY + 1,
    begun: Replay | None = None,
    whether: bool = True,
) -> RemappedMap | None:
    """What all looks say on the lattice on which the loads lie; None when two of the last contradict each other.

    unsettled : where looks need not agree. recent : how many of them are compared. begun : the first, taken in already.
    whether : as for kb.localisation.hypotheses.remap.relaid.
    """
    if not _agree(frame, fallen(frame, observations), stacked(observations), unsettled, recent):
        return None
    return relaid(frame, frame, observations, loads, begun, whether)


def _agree(
    frame: Frame,
    squares: NDArray[np.int64],
    ranges: NDArray[np.int16],
    unsettled: Sequence[OriginDisc] = (),
    recent: int = MEMORY + 1,
) -> bool:
    """Does none of the last looks contradict another? squares, ranges : of all looks, as for
    kb.localisation.hypotheses.frames.clashing.
    """
    squares, ranges = squares[-recent:], ranges[-recent:]
    apart = len(squares) // FEW
    if apart > 1 and clashing(frame, squares[::-apart], ranges[::-apart], unsettled):  # the newest one among them
        return False
    return not clashing(frame, squares, ranges, unsettled)


class End(NamedTuple):
    """Where a motion may have ended: a place of Utak's own frame, and how much of the motion was gone."""

    place: Place
    gone: float


class Walk:
    """A motion without anything in hand, on a lattice. looks : all, where they are believed to have been received.

    ends : where he may have been stopped, in the order of the way, and its end; gone counts the crossings before it.
    """

    def __init__(self, motion: MotionHypothesis, frame: Frame, observations: Sequence[Observation]) -> None:
        x, y = observations[motion.number - 1].place
        self._met = met = crossings(frame.place_from_utak(x, y), frame.to_lattice(*motion.shift))
        halts = [End(frame.place_to_utak(*place), at) for at in range(len(met)) for place in views(met[at].before)]
        self.ends = (*halts, End((x + motion.shift[0], y + motion.shift[1]), len(met)))

    def ahead(self, end: End, occupancy: OccupancyMap, things: Set[Square] = frozenset()) -> int:
        """What stands where he would have been stopped; FREE, too, where something would have stopped him before.

        things : squares on which something stood then that was moved since.
        """
        at = int(end.gone)
        entered = [crossing.entered for crossing in self._met[: at + 1]]
        states = (FULL if square in things else _state(occupancy, square) for square in entered)
        if FULL in itertools.islice(states, at):
            return FREE
        return next(states, OPEN)


def plus(place: Place, shift: Place) -> Place:
    """A place so much further east and north."""
    return place[0] + shift[0], place[1] + shift[1]


def _state(occupancy: OccupancyMap, square: tuple[int, int]) -> int:
    row, column = occupancy.index(*square)
    return int(occupancy.state[row, column])
