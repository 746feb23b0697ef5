"""Proposals that a held object is larger than it seemed: it goes on in what was taken for wall.

What touches a wall looks one with it, and is told apart only where it sticks out. Only when an object is drawn out of a
door or a niche, or away from a wall, floor shows where wall seemed to be, and so how far the object went on.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import shapely

from utak.geometry.motion.se2 import Translate
from utak.kb.localisation.hypotheses.carry_outcomes import predicted_outcome
from utak.kb.localisation.hypotheses.contacts import square_polygon
from utak.kb.localisation.hypotheses.explanation import Explanation
from utak.kb.localisation.known.situation import ObservedSituation, count_clashes
from utak.kb.mapping.obstacle_chance import UNSEEN_PROBABILITY, ObstacleChance
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
        # It goes on in a wall as broad as it is, or the rest stands beside it, as an arm of a U that leans on a wall.
        drawn = list(_drawn_out(held, side, situation.state.occupancy))
        standing = list(_with_what_stands(held, side, situation))
        for larger, ends in ((drawn, False), (standing, len(standing) < MAX_HIDDEN_DEPTH)):
            agreeing = list(_agreeing_lengths(situation, larger, ends))
            if agreeing:
                yield _best_length(agreeing, situation)._replace(distance=agreeing[0].explanation.distance)


class _Length(NamedTuple):
    """A length by which an object may go on to one side, with which the observation agrees."""

    explanation: Explanation  # that it does
    ends: bool  # whether all that was hidden had been settled as occupied, or floor had been seen beyond it
    floor: OccupancyMap  # the map with floor in place of what was hidden
    held_objects: list[HeldObject]  # all held objects after the motion, the larger one last


def _best_length(agreeing: list[_Length], situation: ObservedSituation) -> Explanation:
    """Return the best of some lengths of an object to one side, given the least first."""
    # It is the greatest over squares that had been settled as occupied, or up to floor, or else the least; but a
    # greater one where something stands at the end that only the greater one accounts for.
    settled = [length for length in agreeing if length.ends]
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


def _agreeing_lengths(situation: ObservedSituation, larger: Sequence[HeldObject], ends: bool) -> Iterator[_Length]:
    """Yield the lengths of an object, given the least first, with which the observation agrees.

    ends : whether floor was seen beyond the last one.
    """
    occupancy, seen = situation.state.occupancy, patch_of_polygon(situation.held.polygon).squares()
    others = situation.state.others(situation.held)
    for depth, whole in enumerate(larger, 1):
        hidden = patch_of_polygon(whole.polygon).squares() - seen
        settled = all(occupancy.state[occupancy.index(*square)] == OCCUPIED for square in hidden)
        outcome = predicted_outcome(situation.state.place, whole.polygon, situation.motion)._replace(how="larger")
        patch, floor = patch_of_squares(hidden), occupancy.copy()
        floor.declare_patch(patch, FREE, len(situation.state.observations) - 1)
        held_objects = [*others, whole.moved(outcome.polygon, whole.slack, commanded=True)]
        if not count_clashes(situation.state.frame, floor, held_objects, outcome.place, situation.ranges):
            found = Explanation("larger", outcome.place, situation.state.frame, 0, float(depth), outcome, instead=whole)
            yield _Length(found, settled or (ends and depth == len(larger)), floor, held_objects)


def _drawn_out(held: HeldObject, side: tuple[int, int], occupancy: OccupancyMap) -> Iterator[HeldObject]:
    """Yield an object that goes on to one side as broad as it is, by one square, by two, up to floor that was seen."""
    seen = patch_of_polygon(held.polygon).squares()
    for depth in range(1, MAX_HIDDEN_DEPTH + 1):
        steps = (Translate(step * side[0], step * side[1]) for step in range(depth + 1))
        polygon = shapely.union_all([step.carry(held.polygon) for step in steps])
        hidden = patch_of_polygon(polygon).squares() - seen
        if any(occupancy.state[occupancy.index(*square)] == FREE for square in hidden):
            return
        yield _of_outline(held, polygon)


def _with_what_stands(held: HeldObject, side: tuple[int, int], situation: ObservedSituation) -> Iterator[HeldObject]:
    """Yield an object with what stands beside its rectangle, by one square, by two, until nothing more stands there."""
    occupancy = situation.state.occupancy
    chance = ObstacleChance(occupancy, situation.state.completions)
    west, south, east, north = held.polygon.bounds
    covered = patch_of_polygon(held.polygon).squares()
    for depth in range(1, MAX_HIDDEN_DEPTH + 1):
        x, y = (depth * step for step in side)
        rectangle = shapely.box(west + min(x, 0), south + min(y, 0), east + max(x, 0), north + max(y, 0))
        beside = rectangle.difference(shapely.box(west, south, east, north))
        squares = patch_of_polygon(beside).squares()
        floor = [square_polygon(square) for square in squares if _is_likely_floor(square, occupancy, chance)]
        joined = shapely.union_all([held.polygon, beside.difference(shapely.union_all(floor))])
        polygon = next(part for part in shapely.get_parts(joined) if part.intersection(held.polygon).area)
        before, covered = covered, patch_of_polygon(polygon).squares()
        if polygon.interiors or covered == before:
            return
        yield _of_outline(held, polygon)


def _of_outline(held: HeldObject, polygon: Any) -> HeldObject:
    """Return an object with another outline; its shape class is unknown then."""
    return replace(held, polygon=polygon, first=polygon, shape={})


def _is_likely_floor(square: Square, occupancy: OccupancyMap, chance: ObstacleChance) -> bool:
    """Return whether a square was seen as floor, or more likely is floor than not by what was seen of it."""
    if occupancy.state[occupancy.index(*square)] != OPEN:
        return bool(occupancy.state[occupancy.index(*square)] == FREE)
    occupied = chance.occupied(square)
    return occupied is not UNSEEN_PROBABILITY and bool(occupied.mean() < 0.5)
