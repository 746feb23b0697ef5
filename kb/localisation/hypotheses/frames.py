"""How the lattice of the table may lie under Utak, judged by all looks so far.

Under a wrong angle two looks, or two fields of one look, claim of one square that it is free and that it is occupied.
A lattice that leads to such a contradiction is given up. Of those that stand that one is preferred on which the table
looks plainest (kb.localisation.hypotheses.map_prior).
"""

import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from geometry.counts.contradictions import contradicting
from kb.perception.frame import CENTRE, Frame

Box = tuple[float, float, float, float]  # west, south, east, north
MEMORY = 12  # looks by which angles are judged: those that contradict older looks are gone already
ANGLES = tuple(sorted(range(-44, 46), key=lambda angle: (abs(angle), angle)))


class FrameHypothesis(NamedTuple):
    """How the lattice may lie.

    Its angle in degrees, and a box (west, south, east, north) within the square, in which Utak woke. dear : by how many
    edges the simplest picture on it costs more than the simplest on any other; 0 when that was not weighed.
    """

    angle: int
    box: Box
    dear: float = 0.0

    @property
    def frame(self) -> Frame:
        """The lattice, with the middle of the box for the point where he woke.

        The square's centre where that will do.
        """
        west, south, east, north = self.box
        if west <= CENTRE[0] <= east and south <= CENTRE[1] <= north:
            return Frame(self.angle)
        return Frame(self.angle, ((west + east) / 2, (south + north) / 2))

    @property
    def is_point(self) -> bool:
        """Does it say exactly where he woke?"""
        return self.box[:2] == self.box[2:]

    @property
    def is_centred(self) -> bool:
        """Does it say that he woke right amid his square?"""
        return self.box == CENTRE + CENTRE

    @property
    def is_plausible(self) -> bool:
        """Is the table hardly less plain on it than on any other?"""
        return self.dear <= DOUBTED

    @property
    def area(self) -> float:
        """Of the box, in squares^2."""
        west, south, east, north = self.box
        return (east - west) * (north - south)

    def holds(self, frame: Frame) -> bool:
        """Does it say that a lattice may be the true one?"""
        west, south, east, north = self.box
        (x, y), point = frame.origin, self.is_point
        within = (x, y) == self.box[:2] if point else west <= x < east and south <= y < north
        return self.angle == frame.angle and within

    def split(self, place: tuple[float, float]) -> "list[FrameHypothesis]":
        """Cut the box where the square changes on which he stands at a place of his own frame.

        The part with the centre first.
        """
        west, south, east, north = self.box
        dx, dy = Frame(self.angle).to_lattice(*place)
        columns = _cut(west, east, math.ceil(dx) - dx)
        rows = _cut(south, north, math.ceil(dy) - dy)
        return [self._replace(box=(w, s, e, n)) for w, e in columns for s, n in rows]


def exactly(frame: Frame) -> FrameHypothesis:
    """That it is just this lattice, and he woke just there."""
    return FrameHypothesis(frame.angle, frame.origin + frame.origin)


CENTRED = tuple(FrameHypothesis(angle, CENTRE + CENTRE) for angle in ANGLES)
ANYWHERE = tuple(FrameHypothesis(angle, (0.0, 0.0, 1.0, 1.0)) for angle in ANGLES)
DOUBTED = 5.0  # edges by which the simplest picture may cost more on a lattice that is likely yet
ELSEWHERE = 2.5  # log odds against having woken elsewhere than amid his square
ODD = 0.1  # of the side of the square that looks leave of it on average, below which they left suspiciously little
GRID = 11  # points along either side of what is left of the square in which he woke


class PlacedObservation(NamedTuple):
    """Where a thing lay that Utak has moved, or was to move later, when he looked.

    middle : of its outline, in his own frame. degrees : by which it was turned since he first held it. slack : squares
    by which it may have lain otherwise. taken : the middle of its outline where he first held it, as was believed then.
    """

    name: str
    middle: tuple[float, float]
    degrees: float
    slack: float
    taken: tuple[float, float]


