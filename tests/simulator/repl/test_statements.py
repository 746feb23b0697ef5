"""Lines become statements: queries end at their full stop, commands at the end of a line."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from utak.simulator.repl.statements import (
    MAX_STATEMENT_CHARACTERS,
    StatementBuffer,
    is_query,
    query_end,
    without_comment,
)

COMMANDS = ["assume", "diff", "facts", "goal", "help", "quit", "run", "since", "step"]


def statements(*lines: str) -> list[str]:
    """Return the statements in some lines, the last one as it stands at their end."""
    buffer = StatementBuffer(COMMANDS)
    found = [one for line in lines for one in buffer.feed(line)]
    return found + buffer.finish()


@pytest.mark.parametrize(
    ("lines", "found"),
    [
        (["?- node(X)."], ["?- node(X)."]),
        (["?- node(X),", "   kind(X, object, C)."], ["?- node(X),\n   kind(X, object, C)."]),
        (["object(X),", "not held(X).", "step"], ["object(X),\nnot held(X).", "step"]),
        (["?- a(X). ?- b(X). help"], ["?- a(X).", "?- b(X).", "help"]),
        (["?- X = 1..3, a(X). % the end."], ["?- X = 1..3, a(X)."]),
        (['?- X = "a. b%c". run'], ['?- X = "a. b%c".', "run"]),
        (["?- a(X)", "?- b(X)"], ["?- a(X)", "?- b(X)"]),
        (["?- a(X)", "", "step"], ["?- a(X)", "step"]),
        (["?- a(X)", "step 2", "run"], ["?- a(X)", "step 2", "run"]),  # nothing is missing but the full stop
        (["?- a(X),", "help"], ["?- a(X),\nhelp"]),  # help may be meant as a part of the query
        (["step 3", "facts o1.", ";"], ["step 3", "facts o1.", ";"]),
        (["goal at(utak, x)", "run"], ["goal at(utak, x)", "run"]),
        (["goal(X)", "run"], ["goal(X)", "run"]),
        (["assume shape(o1,", "  square, 90).", "run"], ["assume shape(o1,\n  square, 90).", "run"]),
        (["assume p(X) :-", " node(X).", "run"], ["assume p(X) :-\n node(X).", "run"]),
        (["% a comment", "", "   ", "nonsense"], ["nonsense"]),
        (["#count{ X : object(X) } = N,", "N > 1."], ["#count{ X : object(X) } = N,\nN > 1."]),
    ],
)
def test_lines_and_their_statements(lines: list[str], found: list[str]) -> None:
    assert statements(*lines) == found


def test_a_statement_without_end_is_ended_at_some_length() -> None:
    buffer = StatementBuffer(COMMANDS)
    assert any(buffer.feed("a(X)," * 100) for _ in range(2 + MAX_STATEMENT_CHARACTERS // 500))


def test_what_was_begun_can_be_dropped() -> None:
    buffer = StatementBuffer(COMMANDS)
    assert buffer.feed("object(X),") == []
    assert buffer.is_open
    buffer.clear()
    assert not buffer.is_open
    assert buffer.feed("step") == ["step"]


@given(st.lists(st.text(alphabet='ab?-X(),.; \t"%\\sel', max_size=12), max_size=8))
def test_no_text_is_lost_or_invented(lines: list[str]) -> None:
    """The letters of all statements are those of the lines, without comments, in order."""
    buffer = StatementBuffer(COMMANDS)
    found = [one for line in lines for one in buffer.feed(line)] + buffer.finish()
    assert not buffer.is_open
    assert all(one.strip() for one in found)
    given_letters = "".join("".join(lines).split())
    rest = iter(given_letters)
    assert all(letter in rest for letter in "".join("".join(found).split()))


@given(st.text(max_size=30))
def test_ends_and_comments_of_any_text(text: str) -> None:
    assert text.startswith(without_comment(text).rstrip()[:1])
    end = query_end(text)
    assert end == -1 or text[end - 1] == "."
    is_query(text, COMMANDS)
