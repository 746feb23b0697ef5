"""Evaluation of what-if questions: which fields contradict another frame, once objects have been moved.

Observations do not agree where objects came from and went to. So each frame in question is compared with all
observations, with the objects remapped to it. kb.localisation.propose.frame and
kb.localisation.propose.origin_from_turns say which frames are evaluated.
"""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
import shapely

from utak.geometry.motion.se2 import Motion, Rotate, Translate
from utak.kb.body import Command, Move, Push, Turn
from utak.kb.localisation.hypotheses.carry_outcomes import (
    END_SPACING,
    CarryOutcome,
    blocked_by_known,
    other_outcomes,
    predicted_outcome,
)
from utak.kb.localisation.hypotheses.contacts import Obstructions
from utak.kb.localisation.hypotheses.frames import (
    FieldRanges,
    FrameHypothesis,
    Observation,
    Position,
    UnsettledDisc,
    consistent_hypotheses,
    grid_cell_size,
)
from utak.kb.localisation.hypotheses.remap import RemapCache, RemappedMap, ReplayPrefixes
from utak.kb.mapping.completions import Completions
from utak.kb.mapping.occupancy import OccupancyMap
from utak.kb.objects.held_object import HeldObject, Square, subtract_held_objects
from utak.kb.perception.frame import Frame

MAX_JUDGING_OBSERVATIONS = 24  # last observations by which frames are judged once objects were moved; tuned
UNSETTLED_MARGIN = 1.5  # squares around a moved object within which observations need not agree; tuned


class WhatIf(NamedTuple):
    """The evaluation of a frame that may be the true one."""

    frame: Frame  # the frame
    hypotheses: tuple[FrameHypothesis, ...]  # all frame hypotheses that are left then
    place: Position  # of Utak now, (x, y) in squares, map frame of `frame`
    # Of the motion of the object in hand, map frame of `frame`; None when none was moved, or not asked
    outcome: CarryOutcome | None
    residual: int  # number of fields that contradict it, over all observations; 0 is best
    searched: bool  # whether hypotheses were taken up again that had been given up


