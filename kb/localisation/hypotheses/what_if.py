"""Supposing that the lattice lies otherwise, when a look contradicts what is believed and things have been moved.

Then looks do not agree where things came from and went to. So each lattice that may be is held against all looks, with
the things laid on it anew. Which are tried is for kb.localisation.propose.frame and
kb.localisation.propose.origin_from_turns.
"""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

from geometry.motion.se2 import Motion, Rotate, Translate
from kb.body import Command, Move, Push, Turn
from kb.localisation.hypotheses.carry_outcomes import STRIDE, Outcome, arrested, otherwise, predicted
from kb.localisation.hypotheses.contacts import Obstructions
from kb.localisation.hypotheses.frames import FrameHypothesis, Observation, OriginDisc, cells, search
from kb.localisation.hypotheses.remap import Prefixes, RemapCache, RemappedMap
from kb.mapping.completions import Completions
from kb.mapping.occupancy import OccupancyMap
from kb.objects.held_object import HeldObject, discounted
from kb.perception.frame import Frame

Place = tuple[float, float]
Ranges = NDArray[np.int16]
RECENT = 24  # looks by which lattices are judged
BESIDE = 1.5  # squares about a thing that was moved in which looks need not agree


class WhatIf(NamedTuple):
    """A lattice that may be the true one.

    hypotheses : all that are left then. place : where Utak is on it. outcome : what came of the motion of the thing in
    hand. misfits : fields that contradict it, of all looks. searched : were hypotheses taken up that had been given up?
    """

    frame: Frame
    hypotheses: tuple[FrameHypothesis, ...]
    place: Place
    outcome: Outcome | None
    misfits: int
    searched: bool


