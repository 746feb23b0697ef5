"""Proposals that an earlier motion ended elsewhere than believed, once objects have been moved (smoothing).

Everything seen since then, and every object first held since then, lies elsewhere, too. The newest motion is evaluated
again with the correction, for what blocked the one may have blocked the other, seen where it really is.
"""

import math
from collections.abc import Iterable, Iterator, Set

from utak.geometry.motion.first_contact import ContactBody, Obstacles
from utak.geometry.motion.se2 import Translate
from utak.kb.localisation.hypotheses.contacts import SAME_CONTACT_FRACTION, Obstructions, square_polygon
from utak.kb.localisation.hypotheses.correction import WalkCorrection
from utak.kb.localisation.hypotheses.explanation import Explanation, likeliest_first
from utak.kb.localisation.hypotheses.frames import KEPT_ODDS, Hypothesis, Position, observation_squares
from utak.kb.localisation.hypotheses.recognition import places_within
from utak.kb.localisation.hypotheses.reestimation import WalkEnd, WalkInFrame, remap_if_consistent
from utak.kb.localisation.hypotheses.remap import object_at, remap
from utak.kb.localisation.hypotheses.walk_outcomes import (
    LINE_DISTANCE,
    StraightMotion,
    add,
    observation_places,
    slipped_ends,
)
from utak.kb.localisation.known.situation import ObservedSituation, is_simple, residual_at, with_chance
from utak.kb.localisation.known.state import TrackerState
from utak.kb.mapping.occupancy import FREE, OCCUPIED, OPEN, OccupancyMap
from utak.kb.mapping.patch import patch_of_polygon
from utak.kb.objects.held_object import HeldObject, Square, is_grid_aligned


def propose(situation: ObservedSituation) -> list[Explanation]:
    """Return the explanations by which an earlier motion ended elsewhere than believed."""
    state = situation.state
    if not state.held_objects:
        return _earlier_walks(situation) if situation.walked else []
    simple = [one for one in situation.found if is_simple(state, one) and one.frame == state.frame]
    return [] if any(one.chance is not None for one in simple) else reestimate_motions(situation, bool(simple))


def reestimate_motions(situation: ObservedSituation, kept: bool) -> list[Explanation]:
    """Return other ends of earlier motions with which nothing is contradicted, believed frame: all, or those kept."""
    state, doubtful = situation.state, {end.since for end in situation.state.ends}
    motions = (motion for motion in _known_motions(situation) if not kept or motion.number in doubtful)
    found = (with_chance(state, one) for motion in motions for one in _other_ends(situation, motion, kept))
    return sorted(found, key=lambda one: not one.contact_known)


def ends_left(situation: ObservedSituation, chosen: Explanation) -> list[Hypothesis]:
    """Return the other ends of earlier motions that the newest observation leaves beside the chosen explanation."""
    state, told = situation.state, chosen.correction and chosen.correction.since
    ends = [end for end in state.ends if end.since != told]
    if not ends or chosen.how != "predicted" or state.shaken:  # what contradicts another end may be a slip
        return ends
    found = (one.correction for one in reestimate_motions(situation, kept=True))
    agree = [state.kept_end(other.since, other.shift) for other in found if other is not None]
    return [end for end in ends if end in agree]


def propose_slips(situation: ObservedSituation) -> list[Explanation]:
    """Return where earlier motions may have slipped to, so that no observation is contradicted, the newest first."""
    return [one for motion in _known_motions(situation) for one in _slips(situation, motion)]


def _earlier_walks(situation: ObservedSituation) -> list[Explanation]:
    """Return explanations by which the newest walk, or an earlier one, was blocked where nothing was known."""
    state, frames = situation.state, [one for one in situation.found if one.remaps and not one.unexplained]
    turned = any(one.prior_cost <= KEPT_ODDS for one in frames)
    simple = any(not one.unexplained for one in situation.found if one.how != "slipped" or state.slipped)
    if not turned:
        return _blocked_elsewhere(situation, state.earlier if simple else state.reestimable)
    found = _blocked_elsewhere(situation, state.reestimable)
    odd = not state.off_middle and all(one.is_odd for one in frames)
    return [one for one in found if (one.contact_known or one.chance) and (odd or one.frame == state.frame)]


