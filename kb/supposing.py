"""Supposing that the lattice lies otherwise, when a look contradicts what is believed and things have been moved.

Then looks do not agree where things came from and went to, and what was in Utak's hand tells something of its own: a
turn goes about him, so it leaves a thing elsewhere when he stands elsewhere in his square than he thinks. Each lattice
that may be is held against all looks, with the things laid on it anew.
"""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

from geometry.contact import Obstacles
from geometry.rigid import Motion, Rotate, Translate
from kb.body import Command, Move, Push, Turn
from kb.evidence import FULL, Evidence
from kb.hauling import STRIDE, Outcome, arrested, otherwise, predicted
from kb.heading import CENTRED, Disc, Hypothesis, Look, anywhere, candidates, fallen, points, search
from kb.lattice import Lattice
from kb.loads import Load, discounted
from kb.relaying import Relaid, relaid, shifted

Place = tuple[float, float]
Ranges = NDArray[np.int16]
RECENT = 24  # looks by which lattices are judged
ABOUT = 2  # degrees by which the lattice may lie otherwise than any that was left
WIDEST = 8  # degrees between those that were left, for more to be thought of
FEW = 12  # lattices on which all is laid anew, at most
LEAST = 4  # at least
MOST_REPLAYS = 200  # looks that are taken in anew for that
BEST = 3  # of those, on which the motion may have been stopped by what was not known
BESIDE = 1.5  # squares about a thing that was moved in which looks need not agree
SLIVER = 0.02  # squares^2: where there is no more room for where he woke, he was rather stopped
ROOM = 3  # squares about a motion in which something may stop it


class Supposed(NamedTuple):
    """A lattice that may be the true one.

    hypotheses : all that are left then. place : where Utak is on it. outcome : what came of the motion of the thing in
    hand. misfits : fields that contradict it, of all looks. searched : were hypotheses taken up that had been given up?
    """

    lattice: Lattice
    hypotheses: tuple[Hypothesis, ...]
    place: Place
    outcome: Outcome | None
    misfits: int
    searched: bool


