"""JSON values come back from short texts."""

import string
from typing import Any

from hypothesis import given
from hypothesis import strategies as st

from simulator.replay.packed.short_texts import short_text, values_of

VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.text(),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=4), inner, max_size=4),
    max_leaves=12,
)


@given(st.lists(VALUES, min_size=1, max_size=4))
def test_values_come_back(values: list[Any]) -> None:
    text = short_text(values)
    assert values_of(text) == values
    assert not set(text) & set("<>&`\"'" + string.whitespace)


def test_what_stood_long_before_is_found_again() -> None:
    far = [f"fact({number * number % 100_003})." for number in range(20_000)]
    assert len(short_text([far, far])) < len(short_text([far])) + 300
