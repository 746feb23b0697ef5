"""Re-estimation of walks: other ends of a remembered motion, tried when observations contradict each other.

For each end the observations since are shifted, and the frame hypotheses are kept in which none of them contradicts
another. In robotics this is called smoothing.
"""

import itertools
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from utak.geometry.motion.se2 import Translate
from utak.kb.localisation.hypotheses.frames import (
    MAX_CHECKED_OBSERVATIONS,
    FrameHypothesis,
    ObjectPose,
    Observation,
    Position,
    UnsettledDisc,
    count_contradictions_at,
    observation_squares,
    place_squares,
    stack_ranges,
)
from utak.kb.localisation.hypotheses.remap import MapReplay, RemappedMap, ReplayPrefixes, remap
from utak.kb.localisation.hypotheses.walk_outcomes import (
    LINE_DISTANCE,
    MotionHypothesis,
    add,
    line_crossings,
    observation_places,
)
from utak.kb.mapping.occupancy import FREE, OCCUPIED, OPEN, OccupancyMap
from utak.kb.objects.held_object import HeldObject, Square
from utak.kb.perception.frame import Frame

MAX_REESTIMATED_HYPOTHESES = 90  # hypotheses in which one motion is re-estimated: as many as there are orientations
QUICK_CHECK_OBSERVATIONS = 3  # observations, about, that are compared before all: most contradictions show there


class WalkCorrection(NamedTuple):
    """A shift of all observations from one on, and of the objects that were seen or moved from there."""

    since: int  # the number of the first observation that is shifted; the first of all has the number 0
    shift: Position  # from the believed place to the corrected one, (east, north) in squares, Utak's own frame
    # Objects that were first held since, by name, each with the shift of where it lies and lay, same frame and unit
    seen: tuple[tuple[str, Position], ...] = ()
    # The name of the object in hand on the motion that is corrected; None when there was none
    in_hand: str | None = None

    def place(self, place: Position) -> Position:
        """Return a place of Utak since the motion as corrected, (east, north) in squares, Utak's own frame."""
        return add(place, self.shift)

    def observations(self, observations: Sequence[Observation]) -> list[Observation]:
        """Return all observations, oldest first, with corrected places and object poses; earlier ones are unchanged."""
        since = [
            observation._replace(place=self.place(observation.place), moved=tuple(map(self._pose, observation.moved)))
            for observation in observations[self.since :]
        ]
        return [*observations[: self.since], *since]

    def held_objects(self, held_objects: Mapping[str, HeldObject], frame: Frame) -> dict[str, HeldObject]:
        """Return all held objects, by name, where they lie and lay as corrected; same frame and order as given."""
        return {name: self._corrected_object(held, frame) for name, held in held_objects.items()}

    def _pose(self, pose: ObjectPose) -> ObjectPose:
        """Return the corrected pose of an object at an observation since the motion, Utak's own frame."""
        aside = self._aside(pose.name)
        if pose.name != self.in_hand:
            pose = pose._replace(taken=add(pose.taken, aside))
        return pose._replace(middle=add(pose.middle, aside))

    def _corrected_object(self, held: HeldObject, frame: Frame) -> HeldObject:
        """Return an object where it lies as corrected, map frame of `frame`; the same object when it is not shifted."""
        aside = Translate(*frame.to_map(*self._aside(held.name)))
        if not any(aside):
            return held
        first = held.first if held.name == self.in_hand else aside.carry(held.first)
        return replace(held.lying(aside.carry(held.polygon), held.slack), first=first, seen_on=None)

    def _aside(self, name: str) -> Position:
        """Return the shift of an object, (east, north) in squares, Utak's own frame; (0, 0) when it is not shifted."""
        return self.shift if name == self.in_hand else dict(self.seen).get(name, (0.0, 0.0))


class ReestimatedWalk(NamedTuple):
    """A re-estimated motion: a frame, and the correction of a motion with which observations agree."""

    hypothesis: FrameHypothesis  # of the frame
    correction: WalkCorrection  # of all observations since that motion
    contact_known: bool  # whether something known stands where the motion was blocked then
    residual: int  # number of fields that contradict it, over all observations
    # Where the newest observation was made then, (east, north) in squares, Utak's own frame
    newest: Position = (0.0, 0.0)


