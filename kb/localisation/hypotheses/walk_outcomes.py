"""Walk outcomes: where a straight motion may have ended otherwise than commanded.

Utak is a point, so a contact stops it on a grid line. In the believed frame contacts are rare, for motions lead over
squares that are believed free. In a wrong frame they are common, and neither the contact nor the frame is explained
without the other. What the first observation after a motion leaves open a later one may tell. So motions are
remembered, and re-estimated when observations contradict each other.
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
from kb.localisation.hypotheses.remap import RemappedMap, Replay, ReplayPrefixes, remap
from kb.mapping.occupancy import FREE, FULL, OPEN, OccupancyMap
from kb.objects.held_object import HeldObject, Square
from kb.perception.frame import Frame

MAX_REESTIMATED_HYPOTHESES = 90  # hypotheses in which one motion is re-estimated: as many as there are orientations
QUICK_CHECK_OBSERVATIONS = 3  # observations, about, that are compared before all: most contradictions show there
MAX_WALK_SLIP = 2  # squares from the predicted end within which a slipped walk is looked for; tuned
LINE_DISTANCE = 1e-6  # squares from a grid line to a place right beside it; the physics stops motions within 1e-6


class Crossing(NamedTuple):
    """A crossing of a grid line by a motion, and the square that is entered there, map frame.

    A motion that is blocked there ends on the line, and the observation is made from the square further north and east
    on the table. How the table is turned is unknown, so it may be either side.

    Attributes
    ----------
    before : the place LINE_DISTANCE this side of the line.
    after : the place LINE_DISTANCE beyond it.
    entered : the square beyond.
    """

    before: Position
    after: Position
    entered: Square


class MotionHypothesis(NamedTuple):
    """A straight motion as it was commanded, and where else it may have ended.

    Attributes
    ----------
    number : of the observation after it.
    shift : the commanded motion, (east, north) in squares, Utak's own frame.
    hypotheses : the frame hypotheses before that observation.
    blocked : whether it is believed to have been blocked.
    load : the name of the object in hand; None when there was none.
    alternative_ends : other ends that agree with that observation, Utak's own frame, each with its probability.
    """

    number: int
    shift: Position
    hypotheses: tuple[FrameHypothesis, ...]
    blocked: bool = False
    load: str | None = None
    alternative_ends: tuple[tuple[Position, float], ...] = ()

    def likely_ends(self, min_chance: float) -> list[Position]:
        """Return the other ends of a probability above `min_chance`, Utak's own frame."""
        return [there for there, chance in self.alternative_ends if chance > min_chance]

    def chance_of_end(self, place: Position) -> float | None:
        """Return the probability of an end at `place`, Utak's own frame; None when it is no known other end."""
        near = (chance for there, chance in self.alternative_ends if math.dist(there, place) < 4 * LINE_DISTANCE)
        return max(near, default=None)


class WalkCorrection(NamedTuple):
    """A shift of all observations from one on, and of the objects that were seen or moved from there.

    Attributes
    ----------
    since : the number of the first observation that is shifted.
    shift : from the believed place to the corrected one, (east, north) in squares, Utak's own frame.
    seen : objects that were first held since, by name, each with the shift of where it lies and lay, same frame.
    hauled : the name of the object in hand on the motion that is corrected; None when there was none.
    """

    since: int
    shift: Position
    seen: tuple[tuple[str, Position], ...] = ()
    hauled: str | None = None

    def place(self, place: Position) -> Position:
        """Return a place since the motion as corrected, Utak's own frame."""
        return add(place, self.shift)

    def observations(self, observations: Sequence[Observation]) -> list[Observation]:
        """Return all observations, with corrected places."""
        since = [
            observation._replace(place=self.place(observation.place), moved=tuple(map(self._pose, observation.moved)))
            for observation in observations[self.since :]
        ]
        return [*observations[: self.since], *since]

    def loads(self, loads: Mapping[str, HeldObject], frame: Frame) -> dict[str, HeldObject]:
        """Return all held objects where they lie and lay as corrected. frame : the map frame of `loads`."""
        return {name: self._load(load, frame) for name, load in loads.items()}

    def _pose(self, pose: ObjectPose) -> ObjectPose:
        """Return the corrected pose of an object at an observation since the motion."""
        aside = self._aside(pose.name)
        if pose.name != self.hauled:
            pose = pose._replace(taken=add(pose.taken, aside))
        return pose._replace(middle=add(pose.middle, aside))

    def _load(self, load: HeldObject, frame: Frame) -> HeldObject:
        """Return an object where it lies as corrected."""
        aside = Translate(*frame.to_lattice(*self._aside(load.name)))
        if not any(aside):
            return load
        first = load.first if load.name == self.hauled else aside.carry(load.first)
        return replace(load.lying(aside.carry(load.polygon), load.slack), first=first)

    def _aside(self, name: str) -> Position:
        """Return the shift of an object, Utak's own frame."""
        return self.shift if name == self.hauled else dict(self.seen).get(name, (0.0, 0.0))