@dataclass(frozen=True)
class Surprise:
    """An observation that contradicts what is believed, with what was believed before it."""

    command: Command  # the command before the observation, Utak's own frame
    ranges: FieldRanges  # (160, 2) int16, least and greatest count of occupied squares under each of its fields
    frame: Frame  # the believed frame
    place: Position  # of Utak before the command, (x, y) in squares, map frame
    occupancy: OccupancyMap  # the believed map
    observations: Sequence[Observation]  # all earlier ones, oldest first
    held_objects: Mapping[str, HeldObject]  # all objects that were ever held, before the command, by name, map frame
    in_hand: str | None  # the name of the object in hand; None when there is none
    hypotheses: tuple[FrameHypothesis, ...]  # the frame hypotheses that are left
    # Completions of the believed map (sampled maps that agree with all counts); None when none were drawn
    pictures: Completions | None = None
    # The squares of things that were seen and never held, by name, map frame
    things: Mapping[str, frozenset[Square]] = field(default_factory=dict)

    # -- what is known of it ---------------------------------------------------------------------

    @property
    def carried(self) -> tuple[str, Push | Turn] | None:
        """Return the name of the object that was to be moved, and the command (push or turn); None when none was."""
        if self.in_hand is not None and isinstance(self.command, Push | Turn):
            return self.in_hand, self.command
        return None

    @property
    def degrees(self) -> float:
        """Return the commanded rotation of the held object, in degrees, counter-clockwise positive; 0 for no turn."""
        return self.command.degrees if isinstance(self.command, Turn) and self.in_hand is not None else 0.0

    @property
    def any_turned(self) -> bool:
        """Return whether any object was ever turned, or is to be turned now: then it tells where the origin lies."""
        return self.degrees != 0.0 or any(held.turned % 360 for held in self.held_objects.values())

    @property
    def commanded_place(self) -> Position:
        """Return where the command leads: (east, north) in squares, Utak's own frame."""
        east, north = self.frame.place_to_utak(*self.place)
        if isinstance(self.command, Move if self.in_hand is None else Push):
            return east + self.command.east, north + self.command.north
        return east, north

    @cached_property
    def hypotheses_before(self) -> tuple[FrameHypothesis, ...]:
        """Return what all observations before the command leave of the frame hypotheses, in their order; cached."""
        # Empty when they refute all.
        return consistent_hypotheses(
            self.observations[-MAX_JUDGING_OBSERVATIONS:], self.hypotheses, self.unsettled_discs
        )

    @cached_property
    def judging_observations(self) -> list[Observation]:
        """Return the observations by which frames are judged, oldest first: the last earlier ones and the new one."""
        newest = Observation(self.ranges, self.commanded_place)
        return [*self.observations[-MAX_JUDGING_OBSERVATIONS:], newest]

    @cached_property
    def unsettled_discs(self) -> list[UnsettledDisc]:
        """Return the parts of the table where any object lay at any time, or is to lie now, sorted."""
        discs = set()
        for held in self.held_objects.values():
            lying = [held.polygon, held.first]
            if self.carried is not None and held.name == self.carried[0]:
                lying.append(command_motion(self.carried[1], self.frame, self.place).carry(held.polygon))
            middles = [self.frame.place_to_utak(lain.centroid.x, lain.centroid.y) for lain in lying]
            middles += [
                pose.middle for observation in self.observations for pose in observation.moved if pose.name == held.name
            ]
            corners = shapely.get_coordinates(held.polygon) - shapely.get_coordinates(held.polygon.centroid)
            reach = float(np.hypot(*corners.T).max()) + UNSETTLED_MARGIN
            discs |= {UnsettledDisc(middle, reach) for middle in middles}
        return sorted(discs)

    @cached_property
    def prefixes(self) -> ReplayPrefixes:
        """Return the replays of the first observations (mapped one after the other) in the believed frame; cached."""
        return ReplayPrefixes(self.frame, self.observations, self.held_objects)

    # -- evaluation of a frame -------------------------------------------------------------------

    def evaluate_frame(
        self,
        frame: Frame,
        hypotheses: tuple[FrameHypothesis, ...],
        searched: bool = False,
        cut_short: bool = False,
        origin_error: float = 0.0,
        only_whether: bool = False,
    ) -> WhatIf:
        """Return what contradicts a frame, with the outcome of the motion that fits it best."""
        if only_whether and (refuted := self.refuted(frame, hypotheses)) is not None:
            return refuted._replace(searched=searched)
        if self.carried is None:  # it went as commanded
            place = frame.place_from_utak(*self.commanded_place)
            held_objects = self.remapped(frame).held_objects.values()
            residual = self._residual(frame, held_objects, place, origin_error, only_whether)
            return WhatIf(frame, hypotheses, place, None, residual, searched)
        tried = []
        for outcome in self._outcomes(frame, cut_short):
            slack = END_SPACING / 2 if cut_short and outcome.how != "predicted" else 0.0
            judged = self.evaluate_outcome(frame, hypotheses, outcome, slack, origin_error, searched, only_whether)
            tried.append(judged)
            if not judged.residual:
                break
        return min(tried, key=lambda one: one.residual)

    def refuted(self, frame: Frame, hypotheses: tuple[FrameHypothesis, ...]) -> WhatIf | None:
        """Return the evaluation of a frame that earlier observations contradict; None when none does."""
        residual = self.remapped(frame, only_whether=True).residual
        place = frame.place_from_utak(*self.commanded_place)
        return WhatIf(frame, hypotheses, place, None, residual, False) if residual else None

    def evaluate_outcome(
        self,
        frame: Frame,
        hypotheses: tuple[FrameHypothesis, ...],
        outcome: CarryOutcome,
        slack: float = 0.0,
        origin_error: float = 0.0,
        searched: bool = False,
        only_whether: bool = False,
    ) -> WhatIf:
        """Return what contradicts a frame together with an outcome of the motion of the object in hand."""
        assert self.carried is not None
        name, held_objects = self.carried[0], self.remapped(frame).held_objects
        slack, commanded = max(held_objects[name].slack, slack), outcome.as_commanded
        moved = held_objects[name].moved(outcome.polygon, slack, outcome.degrees, commanded)
        after = {**held_objects, name: moved}.values()
        residual = self._residual(frame, after, outcome.place, origin_error, only_whether)
        return WhatIf(frame, hypotheses, outcome.place, outcome, residual, searched)

    def _residual(
        self,
        frame: Frame,
        held_objects: Iterable[HeldObject],
        place: Position,
        origin_error: float,
        only_whether: bool = False,
    ) -> int:
        """Return how many fields contradict a frame, over all observations."""
        under = self.remapped(frame)
        if only_whether and under.residual:
            return under.residual
        lying = [held.woken(origin_error) if origin_error else held for held in held_objects]
        return under.residual + count_clashes(frame, under.occupancy, lying, place, self.ranges, only_whether)

    def motion_in(self, frame: Frame) -> tuple[Position, Any, Motion]:
        """Return Utak's place and the outline of the object before the motion, and the motion, all in a frame."""
        assert self.carried is not None
        name, command = self.carried
        place = frame.place_from_utak(*self.frame.place_to_utak(*self.place))
        return place, self.remapped(frame).held_objects[name].polygon, command_motion(command, frame, place)

    def remapped(self, frame: Frame, only_whether: bool = False) -> RemappedMap:
        """Return the map of all earlier observations in a frame, with the held objects; kept for each frame."""
        return self._maps.remapped(frame, only_whether)

    @cached_property
    def _maps(self) -> RemapCache:
        """Return the cache of the maps, with the held objects, of all frames that were asked for; cached itself."""
        return RemapCache(self.frame, self.occupancy, self.observations, self.held_objects)

    def _outcomes(self, frame: Frame, cut_short: bool) -> Iterator[CarryOutcome]:
        """Yield the outcomes of the motion of the object in hand that are to be evaluated in a frame."""
        place, polygon, motion = self.motion_in(frame)
        if cut_short:
            yield from (outcome for outcome in other_outcomes(place, polygon, motion) if outcome.stopped)
            return
        occupancy = self.remapped(frame).occupancy
        same = occupancy is self.occupancy
        obstructions = self.obstructions if same else Obstructions(occupancy, place, polygon, motion)
        blocked = blocked_by_known(place, polygon, motion, obstructions.known)
        if blocked is not None:
            yield blocked
        yield predicted_outcome(place, polygon, motion)

    @cached_property
    def obstructions(self) -> Obstructions:
        """Return the obstacles, occupied squares and open ones, about the motion of the object in hand; cached."""
        return Obstructions(self.occupancy, *self.motion_in(self.frame), self.pictures)

    # -- after it ---------------------------------------------------------------------------------

    def others(self, held: HeldObject) -> list[HeldObject]:
        """Return all objects that were ever held except the one of the name of `held`, where they lie, map frame."""
        return [other for other in self.held_objects.values() if other.name != held.name]

    def objects_after(self, outcome: CarryOutcome) -> list[HeldObject]:
        """Return all held objects after an outcome of the motion of the one in hand, believed frame."""
        return [
            held.moved(outcome.polygon, held.slack, commanded=outcome.as_commanded) if name == self.in_hand else held
            for name, held in self.held_objects.items()
        ]

    def map_after(self, held_objects: Sequence[HeldObject], place: Position) -> OccupancyMap:
        """Return a copy of the believed map with the new observation integrated as if it was made at `place`."""
        x, y = (math.floor(v) for v in place)
        samples, counts = subtract_held_objects(self.frame.samples(), self.ranges, x, y, held_objects)
        occupancy = self.occupancy.copy()
        occupancy.observe(samples, counts, x, y, len(self.observations))
        return occupancy


