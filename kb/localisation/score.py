"""Scoring of explanations of an observation: what contradicts each, what else is proposed, and which one is chosen.

Expensive proposals are made only when cheap ones leave something unexplained. kb/asp/accommodation.lp chooses.
"""

import math
from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple, TypeVar

from kb.localisation.hypotheses.explanation import Explanation, cheapest
from kb.localisation.hypotheses.frames import FieldRanges, FrameHypothesis, Position
from kb.localisation.hypotheses.map_prior import UNTRIED_COST
from kb.localisation.hypotheses.walk_outcomes import MotionHypothesis
from kb.localisation.hypotheses.what_if import Surprise, count_clashes
from kb.localisation.propose import blocked
from kb.localisation.propose.earlier_motion import (
    ReestimatedMotion,
    reestimate_motions,
    reestimate_with_origin,
)
from kb.localisation.propose.frame import best_frame, blocked_pushes_with_origin
from kb.localisation.state import TrackerState
from kb.objects.held_object import HeldObject

MAX_FRAME_SEARCHES = 6  # searches over all frames before slips are blamed for residuals; tuned on random worlds
MAX_FAILED_SEARCHES = 18  # searches that explained nothing, after which no slow proposal is made; tuned likewise
Found = TypeVar("Found")


class SearchBudget:
    """The searches over all frames that are spent, counted while one observation is explained.

    Attributes
    ----------
    spent : the number of slow searches that found nothing or went over all frames, over the whole life of the tracker.
    """

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
        """Return what a slow proposal finds; [] without calling it when the budget is exhausted.

        A proposal that finds nothing spends 1 search.

        propose : the slow proposal, called at most once; it returns what it found, [] for nothing. The list is returned
            as it is.
        """
        if self.exhausted:
            return []
        found = propose()
        self.spent += not found
        return found


class Judgement(NamedTuple):
    """The explanation chosen for an observation, and what was learnt while choosing it.

    Attributes
    ----------
    explanation : the chosen one.
    searches : the number of slow searches spent so far, over the whole life of the tracker.
    blocked : where the newest motion may have ended (its whole way included), each with its chance, as far as the
        observation agrees; empty when the motion can have met nothing.
    hypotheses : the frame hypotheses that are left, if they were weighed anew; None when they stay as they are.
    """

    explanation: Explanation
    searches: int
    blocked: tuple[Explanation, ...] = ()
    hypotheses: tuple[FrameHypothesis, ...] | None = None


def residual_at(state: TrackerState, ranges: FieldRanges, place: Position, held_objects: Iterable[HeldObject]) -> int:
    """Return how many fields of an observation at `place` contradict the map and the held objects where they lie.

    Fields of earlier observations that are no longer possible with it count as well; 0 means that nothing contradicts.

    Parameters
    ----------
    state : what is believed; its map and its frame are used.
    ranges : (160, 2) int16, least and greatest count of occupied squares under each field of the observation.
    place : where it was made, (x, y) in squares, map frame.
    held_objects : all objects that were ever held, where they lie then, map frame.
    """
    return count_clashes(state.frame, state.occupancy, held_objects, place, ranges)


def consistent_ends(
    surprise: Surprise, ended: Iterable[tuple[blocked.BlockedMotion, Explanation]]
) -> tuple[Explanation, ...]:
    """Return those possible ends of the newest motion that its observation agrees with, each with its chance.

    Parameters
    ----------
    surprise : the observation, with what was believed before it.
    ended : each possible end, with the explanation that the motion ended there.

    Returns
    -------
    tuple of Explanation
        Those without residual, in the order given, with `chance`, `contact_squares` and a `prior_cost` (log odds,
        relative to the best of them). Each keeps its place, (x, y) in squares, map frame. Empty when the observation
        agrees with none.
    """
    fitting = (
        one._replace(chance=end.chance, contact_squares=end.contact_squares) for end, one in ended if not one.residual
    )
    return tuple(blocked.consistent_explanations(surprise, fitting))