class ReestimatedWalk(NamedTuple):
    """A re-estimated motion: a frame, and the correction of an earlier motion with which observations agree.

    Attributes
    ----------
    hypothesis : of the frame.
    correction : of all observations since that motion.
    contact_known : whether something known stands where the motion was blocked then.
    residual : fields that contradict it, over all observations.
    newest : where the newest observation was made then, Utak's own frame.
    """

    hypothesis: FrameHypothesis
    correction: WalkCorrection
    contact_known: bool
    residual: int
    newest: Position = (0.0, 0.0)


# -- places at and beside grid lines ---------------------------------------------------------------


def blocked_ends(start: Position, shift: Position) -> tuple[Position, ...]:
    """Return where a motion may have been blocked, map frame: both sides of each grid line, the last first.

    The start is the last of them. There are none for a motion of length 0.
    """
    lines = reversed(line_crossings(start, shift))
    found = [place for crossing in lines for place in (crossing.after, crossing.before)]
    return (*found, start) if any(shift) else ()


def slipped_ends(place: Position) -> tuple[Position, ...]:
    """Return the places whole squares away from `place`, up to MAX_WALK_SLIP in each axis, the nearest first."""
    reach = range(-MAX_WALK_SLIP, MAX_WALK_SLIP + 1)
    offsets = sorted((i * i + j * j, i, j) for i in reach for j in reach if i or j)
    return tuple((place[0] + i, place[1] + j) for _, i, j in offsets)


def line_crossings(start: Position, shift: Position) -> tuple[Crossing, ...]:
    """Return where a motion crosses grid lines, in order, map frame.

    Through a corner of squares the motion enters the two squares beside it first, one after the other, and then the one
    beyond.
    """
    found: list[tuple[float, int, Crossing]] = []
    signs = [math.copysign(LINE_DISTANCE, v) for v in shift]
    for axis in (0, 1):
        low, high = sorted((start[axis], start[axis] + shift[axis]))
        for line in range(math.floor(low) + 1, math.ceil(high)):
            part = (line - start[axis]) / shift[axis]
            across = start[1 - axis] + shift[1 - axis] * part
            other, when = round(across), round(part, 9)
            if (
                shift[1 - axis] and abs(across - other) < LINE_DISTANCE
            ):  # at a corner: still this side of the other line
                across = other - signs[1 - axis]
                if axis == 1:
                    found.append((when, 2, _crossing(line, other + signs[0], axis, signs[1])))
            found.append((when, axis, _crossing(line, across, axis, signs[axis])))
    return tuple(crossing for *_, crossing in sorted(found))


def on_line(place: Position) -> Position:
    """Return `place` with each coordinate within 2e-6 squares of a grid line moved onto it, map frame.

    A contact stopped the motion there, so the robot is on the line.
    """
    x, y = (float(round(v)) if abs(v - round(v)) <= 2 * LINE_DISTANCE else v for v in place)
    return x, y


