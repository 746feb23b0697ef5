"""Proposals that an earlier motion ended elsewhere than believed, once objects have been moved (smoothing).

Everything seen since then, and every object first held since then, lies elsewhere, too. The newest motion is evaluated
again with the correction, for what blocked the one may have blocked the other, seen where it really is.
"""

import itertools
import math
from collections.abc import Iterator, Sequence, Set
from dataclasses import replace
from typing import NamedTuple

from utak.geometry.motion.first_contact import ContactBody, Obstacles
from utak.geometry.motion.se2 import Translate
from utak.kb.localisation.hypotheses.contacts import SAME_CONTACT_FRACTION, Obstructions, square_polygon
from utak.kb.localisation.hypotheses.frames import (
    Observation,
    Position,
    any_origin,
    consistent_hypotheses,
    exact_hypothesis,
    frames_to_try,
    observation_squares,
)
from utak.kb.localisation.hypotheses.recognition import places_within
from utak.kb.localisation.hypotheses.reestimation import (
    ReestimatedWalk,
    WalkCorrection,
    WalkEnd,
    WalkInFrame,
    remap_if_consistent,
)
from utak.kb.localisation.hypotheses.remap import MapReplay, RemappedMap, object_at, remap
from utak.kb.localisation.hypotheses.walk_outcomes import (
    LINE_DISTANCE,
    MotionHypothesis,
    add,
    observation_places,
    slipped_ends,
)
from utak.kb.localisation.hypotheses.what_if import Surprise, WhatIf, count_clashes
from utak.kb.mapping.occupancy import FREE, OCCUPIED, OPEN, OccupancyMap
from utak.kb.mapping.patch import patch_of_polygon
from utak.kb.objects.held_object import HeldObject, Square, is_grid_aligned
from utak.kb.perception.frame import Frame

MAX_MOTIONS_WITH_ORIGIN = 4  # last motions that are re-estimated together with the origin: bounds the time; tuned
MAX_FRAMES_PER_END = 3  # frames that are evaluated for each end of those: bounds the time; tuned


class ReestimatedMotion(NamedTuple):
    """A re-estimated earlier motion, and the evaluation of everything else with it."""

    walk: ReestimatedWalk  # the correction of the earlier motion
    what_if: WhatIf  # the evaluation of the newest observation with it


class CarriedMotion:
    """An earlier straight motion with an object in hand, in the believed frame."""

    def __init__(self, motion: MotionHypothesis, surprise: Surprise) -> None:
        """Find the ends of a motion with an object in hand."""
        assert motion.in_hand is not None
        frame, observations, held_objects = (
            surprise.frame,
            surprise.observations[: motion.number],
            surprise.held_objects,
        )
        pose = next(pose for pose in observations[-1].moved if pose.name == motion.in_hand)
        self._place = frame.place_from_utak(*observations[-1].place)
        self._polygon = object_at(held_objects[motion.in_hand], pose, frame).polygon
        self._motion = Translate(*frame.to_map(*motion.shift))
        before = remap(
            frame, frame, observations, held_objects.values(), surprise.prefixes.first(motion.number)
        ).occupancy
        contacts = self._obstructions(before).contacts(self._place, self._polygon, self._motion)
        likely = (contact.fraction for contact in sorted(contacts, key=lambda contact: -contact.chance))
        fractions = dict.fromkeys((*likely, 1.0))
        halts = [(part, view) for part in fractions for view in observation_places(self._place_after(part))]
        self.ends = tuple(WalkEnd(frame.place_to_utak(*view), part) for part, view in halts)

    def _place_after(self, fraction: float) -> Position:
        """Return Utak's place after a fraction (0 to 1) of the motion, (x, y) in squares, map frame."""
        return self._place[0] + fraction * self._motion.dx, self._place[1] + fraction * self._motion.dy

    def state_ahead(self, end: WalkEnd, occupancy: OccupancyMap, things: Set[Square]) -> int:
        """Return the state of what blocked the motion at `end`."""
        # OCCUPIED for something known, OPEN or FREE (1, -1, 0).
        # FREE if something known would have blocked it before, or if nothing can be met there;
        body, obstructions = ContactBody(self._polygon, [self._place]), self._obstructions(occupancy)
        known = obstructions.known.first_contact(body, self._motion)
        if things:
            stood = Obstacles([square_polygon(square) for square in things])
            known = min(known, stood.first_contact(body, self._motion))
        if known < end.progress - SAME_CONTACT_FRACTION:
            return FREE
        if known < 1.0 and known < end.progress + SAME_CONTACT_FRACTION:
            return OCCUPIED
        contacts = obstructions.contacts(self._place, self._polygon, self._motion)
        met = (abs(contact.fraction - end.progress) < SAME_CONTACT_FRACTION for contact in contacts)
        return OPEN if end.progress == 1.0 or any(met) else FREE

    def _obstructions(self, occupancy: OccupancyMap) -> Obstructions:
        """Return the obstacles about the motion in a map: occupied squares (`known`) and open ones, map frame."""
        return Obstructions(occupancy, self._place, self._polygon, self._motion)