class Observation(NamedTuple):
    """One impression's count ranges (160, 2), and where it was received: (east, north) of Utak's own frame.

    moved : where the things lay that he had moved by then.
    """

    ranges: NDArray[np.int16]
    place: tuple[float, float]
    moved: tuple[PlacedObservation, ...] = ()


class OriginDisc(NamedTuple):
    """A part of the table, in Utak's own frame, of which looks need not agree, for things were moved there."""

    middle: tuple[float, float]
    reach: float


def contradictions(frame: Frame, observations: Sequence[Observation], unsettled: Sequence[OriginDisc] = ()) -> int:
    """How many squares and fields contradict each other if the lattice lies like this.

    Squares under fields that are quite full or quite empty are compared with each other, and other fields with them;
    those on an unsettled part of the table with nothing.
    """
    return clashing(frame, fallen(frame, observations), stacked(observations), unsettled)


def stacked(observations: Sequence[Observation]) -> NDArray[np.int16]:
    """(looks, 160, 2): the count ranges of some looks."""
    return np.stack([observation.ranges for observation in observations])


def clashing(
    frame: Frame, squares: NDArray[np.int64], ranges: NDArray[np.int16], unsettled: Sequence[OriginDisc] = ()
) -> int:
    """The same of looks with these count ranges, (looks, 160, 2), that were received on these squares, (looks, 2)."""
    apart = [(*frame.place_from_utak(*disc.middle), disc.reach) for disc in unsettled]
    discs = np.array(apart, np.float64).reshape(-1, 3)
    return contradicting(*frame.samples(), np.ascontiguousarray(squares), np.ascontiguousarray(ranges), discs)


def standing(
    hypotheses: Iterable[FrameHypothesis], observations: Sequence[Observation], unsettled: Sequence[OriginDisc] = ()
) -> tuple[FrameHypothesis, ...]:
    """What is left of the hypotheses when the last of these looks is taken into account, in order of preference.

    Hypotheses by which every look fell on the same squares stand or fall together.
    """
    judged: dict[tuple[int, bytes], bool] = {}
    left = []
    for part in (part for hypothesis in hypotheses for part in hypothesis.split(observations[-1].place)):
        frame = part.frame
        key = (part.angle, fallen(frame, observations).tobytes())
        if key not in judged:
            judged[key] = not contradictions(frame, observations, unsettled)
        if judged[key]:
            left.append(part)
    return tuple(left)


def search(
    observations: Sequence[Observation],
    hypotheses: Iterable[FrameHypothesis] = ANYWHERE,
    unsettled: Sequence[OriginDisc] = (),
) -> tuple[FrameHypothesis, ...]:
    """All that these looks leave of some hypotheses: of all that there are, wherever in his square Utak woke."""
    left = tuple(hypotheses)
    for number in range(1, len(observations) + 1):
        left = standing(left, observations[:number], unsettled)
    return left


def anywhere(angles: Iterable[int]) -> tuple[FrameHypothesis, ...]:
    """The hypotheses of some angles, wherever in his square Utak woke."""
    return tuple(FrameHypothesis(angle, (0.0, 0.0, 1.0, 1.0)) for angle in angles)


def fallen(frame: Frame, observations: Sequence[Observation]) -> NDArray[np.int64]:
    """(looks, 2): the squares of the lattice on which looks were received."""
    return squares_of(frame, np.array([observation.place for observation in observations]).reshape(-1, 2))


def squares_of(frame: Frame, places: NDArray[np.float64]) -> NDArray[np.int64]:
    """(n, 2): the squares of the lattice in which places (n, 2) of his own frame lie."""
    x, y = frame.places_from_utak(places[:, 0], places[:, 1])
    squares: NDArray[np.int64] = np.floor(np.stack((x, y), 1)).astype(np.int64)
    return squares


