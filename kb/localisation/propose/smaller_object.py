"""Proposals that the held object does not fill the squares in which it was seen.

A push shows it in two ways: a side that lies further in enters the next row of squares later, and an object that is
pressed against something known goes further than its squares would let it.
"""

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from utak.geometry.motion.se2 import Motion, Translate
from utak.kb.localisation.hypotheses.carry_outcomes import END_SPACING, CarryOutcome, blocked_by_known
from utak.kb.localisation.hypotheses.contacts import NO_SQUARES
from utak.kb.localisation.hypotheses.explanation import Explanation
from utak.kb.localisation.hypotheses.frames import Position
from utak.kb.localisation.hypotheses.what_if import Surprise, count_clashes
from utak.kb.mapping.patch import patch_of_polygon
from utak.kb.objects.held_object import COMMAND_ROUNDING, HeldObject
from utak.kb.objects.subcell_extent import SubcellExtent, as_sides, inset_change


def smaller_objects(surprise: Surprise, held: HeldObject, motion: Motion, whole: CarryOutcome) -> Iterator[Explanation]:
    """Yield explanations that a motion went as commanded, or until the object met something, and it is smaller."""
    # whole : the outcome of the motion as commanded
    lying = held.moved(whole.polygon, held.slack, whole.degrees, commanded=True)
    less = refined_extent(surprise, lying, whole.place)
    if less is not None:
        outcome = whole._replace(how="smaller", polygon=less.polygon, insets=less.insets)
        yield Explanation("smaller", whole.place, surprise.frame, 0, 0.0, outcome)
        return
    ends = list(_pressed(surprise, held, motion))
    if ends:
        extents = np.array([end.insets for end in ends])  # (ends, least and most, sides)
        together = SubcellExtent(as_sides(extents[:, 0].min(0).tolist()), as_sides(extents[:, 1].max(0).tolist()))
        outcome = _end_against_known(surprise, held, motion, together) or ends[len(ends) // 2]
        yield Explanation("smaller", outcome.place, surprise.frame, 0, outcome.distance, outcome)


def refined_extent(surprise: Surprise, held: HeldObject, place: Position) -> HeldObject | None:
    """Return an object with the sub-cell extent that an observation at `place` shows; None when none agrees with it."""
    frame, others, nothing = surprise.frame, surprise.others(held), NO_SQUARES
    floor = surprise.occupancy.supposing(patch_of_polygon(held.polygon).squares())

    def agrees(outline: Any) -> bool:
        lying = replace(held, polygon=outline, slack=0.0, full=nothing, empty=nothing)
        return not count_clashes(frame, floor, [*others, lying], place, surprise.ranges)

    return held.told(agrees)


def _pressed(surprise: Surprise, held: HeldObject, motion: Motion) -> Iterator[CarryOutcome]:
    """Yield the ends of a push against something known if the sides ahead lie further in, by one step or more."""
    insets, quarters = held.lying_insets, held.quarters
    if insets is None or quarters is None or not isinstance(motion, Translate):
        return
    ahead = (motion.dx < 0, motion.dx > 0, motion.dy < 0, motion.dy > 0)
    for step in range(math.ceil(1 / END_SPACING)):
        low, high = step * END_SPACING, (step + 1) * END_SPACING
        least = as_sides(max(side, low) if led else side for side, led in zip(insets.least, ahead, strict=True))
        most = as_sides(min(side, high) if led else side for side, led in zip(insets.most, ahead, strict=True))
        if all(few < many for few, many in zip(least, most, strict=True)):
            end = _end_against_known(surprise, held, motion, SubcellExtent(least, most).after(-quarters))
            if end is not None:
                yield end


def _end_against_known(
    surprise: Surprise, held: HeldObject, motion: Motion, insets: SubcellExtent
) -> CarryOutcome | None:
    """Return where something known stops an object with such insets; None if nothing does, or not as was seen."""
    less = held.inset(insets)
    if less is None:
        return None
    end = blocked_by_known(surprise.place, less.polygon, motion, surprise.obstructions.known)
    told = None if end is None else refined_extent(surprise, less.moved(end.polygon, less.slack), end.place)
    if end is None or told is None or told.insets is None:
        return None
    if max(map(abs, inset_change(told.insets, insets))) < COMMAND_ROUNDING:
        return end._replace(polygon=told.polygon, insets=told.insets)
    return _end_against_known(surprise, held, motion, told.insets)  # where it is stopped if its sides lie there
