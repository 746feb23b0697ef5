"""Hypotheses: how the grid of the map may lie in Utak's own frame, and which motion may have ended elsewhere.

In a wrong frame two observations, or two fields of one observation, claim of one square that it is free and that it is
occupied. A frame with such a contradiction is given up. Of the frames that are left the one with the best map prior is
preferred (kb.localisation.hypotheses.map_prior).
"""

import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from utak.geometry.counts.contradictions import total_contradictions
from utak.kb.perception.frame import CENTRE, Frame

Position = tuple[float, float]  # (x, y) or (east, north) in squares; the frame is named where it is used
OriginBox = tuple[float, float, float, float]  # west, south, east, north, within the square of waking, map frame
FieldRanges = NDArray[np.int16]  # (160, 2): least and greatest count of occupied squares of each field

MAX_CHECKED_OBSERVATIONS = 12  # observations by which orientations are judged; older contradictions are gone; tuned
FRAME_ANGLES = tuple(sorted(range(-44, 46), key=lambda angle: (abs(angle), angle)))  # degrees: a quarter turn in all
KEPT_ODDS = 6.0  # log odds within which hypotheses are kept side by side, 1 to 400: a convention
OFF_CENTRE_COST = 2.5  # log odds against having woken elsewhere than in the middle of a square: a convention
CRAMPED_SIDE = 0.1  # of a square: a side left for the origin below this, divided by the observations, is suspicious
ORIGIN_GRID = 11  # points along either side of what is left for the origin: 0.1 squares apart at most


class Hypothesis(NamedTuple):
    """A hypothesis: an orientation of the grid, where in its square Utak woke, which motion ended elsewhere."""

    # Degrees by which Utak's own frame is turned against the grid of the map, counter-clockwise positive, -44 to 45; as
    # of `Frame.angle`.
    angle: int
    # (west, south, east, north) bounds of the origin within the square of waking, in squares, map frame, 0 to 1; a
    # point where the origin is known exactly
    box: OriginBox
    # By how much the simplest map costs more than on the best frame, in log odds (natural logarithm); 0 when not
    # weighed. Of another end of a motion: by how much it is less likely than the believed one
    prior_cost: float = 0.0
    since: int | None = None  # the number of the observation after the motion that ended elsewhere; None when none did
    # By how much that observation and all later ones were made elsewhere than believed, (east, north) in squares,
    # Utak's own frame
    shift: Position = (0.0, 0.0)

    @property
    def frame(self) -> Frame:
        """Return the likeliest frame: with its origin in the middle of the square of waking if the box contains it."""
        west, south, east, north = self.box
        if west <= CENTRE[0] <= east and south <= CENTRE[1] <= north:
            return Frame(self.angle)
        return Frame(self.angle, ((west + east) / 2, (south + north) / 2))

    @property
    def is_point(self) -> bool:
        """Return whether it names the exact origin: its box is a point."""
        return self.box[:2] == self.box[2:]

    @property
    def is_centred(self) -> bool:
        """Return whether it says that the origin is exactly the middle of the square of waking."""
        return self.box == CENTRE + CENTRE

    @property
    def area(self) -> float:
        """Return the area of the box in squares^2, 0 to 1; 0 for an exact origin."""
        west, south, east, north = self.box
        return (east - west) * (north - south)

    def contains(self, frame: Frame) -> bool:
        """Return whether a frame is one of those it allows: the same angle, and an origin within the box."""
        west, south, east, north = self.box
        (x, y), point = frame.origin, self.is_point
        within = (x, y) == self.box[:2] if point else west <= x < east and south <= y < north
        return self.angle == frame.angle and within

    def split(self, place: Position) -> "list[Hypothesis]":
        """Return the parts of the hypothesis for each of which `place` lies in one square, the centre's part first."""
        west, south, east, north = self.box
        dx, dy = Frame(self.angle).to_map(*place)
        columns = _split_interval(west, east, math.ceil(dx) - dx)
        rows = _split_interval(south, north, math.ceil(dy) - dy)
        return [self._replace(box=(w, s, e, n)) for w, e in columns for s, n in rows]


