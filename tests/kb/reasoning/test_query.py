"""Queries to the world model: bindings, yes, no, don't know; and a worker that survives every query."""

import operator
import os
import signal
from collections.abc import Iterator
from contextlib import suppress

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from utak.kb.language.diagnostics import BadInputError
from utak.kb.reasoning.query import QueryAnswer, QueryEngine, QueryLimitError

FACTS = [
    "node(o1).",
    "node(o2).",
    "kind(o1,object,100).",
    "kind(o2,object,80).",
    "shape(o1,square,100).",
    "shape(o2,brick,60).",
    "shape(o2,l_shape,40).",
    "offset(o1,1200,-300).",
    "in(o1,r1).",
]


@pytest.fixture(scope="module")
def engine() -> Iterator[QueryEngine]:
    with QueryEngine(seconds=1.0) as running:
        yield running


def test_bindings_are_sorted_rows(engine: QueryEngine) -> None:
    answer = engine.ask(FACTS, "?- object(X), shape(X, S, C).")
    assert answer.variables == ("X", "S", "C")
    assert answer.rows == (("o1", "square", 100), ("o2", "brick", 60), ("o2", "l_shape", 40))
    assert str(answer) == "X   S        C\no1  square   100\no2  brick    60\no2  l_shape  40"


ANSWERS = {
    "shape(o1, square, 100)": "yes",
    "shape(o1, brick, 100)": "no",
    "shape(o2, brick, 100)": "don't know",
    "kind(o1, verge, 100)": "no",
    "shape(X, disc, C)": "no",
    "in(o2, r1)": "no",
    "held(o1)": "no",
    "#count{X : object(X)} = 2": "yes",
    "not in(o2, r1)": "yes",
    "node(X), not object(X)": "no",
    'object(o1), "50% \\" %* of all" != "b"': "yes",  # what stands in a string is no comment
}


@pytest.mark.parametrize("query", ANSWERS)
def test_queries_without_variables_have_the_answer_yes_no_or_dont_know(engine: QueryEngine, query: str) -> None:
    assert engine.ask(FACTS, query).kind == ANSWERS[query]


UNSEEN = {
    "shape(X, disc, C)": "don't know",  # a disc may stand in an unseen part
    "object(o9)": "don't know",
    "in(o2, r1)": "no",  # o2 was seen, in another room
    "shape(o1, square, 100)": "yes",
}


@pytest.mark.parametrize("query", UNSEEN)
def test_unseen_parts_give_the_answer_dont_know(engine: QueryEngine, query: str) -> None:
    assert engine.ask([*FACTS, "unseen(r1,40)."], query).kind == UNSEEN[query]
    assert engine.ask([*FACTS, "unseen(r1,0)."], query).kind != "don't know"


UTAK = ["node(org).", "kind(org,utak,100).", "in(org,r1).", "kind(o1,object,90)."]
CALLED = {
    "in(utak, R)": (("r1",),),
    "in(X, r1), X = utak": (("org",),),
    "X = utak, node(X)": (("org",),),
    'X = "utak"': (('"utak"',),),
    "kind(utak, K, C)": (("utak", 100),),
    "kind(X, utak, C)": (("org", 100),),
    "kind(X, K, C), K != utak": (("o1", "object", 90),),
    "N = #count{X : kind(X, K, C), K = utak, X = utak}": ((1,),),
}


@pytest.mark.parametrize("query", CALLED)
def test_utak_in_queries_means_org_except_as_a_kind(engine: QueryEngine, query: str) -> None:
    assert engine.ask(UTAK, query).rows == CALLED[query]


MISCALLED = {
    "node(utak), nod(utak)": "query:1:13-13: error: unknown predicate nod/1",
    "colour(utak, 3, X)": "query:1:14-14: error: a colour is a single lower-case letter, not 3",
    "utak(X)": "query:1:1-1: error: unknown predicate utak/1",
}


@pytest.mark.parametrize("query", MISCALLED)
def test_arithmetic_errors_have_their_place_in_the_query(engine: QueryEngine, query: str) -> None:
    with pytest.raises(BadInputError) as caught:
        engine.ask(UTAK, query)
    assert str(caught.value).startswith(MISCALLED[query]) and f"\n  {query}\n" in str(caught.value)