def reestimate_walk(
    motion: MotionHypothesis,
    believed: Frame,
    observations: Sequence[Observation],
    prefixes: Callable[[Frame], ReplayPrefixes] | None = None,
) -> Iterator[ReestimatedWalk]:
    """Yield other ends of a motion, each with the frame in which no observation contradicts another."""
    newest = motion.number == len(observations) - 1
    for hypothesis in _likeliest_hypotheses(motion.hypotheses):
        frame = hypothesis.frame
        begun = ReplayPrefixes(frame, observations, {}) if prefixes is None else prefixes(frame)
        found = list(_other_ends(motion, hypothesis, observations, begun))
        surest = any(one.contact_known for one in found)
        if surest or not (newest and hypothesis.frame == believed):
            yield from (one for one in found if one.contact_known == surest)


def _likeliest_hypotheses(hypotheses: tuple[FrameHypothesis, ...]) -> tuple[FrameHypothesis, ...]:
    """Return the MAX_REESTIMATED_HYPOTHESES of the least prior cost, in the order given; all when there are no more."""
    if len(hypotheses) <= MAX_REESTIMATED_HYPOTHESES:
        return hypotheses
    numbers = sorted(range(len(hypotheses)), key=lambda number: hypotheses[number].prior_cost)
    return tuple(hypotheses[number] for number in sorted(numbers[:MAX_REESTIMATED_HYPOTHESES]))


def _other_ends(
    motion: MotionHypothesis,
    hypothesis: FrameHypothesis,
    observations: Sequence[Observation],
    begun: ReplayPrefixes,
) -> Iterator[ReestimatedWalk]:
    """Yield the other ends of one motion in one frame, with contacts known and unknown, in the order of the way."""
    frame, number = hypothesis.frame, motion.number
    believed, walk = observations[number].place, WalkInFrame(motion, frame, observations)
    judged: dict[bytes, RemappedMap | None] = {}
    ranges, places = stack_ranges(observations), np.array([observation.place for observation in observations])
    for end in walk.ends:
        shift = end.place[0] - believed[0], end.place[1] - believed[1]
        if math.hypot(*shift) < LINE_DISTANCE:  # as believed
            continue
        correction = WalkCorrection(number, shift)
        newest = correction.place(observations[-1].place)
        there = places.copy()
        there[number:] += shift
        for place in _own_observation_places(newest, frame) if number < len(observations) - 1 else [newest]:
            there[-1] = place
            squares = place_squares(frame, there)
            key = squares.tobytes()
            if key not in judged:
                judged[key] = None
                if _are_consistent(frame, squares, ranges):
                    *before, last = correction.observations(observations)
                    judged[key] = remap(frame, frame, [*before, last._replace(place=place)], (), begun.first(number))
            under = judged[key]
            if under is not None and (ahead := walk.state_ahead(end, under.occupancy)) != FREE:
                yield ReestimatedWalk(hypothesis, correction, ahead == OCCUPIED, under.residual, place)


def reestimate_two_walks(
    motion: MotionHypothesis, newest: MotionHypothesis, hypothesis: FrameHypothesis, observations: Sequence[Observation]
) -> Iterator[ReestimatedWalk]:
    """Yield ends of an earlier motion and of the newest one, both blocked by what is known, without contradictions."""
    frame, before, believed = hypothesis.frame, observations[:-1], observations[motion.number].place
    walk = WalkInFrame(motion, frame, observations)
    against = sum(a * b for a, b in zip(motion.shift, newest.shift, strict=True)) > 0
    for end in walk.ends[:-1]:
        correction = WalkCorrection(motion.number, (end.place[0] - believed[0], end.place[1] - believed[1]))
        there = correction.observations(before)
        so_far = remap_if_consistent(frame, there, recent=MAX_CHECKED_OBSERVATIONS, only_whether=False)
        if so_far is None or walk.state_ahead(end, so_far.occupancy) == FREE:
            continue
        onward = WalkInFrame(newest, frame, [*there, observations[-1]])
        still = [WalkEnd(there[-1].place, 0)] * (against and motion.number == newest.number - 1)
        for halt in (*still, *onward.ends[:-1]):
            under = remap_if_consistent(frame, [*there, observations[-1]._replace(place=halt.place)])
            if under is None or under.residual or walk.state_ahead(end, under.occupancy) != OCCUPIED:
                continue
            if halt in still or onward.state_ahead(halt, under.occupancy) == OCCUPIED:
                yield ReestimatedWalk(hypothesis, correction, True, 0, halt.place)