def exact_hypothesis(frame: Frame) -> Hypothesis:
    """Return the hypothesis that the frame is exactly `frame`: its box is the point of the origin."""
    return Hypothesis(frame.angle, frame.origin + frame.origin)


CENTRED_HYPOTHESES = tuple(Hypothesis(angle, CENTRE + CENTRE) for angle in FRAME_ANGLES)
ALL_HYPOTHESES = tuple(Hypothesis(angle, (0.0, 0.0, 1.0, 1.0)) for angle in FRAME_ANGLES)


class ObjectPose(NamedTuple):
    """The pose of an object that was ever held, at the time of an observation."""

    name: str  # of the object
    middle: Position  # the centroid of its outline, (east, north) in squares, Utak's own frame
    degrees: float  # by which it had been turned since it was first held, counter-clockwise positive
    slack: float  # squares by which it may have lain otherwise
    # The centroid of its outline where it was first held, as believed then, (east, north) in squares, Utak's own frame
    taken: Position


class Observation(NamedTuple):
    """An impression as count ranges, and where it was made."""

    ranges: FieldRanges  # (160, 2) int16, least and greatest count of occupied squares under each field of the retina
    place: Position  # where it was made, (east, north) in squares, Utak's own frame
    moved: tuple[ObjectPose, ...] = ()  # the poses at that time of all objects that had been held by then


class UnsettledDisc(NamedTuple):
    """A disc of the table where an object was moved, so that observations need not agree there."""

    middle: Position  # its centre, (east, north) in squares, Utak's own frame
    reach: float  # its radius in squares


def count_contradictions(
    frame: Frame, observations: Sequence[Observation], unsettled: Sequence[UnsettledDisc] = ()
) -> int:
    """Return how many squares and fields contradict each other if the true frame is `frame`; 0 if it may be true."""
    squares = observation_squares(frame, observations)
    return count_contradictions_at(frame, squares, stack_ranges(observations), unsettled)


def stack_ranges(observations: Sequence[Observation]) -> NDArray[np.int16]:
    """Return the count ranges of some observations, at least one: (observations, 160, 2) int16, least and greatest."""
    return np.stack([observation.ranges for observation in observations])


def count_contradictions_at(
    frame: Frame, squares: NDArray[np.int64], ranges: NDArray[np.int16], unsettled: Sequence[UnsettledDisc] = ()
) -> int:
    """Return how many squares and fields contradict each other among observations made on the given squares."""
    apart = [(*frame.place_from_utak(*disc.middle), disc.reach) for disc in unsettled]
    discs = np.array(apart, np.float64).reshape(-1, 3)
    return total_contradictions(*frame.samples(), np.ascontiguousarray(squares), np.ascontiguousarray(ranges), discs)


def prune_hypotheses(
    hypotheses: Iterable[Hypothesis],
    observations: Sequence[Observation],
    unsettled: Sequence[UnsettledDisc] = (),
) -> tuple[Hypothesis, ...]:
    """Return what the last of the observations leaves of some hypotheses, in their order; empty when it refutes all."""
    # A hypothesis is split where the last observation would fall on different squares.
    judged: dict[tuple[int, bytes], bool] = {}
    left = []
    for part in (part for hypothesis in hypotheses for part in hypothesis.split(observations[-1].place)):
        frame = part.frame
        key = (part.angle, observation_squares(frame, observations).tobytes())
        if key not in judged:
            judged[key] = not count_contradictions(frame, observations, unsettled)
        if judged[key]:
            left.append(part)
    return tuple(left)


def consistent_hypotheses(
    observations: Sequence[Observation],
    hypotheses: Iterable[Hypothesis] = ALL_HYPOTHESES,
    unsettled: Sequence[UnsettledDisc] = (),
) -> tuple[Hypothesis, ...]:
    """Return what all observations together leave of some hypotheses, in their order; empty when they refute all."""
    left = tuple(hypotheses)
    for number in range(1, len(observations) + 1):
        left = prune_hypotheses(left, observations[:number], unsettled)
    return left


def any_origin(angles: Iterable[int]) -> tuple[Hypothesis, ...]:
    """Return a hypothesis for each orientation in `angles`, in that order, that allows every origin."""
    return tuple(Hypothesis(angle, (0.0, 0.0, 1.0, 1.0)) for angle in angles)