BAD = {
    "offset(o1, 4294967546, 50)": "query:1:12-21: error: a number beyond 32 bits",
    "X = 3000000000": "query:1:5-14: error: a number beyond 32 bits",
    "X = 0x80000000": "query:1:5-14: error: a number beyond 32 bits",
    "X = 5-2147483648": "query:1:7-16: error: a number beyond 32 bits",
    "X = 2147483647+1": "query:1:5-5: error: a number beyond 32 bits (-2147483648 to 2147483647), in 2147483647 + 1",
    "X = 65536*65536": "in 65536 * 65536",
    "X = 2**31": "in 2 ** 31",
    "X = 3**999999999": "in 3 ** 999999999",
    "X = -(-2147483648)": "a number beyond 32 bits",
    "offset(o1, E, N), X = E*E*E*E": "a number beyond 32 bits",
    "X = #sum{2147483647,a; 1,b}": "a number beyond 32 bits (-2147483648 to 2147483647), in #sum",
    "C = #max{D : shape(o1, T, E)}": "nothing says what D can be",
    "C = #max{D : shape(o1, T, D)} <= f(S)": "nothing says what S can be",
    "X = 5/0": "a division by zero",
    "X = o1+1": "operation undefined: o1 is no number",
    "-object(o1)": "query:1:1-1: error: classical negation is not known here",
    "not -object(o1)": "classical negation is not known here",
    "&diff{a} > 3": "theory atoms are not known here",
    "beside(o1, o2)": "beside belongs in start.lp or goal.lp",
    "kind(o2, banana, C)": "unknown constant banana, which is no kind",
    "kind(o2, objekt, C)": "did you mean object?",
    "kind(o2, K, C), K = banana": "unknown constant banana, which is no kind",
    "shape(o1, sqare, C)": "did you mean square?",
    "shape(banana, square, C)": "unknown constant banana, which is no thing",
    "shape(o1, square, high)": "a confidence must be an integer, not high",
    "shape(o1, square, 101)": "a confidence must be from 0 to 100, not 101",
    "corner(north, E, N)": "unknown constant north, which is no corner",
    "X = " + "-" * 5000 + "1": "it is nested too deep",
    "": "the query is empty",
    "shpe(X, Y, Z)": "did you mean shape?",
    "shape(square)": "there is shape/2, shape/3",
    "shape(X": "query:1:1-7: error: syntax error",
    "object(X). object(Y)": "without a full stop",
    "object(X) :- node(X)": "syntax error",
    "not object(X)": "nothing says what X can be",
    'object(X). #include "/etc/passwd".': "error",
    "#script (python) import os #end": "syntax error",
    "X = @f()": "operation undefined",
    "X = o1..5": "operation undefined: o1 is no number",
    "X > 3, X > 6": "nothing says what X can be",
    "shape(T, S, _) : object(T)": "nothing says what S can be",
    "object(\u201cx\u201d)": "typographic",
    "object(X) % and\nmore": "no comments",
    "object(X),\n  shpe(X, Y, Z)": "query:2:3-3: error: unknown predicate shpe/3",
    "object(X),\n\n (": "query:3:",
    "object(X),\n  X = 3000000000": "query:2:7-16: error: a number beyond 32 bits",
    "a" * 20_000: "at most 10000 characters",
}


NUMBERS = {
    "X = -2147483648": -2147483648,
    "X = 2147483647": 2147483647,
    "X = 65536*(-32768)": -2147483648,
    "X = 0x7fffffff": 2147483647,
    "X = -7/2": -3,
    "X = 7\\-2": 1,
    "X = 2**-1": 0,
    "X = (-1)**999999999": -1,
    "X = 5^3": 6,
    "X = ~5": -6,
    "X = |3-5|": 2,
    "offset(o1, X+200, N)": 1000,
    "offset(o1, 3*X, N)": 400,
    "offset(o1, E, -X), X > 0": 300,
    "X = #sum{2147483647,a; 1,b; -1,c}": 2147483647,
    "shape(o2, S, C), X = 100/(C-60), S != brick": -5,
    "3 < X, X < 5": 4,
}


@pytest.mark.parametrize("query", NUMBERS)
def test_arithmetic_is_exact(engine: QueryEngine, query: str) -> None:
    answer = engine.ask(FACTS, query)
    assert [row[answer.variables.index("X")] for row in answer.rows] == [NUMBERS[query]]


numbers = st.sampled_from([0, 1, -1, 2, 7, 46340, 46341, 65536, 2**31 - 1, -(2**31), 2**31, 2**32, 10**20])
signs = st.sampled_from(["+", "-", "*"])
PYTHON = {"+": operator.add, "-": operator.sub, "*": operator.mul}


