"""Differences between JSON values lead from one value to the other one."""

import json
from typing import Any

from hypothesis import given
from hypothesis import strategies as st

from simulator.replay.packed.delta import SAME, difference, patched
from simulator.replay.packed.packing import slim

SCALARS = st.none() | st.booleans() | st.integers(-3, 3) | st.floats(-2, 2) | st.text("ab0", max_size=3)
VALUES = st.recursive(
    SCALARS.map(slim),
    lambda inner: st.lists(inner, max_size=6) | st.dictionaries(st.sampled_from("abc"), inner),
    max_leaves=20,
)


@given(VALUES, VALUES)
def test_a_difference_leads_to_the_new_value(old: Any, new: Any) -> None:
    before = json.dumps(old)
    assert json.dumps(patched(old, difference(old, new)), sort_keys=True) == json.dumps(new, sort_keys=True)
    assert json.dumps(old) == before


@given(VALUES)
def test_equal_values_have_no_difference(value: Any) -> None:
    assert difference(value, json.loads(json.dumps(value))) == SAME


@given(st.lists(st.integers(0, 5), min_size=1), st.lists(st.integers(0, 5), min_size=1))
def test_edits_of_lists(old: list[int], new: list[int]) -> None:
    assert patched(old, difference(old, new)) == new


def test_one_more_item_is_a_short_difference() -> None:
    old = [f"fact({number})." for number in range(1000)]
    new = [*old[:500], "fact(new).", *old[500:]]
    assert difference(old, new) == [500, ["fact(new)."]]
    assert len(json.dumps(difference(old, [*old[:100], *old[103:]]))) < 20


def test_large_lists_that_have_nothing_in_common_are_replaced_without_a_search() -> None:
    old, new = [f"a{n}" for n in range(3000)], [f"b{n}" for n in range(3000)]
    assert difference(old, new) == [-3000, new]
