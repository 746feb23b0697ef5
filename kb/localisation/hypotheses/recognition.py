"""Recognition: where on a known map the robot was put down, by what it has seen since (section 3.5 of the paper).

Every square of the map is a place where it may stand. A place gains by each field that the map predicts, as much as
such a field tells: little where floor goes on, much at an edge; the rates are counted in the robot's own impressions.
It loses by each field that the map forbids. The place is known when no other place comes near.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from utak.geometry.counts.retina import FIELDS
from utak.kb.localisation.hypotheses.frames import FieldRanges, OriginBox, Position
from utak.kb.mapping.occupancy import OCCUPIED, OPEN, SIGHT_RANGE, OccupancyMap
from utak.kb.mapping.patch import Patch
from utak.kb.perception.frame import MAX_SAMPLED_SQUARES, Samples

MIN_LEAD = 6.0  # nats by which the best place must lead: the same within which explanations are kept side by side
MISFIT_LOSS = 10.0  # nats that a field of noise costs, as in kb/asp/accommodation.lp
SUBSQUARES = 8  # places within a square that are told apart, along each axis: squares of 1/8; bounds the time
MIN_VARIANCE = 0.01  # squares^2 of a field's count where all its squares are settled: it is the count, nearly
CHUNK = 256  # places that are judged at once: bounds memory

Scores = NDArray[np.float32]  # (rows, columns) of a map: the nats by which a look favours each square


class Look(NamedTuple):
    """An impression received since the robot was put down."""

    scores: Scores  # by the square from which it was received
    away: Position  # from where the robot was put down, (x, y) in squares, map frame


class Recognised(NamedTuple):
    """A place on a known map where all looks fit."""

    landing: Position  # where the robot was put down, (x, y) in squares, map frame
    error: OriginBox  # how far it may truly lie from there: west, south, east, north, in squares
    chance: float  # one of so many places: the probability of it before any look


def look_scores(
    occupancy: OccupancyMap,
    things: Sequence[tuple[Patch, Patch]],
    samples: Samples,
    ranges: FieldRanges,
    earlier: Sequence[FieldRanges],
) -> Scores:
    """Return by how much an impression favours each square of a map; -inf where the robot cannot have been.

    things : the squares that held things surely cover, and those that they may cover.
    """
    states = occupancy.state.copy()
    for sure, possible in things:
        for patch, value in ((possible, OPEN), (sure, OCCUPIED)):
            states[occupancy.squares(*patch)] = value
    chances = np.where(states == OPEN, 1.0 / (1.0 + np.exp(-occupancy.logit)), states == OCCUPIED)
    chances[~occupancy.seen & (states == OPEN)] = np.nan
    padded = np.pad(chances.astype(np.float32), SIGHT_RANGE, constant_values=np.nan)
    scores = np.full(states.shape, -np.inf, np.float32)
    rows, columns = np.nonzero((states != OCCUPIED) & occupancy.seen)
    under = samples.rows * padded.shape[1] + samples.columns
    weight, told, flat = samples.weight.astype(np.float32), _told(ranges, earlier), padded.ravel()
    low, high = (ranges[:, 0] - samples.slack).astype(np.float32), ranges[:, 1].astype(np.float32)
    for begin in range(0, len(rows), CHUNK):
        part = slice(begin, begin + CHUNK)
        base = (rows[part] + SIGHT_RANGE) * padded.shape[1] + columns[part] + SIGHT_RANGE
        at = np.where(weight > 0, flat[base[:, None, None] + under[None]], 0.0)
        mean = np.einsum("pfs,fs->pf", at, weight)
        spread = np.sqrt(np.einsum("pfs,fs->pf", at * (1.0 - at), weight) + MIN_VARIANCE)
        likely = ndtr((high + 0.5 - mean) / spread) - ndtr((low - 0.5 - mean) / spread)
        gains = np.maximum(np.log(np.maximum(likely, 1e-9)) + told, -MISFIT_LOSS)
        scores[rows[part], columns[part]] = np.nansum(gains, axis=1)  # what was never seen tells nothing
    return scores


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
    """Return where the robot was put down on a map; None where no place, or more than one, fits what it saw."""
    steps = (np.arange(SUBSQUARES) + 0.5) / SUBSQUARES
    offsets = [(u, v) for v in steps for u in steps] if len(looks) > 1 else [(0.5, 0.5)]
    totals = np.stack([_total(looks, offset) for offset in offsets])
    count = int(np.isfinite(looks[0].scores).sum())
    best = float(totals.max(initial=-np.inf))
    if not count or best < math.log(count) + MIN_LEAD:
        return None
    which, rows, columns = np.nonzero(totals > best - MIN_LEAD)
    sub = np.array(offsets)[which]
    points = np.stack([columns + sub[:, 0] + occupancy.west, rows + sub[:, 1] + occupancy.south], 1)
    first, last = points.min(0), points.max(0)
    if (last - first).max() >= 1.0:
        return None
    half = 0.5 / SUBSQUARES if len(looks) > 1 else 0.5
    middle = (first + last) / 2
    (west, south), (east, north) = (first - half - middle).tolist(), (last + half - middle).tolist()
    return Recognised((float(middle[0]), float(middle[1])), (west, south, east, north), 1.0 / count)


def _total(looks: Sequence[Look], offset: Position) -> Scores:
    """Return the scores of all looks together by the square where the robot was put down, at a point of the square."""
    total = looks[0].scores.copy()
    for look in looks[1:]:
        dx, dy = (math.floor(o + a) for o, a in zip(offset, look.away, strict=True))
        total += _shifted(look.scores, dx, dy)
    return total


def _shifted(scores: Scores, dx: int, dy: int) -> Scores:
    """Return scores by the squares from which (dx, dy) leads to those given; -inf beyond the map."""
    shifted = np.full(scores.shape, -np.inf, np.float32)
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
