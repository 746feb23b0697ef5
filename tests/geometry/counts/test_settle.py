"""The kernels that settle squares against the same rules written down simply."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from utak.geometry.counts.settle import FREE, OCCUPIED, OPEN, misfits, remaining_counts, settle

SQUARE_COUNT, MAX_FIELD_SQUARES = 12, 6


def settled_by_rules(state, where, weight, low, high):
    """Return the states of all squares, settled by the rules one after another until none settles any more."""
    state = dict(enumerate(state))
    while True:
        settled = {}
        remaining = []
        for squares, weights, least, most in zip(where, weight, low, high, strict=True):
            open_ = {s: w for s, w in zip(squares, weights, strict=True) if w and state[s] == OPEN}
            full = sum(w for s, w in zip(squares, weights, strict=True) if state[s] == OCCUPIED)
            room = sum(open_.values())
            remaining.append((open_, max(least - full, 0), min(most - full, room)))
        for value in (FREE, OCCUPIED):
            for open_, least, most in remaining:
                room = sum(open_.values())
                free = {s for s, w in open_.items() if w > most}
                full = {s for s, w in open_.items() if w > room - least} - free
                settled |= dict.fromkeys(free if value == FREE else full, value)
        if not settled:
            single_weight = [one for one in remaining if one[0] and max(one[0].values()) == 1]
            pairs = [(a, b) for a in single_weight for b in single_weight if a is not b and a[0].keys() & b[0].keys()]
            for value in (OCCUPIED, FREE):
                for (one, least, most), (two, fewest, greatest) in pairs:
                    only, common = one.keys() - two.keys(), len(one.keys() & two.keys())
                    none_occupied = most - max(fewest - (len(two) - common), 0) <= 0
                    all_occupied = least - min(greatest, common) >= len(only)
                    if only and (none_occupied if value == FREE else all_occupied):
                        settled |= dict.fromkeys(only, value)
        if not settled:
            return [state[s] for s in range(SQUARE_COUNT)]
        state |= settled


@st.composite
def fields(draw):
    """Draw some fields over a few squares, each of single or double squares, with counts that one truth allows."""
    truth = draw(st.lists(st.booleans(), min_size=SQUARE_COUNT, max_size=SQUARE_COUNT))
    chosen = draw(
        st.lists(
            st.sets(st.integers(0, SQUARE_COUNT - 1), min_size=1, max_size=MAX_FIELD_SQUARES), min_size=1, max_size=9
        )
    )
    where, weight = (
        np.zeros((len(chosen), MAX_FIELD_SQUARES), np.int32),
        np.zeros((len(chosen), MAX_FIELD_SQUARES), np.int16),
    )
    low, high = np.zeros((2, len(chosen)), np.int16)
    for n, squares in enumerate(chosen):
        where[n, : len(squares)] = sorted(squares)
        weight[n, : len(squares)] = draw(st.sampled_from([1, 1, 1, 2]))
        count = int((np.array(truth)[where[n]] * weight[n]).sum())
        low[n], high[n] = count - draw(st.integers(0, 1)), count + draw(st.integers(0, 1))
    return where, weight, low, high


@pytest.mark.long
@settings(max_examples=150, deadline=None)
@given(fields(), st.data())
def test_fields_added_in_turn_settle_the_same_squares_as_all_at_once(given_, data) -> None:
    where, weight, low, high = given_
    state, by = np.full(SQUARE_COUNT, OPEN, np.int8), np.full(SQUARE_COUNT, -1, np.int16)
    fresh = np.zeros(len(low), np.bool_)
    cuts = sorted({data.draw(st.integers(1, len(low))), len(low)})
    for number, (start, stop) in enumerate(zip([0, *cuts], cuts, strict=False)):
        fresh[start:stop] = True
        settle(state, by, where[:stop], weight[:stop], low[:stop], high[:stop], fresh[:stop], number)
    wanted = settled_by_rules([OPEN] * SQUARE_COUNT, where.tolist(), weight.tolist(), low.tolist(), high.tolist())
    assert state.tolist() == wanted
    assert (by >= 0).tolist() == [one != OPEN for one in wanted]
    assert not fresh.any()


@settings(max_examples=50, deadline=None)
@given(fields(), st.lists(st.sampled_from([OPEN, FREE, OCCUPIED]), min_size=SQUARE_COUNT, max_size=SQUARE_COUNT))
def test_remaining_counts_and_contradicted_fields(given_, states) -> None:
    where, weight, low, high = given_
    state, wrong = np.array(states, np.int8), np.zeros(len(low), np.bool_)
    found = misfits(state, where, weight, low, high, wrong)
    open_, room, least, most = remaining_counts(state, where, weight, low, high)
    full = np.where(state[where] == OCCUPIED, weight, 0).sum(1)
    assert (open_ == ((state[where] == OPEN) & (weight > 0))).all()
    assert (room == (weight * open_).sum(1)).all()
    assert (least == np.maximum(low - full, 0)).all()
    assert (most == np.minimum(high - full, room)).all()
    assert (wrong == ((full > high) | (full + room < low))).all()
    assert found == wrong.sum()
