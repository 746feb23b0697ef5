"""Recognition: where on a known map the robot was put down, by what it has seen since (section 3.5 of the paper).

Every square of the map is a place where it may stand. A place gains by each field that the map predicts, as much as
such a field tells: little where floor goes on, much at an edge; the rates are counted in the robot's own impressions.
It loses by each field that the map forbids. The place is known when no other place comes near.
"""

import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from utak.geometry.counts.retina import FIELDS, RETINA_REACH
from utak.geometry.kernels.arrays import Bools, Longs
from utak.kb.localisation.hypotheses.frames import KEPT_ODDS, FieldRanges, OriginBox, Position
from utak.kb.localisation.hypotheses.walk_outcomes import LINE_DISTANCE
from utak.kb.mapping.occupancy import OCCUPIED, OPEN, SIGHT_RANGE, OccupancyMap
from utak.kb.mapping.patch import Patch
from utak.kb.perception.frame import MAX_SAMPLED_SQUARES, Samples

# Log odds by which the best place must lead: twice those of what is kept side by side, as open squares count as
# independent
MIN_LEAD = 2 * KEPT_ODDS
MISFIT_LOSS = 10.0  # nats that a field of noise costs, as in kb/asp/accommodation.lp
# Nats that it costs on top of that where a place is recognised: hardly is the map wrong there, or a thing moved, too
FORBIDDEN_LOSS = 20.0
SUBSQUARES = 8  # places within a square that are told apart, along each axis: squares of 1/8; bounds the time
MIN_VARIANCE = 0.01  # squares^2, of a field's count where all its squares are settled: no count but that fits
MIN_LIKELIHOOD = 1e-9  # probability below which a field counts as forbidden: its logarithm is finite
CHUNK = 256  # places that are judged at once: bounds memory

Scores = NDArray[np.float32]  # (rows, columns) of a map: the nats by which a look favours each square


class Look(NamedTuple):
    """An impression received since the robot was put down."""

    scores: Scores  # by the square from which it was received
    away: Position  # from where the robot was put down, (x, y) in squares, map frame


class Recognised(NamedTuple):
    """A place on a known map where all looks fit."""

    place: Position  # where the newest look was made, (x, y) in squares, map frame: the likeliest
    error: OriginBox  # how far it may truly lie from there: west, south, east, north, in squares
    points: tuple[Position, ...]  # the middles of the cells of SUBSQUARES in which it may lie, the likeliest first


def place_of(likely: Sequence[Position], points: Sequence[Position], half: float) -> tuple[Position, OriginBox]:
    """Return the middle of the likely points, and how far cells of `half` a side about all of them reach from it."""
    middle = (np.min(likely, 0) + np.max(likely, 0)) / 2
    (west, south), (east, north) = np.min(points, 0) - half - middle, np.max(points, 0) + half - middle
    return (float(middle[0]), float(middle[1])), (float(west), float(south), float(east), float(north))


