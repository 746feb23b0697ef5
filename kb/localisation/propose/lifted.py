"""Proposals that others put the robot elsewhere, heading as before: where it recognises what it sees, or it is lost.

That it was lifted is as likely as what it sees is on the known map in the mean, or where nothing is known. Where one
place alone fits it is known where; otherwise a new map is begun, and the old one kept to be recognised later.
"""

from collections.abc import Sequence

from utak.kb.localisation.hypotheses.explanation import Explanation
from utak.kb.localisation.hypotheses.frames import FieldRanges, Position
from utak.kb.localisation.hypotheses.recognition import KnownMap, Look, mean_likelihood, recognise
from utak.kb.localisation.hypotheses.what_if import count_clashes
from utak.kb.localisation.state import TrackerState


def weighed_with_lifting(
    state: TrackerState, ranges: FieldRanges, explanations: Sequence[tuple[TrackerState, Explanation]]
) -> list[Explanation]:
    """Return explanations, and that the robot was lifted, each with its price by how likely it makes what is seen."""
    # explanations : each with the state in which what is in hand lies where it says
    look = look_at(state, ranges)
    likely = [_likelihood(after, ranges, one) for after, one in explanations]
    lifting = mean_likelihood(look.scores)
    best = max(lifting, *likely)
    found = recognise(state.occupancy, [look])
    lifted = Explanation("lost", state.place, state.frame, 0, 1.0)
    if found is not None:
        held_objects = state.held_objects.values()
        residual = count_clashes(state.frame, state.occupancy, held_objects, found.place, ranges)
        lifted = Explanation("lifted", found.place, state.frame, residual, 1.0, place_error=found.error)
    weighed = zip((one for _, one in explanations), likely, strict=True)
    return [
        *(one._replace(prior_cost=one.prior_cost + best - nats) for one, nats in weighed),
        lifted._replace(prior_cost=best - lifting),
    ]


def _likelihood(state: TrackerState, ranges: FieldRanges, explanation: Explanation) -> float:
    """Return how much the look favours where an explanation says it was made, in nats, beside its fields of noise."""
    if explanation.frame != state.frame:
        return known_map(state).score_at(ranges, state.place)
    return known_map(state).score_at(ranges, explanation.place)


def known_map(state: TrackerState) -> KnownMap:
    """Return the believed map with what lies on it."""
    things = [(held.sure, held.possible) for held in state.held_objects.values()]
    earlier = [observation.ranges for observation in state.observations]
    return KnownMap(state.occupancy, things, state.frame.samples(), earlier)


def look_at(state: TrackerState, ranges: FieldRanges, away: Position = (0.0, 0.0)) -> Look:
    """Return how an impression judges the places of a map. away : from where the robot was put down, in squares."""
    return Look(known_map(state).scores(ranges), away)
