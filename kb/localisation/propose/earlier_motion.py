"""Motions told again once things have been moved: an earlier one ended elsewhere than believed, so a look contradicts.

All that was seen since, and every thing that was first held since, lies where it would then. The motion after which the
look came is told again with it, for what stopped the one may have stopped the other, seen where it is.
"""

import itertools
import math
from collections.abc import Iterator, Sequence, Set
from dataclasses import replace
from typing import NamedTuple

from geometry.motion.first_contact import ContactBody, Obstacles
from geometry.motion.se2 import Translate
from kb.localisation.hypotheses.contacts import TOGETHER, Obstructions, box_of
from kb.localisation.hypotheses.frames import Observation, anywhere, candidates, exactly, fallen, search
from kb.localisation.hypotheses.remap import RemappedMap, lain, relaid
from kb.localisation.hypotheses.walk_outcomes import (
    HAIR,
    End,
    MotionHypothesis,
    Place,
    ReestimatedWalk,
    Walk,
    WalkCorrection,
    agreed,
    plus,
    views,
)
from kb.localisation.hypotheses.what_if import Surprise, WhatIf
from kb.mapping.occupancy import FREE, FULL, OPEN, OccupancyMap
from kb.mapping.patch import covered
from kb.objects.held_object import HeldObject, Square, is_whole
from kb.perception.frame import Frame

LAST = 4  # motions that are told again together with where he woke
FEW = 3  # lattices on which each is tried


class ReestimatedMotion(NamedTuple):
    """What may have come of an earlier motion, and what is to be believed then of all else."""

    retold: ReestimatedWalk
    supposed: WhatIf


class CarriedMotion:
    """A straight motion with a thing in hand, on the lattice that is believed.

    ends : where it may have been stopped, the likeliest first by what was seen before, and its end.
    """

    def __init__(self, motion: MotionHypothesis, surprise: Surprise) -> None:
        assert motion.load is not None
        frame, observations, loads = surprise.frame, surprise.observations[: motion.number], surprise.loads
        was = next(was for was in observations[-1].moved if was.name == motion.load)
        self._place = frame.place_from_utak(*observations[-1].place)
        self._polygon = lain(loads[motion.load], was, frame).polygon
        self._motion = Translate(*frame.to_lattice(*motion.shift))
        before = relaid(frame, frame, observations, loads.values(), surprise.prefixes.of(motion.number)).occupancy
        stops = self._hindrances(before).stops(self._place, self._polygon, self._motion)
        parts = dict.fromkeys((*(stop.part for stop in sorted(stops, key=lambda stop: -stop.chance)), 1.0))
        halts = [(part, view) for part in parts for view in views(self._after(part))]
        self.ends = tuple(End(frame.place_to_utak(*view), part) for part, view in halts)

    def _after(self, part: float) -> Place:
        """Where Utak is after a part of the motion."""
        return self._place[0] + part * self._motion.dx, self._place[1] + part * self._motion.dy

    def ahead(self, end: End, occupancy: OccupancyMap, things: Set[Square]) -> int:
        """What stands where it would have been stopped; FREE, too, where something would have stopped it before.

        things : squares on which something stood then that was moved since.
        """
        body, hindrances = ContactBody(self._polygon, [self._place]), self._hindrances(occupancy)
        known = hindrances.walls.first_contact(body, self._motion).fraction
        if things:
            stood = Obstacles([box_of(square) for square in things])
            known = min(known, stood.first_contact(body, self._motion).fraction)
        if known < end.gone - TOGETHER:
            return FREE
        if known < 1.0 and known < end.gone + TOGETHER:
            return FULL
        stops = hindrances.stops(self._place, self._polygon, self._motion)
        return OPEN if end.gone == 1.0 or any(abs(stop.part - end.gone) < TOGETHER for stop in stops) else FREE

    def _hindrances(self, occupancy: OccupancyMap) -> Obstructions:
        return Obstructions(occupancy, self._place, self._polygon, self._motion)


def recalled(surprise: Surprise, motions: Sequence[MotionHypothesis]) -> list[ReestimatedMotion]:
    """All that may have come of earlier motions by which nothing is contradicted any more, on the lattice believed.

    Those come first by which something known stopped him.
    """
    told = [motion for motion in reversed(motions) if _held_then(motion, surprise)]
    found = [one for motion in told for one in _otherwise(surprise, motion)]
    return sorted(found, key=lambda one: not one.retold.known)


def recalled_elsewhere(surprise: Surprise, motions: Sequence[MotionHypothesis]) -> list[ReestimatedMotion]:
    """The same of the last motion of a thing that explains all, if he woke elsewhere in his square besides.

    Neither is told without the other: where a thing was stopped depends on where it lay, which is known in squares;
    from where he looked then does on where he woke.
    """
    told = (motion for motion in reversed(motions) if motion.load is not None and _held_then(motion, surprise))
    found = ([*_elsewhere(surprise, motion)] for motion in itertools.islice(told, LAST))
    return sorted(next(filter(None, found), []), key=lambda one: not one.retold.known)


