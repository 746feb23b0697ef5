"""Accommodation: the believed pose, the angle of the lattice and the map, made to agree with every new impression.

From the command the pose is predicted. When the impression cannot have been received there, explanations are gathered
(the motion was blocked, it ended beside the predicted place, the lattice lies at another angle) and
kb/asp/accommodation.lp chooses the cheapest. Then the impression is taken into the evidence. Each of the 160 cells ends
as predicted, as explained (it shows squares not settled before), or as noise. Who is lost forgets, and begins anew.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from functools import cache

import numpy as np
from numpy.typing import NDArray

from geometry.rigid import Motion, Rotate
from kb.belying import belied, likeliest_stop
from kb.body import Command, Impression, Move, Push, Release, Turn
from kb.doubting import explained
from kb.evidence import FREE, OPEN, Evidence
from kb.explanation import Accommodated, Explanation, cheapest, misled, statuses
from kb.hauling import Outcome, otherwise, predicted
from kb.heading import (
    ANYWHERE,
    CENTRED,
    MEMORY,
    Box,
    Hypothesis,
    Look,
    anywhere,
    candidates,
    cramped,
    leeway,
    search,
    standing,
)
from kb.lattice import CENTRE, Lattice
from kb.leaning import after, leaning
from kb.loads import ROUNDING, Load, borne_out, discounted
from kb.relaying import laid, relaid
from kb.retina import count_ranges
from kb.stops import HAIR, Moved, around, ends, next_square, retold
from kb.supposing import Surprise, agreeing, as_motion, clashes, laid_on
from kb.suspecting import Hindrances, suspects

MOST_REPLAYS = 120  # looks that are taken in anew, to try lattices, before one is believed
NONE_FITS = 10**6  # misfits of no lattice at all
MOST_SEARCHES = 6  # times that all lattices are tried anew before slips are blamed for what contradicts
HOPELESS = 18  # times that no other lattice explained it better, with things moved, before none is tried any more
SETTLED = math.radians(5)  # by which angles may differ while that hardly is why looks contradict
CONTRADICTED = 2  # misfits that a contradiction of looks weighs as much as: more than any other lattice costs
REMEMBERED = 3  # motions that may turn out to have been stopped
RECENT = 4  # looks by which he tells that he is lost
LOST = 8  # misfits, of these looks
ASTRAY = 24  # so many once he has moved a thing, which may just lie otherwise than he believes
Place = tuple[float, float]


@dataclass
class Memory:
    """All that is held true of the pose and the map. One of the few places with state.

    place is a point of the lattice; looks keep where each impression was received, in Utak's own frame. loads are the
    things that he has held, by name, and held the one that he holds. moved : his last motions before he held any, which
    may have ended otherwise than believed. barred : squares before which he was stopped himself; suspected : those of
    which one stopped what he carried, for all that was known. unfit : misfits of each of the last looks. been : where
    looks were received, in his own frame, before he was lost and began anew.
    """

    evidence: Evidence = field(default_factory=Evidence)
    lattice: Lattice = field(default_factory=Lattice)
    place: Place = CENTRE
    looks: list[Look] = field(default_factory=list)
    hypotheses: tuple[Hypothesis, ...] = CENTRED
    trust: int = 0
    barred: set[tuple[int, int]] = field(default_factory=set)
    suspected: set[tuple[int, int]] = field(default_factory=set)
    searches: int = 0
    slipped: bool = False
    moved: tuple[Moved, ...] = ()
    loads: dict[str, Load] = field(default_factory=dict)
    held: str | None = None
    unfit: tuple[int, ...] = ()
    been: tuple[Place, ...] = ()

    @property
    def lost(self) -> bool:
        """Does what he sees agree with nothing that he believes, look after look?"""
        most = ASTRAY if any(load.proven for load in self.loads.values()) else LOST
        return sum(self.unfit) >= most and sum(unfit > 0 for unfit in self.unfit) > 1

    @property
    def square(self) -> tuple[int, int]:
        """The square of the lattice on which Utak stands."""
        return math.floor(self.place[0]), math.floor(self.place[1])

    @property
    def track(self) -> list[Place]:
        """Where he has been, as points of the lattice."""
        return [self.lattice.place_from_utak(*place) for place in (*self.been, *(look.place for look in self.looks))]

    @property
    def looked_from(self) -> frozenset[tuple[int, int]]:
        """The squares on which an impression was received that he has not forgotten."""
        return frozenset((math.floor(x), math.floor(y)) for x, y in self.track[len(self.been) :])

    @property
    def spread(self) -> float:
        """By how many radians the angles that still stand differ from the believed one, at most."""
        return math.radians(max((abs(other.angle - self.lattice.angle) for other in self.hypotheses), default=0))

    @property
    def closed(self) -> frozenset[tuple[int, int]]:
        """The squares on which something stands, or likely does, for it stopped a motion."""
        sure = set() if self.slipped else self.barred  # who slips may have stopped by himself
        doubted = (self.barred | self.suspected) - sure
        return frozenset((*sure, *(s for s in doubted if self.evidence.state[self.evidence.index(*s)] == OPEN)))

    @property
    def _off_middle(self) -> bool:
        """Has it turned out that he did not wake amid his square?"""
        return self.lattice.woke != CENTRE

    @property
    def _beside_line(self) -> bool:
        """Was he stopped beside a line, which tells where he stands but for a hair?"""
        return min(map(abs, self.leeway)) <= 2 * HAIR

    @property
    def leeway(self) -> Box:
        """How far from where he believes it he may have woken: to the west and south (not above 0), east and north."""
        return leeway(self.lattice, self.looks, self.hypotheses)

    @property
    def sure(self) -> bool:
        """Is what the counts settle beyond doubt?

        Not when a look contradicted another one or a motion ended beside where it should, nor while several places in
        his square are left at which he may have woken, or several angles none of which is that of his own axes.
        """
        along = self.lattice.angle == 0 and all(other.box == CENTRE + CENTRE for other in self.hypotheses)
        return not (self.evidence.overruled or self.slipped) and (along or len(self.hypotheses) == 1)

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
        if chosen.outcome and not chosen.misfits and belied(surprise, chosen.outcome):
            stop = likeliest_stop(surprise, load, motion)
            if stop is not None:
                chosen = self._choose([chosen._replace(misfits=CONTRADICTED), self._outcome(ranges, load, stop)])
        elif chosen.misfits:
            ends = surprise.hindrances.ends(self.place, load.polygon, motion)
            outcomes = [one for one in (self._outcome(ranges, load, end) for end in ends) if not one.misfits]
            outcomes += [self._outcome(ranges, load, other) for other in otherwise(self.place, load.polygon, motion)]
            simple = any(not one.misfits for one in outcomes if one.how != "slipped" or self.slipped)
            explanations = [chosen, *outcomes, *self._elsewhere(surprise, chosen.misfits, simple)]
            chosen = self._choose(explanations, np.array_equal(ranges, self.looks[-1].ranges))
        self._lie(chosen)
        self._carried(self.loads[load.name], chosen, as_motion(command, self.lattice, self.place), ranges)
        self.place = chosen.place
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

    def _outcome(self, ranges: NDArray[np.int16], load: Load, outcome: Outcome) -> Explanation:
        loads = [*self._others(load), load.moved(outcome.polygon, load.slack)]
        misfits = self._clashes(ranges, outcome.place, loads)
        return Explanation(outcome.how, outcome.place, self.lattice, misfits, outcome.distance, outcome)

    def _accommodate(
        self, impression: Impression, predicted: Place, stops: tuple[Place, ...], command: Command | None = None
    ) -> Accommodated:
        ranges = count_ranges(impression.retina)
        if stops and not self.loads and isinstance(command, Move):
            motion = Moved(len(self.looks), (command.east, command.north), self.hypotheses)
            self.moved = (*self.moved[1 - REMEMBERED :], motion)
        explanation = self._explain(ranges, predicted, stops, command)
        self._lie(explanation)
        self.trust = self.trust + 1 if explanation.how == "predicted" else 0
        if explanation.how == "slipped":
            self.slipped, self.moved = True, ()
        elif explanation.how in ("blocked", "misled"):
            since = len(self.looks) if explanation.retold is None else explanation.retold.since
            self.moved = tuple(m._replace(stopped=True) if m.number == since else m for m in self.moved)
        if explanation.how == "blocked" or explanation.place == self.place != predicted:
            self.barred.add(next_square(explanation.place, predicted))
        return self._take_in(explanation, ranges)

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
        before = [motion for motion in self.moved if motion.number < len(self.looks)]  # their looks were taken in
        stopped = [motion for motion in before if motion.stopped]
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
        if stops and not self.loads and all(e.misfits for e in turned):
            simple = any(not e.misfits for e in explanations if e.how != "slipped" or self.slipped)
            explanations += misled(look, map(told, before if simple else self.moved))
        elif stops and not self.loads and not self._off_middle and all(e.odd for e in turned):
            explanations += [e for e in misled(look, map(told, self.moved)) if e.retold is not None and e.retold.known]
        return self._choose(explanations)

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

    def _choose(self, explanations: list[Explanation], unchanged: bool = False) -> Explanation:
        """The explanation to believe. unchanged : nothing looks otherwise than at the last look."""
        facts = [f"trust({0 if self._off_middle else self.trust})", *["slips"] * self.slipped]
        facts += ["off_middle"] * self._off_middle
        facts += ["proven"] * (self.held is not None and self.loads[self.held].proven)
        return cheapest(explanations, [*facts, *["unchanged"] * unchanged])

    def _lie(self, chosen: Explanation) -> None:
        """Believe what an explanation says of the lattice and of earlier motions; if that is new, all is laid anew."""
        loads = self.loads
        if chosen.anew:
            self.hypotheses, self.trust = chosen.hypotheses, 0
            loads = borne_out(loads, self.held)
        if chosen.retold is not None:
            self.looks = chosen.retold.looks(self.looks)
        elif chosen.lattice == self.lattice:
            return
        if chosen.retold is not None or len(loads) < len(self.loads):
            under = relaid(chosen.lattice, self.lattice, self.looks, loads.values())
        else:
            under = laid_on(chosen.lattice, self.lattice, self.evidence, self.looks, loads)
        if under.evidence is not self.evidence:
            self.barred, self.suspected = set(), set()
        self.lattice, self.evidence, self.loads = chosen.lattice, under.evidence, dict(under.loads)
