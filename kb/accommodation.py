"""Accommodation: the believed pose, the angle of the lattice and the map, made to agree with every new impression.

From the command the pose is predicted. When the impression cannot have been received there, explanations are gathered
(the motion was blocked, it ended beside the predicted place, the lattice lies at another angle) and
kb/asp/accommodation.lp chooses the cheapest. Then the impression is taken into the evidence. Each of the 160 cells ends
as predicted, as explained (it shows squares not settled before), or as noise. Who is lost forgets, and begins anew.
"""

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geometry.rigid import Motion, Rotate
from kb.belying import overlooked
from kb.body import Command, Impression, Move, Push, Release, Turn
from kb.doubting import explained
from kb.evidence import FREE, Evidence
from kb.explanation import Accommodated, Explanation, cheapest, misled, statuses
from kb.hauling import Outcome, otherwise, predicted
from kb.heading import (
    ANYWHERE,
    MEMORY,
    Hypothesis,
    Look,
    anywhere,
    candidates,
    cramped,
    search,
    standing,
)
from kb.holding import RECENT, Holding
from kb.lattice import Lattice
from kb.leaning import after, leaning
from kb.loads import ROUNDING, Load, borne_out, covered, discounted
from kb.recalling import recalled
from kb.relaying import laid, relaid
from kb.retina import count_ranges
from kb.stops import Moved, Retold, around, ends, next_square, retold, retold_both
from kb.supposing import Surprise, agreeing, as_motion, clashes, laid_on
from kb.suspecting import Hindrances, led_to, suspects

MOST_REPLAYS = 120  # looks that are taken in anew, to try lattices, before one is believed
NONE_FITS = 10**6  # misfits of no lattice at all
MOST_SEARCHES = 6  # times that all lattices are tried anew before slips are blamed for what contradicts
HOPELESS = 18  # times that no other lattice explained it better, with things moved, before none is tried any more
SETTLED = math.radians(5)  # by which angles may differ while that hardly is why looks contradict
CONTRADICTED = 2  # misfits that a contradiction of looks weighs as much as: more than any other lattice costs
CLEAR = 0.25  # how likely a motion is stopped, at most, that comes upon nothing
REMEMBERED = 6  # motions that may turn out to have been stopped
Place = tuple[float, float]