@dataclass(frozen=True)
class Surprise:
    """A look, after a command, that contradicts what was believed before.

    place : of Utak before it, on the lattice. held : the name of the load in his hand. hypotheses : what was left.
    pictures : of the map before it; None where none were drawn.
    """

    command: Command
    ranges: Ranges
    frame: Frame
    place: Place
    occupancy: OccupancyMap
    observations: Sequence[Observation]
    loads: Mapping[str, HeldObject]
    held: str | None
    hypotheses: tuple[FrameHypothesis, ...]
    pictures: Completions | None = None

    # -- what is known of it ---------------------------------------------------------------------

    @property
    def moving(self) -> tuple[str, Push | Turn] | None:
        """The name of the thing that was to be moved, and by which command; None when none was."""
        if self.held is not None and isinstance(self.command, Push | Turn):
            return self.held, self.command
        return None

    @property
    def degrees(self) -> float:
        """By which what is in his hand was to be turned."""
        return self.command.degrees if isinstance(self.command, Turn) and self.held is not None else 0.0

    @property
    def turned(self) -> bool:
        """Has anything been turned, so that it tells where in his square he stands?"""
        return self.degrees != 0.0 or any(load.turned % 360 for load in self.loads.values())

    @property
    def own(self) -> Place:
        """Where the command leads, in his own frame."""
        east, north = self.frame.place_to_utak(*self.place)
        if isinstance(self.command, Move if self.held is None else Push):
            return east + self.command.east, north + self.command.north
        return east, north

    @cached_property
    def before(self) -> tuple[FrameHypothesis, ...]:
        """The hypotheses that stood before the command."""
        return search(self.observations[-RECENT:], self.hypotheses, self.unsettled)

    @cached_property
    def recent(self) -> list[Observation]:
        """The looks by which lattices are judged, the new one last."""
        return [*self.observations[-RECENT:], Observation(self.ranges, self.own)]

    @cached_property
    def unsettled(self) -> list[OriginDisc]:
        """Where things were moved, wherever they lay meanwhile."""
        discs = set()
        for load in self.loads.values():
            lying = [load.polygon, load.first]
            if self.moving is not None and load.name == self.moving[0]:
                lying.append(as_motion(self.moving[1], self.frame, self.place).carry(load.polygon))
            middles = [self.frame.place_to_utak(lain.centroid.x, lain.centroid.y) for lain in lying]
            middles += [
                was.middle for observation in self.observations for was in observation.moved if was.name == load.name
            ]
            corners = shapely.get_coordinates(load.polygon) - shapely.get_coordinates(load.polygon.centroid)
            reach = float(np.hypot(*corners.T).max()) + BESIDE
            discs |= {OriginDisc(middle, reach) for middle in middles}
        return sorted(discs)

    @cached_property
    def prefixes(self) -> Prefixes:
        """The first of the looks, on the lattice that is believed."""
        return Prefixes(self.frame, self.observations, self.loads)

    # -- trying a lattice ------------------------------------------------------------------------

    def tried(
        self,
        frame: Frame,
        hypotheses: tuple[FrameHypothesis, ...],
        searched: bool = False,
        cut_short: bool = False,
        far: float = 0.0,
        whether: bool = False,
    ) -> WhatIf:
        """What contradicts a lattice.

        cut_short : the motion may have ended early, for whatever reason. far : squares from where he woke, at most.
        whether : as for `judged`.
        """
        if whether and (refused := self.refused(frame, hypotheses)) is not None:
            return refused._replace(searched=searched)
        if self.moving is None:  # it went as said
            place = frame.place_from_utak(*self.own)
            misfits = self._misfits(frame, self.laid(frame).loads.values(), place, far, whether)
            return WhatIf(frame, hypotheses, place, None, misfits, searched)
        tried = []
        for outcome in self._outcomes(frame, cut_short):
            slack = STRIDE / 2 if cut_short and outcome.how != "predicted" else 0.0
            tried.append(self.judged(frame, hypotheses, outcome, slack, far, searched, whether))
            if not tried[-1].misfits:
                break
        return min(tried, key=lambda one: one.misfits)

    def refused(self, frame: Frame, hypotheses: tuple[FrameHypothesis, ...]) -> WhatIf | None:
        """That earlier looks contradict a lattice, whatever came of the motion; None when none does."""
        misfits = self.laid(frame, whether=True).misfits
        place = frame.place_from_utak(*self.own)
        return WhatIf(frame, hypotheses, place, None, misfits, False) if misfits else None

    def judged(
        self,
        frame: Frame,
        hypotheses: tuple[FrameHypothesis, ...],
        outcome: Outcome,
        slack: float = 0.0,
        far: float = 0.0,
        searched: bool = False,
        whether: bool = False,
    ) -> WhatIf:
        """What contradicts a lattice, and an outcome of the motion of what was in his hand.

        slack : squares by which it may have ended elsewhere. far : squares from where he woke, at most. whether : it is
        asked only whether anything contradicts; misfits may then be too few, though not 0.
        """
        assert self.moving is not None
        held, loads = self.moving[0], self.laid(frame).loads
        slack, commanded = max(loads[held].slack, slack), outcome.as_commanded
        moved = loads[held].moved(outcome.polygon, slack, outcome.degrees, commanded)
        misfits = self._misfits(frame, {**loads, held: moved}.values(), outcome.place, far, whether)
        return WhatIf(frame, hypotheses, outcome.place, outcome, misfits, searched)

    def _misfits(
        self, frame: Frame, loads: Iterable[HeldObject], place: Place, far: float, whether: bool = False
    ) -> int:
        """How many fields contradict a lattice, of this look, with the loads where they lie then, and of all others."""
        under = self.laid(frame)
        if whether and under.misfits:
            return under.misfits
        lying = [load.woken(far) if far else load for load in loads]
        return under.misfits + clashes(frame, under.occupancy, lying, place, self.ranges, whether)

    def begun(self, frame: Frame) -> tuple[Place, Any, Motion]:
        """Where he stood before the motion, and what was in his hand, if the lattice lies so; and the motion."""
        assert self.moving is not None
        held, command = self.moving
        place = frame.place_from_utak(*self.frame.place_to_utak(*self.place))
        return place, self.laid(frame).loads[held].polygon, as_motion(command, frame, place)

    def laid(self, frame: Frame, whether: bool = False) -> RemappedMap:
        """What all looks say on a lattice. whether : as for kb.localisation.hypotheses.remap.relaid."""
        return self._layings.on(frame, whether)

    @cached_property
    def _layings(self) -> RemapCache:
        return RemapCache(self.frame, self.occupancy, self.observations, self.loads)

    def _outcomes(self, frame: Frame, cut_short: bool) -> Iterator[Outcome]:
        """The motion, as far as what is known to stand in the way lets it go; and as it was commanded."""
        place, polygon, motion = self.begun(frame)
        if cut_short:
            yield from (outcome for outcome in otherwise(place, polygon, motion) if outcome.how in ("stuck", "blocked"))
            return
        occupancy = self.laid(frame).occupancy
        same = occupancy is self.occupancy
        hindrances = self.hindrances if same else Obstructions(occupancy, place, polygon, motion)
        stopped = arrested(place, polygon, motion, hindrances.walls)
        if stopped is not None:
            yield stopped
        yield predicted(place, polygon, motion)

    @cached_property
    def hindrances(self) -> Obstructions:
        """What stands, or may stand, about the motion on the lattice that is believed."""
        return Obstructions(self.occupancy, *self.begun(self.frame), self.pictures)

    # -- after it ---------------------------------------------------------------------------------

    def lying(self, outcome: Outcome) -> list[HeldObject]:
        """All loads where they lie on the lattice that is believed, if the motion of the one in hand came out so."""
        return [
            load.moved(outcome.polygon, load.slack, commanded=outcome.as_commanded) if name == self.held else load
            for name, load in self.loads.items()
        ]

    def looked(self, loads: Sequence[HeldObject], place: Place) -> OccupancyMap:
        """What is settled together with the look, if it was received at a place, with the loads where they lie."""
        x, y = (math.floor(v) for v in place)
        samples, counts = discounted(self.frame.samples(), self.ranges, x, y, loads)
        occupancy = self.occupancy.copy()
        occupancy.observe(samples, counts, x, y, len(self.observations))
        return occupancy


