"""Proposals that a motion of a held object was blocked, where the observation only contradicts what it itself settles.

An observation far from everything known hardly contradicts any of it, wherever it was made. But what it says of the
squares that it shares with earlier observations must be consistent. Where it is not, the motion was blocked.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from utak.geometry.motion.se2 import Rotate
from utak.kb.localisation.hypotheses.carry_outcomes import END_SPACING, CarryOutcome, other_outcomes, predicted_outcome
from utak.kb.localisation.hypotheses.frames import Position
from utak.kb.localisation.known.situation import ObservedSituation, count_clashes, residual_at
from utak.kb.mapping.occupancy import OCCUPIED
from utak.kb.mapping.patch import patch_of_polygon
from utak.kb.objects.held_object import GRID_CORNER_TOLERANCE, HeldObject

MIN_CROWDED_SQUARES = 4  # newly occupied squares right beside a turned object from which its turn is doubted; tuned
CROWDED_DISTANCE = 1.0  # squares around an object in which those are counted: its neighbours


def overlooked_contact(situation: ObservedSituation) -> CarryOutcome | None:
    """Return where the motion of an object was blocked, if the observation contradicts the whole motion; else None."""
    whole = predicted_outcome(situation.state.place, situation.held.polygon, situation.motion)
    if _is_contradicted(situation, whole):
        fitting = (end for end in situation.contact_ends if not residual_at(situation, end.place, end))
        return next((end for end in fitting if not _is_contradicted(situation, end)), None)
    return shortened_turn(situation) if isinstance(situation.motion, Rotate) else None


def _is_contradicted(situation: ObservedSituation, outcome: CarryOutcome) -> bool:
    """Return whether what the observation settles, with all earlier ones, contradicts the observation itself."""
    held_objects = situation.objects_after(outcome)
    occupancy = situation.map_after(held_objects, outcome.place)
    return count_clashes(situation.state.frame, occupancy, held_objects, outcome.place, situation.ranges) > 0


def shortened_turn(situation: ObservedSituation) -> CarryOutcome | None:
    """Return where a turn ended short, if that explains what seems to stand right beside the object now; else None."""
    assert isinstance(situation.motion, Rotate)
    state, held, motion = situation.state, situation.held, situation.motion
    place, others = state.place, state.others(held)
    whole = _turned(held, motion.carry(held.polygon), held.slack, motion.degrees)
    crowded = _count_crowded(situation, whole, others, place)
    if crowded < MIN_CROWDED_SQUARES:
        return None
    ends = situation.contact_ends
    ends += [end for end in other_outcomes(place, held.polygon, motion) if end.how == "blocked"]
    possible: list[tuple[int, float, CarryOutcome]] = []
    for end in ends:
        there = _turned(held, end.polygon, END_SPACING, end.degrees)
        if not count_clashes(state.frame, state.occupancy, [*others, there], place, situation.ranges):
            possible.append((_count_crowded(situation, there, others, place), end.degrees, end))
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


def _count_crowded(
    situation: ObservedSituation, held: HeldObject, others: Sequence[HeldObject], place: Position
) -> int:
    """Return how many squares right beside an object are occupied by the newest observation alone."""
    before, after = situation.state.occupancy, situation.map_after([*others, held], place)
    about = patch_of_polygon(held.polygon.buffer(CROWDED_DISTANCE, join_style="mitre")).squares()
    new = [square for square in about if before.state[before.index(*square)] != OCCUPIED]
    return sum(after.state[after.index(*square)] == OCCUPIED for square in new)
