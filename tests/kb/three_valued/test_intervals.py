"""Comparison of intervals: the deciding numbers give the same truth value as all numbers."""

from typing import Any

from hypothesis import given
from hypothesis import strategies as st

from utak.kb.reasoning.query_worker import answer_query
from utak.kb.three_valued.term_values import deciding_numbers
from utak.kb.three_valued.uncertain_values import COMPARISON_OPERATORS, Unknown, compare

ranges = st.builds(lambda low, size: range(low, low + size), st.integers(-6, 6), st.integers(0, 6))
bound = st.none() | st.integers(-6, 9)
unknown = st.builds(lambda low, high: [Unknown(low, high)], bound, bound).filter(
    lambda one: one[0].low is None or one[0].high is None or one[0].low <= one[0].high
)
numbers = st.builds(lambda number: [number], st.integers(-6, 9))


def truth(sign: str, firsts: Any, seconds: Any) -> Any:
    """Return whether a comparison holds for some pair."""
    truths = {compare(sign, a, b, frozenset()) for a in firsts for b in seconds}
    return True if True in truths else None if None in truths else False


@given(st.sampled_from(sorted(COMPARISON_OPERATORS)), ranges | numbers | unknown, ranges | numbers | unknown)
def test_deciding_numbers_compare_as_all_numbers_do(sign: str, firsts: Any, seconds: Any) -> None:
    few = truth(sign, list(deciding_numbers(firsts, seconds)), list(deciding_numbers(seconds, firsts)))
    assert few == truth(sign, firsts, seconds)


def test_a_long_interval_is_enumerated_once() -> None:
    found = answer_query([["room", "r1"]], "room(R), X = 1..9000")
    assert len(found["rows"]) == 9000
