"""Proposals that a motion of a held object was blocked, where the observation only contradicts what it itself settles.

An observation far from everything known hardly contradicts any of it, wherever it was made. But what it says of the
squares that it shares with earlier observations must be consistent. Where it is not, the motion was blocked.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from utak.geometry.motion.se2 import Motion, Rotate
from utak.kb.localisation.hypotheses.carry_outcomes import END_SPACING, CarryOutcome, other_outcomes, predicted_outcome
from utak.kb.localisation.hypotheses.frames import Position
from utak.kb.localisation.hypotheses.what_if import Surprise, count_clashes
from utak.kb.mapping.occupancy import OCCUPIED
from utak.kb.mapping.patch import patch_of_polygon
from utak.kb.objects.held_object import GRID_CORNER_TOLERANCE, HeldObject

MIN_CROWDED_SQUARES = 4  # newly occupied squares right beside a turned object from which its turn is doubted; tuned
CROWDED_DISTANCE = 1.0  # squares around an object in which those are counted: its neighbours


def overlooked_contact(surprise: Surprise, held: HeldObject, motion: Motion) -> CarryOutcome | None:
    """Return where the motion of an object was blocked, if the observation contradicts the whole motion; else None."""
    if is_contradicted(surprise, predicted_outcome(surprise.place, held.polygon, motion)):
        return likeliest_contact(surprise, held, motion)
    return shortened_turn(surprise, held, motion) if isinstance(motion, Rotate) else None


def is_contradicted(surprise: Surprise, outcome: CarryOutcome) -> bool:
    """Return whether what the observation settles, with all earlier ones, contradicts the observation itself."""
    held_objects = surprise.objects_after(outcome)
    occupancy = surprise.map_after(held_objects, outcome.place)
    return count_clashes(surprise.frame, occupancy, held_objects, outcome.place, surprise.ranges) > 0


def likeliest_contact(surprise: Surprise, held: HeldObject, motion: Motion) -> CarryOutcome | None:
    """Return the outcome of the likeliest contact that nothing contradicts; None when there is none."""
    for end in surprise.obstructions.outcomes(surprise.place, held.polygon, motion):
        there = surprise.objects_after(end)
        fits = not count_clashes(surprise.frame, surprise.occupancy, there, end.place, surprise.ranges)
        if fits and not is_contradicted(surprise, end):
            return end
    return None


def shortened_turn(surprise: Surprise, held: HeldObject, motion: Rotate) -> CarryOutcome | None:
    """Return where a turn ended short, if that explains what seems to stand right beside the object now; else None."""
    place, polygon = surprise.place, held.polygon
    others = surprise.others(held)
    whole = _turned(held, motion.carry(polygon), held.slack, motion.degrees)
    crowded = _count_crowded(surprise, whole, others, place)
    if crowded < MIN_CROWDED_SQUARES:
        return None
    ends = [*surprise.obstructions.outcomes(place, polygon, motion)]
    ends += [end for end in other_outcomes(place, polygon, motion) if end.how == "blocked"]
    possible: list[tuple[int, float, CarryOutcome]] = []
    for end in ends:
        there = _turned(held, end.polygon, END_SPACING, end.degrees)
        if not count_clashes(surprise.frame, surprise.occupancy, [*others, there], place, surprise.ranges):
            possible.append((_count_crowded(surprise, there, others, place), end.degrees, end))
    fewest = min((many for many, *_ in possible), default=crowded)
    fitting = sorted((one for one in possible if one[0] == fewest), key=lambda one: one[1])
    return fitting[len(fitting) // 2][2] if 2 * fewest < crowded else None


def _turned(held: HeldObject, polygon: Any, slack: float, degrees: float) -> HeldObject:
    """Return an object after a turn. The less it is turned in all, the less it is astray by a wrong origin."""
    moved = held.moved(polygon, slack, degrees)
    before, after = (abs(math.sin(math.radians(one.turned / 2))) for one in (held, moved))
    # Not turned at all, or all the way round: then how far it is astray is unknown
    whole = before < GRID_CORNER_TOLERANCE
    return moved if whole else replace(moved, astray=held.astray * after / before)


def _count_crowded(surprise: Surprise, held: HeldObject, others: Sequence[HeldObject], place: Position) -> int:
    """Return how many squares right beside an object are occupied by the newest observation alone."""
    before, after = surprise.occupancy, surprise.map_after([*others, held], place)
    about = patch_of_polygon(held.polygon.buffer(CROWDED_DISTANCE, join_style="mitre")).squares()
    new = [square for square in about if before.state[before.index(*square)] != OCCUPIED]
    return sum(after.state[after.index(*square)] == OCCUPIED for square in new)
