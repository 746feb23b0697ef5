"""Scoring of explanations of an observation: what contradicts each, what else is proposed, and which one is chosen.

Expensive proposals are made only when cheap ones leave something unexplained. kb/asp/accommodation.lp chooses.
"""

import math
from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple, TypeVar

from utak.kb.localisation.hypotheses.carry_outcomes import CarryOutcome
from utak.kb.localisation.hypotheses.explanation import Explanation, cheapest
from utak.kb.localisation.hypotheses.frames import FieldRanges, FrameHypothesis, Position
from utak.kb.localisation.hypotheses.map_prior import UNTRIED_COST
from utak.kb.localisation.hypotheses.what_if import Surprise, count_clashes
from utak.kb.localisation.propose import blocked
from utak.kb.localisation.propose.earlier_motion import (
    ReestimatedMotion,
    reestimate_motions,
    reestimate_slips,
    reestimate_with_origin,
)
from utak.kb.localisation.propose.frame import best_frame, blocked_pushes_with_origin
from utak.kb.localisation.propose.lifted import weighed_with_lifting
from utak.kb.localisation.propose.others import propose_changes
from utak.kb.localisation.state import TrackerState
from utak.kb.objects.held_object import HeldObject

MAX_FRAME_SEARCHES = 6  # searches over all frames before slips are blamed for residuals; tuned on random worlds
MAX_FAILED_SEARCHES = 18  # searches that explained nothing, after which no slow proposal is made; tuned likewise
MIN_UNEXPLAINED = 2  # fields of noise that cost more than an act of others: derived from kb/asp/accommodation.lp
Found = TypeVar("Found")


class SearchBudget:
    """The searches over all frames that are spent, counted while one observation is explained."""

    def __init__(self, spent: int) -> None:
        """Begin with the searches spent so far. spent : a count, as of `TrackerState.search_count`."""
        self.spent = spent

    @property
    def frames_left(self) -> bool:
        """Return whether all frames may be searched once more: fewer than MAX_FRAME_SEARCHES (6) searches are spent."""
        return self.spent < MAX_FRAME_SEARCHES

    @property
    def exhausted(self) -> bool:
        """Return whether no slow proposal may be made any more: MAX_FAILED_SEARCHES (18) searches are spent."""
        return self.spent >= MAX_FAILED_SEARCHES

    def search(self, propose: Callable[[], list[Found]]) -> list[Found]:
        """Return what a slow proposal finds; [] without calling it when the budget is exhausted."""
        if self.exhausted:
            return []
        found = propose()
        self.spent += not found
        return found


class LookedFrom(NamedTuple):
    """The places from which an observation may come, once others moved things."""

    surprise: Surprise  # what is in hand lies where a motion took it, if there was one
    places: Sequence[Position]  # the likeliest first, map frame
    outcome: CarryOutcome | None = None  # of that motion

    def changes(self) -> list[Explanation]:
        """Return explanations by which others moved things, what is in hand if it was not moved just then."""
        found, in_hand = propose_changes(self.surprise, self.places), self.surprise.carried and self.surprise.in_hand
        changed = [(one, one.change.gone) for one in found if one.change is not None]
        taken = in_hand is not None and self.outcome is None
        return [one._replace(outcome=self.outcome) for one, gone in changed if (in_hand in gone) == taken]


class Judgement(NamedTuple):
    """The explanation chosen for an observation, and what was learnt while choosing it."""

    explanation: Explanation  # the chosen one
    searches: int  # the number of slow searches spent so far, over the whole life of the tracker
    # Where the newest motion may have ended (its whole way included), each with its chance, as far as the observation
    # agrees; empty when the motion can have met nothing
    blocked: tuple[Explanation, ...] = ()
    # The frame hypotheses that are left, if they were weighed anew; None when they stay as they are
    hypotheses: tuple[FrameHypothesis, ...] | None = None


def residual_at(state: TrackerState, ranges: FieldRanges, place: Position, held_objects: Iterable[HeldObject]) -> int:
    """Return how many fields of an observation at `place` contradict the map and the held objects where they lie."""
    return count_clashes(state.frame, state.occupancy, held_objects, place, ranges)


def consistent_ends(
    surprise: Surprise, ended: Iterable[tuple[blocked.BlockedMotion, Explanation]]
) -> tuple[Explanation, ...]:
    """Return those possible ends of the newest motion that its observation agrees with, each with its chance."""
    fitting = (
        one._replace(chance=end.chance, contact_squares=end.contact_squares) for end, one in ended if not one.residual
    )
    return tuple(blocked.consistent_explanations(surprise, fitting))


def propose_frame(
    state: TrackerState, surprise: Surprise, residual: int, budget: SearchBudget, simple: bool = False
) -> list[Explanation]:
    """Return the frame that explains a surprise with fewer than `residual` unexplained fields, if there is one."""
    if budget.exhausted:
        return []
    found = best_frame(surprise, budget.frames_left, simple)
    if found is None or found.residual >= residual:
        budget.spent += 1
        return []
    budget.spent += found.searched
    outcome = found.outcome
    pushed = outcome is not None and outcome.stopped and surprise.degrees == 0.0
    if simple and pushed and found.frame == state.frame:  # finer proposals of where it was blocked exist already
        return []
    if found.frame != state.frame or set(found.hypotheses) != set(state.hypotheses):
        distance = 0.0 if outcome is None else outcome.distance
        turned = Explanation("turned", found.place, found.frame, found.residual, distance, outcome, found.hypotheses)
        return [turned._replace(prior_cost=prior_cost(state, found.frame.angle))]
    if outcome is None or outcome.how == "predicted":  # proposed already
        return []
    return [Explanation(outcome.how, outcome.place, state.frame, found.residual, outcome.distance, outcome)]


