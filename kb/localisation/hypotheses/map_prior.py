"""How plain the table looks on a lattice: what the simplest picture costs that agrees with all counts.

Walls and things have straight sides along the lattice, as a rule. On a lattice that lies otherwise than the table's the
same counts need crooked sides, and many more of them: in 300 random worlds the first look alone told the angle to
within two degrees in 98 of 100, long before two looks contradict each other on all other lattices.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from geometry.counts.gibbs import DRAWN, EDGE, FULL, costs, pictures
from kb.localisation.hypotheses.frames import ELSEWHERE, FrameHypothesis, Observation, fallen
from kb.localisation.hypotheses.remap import relaid
from kb.mapping.completions import SEED, CompletionTask, Image, Told, ground_of, scenes
from kb.mapping.occupancy import OccupancyMap
from kb.perception.frame import Frame

LESS_LIKELY = 0.8  # by this power of e a picture is the less likely that costs more by 1
HOT = 0.5  # the inverse temperature at which drawing begins
FAIR = (4, 60)  # pictures, and sweeps over each, that tell how plain the table looks
ROUGH = (1, 20)  # those that tell which lattices are worth more
STRAIGHT = 0.65  # what bends cost beside edges, at most, where all others are rather not tried but those NEAR degrees
NEAR = 6
STEP = 2  # degrees between those that are tried first
SOME, BEHIND = 12, 25.0  # angles about which all others are tried, at most, and log odds by which they may be behind
NOISE = 0.25  # of what a rough picture costs, that another one may cost less
ROUNDS = ((12, 20.0, (1, 40)), (6, 12.0, (2, 60)), (3, 8.0, (4, 60)))  # then so many of the best get so many more
FEW = 8  # lattices that are weighed again with the next look, at most
AGAIN = 10.0  # log odds against those
BESIDE = 2  # degrees from the likeliest: such are weighed again, too, for a single look hardly tells them apart
UNTRIED = 12.0  # log odds against those that are not tried, at least
CLOSE = 6.0  # log odds against the lattices and the maps of which it is asked once more
CLOSELY = 2  # times that it is asked so of maps
ALONG = 4.5  # log odds that the lattice lies along his own axes, beside any other angle
MOST = 16  # pictures of one effort
Effort = tuple[int, int]
Drawn = dict[Told, tuple[float, Image]]
Key = tuple[int, bytes]


class MapDescription:
    """A map, and the simplest picture of it that was drawn so far, scene by scene.

    price : what that picture costs, as log odds against it.
    """

    def __init__(self, occupancy: OccupancyMap, drawn: Drawn | None = None) -> None:
        """Drawn : what was drawn of scenes before, of this map or of others; it is added to."""
        self._view = occupancy.view()
        self._ground = ground_of(self._view)
        self._scenes = list(scenes(self._view, self._ground))
        self._least = [np.inf] * len(self._scenes)
        self._image = (self._ground == FULL).astype(np.int8)
        self._drawn: Drawn = {} if drawn is None else drawn
        self._rounds = 0
        self.price = np.inf

    def draw(self, effort: Effort = FAIR) -> float:
        """Draw so many more pictures, with so many sweeps over each; the price then."""
        for number, scene in enumerate(self._scenes):
            key = (*scene.told(self._view), *effort, self._rounds)
            if key not in self._drawn:
                self._drawn[key] = _simplest(scene, effort, SEED + MOST * self._rounds)
            least, image = self._drawn[key]
            if least < self._least[number]:
                self._least[number] = least
                open_ = scene.ground == DRAWN
                self._image[scene.rows, scene.columns][open_] = image[open_]
        self._rounds += 1
        self.price = self.cost(EDGE)
        return self.price

    def cost(self, edge: float) -> float:
        """What the simplest picture costs, as log odds against it. edge : what an edge costs."""
        return LESS_LIKELY * float(costs(self._image[None], self._ground, self._view.counts, edge)[0])

    @property
    def bends(self) -> float:
        """What corners and wrong counts cost beside the edges."""
        bends = self.cost(0.0)
        return bends / max(self.price - bends, LESS_LIKELY)


def _simplest(scene: CompletionTask, effort: Effort, seed: int) -> tuple[float, Image]:
    """What the simplest of some pictures of a scene costs, and the picture."""
    number, sweeps = effort
    images = pictures(scene.ground, scene.counts, np.repeat(scene.first[None], number, axis=0), sweeps, HOT, seed)
    prices = costs(images, scene.ground, scene.counts)
    return float(prices.min()), images[prices.argmin()]


class FrameTrial(MapDescription):
    """The same of some looks on a lattice, which lies askew less likely than along his own axes."""

    def __init__(self, frame: Frame, observations: Sequence[Observation]) -> None:
        super().__init__(relaid(frame, frame, observations, ()).occupancy)
        self._askew = ALONG * (frame.angle != 0)

    @property
    def odds(self) -> float:
        """Log odds against the lattice."""
        return self.price + self._askew


def plainness(sketches: Sequence[tuple[MapDescription, float]]) -> list[float]:
    """What the simplest picture of each map costs beside that of the plainest one, as log odds.

    Edges are not counted, for maps may differ in size. sketches : each with the log odds against its map by all else;
    most effort is spent on those that may be the likeliest.
    """
    for sketch, _ in sketches:
        sketch.draw()
    for _ in range(CLOSELY):
        odds = [sketch.cost(0.0) + against for sketch, against in sketches]
        close = [n for n, one in enumerate(odds) if one <= min(odds) + CLOSE]
        for n in close if len(close) > 1 else ():
            sketches[n][0].draw()
    prices = [sketch.cost(0.0) for sketch, _ in sketches]
    return [price - min(prices) for price in prices]


class Alike(NamedTuple):
    """Hypotheses of one angle by which the looks fell on the same squares beside each other, so that the table is one.

    against : log odds against having woken in that part of his square.
    """

    frame: Frame
    dear: float
    against: float


def weighed(hypotheses: Sequence[FrameHypothesis], observations: Sequence[Observation]) -> tuple[FrameHypothesis, ...]:
    """The same hypotheses, each with how much less likely it is than the one on which the table looks plainest.

    Of those weighed before the likely ones alone are weighed again, with the new look, and the angles beside them.
    """
    keys = [_key(hypothesis, observations) for hypothesis in hypotheses]
    same: dict[Key, list[FrameHypothesis]] = {}
    for hypothesis, key in zip(hypotheses, keys, strict=True):
        same.setdefault(key, []).append(hypothesis)
    alike = {key: _alike(own) for key, own in same.items()}
    least = min((one.dear for one in alike.values()), default=0.0)
    likely = _likely(alike, least)
    if len(likely) < 2:
        return tuple(h._replace(dear=h.dear - least) for h in hypotheses)
    if least < UNTRIED and any(one.dear for one in alike.values()):
        trials = {key: _drawn(alike[key], observations) for key in likely[:FEW]}
    else:  # for the first time, or all that were likely are given up
        trials = _first_tried(alike, observations)
    odds = {key: trial.odds + alike[key].against for key, trial in trials.items()}
    best = min(odds.values())
    close = [key for key in odds if odds[key] <= best + CLOSE]
    for key in close if len(close) > 1 else ():
        trials[key].draw()
        odds[key] = trials[key].odds + alike[key].against
    best = min(odds.values())
    dear = {key: max(one.dear - least, UNTRIED) for key, one in alike.items()}
    dear |= {key: odd - best for key, odd in odds.items()}
    return tuple(h._replace(dear=dear[key]) for h, key in zip(hypotheses, keys, strict=True))


def _key(hypothesis: FrameHypothesis, observations: Sequence[Observation]) -> Key:
    """The angle, and on which squares the looks fell beside the last one."""
    squares = fallen(hypothesis.frame, observations)
    return hypothesis.angle, (squares - squares[-1]).tobytes()


def _alike(same: Sequence[FrameHypothesis]) -> Alike:
    likeliest = max(same, key=lambda one: (one.is_centred, one.area))
    area = sum(one.area for one in same)
    against = 0.0 if likeliest.is_centred or not area else ELSEWHERE - math.log(area)
    return Alike(likeliest.frame, min(one.dear for one in same), against)


def _likely(alike: Mapping[Key, Alike], least: float) -> list[Key]:
    """Those that are worth weighing, the likeliest first."""
    best = [angle for (angle, _), one in alike.items() if one.dear == least]
    near = (
        key
        for key, one in alike.items()
        if one.dear <= least + AGAIN or any(abs(key[0] - angle) <= BESIDE for angle in best)
    )
    return sorted(near, key=lambda key: (alike[key].dear, alike[key].against, key))


def _first_tried(alike: Mapping[Key, Alike], observations: Sequence[Observation]) -> dict[Key, FrameTrial]:
    """Trials of those that may be the best: of each angle the likeliest part of his square, of the best ones others."""
    parts: dict[int, list[Key]] = {}
    for key in sorted(alike, key=lambda key: (alike[key].against, key)):
        parts.setdefault(key[0], []).append(key)
    trials = _competing({angle: alike[own[0]].frame for angle, own in parts.items()}, observations)
    leading = sorted(trials, key=lambda angle: trials[angle].odds)
    others = [key for angle in leading for key in parts[angle][1:]][:FEW]
    return {parts[angle][0]: trial for angle, trial in trials.items()} | {
        key: _drawn(alike[key], observations) for key in others
    }


def _drawn(one: Alike, observations: Sequence[Observation]) -> FrameTrial:
    trial = FrameTrial(one.frame, observations)
    trial.draw()
    return trial


def _competing(frames: dict[int, Frame], observations: Sequence[Observation]) -> dict[int, FrameTrial]:
    """Trials of those lattices that may be the best, by angle: most effort is spent on the likeliest."""
    trials: dict[int, FrameTrial] = {}

    def enter(angles: Iterable[int]) -> None:
        for angle in angles:
            if angle in frames and angle not in trials:
                trials[angle] = FrameTrial(frames[angle], observations)
                trials[angle].draw(ROUGH)

    def leading(most: int, behind: float) -> list[int]:
        ordered = sorted(trials, key=lambda angle: trials[angle].odds)[:most]
        best = trials[ordered[0]]
        return [angle for angle in ordered if trials[angle].odds <= best.odds + max(behind, NOISE * best.price)]

    enter([0])
    if 0 in trials and trials[0].draw() and trials[0].bends < STRAIGHT:
        frames = {angle: frame for angle, frame in frames.items() if abs(angle) <= NEAR}
    enter([angle for angle in frames if angle % STEP == 0] or frames)
    enter(angle + step for angle in leading(SOME, BEHIND) for step in range(1 - STEP, STEP))
    for most, behind, effort in ROUNDS:
        for angle in dict.fromkeys([*leading(most, behind), *([0] if 0 in trials else [])]):
            trials[angle].draw(effort)
    return trials
