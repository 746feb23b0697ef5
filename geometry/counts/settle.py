"""Squares that counts of overlapping fields settle: those that must be occupied, and those that cannot be.

A field is a set of squares that the robot sees as one; its count says how many of them are occupied, each as often as
the field samples it (its weight there). These are kernels over the arrays of kb.mapping.occupancy. `state` (squares,)
int8 is OPEN, FREE or OCCUPIED, and `settled_by` (squares,) int16 is the number of the impression that settled a square;
both are flat, index row * columns + column in the map's array. A field is a row of `where` (n, m) int32, flat squares,
each of them once, with its `weight` (n, m) int16, 0 for padding, and the least and the greatest count, `low` and `high`
(n,) int16. `fresh` (n,) bool marks the fields that are not yet compared with all others since they came in, or since
one of their squares was settled.

# Strategy: every rule looks at all fields with what is settled so far, then all that it found is settled at once; so
the order of the fields does not matter. Fields that share squares are found by lists of the fields on every square. Two
fields of which neither is fresh have settled all that they settle together.
"""

import numpy as np
from numpy.typing import NDArray

from utak.geometry.kernels.arrays import Ints, Longs
from utak.geometry.kernels.jit import bare, compiled

OPEN, FREE, OCCUPIED = -1, 0, 1  # states of a square: not settled, settled as free, settled as occupied
MAX_ROUNDS = 20  # rounds of both rules; convention, a bound on time

SquareStates = NDArray[np.int8]
Numbers = NDArray[np.int16]


def remaining_counts(
    state: SquareStates, where: Ints, weight: Numbers, low: Numbers, high: Numbers
) -> tuple[NDArray[np.bool_], Longs, Longs, Longs]:
    """Return what remains of every field once settled squares are taken out."""
    at = state[where]
    open_ = (at == OPEN) & (weight > 0)
    left, occupied = (np.where(chosen, weight, 0).sum(axis=1) for chosen in (open_, at == OCCUPIED))
    return open_, left, np.maximum(low - occupied, 0), np.minimum(high - occupied, left)


@bare
def _weights(state: SquareStates, where: Ints, weight: Numbers, i: int) -> tuple[int, int]:
    """Return how often field i samples squares that are settled as occupied, and open ones."""
    occupied, open_weight = 0, 0
    for k in range(where.shape[1]):
        at = state[where[i, k]]
        if at == OCCUPIED:
            occupied += weight[i, k]
        elif at == OPEN:
            open_weight += weight[i, k]
    return occupied, open_weight


@compiled
def misfits(
    state: SquareStates, where: Ints, weight: Numbers, low: Numbers, high: Numbers, wrong: NDArray[np.bool_]
) -> int:
    """Return how many fields cannot have their counts if all that is settled is right; mark them in `wrong`."""
    found = 0
    for i in range(where.shape[0]):
        occupied, possible = _weights(state, where, weight, i)
        wrong[i] = occupied > high[i] or occupied + possible < low[i]
        found += wrong[i]
    return found


@compiled
def settle(
    state: SquareStates,
    settled_by: Numbers,
    where: Ints,
    weight: Numbers,
    low: Numbers,
    high: Numbers,
    fresh: NDArray[np.bool_],
    impression: int,
) -> None:
    """Settle in place all squares that the counts settle, by single fields and by pairs of fields."""
    verdicts, newly_settled = np.zeros(where.size, np.int8), np.zeros(len(state), np.bool_)
    for _ in range(MAX_ROUNDS):
        changed = False
        while _settle_by_single_fields(
            state, settled_by, where, weight, low, high, verdicts, newly_settled, impression
        ):
            changed = True
        if changed:
            continue
        for i in range(where.shape[0]):
            for k in range(where.shape[1]):
                fresh[i] = fresh[i] or (weight[i, k] > 0 and newly_settled[where[i, k]])
        newly_settled[:] = False
        if not _settle_by_pairs(state, settled_by, where, weight, low, high, fresh, newly_settled, impression):
            return


@compiled
def _settle_by_single_fields(
    state: SquareStates,
    settled_by: Numbers,
    where: Ints,
    weight: Numbers,
    low: Numbers,
    high: Numbers,
    verdicts: SquareStates,
    newly_settled: NDArray[np.bool_],
    impression: int,
) -> bool:
    """Settle squares by single fields, and return whether any was settled."""
    fields, entries = where.shape
    found = False
    for i in range(fields):
        occupied, open_weight = _weights(state, where, weight, i)
        low_left, high_left = max(low[i] - occupied, 0), min(high[i] - occupied, open_weight)
        for k in range(entries):
            verdict = OPEN
            if weight[i, k] > 0 and state[where[i, k]] == OPEN:
                if weight[i, k] > high_left:
                    verdict = FREE
                elif weight[i, k] > open_weight - low_left:
                    verdict = OCCUPIED
                found = found or verdict != OPEN
            verdicts[i * entries + k] = verdict
    if not found:
        return False
    for value in (FREE, OCCUPIED):  # if two fields contradict each other, the one that needs the square wins
        for i in range(fields):
            for k in range(entries):
                if verdicts[i * entries + k] == value:
                    state[where[i, k]] = value
                    settled_by[where[i, k]] = impression
                    newly_settled[where[i, k]] = True
    return True