@dataclass(frozen=True)
class Surprise:
    """A look, after a command, that contradicts what was believed before.

    place : of Utak before it, on the lattice. held : the name of the load in his hand. hypotheses : what was left.
    """

    command: Command
    ranges: Ranges
    lattice: Lattice
    place: Place
    evidence: Evidence
    looks: Sequence[Look]
    loads: Mapping[str, Load]
    held: str | None
    hypotheses: tuple[Hypothesis, ...]

    def explained(self, anew: bool) -> Supposed | None:
        """The lattice that explains it best; None when none is left.

        anew : may hypotheses that were given up before be taken up again?
        """
        if self._turned:
            standing = self._otherwise_turned()
            if standing is not None:
                return standing
            fitting = [one for one in map(self._point, self._points()) if not one.misfits]
            if fitting:
                return _middle(fitting)
        found: list[Supposed] = []
        few = max(LEAST, min(FEW, MOST_REPLAYS // (len(self.looks) + 1)))
        for searched in (False, True)[: 1 + anew]:
            hypotheses = self._searched() if searched else self._left()
            if searched and sum(hypothesis.area for hypothesis in hypotheses) < SLIVER:
                short = self._cut_short(few)
                if short is not None:
                    return short
            for lattice in candidates(hypotheses, self.lattice)[:few]:
                found.append(self._tried(lattice, hypotheses, searched))
                if not found[-1].misfits:
                    return found[-1]
        if not found and self._moving is not None:  # on none of them the motion went on to its end
            for lattice in candidates(self._before, self.lattice)[:few]:
                found += [self._tried(lattice, self._before, False, cut_short) for cut_short in (False, True)]
            return min(found, key=lambda one: one.misfits, default=None)
        found.sort(key=lambda one: one.misfits)
        others = [one for one in found if one.lattice != self.lattice][:BEST]
        found += [self._tried(one.lattice, one.hypotheses, one.searched, cut_short=True) for one in others]
        return min(found, key=lambda one: one.misfits, default=None)

    def _cut_short(self, few: int) -> Supposed | None:
        """A lattice that stood before the thing in hand was moved, on which that was stopped, and nothing contradicts.

        Rather where something is known that stopped it; of angles that do as well, the middle one.
        """
        if self._moving is None:
            return None
        lattices = candidates(self._before, self.lattice)[:few]
        for cut_short in (False, True):
            tried = [self._tried(lattice, self._before, False, cut_short) for lattice in lattices]
            fitting = sorted((one for one in tried if not one.misfits), key=lambda one: one.lattice.angle)
            if fitting:
                return fitting[(len(fitting) - 1) // 2]
        return None

    def _otherwise_turned(self) -> Supposed | None:
        """A lattice turned otherwise than believed that was never given up, and on which nothing contradicts.

        That he woke amid his square is assumed as long as that explains all.
        """
        others = [other for other in self.hypotheses if other in CENTRED and other.angle != self.lattice.angle]
        left = search(self._recent, others, self._unsettled)
        tried = (self._tried(lattice, left, False) for lattice in candidates(left, self.lattice)[:FEW])
        return next((one for one in tried if not one.misfits), None)

    # -- what there is to try --------------------------------------------------------------------

    @property
    def _moving(self) -> tuple[str, Push | Turn] | None:
        """The name of the thing that was to be moved, and by which command; None when none was."""
        if self.held is not None and isinstance(self.command, Push | Turn):
            return self.held, self.command
        return None

    @property
    def _turned(self) -> bool:
        """Has anything been turned, so that it tells where in his square he stands?"""
        turning = self._moving is not None and isinstance(self.command, Turn)
        return turning or any(load.turned % 360 for load in self.loads.values())

    @property
    def _own(self) -> Place:
        """Where the command leads, in his own frame."""
        east, north = self.lattice.place_to_utak(*self.place)
        if isinstance(self.command, Move if self.held is None else Push):
            return east + self.command.east, north + self.command.north
        return east, north

    def _points(self) -> tuple[Hypothesis, ...]:
        """Points of his square at which he may have woken, the lattice being turned as it is believed to be."""
        given = tuple(h for h in self.hypotheses if h.angle == self.lattice.angle and h.is_point)
        return given if len(given) > 1 else points(self.lattice, self.looks)

    def _left(self) -> tuple[Hypothesis, ...]:
        """The hypotheses that still stand."""
        return search(self._recent, self.hypotheses, self._unsettled)

    def _searched(self) -> tuple[Hypothesis, ...]:
        """All that may be, of angles near to those that were left."""
        angles = [self.lattice.angle, *(h.angle for h in self.hypotheses)]
        if max(angles) - min(angles) > WIDEST:
            angles = [self.lattice.angle]
        about = anywhere(range(min(angles) - ABOUT, max(angles) + ABOUT + 1))
        return search(self._recent, about, self._unsettled)

    @cached_property
    def _before(self) -> tuple[Hypothesis, ...]:
        """The hypotheses that stood before the command."""
        return search(self.looks[-RECENT:], self.hypotheses, self._unsettled)

    @cached_property
    def _recent(self) -> list[Look]:
        return [*self.looks[-RECENT:], Look(self.ranges, self._own)]

    @cached_property
    def _unsettled(self) -> list[Disc]:
        """Where things were moved, wherever they lay meanwhile."""
        discs = set()
        for load in self.loads.values():
            lying = [load.polygon, load.first]
            if self._moving is not None and load.name == self._moving[0]:
                lying.append(as_motion(self._moving[1], self.lattice, self.place).carry(load.polygon))
            middles = [self.lattice.place_to_utak(lain.centroid.x, lain.centroid.y) for lain in lying]
            middles += [was.middle for look in self.looks for was in look.moved if was.name == load.name]
            corners = shapely.get_coordinates(load.polygon) - shapely.get_coordinates(load.polygon.centroid)
            reach = float(np.hypot(*corners.T).max()) + BESIDE
            discs |= {Disc(middle, reach) for middle in middles}
        return sorted(discs)

    # -- trying it -------------------------------------------------------------------------------

    def _point(self, hypothesis: Hypothesis) -> Supposed:
        return self._tried(hypothesis.lattice, (hypothesis,), False)

    def _tried(
        self, lattice: Lattice, hypotheses: tuple[Hypothesis, ...], searched: bool, cut_short: bool = False
    ) -> Supposed:
        """What contradicts a lattice. cut_short : the motion may have ended early, for whatever reason."""
        under = self._laid(lattice)
        if self._moving is None:  # it went as said
            place = lattice.place_from_utak(*self._own)
            misfits = under.misfits + clashes(lattice, under.evidence, under.loads.values(), place, self.ranges)
            return Supposed(lattice, hypotheses, place, None, misfits, searched)
        tried = []
        held, command = self._moving
        load = under.loads[held]
        for outcome in self._outcomes(lattice, under, load.polygon, command, cut_short):
            slack = load.slack if outcome.how == "predicted" or not cut_short else max(load.slack, STRIDE / 2)
            after = {**under.loads, held: load.moved(outcome.polygon, slack)}
            misfits = under.misfits + clashes(lattice, under.evidence, after.values(), outcome.place, self.ranges)
            tried.append(Supposed(lattice, hypotheses, outcome.place, outcome, misfits, searched))
            if not misfits:
                break
        return min(tried, key=lambda one: one.misfits)

    def _laid(self, lattice: Lattice) -> Relaid:
        """What all looks say on a lattice; worked out once for each."""
        if lattice not in self._known:
            self._known[lattice] = laid_on(lattice, self.lattice, self.evidence, self.looks, self.loads)
        return self._known[lattice]

    @cached_property
    def _known(self) -> dict[Lattice, Relaid]:
        return {}

    def _outcomes(
        self, lattice: Lattice, under: Relaid, polygon: Any, command: Push | Turn, cut_short: bool
    ) -> Iterator[Outcome]:
        """The motion, as far as what is known to stand in the way lets it go; and as it was commanded."""
        place = lattice.place_from_utak(*self.lattice.place_to_utak(*self.place))
        motion = as_motion(command, lattice, place)
        if cut_short:
            yield from (outcome for outcome in otherwise(place, polygon, motion) if outcome.how in ("stuck", "blocked"))
            return
        same = under.evidence is self.evidence
        obstacles = self._walls if same else walls(under.evidence, polygon, place, motion)
        stopped = arrested(place, polygon, motion, obstacles)
        if stopped is not None:
            yield stopped
        yield predicted(place, polygon, motion)

    @cached_property
    def _walls(self) -> Obstacles:
        """What stands about the motion on the lattice that is believed."""
        assert self._moving is not None
        held, command = self._moving
        motion = as_motion(command, self.lattice, self.place)
        return walls(self.evidence, self.loads[held].polygon, self.place, motion)


def agreeing(
    hypotheses: Sequence[Hypothesis],
    lattice: Lattice,
    place: Place,
    evidence: Evidence,
    looks: Sequence[Look],
    loads: Mapping[str, Load],
    ranges: Ranges,
) -> tuple[Hypothesis, ...]:
    """Of points at which he may have woken those that agree with a look at what he turned; all when none does.

    lattice, place, evidence, loads : as they are believed, the motion before the look included.
    """
    own = lattice.place_to_utak(*place)
    agree = []
    for hypothesis in hypotheses:
        other = hypothesis.lattice
        under = laid_on(other, lattice, evidence, looks, loads)
        if not clashes(other, under.evidence, under.loads.values(), other.place_from_utak(*own), ranges):
            agree.append(hypothesis)
    return tuple(agree or hypotheses)


def laid_on(new: Lattice, old: Lattice, evidence: Evidence, looks: Sequence[Look], loads: Mapping[str, Load]) -> Relaid:
    """What all looks say, and where the loads are, on another lattice.

    old, evidence : what is believed. Where every look falls on the same squares all that stands says the same.
    """
    if new.angle == old.angle and (fallen(new, looks) == fallen(old, looks)).all():
        return Relaid(evidence, {name: shifted(load, new, old) for name, load in loads.items()}, 0)
    return relaid(new, old, looks, loads.values())


def as_motion(command: Push | Turn, lattice: Lattice, place: Place) -> Motion:
    """A command as a motion on the lattice. place : of Utak, when he gives it."""
    if isinstance(command, Turn):
        return Rotate(command.degrees, place)
    return Translate(*lattice.to_lattice(command.east, command.north))


def clashes(lattice: Lattice, evidence: Evidence, loads: Iterable[Load], place: Place, ranges: Ranges) -> int:
    """How many fields cannot be right if a look was received at a place, with the loads where they lie."""
    x, y = math.floor(place[0]), math.floor(place[1])
    return evidence.clashes(*discounted(lattice.samples(), ranges, x, y, loads), x, y)


def walls(evidence: Evidence, polygon: Any, place: Place, motion: Motion) -> Obstacles:
    """What is known to stand where a thing and Utak may come on a motion."""
    corners = np.array([*shapely.get_coordinates(polygon), place])
    if isinstance(motion, Rotate):
        reach = float(np.hypot(*(corners - np.array(place)).T).max())
        low, high = np.array(place) - reach, np.array(place) + reach
    else:
        ends = np.concatenate([corners, motion.points(corners)])
        low, high = ends.min(0), ends.max(0)
    row, column = evidence.index(*(math.floor(v) - ROOM for v in low))
    top, right = evidence.index(*(math.ceil(v) + ROOM for v in high))
    row, column = max(row, 0), max(column, 0)
    rows, columns = np.nonzero(evidence.state[row:top, column:right] == FULL)
    west, south = columns + column + evidence.west, rows + row + evidence.south
    return Obstacles(list(shapely.box(west, south, west + 1, south + 1)))


def _middle(fitting: Sequence[Supposed]) -> Supposed:
    """Of lattices that differ in where Utak woke the one amid them; all of them are left."""
    woke = np.array([one.lattice.woke for one in fitting])
    nearest = int(np.hypot(*(woke - woke.mean(0)).T).argmin())
    return fitting[nearest]._replace(hypotheses=tuple(h for one in fitting for h in one.hypotheses))