def snap_to_middle(place: Position) -> Position:
    """Return `place` with each coordinate within 2e-6 squares of the middle of a square moved onto it, map frame.

    Motions from beside a grid line to the middle of a square end that near to it.
    """
    x, y = (math.floor(v) + 0.5 if abs(v - math.floor(v) - 0.5) <= 2 * LINE_DISTANCE else v for v in place)
    return x, y


def observation_places(place: Position) -> tuple[Position, ...]:
    """Return the places from which the observation at `place` may be made, one for each square that it touches.

    Within 2e-6 squares of a grid line those are both sides of the line, at a grid corner all four squares; else it is
    `place` alone. Map frame.
    """
    columns, rows = (
        (v,) if abs(v - round(v)) > 2 * LINE_DISTANCE else (round(v) - LINE_DISTANCE, round(v) + LINE_DISTANCE)
        for v in place
    )
    return tuple((x, y) for x in columns for y in rows)


def entered_square(place: Position, towards: Position) -> Square:
    """Return the square that a motion from `place` towards a point was about to enter, map frame."""
    away = math.dist(place, towards) or 1.0
    ahead = [a + (b - a) / away for a, b in zip(place, towards, strict=True)]
    return math.floor(ahead[0]), math.floor(ahead[1])


def add(place: Position, shift: Position) -> Position:
    """Return the sum of a place and a shift of the same frame."""
    return place[0] + shift[0], place[1] + shift[1]


def _own_observation_places(place: Position, frame: Frame) -> list[Position]:
    """Return `observation_places` for a place of Utak's own frame, in that frame."""
    return [frame.place_to_utak(*view) for view in observation_places(frame.place_from_utak(*place))]


def _crossing(line: int, across: float, axis: int, onward: float) -> Crossing:
    """Return the crossing of a line of one axis, at a place along it. onward : LINE_DISTANCE with the motion's sign."""
    before, after = ((at, across) if axis == 0 else (across, at) for at in (line - onward, line + onward))
    return Crossing(before, after, (math.floor(after[0]), math.floor(after[1])))


# -- re-estimation of walks ------------------------------------------------------------------------


def reestimate_walk(
    motion: MotionHypothesis,
    believed: Frame,
    observations: Sequence[Observation],
    prefixes: Callable[[Frame], ReplayPrefixes] | None = None,
) -> Iterator[ReestimatedWalk]:
    """Yield other ends of a motion, each with the frame in which no observation contradicts another.

    Until it was blocked the motion entered no occupied square, and it was blocked before no free one. Where a contact
    with something known is possible, contacts with open squares are left out. Not yielded: what is believed already,
    and a contact of the newest motion with something unknown in the believed frame.

    Parameters
    ----------
    motion : a motion with an empty hand, with the frame hypotheses to try.
    believed : the believed frame.
    observations : all, at their believed places; the newest where it was commanded.
    prefixes : returns the replays of the first observations in a frame; made anew for each frame when None.
    """
    newest = motion.number == len(observations) - 1
    for hypothesis in _likeliest_hypotheses(motion.hypotheses):
        frame = hypothesis.frame
        begun = ReplayPrefixes(frame, observations, {}) if prefixes is None else prefixes(frame)
        found = list(_other_ends(motion, hypothesis, observations, begun))
        surest = any(one.contact_known for one in found)
        if surest or not (newest and hypothesis.frame == believed):
            yield from (one for one in found if one.contact_known == surest)


def _likeliest_hypotheses(hypotheses: tuple[FrameHypothesis, ...]) -> tuple[FrameHypothesis, ...]:
    """Return the MAX_REESTIMATED_HYPOTHESES of the least prior cost, in their order."""
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
    """Yield the other ends of one motion in one frame. begun : the replays of the first observations in that frame."""
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
                yield ReestimatedWalk(hypothesis, correction, ahead == FULL, under.residual, place)