def remap_if_consistent(
    frame: Frame,
    observations: Sequence[Observation],
    held_objects: Iterable[HeldObject] = (),
    unsettled: Sequence[UnsettledDisc] = (),
    recent: int = MAX_CHECKED_OBSERVATIONS + 1,
    begun: MapReplay | None = None,
    only_whether: bool = True,
) -> RemappedMap | None:
    """Return the map of all observations in a frame; None when two of the last observations contradict each other."""
    squares = observation_squares(frame, observations)
    if not _are_consistent(frame, squares, stack_ranges(observations), unsettled, recent):
        return None
    return remap(frame, frame, observations, held_objects, begun, only_whether)


def _are_consistent(
    frame: Frame,
    squares: NDArray[np.int64],
    ranges: NDArray[np.int16],
    unsettled: Sequence[UnsettledDisc] = (),
    recent: int = MAX_CHECKED_OBSERVATIONS + 1,
) -> bool:
    """Return whether none of the last observations contradicts another."""
    squares, ranges = squares[-recent:], ranges[-recent:]
    apart = len(squares) // QUICK_CHECK_OBSERVATIONS
    if apart > 1 and count_contradictions_at(frame, squares[::-apart], ranges[::-apart], unsettled):  # with the newest
        return False
    return not count_contradictions_at(frame, squares, ranges, unsettled)


class WalkEnd(NamedTuple):
    """A possible end of a motion."""

    place: Position  # (east, north) in squares, Utak's own frame
    # How far the motion had come: the number of grid lines crossed before it, or, with an object in hand, the part of
    # the motion, 0 to 1
    progress: float


class WalkInFrame:
    """A motion with an empty hand, in a frame."""

    def __init__(self, motion: MotionHypothesis, frame: Frame, observations: Sequence[Observation]) -> None:
        """Find the ends of a motion."""
        x, y = observations[motion.number - 1].place
        self._met = met = line_crossings(frame.place_from_utak(x, y), frame.to_map(*motion.shift))
        halts = [
            WalkEnd(frame.place_to_utak(*place), at)
            for at in range(len(met))
            for place in observation_places(met[at].before)
        ]
        self.ends = (*halts, WalkEnd((x + motion.shift[0], y + motion.shift[1]), len(met)))

    def state_ahead(self, end: WalkEnd, occupancy: OccupancyMap, things: Set[Square] = frozenset()) -> int:
        """Return the state of the square that blocked the motion at `end`: OCCUPIED, OPEN or FREE (1, -1 or 0)."""
        # FREE if one before it was occupied, so that the motion cannot have come so far;
        at = int(end.progress)
        entered = [crossing.entered for crossing in self._met[: at + 1]]
        states = (OCCUPIED if square in things else _square_state(occupancy, square) for square in entered)
        if OCCUPIED in itertools.islice(states, at):
            return FREE
        return next(states, OPEN)


def _square_state(occupancy: OccupancyMap, square: Square) -> int:
    """Return the state of a square (column, row) of the map frame: OCCUPIED, OPEN or FREE."""
    row, column = occupancy.index(*square)
    return int(occupancy.state[row, column])


def _own_observation_places(place: Position, frame: Frame) -> list[Position]:
    """Return the places from which the observation at `place` may be made: one for each square that it touches."""
    return [frame.place_to_utak(*view) for view in observation_places(frame.place_from_utak(*place))]