def propose_frame(
    state: TrackerState, surprise: Surprise, residual: int, budget: SearchBudget, simple: bool = False
) -> list[Explanation]:
    """Return the frame that explains a surprise with fewer than `residual` unexplained fields, if there is one.

    It comes as an explanation: the frame, the place of Utak (x, y) in squares, map frame of that frame, the outcome for
    an object in hand, and the number of fields left unexplained.

    Parameters
    ----------
    state : what was believed before the observation.
    surprise : the observation, after objects were moved.
    residual : the fields that the motion as commanded leaves unexplained: a count.
    budget : of slow searches; 1 is spent when nothing is found, or when all frames were searched.
    simple : whether a motion that ended early explains it in the believed frame.

    Returns
    -------
    list of Explanation
        One at most. Its kind is turned for another frame, or for other frame hypotheses; in the believed frame it is
        that of the outcome of the motion. [] when no frame is better, when the budget is exhausted, or when the same is
        proposed elsewhere.
    """
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
    """Return explanations by which a push was blocked and the origin of the frame lies elsewhere in its square.

    Each is of kind turned and without residual, with the probability of the contact as `chance`. Its `prior_cost` (log
    odds against that origin) is the less the larger the part of the square of waking is in which the origin may lie
    then. One for each square of Utak and each contact; its place is (x, y) in squares, map frame of its frame. [] when
    nothing fits, without a push, and when the budget of slow searches is exhausted.

    surprise : the observation after the push. budget : of slow searches; 1 is spent when nothing is found.
    """
    found = []
    for one, chance, against in budget.search(lambda: blocked_pushes_with_origin(surprise)):
        distance = 0.0 if one.outcome is None else one.outcome.distance
        turned = Explanation("turned", one.place, one.frame, 0, distance, one.outcome, one.hypotheses)
        found.append(turned._replace(chance=chance, prior_cost=against, origin_weighed=True))
    return found


class EarlierMotionProposers(NamedTuple):
    """The two proposers of earlier motions that ended elsewhere than believed.

    Both are called with the newest observation and with the motions to try, oldest first, and return a list, [] for
    nothing.

    Attributes
    ----------
    in_frame : proposes other ends in the believed frame.
    with_origin : proposes other ends together with another origin of the frame.
    """

    in_frame: Callable[[Surprise, Sequence[MotionHypothesis]], list[ReestimatedMotion]] = reestimate_motions
    with_origin: Callable[[Surprise, Sequence[MotionHypothesis]], list[ReestimatedMotion]] = reestimate_with_origin


EARLIER_MOTION_PROPOSERS = EarlierMotionProposers()  # the ones in use; tests pass others


def propose_earlier_motions(
    state: TrackerState,
    surprise: Surprise,
    others: Iterable[Explanation],
    budget: SearchBudget,
    proposers: EarlierMotionProposers = EARLIER_MOTION_PROPOSERS,
) -> list[Explanation]:
    """Return explanations by which an earlier motion ended elsewhere than believed.

    Where a simple explanation (see `is_simple`) in the believed frame exists, only motions that were in doubt are
    re-estimated (other ends of them are tried), and none if the chance of the simple explanation is known. Another
    origin of the frame is proposed as well only where nothing simple explains the observation in any frame.

    Parameters
    ----------
    state : what was believed before the observation.
    surprise : the observation, after objects were moved.
    others : all explanations so far.
    budget : of slow searches; the search with another origin is charged to it.
    proposers : the functions that are asked.

    Returns
    -------
    list of Explanation
        Of kind misled and without residual; [] when there is none. One for each other end of a motion, contacts with
        something known first, then the newest motion first. Its place is that of the newest observation, (x, y) in
        squares, map frame of its frame; its `distance` is how far the end is shifted, in squares.
    """
    simple = [other for other in others if is_simple(state, other)]
    here = [other for other in simple if other.frame == state.frame]
    if here:
        known = any(other.chance is not None for other in here)
        likely = [] if known else [_earlier_motion(state, one) for one in proposers.in_frame(surprise, state.doubtful)]
        return [one for one in likely if one.chance is not None]
    found = proposers.in_frame(surprise, state.earlier)
    if not found and not simple:
        found = budget.search(lambda: proposers.with_origin(surprise, state.earlier))
    return [_earlier_motion(state, one) for one in found]


