"""Proposals that a held object is larger than it seemed: it goes on in what was taken for wall.

What touches a wall looks one with it, and is told apart only where it sticks out. Only when an object is drawn out of a
door or a niche, or away from a wall, floor shows where wall seemed to be, and so how far the object went on.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import shapely

from utak.geometry.motion.se2 import Translate
from utak.kb.localisation.hypotheses.carry_outcomes import predicted_outcome
from utak.kb.localisation.hypotheses.contacts import square_polygon
from utak.kb.localisation.hypotheses.explanation import Explanation
from utak.kb.localisation.hypotheses.frames import Position
from utak.kb.localisation.known.situation import ObservedSituation, count_clashes
from utak.kb.mapping.obstacle_chance import ObstacleChance
from utak.kb.mapping.occupancy import FREE, OCCUPIED, OPEN, OccupancyMap
from utak.kb.mapping.patch import patch_of_polygon, patch_of_squares
from utak.kb.objects.held_object import COMMAND_ROUNDING, HeldObject, Square, is_grid_aligned

MAX_HIDDEN_DEPTH = 8  # squares by which an object may go on in what seems to be wall; a bound on time
BESIDE_END = range(-3, 4)  # squares about the end of an object: one field of 4 x 4 may show them together (derived)
SIDE_DIRECTIONS = ((1, 0), (0, 1), (-1, 0), (0, -1))  # map frame: east, north, west, south


def propose(situation: ObservedSituation) -> Iterator[Explanation]:
    """Yield explanations that a push went as commanded and the object is larger than it seemed."""
    held, motion = situation.held, situation.motion
    if (
        not isinstance(motion, Translate)
        or held.turned
        or not is_grid_aligned(held.first)
        or max(map(abs, _way(held))) >= 1
    ):
        return  # what left a square showed then how large it is
    chance = ObstacleChance(situation.state.occupancy, situation.state.completions)
    shown = _shown_by(situation, motion, chance)
    for least in (held, *shown):
        for side in SIDE_DIRECTIONS:
            # It goes on in a wall as broad as it is, or the rest stands beside it: the arm of a U that leans on a wall.
            drawn = _drawn_out(least, side, situation.state.occupancy)
            for larger in map(list, (drawn, _with_what_stands(least, side, chance))):
                wholes = [least] * (least is not held) + larger
                agreeing = list(_agreeing_lengths(situation, wholes, ends=len(larger) < MAX_HIDDEN_DEPTH))
                if agreeing:
                    yield _best_length(agreeing, situation)._replace(distance=agreeing[0].explanation.distance)


class _Length(NamedTuple):
    """A length by which an object may go on to one side, with which the observation agrees."""

    explanation: Explanation  # that it does
    ends: bool  # whether floor had been seen beyond what was hidden
    floor: OccupancyMap  # the map with floor in place of what was hidden
    held_objects: list[HeldObject]  # all held objects after the motion, the larger one last


def _best_length(agreeing: list[_Length], situation: ObservedSituation) -> Explanation:
    """Return the best of some lengths of an object to one side, given the least first."""
    # It is the one up to floor, for what stands in a gap of a wall mostly is as deep as that, or else the least; but
    # a greater one where something stands at the end that only the greater one accounts for.
    best = agreeing[-1] if agreeing[-1].ends else agreeing[0]
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
    """Yield the lengths of an object, given the least first, with which the observation agrees."""
    # ends : whether floor was seen beyond the last one.
    occupancy, seen = situation.state.occupancy, patch_of_polygon(situation.held.first).squares()
    others = situation.state.others(situation.held)
    for whole in larger:
        hidden = patch_of_polygon(whole.first).squares() - seen
        outcome = predicted_outcome(situation.state.place, whole.polygon, situation.motion)._replace(how="larger")
        patch, floor = patch_of_squares(hidden), occupancy.copy()
        floor.declare_patch(patch, FREE, len(situation.state.observations) - 1)
        held_objects = [*others, whole.moved(outcome.polygon, whole.slack, commanded=True)]
        if not count_clashes(situation.state.frame, floor, held_objects, outcome.place, situation.ranges):
            bounds = zip(whole.polygon.bounds, situation.held.polygon.bounds, strict=True)
            further = sum(abs(one - other) for one, other in bounds)
            found = Explanation("larger", outcome.place, situation.state.frame, 0, further, outcome, instead=whole)
            yield _Length(found, ends and whole is larger[-1], floor, held_objects)


def _shown_by(situation: ObservedSituation, motion: Translate, chance: ObstacleChance) -> list[HeldObject]:
    """Return the object with all that came along and all that left where it was, in a list; [] where nothing did."""
    # Also [] after a motion that was not one by whole squares.
    held, state = situation.held, situation.state
    east, north = (one + other for one, other in zip(_way(held), (motion.dx, motion.dy), strict=True))
    dx, dy = round(east), round(north)
    if max(abs(east - dx), abs(north - dy)) > COMMAND_ROUNDING:
        return []
    outcome = predicted_outcome(state.place, held.polygon, motion)
    others = set[Square]().union(*(other.possible.squares() for other in state.others(held)))
    before, after = (patch_of_polygon(polygon).squares() for polygon in (held.first, outcome.polygon))
    occupied, free = _whole_fields(situation, outcome.place)
    along = {(x - dx, y - dy) for x, y in occupied - after - others if chance.likeliest((x, y)) == FREE}
    came = {square for square in along if chance.likeliest(square) != FREE}  # where floor was seen nothing was hidden
    left = {square for square in free - before - others if chance.likeliest(square) == OCCUPIED}
    reach = held.first.envelope.buffer(MAX_HIDDEN_DEPTH, join_style="mitre")
    hidden = [cell for cell in map(square_polygon, came | left) if reach.covers(cell)]
    if not hidden:
        return []
    known = shapely.union_all([held.first, *hidden])
    whole = _joined(held, known, known.envelope, chance)
    found = patch_of_polygon(whole.first).squares() - before  # none where nothing that left was beside it
    return [whole] if found and not whole.first.interiors else []


def _whole_fields(situation: ObservedSituation, place: Position) -> tuple[set[Square], set[Square]]:
    """Return the squares under fields that are all occupied, and those under fields all free, seen from a place."""
    samples, (x, y) = situation.state.frame.samples(), (math.floor(v) for v in place)
    weight, (least, most) = samples.weight.sum(1), situation.ranges.T
    occupied, free = (
        {
            (x + column, y + row)
            for column, row in zip(samples.columns[under].tolist(), samples.rows[under].tolist(), strict=True)
        }
        for under in ((samples.weight > 0) & fields[:, None] for fields in (least - samples.slack >= weight, most <= 0))
    )
    return occupied, free


def _drawn_out(held: HeldObject, side: tuple[int, int], occupancy: OccupancyMap) -> Iterator[HeldObject]:
    """Yield an object that goes on to one side as broad as it is, by one square, by two, up to floor that was seen."""
    seen = patch_of_polygon(held.first).squares()
    for depth in range(1, MAX_HIDDEN_DEPTH + 1):
        steps = (Translate(step * side[0], step * side[1]) for step in range(depth + 1))
        polygon = shapely.union_all([step.carry(held.first) for step in steps])
        hidden = patch_of_polygon(polygon).squares() - seen
        if any(occupancy.state[occupancy.index(*square)] == FREE for square in hidden):
            return
        yield _of_outline(held, polygon)


def _with_what_stands(held: HeldObject, side: tuple[int, int], chance: ObstacleChance) -> Iterator[HeldObject]:
    """Yield an object with what stands beside its rectangle, by one square, by two, until nothing more stands there."""
    west, south, east, north = held.first.bounds
    covered = patch_of_polygon(held.first).squares()
    for depth in range(1, MAX_HIDDEN_DEPTH + 1):
        x, y = (depth * step for step in side)
        rectangle = shapely.box(west + min(x, 0), south + min(y, 0), east + max(x, 0), north + max(y, 0))
        whole = _joined(held, held.first, rectangle, chance)
        before, covered = covered, patch_of_polygon(whole.first).squares()
        if whole.first.interiors or covered == before:
            return
        yield whole


def _joined(held: HeldObject, known: Any, rectangle: Any, chance: ObstacleChance) -> HeldObject:
    """Return an object with what is known of it, and what stands in a rectangle beside its own and joins that."""
    squares = patch_of_polygon(rectangle).squares()
    floor = [square_polygon(square) for square in squares if chance.likeliest(square) == FREE]
    joined = shapely.union_all([known, rectangle.difference(shapely.union_all([held.first.envelope, *floor]))])
    return _of_outline(held, next(part for part in shapely.get_parts(joined) if part.intersection(held.first).area))


def _of_outline(held: HeldObject, first: Any) -> HeldObject:
    """Return an object with another outline where it lay when first held; its shape class is unknown then."""
    return replace(held, polygon=Translate(*_way(held)).carry(first), first=first, shape={})


def _way(held: HeldObject) -> Position:
    """Return how far an object that was not turned has been moved since it was first held."""
    west, south, *_ = held.first.bounds
    return held.polygon.bounds[0] - west, held.polygon.bounds[1] - south
