"""Values of which bounds are known: what is said of them is so of every number that they can be."""

import operator
from itertools import product

from clingo import Function, Number
from hypothesis import given, settings
from hypothesis import strategies as st

from utak.kb.reasoning.query_worker import answer_query
from utak.kb.three_valued.arithmetic import calculate
from utak.kb.three_valued.values import (
    MIRRORED_SIGNS,
    NEW,
    NO_NUMBER,
    Value,
    aggregate,
    calculate_uncertain,
    compare,
    from_clingo,
    narrow,
    numbers,
    to_clingo,
)

OPERATORS = {
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
    "=": operator.eq,
    "!=": operator.ne,
}
NO_NAMES: frozenset[str] = frozenset()
signs = st.sampled_from(sorted(OPERATORS))
unknown = st.builds(
    lambda low, size: from_clingo(to_clingo(numbers(low, low + size))), st.integers(-6, 6), st.integers(0, 5)
)
intervals = st.builds(
    lambda low, size: from_clingo(Function("range__", [Number(low), Number(low + size)])),
    st.integers(-6, 6),
    st.integers(-1, 5),
)


def all_of(value: Value) -> range:
    low, high = value.ends
    return range(low, high + 1)


@given(signs, unknown, unknown)
def test_a_comparison_is_known_when_all_numbers_agree(sign: str, a: Value, b: Value) -> None:
    truths = {OPERATORS[sign](p, q) for p, q in product(all_of(a), all_of(b))}
    assert compare(sign, a, b, NO_NAMES) == (truths.pop() if len(truths) == 1 else None)
    assert compare(MIRRORED_SIGNS[sign], b, a, NO_NAMES) == compare(sign, a, b, NO_NAMES)


@given(signs, st.integers(-8, 8), intervals)
def test_an_interval_compares_as_some_of_its_numbers_does(sign: str, number: int, some: Value) -> None:
    expected = any(OPERATORS[sign](number, one) for one in all_of(some))
    assert compare(sign, from_clingo(Number(number)), some, NO_NAMES) is expected


@given(signs, unknown, intervals)
def test_what_is_said_of_an_unknown_number_and_an_interval_is_so(sign: str, value: Value, some: Value) -> None:
    truths = {any(OPERATORS[sign](number, one) for one in all_of(some)) for number in all_of(value)}
    found = compare(sign, value, some, NO_NAMES)
    assert found is None or truths == {found}


@given(signs, unknown, unknown)
def test_a_narrowed_value_keeps_all_with_which_a_comparison_holds(sign: str, a: Value, b: Value) -> None:
    left = {p for p, q in product(all_of(a), all_of(b)) if OPERATORS[sign](p, q)}
    assert left <= set(all_of(narrow(a, sign, b))) <= set(all_of(a))


@given(st.sampled_from(["+", "-", "*", "\\", "&"]), unknown, unknown.filter(lambda value: 0 not in all_of(value)))
def test_a_calculation_has_the_bounds_of_its_results(sign: str, a: Value, b: Value) -> None:
    results = {calculate(sign, p, q) for p, q in product(all_of(a), all_of(b))}
    low, high = calculate_uncertain(sign, a, b).ends
    assert low <= min(results) and max(results) <= high
    assert sign not in "+-*" or (low, high) == (min(results), max(results))


elements = st.lists(st.tuples(st.integers(-3, 3), st.booleans()), max_size=5, unique_by=lambda one: one[0])


@settings(max_examples=60)
@given(st.sampled_from(["#count", "#sum", "#sum+", "#min", "#max"]), elements)
def test_an_aggregate_has_the_bounds_of_all_ways_to_count(function: str, found: list[tuple[int, bool]]) -> None:
    tuples = [((from_clingo(Number(number)),), is_certain) for number, is_certain in found]
    whole = aggregate(function, tuples)
    ways = product(*([True] if is_certain else [True, False] for _, is_certain in found))
    each = [
        aggregate(function, [(values, True) for (values, _), counts in zip(tuples, way, strict=True) if counts])
        for way in ways
    ]
    assert whole.low == min(one.low for one in each) and whole.high == max(one.high for one in each)


def test_a_new_thing_is_none_of_those_that_are_known() -> None:
    names = frozenset({"o1"})
    o1, o9 = from_clingo(Function("o1")), from_clingo(Function("o9"))
    assert compare("=", NEW, o1, names) is False and compare("!=", NEW, o1, names) is True
    assert compare("=", NEW, o9, names) is None and compare("=", NO_NUMBER, o1, names) is None
    assert compare("=", NO_NUMBER, from_clingo(Number(2**31 - 1)), names) is False


def test_a_long_interval_is_enumerated_once() -> None:
    found = answer_query([["room", "r1"]], "room(R), X = 1..9000")
    assert len(found["rows"]) == 9000
