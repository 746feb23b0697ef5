"""Map prior: the description length of the simplest map that agrees with all counts, in a frame.

Walls and objects have straight sides along the grid, as a rule. In a wrong frame the same counts need bent sides, and
many more of them. In 300 random worlds the first observation alone told the orientation to within two degrees in 98 of
100, long before two observations contradict each other in all other frames. The simplest map is sought by annealed
Gibbs sampling (Geman and Geman 1984; geometry.counts.gibbs).
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from utak.geometry.counts.gibbs import DRAWN, EDGE_COST, OCCUPIED, costs, pictures
from utak.kb.localisation.hypotheses.frames import (
    KEPT_ODDS,
    OFF_CENTRE_COST,
    Hypothesis,
    Observation,
    observation_squares,
)
from utak.kb.localisation.hypotheses.remap import remap
from utak.kb.mapping.completions import COMPLETION_SEED, CompletionTask, OccupancyImage, given_squares, scenes
from utak.kb.mapping.occupancy import OccupancyMap
from utak.kb.perception.frame import Frame

LOG_ODDS_PER_COST = 0.8  # log odds against a map for each unit of its cost; tuned
START_INVERSE_TEMPERATURE = 0.5  # of the annealing; tuned
FULL_EFFORT = (4, 60)  # completions, and sweeps over each, that tell the description length of a map; tuned
ROUGH_EFFORT = (1, 20)  # the same, to tell which frames are worth more; tuned
MAX_STRAIGHT_BENDS = 0.65  # cost of bends for each unit of cost of edges, below which Utak's own axes fit; tuned
STRAIGHT_ANGLES = 6  # degrees about Utak's own axes that are tried alone where those fit; tuned
COARSE_ANGLE_STEP = 2  # degrees between the orientations that are tried first; tuned
MAX_REFINED_ANGLES = 12  # orientations whose neighbours are tried next; tuned
MAX_REFINED_ODDS = 25.0  # log odds by which those may be behind the best one; tuned
ROUGH_COST_NOISE = 0.25  # part of the cost of a rough completion by which another one may cost less; tuned
REFINEMENT_ROUNDS = ((12, 20.0, (1, 40)), (6, 12.0, (2, 60)), (3, 8.0, (4, 60)))
# Rounds of (orientations kept, log odds they may be behind, effort that each gets then); tuned.
MAX_REWEIGHED_FRAMES = 8  # frames that are weighed again with the next observation: bounds its time; tuned
MAX_REWEIGHED_COST = 10.0  # log odds up to which a frame is weighed again; tuned
REWEIGHED_ANGLES = 2  # degrees about the best orientation that are weighed again, too: one observation confuses them
UNTRIED_COST = 12.0  # log odds against frames that are not tried, at least: above all that are weighed again
MAX_REDRAWS = 2  # times that close maps are drawn once more; tuned
OBLIQUE_COST = 4.5  # log odds against any one orientation but Utak's own axes; about ln 90, for 90 orientations
SEEDS_PER_EFFORT = 16  # random seeds reserved for each effort: more than completions in any effort
MAX_KEPT_SCENES = 512  # scenes whose simplest completions are remembered; a bound on memory
Effort = tuple[int, int]
SquaresKey = tuple[int, bytes]


class MapDescription:
    """A map, and the simplest completion of it that was drawn so far, scene by scene."""

    def __init__(self, occupancy: OccupancyMap, against: float = 0.0) -> None:
        """Begin with no completion. against : log odds (natural logarithm) against what it is the map of."""
        self._view = occupancy.view()
        self._ground = given_squares(self._view)
        self._scenes = list(scenes(self._view, self._ground))
        self._least = [np.inf] * len(self._scenes)
        self._image = (self._ground == OCCUPIED).astype(np.int8)
        self._rounds = 0
        self.price = np.inf
        self.against = against

    def draw(self, effort: Effort = FULL_EFFORT) -> float:
        """Draw more completions and return the price of the simplest one so far, in log odds (natural logarithm)."""
        for number, scene in enumerate(self._scenes):
            least, image = _simplest(scene, effort, COMPLETION_SEED + SEEDS_PER_EFFORT * self._rounds)
            if least < self._least[number]:
                self._least[number] = least
                open_ = scene.ground == DRAWN
                self._image[scene.rows, scene.columns][open_] = image[open_]
        self._rounds += 1
        self.price = self.cost(EDGE_COST)
        return self.price

    def cost(self, edge: float) -> float:
        """Return the log odds (natural logarithm) against the simplest completion; nothing is drawn."""
        return LOG_ODDS_PER_COST * float(costs(self._image[None], self._ground, self._view.counts, edge)[0])

    @property
    def odds(self) -> float:
        """Return the log odds (natural logarithm) against the map and what it is the map of; less is better."""
        return self.price + self.against

    @property
    def bend_ratio(self) -> float:
        """Return the cost of corners and wrong counts, divided by the cost of edges; small for straight sides."""
        bends = self.cost(0.0)
        return bends / max(self.price - bends, LOG_ODDS_PER_COST)


@lru_cache(maxsize=MAX_KEPT_SCENES)  # maps of several frames, and of several impressions, have scenes in common
def _simplest(scene: CompletionTask, effort: Effort, seed: int) -> tuple[float, OccupancyImage]:
    """Return the cost of the simplest of some completions of a scene, and that completion."""
    number, sweeps = effort
    first = np.repeat(scene.first[None], number, axis=0)
    images = pictures(scene.ground, scene.counts, first, sweeps, START_INVERSE_TEMPERATURE, seed)
    prices = costs(images, scene.ground, scene.counts)
    return float(prices.min()), images[prices.argmin()]


def relative_costs(maps: Sequence[MapDescription]) -> list[float]:
    """Return by how much each map costs more than the best one, in log odds (natural logarithm)."""
    # Edges are not counted, for the maps may differ in size.
    for description in maps:
        description.draw()
    for _ in range(MAX_REDRAWS):
        odds = [description.cost(0.0) + description.against for description in maps]
        close = [n for n, one in enumerate(odds) if one <= min(odds) + KEPT_ODDS]
        for n in close if len(close) > 1 else ():
            maps[n].draw()
    prices = [description.cost(0.0) for description in maps]
    return [price - min(prices) for price in prices]


class AlikeHypotheses(NamedTuple):
    """Hypotheses of one orientation with the same map: their observations fell on the same squares."""

    frame: Frame  # the likeliest of their frames
    prior_cost: float  # the least of their prior costs before, in log odds
    against: float  # log odds against having woken in that part of the square; 0 for the middle or a single point


def weigh_hypotheses(hypotheses: Sequence[Hypothesis], observations: Sequence[Observation]) -> tuple[Hypothesis, ...]:
    """Return the same hypotheses (angle and box of origins unchanged), each with its prior cost above the best."""
    keys = [_squares_key(hypothesis, observations) for hypothesis in hypotheses]
    same: dict[SquaresKey, list[Hypothesis]] = {}
    for hypothesis, key in zip(hypotheses, keys, strict=True):
        same.setdefault(key, []).append(hypothesis)
    alike = {key: _alike(own) for key, own in same.items()}
    least = min((one.prior_cost for one in alike.values()), default=0.0)
    likely = _likely(alike, least)
    if len(likely) < 2:
        return tuple(h._replace(prior_cost=h.prior_cost - least) for h in hypotheses)
    if least < UNTRIED_COST and any(one.prior_cost for one in alike.values()):
        trials = {key: _trial(alike[key].frame, observations) for key in likely[:MAX_REWEIGHED_FRAMES]}
    else:  # for the first time, or all that were likely are given up
        trials = _first_trials(alike, observations)
    odds = _odds(trials, alike)
    best = min(odds.values())
    cost = {key: max(one.prior_cost - least, UNTRIED_COST) for key, one in alike.items()}
    cost |= {key: odd - best for key, odd in odds.items()}
    return tuple(h._replace(prior_cost=cost[key]) for h, key in zip(hypotheses, keys, strict=True))


def _odds(
    trials: Mapping[SquaresKey, MapDescription], alike: Mapping[SquaresKey, AlikeHypotheses]
) -> dict[SquaresKey, float]:
    """Return the log odds (natural logarithm) against each trial, by key, origin included; the less the better."""
    for trial in trials.values():
        if trial.price == np.inf:
            trial.draw()
    odds = {key: trial.odds + alike[key].against for key, trial in trials.items()}
    best = min(odds.values())
    close = [key for key in odds if odds[key] <= best + KEPT_ODDS]
    for key in close if len(close) > 1 else ():
        trials[key].draw()
        odds[key] = trials[key].odds + alike[key].against
    return odds


def _squares_key(hypothesis: Hypothesis, observations: Sequence[Observation]) -> SquaresKey:
    """Return what hypotheses of the same map share: (angle in degrees, squares relative to the last one, as bytes)."""
    squares = observation_squares(hypothesis.frame, observations)
    return hypothesis.angle, (squares - squares[-1]).tobytes()


def _alike(same: Sequence[Hypothesis]) -> AlikeHypotheses:
    """Return hypotheses of the same map, at least one, as one."""
    likeliest = max(same, key=lambda one: (one.is_centred, one.area))
    area = sum(one.area for one in same)
    against = 0.0 if likeliest.is_centred or not area else OFF_CENTRE_COST - math.log(area)
    return AlikeHypotheses(likeliest.frame, min(one.prior_cost for one in same), against)


def _likely(alike: Mapping[SquaresKey, AlikeHypotheses], least: float) -> list[SquaresKey]:
    """Return the keys of the hypotheses that are worth weighing again, the likeliest first."""
    best = [angle for (angle, _), one in alike.items() if one.prior_cost == least]
    near = (
        key
        for key, one in alike.items()
        if one.prior_cost <= least + MAX_REWEIGHED_COST
        or any(abs(key[0] - angle) <= REWEIGHED_ANGLES for angle in best)
    )
    return sorted(near, key=lambda key: (alike[key].prior_cost, alike[key].against, key))


def _first_trials(
    alike: Mapping[SquaresKey, AlikeHypotheses], observations: Sequence[Observation]
) -> dict[SquaresKey, MapDescription]:
    """Return trials, by key, of the frames that may be best: the likeliest origin of each orientation, then others."""
    parts: dict[int, list[SquaresKey]] = {}
    for key in sorted(alike, key=lambda key: (alike[key].against, key)):
        parts.setdefault(key[0], []).append(key)
    trials = _Competition({angle: alike[own[0]].frame for angle, own in parts.items()}, observations).run()
    leading = sorted(trials, key=lambda angle: trials[angle].odds)
    others = [key for angle in leading for key in parts[angle][1:]][:MAX_REWEIGHED_FRAMES]
    return {parts[angle][0]: trial for angle, trial in trials.items()} | {
        key: _trial(alike[key].frame, observations) for key in others
    }


def _trial(frame: Frame, observations: Sequence[Observation]) -> MapDescription:
    """Return the map of some observations in a frame, with the prior of its orientation; nothing is drawn yet."""
    return MapDescription(remap(frame, frame, observations, ()).occupancy, against=OBLIQUE_COST * (frame.angle != 0))


class _Competition:
    """Trials of one frame of each orientation; the more effort is spent on a frame the likelier it is."""

    def __init__(self, frames: Mapping[int, Frame], observations: Sequence[Observation]) -> None:
        """Begin with no trial."""
        self._frames, self._observations = frames, observations
        self._trials: dict[int, MapDescription] = {}

    def run(self) -> dict[int, MapDescription]:
        """Return the trials of the frames that may be the best, by orientation; all of them were drawn."""
        trials = self._trials
        self._enter([0])
        if 0 in trials and trials[0].draw() and trials[0].bend_ratio < MAX_STRAIGHT_BENDS:
            self._frames = {angle: frame for angle, frame in self._frames.items() if abs(angle) <= STRAIGHT_ANGLES}
        self._enter([angle for angle in self._frames if angle % COARSE_ANGLE_STEP == 0] or self._frames)
        refined = self._leading(MAX_REFINED_ANGLES, MAX_REFINED_ODDS)
        self._enter(angle + step for angle in refined for step in range(1 - COARSE_ANGLE_STEP, COARSE_ANGLE_STEP))
        for most, behind, effort in REFINEMENT_ROUNDS:
            for angle in dict.fromkeys([*self._leading(most, behind), *([0] if 0 in trials else [])]):
                trials[angle].draw(effort)
        return trials

    def _enter(self, angles: Iterable[int]) -> None:
        """Try some orientations (degrees) roughly; those without a frame and those tried before are skipped."""
        for angle in angles:
            if angle in self._frames and angle not in self._trials:
                self._trials[angle] = _trial(self._frames[angle], self._observations)
                self._trials[angle].draw(ROUGH_EFFORT)

    def _leading(self, most: int, behind: float) -> list[int]:
        """Return the best orientations in degrees, the best first, at least one."""
        trials = self._trials
        ordered = sorted(trials, key=lambda angle: trials[angle].odds)[:most]
        best = trials[ordered[0]]
        limit = best.odds + max(behind, ROUGH_COST_NOISE * best.price)
        return [angle for angle in ordered if trials[angle].odds <= limit]