class KnownMap:
    """A map with what lies on it, as a look is compared with it."""

    def __init__(
        self,
        occupancy: OccupancyMap,
        things: Iterable[tuple[Patch, Patch]],
        samples: Samples,
        earlier: Sequence[FieldRanges],
    ) -> None:
        """Prepare the comparison; nothing is changed.

        things : the squares that held things surely cover, and those that they may cover. earlier : the impressions by
        which the map was made.
        """
        states = occupancy.state.copy()
        for sure, possible in things:
            for patch, value in ((possible, OPEN), (sure, OCCUPIED)):
                states[occupancy.squares(*patch)] = value
        chances = np.where(states == OPEN, 1.0 / (1.0 + np.exp(-occupancy.logit)), states == OCCUPIED)
        chances[~occupancy.seen & (states == OPEN)] = np.nan
        self._standing = states == OCCUPIED
        self._places = ~self._standing & _within_reach(occupancy.seen)
        self._index, self._samples, self._earlier = occupancy.index, samples, earlier
        padded = np.pad(chances.astype(np.float32), SIGHT_RANGE, constant_values=np.nan)
        self._chances, self._columns = padded.ravel(), padded.shape[1]

    def scores(self, ranges: FieldRanges) -> Scores:
        """Return by how much an impression favours each square: -inf where something stands, 0 where all is open."""
        scores = np.where(self._standing, np.float32(-np.inf), np.float32(0))
        rows, columns = np.nonzero(self._places)
        for begin in range(0, len(rows), CHUNK):
            part = slice(begin, begin + CHUNK)
            gains = self._gains(ranges, rows[part], columns[part])
            scores[rows[part], columns[part]] = gains.sum(1) - FORBIDDEN_LOSS * (gains <= -MISFIT_LOSS).sum(1)
        return scores

    def score_at(self, ranges: FieldRanges, place: Position) -> float:
        """Return by how much an impression favours a place, but for the fields that it forbids."""
        row, column = self._index(math.floor(place[0]), math.floor(place[1]))
        gains = self._gains(ranges, np.array([row]), np.array([column]))
        return float(gains[gains > -MISFIT_LOSS].sum())

    def _gains(self, ranges: FieldRanges, rows: Longs, columns: Longs) -> NDArray[np.float32]:
        """Return what each field gains for each of some squares, (squares, 160); what was never seen tells nothing."""
        samples = self._samples
        under = samples.rows * self._columns + samples.columns
        base = (rows + SIGHT_RANGE) * self._columns + columns + SIGHT_RANGE
        weight = samples.weight.astype(np.float32)
        at = np.where(weight > 0, self._chances[base[:, None, None] + under[None]], np.float32(0))
        mean = np.einsum("pfs,fs->pf", at, weight)
        spread = np.sqrt(np.einsum("pfs,fs->pf", at * (1 - at), weight) + np.float32(MIN_VARIANCE))
        low, high = ranges[:, 0] - samples.slack, ranges[:, 1]
        likely = ndtr((high + 0.5 - mean) / spread) - ndtr((low - 0.5 - mean) / spread)
        told = _told(ranges, self._earlier)
        gains: NDArray[np.float32] = np.nan_to_num(np.log(np.maximum(likely, MIN_LIKELIHOOD)) + told)
        return np.maximum(gains, -MISFIT_LOSS)


