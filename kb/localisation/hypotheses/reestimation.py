"""Re-estimation of walks: other ends of a remembered motion, tried when observations contradict each other.

For each end the observations since are shifted, and the frame hypotheses are kept in which none of them contradicts
another. In robotics this is called smoothing.
"""

import itertools
import math
from collections.abc import Callable, Iterable, Iterator, Sequence, Set
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from utak.kb.localisation.hypotheses.correction import WalkCorrection
from utak.kb.localisation.hypotheses.explanation import Explanation
from utak.kb.localisation.hypotheses.frames import (
    MAX_CHECKED_OBSERVATIONS,
    Hypothesis,
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
    StraightMotion,
    line_crossings,
    observation_places,
)
from utak.kb.mapping.occupancy import FREE, OCCUPIED, OPEN, OccupancyMap
from utak.kb.objects.held_object import HeldObject, Square
from utak.kb.perception.frame import Frame

MAX_REESTIMATED_HYPOTHESES = 90  # hypotheses in which one motion is re-estimated: as many as there are orientations
QUICK_CHECK_OBSERVATIONS = 3  # observations, about, that are compared before all: most contradictions show there


def reestimate_walk(
    motion: StraightMotion,
    believed: Frame,
    observations: Sequence[Observation],
    prefixes: Callable[[Frame], ReplayPrefixes] | None = None,
) -> Iterator[Explanation]:
    """Yield other ends of a motion, each in a frame in which no observation contradicts another."""
    newest = motion.number == len(observations) - 1
    for hypothesis in _likeliest_hypotheses(motion.hypotheses):
        frame = hypothesis.frame
        begun = ReplayPrefixes(frame, observations, {}) if prefixes is None else prefixes(frame)
        found = list(_other_ends(motion, hypothesis, observations, begun))
        surest = any(one.contact_known for one in found)
        if surest or not (newest and hypothesis.frame == believed):
            yield from (one for one in found if one.contact_known == surest)


def _likeliest_hypotheses(hypotheses: tuple[Hypothesis, ...]) -> tuple[Hypothesis, ...]:
    """Return the MAX_REESTIMATED_HYPOTHESES of the least prior cost, in the order given; all when there are no more."""
    if len(hypotheses) <= MAX_REESTIMATED_HYPOTHESES:
        return hypotheses
    numbers = sorted(range(len(hypotheses)), key=lambda number: hypotheses[number].prior_cost)
    return tuple(hypotheses[number] for number in sorted(numbers[:MAX_REESTIMATED_HYPOTHESES]))


def _other_ends(
    motion: StraightMotion,
    hypothesis: Hypothesis,
    observations: Sequence[Observation],
    begun: ReplayPrefixes,
) -> Iterator[Explanation]:
    """Yield the other ends of one motion in one frame, with contacts known and unknown, in the order of the way."""
    frame, number = hypothesis.frame, motion.number
    believed, walk = observations[number].place, WalkInFrame(motion, frame, observations)
    judged: dict[bytes, RemappedMap | None] = {}
    ranges, places = stack_ranges(observations), np.array([observation.place for observation in observations])
    for end in walk.ends:
        shift = end.shift_from(believed)
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
                    all_there, first = [*before, last._replace(place=place)], begun.first(number)
                    judged[key] = remap(frame, frame, all_there, (), first, only_whether=True)
            under = judged[key]
            if under is None or under.residual:
                continue
            ahead = walk.state_ahead(end, under.occupancy)
            if ahead != FREE:
                yield _misled(hypothesis, correction, place, ahead == OCCUPIED)


def _misled(hypothesis: Hypothesis, correction: WalkCorrection, newest: Position, contact_known: bool) -> Explanation:
    """Return the explanation by another end of a motion. newest : of the observations, Utak's own frame."""
    place, far = hypothesis.frame.place_from_utak(*newest), math.hypot(*correction.shift)
    misled = Explanation("misled", place, hypothesis.frame, 0, far, None, (hypothesis,), correction)
    return misled._replace(contact_known=contact_known, prior_cost=hypothesis.prior_cost)


def remap_if_consistent(
    frame: Frame,
    observations: Sequence[Observation],
    held_objects: Iterable[HeldObject] = (),
    unsettled: Sequence[UnsettledDisc] = (),
    begun: MapReplay | None = None,
) -> RemappedMap | None:
    """Return the map of all observations in a frame; None when two of the last observations contradict each other."""
    squares = observation_squares(frame, observations)
    if not _are_consistent(frame, squares, stack_ranges(observations), unsettled):
        return None
    return remap(frame, frame, observations, held_objects, begun, only_whether=True)


def _are_consistent(
    frame: Frame,
    squares: NDArray[np.int64],
    ranges: NDArray[np.int16],
    unsettled: Sequence[UnsettledDisc] = (),
) -> bool:
    """Return whether none of the last observations contradicts another."""
    squares, ranges = squares[-MAX_CHECKED_OBSERVATIONS - 1 :], ranges[-MAX_CHECKED_OBSERVATIONS - 1 :]
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

    def shift_from(self, place: Position) -> Position:
        """Return by how much it lies from a place: (east, north) in squares, Utak's own frame."""
        return self.place[0] - place[0], self.place[1] - place[1]


class WalkInFrame:
    """A motion with an empty hand, in a frame."""

    def __init__(self, motion: StraightMotion, frame: Frame, observations: Sequence[Observation]) -> None:
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