def within(frame: Frame, observations: Sequence[Observation]) -> Box:
    """Where Utak may have woken if every look fell on the square that it is believed to have fallen on.

    Wherever in it that was, all that stands looked the same.
    """
    away = np.array([frame.to_lattice(*observation.place) for observation in observations]).reshape(-1, 2)
    corners = fallen(frame, observations)
    west, south = np.maximum((corners - away).max(0), 0.0).tolist()
    east, north = np.minimum((corners + 1 - away).min(0), 1.0).tolist()
    return west, south, east, north


def leeway(frame: Frame, observations: Sequence[Observation], hypotheses: Sequence[FrameHypothesis]) -> Box:
    """How far from where he believes it Utak may have woken: to the west and south (not above 0), east and north.

    That he woke amid his square he only assumes.
    """
    west, south, east, north = within(frame, observations)
    boxes = np.array([h.box for h in hypotheses if h.angle == frame.angle and not h.is_centred])
    if len(boxes):
        west, south = max(west, boxes[:, 0].min()), max(south, boxes[:, 1].min())
        east, north = min(east, boxes[:, 2].max()), min(north, boxes[:, 3].max())
    x, y = frame.origin
    return min(west - x, 0.0), min(south - y, 0.0), max(east - x, 0.0), max(north - y, 0.0)


def points(frame: Frame, observations: Sequence[Observation]) -> tuple[FrameHypothesis, ...]:
    """GRID by GRID points at which Utak may have woken if every look fell on the square that it is believed to."""
    west, south, east, north = within(frame, observations)
    steps = (np.arange(GRID) + 0.5) / GRID
    places = ((float(west + (east - west) * i), float(south + (north - south) * j)) for i in steps for j in steps)
    return tuple(FrameHypothesis(frame.angle, place + place) for place in places)


def cramped(hypotheses: Sequence[FrameHypothesis], observations: int) -> bool:
    """Is less room left for where he woke than so many looks leave by chance?

    Each look cuts either side of his square in two, anywhere. Then a side of what he truly woke in is shorter than
    ODD / looks about once in two hundred times: more likely a look was received elsewhere than is believed.
    """
    if not hypotheses or any(hypothesis.is_centred for hypothesis in hypotheses):
        return False
    west, south, east, north = np.array([hypothesis.box for hypothesis in hypotheses]).T
    return bool(min((east - west).max(), (north - south).max()) < ODD / max(observations, 1))


def cells(where: Sequence[FrameHypothesis]) -> tuple[float, float]:
    """How wide and how high a cell of a grid is for which each of some of its points stands."""
    lines = [np.unique(np.round([point.box[axis] for point in where], 9)) for axis in (0, 1)]
    width, height = (float(np.diff(line).min()) if len(line) > 1 else 0.0 for line in lines)
    return width, height


def candidates(hypotheses: Sequence[FrameHypothesis], held: Frame) -> list[Frame]:
    """The lattices to try, the likeliest first: those on which the table is plainest, the one held, one along his own
    axes, then from the middle outwards.

    Of one angle that first which leaves the most room for where he woke.
    """
    angles = sorted({h.angle for h in hypotheses})
    middle = (len(angles) - 1) / 2
    outwards = sorted(angles, key=lambda angle: (angle != 0, abs(angles.index(angle) - middle)))
    ordered = sorted(hypotheses, key=lambda h: (h.dear, h.frame != held, outwards.index(h.angle), -h.area, h.box))
    return list(dict.fromkeys(h.frame for h in ordered))


def _cut(low: float, high: float, at: float) -> list[tuple[float, float]]:
    """An interval cut in two at a point inside it; the part that holds the middle of a square first."""
    if not low < at < high:
        return [(low, high)]
    parts = [(low, at), (at, high)]
    return parts if at > CENTRE[0] else parts[::-1]