@compiled
def _settle_by_pairs(
    state: SquareStates,
    settled_by: Numbers,
    where: Ints,
    weight: Numbers,
    low: Numbers,
    high: Numbers,
    fresh: NDArray[np.bool_],
    newly_settled: NDArray[np.bool_],
    impression: int,
) -> bool:
    """Settle what two fields do not share, from the difference of their counts."""
    fields, entries = where.shape
    open_weight, low_left, high_left = np.zeros((3, fields), np.int64)
    total = 0
    for i in range(fields):
        occupied, open_weight[i] = _weights(state, where, weight, i)
        heaviest = 0
        for k in range(entries):
            if state[where[i, k]] == OPEN:
                heaviest = max(heaviest, weight[i, k])
        low_left[i], high_left[i] = max(low[i] - occupied, 0), min(high[i] - occupied, open_weight[i])
        if heaviest != 1:
            open_weight[i] = 0
        total += open_weight[i]
    every = np.ones(fields, np.bool_)
    first, on = _fields_by_square(state, where, weight, open_weight, every, total)
    first_fresh, on_fresh = _fields_by_square(state, where, weight, open_weight, fresh, total)
    shared, within = np.zeros(fields, np.int64), np.full(len(state), -1, np.int64)
    neighbours, free, filled = (
        np.empty(fields, np.int64),
        np.zeros(len(state), np.bool_),
        np.zeros(len(state), np.bool_),
    )
    changed = False
    for a in range(fields):
        if open_weight[a] == 0:
            continue
        neighbour_count = 0
        begin, fields_on = (first, on) if fresh[a] else (first_fresh, on_fresh)
        for k in range(entries):
            square = where[a, k]
            if weight[a, k] > 0 and state[square] == OPEN:
                for at in range(begin[square], begin[square + 1]):
                    b = fields_on[at]
                    if shared[b] == 0:
                        neighbours[neighbour_count] = b
                        neighbour_count += 1
                    shared[b] += 1
        for n in range(neighbour_count):
            b = neighbours[n]
            common = shared[b]
            shared[b] = 0
            if a == b or open_weight[a] == common:
                continue
            none_occupied = high_left[a] - max(low_left[b] - (open_weight[b] - common), 0) <= 0
            all_occupied = low_left[a] - min(high_left[b], common) >= open_weight[a] - common
            if not none_occupied and not all_occupied:
                continue
            for k in range(entries):
                if weight[b, k] > 0:
                    within[where[b, k]] = a * fields + b
            for k in range(entries):
                square = where[a, k]
                if weight[a, k] > 0 and state[square] == OPEN and within[square] != a * fields + b:
                    free[square] = free[square] or none_occupied
                    filled[square] = filled[square] or all_occupied
                    changed = True
    fresh[:] = False
    if not changed:
        return False
    for square in range(len(state)):
        if free[square] or filled[square]:
            state[square] = FREE if free[square] else OCCUPIED
            settled_by[square] = impression
            newly_settled[square] = True
    return True


@compiled
def _fields_by_square(
    state: SquareStates, where: Ints, weight: Numbers, open_weight: Longs, chosen: NDArray[np.bool_], entries: int
) -> tuple[Longs, Longs]:
    """Return the chosen fields with open squares, by open square: those on square s are on[first[s]:first[s + 1]]."""
    first, on = np.zeros(len(state) + 2, np.int64), np.empty(entries, np.int64)
    for i in range(where.shape[0]):
        if chosen[i] and open_weight[i] > 0:
            for k in range(where.shape[1]):
                if weight[i, k] > 0 and state[where[i, k]] == OPEN:
                    first[where[i, k] + 2] += 1
    for square in range(len(state)):
        first[square + 2] += first[square + 1]
    for i in range(where.shape[0]):
        if chosen[i] and open_weight[i] > 0:
            for k in range(where.shape[1]):
                square = where[i, k]
                if weight[i, k] > 0 and state[square] == OPEN:
                    on[first[square + 1]] = i
                    first[square + 1] += 1
    return first, on
