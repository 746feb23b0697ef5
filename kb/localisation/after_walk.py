"""Explanations of an observation after a walk, or on waking: where the walk ended, and how the frame lies."""

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache

from geometry.motion.se2 import Translate
from kb.body import Command, Move
from kb.localisation.hypotheses.explanation import Explanation, misled
from kb.localisation.hypotheses.frames import (
    DOUBTED,
    MEMORY,
    FrameHypothesis,
    Observation,
    anywhere,
    candidates,
    cramped,
    search,
    standing,
)
from kb.localisation.hypotheses.map_prior import weighed
from kb.localisation.hypotheses.remap import Prefixes, relaid
from kb.localisation.hypotheses.walk_outcomes import (
    MotionHypothesis,
    ReestimatedWalk,
    around,
    retold,
    retold_both,
    views,
)
from kb.localisation.propose.blocked import halts, whole_first
from kb.localisation.propose.origin import misplaced
from kb.localisation.score import (
    CONTRADICTION_RESIDUAL,
    Judgement,
    Place,
    Ranges,
    SearchBudget,
    choose,
    consistent_ends,
    is_simple,
    prior_cost,
    propose_earlier_motions,
    propose_frame,
    residual,
    with_chance,
)
from kb.localisation.state import TrackerState
from kb.perception.frame import Frame

MAX_REPLAYED_OBSERVATIONS = 120  # observations replayed to try frames, for one choice: bounds its time; tuned
MIN_TRIED_FRAMES = 6  # frames that are tried at least, however many observations there are; tuned
MAX_KEPT_REPLAYS = 16  # frames whose replayed first observations are kept for other motions: bounds memory; tuned
NO_FRAME_RESIDUAL = 10**6  # residual fields when no frame is left: more than any frame can have
SETTLED_SPREAD = math.radians(5)  # orientations that differ by less hardly cause contradictions; tuned
Replays = Callable[[MotionHypothesis], Iterable[ReestimatedWalk]]


@dataclass(frozen=True)
class WalkEnds:
    """What dead reckoning says of the end of a walk.

    Attributes
    ----------
    predicted : where the walk ends if nothing stops it, map frame.
    stops : where it may have been blocked, the last place first; empty when there was no walk. Map frame.
    """

    predicted: Place
    stops: tuple[Place, ...]


def explain_walk(state: TrackerState, ranges: Ranges, ends: WalkEnds, command: Command | None) -> Judgement:
    """Return the explanation chosen for an observation after a walk, or after another motion of an empty hand.

    ranges : (160, 2) least and greatest counts of the fields. command : None on waking.
    """
    return _WalkExplainer(state, ranges, ends, command).judge()


