"""Proposals that others put the robot elsewhere, heading as before: where it recognises what it sees, or it is lost.

That it was lifted is as likely as what it sees is on the known map in the mean, or where nothing is known. Where one
place alone fits it is known where; otherwise a new map is begun, and the old one kept to be recognised later.
"""

from utak.kb.localisation.hypotheses.explanation import Explanation
from utak.kb.localisation.hypotheses.frames import Position
from utak.kb.localisation.hypotheses.recognition import KnownMap, Look, mean_likelihood, recognise
from utak.kb.localisation.known.situation import ObservedSituation, residual_at

MIN_KNOWN_LOOKS = 2  # looks that a map was made of: by one alone, much else fits; a convention


def propose(situation: ObservedSituation) -> list[Explanation]:
    """Return the explanation that others put the robot elsewhere, in a list."""
    state, look = situation.state, look_at(situation)
    found = recognise(state.occupancy, [look]) if len(state.observations) >= MIN_KNOWN_LOOKS else None
    lifted = Explanation("lost", state.place, state.frame, 0, 1.0, prior_cost=-mean_likelihood(look.scores))
    if found is not None:
        residual = residual_at(situation, found.place)
        lifted = lifted._replace(how="lifted", place=found.place, residual=residual, place_error=found.error)
    return [lifted]


def weighed(situation: ObservedSituation) -> list[Explanation]:
    """Return the explanations found, each priced by how likely it makes what is seen, in nats beside its noise."""
    state, known = situation.state, _known_map(situation)
    places = [one.place if one.frame == state.frame else state.place for one in situation.found]
    costs = [
        one.prior_cost - (one.how not in ("lifted", "lost") and known.score_at(situation.ranges, place))
        for one, place in zip(situation.found, places, strict=True)
    ]
    return [one._replace(prior_cost=cost - min(costs)) for one, cost in zip(situation.found, costs, strict=True)]


def _known_map(situation: ObservedSituation) -> KnownMap:
    """Return the believed map with what lies on it."""
    state = situation.state
    things = [(held.sure, held.possible) for held in state.held_objects.values()]
    return KnownMap(state.occupancy, things, state.frame.samples(), [one.ranges for one in state.observations])


def look_at(situation: ObservedSituation, away: Position = (0.0, 0.0)) -> Look:
    """Return how an impression judges the places of a map. away : from where the robot was put down, in squares."""
    return Look(_known_map(situation).scores(situation.ranges), away)
