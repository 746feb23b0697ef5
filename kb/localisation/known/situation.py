"""The situation: what is known when an observation is to be explained, and what contradicts another frame then.

Before an object is moved observations contradict each other in a wrong frame. Once objects were moved observations do
not agree where they came from and went to, so each frame in question is compared with all observations, with the
objects remapped to it.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from copy import copy
from dataclasses import dataclass, replace
from functools import cache, cached_property, lru_cache
from typing import Any

import numpy as np
import shapely

from utak.geometry.motion.se2 import Motion, Rotate, Translate
from utak.kb.body import Command, Move, Push, Turn
from utak.kb.localisation.hypotheses.carry_outcomes import (
    END_SPACING,
    CarryOutcome,
    blocked_by_known,
    observed_from,
    other_outcomes,
    predicted_outcome,
)
from utak.kb.localisation.hypotheses.contacts import ContactHypothesis, Obstructions, contact_outcomes
from utak.kb.localisation.hypotheses.explanation import Explanation
from utak.kb.localisation.hypotheses.frames import (
    MAX_CHECKED_OBSERVATIONS,
    FieldRanges,
    Hypothesis,
    Observation,
    Position,
    UnsettledDisc,
    prune_hypotheses,
)
from utak.kb.localisation.hypotheses.map_prior import weigh_hypotheses
from utak.kb.localisation.hypotheses.reestimation import reestimate_walk
from utak.kb.localisation.hypotheses.remap import RemapCache, RemappedMap, ReplayPrefixes
from utak.kb.localisation.hypotheses.walk_outcomes import StraightMotion, add
from utak.kb.localisation.known.frames_left import another_frame
from utak.kb.localisation.known.state import TrackerState
from utak.kb.mapping.occupancy import OccupancyMap
from utak.kb.objects.held_object import HeldObject, subtract_held_objects
from utak.kb.perception.frame import Frame

MAX_JUDGING_OBSERVATIONS = 24  # last observations by which frames are judged once objects were moved; tuned
UNSETTLED_MARGIN = 1.5  # squares around a moved object within which observations need not agree; tuned
MAX_KEPT_REPLAYS = 16  # frames whose replayed first observations are kept for other motions: bounds memory; tuned


@dataclass(frozen=True)
class ObservedSituation:
    """An observation that is to be explained, with what was believed before it and the explanations found so far."""

    state: TrackerState  # before the command
    command: Command | None  # before the observation, Utak's own frame; None on waking
    ranges: FieldRanges  # (160, 2) int16, least and greatest count of occupied squares under each of its fields
    found: tuple[Explanation, ...] = ()  # the likeliest first

    # -- what is known of it ---------------------------------------------------------------------

    def having(self, found: Iterable[Explanation]) -> "ObservedSituation":
        """Return the situation with other explanations found; what was worked out of it is kept."""
        later = copy(self)
        later.__dict__["found"] = tuple(found)
        return later

    def supposing(self, **changes: Any) -> "ObservedSituation":
        """Return the situation as it is if the state was another one."""
        return replace(self, state=replace(self.state, **changes))

    @property
    def carries(self) -> bool:
        """Return whether the command was to move what is in hand: a push or a turn."""
        return self.state.in_hand is not None and isinstance(self.command, Push | Turn)

    @property
    def held(self) -> HeldObject:
        """Return the object in hand; raise KeyError when there is none."""
        return self.state.held_objects[self.state.in_hand or ""]

    @cached_property
    def motion(self) -> Motion:
        """Return the commanded motion, map frame: that of what is in hand, or of Utak alone; cached."""
        if self.carries:
            return self._motion_from(self.state.frame, self.state.place)
        if isinstance(self.command, Move) and self.state.in_hand is None:
            return Translate(*self.state.frame.to_map(self.command.east, self.command.north))
        return Translate(0.0, 0.0)

    @property
    def walked(self) -> bool:
        """Return whether Utak was to move alone."""
        return not self.carries and any(self.motion)

    @property
    def shift(self) -> Position:
        """Return by how much the motion shifts Utak: (x, y) in squares, map frame."""
        return (self.motion.dx, self.motion.dy) if isinstance(self.motion, Translate) else (0.0, 0.0)

    @property
    def ahead(self) -> Position:
        """Return where the motion leads Utak: (x, y) in squares, map frame."""
        return add(self.state.place, self.shift)

    @property
    def any_turned(self) -> bool:
        """Return whether any object was ever turned, or is to be turned now: then it tells where the origin lies."""
        now = self.carries and isinstance(self.motion, Rotate) and self.motion.degrees != 0.0
        return now or any(held.turned % 360 for held in self.state.held_objects.values())

    @property
    def commanded_place(self) -> Position:
        """Return where the command leads: (east, north) in squares, Utak's own frame."""
        east, north = self.state.frame.place_to_utak(*self.state.place)
        if isinstance(self.command, Move if self.state.in_hand is None else Push):
            return east + self.command.east, north + self.command.north
        return east, north

    @property
    def contact_ends(self) -> list[CarryOutcome]:
        """Return the outcomes of the contacts that may have stopped what is in hand, the likeliest first."""
        return contact_outcomes(self.contacts, self.state.place, self.held.polygon, self.motion)

    @cached_property
    def contacts(self) -> list[ContactHypothesis]:
        """Return the contacts that may have stopped what is in hand, in the order of the way; cached."""
        return self.obstructions.contacts(self.state.place, self.held.polygon, self.motion)

    # -- frames, before any object was moved -----------------------------------------------------

    @cached_property
    def observation(self) -> Observation:
        """Return the observation where it was made if nothing stopped the motion; cached."""
        state = self.state
        near = [(residual_at(self, place), n, place) for n, place in enumerate(state.places_near(self.ahead))]
        return Observation(self.ranges, state.frame.place_to_utak(*min(near)[2]))

    @property
    def observations(self) -> list[Observation]:
        """Return all observations, oldest first, with the new one."""
        return [*self.state.observations, self.observation]

    @cached_property
    def left(self) -> tuple[Hypothesis, ...]:
        """Return the frame hypotheses that the last observations leave, with their prior costs; cached."""
        recent = self.observations[-MAX_CHECKED_OBSERVATIONS - 1 :]
        return weigh_hypotheses(prune_hypotheses(self.state.frames, recent), recent)

    @cached_property
    def another(self) -> Explanation | None:
        """Return the explanation by the best frame that all observations leave; None when they leave none; cached."""
        return another_frame(self.state, self.left, self.observations)

    @property
    def stands(self) -> bool:
        """Return whether the last observations leave the believed frame."""
        return any(hypothesis.contains(self.state.frame) for hypothesis in self.left)

    @cached_property
    def other_ends(self) -> Callable[[StraightMotion], tuple[Explanation, ...]]:
        """Return a function that returns other ends of a walk, in any frame it may have been made in; cached itself."""
        begun = lru_cache(MAX_KEPT_REPLAYS)(lambda frame: ReplayPrefixes(frame, self.observations, {}))
        return cache(lambda motion: tuple(reestimate_walk(motion, self.state.frame, self.observations, begun)))

    # -- frames, once objects were moved ---------------------------------------------------------

    @cached_property
    def judging_observations(self) -> list[Observation]:
        """Return the observations by which frames are judged, oldest first: the last earlier ones and the new one."""
        newest = Observation(self.ranges, self.commanded_place)
        return [*self.state.observations[-MAX_JUDGING_OBSERVATIONS:], newest]

    @cached_property
    def unsettled_discs(self) -> list[UnsettledDisc]:
        """Return the parts of the table where any object lay at any time, or is to lie now, sorted."""
        discs, state = set(), self.state
        for held in state.held_objects.values():
            lying = [held.polygon, held.first]
            if self.carries and held.name == state.in_hand:
                lying.append(self.motion.carry(held.polygon))
            middles = [state.frame.place_to_utak(lain.centroid.x, lain.centroid.y) for lain in lying]
            middles += [
                pose.middle
                for observation in state.observations
                for pose in observation.moved
                if pose.name == held.name
            ]
            corners = shapely.get_coordinates(held.polygon) - shapely.get_coordinates(held.polygon.centroid)
            reach = float(np.hypot(*corners.T).max()) + UNSETTLED_MARGIN
            discs |= {UnsettledDisc(middle, reach) for middle in middles}
        return sorted(discs)

    @cached_property
    def prefixes(self) -> ReplayPrefixes:
        """Return the replays of the first observations (mapped one after the other) in the believed frame; cached."""
        return ReplayPrefixes(self.state.frame, self.state.observations, self.state.held_objects)

    def by_frame(
        self,
        frame: Frame,
        hypotheses: tuple[Hypothesis, ...],
        cut_short: bool = False,
        origin_error: float = 0.0,
    ) -> Explanation | None:
        """Return the explanation by another frame, with the likeliest outcome; None where something contradicts it."""
        if self.remapped(frame).residual:
            return None
        if not self.carries:  # it went as commanded
            place = frame.place_from_utak(*self.commanded_place)
            turned = Explanation("turned", place, frame, 0, 0.0, None, hypotheses)
            return self._fitting(turned, self.remapped(frame).held_objects.values(), origin_error)
        for outcome in self._outcomes(frame, cut_short):
            slack = END_SPACING / 2 if cut_short and outcome.how != "predicted" else 0.0
            found = self.by_outcome(frame, hypotheses, outcome, slack, origin_error)
            if found is not None:
                return found
        return None

    def by_outcome(
        self,
        frame: Frame,
        hypotheses: tuple[Hypothesis, ...],
        outcome: CarryOutcome,
        slack: float = 0.0,
        origin_error: float = 0.0,
    ) -> Explanation | None:
        """Return the explanation by a frame that earlier observations agree with, and an outcome; None likewise."""
        name, held_objects = self.held.name, self.remapped(frame).held_objects
        slack, commanded = max(held_objects[name].slack, slack), outcome.as_commanded
        moved = held_objects[name].moved(outcome.polygon, slack, outcome.degrees, commanded)
        turned = Explanation("turned", outcome.place, frame, 0, outcome.distance, outcome, hypotheses)
        return self._fitting(turned, {**held_objects, name: moved}.values(), origin_error)

    def _fitting(
        self, turned: Explanation, held_objects: Iterable[HeldObject], origin_error: float
    ) -> Explanation | None:
        """Return an explanation by another frame; None where it contradicts the observation."""
        lying = [held.woken(origin_error) if origin_error else held for held in held_objects]
        occupancy = self.remapped(turned.frame).occupancy
        clashes = count_clashes(turned.frame, occupancy, lying, turned.place, self.ranges, only_whether=True)
        return None if clashes else turned

    def motion_in(self, frame: Frame) -> tuple[Position, Any, Motion]:
        """Return Utak's place and the outline of the object before the motion, and the motion, all in a frame."""
        place = frame.place_from_utak(*self.state.frame.place_to_utak(*self.state.place))
        polygon = self.remapped(frame).held_objects[self.held.name].polygon
        return place, polygon, self._motion_from(frame, place)

    def _motion_from(self, frame: Frame, place: Position) -> Motion:
        """Return the commanded motion of what is in hand as one of the map frame of `frame`, in squares or degrees."""
        if isinstance(self.command, Turn):
            return Rotate(self.command.degrees, place)
        assert isinstance(self.command, Push)
        return Translate(*frame.to_map(self.command.east, self.command.north))

    def remapped(self, frame: Frame) -> RemappedMap:
        """Return the map of all earlier observations in a frame, with the held objects; kept for each frame."""
        return self._maps.remapped(frame)

    @cached_property
    def _maps(self) -> RemapCache:
        """Return the cache of the maps, with the held objects, of all frames that were asked for; cached itself."""
        state = self.state
        return RemapCache(state.frame, state.occupancy, state.observations, state.held_objects)

    def _outcomes(self, frame: Frame, cut_short: bool) -> Iterator[CarryOutcome]:
        """Yield the outcomes of the motion of the object in hand that are to be evaluated in a frame."""
        place, polygon, motion = self.motion_in(frame)
        if cut_short:
            yield from (outcome for outcome in other_outcomes(place, polygon, motion) if outcome.stopped)
            return
        occupancy = self.remapped(frame).occupancy
        same = occupancy is self.state.occupancy
        obstructions = self.obstructions if same else Obstructions(occupancy, place, polygon, motion)
        blocked = blocked_by_known(place, polygon, motion, obstructions.known)
        if blocked is not None:
            yield blocked
        yield predicted_outcome(place, polygon, motion)

    @cached_property
    def obstructions(self) -> Obstructions:
        """Return the obstacles, occupied squares and open ones, about the motion of the object in hand; cached."""
        return Obstructions(self.state.occupancy, *self.motion_in(self.state.frame), self.state.completions)

    # -- after it ---------------------------------------------------------------------------------

    def objects_after(self, outcome: CarryOutcome | None) -> list[HeldObject]:
        """Return all held objects after an outcome of the motion of the one in hand, believed frame."""
        in_hand = None if outcome is None else self.state.in_hand
        return [
            held.moved(outcome.polygon, held.slack, commanded=outcome.as_commanded)
            if outcome is not None and name == in_hand
            else held
            for name, held in self.state.held_objects.items()
        ]

    def map_after(self, held_objects: Sequence[HeldObject], place: Position) -> OccupancyMap:
        """Return a copy of the believed map with the new observation integrated as if it was made at `place`."""
        x, y = (math.floor(v) for v in place)
        samples, counts = subtract_held_objects(self.state.frame.samples(), self.ranges, x, y, held_objects)
        occupancy = self.state.occupancy.copy()
        occupancy.observe(samples, counts, x, y, len(self.state.observations))
        return occupancy


