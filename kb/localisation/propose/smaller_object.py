"""Proposals that a held object does not fill the squares in which it was seen."""

from dataclasses import replace
from typing import Any

from utak.kb.localisation.hypotheses.contacts import NO_SQUARES
from utak.kb.localisation.hypotheses.explanation import Explanation
from utak.kb.localisation.hypotheses.frames import FieldRanges, Position
from utak.kb.localisation.known.situation import ObservedSituation, count_clashes
from utak.kb.localisation.known.state import TrackerState
from utak.kb.mapping.patch import patch_of_polygon
from utak.kb.objects.held_object import HeldObject


def propose(situation: ObservedSituation) -> list[Explanation]:
    """Return the explanation that the object does not fill its squares, in a list; [] when that explains nothing."""
    whole = situation.found[0]
    assert whole.outcome is not None
    held, outcome = situation.held, whole.outcome
    lying = held.moved(outcome.polygon, held.slack, outcome.degrees, commanded=True)
    less = refined_extent(situation.state, lying, situation.ranges, outcome.place)
    if less is None:
        return []
    smaller = outcome._replace(how="smaller", polygon=less.polygon, insets=less.insets)
    return [whole._replace(how="smaller", residual=0, contradicted=False, outcome=smaller)]


def refined_extent(state: TrackerState, held: HeldObject, ranges: FieldRanges, place: Position) -> HeldObject | None:
    """Return an object with the sub-cell extent that an observation at `place` shows; None when none agrees with it."""
    others = state.others(held)
    floor = state.occupancy.supposing(patch_of_polygon(held.polygon).squares())

    def agrees(outline: Any) -> bool:
        lying = replace(held, polygon=outline, slack=0.0, full=NO_SQUARES, empty=NO_SQUARES)
        return not count_clashes(state.frame, floor, [*others, lying], place, ranges)

    return held.told(agrees)
