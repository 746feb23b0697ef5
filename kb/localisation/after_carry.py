"""What a look says that was received after a push or a turn with something in hand: what came of the motion."""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geometry.motion.se2 import Motion, Rotate
from kb.localisation.hypotheses.carry_outcomes import Outcome, otherwise, predicted
from kb.localisation.hypotheses.contacts import Obstructions, led_to, suspects
from kb.localisation.hypotheses.explanation import Explanation
from kb.localisation.hypotheses.what_if import Surprise, agreeing, clashes
from kb.localisation.propose.blocked import halts, whole_first
from kb.localisation.propose.contradicted_motion import overlooked
from kb.localisation.propose.held_object_state import after, leaning
from kb.localisation.propose.larger_object import larger
from kb.localisation.score import CONTRADICTED, Judging, Place
from kb.mapping.patch import covered
from kb.objects.held_object import ROUNDING, HeldObject

CLEAR = 0.25  # how likely a motion is stopped, at most, that comes upon nothing


class Carried(Judging):
    """What is held true, with the explanations of a look after a motion of what he holds."""

    def _came_of(self, surprise: Surprise, load: HeldObject, motion: Motion) -> Explanation:
        """What came of a motion with a load in hand, by the look after it."""
        ranges = surprise.ranges
        whole = self._outcome(surprise, predicted(self.place, load.polygon, motion))
        halted = self._halted_push(surprise, load, motion)
        if whole_first(halted):
            return self._choose(halted)
        if not whole.misfits and not halted:
            stop = overlooked(surprise, load, motion)
            if stop is None:
                return whole
            return self._choose([whole._replace(misfits=CONTRADICTED), self._outcome(surprise, stop)])
        if not whole.misfits:
            whole = whole._replace(misfits=CONTRADICTED)
        stops = surprise.hindrances.stops(self.place, load.polygon, motion)
        ends = led_to(stops, self.place, load.polygon, motion)
        outcomes = halted or [one for one in (self._outcome(surprise, end) for end in ends) if not one.misfits]
        outcomes += [self._outcome(surprise, other) for other in otherwise(self.place, load.polygon, motion)]
        outcomes += [*self._smaller(ranges, load, whole), *larger(surprise, load, motion)]
        simple = any(not one.misfits for one in outcomes if one.how != "slipped" or self.slipped)
        explanations = [whole, *outcomes, *self._elsewhere(surprise, whole.misfits, simple)]
        explanations += self._recalled(surprise, explanations)
        if not any(map(self._simple, explanations)):
            explanations += self._halted_elsewhere(surprise)
        clear = sum(stop.chance for stop in stops) <= CLEAR
        unchanged, uneven = (
            np.array_equal(ranges, self.observations[-1].ranges),
            load.insets and any(load.insets.believed),
        )
        told = {"unchanged": unchanged, "clear": clear, "uneven": uneven}
        return self._choose(explanations, [fact for fact, so in told.items() if so])

    def _halted_push(self, surprise: Surprise, load: HeldObject, motion: Motion) -> list[Explanation]:
        """Where a push came to a halt that may have been stopped, of the halts that the look bears out."""
        ended = []
        for halt in halts(surprise, load, motion):
            assert halt.outcome is not None
            ended.append((halt, self._outcome(surprise, halt.outcome)))
        return self._halted(surprise, ended)

    def _carried(self, load: HeldObject, chosen: Explanation, motion: Motion, ranges: NDArray[np.int16]) -> None:
        """Believe what came of a motion with a load in hand."""
        self.slipped |= chosen.how == "slipped"
        others, place = self._others(load), chosen.place
        suspected = suspects(chosen.outcome, motion, load, others, self.occupancy)
        self.suspected |= suspected
        load = replace(load, inexact=load.inexact or self.slipped)
        carried = after(load, chosen.outcome, chosen.misfits, bool(suspected))
        if carried.inexact and carried.proven and not suspected and chosen.outcome and chosen.outcome.stopped:
            walls = Obstructions(self.occupancy, place, carried.polygon, motion).walls
            carried = leaning(carried, motion, walls, lambda lying: self._clashes(ranges, place, [*others, lying]))
        self.loads[load.name] = carried

    def _smaller(self, ranges: NDArray[np.int16], load: HeldObject, whole: Explanation) -> list[Explanation]:
        """That less of a thing was seen than was predicted, for it does not fill its squares. whole : as predicted."""
        outcome = whole.outcome
        assert outcome is not None
        lying = load.moved(outcome.polygon, load.slack, outcome.degrees, commanded=True)
        less = self._told(lying, ranges, outcome.place)
        if less is None:
            return []
        told = outcome._replace(how="smaller", polygon=less.polygon, insets=less.insets)
        return [whole._replace(how="smaller", misfits=0, outcome=told)]

    def _told(self, load: HeldObject, ranges: NDArray[np.int16], place: Place) -> HeldObject | None:
        """What a look tells of how far in the sides of a thing lie; None when it agrees with no such outline.

        Where the thing may lie there is rather floor than something that happens to fill what the thing leaves free.
        """
        frame, others, nothing = self.frame, self._others(load), frozenset[tuple[int, int]]()
        rather = self.occupancy.supposing(covered(load.polygon).squares())

        def agrees(outline: Any) -> bool:
            lying = replace(load, polygon=outline, slack=0.0, full=nothing, empty=nothing)
            return not clashes(frame, rather, [*others, lying], place, ranges)

        return load.told(agrees)

    def _others(self, load: HeldObject) -> list[HeldObject]:
        """All loads but one."""
        return [other for other in self.loads.values() if other.name != load.name]

    def _stray(self, ranges: NDArray[np.int16]) -> None:
        """How far what was turned may lie from where it is believed to, as it is open where in his square he woke."""
        within = tuple(h for h in self.hypotheses if h.angle == self.frame.angle and h.is_point)
        if len(within) > 1:
            within = agreeing(within, self.frame, self.place, self.occupancy, self.observations, self.loads, ranges)
            self.hypotheses = within
        away = np.array([h.frame.origin for h in within]).reshape(-1, 2) - np.array(self.frame.origin)
        for name, load in self.loads.items():
            far = np.hypot(*(away - Rotate(load.turned, (0.0, 0.0)).points(away)).T)
            least = ROUNDING if self._beside_line and load.turned % 360 else 0.0
            self.loads[name] = replace(load, astray=float(far.max(initial=least)))

    def _outcome(self, surprise: Surprise, outcome: Outcome) -> Explanation:
        misfits = self._clashes(surprise.ranges, outcome.place, surprise.lying(outcome))
        return Explanation(outcome.how, outcome.place, self.frame, misfits, outcome.distance, outcome)
