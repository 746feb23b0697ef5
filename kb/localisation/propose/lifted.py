"""Proposals that others put the robot elsewhere on the known map, heading as before: where it recognises what it sees."""

from utak.kb.localisation.hypotheses.explanation import Explanation
from utak.kb.localisation.hypotheses.frames import FieldRanges
from utak.kb.localisation.hypotheses.recognition import Look, look_scores, recognise
from utak.kb.localisation.hypotheses.what_if import count_clashes
from utak.kb.localisation.state import TrackerState


def propose_lifted(state: TrackerState, ranges: FieldRanges) -> list[Explanation]:
    """Return the explanation that the robot stands where the map shows what it sees, in a list; [] for no such place."""
    found = recognise(state.occupancy, [look_at(state, ranges)])
    if found is None:
        return []
    residual = count_clashes(state.frame, state.occupancy, state.held_objects.values(), found.landing, ranges)
    lifted = Explanation("lifted", found.landing, state.frame, residual, 1.0, chance=found.chance)
    return [lifted._replace(place_error=found.error)]


def look_at(state: TrackerState, ranges: FieldRanges, away: tuple[float, float] = (0.0, 0.0)) -> Look:
    """Return how an impression judges the places of a map. away : from where the robot was put down, in squares."""
    things = [(held.sure, held.possible) for held in state.held_objects.values()]
    earlier = [observation.ranges for observation in state.observations]
    return Look(look_scores(state.occupancy, things, state.frame.samples(), ranges, earlier), away)