def reestimate_motions(surprise: Surprise, motions: Sequence[MotionHypothesis]) -> list[ReestimatedMotion]:
    """Return all other ends of earlier motions with which no observation is contradicted, in the believed frame."""
    tried = [motion for motion in reversed(motions) if _has_known_pose(motion, surprise)]
    found = [one for motion in tried for one in _other_ends(surprise, motion)]
    return sorted(found, key=lambda one: not one.walk.contact_known)


def reestimate_slips(surprise: Surprise, motions: Sequence[MotionHypothesis]) -> list[ReestimatedMotion]:
    """Return where earlier motions may have slipped to, so that no observation is contradicted, the newest first."""
    tried = (motion for motion in reversed(motions) if _has_known_pose(motion, surprise))
    return [one for motion in tried for one in _slips(surprise, motion)]


def reestimate_with_origin(surprise: Surprise, motions: Sequence[MotionHypothesis]) -> list[ReestimatedMotion]:
    """Return other ends, with another frame origin, of the newest carrying motion that explains everything so."""
    # Neither is explained without the other: where an object was blocked depends on where it lay, which is known in
    # squares; where the observations since were made depends on the origin.
    tried = (motion for motion in reversed(motions) if motion.in_hand is not None and _has_known_pose(motion, surprise))
    found = ([*_ends_with_origin(surprise, motion)] for motion in itertools.islice(tried, MAX_MOTIONS_WITH_ORIGIN))
    return sorted(next(filter(None, found), []), key=lambda one: not one.walk.contact_known)


def _has_known_pose(motion: MotionHypothesis, surprise: Surprise) -> bool:
    """Return whether the pose of the object in hand before a motion is known; True for an empty hand."""
    before = surprise.observations[motion.number - 1].moved
    return motion.in_hand is None or any(pose.name == motion.in_hand for pose in before)


def _other_ends(surprise: Surprise, motion: MotionHypothesis) -> Iterator[ReestimatedMotion]:
    """Yield other ends of one motion in the believed frame, with which nothing contradicts the newest observation."""
    observations, frame = surprise.observations, surprise.frame
    believed, first = observations[motion.number].place, surprise.prefixes.first(motion.number)
    if first.contradicted:  # whatever came of the motion
        return
    way = WalkInFrame(motion, frame, observations) if motion.in_hand is None else CarriedMotion(motion, surprise)
    judged: dict[Position, RemappedMap | None] = {}  # by the shift
    for end in way.ends:
        shift = end.place[0] - believed[0], end.place[1] - believed[1]
        if math.hypot(*shift) < LINE_DISTANCE:  # as believed
            continue
        corrected, correction = _corrected(surprise, motion, end)
        if shift not in judged:
            judged[shift] = _consistent_map(corrected, first)
        under = judged[shift]
        if under is None:
            continue
        ahead = way.state_ahead(end, under.occupancy, _moved_since(under, corrected.observations, motion, frame))
        if ahead == FREE:
            continue
        supposed = replace(corrected, occupancy=under.occupancy, held_objects=under.held_objects)
        what_if = supposed.evaluate_frame(frame, surprise.hypotheses, only_whether=True)
        if not what_if.residual:
            walk = ReestimatedWalk(exact_hypothesis(frame), correction, ahead == OCCUPIED, 0)
            yield ReestimatedMotion(walk, what_if)


def _consistent_map(corrected: Surprise, begun: MapReplay) -> RemappedMap | None:
    """Return the map of all corrected observations, in the believed frame; None where one contradicts the others."""
    held_objects = corrected.held_objects.values()
    under = remap_if_consistent(
        corrected.frame, corrected.observations, held_objects, corrected.unsettled_discs, begun=begun
    )
    return None if under is None or under.residual else under


def _slips(surprise: Surprise, motion: MotionHypothesis) -> Iterator[ReestimatedMotion]:
    """Yield ends whole squares beside the commanded end of one motion, with which no observation is contradicted."""
    frame, first = surprise.frame, surprise.prefixes.first(motion.number)
    if first.contradicted:  # whatever came of the motion
        return
    end = add(surprise.observations[motion.number - 1].place, motion.shift)
    for place in slipped_ends(frame.place_from_utak(*end)):
        corrected, correction = _corrected(surprise, motion, WalkEnd(frame.place_to_utak(*place), 1))
        under = _consistent_map(corrected, first)
        if under is None:
            continue
        supposed = replace(corrected, occupancy=under.occupancy, held_objects=under.held_objects)
        for what_if in _newest_after_slip(supposed):
            if not what_if.residual:
                yield ReestimatedMotion(ReestimatedWalk(exact_hypothesis(frame), correction, False, 0), what_if)
                break