def is_simple(state: TrackerState, explanation: Explanation) -> bool:
    """Return whether an explanation is simple."""
    # No residual, no first slip, and the believed orientation of the frame.
    likely = explanation.how != "slipped" or state.slipped
    return likely and not explanation.unexplained and explanation.frame.angle == state.frame.angle


def with_chance(state: TrackerState, explanation: Explanation) -> Explanation:
    """Return a re-estimation of an earlier motion with its chance by the observation after that motion, if known."""
    # None when that end was no known alternative.
    correction = explanation.correction
    assert correction is not None
    kept = state.kept_end(correction.since, correction.shift)
    known = kept is not None and kept.contains(explanation.frame)
    return explanation._replace(chance=math.exp(-kept.prior_cost)) if kept and known else explanation


def residual_at(situation: ObservedSituation, place: Position, outcome: CarryOutcome | None = None) -> int:
    """Return how many fields contradict the believed map if the observation was made at `place`, after an outcome."""
    state, held_objects = situation.state, situation.objects_after(outcome)
    return count_clashes(state.frame, state.occupancy, held_objects, place, situation.ranges)


def explained_by(situation: ObservedSituation, outcome: CarryOutcome) -> Explanation:
    """Return the explanation that the motion of the object in hand had an outcome, in the believed frame."""
    views = observed_from(outcome)
    residual, seen = min(
        ((residual_at(situation, view.place, view), view) for view in views), key=lambda found: found[0]
    )
    return Explanation(seen.how, seen.place, situation.state.frame, residual, seen.distance, seen)


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
