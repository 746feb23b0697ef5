"""Proposals that a held object is larger than it seemed: it goes on in what was taken for wall.

What touches a wall looks one with it, and is told apart only where it sticks out. Only when an object is drawn out of a
door or a niche, floor shows where wall seemed to be, and so how far the object went on.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import shapely

from utak.geometry.motion.se2 import Translate
from utak.kb.localisation.hypotheses.carry_outcomes import predicted_outcome
from utak.kb.localisation.hypotheses.explanation import Explanation
from utak.kb.localisation.known.situation import ObservedSituation, count_clashes
from utak.kb.mapping.occupancy import FREE, OCCUPIED, OPEN, OccupancyMap
from utak.kb.mapping.patch import patch_of_polygon, patch_of_squares
from utak.kb.objects.held_object import HeldObject, Square, is_grid_aligned

MAX_HIDDEN_DEPTH = 8  # squares by which an object may go on in what seems to be wall; a bound on time
BESIDE_END = range(-3, 4)  # squares about the end of an object: one field of 4 x 4 may show them together (derived)
SIDE_DIRECTIONS = ((1, 0), (0, 1), (-1, 0), (0, -1))  # map frame: east, north, west, south


def propose(situation: ObservedSituation) -> Iterator[Explanation]:
    """Yield explanations that a push went as commanded and the object is larger than it seemed."""
    held, motion = situation.held, situation.motion
    if held.proven or not isinstance(motion, Translate) or not is_grid_aligned(held.polygon):
        return
    for side in SIDE_DIRECTIONS:
        agreeing = list(_agreeing_lengths(situation, held, motion, side))
        if agreeing:
            yield _best_length(agreeing, situation)._replace(distance=agreeing[0].explanation.distance)


class _Length(NamedTuple):
    """A length by which an object may go on to one side, with which the observation agrees."""

    explanation: Explanation  # that it does
    occupied: bool  # whether all that was hidden had been settled as occupied
    floor: OccupancyMap  # the map with floor in place of what was hidden
    held_objects: list[HeldObject]  # all held objects after the motion, the larger one last


def _best_length(agreeing: list[_Length], situation: ObservedSituation) -> Explanation:
    """Return the best of some lengths of an object to one side, given the least first."""
    # It is the greatest over squares that had been settled as occupied, or else the least; but a greater one where
    # something stands at the end that only the greater one accounts for.
    settled = [length for length in agreeing if length.occupied]
    best = settled[-1] if settled else agreeing[0]
    for length in agreeing[agreeing.index(best) + 1 :]:
        lying, further = (patch_of_polygon(one.held_objects[-1].polygon).squares() for one in (best, length))
        beside = {(x + i, y + j) for x, y in further - lying for i in BESIDE_END for j in BESIDE_END}
        short, long = (_clashes_beside(one, beside, situation) for one in (best, length))
        if short and not long:
            best = length
    return best.explanation


def _clashes_beside(length: _Length, squares: set[Square], situation: ObservedSituation) -> bool:
    """Return whether the observation contradicts a length if nothing else stands on some squares that are open yet."""
    floor = length.floor.copy()
    open_ = {square for square in squares if floor.state[floor.index(*square)] == OPEN}
    if open_:
        patch = patch_of_squares(open_)
        floor.declare_patch(patch, FREE, len(situation.state.observations) - 1)
    place = length.explanation.place
    return (
        count_clashes(situation.state.frame, floor, length.held_objects, place, situation.ranges, only_whether=True) > 0
    )


def _agreeing_lengths(
    situation: ObservedSituation, held: HeldObject, motion: Translate, side: tuple[int, int]
) -> Iterator[_Length]:
    """Yield the lengths by which the object may go on to one side, if the observation agrees, the least first."""
    occupancy, seen = situation.state.occupancy, patch_of_polygon(held.polygon).squares()
    others = situation.state.others(held)
    for depth in range(1, MAX_HIDDEN_DEPTH + 1):
        whole = _extended(held, side, depth)
        hidden = patch_of_polygon(whole.polygon).squares() - seen
        states = {int(occupancy.state[occupancy.index(*square)]) for square in hidden}
        if FREE in states:
            return
        outcome = predicted_outcome(situation.state.place, whole.polygon, motion)._replace(how="larger")
        patch, floor = patch_of_squares(hidden), occupancy.copy()
        floor.declare_patch(patch, FREE, len(situation.state.observations) - 1)
        held_objects = [*others, whole.moved(outcome.polygon, whole.slack, commanded=True)]
        if not count_clashes(situation.state.frame, floor, held_objects, outcome.place, situation.ranges):
            found = Explanation("larger", outcome.place, situation.state.frame, 0, float(depth), outcome, instead=whole)
            yield _Length(found, states == {OCCUPIED}, floor, held_objects)


def _extended(held: HeldObject, side: tuple[int, int], depth: int) -> HeldObject:
    """Return an object that goes on to one side by `depth` squares; its shape class is unknown then."""
    steps = (Translate(step * side[0], step * side[1]) for step in range(depth + 1))
    polygon = shapely.union_all([step.carry(held.polygon) for step in steps])
    return replace(held, polygon=polygon, first=polygon, shape={})
