"""What a look says that was received after a walk, or on waking: how it came about, and how the lattice lies."""

import math
from collections.abc import Callable, Iterable, Sequence
from functools import cache, lru_cache

import numpy as np
from numpy.typing import NDArray

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
from kb.localisation.score import CONTRADICTED, MOST_SEARCHES, Judging, Place
from kb.perception.frame import Frame

MOST_REPLAYS = 120  # looks that are taken in anew, to try lattices, before one is believed
KEPT = 16  # lattices on which the first looks are kept laid, for other motions
NONE_FITS = 10**6  # misfits of no lattice at all
SETTLED = math.radians(5)  # by which angles may differ while that hardly is why looks contradict


class Walked(Judging):
    """What is held true, with the explanations of a look after a walk."""

    def _explain(
        self, ranges: NDArray[np.int16], predicted: Place, stops: tuple[Place, ...], command: Command | None
    ) -> Explanation:
        ahead = [self._explanation("predicted", place, ranges, predicted) for place in views(predicted)]
        first = min(ahead, key=lambda one: one.misfits)
        predicted = first.place
        observation = Observation(ranges, self.frame.place_to_utak(*predicted))
        halted = self._halted_walk(command, ranges) if stops and command is not None else []
        if halted and not whole_first(halted) and not first.misfits:
            first = first._replace(misfits=CONTRADICTED)
        observations = [*self.observations, observation]
        begun = lru_cache(KEPT)(lambda frame: Prefixes(frame, observations, {}))
        told = cache(lambda motion: tuple(retold(motion, self.frame, observations, begun)))
        stopped = [motion for motion in self.earlier if motion.stopped]
        if first.misfits and not self.loads and any(not one.misfits for motion in stopped for one in told(motion)):
            turned = self._stopped(observation, map(told, stopped))
        elif not self.loads:
            recent = [*self.observations[-MEMORY:], observation]
            left = weighed(standing(self.hypotheses, recent), recent)
            if not first.misfits and any(hypothesis.holds(self.frame) for hypothesis in left):
                return self._plainest(halted or [first], observation, left)
            turned = self._turned(observation, left, recent)
        elif first.misfits and command is not None:
            turned = self._elsewhere(self._surprise(command, ranges), first.misfits)
        elif halted:
            return self._choose(halted)
        else:
            turned = []
        if not first.misfits and not turned:
            return first
        if not first.misfits:  # no settled square is otherwise, but two looks contradict each other on this lattice
            first = first._replace(misfits=CONTRADICTED)
        explanations = [first]
        explanations += [one for one in halted if one.how != "predicted"]
        explanations += [self._explanation("blocked", stop, ranges, predicted) for stop in stops if not halted]
        explanations += [self._explanation("slipped", place, ranges, predicted) for place in around(predicted)]
        explanations += turned
        if self.loads and command is not None:
            explanations += self._recalled(self._surprise(command, ranges), explanations)
        elif stops:
            explanations += self._misled(observation, told, turned, explanations)
            if not any(map(self._simple, explanations)):
                explanations += self._at_length(
                    lambda: misplaced(self.tellable, self.frame, [*self.observations, observation])
                )
        return self._choose(explanations)

    def _halted_walk(self, command: Command, ranges: NDArray[np.int16]) -> list[Explanation]:
        """Where a walk came to a halt that may have been stopped, of the halts that the look bears out."""
        assert isinstance(command, Move)
        surprise = self._surprise(command, ranges)
        motion = Translate(*self.frame.to_lattice(command.east, command.north))
        found = halts(surprise, None, motion)
        ended = [(halt, self._explanation(halt.how, halt.place, ranges, found[0].place)) for halt in found]
        return self._halted(surprise, ended)

    def _misled(
        self,
        observation: Observation,
        told: Callable[[MotionHypothesis], Iterable[ReestimatedWalk]],
        turned: list[Explanation],
        others: list[Explanation],
    ) -> list[Explanation]:
        """That the newest motion, or an earlier one, was stopped where nobody thought so. look : as predicted.

        told : what may have come of a motion. turned : the lattices to believe instead, if all went as commanded; where
        one of them explains all, only stops by something known are thought of. others : all explanations so far.
        """
        if all(e.misfits for e in turned):
            simple = any(not e.misfits for e in others if e.how != "slipped" or self.slipped)
            return self._stopped(observation, map(told, self.earlier if simple else self.tellable))
        met = [e for e in self._stopped(observation, map(told, self.tellable)) if e.met or e.chance]
        if self._off_middle or not all(e.odd for e in turned):
            met = [e for e in met if e.frame == self.frame]
        return met or self._stopped_twice(observation)

    def _stopped(self, observation: Observation, told: Iterable[Iterable[ReestimatedWalk]]) -> list[Explanation]:
        """That one of some motions was stopped, as it was told. look : as predicted.

        Where the newest one came to a halt on the lattice held is judged already, if it may have been stopped at all.
        """
        judged = len(self.observations) if self.ended else None
        found = ((e, e.retold) for e in misled(observation, told) if e.retold is not None)
        return [
            self._doubted(e._replace(crooked=one.hypothesis.dear))
            for e, one in found
            if one.correction.since != judged or e.frame != self.frame
        ]

    def _stopped_twice(self, observation: Observation) -> list[Explanation]:
        """That the newest motion was stopped, and one before it unnoticed, on the lattice held. look : as predicted."""
        observations, newest, found = [*self.observations, observation], self.moved[-1], []
        held = [hypothesis for hypothesis in newest.hypotheses if hypothesis.frame == self.frame][:1]
        pairs = [(motion, hypothesis) for hypothesis in held for motion in reversed(self.earlier)]
        for told in (one for motion, h in pairs for one in retold_both(motion, newest, h, observations)):
            far = math.hypot(*told.correction.shift) + math.dist(told.newest, observation.place)
            place = self.frame.place_from_utak(*told.newest)
            found.append(Explanation("misled", place, self.frame, 0, far, None, self.hypotheses, told))
        return found

    def _plainest(
        self, ended: Sequence[Explanation], observation: Observation, left: tuple[FrameHypothesis, ...]
    ) -> Explanation:
        """The lattice held, on which nothing contradicts, or another one on which the table looks plainer.

        ended : explanations of a look on the lattice held. left : the hypotheses that stand, weighed.
        """
        self.hypotheses = left
        dear = next(h.dear for h in left if h.holds(self.frame))
        explanations = [one._replace(crooked=one.crooked + dear) for one in ended]
        if dear > 0:
            plainest = candidates(left, self.frame)[0]
            place = plainest.place_from_utak(*observation.place)
            explanations.append(Explanation("turned", place, plainest, 0, 0.0, None, left))
        return self._choose(explanations, ["stands"])

    def _turned(
        self, observation: Observation, left: tuple[FrameHypothesis, ...], recent: list[Observation]
    ) -> list[Explanation]:
        """The lattice to believe instead of the one held, on which looks contradict.

        look : the new one, as predicted, recent : the last ones with it. left : the hypotheses that stand.
        """
        if self.likely_spread <= SETTLED:  # rather he woke elsewhere in his square than that the angle is another one
            beside = search(recent, anywhere((self.frame.angle,)))
            left = weighed((*beside, *(h for h in left if h.angle != self.frame.angle)), recent)
        frame, misfits = self._borne_out(left, observation)
        if (misfits or self._dear(frame.angle) > DOUBTED) and self.searches < MOST_SEARCHES:
            self.searches += 1
            found = tuple(one._replace(dear=self._dear(one.angle)) for one in search(recent))
            another, fewer = self._borne_out(found, observation)
            if (fewer, self._dear(another.angle)) < (misfits, self._dear(frame.angle)):
                left, frame, misfits = found, another, fewer
        place = frame.place_from_utak(*observation.place)
        misfits += cramped(left, len(self.observations))
        crooked = self._dear(frame.angle)
        return [Explanation("turned", place, frame, misfits, 0.0, None, left, crooked=crooked)] * bool(left)

    def _borne_out(self, left: tuple[FrameHypothesis, ...], observation: Observation) -> tuple[Frame, int]:
        """Of the lattices left, the one that all looks bear out best, and how many fields it leaves as noise."""
        if not left:
            return self.frame, NONE_FITS
        tried: list[tuple[int, int]] = []
        frames = candidates(left, self.frame)[: max(6, MOST_REPLAYS // (len(self.observations) + 1))]
        for number, frame in enumerate(frames):
            tried.append((relaid(frame, self.frame, [*self.observations, observation], ()).misfits, number))
            if tried[-1][0] == 0:
                break
        misfits, number = min(tried)
        return frames[number], misfits

    def _explanation(self, how: str, place: Place, ranges: NDArray[np.int16], predicted: Place) -> Explanation:
        misfits = self._clashes(ranges, place, self.loads.values())
        return Explanation(how, place, self.frame, misfits, math.dist(place, predicted))
