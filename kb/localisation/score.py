"""What speaks for and against an explanation of a look: what contradicts it, and what else may have come about."""

import math
from collections.abc import Callable, Iterable
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from kb.body import Command
from kb.localisation.holding import Holding
from kb.localisation.hypotheses.explanation import Explanation, cheapest
from kb.localisation.hypotheses.map_prior import UNTRIED
from kb.localisation.hypotheses.remap import RemapCache, relaid
from kb.localisation.hypotheses.what_if import Surprise, clashes
from kb.localisation.propose import blocked
from kb.localisation.propose.earlier_motion import ReestimatedMotion, recalled, recalled_elsewhere
from kb.localisation.propose.frame import explained, halted_elsewhere
from kb.objects.held_object import HeldObject, borne_out

MOST_SEARCHES = 6  # times that all lattices are tried anew before slips are blamed for what contradicts
HOPELESS = 18  # times that nothing else explained it better before nothing more is tried that takes as long
CONTRADICTED = 2  # misfits that a contradiction of looks weighs as much as: more than any other lattice costs
Place = tuple[float, float]
T = TypeVar("T")


class Judging(Holding):
    """What is held true, with what it says of new looks and of explanations of them."""

    def _surprise(self, command: Command, ranges: NDArray[np.int16]) -> Surprise:
        """A look that contradicts what is believed, now that things have been moved."""
        return Surprise(
            command,
            ranges,
            self.frame,
            self.place,
            self.occupancy,
            self.observations,
            self.loads,
            self.held,
            self.hypotheses,
            self.pictures,
        )

    def _halted(
        self, surprise: Surprise, ended: Iterable[tuple[blocked.BlockedMotion, Explanation]]
    ) -> list[Explanation]:
        """Of the halts of the newest motion, told so, those that its look bears out: they are remembered."""
        told = (one._replace(chance=halt.chance, against=halt.against) for halt, one in ended if not one.misfits)
        self.ended = tuple(blocked.borne_out(surprise, told))
        return list(self.ended)

    def _elsewhere(self, surprise: Surprise, misfits: int, simple: bool = False) -> list[Explanation]:
        """The lattice that explains a surprise better, if there is one.

        simple : is it explained by a motion that ended early?
        """
        if self.searches >= HOPELESS:
            return []
        found = explained(surprise, self.searches < MOST_SEARCHES, simple)
        if found is None or found.misfits >= misfits:
            self.searches += 1
            return []
        self.searches += found.searched
        outcome = found.outcome
        pushed = outcome is not None and outcome.stopped and surprise.degrees == 0.0
        if simple and pushed and found.frame == self.frame:  # where that was is judged more finely already
            return []
        if found.frame != self.frame or set(found.hypotheses) != set(self.hypotheses):
            far = 0.0 if outcome is None else outcome.distance
            turned = Explanation("turned", found.place, found.frame, found.misfits, far, outcome, found.hypotheses)
            return [turned._replace(crooked=self._dear(found.frame.angle))]
        if outcome is None or outcome.how == "predicted":  # as is judged already
            return []
        return [Explanation(outcome.how, outcome.place, self.frame, found.misfits, outcome.distance, outcome)]

    def _halted_elsewhere(self, surprise: Surprise) -> list[Explanation]:
        """That a push was stopped, and he woke elsewhere in his square: each the likelier the more of that is left."""
        found = []
        for one, chance, against in self._at_length(lambda: halted_elsewhere(surprise)):
            far = 0.0 if one.outcome is None else one.outcome.distance
            turned = Explanation("turned", one.place, one.frame, 0, far, one.outcome, one.hypotheses)
            found.append(turned._replace(chance=chance, crooked=against, weighed=True))
        return found

    def _recalled(self, surprise: Surprise, others: Iterable[Explanation]) -> list[Explanation]:
        """Earlier motions that ended elsewhere than is believed.

        Where a simple thing explains all as the lattice is, only those that likely did by the look after them, and none
        if it is known how likely that thing is. That he woke elsewhere in his square as well is told only where nothing
        simple explains it on any other lattice either.
        """
        simple = [other for other in others if self._simple(other)]
        here = [other for other in simple if other.frame == self.frame]
        if here:
            known = any(other.chance is not None for other in here)
            likely = [] if known else [self._told_again(one) for one in recalled(surprise, self.in_doubt)]
            return [one for one in likely if one.chance is not None]
        found = recalled(surprise, self.earlier)
        if not found and not simple:
            found = self._at_length(lambda: recalled_elsewhere(surprise, self.earlier))
        return [self._told_again(one) for one in found]

    def _at_length(self, tell: Callable[[], list[T]]) -> list[T]:
        """What is told by trying much; nothing any more after that told nothing too often."""
        if self.searches >= HOPELESS:
            return []
        found = tell()
        self.searches += not found
        return found

    def _simple(self, explanation: Explanation) -> bool:
        """Does an explanation leave nothing as noise, and say neither that he slipped nor that the angle is another?"""
        likely = explanation.how != "slipped" or self.slipped
        return likely and not explanation.misfits and explanation.frame.angle == self.frame.angle

    def _told_again(self, recalled: ReestimatedMotion) -> Explanation:
        """That an earlier motion ended elsewhere than is believed, as it was told again."""
        told, one = recalled
        far = math.hypot(*told.correction.shift)
        misled = Explanation("misled", one.place, one.frame, 0, far, one.outcome, one.hypotheses, told)
        return self._doubted(misled)

    def _doubted(self, explanation: Explanation) -> Explanation:
        """That an earlier motion ended otherwise, with how likely that was by the look after it, if that was told."""
        assert explanation.retold is not None
        correction = explanation.retold.correction
        motion = next((motion for motion in self.moved if motion.number == correction.since), None)
        if motion is None or motion.number >= len(self.observations) or explanation.frame != self.frame:
            return explanation
        return explanation._replace(chance=motion.doubt(correction.place(self.observations[motion.number].place)))

    def _doubt(self, chosen: Explanation) -> None:
        """Remember where else the newest motion may have ended than an explanation says that is believed."""
        if not self.ended or chosen.frame != self.frame or self.moved[-1].number != len(self.observations):
            return
        weights = [(one, (one.chance or 0.0) * math.exp(-one.crooked)) for one in self.ended]
        total = sum(weight for _, weight in weights)
        others = [(self.frame.place_to_utak(*one.place), w / total) for one, w in weights if one.place != chosen.place]
        self.moved = (*self.moved[:-1], self.moved[-1]._replace(doubts=tuple(others)))

    def _dear(self, angle: int) -> float:
        """How much less plain the table looked at an angle than at the one believed, by all looks before."""
        if angle == self.frame.angle:
            return 0.0
        return min((one.dear for one in self.hypotheses if one.angle == angle), default=UNTRIED)

    def _clashes(self, ranges: NDArray[np.int16], place: Place, loads: Iterable[HeldObject]) -> int:
        """How many fields cannot be right if the impression was received at a place, with the loads where they lie."""
        return clashes(self.frame, self.occupancy, loads, place, ranges)

    def _choose(self, explanations: list[Explanation], told: Iterable[str] = ()) -> Explanation:
        """The explanation to believe. told : facts about the motion and the look."""
        facts = [f"trust({0 if self._off_middle else self.trust})", *["slips"] * self.slipped]
        facts += ["off_middle"] * self._off_middle
        facts += [f"met({n})" for n, e in enumerate(explanations) if e.met and e.frame == self.frame]
        facts += ["proven"] * (self.held is not None and self.loads[self.held].proven)
        return cheapest(explanations, [*facts, *told])

    def _lie(self, chosen: Explanation) -> None:
        """Believe what an explanation says of the lattice and of earlier motions; if that is new, all is laid anew."""
        loads = self.loads
        if chosen.anew:
            self.hypotheses, self.trust = chosen.hypotheses, 0
            loads = borne_out(loads, self.held)
        if chosen.retold is not None:
            correction = chosen.retold.correction
            own = self.frame.place_to_utak(*self.place)
            self.place = self.frame.place_from_utak(*correction.place(own))
            self.observations, loads = correction.observations(self.observations), correction.loads(loads, self.frame)
        elif chosen.frame == self.frame:
            return
        if chosen.retold is not None or len(loads) < len(self.loads):
            under = relaid(chosen.frame, self.frame, self.observations, loads.values())
        else:
            under = RemapCache(self.frame, self.occupancy, self.observations, loads).on(chosen.frame)
        if under.occupancy is not self.occupancy:
            self.barred, self.suspected, self.pictures = set(), set(), None
        self.frame, self.occupancy, self.loads = chosen.frame, under.occupancy, dict(under.loads)
