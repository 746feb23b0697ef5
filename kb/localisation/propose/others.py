"""Proposals that others changed the table: a thing is no longer where it lay, something stands where floor was.

Whole things leave, walls do not. What earlier impressions said of the squares that changed says nothing any more; the
new impression, and those after it, show what is there now.
"""

import math
from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from utak.geometry.kernels.arrays import Bools
from utak.geometry.raster.components import components
from utak.kb.localisation.hypotheses.explanation import PRICE_PER_NAT, Explanation, TableChange
from utak.kb.localisation.hypotheses.frames import FieldRanges, Observation, Position, observation_squares
from utak.kb.localisation.hypotheses.remap import object_at
from utak.kb.localisation.hypotheses.what_if import Surprise, count_clashes
from utak.kb.mapping.occupancy import FREE, OCCUPIED, OPEN
from utak.kb.mapping.patch import patch_of_polygon, patch_of_squares
from utak.kb.objects.held_object import HeldObject, Square, subtract_held_objects
from utak.kb.perception.frame import Frame, Samples

BLOCKED_PRICE = 16  # of a motion that ended early, as in kb/asp/accommodation.lp
SAME_THING_DISTANCE = 2  # squares between squares that changed which count as one thing: half of the largest field


def propose_changes(surprise: Surprise, places: Iterable[Position]) -> list[Explanation]:
    """Return explanations by which others changed the table, one for each place where the look may have been made."""
    there = list(dict.fromkeys(places))
    found = [_changed_at(surprise, there[0])]
    if found[0] is None or found[0].residual:  # the motion may have ended early, where others explain all
        early_ends = (_changed_at(surprise, place) for place in there[1:])
        found += [one if one and not one.residual else None for one in early_ends]
    there = there[: len(found)]
    early = (math.dist(place, there[0]) for place in there)
    # A motion that ended early is as unlikely as without others: kb/asp/accommodation.lp
    return [
        one if not far else one._replace(chance=math.exp(-(BLOCKED_PRICE + math.ceil(far)) / PRICE_PER_NAT))
        for one, far in zip(found, early, strict=True)
        if one is not None
    ]


def _changed_at(surprise: Surprise, place: Position) -> Explanation | None:
    """Return the explanation that things were moved, and the look was made at `place`; None when nothing changed."""
    lying = {name: held.possible.squares() for name, held in surprise.held_objects.items()}
    things: dict[str, set[Square]] = {**{name: set(own) for name, own in surprise.things.items()}, **lying}
    if surprise.in_hand is not None and _is_seen(surprise, place, lying[surprise.in_hand]):
        del things[surprise.in_hand]  # it lies a little beside where it is believed, rather than that others took it
    gone = _gone_things(surprise, place, things)
    left = [held for name, held in surprise.held_objects.items() if name not in gone]
    squares = frozenset(square for name in gone for square in things[name])
    new = _new_squares(surprise, place, left, squares)
    if not gone and not new:
        return None
    occupancy = surprise.occupancy.copy()
    changed = squares | new | _around(surprise, place, new - squares)
    occupancy.withdraw_patch(patch_of_squares(changed))
    x, y = math.floor(place[0]), math.floor(place[1])
    against = occupancy.newly_occupied(
        *subtract_held_objects(surprise.frame.samples(), surprise.ranges, x, y, left), x, y
    )
    if against:  # squares that were open one by one, of which earlier counts together say that fewer are occupied
        new |= against
        changed |= against
        occupancy.withdraw_patch(patch_of_squares(against))
    residual = count_clashes(surprise.frame, occupancy, left, place, surprise.ranges)
    parts = _count_parts(new - squares) if new - squares else 0
    change = TableChange(tuple(sorted(gone)), changed, parts)
    acts = max(len(gone), parts)
    return Explanation("changed", place, surprise.frame, residual, acts, change=change)


def _gone_things(surprise: Surprise, place: Position, things: Mapping[str, set[Square]]) -> list[str]:
    """Return the names of the fewest things that are gone where the look shows too little, as far as things explain."""
    x, y = math.floor(place[0]), math.floor(place[1])
    samples, gone = surprise.frame.samples(), list[str]()
    under = _squares_under(samples, x, y)
    while True:
        lacking = _balance(surprise, place, _without(surprise, gone), _squares_of(things, gone))[0]
        fields = [under[field] for field in np.flatnonzero(lacking)]
        shares = {name: sum(not own.isdisjoint(field) for field in fields) for name, own in things.items()}
        left = [
            (-share, name)
            for name, share in shares.items()
            if share and name not in gone and _is_missed(things[name], under, surprise.ranges)
        ]
        if not left:
            return gone
        gone.append(min(left)[1])