def _blocked_elsewhere(situation: ObservedSituation, motions: Iterable[StraightMotion]) -> list[Explanation]:
    """Return explanations, of kind misled, by which one of some walks was blocked elsewhere than believed."""
    state = situation.state
    judged = len(state.observations) if any(one.is_end for one in situation.found) else None
    found = likeliest_first([one for motion in motions for one in situation.other_ends(motion)])
    others = [(one, one.correction) for one in found if one.correction is not None]
    return [with_chance(state, one) for one, other in others if other.since != judged or one.frame != state.frame]


class CarriedMotion:
    """An earlier straight motion with an object in hand, in the believed frame."""

    def __init__(self, motion: StraightMotion, situation: ObservedSituation) -> None:
        """Find the ends of a motion with an object in hand."""
        assert motion.in_hand is not None
        state = situation.state
        frame, observations = state.frame, state.observations[: motion.number]
        pose = next(pose for pose in observations[-1].moved if pose.name == motion.in_hand)
        place, way = frame.place_from_utak(*observations[-1].place), Translate(*frame.to_map(*motion.shift))
        self._way = place, object_at(state.held_objects[motion.in_hand], pose, frame).polygon, way
        first = situation.prefixes.first(motion.number)
        before = remap(frame, frame, observations, state.held_objects.values(), first)
        contacts = Obstructions(before.occupancy, *self._way).contacts(*self._way)
        likely = (contact.fraction for contact in sorted(contacts, key=lambda contact: -contact.chance))
        places = {part: add(place, way.part(part)) for part in (*likely, 1.0)}
        halts = [(part, view) for part, there in places.items() for view in observation_places(there)]
        self.ends = tuple(WalkEnd(frame.place_to_utak(*view), part) for part, view in halts)

    def state_ahead(self, end: WalkEnd, occupancy: OccupancyMap, things: Set[Square]) -> int:
        """Return the state of what blocked the motion at `end`."""
        # OCCUPIED for something known, OPEN or FREE (1, -1, 0).
        # FREE if something known would have blocked it before, or if nothing can be met there;
        (place, polygon, way), obstructions = self._way, Obstructions(occupancy, *self._way)
        body = ContactBody(polygon, [place])
        known = obstructions.known.first_contact(body, way)
        if things:
            stood = Obstacles([square_polygon(square) for square in things])
            known = min(known, stood.first_contact(body, way))
        if known < end.progress - SAME_CONTACT_FRACTION:
            return FREE
        if known < 1.0 and known < end.progress + SAME_CONTACT_FRACTION:
            return OCCUPIED
        contacts = obstructions.contacts(*self._way)
        met = (abs(contact.fraction - end.progress) < SAME_CONTACT_FRACTION for contact in contacts)
        return OPEN if end.progress == 1.0 or any(met) else FREE


def _known_motions(situation: ObservedSituation) -> Iterator[StraightMotion]:
    """Yield the earlier motions before which the pose of the object in hand is known, the newest first."""
    for motion in reversed(situation.state.earlier):
        before = situation.state.observations[motion.number - 1].moved
        if motion.in_hand is None or any(pose.name == motion.in_hand for pose in before):
            yield motion


def _other_ends(situation: ObservedSituation, motion: StraightMotion, kept: bool) -> Iterator[Explanation]:
    """Yield other ends of one motion in the believed frame, with which nothing contradicts the newest observation."""
    state, believed = situation.state, situation.state.observations[motion.number].place
    if situation.prefixes.first(motion.number).contradicted:  # whatever came of the motion
        return
    alone = motion.in_hand is None
    way = WalkInFrame(motion, state.frame, state.observations) if alone else CarriedMotion(motion, situation)
    others = [end for end in way.ends if math.dist(end.place, believed) >= LINE_DISTANCE]
    if kept:
        others = [end for end in others if state.kept_end(motion.number, end.shift_from(believed))]
    for end, supposed, correction in _consistent(situation, motion, others):
        ahead = way.state_ahead(end, supposed.state.occupancy, _moved_since(supposed.state, motion))
        if ahead == FREE:
            continue
        newest = supposed.by_frame(state.frame, state.frames)
        if newest is not None:
            yield _earlier("misled", newest, correction, ahead == OCCUPIED)