def agreeing_hypotheses(
    hypotheses: Sequence[FrameHypothesis],
    frame: Frame,
    place: Position,
    occupancy: OccupancyMap,
    observations: Sequence[Observation],
    held_objects: Mapping[str, HeldObject],
    ranges: FieldRanges,
) -> tuple[FrameHypothesis, ...]:
    """Return those exact origins that agree with an observation of turned objects; all when none does."""
    own, error = frame.place_to_utak(*place), math.hypot(*grid_cell_size(hypotheses)) / 2
    agree, maps = [], RemapCache(frame, occupancy, observations, held_objects)
    for hypothesis in hypotheses:
        other = hypothesis.frame
        under = maps.remapped(other)
        lying = [held.woken(error) for held in under.held_objects.values()]
        if not count_clashes(other, under.occupancy, lying, other.place_from_utak(*own), ranges):
            agree.append(hypothesis)
    return tuple(agree or hypotheses)


def command_motion(command: Push | Turn, frame: Frame, place: Position) -> Motion:
    """Return a command as a motion of the map frame of `frame`, in squares or degrees."""
    if isinstance(command, Turn):
        return Rotate(command.degrees, place)
    return Translate(*frame.to_map(command.east, command.north))


def count_clashes(
    frame: Frame,
    occupancy: OccupancyMap,
    held_objects: Iterable[HeldObject],
    place: Position,
    ranges: FieldRanges,
    only_whether: bool = False,
) -> int:
    """Return how many fields of an observation contradict the map and the held objects; 0 when none does."""
    x, y = math.floor(place[0]), math.floor(place[1])
    return occupancy.clashes(*subtract_held_objects(frame.samples(), ranges, x, y, held_objects), x, y, only_whether)