def is_simple(state: TrackerState, explanation: Explanation) -> bool:
    """Return whether an explanation is simple: no residual, no first slip, and the believed orientation of the frame.

    A slip is an end of a motion beside its predicted end; once one happened, further ones count as simple.

    state : what was believed before the observation.
    """
    likely = explanation.how != "slipped" or state.slipped
    return likely and not explanation.unexplained and explanation.frame.angle == state.frame.angle


def _earlier_motion(state: TrackerState, motion: ReestimatedMotion) -> Explanation:
    """Return the explanation, of kind misled, that an earlier motion ended as it was re-estimated; without residual.

    Its place is where the newest observation was made then, (x, y) in squares, map frame of its frame; its `distance`
    is how far the end of the earlier motion is shifted, in squares.

    state : what was believed before the observation. motion : the correction of the earlier motion, with the evaluation
    of the newest observation by it.
    """
    walk, one = motion
    distance = math.hypot(*walk.correction.shift)
    misled = Explanation("misled", one.place, one.frame, 0, distance, one.outcome, one.hypotheses, walk)
    return with_chance(state, misled)


def with_chance(state: TrackerState, explanation: Explanation) -> Explanation:
    """Return a re-estimation of an earlier motion with its chance by the observation after that motion, if known.

    The result is the explanation with `chance` set: the probability, 0 to 1, of the end that it gives the earlier
    motion, by the observation that followed it; None when that end was no known alternative. It is returned unchanged
    when the motion is not remembered, when its observation is the newest one, or when the frame is another one.

    Parameters
    ----------
    state : what was believed; its remembered motions and their other ends are asked.
    explanation : one that re-estimates a motion (supposes another end of it): its `reestimated` is not None.
    """
    assert explanation.reestimated is not None
    correction = explanation.reestimated.correction
    motion = next((motion for motion in state.motions if motion.number == correction.since), None)
    if motion is None or motion.number >= len(state.observations) or explanation.frame != state.frame:
        return explanation
    return explanation._replace(chance=motion.chance_of_end(correction.place(state.observations[motion.number].place)))


def prior_cost(state: TrackerState, angle: int) -> float:
    """Return by how much the map prior of an orientation is worse than the best one, in log odds (natural logarithm).

    The map prior is how simple the simplest map is that agrees with all counts; less is better. The believed
    orientation has 0, one that is no longer among the hypotheses UNTRIED_COST.

    state : what is believed; its hypotheses are asked. angle : the orientation in degrees, counter-clockwise positive,
    as of `Frame.angle`.
    """
    if angle == state.frame.angle:
        return 0.0
    return min((one.prior_cost for one in state.hypotheses if one.angle == angle), default=UNTRIED_COST)


def choose(state: TrackerState, explanations: list[Explanation], facts: Iterable[str] = ()) -> Explanation:
    """Return the cheapest explanation by kb/asp/accommodation.lp; of those that cost the same the first.

    It is one of `explanations`, unchanged: a place (x, y) in squares, map frame of its frame, with its kind and
    residual. Costs grow with the fields left unexplained, with the distance from the predicted end, with improbability,
    and by its kind.

    Parameters
    ----------
    state : what was believed; it adds the facts trust(N), slips, off_middle, met(E) and proven.
    explanations : at least one, the likeliest first.
    facts : further facts about the motion and the observation, as text without a full stop: stands, clear, uneven,
        unchanged.
    """
    known = [f"trust({0 if state.off_middle else state.confirmations})", *["slips"] * state.slipped]
    known += ["off_middle"] * state.off_middle
    known += [f"met({n})" for n, e in enumerate(explanations) if e.met_known and e.frame == state.frame]
    known += ["proven"] * (state.in_hand is not None and state.held_objects[state.in_hand].proven)
    return cheapest(explanations, [*known, *facts])