@settings(max_examples=100, deadline=None)
@given(numbers, signs, numbers, signs, numbers)
def test_every_result_is_exact_or_refused(engine: QueryEngine, a: int, p: str, b: int, q: str, c: int) -> None:
    first = PYTHON[p](a, b)
    last = PYTHON[q](first, c)
    small = all(-(2**31) <= value < 2**31 for value in (a, b, c, first, last))
    text = f"X = (({a}) {p} ({b})) {q} ({c})"
    if small:
        assert engine.ask([], text).rows == ((last,),)
        return
    with pytest.raises(BadInputError, match="beyond 32 bits"):
        engine.ask([], text)


@pytest.mark.parametrize("query", BAD)
def test_invalid_queries_are_refused(engine: QueryEngine, query: str) -> None:
    with pytest.raises(BadInputError) as caught:
        engine.ask(FACTS, query)
    assert BAD[query] in str(caught.value)
    assert engine.ask(FACTS, "node(o1)").kind == "yes"


def test_an_unknown_predicate_is_underlined(engine: QueryEngine) -> None:
    with pytest.raises(BadInputError) as caught:
        engine.ask(FACTS, "object(X), shpe(X)")
    assert caught.value.problems[0].span == (1, 12, 12)


@pytest.mark.parametrize("query", ["X = 1..100000000", "X = 1..1000000, Y = 1..1000000"])
def test_a_runaway_query_is_given_up(engine: QueryEngine, query: str) -> None:
    with pytest.raises(QueryLimitError):
        engine.ask(FACTS, query)
    assert engine.ask(FACTS, "node(o1)") == QueryAnswer("yes")


def test_a_worker_that_dies_is_replaced(engine: QueryEngine) -> None:
    engine.ask(FACTS, "node(o1)")
    assert engine.process_id is not None
    os.kill(engine.process_id, signal.SIGKILL)
    try:
        engine.ask(FACTS, "node(o1)")  # its end may be noticed before it is asked
    except QueryLimitError as lost:
        assert "process" in str(lost)
    assert engine.ask(FACTS, "node(o1)").kind == "yes"


def test_invalid_facts_are_refused(engine: QueryEngine) -> None:
    with pytest.raises(BadInputError):
        engine.ask(["node(X) :- kind(X,object,C)."], "node(X)")


@settings(max_examples=60, deadline=None)
@given(st.text(alphabet="objectXYnode(),:-.#{}=1 \"'@|&", max_size=25))
def test_any_text_is_answered_or_refused(engine: QueryEngine, text: str) -> None:
    with suppress(BadInputError, QueryLimitError):
        engine.ask(FACTS, text)


BINDINGS = ["parameter(x).", "parameter(y).", "bound(x,o1).", *FACTS]
BOUND = {
    "bound(x, o1)": "yes",
    "bound(x, o2)": "no",  # x is known to mean o1
    "bound(y, o2)": "don't know",  # y means nothing yet
    "bound(P, o2)": "don't know",
    "not bound(y, o2)": "don't know",
    "not bound(x, o2)": "yes",
    "bound(z, o1)": "no",  # the task has no z
    "parameter(z)": "no",
    "bound(x, N), bound(y, N)": "don't know",
    "bound(x, N), not object(N)": "no",
}


@pytest.mark.parametrize("query", BOUND)
def test_what_an_unbound_parameter_means_is_not_known(engine: QueryEngine, query: str) -> None:
    for unseen in ("unseen(r1,0).", "unseen(r1,9)."):
        assert engine.ask([*BINDINGS, unseen], query).kind == BOUND[query]
    with pytest.raises(BadInputError, match="unknown constant floor, which is no object"):
        engine.ask(BINDINGS, "bound(x, floor)")


def test_bound_parameters_are_rows(engine: QueryEngine) -> None:
    answer = engine.ask(BINDINGS, "bound(P, N), shape(N, S, C)")
    assert answer.rows == (("x", "o1", "square", 100),)
    assert answer.types == ("parameter of the task", "thing", "shape", "a confidence")


def test_a_worker_holds_the_facts_of_the_last_query_alone(engine: QueryEngine) -> None:
    other = ["node(o7).", "kind(o7,object,90)."]
    for _ in range(3):
        assert engine.ask(FACTS, "object(X)").rows == (("o1",), ("o2",))
        assert engine.ask(other, "object(X)").rows == (("o7",),)
        engine.close()
        assert engine.ask(other, "object(X)").rows == (("o7",),)


def test_a_query_may_have_several_lines(engine: QueryEngine) -> None:
    assert engine.ask(FACTS, "?- object(X),\n   shape(X, brick, C).\n").rows == (("o2", 60),)
