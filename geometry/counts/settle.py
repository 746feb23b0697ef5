"""What counts of overlapping fields settle: squares that must be occupied, and squares that cannot be.

Kernels over the arrays of kb.mapping.occupancy. state: (squares,) int8, OPEN, FREE or FULL, settled_by: (squares,)
int16, both
flat. A field is a row of `where` (n, m) int32, flat squares, each of them once, with its `weight` (n, m) int16, 0 for
padding, and the least and the greatest count, `low` and `high` (n,) int16. `fresh` (n,) bool marks the fields that are
not compared yet with all others since they came in, or since one of their squares was settled.

# Strategy: every rule looks at all fields with what is settled so far, then all that it found is settled at once; so
# the order of the fields does not matter. Fields that share squares are found by lists of the fields on every square;
two neither of which is fresh have told all that they tell together.
"""

import numpy as np
from numpy.typing import NDArray

from geometry.kernels.arrays import Ints, Longs
from geometry.kernels.jit import compiled

OPEN, FREE, FULL = -1, 0, 1
ROUNDS = 20  # of both rules, at most

States = NDArray[np.int8]
Numbers = NDArray[np.int16]


@compiled
def residue(
    state: States, where: Ints, weight: Numbers, low: Numbers, high: Numbers
) -> tuple[NDArray[np.bool_], Longs, Longs, Longs]:
    """Of every field: its open entries (n, m), their weight, and the least and the greatest count left for them."""
    number, most = where.shape
    open_ = np.zeros((number, most), np.bool_)
    left = np.zeros((3, number), np.int64)
    for i in range(number):
        full = 0
        for k in range(most):
            if weight[i, k] > 0:
                at = state[where[i, k]]
                if at == OPEN:
                    open_[i, k] = True
                    left[0, i] += weight[i, k]
                elif at == FULL:
                    full += weight[i, k]
        left[1, i] = max(low[i] - full, 0)
        left[2, i] = min(high[i] - full, left[0, i])
    return open_, left[0], left[1], left[2]


@compiled
def misfits(state: States, where: Ints, weight: Numbers, low: Numbers, high: Numbers, wrong: NDArray[np.bool_]) -> int:
    """How many fields cannot show what they show if all that is settled is right; they are marked in `wrong` (n,)."""
    found = 0
    for i in range(where.shape[0]):
        full, possible = 0, 0
        for k in range(where.shape[1]):
            at = state[where[i, k]]
            if at == FULL:
                full += weight[i, k]
            elif at == OPEN:
                possible += weight[i, k]
        wrong[i] = full > high[i] or full + possible < low[i]
        found += wrong[i]
    return found


@compiled
def settle(
    state: States,
    settled_by: Numbers,
    where: Ints,
    weight: Numbers,
    low: Numbers,
    high: Numbers,
    fresh: NDArray[np.bool_],
    number: int,
) -> None:
    """Settle all that the counts settle, as impression `number`, in the arrays themselves."""
    marks, news = np.zeros(where.size, np.int8), np.zeros(len(state), np.bool_)
    for _ in range(ROUNDS):
        changed = False
        while _single(state, settled_by, where, weight, low, high, marks, news, number):
            changed = True
        if changed:
            continue
        for i in range(where.shape[0]):
            for k in range(where.shape[1]):
                fresh[i] = fresh[i] or (weight[i, k] > 0 and news[where[i, k]])
        news[:] = False
        if not _pairs(state, settled_by, where, weight, low, high, fresh, news, number):
            return


@compiled
def _single(
    state: States,
    settled_by: Numbers,
    where: Ints,
    weight: Numbers,
    low: Numbers,
    high: Numbers,
    marks: States,
    news: NDArray[np.bool_],
    number: int,
) -> bool:
    """Fields that can take no more occupied squares leave their others free, and those that need them all fill them."""
    fields, most = where.shape
    found = False
    for i in range(fields):
        full, room = 0, 0
        for k in range(most):
            at = state[where[i, k]]
            if at == FULL:
                full += weight[i, k]
            elif at == OPEN:
                room += weight[i, k]
        least, greatest = max(low[i] - full, 0), min(high[i] - full, room)
        for k in range(most):
            mark = OPEN
            if weight[i, k] > 0 and state[where[i, k]] == OPEN:
                if weight[i, k] > greatest:
                    mark = FREE
                elif weight[i, k] > room - least:
                    mark = FULL
                found = found or mark != OPEN
            marks[i * most + k] = mark
    if not found:
        return False
    for value in (FREE, FULL):  # where two fields contradict each other, one that needs a square wins
        for i in range(fields):
            for k in range(most):
                if marks[i * most + k] == value:
                    state[where[i, k]] = value
                    settled_by[where[i, k]] = number
                    news[where[i, k]] = True
    return True


