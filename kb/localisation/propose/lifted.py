"""Proposals that others put the robot elsewhere, heading as before: where it recognises what it sees, or it is lost.

That it was lifted is as likely as what it sees is on the known map in the mean, or where nothing is known. Where one
place alone fits it is known where; otherwise a new map is begun, and the old one kept to be recognised later.
"""

from collections.abc import Sequence

from utak.kb.localisation.hypotheses.explanation import Explanation
from utak.kb.localisation.hypotheses.frames import Position
from utak.kb.localisation.hypotheses.recognition import KnownMap, Look, mean_likelihood, recognise
from utak.kb.localisation.hypotheses.what_if import Surprise, count_clashes

MIN_KNOWN_LOOKS = 2  # looks that a map was made of: by one alone, much else fits; a convention


def weighed_with_lifting(
    surprise: Surprise, explanations: Sequence[Explanation], may_be_lifted: bool
) -> list[Explanation]:
    """Return explanations, and perhaps that the robot was lifted, each priced by how likely it makes what is seen."""
    look = look_at(surprise)
    likely = [_likelihood(surprise, one) for one in explanations]
    lifting = mean_likelihood(look.scores)
    best = max(lifting, *likely)
    weighed = [
        one._replace(prior_cost=one.prior_cost + best - nats) for one, nats in zip(explanations, likely, strict=True)
    ]
    if not may_be_lifted:
        return weighed
    found = recognise(surprise.occupancy, [look]) if len(surprise.observations) >= MIN_KNOWN_LOOKS else None
    frame, occupancy, held_objects = surprise.frame, surprise.occupancy, surprise.held_objects.values()
    lifted = Explanation("lost", surprise.place, frame, 0, 1.0)
    if found is not None:
        residual = count_clashes(frame, occupancy, held_objects, found.place, surprise.ranges)
        lifted = Explanation("lifted", found.place, frame, residual, 1.0, place_error=found.error)
    return [*weighed, lifted._replace(prior_cost=best - lifting)]


def _likelihood(surprise: Surprise, explanation: Explanation) -> float:
    """Return how much the look favours where an explanation says it was made, in nats, beside its fields of noise."""
    place = explanation.place if explanation.frame == surprise.frame else surprise.place
    return _known_map(surprise).score_at(surprise.ranges, place)


def _known_map(surprise: Surprise) -> KnownMap:
    """Return the believed map with what lies on it."""
    things = [(held.sure, held.possible) for held in surprise.held_objects.values()]
    earlier = [observation.ranges for observation in surprise.observations]
    return KnownMap(surprise.occupancy, things, surprise.frame.samples(), earlier)


def look_at(surprise: Surprise, away: Position = (0.0, 0.0)) -> Look:
    """Return how an impression judges the places of a map. away : from where the robot was put down, in squares."""
    return Look(_known_map(surprise).scores(surprise.ranges), away)
