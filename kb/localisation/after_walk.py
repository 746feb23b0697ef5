"""Explanations of an observation after a walk, or on waking: where the walk ended, and how the frame lies."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache

from utak.geometry.motion.se2 import Translate
from utak.kb.body import Command, Move
from utak.kb.localisation.hypotheses.explanation import Explanation, reestimated_explanations
from utak.kb.localisation.hypotheses.frames import (
    MAX_CHECKED_OBSERVATIONS,
    PLAUSIBLE_COST,
    FieldRanges,
    FrameHypothesis,
    Observation,
    Position,
    any_origin,
    consistent_hypotheses,
    frames_to_try,
    is_cramped,
    prune_hypotheses,
)
from utak.kb.localisation.hypotheses.map_prior import weigh_hypotheses
from utak.kb.localisation.hypotheses.reestimation import ReestimatedWalk, reestimate_two_walks, reestimate_walk
from utak.kb.localisation.hypotheses.remap import ReplayPrefixes, remap
from utak.kb.localisation.hypotheses.walk_outcomes import entered_square, observation_places, slipped_ends
from utak.kb.localisation.propose.blocked import has_whole_way, possible_ends
from utak.kb.localisation.propose.origin import blocked_walks_with_origin
from utak.kb.localisation.score import (
    Judgement,
    LookedFrom,
    SearchBudget,
    choose,
    consistent_ends,
    is_simple,
    prior_cost,
    propose_earlier_motions,
    propose_frame,
    residual_at,
    with_chance,
    with_others,
)
from utak.kb.localisation.state import TrackerState
from utak.kb.mapping.occupancy import FREE
from utak.kb.perception.frame import Frame

MAX_REPLAYED_OBSERVATIONS = 120  # observations replayed to try frames, for one choice: bounds its time; tuned
MIN_TRIED_FRAMES = 6  # frames that are tried at least, however many observations there are; tuned
MAX_KEPT_REPLAYS = 16  # frames whose replayed first observations are kept for other motions: bounds memory; tuned
NO_FRAME_RESIDUAL = 10**6  # residual fields when no frame is left: more than any frame can have
SETTLED_SPREAD = math.radians(5)  # orientations that differ by less hardly cause contradictions; tuned


@dataclass(frozen=True)
class DeadReckoning:
    """The end of a walk by dead reckoning."""

    predicted: Position  # where the walk ends if nothing blocked it, (x, y) in squares, map frame
    # Where it may have been blocked: both sides of each grid line on the way, the one nearest to the end first, and
    # last the start; empty when there was no walk. Map frame.
    blocked: tuple[Position, ...]


def explain_walk(state: TrackerState, ranges: FieldRanges, ends: DeadReckoning, command: Command | None) -> Judgement:
    """Return the explanation chosen for an observation after a walk, or after another motion of an empty hand."""
    judged = _WalkExplainer(state, ranges, ends, command).judge()
    if command is None:
        return judged
    places = [*observation_places(ends.predicted), *ends.blocked]
    surprise = state.surprise(command, ranges)
    return judged._replace(explanation=with_others(state, surprise, judged.explanation, [LookedFrom(surprise, places)]))


class _WalkExplainer:
    """The proposals for one observation, in the order in which they are made; each is made only when it is needed."""

    def __init__(self, state: TrackerState, ranges: FieldRanges, ends: DeadReckoning, command: Command | None) -> None:
        """Compute the explanation that the walk went its whole way, and where it may have been blocked."""
        self._state, self._ranges, self._blocked_places, self._command = state, ranges, ends.blocked, command
        self._ahead = ends.predicted
        self._budget = SearchBudget(state.search_count)
        ahead = [self._explanation("predicted", place, ends.predicted) for place in state.places_near(ends.predicted)]
        self._whole = min(ahead, key=lambda one: one.residual)
        self._predicted = self._whole.place
        self._observation = Observation(ranges, state.frame.place_to_utak(*self._predicted))
        self._observations = [*state.observations, self._observation]
        self._possible_ends = self._blocked_walk(command) if ends.blocked and isinstance(command, Move) else ()
        if self._possible_ends and not has_whole_way(self._possible_ends) and not self._whole.unexplained:
            self._whole = self._whole._replace(contradicted=True)
        begun = lru_cache(MAX_KEPT_REPLAYS)(lambda frame: ReplayPrefixes(frame, self._observations, {}))
        self._reestimations = cache(
            lambda motion: tuple(reestimate_walk(motion, state.frame, self._observations, begun))
        )

    def judge(self) -> Judgement:
        """Return the chosen explanation, with what was learnt while choosing; the state is not changed."""
        state, first = self._state, self._whole
        if not state.held_objects:
            stopped = [motion for motion in state.earlier if motion.blocked]
            if first.unexplained and any(not one.residual for motion in stopped for one in self._reestimations(motion)):
                turned = self._blocked_elsewhere(map(self._reestimations, stopped))
            else:
                recent = [*state.observations[-MAX_CHECKED_OBSERVATIONS:], self._observation]
                left = weigh_hypotheses(prune_hypotheses(state.hypotheses, recent), recent)
                if not first.unexplained and any(hypothesis.contains(state.frame) for hypothesis in left):
                    return self._judgement(self._best_prior(self._possible_ends or [first], left), left)
                turned = self._other_frame(left, recent)
        elif first.unexplained and self._command is not None:
            surprise = state.surprise(self._command, self._ranges)
            turned = propose_frame(state, surprise, first.unexplained, self._budget)
        elif self._possible_ends:
            return self._judgement(choose(state, list(self._possible_ends)))
        else:
            turned = []
        if not first.unexplained and not turned:
            return self._judgement(first)
        if not first.unexplained:  # no settled square contradicts it, but two observations contradict each other
            first = first._replace(contradicted=True)
        return self._judgement(choose(state, self._all(first, turned)))

    def _judgement(self, chosen: Explanation, left: tuple[FrameHypothesis, ...] | None = None) -> Judgement:
        """Return a chosen explanation with what was learnt while choosing it."""
        return Judgement(chosen, self._budget.spent, self._possible_ends, left)

    def _all(self, first: Explanation, turned: list[Explanation]) -> list[Explanation]:
        """Return all explanations: the walk as predicted, then blocked, slipped, other frames, earlier motions."""
        state = self._state
        explanations = [first]
        explanations += [one for one in self._possible_ends if one.how != "predicted"]
        explanations += [] if self._possible_ends else map(self._blocked, self._blocked_places)
        explanations += [
            self._explanation("slipped", place, self._predicted) for place in slipped_ends(self._predicted)
        ]
        explanations += turned
        if state.held_objects and self._command is not None:
            surprise = state.surprise(self._command, self._ranges)
            explanations += propose_earlier_motions(state, surprise, explanations, self._budget)
        elif self._blocked_places:
            explanations += self._earlier_walks(turned, explanations)
            if not any(is_simple(state, one) for one in explanations):
                explanations += self._budget.search(
                    lambda: blocked_walks_with_origin(state.reestimable, state.frame, self._observations)
                )
        return explanations

    def _blocked_walk(self, command: Move) -> tuple[Explanation, ...]:
        """Return where the walk may have ended, its whole way included, as far as the observation agrees."""
        # Empty when the walk can hardly have met anything, or when the observation agrees with none.
        surprise = self._state.surprise(command, self._ranges)
        motion = Translate(*self._state.frame.to_map(command.east, command.north))
        found = possible_ends(surprise, None, motion)
        ended = [(end, self._explanation(end.how, end.place, found[0].place)) for end in found]
        return consistent_ends(surprise, ended)

    def _earlier_walks(self, turned: list[Explanation], others: list[Explanation]) -> list[Explanation]:
        """Return explanations by which the newest walk, or an earlier one, was blocked where nothing was known."""
        state = self._state
        if all(e.unexplained for e in turned):
            simple = any(not e.unexplained for e in others if e.how != "slipped" or state.slipped)
            return self._blocked_elsewhere(map(self._reestimations, state.earlier if simple else state.reestimable))
        met = [
            e for e in self._blocked_elsewhere(map(self._reestimations, state.reestimable)) if e.met_known or e.chance
        ]
        if state.off_middle or not all(e.is_odd for e in turned):
            met = [e for e in met if e.frame == state.frame]
        return met or self._both_blocked()

    def _blocked_elsewhere(self, walks: Iterable[Iterable[ReestimatedWalk]]) -> list[Explanation]:
        """Return explanations, of kind misled, by which one of some walks was blocked elsewhere than believed."""
        state = self._state
        judged = len(state.observations) if self._possible_ends else None
        found = ((e, e.reestimated) for e in reestimated_explanations(walks) if e.reestimated is not None)
        return [
            with_chance(state, e._replace(prior_cost=one.hypothesis.prior_cost))
            for e, one in found
            if one.correction.since != judged or e.frame != state.frame
        ]

    def _both_blocked(self) -> list[Explanation]:
        """Return explanations by which both the newest walk and an earlier one were blocked, in the believed frame."""
        state, newest, found = self._state, self._state.motions[-1], []
        believed = [hypothesis for hypothesis in newest.hypotheses if hypothesis.frame == state.frame][:1]
        pairs = [(motion, hypothesis) for hypothesis in believed for motion in reversed(state.earlier)]
        for walk in (one for motion, h in pairs for one in reestimate_two_walks(motion, newest, h, self._observations)):
            distance = math.hypot(*walk.correction.shift) + math.dist(walk.newest, self._observation.place)
            place = state.frame.place_from_utak(*walk.newest)
            found.append(Explanation("misled", place, state.frame, 0, distance, None, state.hypotheses, walk))
        return found

    def _best_prior(self, ended: Sequence[Explanation], left: tuple[FrameHypothesis, ...]) -> Explanation:
        """Return the choice between the believed frame, uncontradicted, and that of the best map prior."""
        state = self._state
        cost = next(h.prior_cost for h in left if h.contains(state.frame))
        explanations = [one._replace(prior_cost=one.prior_cost + cost) for one in ended]
        if cost > 0:
            best = frames_to_try(left, state.frame)[0]
            place = best.place_from_utak(*self._observation.place)
            explanations.append(Explanation("turned", place, best, 0, 0.0, None, left))
        return choose(state, explanations, ["stands"])

    def _other_frame(self, left: tuple[FrameHypothesis, ...], recent: list[Observation]) -> list[Explanation]:
        """Return the explanation by another frame, where observations contradict the believed one, in a list."""
        state, observation = self._state, self._observation
        if state.likely_spread <= SETTLED_SPREAD:  # another origin is likelier than another orientation
            beside = consistent_hypotheses(recent, any_origin((state.frame.angle,)))
            left = weigh_hypotheses((*beside, *(h for h in left if h.angle != state.frame.angle)), recent)
        frame, residual = self._best_frame(left)
        if (residual or prior_cost(state, frame.angle) > PLAUSIBLE_COST) and self._budget.frames_left:
            self._budget.spent += 1
            found = tuple(
                one._replace(prior_cost=prior_cost(state, one.angle)) for one in consistent_hypotheses(recent)
            )
            another, fewer = self._best_frame(found)
            if (fewer, prior_cost(state, another.angle)) < (residual, prior_cost(state, frame.angle)):
                left, frame, residual = found, another, fewer
        place = frame.place_from_utak(*observation.place)
        cost, cramped = prior_cost(state, frame.angle), is_cramped(left, len(state.observations))
        turned = Explanation("turned", place, frame, residual, 0.0, None, left, prior_cost=cost, cramped=cramped)
        return [turned] * bool(left)

    def _best_frame(self, left: tuple[FrameHypothesis, ...]) -> tuple[Frame, int]:
        """Return the frame of the least residual among those left, and that residual (a count of fields)."""
        state = self._state
        if not left:
            return state.frame, NO_FRAME_RESIDUAL
        tried: list[tuple[int, int]] = []
        most = max(MIN_TRIED_FRAMES, MAX_REPLAYED_OBSERVATIONS // (len(state.observations) + 1))
        frames = frames_to_try(left, state.frame)[:most]
        for number, frame in enumerate(frames):
            tried.append((remap(frame, state.frame, self._observations, ()).residual, number))
            if tried[-1][0] == 0:
                break
        residual, number = min(tried)
        return frames[number], residual

    def _blocked(self, place: Position) -> Explanation:
        """Return the explanation that the walk was blocked at `place`, contradicted where floor is settled ahead."""
        occupancy, entered = self._state.occupancy, entered_square(place, self._ahead)
        barred = entered is not None and occupancy.state[occupancy.index(*entered)] != FREE
        return self._explanation("blocked", place, self._predicted)._replace(contradicted=not barred)

    def _explanation(self, how: str, place: Position, predicted: Position) -> Explanation:
        """Return the explanation that the observation was made at `place`, in the believed frame."""
        residual = residual_at(self._state, self._ranges, place, self._state.held_objects.values())
        return Explanation(how, place, self._state.frame, residual, math.dist(place, predicted))