@compiled
def _pairs(
    state: States,
    settled_by: Numbers,
    where: Ints,
    weight: Numbers,
    low: Numbers,
    high: Numbers,
    fresh: NDArray[np.bool_],
    news: NDArray[np.bool_],
    number: int,
) -> bool:
    """Settle what two fields do not share, from the difference of their counts: fields of single squares alone.

    No field is fresh after that; the squares that are settled are marked in `news` (squares,).
    """
    fields, most = where.shape
    room, least, greatest = np.zeros(fields, np.int64), np.zeros(fields, np.int64), np.zeros(fields, np.int64)
    entries = 0
    for i in range(fields):
        full, heaviest = 0, 0
        for k in range(most):
            at = state[where[i, k]]
            if at == FULL:
                full += weight[i, k]
            elif at == OPEN and weight[i, k] > 0:
                room[i] += weight[i, k]
                heaviest = max(heaviest, weight[i, k])
        least[i], greatest[i] = max(low[i] - full, 0), min(high[i] - full, room[i])
        if heaviest != 1:
            room[i] = 0
        entries += room[i]
    every = np.ones(fields, np.bool_)
    first, on = _fields_on(state, where, weight, room, every, entries)
    first_fresh, on_fresh = _fields_on(state, where, weight, room, fresh, entries)
    shared, within = np.zeros(fields, np.int64), np.full(len(state), -1, np.int64)
    met, free, filled = np.empty(fields, np.int64), np.zeros(len(state), np.bool_), np.zeros(len(state), np.bool_)
    changed = False
    for a in range(fields):
        if room[a] == 0:
            continue
        many = 0
        begin, those = (first, on) if fresh[a] else (first_fresh, on_fresh)
        for k in range(most):
            square = where[a, k]
            if weight[a, k] > 0 and state[square] == OPEN:
                for at in range(begin[square], begin[square + 1]):
                    b = those[at]
                    if shared[b] == 0:
                        met[many] = b
                        many += 1
                    shared[b] += 1
        for n in range(many):
            b = met[n]
            common = shared[b]
            shared[b] = 0
            if a == b or room[a] == common:
                continue
            none = greatest[a] - max(least[b] - (room[b] - common), 0) <= 0
            all_ = least[a] - min(greatest[b], common) >= room[a] - common
            if not none and not all_:
                continue
            for k in range(most):
                if weight[b, k] > 0:
                    within[where[b, k]] = a * fields + b
            for k in range(most):
                square = where[a, k]
                if weight[a, k] > 0 and state[square] == OPEN and within[square] != a * fields + b:
                    free[square] = free[square] or none
                    filled[square] = filled[square] or all_
                    changed = True
    fresh[:] = False
    if not changed:
        return False
    for square in range(len(state)):
        if free[square] or filled[square]:
            state[square] = FREE if free[square] else FULL
            settled_by[square] = number
            news[square] = True
    return True


@compiled
def _fields_on(
    state: States, where: Ints, weight: Numbers, room: Longs, chosen: NDArray[np.bool_], entries: int
) -> tuple[Longs, Longs]:
    """The chosen fields with room on every open square: those on square s are on[first[s]:first[s + 1]]."""
    first, on = np.zeros(len(state) + 2, np.int64), np.empty(entries, np.int64)
    for i in range(where.shape[0]):
        if chosen[i] and room[i] > 0:
            for k in range(where.shape[1]):
                if weight[i, k] > 0 and state[where[i, k]] == OPEN:
                    first[where[i, k] + 2] += 1
    for square in range(len(state)):
        first[square + 2] += first[square + 1]
    for i in range(where.shape[0]):
        if chosen[i] and room[i] > 0:
            for k in range(where.shape[1]):
                square = where[i, k]
                if weight[i, k] > 0 and state[square] == OPEN:
                    on[first[square + 1]] = i
                    first[square + 1] += 1
    return first, on