class _WalkExplainer:
    """The proposals for one observation, in the order in which they are made; each is made only when it is needed."""

    def __init__(self, state: TrackerState, ranges: Ranges, ends: WalkEnds, command: Command | None) -> None:
        self._state, self._ranges, self._stops, self._command = state, ranges, ends.stops, command
        self._budget = SearchBudget(state.searches)
        ahead = [self._explanation("predicted", place, ends.predicted) for place in views(ends.predicted)]
        self._first = min(ahead, key=lambda one: one.misfits)
        self._predicted = self._first.place
        self._observation = Observation(ranges, state.frame.place_to_utak(*self._predicted))
        self._observations = [*state.observations, self._observation]
        self._ended = self._blocked_walk(command) if ends.stops and isinstance(command, Move) else ()
        if self._ended and not whole_first(self._ended) and not self._first.misfits:
            self._first = self._first._replace(misfits=CONTRADICTION_RESIDUAL)
        begun = lru_cache(MAX_KEPT_REPLAYS)(lambda frame: Prefixes(frame, self._observations, {}))
        self._told = cache(lambda motion: tuple(retold(motion, state.frame, self._observations, begun)))

    def judge(self) -> Judgement:
        """Return the chosen explanation, with what was learnt while choosing."""
        state, first = self._state, self._first
        if not state.loads:
            stopped = [motion for motion in state.earlier if motion.stopped]
            if first.misfits and any(not one.misfits for motion in stopped for one in self._told(motion)):
                turned = self._stopped(map(self._told, stopped))
            else:
                recent = [*state.observations[-MEMORY:], self._observation]
                left = weighed(standing(state.hypotheses, recent), recent)
                if not first.misfits and any(hypothesis.holds(state.frame) for hypothesis in left):
                    return self._judgement(self._plainest(self._ended or [first], left), left)
                turned = self._turned(left, recent)
        elif first.misfits and self._command is not None:
            surprise = state.surprise(self._command, self._ranges)
            turned = propose_frame(state, surprise, first.misfits, self._budget)
        elif self._ended:
            return self._judgement(choose(state, list(self._ended)))
        else:
            turned = []
        if not first.misfits and not turned:
            return self._judgement(first)
        if not first.misfits:  # no settled square contradicts it, but two observations contradict each other
            first = first._replace(misfits=CONTRADICTION_RESIDUAL)
        return self._judgement(choose(state, self._all(first, turned)))

    def _judgement(self, chosen: Explanation, left: tuple[FrameHypothesis, ...] | None = None) -> Judgement:
        """Return a chosen explanation with what was learnt. left : the hypotheses weighed anew, if they were."""
        return Judgement(chosen, self._budget.spent, self._ended, left)

    def _all(self, first: Explanation, turned: list[Explanation]) -> list[Explanation]:
        """Return all explanations: first the walk as predicted, then blocked, slipped, other frames, earlier motions.

        turned : the explanations by another frame.
        """
        state = self._state
        explanations = [first]
        explanations += [one for one in self._ended if one.how != "predicted"]
        explanations += [self._explanation("blocked", stop, self._predicted) for stop in self._stops if not self._ended]
        explanations += [self._explanation("slipped", place, self._predicted) for place in around(self._predicted)]
        explanations += turned
        if state.loads and self._command is not None:
            surprise = state.surprise(self._command, self._ranges)
            explanations += propose_earlier_motions(state, surprise, explanations, self._budget)
        elif self._stops:
            explanations += self._misled(turned, explanations)
            if not any(is_simple(state, one) for one in explanations):
                explanations += self._budget.search(lambda: misplaced(state.tellable, state.frame, self._observations))
        return explanations

    def _blocked_walk(self, command: Move) -> tuple[Explanation, ...]:
        """Return where the walk may have ended, its whole way included, as far as the observation agrees."""
        surprise = self._state.surprise(command, self._ranges)
        motion = Translate(*self._state.frame.to_lattice(command.east, command.north))
        found = halts(surprise, None, motion)
        ended = [(halt, self._explanation(halt.how, halt.place, found[0].place)) for halt in found]
        return consistent_ends(surprise, ended)

    def _misled(self, turned: list[Explanation], others: list[Explanation]) -> list[Explanation]:
        """Return explanations by which the newest walk, or an earlier one, was blocked where nothing was known.

        Where another frame explains everything, only contacts with something known are proposed.

        turned : the explanations by another frame. others : all explanations so far.
        """
        state = self._state
        if all(e.misfits for e in turned):
            simple = any(not e.misfits for e in others if e.how != "slipped" or state.slipped)
            return self._stopped(map(self._told, state.earlier if simple else state.tellable))
        met = [e for e in self._stopped(map(self._told, state.tellable)) if e.met or e.chance]
        if state.off_middle or not all(e.odd for e in turned):
            met = [e for e in met if e.frame == state.frame]
        return met or self._stopped_twice()

    def _stopped(self, told: Iterable[Iterable[ReestimatedWalk]]) -> list[Explanation]:
        """Return explanations by which one of some walks was blocked elsewhere than believed.

        Ends of the newest walk in the believed frame are left out if they were proposed already.

        told : the re-estimations of each walk.
        """
        state = self._state
        judged = len(state.observations) if self._ended else None
        found = ((e, e.retold) for e in misled(self._observation, told) if e.retold is not None)
        return [
            with_chance(state, e._replace(crooked=one.hypothesis.dear))
            for e, one in found
            if one.correction.since != judged or e.frame != state.frame
        ]

    def _stopped_twice(self) -> list[Explanation]:
        """Return explanations by which both the newest walk and an earlier one were blocked, in the believed frame."""
        state, newest, found = self._state, self._state.moved[-1], []
        held = [hypothesis for hypothesis in newest.hypotheses if hypothesis.frame == state.frame][:1]
        pairs = [(motion, hypothesis) for hypothesis in held for motion in reversed(state.earlier)]
        for told in (one for motion, h in pairs for one in retold_both(motion, newest, h, self._observations)):
            far = math.hypot(*told.correction.shift) + math.dist(told.newest, self._observation.place)
            place = state.frame.place_from_utak(*told.newest)
            found.append(Explanation("misled", place, state.frame, 0, far, None, state.hypotheses, told))
        return found

    def _plainest(self, ended: Sequence[Explanation], left: tuple[FrameHypothesis, ...]) -> Explanation:
        """Return the choice between the believed frame, which nothing contradicts, and the one of the best map prior.

        ended : the explanations in the believed frame. left : the frame hypotheses that are left, weighed.
        """
        state = self._state
        dear = next(h.dear for h in left if h.holds(state.frame))
        explanations = [one._replace(crooked=one.crooked + dear) for one in ended]
        if dear > 0:
            plainest = candidates(left, state.frame)[0]
            place = plainest.place_from_utak(*self._observation.place)
            explanations.append(Explanation("turned", place, plainest, 0, 0.0, None, left))
        return choose(state, explanations, ["stands"])

    def _turned(self, left: tuple[FrameHypothesis, ...], recent: list[Observation]) -> list[Explanation]:
        """Return the explanation by another frame, where observations contradict the believed one; if there is one.

        left : the frame hypotheses that are left. recent : the last observations, the new one included.
        """
        state, observation = self._state, self._observation
        if state.likely_spread <= SETTLED_SPREAD:  # another origin is likelier than another orientation
            beside = search(recent, anywhere((state.frame.angle,)))
            left = weighed((*beside, *(h for h in left if h.angle != state.frame.angle)), recent)
        frame, misfits = self._best_frame(left)
        if (misfits or prior_cost(state, frame.angle) > DOUBTED) and self._budget.frames_left:
            self._budget.spent += 1
            found = tuple(one._replace(dear=prior_cost(state, one.angle)) for one in search(recent))
            another, fewer = self._best_frame(found)
            if (fewer, prior_cost(state, another.angle)) < (misfits, prior_cost(state, frame.angle)):
                left, frame, misfits = found, another, fewer
        place = frame.place_from_utak(*observation.place)
        misfits += cramped(left, len(state.observations))
        crooked = prior_cost(state, frame.angle)
        return [Explanation("turned", place, frame, misfits, 0.0, None, left, crooked=crooked)] * bool(left)

    def _best_frame(self, left: tuple[FrameHypothesis, ...]) -> tuple[Frame, int]:
        """Return the frame of the least residual over all observations among those left, and that residual."""
        state = self._state
        if not left:
            return state.frame, NO_FRAME_RESIDUAL
        tried: list[tuple[int, int]] = []
        most = max(MIN_TRIED_FRAMES, MAX_REPLAYED_OBSERVATIONS // (len(state.observations) + 1))
        frames = candidates(left, state.frame)[:most]
        for number, frame in enumerate(frames):
            tried.append((relaid(frame, state.frame, self._observations, ()).misfits, number))
            if tried[-1][0] == 0:
                break
        misfits, number = min(tried)
        return frames[number], misfits

    def _explanation(self, how: str, place: Place, predicted: Place) -> Explanation:
        """Return the explanation that the observation was made at `place`. predicted : by dead reckoning; map frame."""
        misfits = residual(self._state, self._ranges, place, self._state.loads.values())
        return Explanation(how, place, self._state.frame, misfits, math.dist(place, predicted))