def _slips(situation: ObservedSituation, motion: StraightMotion) -> Iterator[Explanation]:
    """Yield ends whole squares beside the commanded end of one motion, with which no observation is contradicted."""
    frame = situation.state.frame
    if situation.prefixes.first(motion.number).contradicted:  # whatever came of the motion
        return
    end = add(situation.state.observations[motion.number - 1].place, motion.shift)
    there = (WalkEnd(frame.place_to_utak(*place), 1) for place in slipped_ends(frame.place_from_utak(*end)))
    for _, supposed, correction in _consistent(situation, motion, there):
        newest = _newest_after_slip(supposed)
        if newest is not None:
            yield _earlier("slipped", newest, correction, contact_known=False)


def _consistent(
    situation: ObservedSituation, motion: StraightMotion, ends: Iterable[WalkEnd]
) -> Iterator[tuple[WalkEnd, ObservedSituation, WalkCorrection]]:
    """Yield the ends of an earlier motion with which no earlier observation is contradicted, and the situation then."""
    frame, first = situation.state.frame, situation.prefixes.first(motion.number)
    for end in ends:
        corrected, correction = _corrected(situation, motion, end)
        there, held_objects = corrected.state.observations, corrected.state.held_objects.values()
        under = remap_if_consistent(frame, there, held_objects, corrected.unsettled_discs, begun=first)
        if under is not None and not under.residual:
            yield end, corrected.supposing(occupancy=under.occupancy, held_objects=under.held_objects), correction


def _newest_after_slip(supposed: ObservedSituation) -> Explanation | None:
    """Return where the newest observation was made after a slip, the likeliest place; None where none fits."""
    state, frame = supposed.state, supposed.state.frame
    if supposed.carries:
        return supposed.by_frame(frame, state.frames)
    # Where in its square the robot was after the slip is not known.
    near = places_within(frame.place_from_utak(*supposed.commanded_place), (-0.5, -0.5, 0.5, 0.5))
    place = next((place for place in near if not residual_at(supposed, place)), None)
    return None if place is None else Explanation("slipped", place, frame, 0, 0.0, None, state.frames)


def _earlier(how: str, newest: Explanation, correction: WalkCorrection, contact_known: bool) -> Explanation:
    """Return the explanation that an earlier motion ended otherwise, and the newest observation was made so then."""
    distance = math.hypot(*correction.shift)
    return newest._replace(how=how, distance=distance, correction=correction, contact_known=contact_known)


def _corrected(
    situation: ObservedSituation, motion: StraightMotion, end: WalkEnd
) -> tuple[ObservedSituation, WalkCorrection]:
    """Return the situation as it is if an earlier motion ended at `end`, and the correction of everything since."""
    # The correction is a shift (east, north) in squares, Utak's own frame, of all observations since the motion.
    state = situation.state
    frame, believed = state.frame, state.observations[motion.number].place
    shift = end.shift_from(believed)
    since = [held for held in state.held_objects.values() if held.since > motion.number]
    seen = tuple((held.name, _object_shift(held, shift, state)) for held in since)
    correction = WalkCorrection(motion.number, shift, seen, motion.in_hand)
    there = tuple(correction.observations(state.observations))
    place = frame.place_from_utak(*correction.place(frame.place_to_utak(*state.place)))
    held_objects = correction.held_objects(state.held_objects, frame)
    return situation.supposing(place=place, observations=there, held_objects=held_objects), correction


def _object_shift(held: HeldObject, shift: Position, state: TrackerState) -> Position:
    """Return the shift of an object when the observation that showed it was made `shift` away."""
    # An object with sides on grid lines is shifted by whole squares, for the retina tells squares, wherever in a square
    # the observation is made.
    if not is_grid_aligned(held.first):
        return shift
    frame, observation = state.frame, state.observations[held.since - 1]
    elsewhere = observation._replace(place=add(observation.place, shift))
    (west, south), (east, north) = observation_squares(frame, [observation, elsewhere])
    return frame.to_utak(float(east - west), float(north - south))


def _moved_since(state: TrackerState, motion: StraightMotion) -> frozenset[Square]:
    """Return the squares that objects covered when a motion was made, without the object in hand."""
    before = {pose.name: pose for pose in state.observations[motion.number - 1].moved}
    squares: frozenset[Square] = frozenset()
    for held in state.held_objects.values():
        if held.name != motion.in_hand:
            lying = object_at(held, before[held.name], state.frame).polygon if held.name in before else held.first
            squares |= patch_of_polygon(lying).squares()
    return squares