def _is_seen(surprise: Surprise, place: Position, squares: set[Square]) -> bool:
    """Return whether the look shows that something stands on any of some squares."""
    samples = surprise.frame.samples()
    single = (samples.weight.sum(1) == 1) & (samples.slack == 0) & (surprise.ranges[:, 0] > 0)
    x, y = math.floor(place[0]), math.floor(place[1])
    under = _squares_under(samples, x, y)
    return any(not squares.isdisjoint(under[field]) for field in np.flatnonzero(single))


def _is_missed(own: set[Square], under: Sequence[set[Square]], ranges: FieldRanges) -> bool:
    """Return whether at most half of what would be seen of a thing may be there: else it lies a little otherwise."""
    expected = [len(own & field) for field in under]
    there = sum(min(count, int(most)) for count, most in zip(expected, ranges[:, 1], strict=True))
    return 2 * there <= sum(expected)


def _new_squares(
    surprise: Surprise, place: Position, left: Sequence[HeldObject], gone: frozenset[Square]
) -> frozenset[Square]:
    """Return the squares of floor on which something may stand now, since the look shows too much."""
    x, y = math.floor(place[0]), math.floor(place[1])
    samples = surprise.frame.samples()
    surplus = _balance(surprise, place, left, gone)[1]
    under = _squares_under(samples, x, y)
    state_at, index = surprise.occupancy.state, surprise.occupancy.index
    shown = {square for field in np.flatnonzero(surplus) for square in under[field]}
    return frozenset(square for square in shown if state_at[index(*square)] == FREE)


def _around(surprise: Surprise, place: Position, squares: Iterable[Square]) -> set[Square]:
    """Return the squares under all fields about some squares, but those where something stands."""
    # A thing covers more squares than those that contradict what was known. What the look shows of them counts.
    x, y = math.floor(place[0]), math.floor(place[1])
    reach = range(-SAME_THING_DISTANCE, SAME_THING_DISTANCE + 1)
    near = {(column + dx, row + dy) for column, row in squares for dx in reach for dy in reach}
    fields = (own for own in _squares_under(surprise.frame.samples(), x, y) if not own.isdisjoint(near))
    state_at, index = surprise.occupancy.state, surprise.occupancy.index
    return {square for own in fields for square in own if state_at[index(*square)] != OCCUPIED}


def _balance(
    surprise: Surprise, place: Position, held: Iterable[HeldObject], opened: Iterable[Square]
) -> tuple[Bools, Bools]:
    """Return which fields show less than the map and held objects allow, and which show more; opened squares may be."""
    x, y = math.floor(place[0]), math.floor(place[1])
    occupancy = surprise.occupancy
    occupancy.make_room(x, y)
    samples, counts = subtract_held_objects(surprise.frame.samples(), surprise.ranges, x, y, held)
    states = occupancy.state.copy()
    for square in opened:
        states[occupancy.index(*square)] = OPEN
    at = states[samples.rows + (y - occupancy.south), samples.columns + (x - occupancy.west)]
    occupied = (samples.weight * (at == OCCUPIED)).sum(1)
    possible = occupied + (samples.weight * (at == OPEN)).sum(1)
    return np.asarray(occupied > counts[:, 1]), np.asarray(possible < counts[:, 0] - samples.slack)


def _without(surprise: Surprise, gone: Sequence[str]) -> list[HeldObject]:
    return [held for name, held in surprise.held_objects.items() if name not in gone]


def _squares_of(things: Mapping[str, set[Square]], names: Iterable[str]) -> set[Square]:
    return {square for name in names for square in things[name]}


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
    mask = np.pad(patch_of_squares(squares).mask, SAME_THING_DISTANCE)
    near = mask.copy()
    for _ in range(SAME_THING_DISTANCE // 2):
        wide = np.pad(near, 1)
        near = np.logical_or.reduce(
            [wide[1 + dy :, 1 + dx :][: near.shape[0], : near.shape[1]] for dy in (-1, 0, 1) for dx in (-1, 0, 1)]
        )
    return int(components(near).labels.max())


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
        told.append(observation._replace(ranges=silenced(observation.ranges, samples, x, y, squares), moved=moved))
    return tuple(told)


def silenced(ranges: FieldRanges, samples: Samples, x: int, y: int, squares: set[Square]) -> FieldRanges:
    """Return the counts of an observation from the square (x, y); fields over some squares say nothing."""
    rows = np.array([[row, column] for column, row in squares])
    south, west = rows.min(0)
    mask = np.zeros(tuple(rows.max(0) - [south, west] + 1), np.bool_)
    mask[rows[:, 0] - south, rows[:, 1] - west] = True
    row, column = samples.rows + (y - south), samples.columns + (x - west)
    inside = (row >= 0) & (row < mask.shape[0]) & (column >= 0) & (column < mask.shape[1]) & (samples.weight > 0)
    over = (inside & mask[np.where(inside, row, 0), np.where(inside, column, 0)]).any(1)
    if not over.any():
        return ranges
    left = ranges.copy()
    left[over, 0] = 0
    left[over, 1] = samples.weight[over].sum(1) + samples.slack[over]
    return left