@dataclass
class Memory(Holding):
    """What is held true, kept up to date: one of the few places with state."""

    def anew(self) -> "Memory":
        """The memory of one who is lost, and begins anew with what he sees next, for nothing else leads back.

        In his own frame he goes on from where he believes himself, so that he knows about where he came from.
        """
        been = (*self.been, *(look.place for look in self.looks[:-1]))
        return Memory(Evidence(), self.lattice, self.place, hypotheses=ANYWHERE, slipped=self.slipped, been=been)

    def wake(self, impression: Impression) -> Accommodated:
        """Take in the first impression."""
        return self._accommodate(impression, self.place, ())

    def accommodate(self, command: Command, impression: Impression) -> Accommodated:
        """Take in the impression that followed a command."""
        if self.held is not None and isinstance(command, Push | Turn):
            return self._carry(impression, self.loads[self.held], command)
        if isinstance(command, Release):
            self.held = None
        shift = (0.0, 0.0)
        if isinstance(command, Move) and self.held is None:
            shift = self.lattice.to_lattice(command.east, command.north)
        x, y = self.place
        return self._accommodate(impression, (x + shift[0], y + shift[1]), ends((x, y), shift), command)

    def grasp(self, load: Load) -> None:
        """Believe that a thing is in hand: what is new as a load is taken out of the standing map.

        A thing lies on the floor, so there is floor under it.
        """
        if load.name not in self.loads:
            patch = load.possible
            self.evidence.declare(self.evidence.squares(patch.west, patch.south, patch.mask), FREE, len(self.looks) - 1)
        self.loads.setdefault(load.name, replace(load, since=len(self.looks)))
        self.held = load.name

    def _carry(self, impression: Impression, load: Load, command: Push | Turn) -> Accommodated:
        """Take in the impression that followed a push or a turn with a load in hand."""
        ranges, motion = count_ranges(impression.retina), as_motion(command, self.lattice, self.place)
        if isinstance(command, Turn) and self._beside_line:
            load = self.loads[load.name] = replace(load, astray=max(load.astray, ROUNDING))
        surprise = self._surprise(command, ranges)
        chosen = self._outcome(ranges, load, predicted(self.place, load.polygon, motion))
        if not chosen.misfits:
            stop = overlooked(surprise, load, motion)
            if stop is not None:
                chosen = self._choose([chosen._replace(misfits=CONTRADICTED), self._outcome(ranges, load, stop)])
        else:
            stops = surprise.hindrances.stops(self.place, load.polygon, motion)
            ends = led_to(stops, self.place, load.polygon, motion)
            outcomes = [one for one in (self._outcome(ranges, load, end) for end in ends) if not one.misfits]
            outcomes += [self._outcome(ranges, load, other) for other in otherwise(self.place, load.polygon, motion)]
            outcomes += self._smaller(ranges, load, chosen)
            simple = any(not one.misfits for one in outcomes if one.how != "slipped" or self.slipped)
            explanations = [chosen, *outcomes, *self._elsewhere(surprise, chosen.misfits, simple)]
            explanations += self._recalled(surprise, explanations)
            clear = sum(stop.chance for stop in stops) <= CLEAR
            unchanged, uneven = np.array_equal(ranges, self.looks[-1].ranges), load.insets and any(load.insets.believed)
            told = {"unchanged": unchanged, "clear": clear, "uneven": uneven}
            chosen = self._choose(explanations, [fact for fact, so in told.items() if so])
        if isinstance(command, Push):
            self._remember(command, load.name)
        self._lie(chosen)
        self._carried(self.loads[load.name], chosen, as_motion(command, self.lattice, self.place), ranges)
        self.place = chosen.place
        if chosen.outcome is not None and chosen.outcome.as_commanded:
            carried = self.loads[load.name]
            self.loads[load.name] = self._told(carried, ranges, self.place) or carried
        self._stray(ranges)
        return self._take_in(chosen, ranges)

    def _carried(self, load: Load, chosen: Explanation, motion: Motion, ranges: NDArray[np.int16]) -> None:
        """Believe what came of a motion with a load in hand."""
        self.slipped |= chosen.how == "slipped"
        others, place = self._others(load), chosen.place
        suspected = suspects(chosen.outcome, motion, load, others, self.evidence)
        self.suspected |= suspected
        load = replace(load, inexact=load.inexact or self.slipped)
        carried = after(load, chosen.outcome, chosen.misfits, bool(suspected))
        if carried.inexact and carried.proven and not suspected and chosen.outcome and chosen.outcome.stopped:
            walls = Hindrances(self.evidence, place, carried.polygon, motion).walls
            carried = leaning(carried, motion, walls, lambda lying: self._clashes(ranges, place, [*others, lying]))
        self.loads[load.name] = carried

    def _smaller(self, ranges: NDArray[np.int16], load: Load, whole: Explanation) -> list[Explanation]:
        """That less of a thing was seen than was predicted, for it does not fill its squares. whole : as predicted."""
        outcome = whole.outcome
        assert outcome is not None
        lying = load.moved(outcome.polygon, load.slack, outcome.degrees, commanded=True)
        less = self._told(lying, ranges, outcome.place)
        if less is None:
            return []
        told = outcome._replace(how="smaller", polygon=less.polygon, insets=less.insets)
        return [whole._replace(how="smaller", misfits=0, outcome=told)]

    def _told(self, load: Load, ranges: NDArray[np.int16], place: Place) -> Load | None:
        """What a look tells of how far in the sides of a thing lie; None when it agrees with no such outline.

        Where the thing may lie there is rather floor than something that happens to fill what the thing leaves free.
        """
        lattice, others, nothing = self.lattice, self._others(load), frozenset[tuple[int, int]]()
        rather = self.evidence.supposing(covered(load.polygon).squares())

        def agrees(outline: Any) -> bool:
            lying = replace(load, polygon=outline, slack=0.0, full=nothing, empty=nothing)
            return not clashes(lattice, rather, [*others, lying], place, ranges)

        return load.told(agrees)

    def _others(self, load: Load) -> list[Load]:
        """All loads but one."""
        return [other for other in self.loads.values() if other.name != load.name]

    def _stray(self, ranges: NDArray[np.int16]) -> None:
        """How far what was turned may lie from where it is believed to, as it is open where in his square he woke."""
        within = tuple(h for h in self.hypotheses if h.angle == self.lattice.angle and h.is_point)
        if len(within) > 1:
            within = agreeing(within, self.lattice, self.place, self.evidence, self.looks, self.loads, ranges)
            self.hypotheses = within
        away = np.array([h.lattice.woke for h in within]).reshape(-1, 2) - np.array(self.lattice.woke)
        for name, load in self.loads.items():
            far = np.hypot(*(away - Rotate(load.turned, (0.0, 0.0)).points(away)).T)
            least = ROUNDING if self._beside_line and load.turned % 360 else 0.0
            self.loads[name] = replace(load, astray=float(far.max(initial=least)))

    def _surprise(self, command: Command, ranges: NDArray[np.int16]) -> Surprise:
        """A look that contradicts what is believed, now that things have been moved."""
        return Surprise(
            command, ranges, self.lattice, self.place, self.evidence, self.looks, self.loads, self.held, self.hypotheses
        )

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
        if found.lattice != self.lattice or set(found.hypotheses) != set(self.hypotheses):
            far = 0.0 if outcome is None else outcome.distance
            return [Explanation("turned", found.place, found.lattice, found.misfits, far, outcome, found.hypotheses)]
        if outcome is None:
            return []
        return [Explanation(outcome.how, outcome.place, self.lattice, found.misfits, outcome.distance, outcome)]

    def _recalled(self, surprise: Surprise, others: Iterable[Explanation]) -> list[Explanation]:
        """Earlier motions that ended elsewhere than is believed, unless there are others that explain a surprise."""
        if any(not other.misfits for other in others if other.how != "slipped" or self.slipped):
            return []
        found = []
        for told, one in recalled(surprise, self.earlier):
            far = math.hypot(*told.correction.shift)
            found.append(Explanation("misled", one.place, one.lattice, 0, far, one.outcome, self.hypotheses, told))
        return found

    def _outcome(self, ranges: NDArray[np.int16], load: Load, outcome: Outcome) -> Explanation:
        loads = [*self._others(load), load.moved(outcome.polygon, load.slack, commanded=outcome.as_commanded)]
        misfits = self._clashes(ranges, outcome.place, loads)
        return Explanation(outcome.how, outcome.place, self.lattice, misfits, outcome.distance, outcome)

    def _accommodate(
        self, impression: Impression, predicted: Place, stops: tuple[Place, ...], command: Command | None = None
    ) -> Accommodated:
        ranges = count_ranges(impression.retina)
        if stops and isinstance(command, Move):
            self._remember(command)
        explanation = self._explain(ranges, predicted, stops, command)
        self._lie(explanation)
        self.trust = self.trust + 1 if explanation.how == "predicted" else 0
        if explanation.how == "slipped":
            self.slipped, self.moved = True, ()
        elif explanation.how in ("blocked", "misled"):
            since = len(self.looks) if explanation.retold is None else explanation.retold.correction.since
            self.moved = tuple(m._replace(stopped=True) if m.number == since else m for m in self.moved)
        if explanation.how == "blocked" or explanation.place == self.place != predicted:
            self.barred.add(next_square(explanation.place, predicted))
        return self._take_in(explanation, ranges)

    def _remember(self, command: Move | Push, load: str | None = None) -> None:
        """A motion that is looked at next may turn out to have ended otherwise. load : the name of what is in hand."""
        motion = Moved(len(self.looks), (command.east, command.north), self.hypotheses, load=load)
        self.moved = (*self.moved[1 - REMEMBERED :], motion)

    def _take_in(self, explanation: Explanation, ranges: NDArray[np.int16]) -> Accommodated:
        """Take an explained impression into the evidence, freed of what the loads show."""
        x, y = math.floor(explanation.place[0]), math.floor(explanation.place[1])
        for name, load in self.loads.items():
            self.loads[name] = load.seen(self.lattice.samples(), ranges, x, y)
        samples, counts = discounted(self.lattice.samples(), ranges, x, y, self.loads.values())
        cells = statuses(self.evidence, samples, counts, x, y)
        self.place = explanation.place
        moved = tuple(laid(load, self.lattice) for load in self.loads.values())
        self.looks.append(Look(ranges, self.lattice.place_to_utak(*self.place), moved))
        self.evidence.look(samples, counts, x, y, len(self.looks) - 1)
        if len(self.looks) == 1:
            self.evidence.stand(x, y, 0)
        self.unfit = (*self.unfit[1 - RECENT :], explanation.misfits)
        return Accommodated(explanation, cells)

    def _explain(
        self, ranges: NDArray[np.int16], predicted: Place, stops: tuple[Place, ...], command: Command | None
    ) -> Explanation:
        first = self._explanation("predicted", predicted, ranges, predicted)
        look = Look(ranges, self.lattice.place_to_utak(*predicted))
        told = cache(lambda motion: tuple(retold(motion, self.lattice, [*self.looks, look])))
        stopped = [motion for motion in self.earlier if motion.stopped]
        if first.misfits and not self.loads and any(not one.misfits for motion in stopped for one in told(motion)):
            turned = misled(look, map(told, stopped))
        elif not self.loads:
            turned = self._turned(look, first.misfits)
        elif first.misfits and command is not None:
            turned = self._elsewhere(self._surprise(command, ranges), first.misfits)
        else:
            turned = []
        if not first.misfits and not turned:
            return first
        if not first.misfits:  # no settled square is otherwise, but two looks contradict each other on this lattice
            first = first._replace(misfits=CONTRADICTED)
        explanations = [first]
        explanations += [self._explanation("blocked", stop, ranges, predicted) for stop in stops]
        explanations += [self._explanation("slipped", place, ranges, predicted) for place in around(predicted)]
        explanations += turned
        if self.loads and command is not None:
            explanations += self._recalled(self._surprise(command, ranges), explanations)
        elif stops:
            explanations += self._misled(look, told, turned, explanations)
        return self._choose(explanations)

    def _misled(
        self,
        look: Look,
        told: Callable[[Moved], Iterable[Retold]],
        turned: list[Explanation],
        others: list[Explanation],
    ) -> list[Explanation]:
        """That the newest motion, or an earlier one, was stopped where nobody thought so. look : as predicted.

        told : what may have come of a motion. turned : the lattices to believe instead, if all went as commanded; where
        one of them explains all, only stops by something known are thought of. others : all explanations so far.
        """
        if all(e.misfits for e in turned):
            simple = any(not e.misfits for e in others if e.how != "slipped" or self.slipped)
            return misled(look, map(told, self.earlier if simple else self.tellable))
        met = [e for e in misled(look, map(told, self.tellable)) if e.met]
        if self._off_middle or not all(e.odd for e in turned):
            met = [e for e in met if e.lattice == self.lattice]
        return met or self._stopped_twice(look)

    def _stopped_twice(self, look: Look) -> list[Explanation]:
        """That the newest motion was stopped, and one before it unnoticed, on the lattice held. look : as predicted."""
        looks, newest, found = [*self.looks, look], self.moved[-1], []
        held = [hypothesis for hypothesis in newest.hypotheses if hypothesis.lattice == self.lattice][:1]
        pairs = [(motion, hypothesis) for hypothesis in held for motion in reversed(self.earlier)]
        for told, own in (one for motion, h in pairs for one in retold_both(motion, newest, h, looks)):
            far = math.hypot(*told.correction.shift) + math.dist(own, look.place)
            place = self.lattice.place_from_utak(*own)
            found.append(Explanation("misled", place, self.lattice, 0, far, None, self.hypotheses, told))
        return found

    def _turned(self, look: Look, misfits: int) -> list[Explanation]:
        """The lattice to believe instead, unless the one held explains all. look : the new one, as predicted."""
        recent = [*self.looks[-MEMORY:], look]
        left = standing(self.hypotheses, recent)
        if not misfits and any(h.holds(self.lattice) for h in left):
            self.hypotheses = left
            return []
        lattice, misfits = self.lattice, NONE_FITS
        if self.spread <= SETTLED:  # rather he woke elsewhere in his square than that the angle is another one
            beside = search(recent, anywhere((self.lattice.angle,)))
            lattice, misfits = self._borne_out(beside, look)
            others = tuple(h for h in left if h.angle != self.lattice.angle)
        if misfits:
            lattice, misfits = self._borne_out(left, look)
        else:
            left = (*beside, *others)
        if misfits and self.searches < MOST_SEARCHES:
            self.searches += 1
            found = search(recent)
            another, fewer = self._borne_out(found, look)
            if fewer < misfits:
                left, lattice, misfits = found, another, fewer
        place = lattice.place_from_utak(*look.place)
        misfits += cramped(left, len(self.looks))
        return [Explanation("turned", place, lattice, misfits, 0.0, None, left)] * bool(left)

    def _borne_out(self, left: tuple[Hypothesis, ...], look: Look) -> tuple[Lattice, int]:
        """Of the lattices left, the one that all looks bear out best, and how many fields it leaves as noise."""
        if not left:
            return self.lattice, NONE_FITS
        tried: list[tuple[int, int]] = []
        lattices = candidates(left, self.lattice)[: max(6, MOST_REPLAYS // (len(self.looks) + 1))]
        for number, lattice in enumerate(lattices):
            tried.append((relaid(lattice, self.lattice, [*self.looks, look], ()).misfits, number))
            if tried[-1][0] == 0:
                break
        misfits, number = min(tried)
        return lattices[number], misfits

    def _explanation(self, how: str, place: Place, ranges: NDArray[np.int16], predicted: Place) -> Explanation:
        misfits = self._clashes(ranges, place, self.loads.values())
        return Explanation(how, place, self.lattice, misfits, math.dist(place, predicted))

    def _clashes(self, ranges: NDArray[np.int16], place: Place, loads: Iterable[Load]) -> int:
        """How many fields cannot be right if the impression was received at a place, with the loads where they lie."""
        return clashes(self.lattice, self.evidence, loads, place, ranges)

    def _choose(self, explanations: list[Explanation], told: Iterable[str] = ()) -> Explanation:
        """The explanation to believe. told : facts about the motion and the look."""
        facts = [f"trust({0 if self._off_middle else self.trust})", *["slips"] * self.slipped]
        facts += ["off_middle"] * self._off_middle
        facts += [f"met({n})" for n, e in enumerate(explanations) if e.met and e.lattice == self.lattice]
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
            own = self.lattice.place_to_utak(*self.place)
            self.place = self.lattice.place_from_utak(*correction.place(own))
            self.looks, loads = correction.looks(self.looks), correction.loads(loads, self.lattice)
        elif chosen.lattice == self.lattice:
            return
        if chosen.retold is not None or len(loads) < len(self.loads):
            under = relaid(chosen.lattice, self.lattice, self.looks, loads.values())
        else:
            under = laid_on(chosen.lattice, self.lattice, self.evidence, self.looks, loads)
        if under.evidence is not self.evidence:
            self.barred, self.suspected = set(), set()
        self.lattice, self.evidence, self.loads = chosen.lattice, under.evidence, dict(under.loads)