def propose_blocked_push_and_origin(surprise: Surprise, budget: SearchBudget) -> list[Explanation]:
    """Return explanations by which a push was blocked and the origin of the frame lies elsewhere in its square."""
    found = []
    for one, chance, against in budget.search(lambda: blocked_pushes_with_origin(surprise)):
        distance = 0.0 if one.outcome is None else one.outcome.distance
        turned = Explanation("turned", one.place, one.frame, 0, distance, one.outcome, one.hypotheses)
        found.append(turned._replace(chance=chance, prior_cost=against, origin_weighed=True))
    return found


def propose_earlier_motions(
    state: TrackerState,
    surprise: Surprise,
    others: Iterable[Explanation],
    budget: SearchBudget,
    reestimate: Callable[..., list[ReestimatedMotion]] = reestimate_motions,
) -> list[Explanation]:
    """Return explanations by which an earlier motion ended elsewhere than believed."""
    simple = [other for other in others if is_simple(state, other)]
    here = [other for other in simple if other.frame == state.frame]
    if here:
        known = any(other.chance is not None for other in here)
        likely = [] if known else [_earlier_motion(state, one) for one in reestimate(surprise, state.doubtful)]
        return [one for one in likely if one.chance is not None]
    found = reestimate(surprise, state.earlier)
    if not found and not simple:
        found = budget.search(lambda: reestimate_with_origin(surprise, state.earlier))
    return [_earlier_motion(state, one) for one in found]


def is_simple(state: TrackerState, explanation: Explanation) -> bool:
    """Return whether an explanation is simple."""
    # No residual, no first slip, and the believed orientation of the frame.
    likely = explanation.how != "slipped" or state.slipped
    return likely and not explanation.unexplained and explanation.frame.angle == state.frame.angle


def _earlier_motion(state: TrackerState, motion: ReestimatedMotion) -> Explanation:
    """Return the explanation, of kind misled, that an earlier motion ended as it was re-estimated; without residual."""
    walk, one = motion
    distance = math.hypot(*walk.correction.shift)
    misled = Explanation("misled", one.place, one.frame, 0, distance, one.outcome, one.hypotheses, walk)
    return with_chance(state, misled)


def with_chance(state: TrackerState, explanation: Explanation) -> Explanation:
    """Return a re-estimation of an earlier motion with its chance by the observation after that motion, if known."""
    # None when that end was no known alternative.
    assert explanation.reestimated is not None
    correction = explanation.reestimated.correction
    motion = next((motion for motion in state.motions if motion.number == correction.since), None)
    if motion is None or motion.number >= len(state.observations) or explanation.frame != state.frame:
        return explanation
    return explanation._replace(chance=motion.chance_of_end(correction.place(state.observations[motion.number].place)))


def prior_cost(state: TrackerState, angle: int) -> float:
    """Return by how much the map prior of an orientation is worse than the best one, in log odds."""
    if angle == state.frame.angle:
        return 0.0
    return min((one.prior_cost for one in state.hypotheses if one.angle == angle), default=UNTRIED_COST)


def choose(state: TrackerState, explanations: list[Explanation], facts: Iterable[str] = ()) -> Explanation:
    """Return the cheapest explanation by kb/asp/accommodation.lp; of those that cost the same the first."""
    known = [f"trust({0 if state.off_middle else state.confirmations})", *["slips"] * state.slips]
    known += ["off_middle"] * state.off_middle
    known += [f"met({n})" for n, e in enumerate(explanations) if e.met_known and e.frame == state.frame]
    known += ["proven"] * (state.in_hand is not None and state.held_objects[state.in_hand].proven)
    return cheapest(explanations, [*known, *facts])


def with_others(
    state: TrackerState, surprise: Surprise, chosen: Explanation, looked_from: Sequence[LookedFrom]
) -> Explanation:
    """Return the choice between an explanation and what others may have done, if it explains badly."""
    if not (chosen.unexplained >= MIN_UNEXPLAINED or _slipped_far(chosen)):
        return chosen
    slipped = [_earlier_slip(state, one) for one in reestimate_slips(surprise, state.earlier)]
    chosen = choose(state, [chosen, *slipped])
    # Whose motions slip cannot tell its own slips from what others do.
    if state.slips or chosen in slipped:
        return chosen
    changes = [one for entry in looked_from for one in entry.changes()]
    if state.held_objects:  # what the robot moved itself may lie a little otherwise; what is gone does not
        changes = [one for one in changes if one.change is not None and one.change.gone and not one.residual]
    # Who was put elsewhere sees nothing as expected: no less than what shows by itself that localisation has failed.
    may_be_lifted = chosen.unexplained >= state.max_residual or (_slipped_far(chosen) and not state.held_objects)
    return choose(state, weighed_with_lifting(surprise, [chosen, *changes], may_be_lifted))


def _earlier_slip(state: TrackerState, motion: ReestimatedMotion) -> Explanation:
    """Return the explanation that an earlier motion slipped, and the newest one went as commanded."""
    walk, one = motion
    distance = math.hypot(*walk.correction.shift)
    return Explanation("slipped", one.place, one.frame, 0, distance, one.outcome, state.hypotheses, walk)


def _slipped_far(explanation: Explanation) -> bool:
    """Return whether an explanation is a slip of more than a square."""
    return explanation.how == "slipped" and explanation.distance > 1
