"""Proposals that others changed the table: a thing is no longer where it lay, something stands where floor was.

Whole things leave, walls do not. What earlier impressions said of the squares that changed says nothing any more; the
new impression, and those after it, show what is there now.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from utak.geometry.raster.components import components
from utak.kb.localisation.hypotheses.carry_outcomes import predicted_outcome
from utak.kb.localisation.hypotheses.explanation import PRICE_PER_NAT, Explanation, TableChange
from utak.kb.localisation.hypotheses.frames import FieldRanges, Observation, Position, observation_squares
from utak.kb.localisation.hypotheses.remap import object_at
from utak.kb.localisation.hypotheses.walk_outcomes import blocked_ends, observation_places
from utak.kb.localisation.known.situation import ObservedSituation, count_clashes
from utak.kb.mapping.occupancy import FREE, OCCUPIED, OPEN
from utak.kb.mapping.patch import patch_of_polygon, patch_of_squares
from utak.kb.objects.held_object import HeldObject, Square, subtract_held_objects
from utak.kb.perception.frame import Frame, Samples

BLOCKED_PRICE = 16  # of a motion that ended early, as in kb/asp/accommodation.lp
SAME_THING_DISTANCE = 2  # squares between squares that changed which count as one thing: half of the largest field


def propose(situation: ObservedSituation) -> list[Explanation]:
    """Return explanations by which others changed the table, one for each place where the look may have been made."""
    state = situation.state
    if not situation.carries:
        ends = blocked_ends(state.place, situation.shift)
        found = _changes(situation, [*observation_places(situation.ahead), *ends])
    else:  # others took what is in hand before it was moved, or something else, however that ended
        end = predicted_outcome(state.place, situation.held.polygon, situation.motion)
        moved = {held.name: held for held in situation.objects_after(end)}
        after = situation.supposing(held_objects=moved)
        taken = [one for one in _changes(situation, [state.place]) if one.change and state.in_hand in one.change.gone]
        others = [one for one in _changes(after, [end.place]) if one.change and state.in_hand not in one.change.gone]
        found = taken + [one._replace(outcome=end) for one in others]
    if state.held_objects:  # what the robot moved itself may lie a little otherwise; what is gone does not
        found = [one for one in found if one.change and one.change.gone and not one.residual]
    return found


def _changes(situation: ObservedSituation, places: Iterable[Position]) -> list[Explanation]:
    """Return the explanations by which others changed the table, made at some places, the likeliest first."""
    there = list(dict.fromkeys(places))
    found = [_changed_at(situation, there[0])]
    if found[0] is None or found[0].residual:  # the motion may have ended early, where others explain all
        early_ends = (_changed_at(situation, place) for place in there[1:])
        found += [one if one and not one.residual else None for one in early_ends]
    there = there[: len(found)]
    early = (math.dist(place, there[0]) for place in there)
    # A motion that ended early is as unlikely as without others: kb/asp/accommodation.lp
    return [
        one if not far else one._replace(chance=math.exp(-(BLOCKED_PRICE + math.ceil(far)) / PRICE_PER_NAT))
        for one, far in zip(found, early, strict=True)
        if one is not None
    ]


def _changed_at(situation: ObservedSituation, place: Position) -> Explanation | None:
    """Return the explanation that things were moved, and the look was made at `place`; None when nothing changed."""
    state, look = situation.state, _Look(situation, place)
    lying = {name: held.possible.squares() for name, held in state.held_objects.items()}
    things: dict[str, set[Square]] = {**{name: set(own) for name, own in state.things.items()}, **lying}
    if state.in_hand is not None and look.shows(lying[state.in_hand]):
        del things[state.in_hand]  # it lies a little beside where it is believed, rather than that others took it
    gone = _gone_things(look, things)
    left = [held for name, held in state.held_objects.items() if name not in gone]
    squares = frozenset(square for name in gone for square in things[name])
    new = frozenset(square for square in look.crowded(left, squares) if look.state_of(square) == FREE)
    if not gone and not new:
        return None
    occupancy = state.occupancy.copy()
    changed = squares | new | _around(look, new - squares)
    occupancy.withdraw_patch(patch_of_squares(changed))
    samples = state.frame.samples()
    counted = subtract_held_objects(samples, situation.ranges, *look.square, left)
    against = occupancy.newly_occupied(*counted, *look.square)
    if against:  # squares that were open one by one, of which earlier counts together say that fewer are occupied
        new |= against
        changed |= against
        occupancy.withdraw_patch(patch_of_squares(against))
    residual = count_clashes(state.frame, occupancy, left, place, situation.ranges)
    parts = _count_parts(new - squares) if new - squares else 0
    change = TableChange(tuple(sorted(gone)), changed, parts)
    return Explanation("changed", place, state.frame, residual, max(len(gone), parts), change=change)


class _Look:
    """A look from a place, compared with the believed map."""

    def __init__(self, situation: ObservedSituation, place: Position) -> None:
        """Find the squares under each field, map frame."""
        self.state, self.ranges = situation.state, situation.ranges
        self.square = (math.floor(place[0]), math.floor(place[1]))
        self.under = _squares_under(self.state.frame.samples(), *self.square)
        self.state.occupancy.make_room(*self.square)

    def state_of(self, square: Square) -> int:
        """Return what the map says of a square: FREE, OCCUPIED or OPEN."""
        return int(self.state.occupancy.state[self.state.occupancy.index(*square)])

    def shows(self, squares: set[Square]) -> bool:
        """Return whether the look shows that something stands on any of some squares."""
        samples = self.state.frame.samples()
        single = (samples.weight.sum(1) == 1) & (samples.slack == 0) & (self.ranges[:, 0] > 0)
        return any(not squares.isdisjoint(self.under[field]) for field in np.flatnonzero(single))

    def lacking(self, held: Iterable[HeldObject], opened: Iterable[Square]) -> list[set[Square]]:
        """Return the squares under each field that shows less than the map and held objects demand."""
        occupied, _, counts, _ = self._allowed(held, opened)
        return [self.under[field] for field in np.flatnonzero(occupied > counts[:, 1])]

    def crowded(self, held: Iterable[HeldObject], opened: Iterable[Square]) -> set[Square]:
        """Return the squares under the fields that show more than the map and held objects allow."""
        _, possible, counts, slack = self._allowed(held, opened)
        return {square for field in np.flatnonzero(possible < counts[:, 0] - slack) for square in self.under[field]}

    def _allowed(self, held: Iterable[HeldObject], opened: Iterable[Square]) -> tuple[NDArray[Any], ...]:
        """Return the least and most counts allowed, those seen, and the slack; opened squares may be either."""
        (x, y), occupancy = self.square, self.state.occupancy
        samples, counts = subtract_held_objects(self.state.frame.samples(), self.ranges, x, y, held)
        states = occupancy.state.copy()
        for square in opened:
            states[occupancy.index(*square)] = OPEN
        at = states[samples.rows + (y - occupancy.south), samples.columns + (x - occupancy.west)]
        occupied = (samples.weight * (at == OCCUPIED)).sum(1)
        return occupied, occupied + (samples.weight * (at == OPEN)).sum(1), counts, samples.slack


def _gone_things(look: _Look, things: Mapping[str, set[Square]]) -> list[str]:
    """Return the names of the fewest things that are gone where the look shows too little, as far as things explain."""
    gone = list[str]()
    while True:
        held = [one for name, one in look.state.held_objects.items() if name not in gone]
        fields = look.lacking(held, {square for name in gone for square in things[name]})
        shares = {name: sum(not own.isdisjoint(field) for field in fields) for name, own in things.items()}
        left = [
            (-share, name)
            for name, share in shares.items()
            if share and name not in gone and _is_missed(things[name], look)
        ]
        if not left:
            return gone
        gone.append(min(left)[1])


def _is_missed(own: set[Square], look: _Look) -> bool:
    """Return whether at most half of what would be seen of a thing may be there: else it lies a little otherwise."""
    expected = [len(own & field) for field in look.under]
    there = sum(min(count, int(most)) for count, most in zip(expected, look.ranges[:, 1], strict=True))
    return 2 * there <= sum(expected)


def _around(look: _Look, squares: Iterable[Square]) -> set[Square]:
    """Return the squares under all fields about some squares, but those where something stands."""
    # A thing covers more squares than those that contradict what was known. What the look shows of them counts.
    reach = range(-SAME_THING_DISTANCE, SAME_THING_DISTANCE + 1)
    near = {(column + dx, row + dy) for column, row in squares for dx in reach for dy in reach}
    fields = (own for own in look.under if not own.isdisjoint(near))
    return {square for own in fields for square in own if look.state_of(square) != OCCUPIED}


def _squares_under(samples: Samples, x: int, y: int) -> list[set[Square]]:
    """Return the squares under each field, map frame."""
    return [
        {
            (x + column, y + row)
            for column, row, weight in zip(columns.tolist(), rows.tolist(), weights.tolist(), strict=True)
            if weight
        }
        for columns, rows, weights in zip(samples.columns, samples.rows, samples.weight, strict=True)
    ]


def _count_parts(squares: frozenset[Square]) -> int:
    """Return of how many things some squares may be: those within `SAME_THING_DISTANCE` are of one."""
    half = range(-(SAME_THING_DISTANCE // 2), SAME_THING_DISTANCE // 2 + 1)
    wide = {(x + dx, y + dy) for x, y in squares for dx in half for dy in half}
    return int(components(np.pad(patch_of_squares(wide).mask, 1)).labels.max())


def forgetting(
    frame: Frame, observations: Sequence[Observation], change: TableChange, gone: Sequence[HeldObject]
) -> tuple[Observation, ...]:
    """Return earlier observations without what they say of the squares that changed, and of the things that left."""
    samples, named = frame.samples(), {held.name: held for held in gone}
    told = []
    for observation, (x, y) in zip(observations, observation_squares(frame, observations).tolist(), strict=True):
        squares = set(change.squares)
        for pose in observation.moved:
            if pose.name in named:
                squares |= object_at(named[pose.name], pose, frame).possible.squares()
        known = {pose.name for pose in observation.moved}
        for held in gone:
            squares |= patch_of_polygon(held.first).squares() if held.name not in known else set()
        moved = tuple(pose for pose in observation.moved if pose.name not in named)
        told.append(observation._replace(ranges=_silenced(observation.ranges, samples, x, y, squares), moved=moved))
    return tuple(told)


def _silenced(ranges: FieldRanges, samples: Samples, x: int, y: int, squares: set[Square]) -> FieldRanges:
    """Return the counts of an observation from the square (x, y); fields over some squares say nothing."""
    over = [not squares.isdisjoint(own) for own in _squares_under(samples, x, y)]
    left = ranges.copy()
    left[over, 0] = 0
    left[over, 1] = samples.weight[over].sum(1) + samples.slack[over]
    return left
