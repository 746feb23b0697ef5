"""The localisation tracker: it explains every new observation, and is the only writer of pose, frame and map.

The pose is predicted from the command. When the observation cannot have been made there, explanations are proposed
(the motion was blocked or slipped, the frame lies otherwise, an earlier motion ended elsewhere), scored, and one is
chosen by kb/asp/accommodation.lp. The chosen explanation is applied, and the observation is integrated into the
occupancy map. Each of its 160 fields counts as predicted, as explained (it shows squares that were open), or as noise.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace

from utak.kb.body import Command, Impression, Move, Push, Release, Turn
from utak.kb.localisation.field_account import Accommodation, account_for_fields
from utak.kb.localisation.held_object_state import agreeing_origins, moved_object, objects_astray, turned_astray
from utak.kb.localisation.hypotheses.contacts import suspected_squares
from utak.kb.localisation.hypotheses.correction import WalkCorrection
from utak.kb.localisation.hypotheses.explanation import Explanation, TableChange
from utak.kb.localisation.hypotheses.frames import (
    ALL_HYPOTHESES,
    KEPT_ODDS,
    FieldRanges,
    Hypothesis,
    Observation,
    OriginBox,
    Position,
    exact_hypothesis,
    observation_squares,
)
from utak.kb.localisation.hypotheses.recognition import half_cell, narrowed, place_of, recognise, told_by_contact
from utak.kb.localisation.hypotheses.remap import RemapCache, RemappedMap, object_pose, remap
from utak.kb.localisation.hypotheses.walk_outcomes import (
    StraightMotion,
    add,
    entered_square,
    observation_places,
    snap_to_middle,
)
from utak.kb.localisation.known.situation import ObservedSituation, count_clashes, residual_at
from utak.kb.localisation.known.state import TrackerState
from utak.kb.localisation.proposals import explain
from utak.kb.localisation.propose.earlier_motion import ends_left
from utak.kb.localisation.propose.lifted import MIN_KNOWN_LOOKS, look_at
from utak.kb.localisation.propose.others import forgetting
from utak.kb.localisation.propose.smaller_object import refined_extent
from utak.kb.mapping.completions import Completions
from utak.kb.mapping.occupancy import FREE, OCCUPIED, OccupancyMap
from utak.kb.mapping.patch import Patch, patch_of_polygon, patch_of_squares
from utak.kb.objects.held_object import COMMAND_ROUNDING, HeldObject, Square, held_or_moved, subtract_held_objects
from utak.kb.perception.retina import count_ranges

MAX_MOTIONS = 12  # last straight motions that are kept for re-estimation: bounds its time; tuned on random worlds
MAX_KEPT_ENDS = 5  # other ends kept side by side: bounds the time of a look; the most were 1 in 57 worlds of campaign
RESIDUAL_WINDOW = 4  # last observations by whose residuals a localisation failure is recognised; tuned likewise


@dataclass
class Tracker:
    """The one owner of the localisation state."""

    # What is believed after the newest observation. It is replaced, never changed, but for its occupancy map, which the
    # tracker updates in place.
    state: TrackerState = field(default_factory=TrackerState)

    # -- what others call ------------------------------------------------------------------------

    def anew(self, lost: bool = False) -> "Tracker":
        """Return a tracker that begins anew at the believed place, with an empty map and all frame hypotheses."""
        # The believed frame and place stay, and the track is kept, so that the robot knows about where it came from;
        # the newest observation is left out of it, for it is made again. Who is lost may recognise the map of before.
        former = self.state.former or (_before_contradictions(self.state) if lost else None)
        return _begun(self.state, self.state.observations[:-1], former, unsteady=True)

    def elsewhere(self) -> "Tracker":
        """Return a tracker of a robot that others put somewhere: it begins anew, and keeps what was believed before."""
        # The newest observation fits nowhere, and was not integrated.
        state = self.state
        return _begun(state, state.observations, state.former or state, unsteady=state.slips)

    def recognise(self, command: Command) -> Accommodation | None:
        """Look for the newest observations on the map of before; go on with that if they fit at one place of it."""
        state, former = self.state, self.state.former
        if former is None:
            return None
        first, newest = state.observations[0].place, state.observations[-1]
        away = former.frame.to_map(newest.place[0] - first[0], newest.place[1] - first[1])
        earlier = () if state.slips else state.looks  # whose motions slip does not know how its looks lie to each other
        self.state = state = replace(
            state, looks=(*earlier, look_at(ObservedSituation(former, command, newest.ranges), away))
        )
        is_known = len(former.observations) >= MIN_KNOWN_LOOKS and not state.held_objects
        found = recognise(former.occupancy, state.looks) if is_known else None
        if found is None or (state.slips and len(set(map(_square_of, found.points))) > 1):  # later looks would not tell
            return None
        looked = state.observations[-len(state.looks) :]  # since a map begun anew when lost, the newest alone
        ways = [(look.away[0] - away[0], look.away[1] - away[1]) for look in state.looks]
        unsteady = former.unsteady or state.unsteady
        self.state = replace(former, unsteady=unsteady, removed=state.removed, may_hold=state.may_hold)

        def clashes(point: Position) -> int:
            """Return how many fields of all looks contradict the map if the newest was made at a point."""
            return sum(
                residual_at(ObservedSituation(former, command, one.ranges), add(point, way))
                for one, way in zip(looked, ways, strict=True)
            )

        squares = {point: tuple(map(_square_of, (add(point, way) for way in ways))) for point in found.points}
        against = {one: clashes(point) for point, one in reversed(squares.items())}
        least = min(against.values())
        fitting = [point for point in found.points if against[squares[point]] == least]
        chosen = [point for point in fitting if squares[point] == squares[fitting[0]]]
        place, error = place_of(chosen, fitting, half_cell(state.looks))
        self._put_elsewhere((0.0, 0.0, 0.0, 0.0) if state.slips else error)
        for way, observation in zip(ways, looked, strict=True):
            there = add(place, way)
            residual = residual_at(ObservedSituation(self.state, command, observation.ranges), there)
            recognised = Explanation("slipped" if state.slips else "lifted", there, former.frame, residual, 1.0)
            accommodated = self._integrate(recognised, observation.ranges)
        return accommodated

    def _put_elsewhere(self, error: OriginBox) -> None:
        """Believe in `state` that others put the robot elsewhere: what it held is let go of."""
        state = self.state
        self.state = replace(
            state,
            in_hand=None,
            motions=(),
            hypotheses=tuple(h for h in state.frames if h.contains(state.frame)) or state.frames,
            place_error=error,
            lifted_at=state.lifted_at | {len(state.observations)},
        )

    def wake(self, impression: Impression) -> Accommodation:
        """Explain and integrate the first impression; `state` is replaced."""
        return self._accommodate(ObservedSituation(self.state, None, count_ranges(impression.retina)))

    def accommodate(self, command: Command, impression: Impression) -> Accommodation:
        """Explain and integrate the impression that followed a command; `state` is replaced."""
        ranges = count_ranges(impression.retina)
        if isinstance(command, Release):
            self.state = replace(self.state, in_hand=None, may_hold=False)
        self._prepare(ObservedSituation(self.state, command, ranges))
        return self._accommodate(ObservedSituation(self.state, command, ranges))

    def grasp(self, held: HeldObject) -> None:
        """Believe that an object is in the hand; `state` is replaced."""
        held_objects = self.state.held_objects
        if held.name not in held_objects:
            touching, number = self.state.is_beside_things(held), len(self.state.observations)
            self._declare(held.possible, FREE)
            held_objects = {**held_objects, held.name: replace(held, since=number, touching=touching)}
        self.state = replace(self.state, held_objects=held_objects, in_hand=held.name)

    def update_object(self, held: HeldObject) -> None:
        """Replace what is known of an object that was held before; `state` is replaced."""
        self.state = replace(self.state, held_objects={**self.state.held_objects, held.name: held})

    def withdraw(self, name: str) -> None:
        """Forget an object that was in hand and never moved; `state` is replaced."""
        state = self.state
        left = [held for held in state.held_objects.values() if held.name != name]
        self.state = _remapped(state, remap(state.frame, state.frame, state.observations, left))

    def keep_things(self, things: Mapping[str, frozenset[Square]]) -> None:
        """Keep the squares of the things seen in `state`: what others may have moved is proposed by them."""
        self.state = replace(self.state, things=things)

    def keep_completions(self, completions: Completions | None) -> None:
        """Keep the newest completions of the map in `state`; the chance of a contact is estimated by them."""
        self.state = replace(self.state, completions=completions)

    # -- an observation ---------------------------------------------------------------------------

    def _prepare(self, situation: ObservedSituation) -> None:
        """Remember a straight motion in `state`, and how far a turn may lead what is in hand astray."""
        state, command = situation.state, situation.command
        held = situation.held if situation.carries else None
        if held is not None and isinstance(command, Turn) and (state.beside_line or state.place_doubt):
            held = replace(held, astray=max(held.astray, COMMAND_ROUNDING, turned_astray(state, command.degrees)))
            self.update_object(held)
        if held is not None and held.touching:  # the other thing may reach into squares that it leaves
            lay, there = held.seen_on or held.lying(held.first).possible, situation.motion.carry(held.polygon)
            state.occupancy.uncover(lay, held.lying(there).possible, held.since - 1)
        if isinstance(command, Push | Move) and (held is not None or situation.walked):
            way, name = (command.east, command.north), None if held is None else held.name
            motion = StraightMotion(len(state.observations), way, state.frames, in_hand=name)
            self.state = replace(self.state, motions=(*state.motions[1 - MAX_MOTIONS :], motion))

    def _accommodate(self, situation: ObservedSituation) -> Accommodation:
        """Explain and integrate an observation."""
        chosen, ends = explain(situation)
        if chosen.how == "lost":
            return self._unexplained(chosen, situation.ranges)
        self._learn(situation, chosen, ends)
        self._apply(chosen)
        if not situation.carries:
            chosen = self._end_walk(situation, chosen)
        elif self.state.in_hand == situation.held.name:
            self._move_object(situation, chosen)
        return self._integrate(chosen, situation.ranges)

    def _end_walk(self, situation: ObservedSituation, chosen: Explanation) -> Explanation:
        """Note in `state` how a walk ended by the chosen explanation, and return where the look was made."""
        ahead = situation.ahead
        chosen = self._narrow(situation, chosen)
        number = self.state.confirmations
        number = number + 1 if chosen.how == "predicted" else number * (chosen.chance is not None)
        self.state = replace(self.state, confirmations=number)
        if chosen.how == "slipped":
            self.state = replace(self.state, slipped=True, motions=())
        if chosen.how == "blocked" or chosen.place == self.state.place != ahead:
            entered = entered_square(chosen.place, ahead)
            squares = chosen.contact_squares or frozenset([entered] if entered else [])
            self.state = replace(self.state, blocked_squares=self.state.blocked_squares | squares)
        return chosen

    def _narrow(self, situation: ObservedSituation, explanation: Explanation) -> Explanation:
        """Narrow in `state` where the robot may be since it was lifted, by a look; return where the look was made."""
        state = self.state
        if not any(state.place_error) or explanation.how in ("lifted", "misled", "turned"):
            return explanation
        centre = situation.ahead if explanation.how in ("predicted", "changed") else explanation.place
        near, held, frame = state.places_near(centre), state.held_objects.values(), state.frame
        clashes = [count_clashes(frame, state.occupancy, held, place, situation.ranges) for place in near]
        fitting = [place for place, many in zip(near, clashes, strict=True) if many == min(clashes)]
        place, error = narrowed(centre, state.place_error, fitting)
        if explanation.how == "blocked":
            place, error = told_by_contact(explanation.place, place, error)
        self.state = replace(state, place_error=error)
        self._shift_since_lift((place[0] - centre[0], place[1] - centre[1]))
        return explanation._replace(place=place)

    def _shift_since_lift(self, shift: Position) -> None:
        """Believe in `state` that all looks since the robot was put somewhere were made elsewhere, by a shift."""
        state = self.state
        if not any(shift):
            return
        since = WalkCorrection(max(state.lifted_at), state.frame.to_utak(*shift))
        observations = tuple(since.observations(state.observations))
        before, now = (observation_squares(state.frame, these) for these in (state.observations, observations))
        self.state = state = replace(state, observations=observations)
        if (before != now).any():
            held_objects = state.held_objects.values()
            self.state = _remapped(state, remap(state.frame, state.frame, observations, held_objects))

    def _unexplained(self, explanation: Explanation, ranges: FieldRanges) -> Accommodation:
        """Return the account of an observation that is not integrated, since the robot does not know where it is."""
        x, y = math.floor(explanation.place[0]), math.floor(explanation.place[1])
        samples, occupancy = self.state.frame.samples(), self.state.occupancy
        left, counts = subtract_held_objects(samples, ranges, x, y, self.state.held_objects.values())
        return Accommodation(explanation, account_for_fields(occupancy, left, ranges, counts, (x, y)))

    def _move_object(self, situation: ObservedSituation, chosen: Explanation) -> None:
        """Move the held object in `state` as the chosen explanation says, and refine what is known of its outline."""
        name, ranges = situation.held.name, situation.ranges
        if chosen.instead is not None:
            self._declare(patch_of_polygon(chosen.instead.first), FREE)
            self.update_object(chosen.instead)
        if chosen.left:
            self._declare(patch_of_squares(chosen.left), OCCUPIED)
        self.state = state = replace(self.state, slipped=self.state.slipped or chosen.how == "slipped")
        now = replace(situation, state=state)
        suspected = suspected_squares(chosen.outcome, now.motion, now.held, state.others(now.held), state.occupancy)
        self.update_object(moved_object(now, chosen, suspected))
        self.state = replace(self.state, suspected_squares=state.suspected_squares | suspected, place=chosen.place)
        if chosen.outcome is not None and chosen.outcome.as_commanded:
            refined = refined_extent(self.state, self.state.held_objects[name], ranges, self.state.place)
            if refined is not None:
                self.update_object(refined)
        self.state = replace(self.state, hypotheses=(*agreeing_origins(self.state, ranges), *self.state.ends))
        self.state = replace(self.state, held_objects=objects_astray(self.state))

    # -- the one place where an explanation is applied -------------------------------------------

    def _apply(self, chosen: Explanation) -> None:
        """Believe in `state` what an explanation says of the frame and of earlier motions."""
        if chosen.change is not None:
            self._forget_changed(chosen.change)
            return
        if chosen.how == "lifted":
            self._put_elsewhere(chosen.place_error)
            return
        state, held_objects = self.state, self.state.held_objects
        if chosen.remaps:
            state = replace(state, confirmations=0)
            held_objects = held_or_moved(held_objects, state.in_hand)
        if chosen.correction is not None:
            correction = chosen.correction
            own = state.frame.place_to_utak(*state.place)
            observations = tuple(correction.observations(state.observations))
            held_objects = correction.held_objects(held_objects, state.frame)
            place = state.frame.place_from_utak(*correction.place(own))
            state = replace(state, place=place, observations=observations)
        elif chosen.frame == state.frame:
            self.state = state
            return
        as_before = chosen.correction is None and len(held_objects) == len(state.held_objects)
        maps = RemapCache(state.frame, state.occupancy, state.observations, held_objects)
        under = maps.remapped(chosen.frame) if as_before else None
        if under is None or under.residual:
            under = remap(chosen.frame, state.frame, state.observations, held_objects.values())
        self.state = _remapped(replace(state, frame=chosen.frame), under)

    def _forget_changed(self, change: TableChange) -> None:
        """Forget in `state` what earlier observations say of squares that others changed, and the things that left."""
        state, change_number = self.state, len(self.state.observations)
        gone = [held for held in state.held_objects.values() if held.name in change.gone]
        observations = forgetting(state.frame, state.observations, change, gone)
        held_objects = {name: held for name, held in state.held_objects.items() if name not in change.gone}
        state.occupancy.withdraw_patch(patch_of_squares(change.squares))
        self.state = replace(
            state,
            observations=observations,
            held_objects=held_objects,
            in_hand=None if state.in_hand in change.gone else state.in_hand,
            motions=tuple(motion for motion in state.motions if motion.number >= change_number),
            blocked_squares=state.blocked_squares - change.squares,
            suspected_squares=state.suspected_squares - change.squares,
            completions=None,
            changed_at={**state.changed_at, **dict.fromkeys(change.squares, change_number)},
            removed=state.removed + len(change.gone),
        )

    def _learn(self, situation: ObservedSituation, chosen: Explanation, ends: Iterable[Explanation]) -> None:
        """Keep in `state` which frames are left, and where else motions may have ended."""
        state, number = self.state, len(self.state.observations)
        beside = (one for one in ends if chosen.is_end and one.place != chosen.place)
        newest = (_other_end(one, chosen, number) for one in beside if one.odds <= chosen.odds + KEPT_ODDS)
        kept = sorted((*ends_left(situation, chosen), *newest), key=lambda end: end.prior_cost)[:MAX_KEPT_ENDS]
        self.state = replace(state, hypotheses=(*(chosen.hypotheses or state.frames), *kept))

    def _declare(self, patch: Patch, value: int) -> None:
        """Settle the squares of a patch, map frame, as FREE or OCCUPIED."""
        # They are credited to the newest observation.
        self.state.occupancy.declare_patch(patch, value, len(self.state.observations) - 1)

    def _integrate(self, explanation: Explanation, ranges: FieldRanges) -> Accommodation:
        """Integrate an explained observation into the map, without what the held objects show of themselves."""
        state, occupancy = self.state, self.state.occupancy
        samples, number = state.frame.samples(), len(state.observations)
        x, y = math.floor(explanation.place[0]), math.floor(explanation.place[1])
        held_objects = {name: held.seen(samples, ranges, x, y) for name, held in state.held_objects.items()}
        samples, counts = subtract_held_objects(samples, ranges, x, y, held_objects.values())
        fields = account_for_fields(occupancy, samples, ranges, counts, (x, y))
        moved = tuple(object_pose(held, state.frame) for held in held_objects.values())
        observation = Observation(ranges, state.frame.place_to_utak(*explanation.place), moved)
        occupancy.observe(samples, counts, x, y, number)
        occupancy.overruled += explanation.unexplained  # contradictions among open squares count as well
        if number == 0:
            occupancy.stand(x, y, 0)
        self.state = replace(
            state,
            held_objects=held_objects,
            observations=(*state.observations, observation),
            residuals=(*state.residuals[1 - RESIDUAL_WINDOW :], explanation.unexplained),
            sound_since=number + 1 if explanation.unexplained else state.sound_since,
            place=_standing_place(state, explanation.place),
        )
        return Accommodation(explanation, fields)


def _other_end(end: Explanation, chosen: Explanation, number: int) -> Hypothesis:
    """Return the hypothesis that the motion before an observation ended elsewhere than by the chosen explanation."""
    shift = end.frame.to_utak(end.place[0] - chosen.place[0], end.place[1] - chosen.place[1])
    return exact_hypothesis(end.frame)._replace(prior_cost=end.odds - chosen.odds, since=number, shift=shift)


def _begun(state: TrackerState, made: Iterable[Observation], former: TrackerState | None, unsteady: bool) -> Tracker:
    """Return a tracker with an empty map at the believed place; `made`: the observations whose places are kept."""
    been = (*state.been, *(observation.place for observation in made))
    begun = TrackerState(OccupancyMap(), state.frame, state.place, hypotheses=ALL_HYPOTHESES, been=been)
    may_hold = state.may_hold or state.in_hand is not None
    return Tracker(replace(begun, former=former, unsteady=unsteady, removed=state.removed, may_hold=may_hold))


def _before_contradictions(state: TrackerState) -> TrackerState | None:
    """Return a state without the last looks that contradict it, and the things moved since; None for too few looks."""
    sound = next((n for n, residual in enumerate(state.residuals) if residual), len(state.residuals))
    observations = state.observations[: len(state.observations) - len(state.residuals) + sound]
    if len(observations) < MIN_KNOWN_LOOKS:
        return None
    under = remap(state.frame, state.frame, observations, state.held_objects.values())
    lay = {pose.name: pose.middle for pose in observations[-1].moved}
    now = {name: object_pose(held, state.frame).middle for name, held in state.held_objects.items()}
    still = {name: under.held_objects[name] for name, place in now.items() if lay.get(name) == place}
    there = _remapped(state, under._replace(held_objects=still))
    return replace(there, observations=observations, motions=(), residuals=(), in_hand=None)


def _remapped(state: TrackerState, under: RemappedMap) -> TrackerState:
    """Return a state with another map and the objects on it; what belonged to the squares of the old map is dropped."""
    if under.occupancy is not state.occupancy:
        state = replace(state, blocked_squares=frozenset(), suspected_squares=frozenset(), completions=None)
    return replace(state, occupancy=under.occupancy, held_objects=dict(under.held_objects))


def _square_of(place: Position) -> Square:
    return math.floor(place[0]), math.floor(place[1])


def _standing_place(state: TrackerState, place: Position) -> Position:
    """Return the place to believe, (x, y) in squares, map frame: on the side of a grid line where nothing stands."""
    sides, occupancy = [place, *observation_places(place)], state.occupancy
    squares = [(math.floor(x), math.floor(y)) for x, y in sides]
    free = (occupancy.state[occupancy.index(*s)] != OCCUPIED and s not in state.blocked_squares for s in squares)
    return snap_to_middle(next((side for side, can_stand in zip(sides, free, strict=True) if can_stand), place))