def observation_squares(frame: Frame, observations: Sequence[Observation]) -> NDArray[np.int64]:
    """Return the squares of the map frame on which observations were made: (observations, 2), column and row."""
    return place_squares(frame, np.array([observation.place for observation in observations]).reshape(-1, 2))


def place_squares(frame: Frame, places: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return the squares of the map frame that contain some places: (n, 2), column and row."""
    x, y = frame.place_from_utak(places[:, 0], places[:, 1])
    squares: NDArray[np.int64] = np.floor(np.stack((x, y), 1)).astype(np.int64)
    return squares


def origin_box(frame: Frame, observations: Sequence[Observation]) -> OriginBox:
    """Return the origins for which every observation falls on the square on which it is believed to have fallen."""
    away = np.array([frame.to_map(*observation.place) for observation in observations]).reshape(-1, 2)
    corners = observation_squares(frame, observations)
    west, south = np.maximum((corners - away).max(0), 0.0).tolist()
    east, north = np.minimum((corners + 1 - away).min(0), 1.0).tolist()
    return west, south, east, north


def origin_leeway(
    frame: Frame, observations: Sequence[Observation], hypotheses: Sequence[Hypothesis]
) -> tuple[float, float, float, float]:
    """Return how far the true origin may lie from the believed one."""
    west, south, east, north = origin_box(frame, observations)
    boxes = np.array([h.box for h in hypotheses if h.angle == frame.angle and not h.is_centred])
    if len(boxes):
        west, south = max(west, boxes[:, 0].min()), max(south, boxes[:, 1].min())
        east, north = min(east, boxes[:, 2].max()), min(north, boxes[:, 3].max())
    x, y = frame.origin
    return min(west - x, 0.0), min(south - y, 0.0), max(east - x, 0.0), max(north - y, 0.0)


def origin_grid(frame: Frame, observations: Sequence[Observation]) -> tuple[Hypothesis, ...]:
    """Return ORIGIN_GRID x ORIGIN_GRID exact origins, evenly spaced in the box that `origin_box` returns."""
    west, south, east, north = origin_box(frame, observations)
    steps = (np.arange(ORIGIN_GRID) + 0.5) / ORIGIN_GRID
    places = ((float(west + (east - west) * i), float(south + (north - south) * j)) for i in steps for j in steps)
    return tuple(Hypothesis(frame.angle, place + place) for place in places)


def is_cramped(hypotheses: Sequence[Hypothesis], observations: int) -> bool:
    """Return whether less room is left for the origin than so many observations leave by chance."""
    if not hypotheses or any(hypothesis.is_centred for hypothesis in hypotheses):
        return False
    west, south, east, north = np.array([hypothesis.box for hypothesis in hypotheses]).T
    return bool(min((east - west).max(), (north - south).max()) < CRAMPED_SIDE / max(observations, 1))


def grid_cell_size(points: Sequence[Hypothesis]) -> tuple[float, float]:
    """Return the width and height, in squares, of the cell for which each of some points of an origin grid stands."""
    lines = [np.unique(np.round([point.box[axis] for point in points], 9)) for axis in (0, 1)]
    width, height = (float(np.diff(line).min()) if len(line) > 1 else 0.0 for line in lines)
    return width, height


def frames_to_try(hypotheses: Sequence[Hypothesis], believed: Frame) -> list[Frame]:
    """Return the frames of some hypotheses, the likeliest first."""
    angles = sorted({h.angle for h in hypotheses})
    middle = (len(angles) - 1) / 2
    outwards = sorted(angles, key=lambda angle: (angle != 0, abs(angles.index(angle) - middle)))
    ordered = sorted(
        hypotheses, key=lambda h: (h.prior_cost, h.frame != believed, outwards.index(h.angle), -h.area, h.box)
    )
    return list(dict.fromkeys(h.frame for h in ordered))


def _split_interval(low: float, high: float, at: float) -> list[tuple[float, float]]:
    """Return an interval cut in two at a point inside it, the part that holds the middle of a square (0.5) first."""
    if not low < at < high:
        return [(low, high)]
    parts = [(low, at), (at, high)]
    return parts if at > CENTRE[0] else parts[::-1]