def _newest_after_slip(supposed: Surprise) -> Iterator[WhatIf]:
    """Yield what contradicts the newest observation after a slip, the likeliest place first."""
    frame, held_objects = supposed.frame, supposed.held_objects.values()
    if supposed.carried is not None:
        yield supposed.evaluate_frame(frame, supposed.hypotheses, only_whether=True)
        return
    # Where in its square the robot was after the slip is not known.
    for place in places_within(frame.place_from_utak(*supposed.commanded_place), (-0.5, -0.5, 0.5, 0.5)):
        clashes = count_clashes(frame, supposed.occupancy, held_objects, place, supposed.ranges)
        yield WhatIf(frame, supposed.hypotheses, place, None, clashes, searched=False)


def _ends_with_origin(surprise: Surprise, motion: MotionHypothesis) -> Iterator[ReestimatedMotion]:
    """Yield other ends of one motion of an object, each with another origin of the frame; nothing contradicts them."""
    origins = any_origin((surprise.frame.angle,))
    for end in CarriedMotion(motion, surprise).ends:
        corrected, correction = _corrected(surprise, motion, end)
        left = consistent_hypotheses(corrected.judging_observations, origins, corrected.unsettled_discs)
        if not left:
            continue
        first = surprise.prefixes.first(motion.number)
        under = remap(surprise.frame, surprise.frame, corrected.observations, corrected.held_objects.values(), first)
        corrected = replace(corrected, occupancy=under.occupancy, held_objects=under.held_objects)
        for frame in frames_to_try(left, surprise.frame)[:MAX_FRAMES_PER_END]:
            what_if = corrected.evaluate_frame(frame, left, only_whether=True)
            if what_if.residual:
                continue
            under = corrected.remapped(frame)
            there = replace(corrected, frame=frame, occupancy=under.occupancy, held_objects=under.held_objects)
            things = _moved_since(under, corrected.observations, motion, frame)
            ahead = CarriedMotion(motion, there).state_ahead(end, under.occupancy, things)
            if ahead != FREE:
                walk = ReestimatedWalk(exact_hypothesis(frame), correction, ahead == OCCUPIED, 0)
                yield ReestimatedMotion(walk, what_if)


def _corrected(surprise: Surprise, motion: MotionHypothesis, end: WalkEnd) -> tuple[Surprise, WalkCorrection]:
    """Return a surprise as it is if an earlier motion ended at `end`, and the correction of everything since."""
    # The correction is a shift (east, north) in squares, Utak's own frame, of all observations since the motion.
    frame, believed = surprise.frame, surprise.observations[motion.number].place
    shift = end.place[0] - believed[0], end.place[1] - believed[1]
    since = [held for held in surprise.held_objects.values() if held.since > motion.number]
    seen = tuple((held.name, _object_shift(held, shift, surprise)) for held in since)
    correction = WalkCorrection(motion.number, shift, seen, motion.in_hand)
    there, held_objects = (
        correction.observations(surprise.observations),
        correction.held_objects(surprise.held_objects, frame),
    )
    place = frame.place_from_utak(*correction.place(frame.place_to_utak(*surprise.place)))
    return replace(surprise, place=place, observations=there, held_objects=held_objects), correction


def _object_shift(held: HeldObject, shift: Position, surprise: Surprise) -> Position:
    """Return the shift of an object when the observation that showed it was made `shift` away."""
    # An object with sides on grid lines is shifted by whole squares, for the retina tells squares, wherever in a square
    # the observation is made.
    if not is_grid_aligned(held.first):
        return shift
    frame, observation = surprise.frame, surprise.observations[held.since - 1]
    elsewhere = observation._replace(place=add(observation.place, shift))
    (west, south), (east, north) = observation_squares(frame, [observation, elsewhere])
    return frame.to_utak(float(east - west), float(north - south))


def _moved_since(
    under: RemappedMap, observations: Sequence[Observation], motion: MotionHypothesis, frame: Frame
) -> frozenset[Square]:
    """Return the squares that objects covered when a motion was made, without the object in hand."""
    before = {pose.name: pose for pose in observations[motion.number - 1].moved}
    squares: frozenset[Square] = frozenset()
    for held in under.held_objects.values():
        if held.name != motion.in_hand:
            lying = object_at(held, before[held.name], frame).polygon if held.name in before else held.first
            squares |= patch_of_polygon(lying).squares()
    return squares
