"""Questions to the world model: bindings, yes, no, don't know; and a worker that no query can hang or kill for good."""

import time
from collections.abc import Iterator
from contextlib import suppress

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kb.problems import BadInputError
from kb.query import Answer, QueryEngine, QueryLimitError

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
}


@pytest.mark.parametrize("query", ANSWERS)
def test_one_word_answers(engine: QueryEngine, query: str) -> None:
    assert engine.ask(FACTS, query).kind == ANSWERS[query]


UNSEEN = {
    "shape(X, disc, C)": "don't know",  # it may be where nothing was seen
    "object(o9)": "don't know",
    "in(o2, r1)": "no",  # o2 was seen, and not there
    "shape(o1, square, 100)": "yes",
}


@pytest.mark.parametrize("query", UNSEEN)
def test_what_is_unseen_leaves_doubts(engine: QueryEngine, query: str) -> None:
    assert engine.ask([*FACTS, "unseen(r1,40)."], query).kind == UNSEEN[query]
    assert engine.ask([*FACTS, "unseen(r1,0)."], query).kind != "don't know"


BAD = {
    "": "the query is empty",
    "shpe(X, Y, Z)": "did you mean shape?",
    "shape(X, square)": "there is shape/3",
    "shape(X": "query:1:1-7: error: syntax error",
    "object(X). object(Y)": "without a full stop",
    "object(X) :- node(X)": "syntax error",
    "not object(X)": "nothing says what X can be",
    'object(X). #include "/etc/passwd".': "error",
    "#script (python) import os #end": "syntax error",
    "X = @f()": "operation undefined",
    "object(\u201cx\u201d)": "typographic",
    "object(X) % and\nmore": "one line",
    "a" * 20_000: "at most 10000 characters",
}


@pytest.mark.parametrize("query", BAD)
def test_what_is_no_query_is_refused(engine: QueryEngine, query: str) -> None:
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
    start = time.monotonic()
    with pytest.raises(QueryLimitError):
        engine.ask(FACTS, query)
    assert time.monotonic() - start < 5
    assert engine.ask(FACTS, "node(o1)") == Answer("yes")


def test_a_worker_that_dies_is_replaced(engine: QueryEngine) -> None:
    engine.ask(FACTS, "node(o1)")
    assert engine._worker._process is not None
    engine._worker._process.kill()
    with pytest.raises(QueryLimitError, match="process"):
        engine.ask(FACTS, "node(o1)")
    assert engine.ask(FACTS, "node(o1)").kind == "yes"


def test_facts_that_are_none_are_refused(engine: QueryEngine) -> None:
    with pytest.raises(BadInputError):
        engine.ask(["node(X) :- kind(X,object,C)."], "node(X)")


@settings(max_examples=60, deadline=None)
@given(st.text(alphabet="objectXYnode(),:-.#{}=1 \"'@|&", max_size=25))
def test_any_text_is_answered_or_refused(engine: QueryEngine, text: str) -> None:
    with suppress(BadInputError, QueryLimitError):
        engine.ask(FACTS, text)