def agreeing(
    hypotheses: Sequence[FrameHypothesis],
    frame: Frame,
    place: Place,
    occupancy: OccupancyMap,
    observations: Sequence[Observation],
    loads: Mapping[str, HeldObject],
    ranges: Ranges,
) -> tuple[FrameHypothesis, ...]:
    """Of points at which he may have woken those that agree with a look at what he turned; all when none does.

    lattice, place, evidence, loads : as they are believed, the motion before the look included.
    """
    own, far = frame.place_to_utak(*place), math.hypot(*cells(hypotheses)) / 2
    agree, layings = [], RemapCache(frame, occupancy, observations, loads)
    for hypothesis in hypotheses:
        other = hypothesis.frame
        under = layings.on(other)
        lying = [load.woken(far) for load in under.loads.values()]
        if not clashes(other, under.occupancy, lying, other.place_from_utak(*own), ranges):
            agree.append(hypothesis)
    return tuple(agree or hypotheses)


def as_motion(command: Push | Turn, frame: Frame, place: Place) -> Motion:
    """A command as a motion on the lattice. place : of Utak, when he gives it."""
    if isinstance(command, Turn):
        return Rotate(command.degrees, place)
    return Translate(*frame.to_lattice(command.east, command.north))


def clashes(
    frame: Frame,
    occupancy: OccupancyMap,
    loads: Iterable[HeldObject],
    place: Place,
    ranges: Ranges,
    whether: bool = False,
) -> int:
    """How many fields cannot be right if a look was received at a place, with the loads where they lie.

    whether : it is asked only whether there are any; too few may be told then, though not 0.
    """
    x, y = math.floor(place[0]), math.floor(place[1])
    return occupancy.clashes(*discounted(frame.samples(), ranges, x, y, loads), x, y, whether)