def _within_reach(seen: Bools) -> Bools:
    """Return the squares from which at least half of the retina's width shows squares that were seen."""
    near: Bools = seen.copy()
    for axis in (0, 1):
        wide = np.pad(near, [(RETINA_REACH // 2, RETINA_REACH // 2) if a == axis else (0, 0) for a in (0, 1)])
        near = np.asarray(np.lib.stride_tricks.sliding_window_view(wide, RETINA_REACH + 1, axis).any(-1))
    return near


def mean_likelihood(scores: Scores) -> float:
    """Return how much a look favours that the robot is anywhere on a map, or where nothing is known, in nats."""
    known = scores[_is_known(scores)]
    best = max(float(known.max(initial=0.0)), 0.0)
    anywhere = float(np.exp(known - best).sum()) / max(len(known), 1)
    return best + math.log((anywhere + math.exp(-best)) / 2)


def ndtr(x: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return the normal distribution function, to within 1e-4 (Abramowitz and Stegun, 7.1.25)."""
    z = np.abs(x) / np.float32(math.sqrt(2.0))
    t = 1.0 / (1.0 + 0.47047 * z)
    tail = 0.5 * t * (0.3480242 + t * (-0.0958798 + 0.7478556 * t)) * np.exp(-z * z)
    return np.where(x > 0, 1.0 - tail, tail)


def _told(ranges: FieldRanges, earlier: Sequence[FieldRanges]) -> NDArray[np.float64]:
    """Return how much each field tells, in nats, beside the one before it, by how often both were seen so."""
    kinds = np.array([int(math.log2(field.side)) for field in FIELDS])
    codes = kinds * (MAX_SAMPLED_SQUARES + 1)
    seen = np.ones((3 * (MAX_SAMPLED_SQUARES + 1), MAX_SAMPLED_SQUARES + 1))
    for one in earlier:
        np.add.at(seen, (codes[1:] + one[:-1, 0], one[1:, 0]), 1)
    seen /= seen.sum(1, keepdims=True)
    told = np.zeros(len(FIELDS))
    told[1:] = -np.log(seen[codes[1:] + ranges[:-1, 0], ranges[1:, 0]])
    return told


def recognise(occupancy: OccupancyMap, looks: Sequence[Look]) -> Recognised | None:
    """Return where the newest look was made on a map; None where no place, or more than one, fits what was seen."""
    steps = (np.arange(SUBSQUARES) + 0.5) / SUBSQUARES
    offsets = [(u, v) for v in steps for u in steps] if len(looks) > 1 else [(0.5, 0.5)]
    totals = np.stack([_total(looks, offset) for offset in offsets])
    count = int(_is_known(looks[-1].scores).sum())
    best = float(totals.max(initial=-np.inf))
    if not count or best < math.log(count) + MIN_LEAD:
        return None
    which, rows, columns = np.nonzero(totals > best - MIN_LEAD)
    sub = np.array(offsets)[which]
    points = np.stack([columns + sub[:, 0] + occupancy.west, rows + sub[:, 1] + occupancy.south], 1)
    if np.ptp(points, axis=0).max() > 1.0:  # more than two squares side by side
        return None
    ordered = [(x, y) for x, y in points[np.argsort(-totals[which, rows, columns], kind="stable")].tolist()]
    likely = [(x, y) for x, y in ordered if (math.floor(x), math.floor(y)) == tuple(map(math.floor, ordered[0]))]
    return Recognised(*place_of(likely, ordered, half_cell(looks)), tuple(ordered))


def half_cell(looks: Sequence[Look]) -> float:
    """Return half the side of the cells to which looks tell a place: a square by one alone."""
    return 0.5 / SUBSQUARES if len(looks) > 1 else 0.5


def _is_known(scores: Scores) -> Bools:
    """Return of which squares a map tells something."""
    known: Bools = np.isfinite(scores) & (scores != 0)
    return known


def _total(looks: Sequence[Look], offset: Position) -> Scores:
    """Return the scores of all looks together by the square of the newest one, made at a point of that square."""
    newest = looks[-1]
    total = newest.scores.copy()
    for look in looks[:-1]:
        steps = zip(offset, look.away, newest.away, strict=True)
        dx, dy = (math.floor(within + then - now) for within, then, now in steps)
        total += _shifted(look.scores, dx, dy)
    return total


def _shifted(scores: Scores, dx: int, dy: int) -> Scores:
    """Return scores by the squares from which (dx, dy) leads to those given; 0 beyond the map."""
    shifted = np.zeros(scores.shape, np.float32)
    rows, columns = scores.shape
    to = slice(max(-dy, 0), min(rows - dy, rows)), slice(max(-dx, 0), min(columns - dx, columns))
    origin = slice(max(dy, 0), min(rows + dy, rows)), slice(max(dx, 0), min(columns + dx, columns))
    if to[0].start < to[0].stop and to[1].start < to[1].stop:
        shifted[to] = scores[origin]
    return shifted


def places_within(place: Position, error: OriginBox) -> list[Position]:
    """Return a point of each square in which a place known within an error may lie, the place itself first."""
    if not any(error):
        return [place]
    west, south, east, north = place[0] + error[0], place[1] + error[1], place[0] + error[2], place[1] + error[3]
    found = [
        ((max(west, x) + min(east, x + 1)) / 2, (max(south, y) + min(north, y + 1)) / 2)
        for x in range(math.floor(west), math.ceil(east))
        for y in range(math.floor(south), math.ceil(north))
    ]
    here = math.floor(place[0]), math.floor(place[1])
    return sorted(found, key=lambda point: (math.floor(point[0]), math.floor(point[1])) != here)


def narrowed(place: Position, error: OriginBox, fitting: Sequence[Position]) -> tuple[Position, OriginBox]:
    """Return a place known within an error, and that error, once it is known to lie in a square of those that fit."""
    squares = np.floor(np.array(fitting))
    (x0, y0), (x1, y1) = squares.min(0).tolist(), (squares.max(0) + 1).tolist()
    west, south = max(place[0] + error[0], x0), max(place[1] + error[1], y0)
    east, north = min(place[0] + error[2], x1), min(place[1] + error[3], y1)
    if west > east or south > north:
        return fitting[0], (0.0, 0.0, 0.0, 0.0)
    middle = (west + east) / 2, (south + north) / 2
    return middle, (west - middle[0], south - middle[1], east - middle[0], north - middle[1])


def told_by_contact(contact: Position, place: Position, error: OriginBox) -> tuple[Position, OriginBox]:
    """Return a place known within an error, and that error, once a motion was stopped at a grid line."""
    (x, y), (west, south, east, north) = place, error
    at_column, at_row = (abs(v - round(v)) <= 2 * LINE_DISTANCE for v in contact)
    if at_column:
        x, west, east = contact[0], 0.0, 0.0
    if at_row:
        y, south, north = contact[1], 0.0, 0.0
    return (x, y), (west, south, east, north)
