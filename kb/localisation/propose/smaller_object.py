"""Proposals that a held object does not fill the squares in which it was seen.

A push shows it in two ways: a side that lies further in enters the next row of squares later, and an object that is
pressed against something known goes further than its squares would let it.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from utak.geometry.motion.se2 import Translate
from utak.kb.localisation.hypotheses.carry_outcomes import END_SPACING, CarryOutcome, blocked_by_known, observed_from
from utak.kb.localisation.hypotheses.contacts import NO_SQUARES
from utak.kb.localisation.hypotheses.explanation import Explanation
from utak.kb.localisation.hypotheses.frames import FieldRanges, Position
from utak.kb.localisation.known.situation import ObservedSituation, count_clashes
from utak.kb.localisation.known.state import TrackerState
from utak.kb.mapping.patch import patch_of_polygon
from utak.kb.objects.held_object import COMMAND_ROUNDING, HeldObject
from utak.kb.objects.subcell_extent import SubcellExtent, as_sides


def propose(situation: ObservedSituation) -> list[Explanation]:
    """Return the explanation that the object does not fill its squares, in a list; [] when that explains nothing."""
    # Then the motion went as commanded, or until the object met something known.
    whole = situation.found[0]
    assert whole.outcome is not None
    held, outcome = situation.held, whole.outcome
    lying = held.moved(outcome.polygon, held.slack, outcome.degrees, commanded=True)
    less = refined_extent(situation.state, lying, situation.ranges, outcome.place)
    if less is not None:
        smaller = outcome._replace(how="smaller", polygon=less.polygon, insets=less.insets)
        return [whole._replace(how="smaller", residual=0, contradicted=False, outcome=smaller)]
    ends = list(_pressed(situation))
    if not ends:
        return []
    extents = np.array([end.insets for end in ends])  # (ends, least and most, sides)
    together = SubcellExtent(as_sides(extents[:, 0].min(0).tolist()), as_sides(extents[:, 1].max(0).tolist()))
    end = _end_against_known(situation, together) or ends[len(ends) // 2]
    return [Explanation("smaller", end.place, situation.state.frame, 0, end.distance, end)]


def refined_extent(state: TrackerState, held: HeldObject, ranges: FieldRanges, place: Position) -> HeldObject | None:
    """Return an object with the sub-cell extent that an observation at `place` shows; None when none agrees with it."""
    return held.told(_agreement(state, held, ranges, place))


def _agreement(state: TrackerState, held: HeldObject, ranges: FieldRanges, place: Position) -> Callable[[Any], bool]:
    """Return a function that returns whether an observation at `place` agrees with an exact outline of an object."""
    others = state.others(held)
    floor = state.occupancy.supposing(patch_of_polygon(held.polygon).squares())

    def agrees(outline: Any) -> bool:
        lying = replace(held, polygon=outline, slack=0.0, full=NO_SQUARES, empty=NO_SQUARES)
        return not count_clashes(state.frame, floor, [*others, lying], place, ranges)

    return agrees


def _pressed(situation: ObservedSituation) -> Iterator[CarryOutcome]:
    """Yield the ends of a push against something known if the sides ahead lie further in, by one step or more."""
    insets, quarters, motion = situation.held.lying_insets, situation.held.quarters, situation.motion
    if insets is None or quarters is None or not isinstance(motion, Translate):
        return
    ahead = (motion.dx < 0, motion.dx > 0, motion.dy < 0, motion.dy > 0)
    for step in range(math.ceil(1 / END_SPACING)):
        low, high = max(step * END_SPACING, COMMAND_ROUNDING), (step + 1) * END_SPACING
        least = as_sides(max(side, low) if led else side for side, led in zip(insets.least, ahead, strict=True))
        most = as_sides(min(side, high) if led else side for side, led in zip(insets.most, ahead, strict=True))
        if all(few < many for few, many in zip(least, most, strict=True)):
            end = _end_against_known(situation, SubcellExtent(least, most).after(-quarters))
            if end is not None:
                yield end


def _end_against_known(situation: ObservedSituation, insets: SubcellExtent) -> CarryOutcome | None:
    """Return where something known stops the object with such insets; None if nothing does, or not as was seen."""
    state, less = situation.state, situation.held.inset(insets)
    if less is None:
        return None
    end = blocked_by_known(state.place, less.polygon, situation.motion, situation.obstructions.known)
    if end is None:
        return None
    lying = less.moved(end.polygon, less.slack)
    for view in observed_from(end):
        if _agreement(state, lying, situation.ranges, view.place)(end.polygon):
            return view._replace(insets=insets)
    return None