def _held_then(motion: MotionHypothesis, surprise: Surprise) -> bool:
    """Is it told where the thing lay that was in hand on a motion, if one was?"""
    before = surprise.observations[motion.number - 1].moved
    return motion.load is None or any(was.name == motion.load for was in before)


def _otherwise(surprise: Surprise, motion: MotionHypothesis) -> Iterator[ReestimatedMotion]:
    """What else may have come of one motion."""
    observations, frame = surprise.observations, surprise.frame
    believed, first = observations[motion.number].place, surprise.prefixes.of(motion.number)
    if first.contradicted:  # whatever came of the motion
        return
    way = Walk(motion, frame, observations) if motion.load is None else CarriedMotion(motion, surprise)
    judged: dict[Place, RemappedMap | None] = {}  # by the shift
    for end in way.ends:
        shift = end.place[0] - believed[0], end.place[1] - believed[1]
        if math.hypot(*shift) < HAIR:  # as is believed
            continue
        anew, correction = _corrected(surprise, motion, end)
        if shift not in judged:
            judged[shift] = agreed(frame, anew.observations, anew.loads.values(), anew.unsettled, begun=first)
        under = judged[shift]
        if under is None or under.misfits:
            continue
        ahead = way.ahead(end, under.occupancy, _stood(under, anew.observations, motion, frame))
        if ahead == FREE:
            continue
        supposed = replace(anew, occupancy=under.occupancy, loads=under.loads).tried(
            frame, surprise.hypotheses, whether=True
        )
        if not supposed.misfits:
            yield ReestimatedMotion(ReestimatedWalk(exactly(frame), correction, ahead == FULL, 0), supposed)


def _elsewhere(surprise: Surprise, motion: MotionHypothesis) -> Iterator[ReestimatedMotion]:
    """What else may have come of one motion of a thing, if he woke elsewhere in his square."""
    anywhere_in_it = anywhere((surprise.frame.angle,))
    for end in CarriedMotion(motion, surprise).ends:
        anew, correction = _corrected(surprise, motion, end)
        left = search(anew.recent, anywhere_in_it, anew.unsettled)
        if not left:
            continue
        first = surprise.prefixes.of(motion.number)
        under = relaid(surprise.frame, surprise.frame, anew.observations, anew.loads.values(), first)
        anew = replace(anew, occupancy=under.occupancy, loads=under.loads)
        for frame in candidates(left, surprise.frame)[:FEW]:
            supposed = anew.tried(frame, left, whether=True)
            if supposed.misfits:
                continue
            under = anew.laid(frame)
            there = replace(anew, frame=frame, occupancy=under.occupancy, loads=under.loads)
            way = CarriedMotion(motion, there)
            ahead = way.ahead(end, under.occupancy, _stood(under, anew.observations, motion, frame))
            if ahead != FREE:
                yield ReestimatedMotion(ReestimatedWalk(exactly(frame), correction, ahead == FULL, 0), supposed)


def _corrected(surprise: Surprise, motion: MotionHypothesis, end: End) -> tuple[Surprise, WalkCorrection]:
    """A surprise as it is if an earlier motion ended elsewhere, and what is corrected by that."""
    frame, believed = surprise.frame, surprise.observations[motion.number].place
    shift = end.place[0] - believed[0], end.place[1] - believed[1]
    since = [load for load in surprise.loads.values() if load.since > motion.number]
    seen = tuple((load.name, _aside(load, shift, surprise)) for load in since)
    correction = WalkCorrection(motion.number, shift, seen, motion.load)
    there, loads = correction.observations(surprise.observations), correction.loads(surprise.loads, frame)
    place = frame.place_from_utak(*correction.place(frame.place_to_utak(*surprise.place)))
    return replace(surprise, place=place, observations=there, loads=loads), correction


def _aside(load: HeldObject, shift: Place, surprise: Surprise) -> Place:
    """How far a thing lies from where it was seen to, if Utak stood aside: so many squares when its sides lie on lines.

    For the eye tells squares, wherever in his own he stands.
    """
    if not is_whole(load.first):
        return shift
    frame, observation = surprise.frame, surprise.observations[load.since - 1]
    elsewhere = observation._replace(place=plus(observation.place, shift))
    (west, south), (east, north) = fallen(frame, [observation, elsewhere])
    return frame.to_utak(float(east - west), float(north - south))


def _stood(
    under: RemappedMap, observations: Sequence[Observation], motion: MotionHypothesis, frame: Frame
) -> frozenset[Square]:
    """The squares on which things stood when a motion was made that he has moved since, or before."""
    before = {was.name: was for was in observations[motion.number - 1].moved}
    squares: frozenset[Square] = frozenset()
    for load in under.loads.values():
        if load.name != motion.load:
            lying = lain(load, before[load.name], frame).polygon if load.name in before else load.first
            squares |= covered(lying).squares()
    return squares