def reestimate_two_walks(
    motion: MotionHypothesis, newest: MotionHypothesis, hypothesis: FrameHypothesis, observations: Sequence[Observation]
) -> Iterator[ReestimatedWalk]:
    """Yield ends of an earlier motion and of the newest one, both blocked by something known, without contradictions.

    A motion that goes on against what blocked the one before it does not move at all.

    hypothesis : of the frame. observations : as for `reestimate_walk`.
    """
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
            if under is None or under.residual or walk.state_ahead(end, under.occupancy) != FULL:
                continue
            if halt in still or onward.state_ahead(halt, under.occupancy) == FULL:
                yield ReestimatedWalk(hypothesis, correction, True, 0, halt.place)


def remap_if_consistent(
    frame: Frame,
    observations: Sequence[Observation],
    loads: Iterable[HeldObject] = (),
    unsettled: Sequence[UnsettledDisc] = (),
    recent: int = MAX_CHECKED_OBSERVATIONS + 1,
    begun: Replay | None = None,
    only_whether: bool = True,
) -> RemappedMap | None:
    """Return the map of all observations in a frame; None when two of the last observations contradict each other.

    loads : all held objects, in that frame. unsettled : where observations need not agree. recent : how many of the
    last observations are compared. begun, only_whether : as for kb.localisation.hypotheses.remap.remap.
    """
    squares = observation_squares(frame, observations)
    if not _are_consistent(frame, squares, stack_ranges(observations), unsettled, recent):
        return None
    return remap(frame, frame, observations, loads, begun, only_whether)


def _are_consistent(
    frame: Frame,
    squares: NDArray[np.int64],
    ranges: NDArray[np.int16],
    unsettled: Sequence[UnsettledDisc] = (),
    recent: int = MAX_CHECKED_OBSERVATIONS + 1,
) -> bool:
    """Return whether none of the last observations contradicts another; parameters as of `count_contradictions_at`."""
    squares, ranges = squares[-recent:], ranges[-recent:]
    apart = len(squares) // QUICK_CHECK_OBSERVATIONS
    if apart > 1 and count_contradictions_at(frame, squares[::-apart], ranges[::-apart], unsettled):  # with the newest
        return False
    return not count_contradictions_at(frame, squares, ranges, unsettled)


class WalkEnd(NamedTuple):
    """A possible end of a motion.

    Attributes
    ----------
    place : Utak's own frame.
    progress : how far the motion had come: the number of grid lines crossed before it, or, with an object in hand, the
        part of the motion, 0 to 1.
    """

    place: Position
    progress: float


class WalkInFrame:
    """A motion with an empty hand, in a frame.

    Attributes
    ----------
    ends : where it may have been blocked, in the order of the way, and last its commanded end.
    """

    def __init__(self, motion: MotionHypothesis, frame: Frame, observations: Sequence[Observation]) -> None:
        """Find the ends of a motion. observations : all, at their believed places."""
        x, y = observations[motion.number - 1].place
        self._met = met = line_crossings(frame.place_from_utak(x, y), frame.to_lattice(*motion.shift))
        halts = [
            WalkEnd(frame.place_to_utak(*place), at)
            for at in range(len(met))
            for place in observation_places(met[at].before)
        ]
        self.ends = (*halts, WalkEnd((x + motion.shift[0], y + motion.shift[1]), len(met)))

    def state_ahead(self, end: WalkEnd, occupancy: OccupancyMap, things: Set[Square] = frozenset()) -> int:
        """Return the state of the square that blocked the motion at `end`; FREE if one before it was occupied.

        things : squares that were occupied then by objects moved since.
        """
        at = int(end.progress)
        entered = [crossing.entered for crossing in self._met[: at + 1]]
        states = (FULL if square in things else _square_state(occupancy, square) for square in entered)
        if FULL in itertools.islice(states, at):
            return FREE
        return next(states, OPEN)


def _square_state(occupancy: OccupancyMap, square: Square) -> int:
    """Return the state of a square of the map."""
    row, column = occupancy.index(*square)
    return int(occupancy.state[row, column])
