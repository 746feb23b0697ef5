"""The reader of fact files: accepted texts, and the place and message of every error."""

import os
import time
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from utak.kb.language.diagnostics import BadInputError, CannotOpenError
from utak.kb.language.reader import facts_from_text, read_facts
from utak.kb.language.terms import Number, Symbol, Text

GIVEN_UP = (
    60.0  # seconds of processor time: many times what linear reading takes, far less than quadratic reading would take
)


def problems(text: str) -> list[str]:
    """Return the problems of a text, each as `line:col-col: what`."""
    with pytest.raises(BadInputError) as caught:
        facts_from_text(text)
    return [f"{p.span.line}:{p.span.start}-{p.span.end}: {p.what}" for p in caught.value.problems]


def test_terms_of_every_kind() -> None:
    (fact,) = facts_from_text('p(-7, "a \\"b\\" \\\\ \\n", x, f(g(y), 2147483647), _z\').')
    number, text, name, compound, last = fact.args
    assert isinstance(number, Number)
    assert number.value == -7
    assert isinstance(text, Text)
    assert text.value == 'a "b" \\ \n'
    assert isinstance(name, Symbol)
    assert str(compound) == "f(g(y),2147483647)"
    assert str(last) == "_z'"


def test_comments_and_line_ends() -> None:
    text = "% one\r\na. %* two %* nested\n*% still *% b(\n1 ,2\t).\n%"
    assert [str(f) for f in facts_from_text(text)] == ["a", "b(1,2)"]


def test_spans_count_from_one_in_characters() -> None:
    (fact,) = facts_from_text("\n  object( x ).")
    assert fact.span == (2, 3, 13)
    assert fact.args[0].span == (2, 11, 11)


def test_the_place_of_a_term_does_not_count_for_equality() -> None:
    one, other = facts_from_text("p(x,1).\n   p( x, 1 ).")
    assert one == other
    assert hash(one) == hash(other)


REFUSED = {
    "a :- b.": "1:3-4: a rule",
    ":- b.": "1:1-2: a constraint",
    '#include "x".': "1:1-8: #include is a directive",
    "#script (python) x #end.": "1:1-7: #script is a directive",
    "p(X).": "1:3-3: X is a variable",
    "p(_).": "1:3-3: _ is a variable",
    "P(x).": "1:1-1: a fact cannot begin with the variable P",
    "p(99999999999).": "1:3-13: a number beyond 32 bits",
    "p(-2147483649).": "1:3-13: a number beyond 32 bits",
    "p(1..3).": "1:4-5: ..: intervals, pools and sums",
    "p(1;2).": "1:4-4: ;: intervals, pools and sums",
    "p(1.5).": "1:3-3: a number with a fraction",
    "-p(x).": "1:1-1: a negated fact",
    "not p(x).": "1:5-5: a negated fact",
    "{p}.": "1:1-1: a choice",
    "p(x), q(x).": "1:5-5: one fact at a time, and no , after it",
    "p(x)": "1:4-4: a full stop was expected",
    "p(x, ).": "1:6-6: an argument is missing",
    "p().": "1:3-3: an argument is missing",
    'p("abc).': "1:3-8: this string is not closed",
    'p("a\\q").': "1:3-7: unknown escape",
    "%* p(x).": "1:1-2: this comment is never closed",
    "p((x,y)).": "1:3-3: a term was expected",
    "7.": "1:1-1: a fact was expected",
    "p(-x).": "1:4-4: a minus sign",
    "p(@f(1)).": "1:3-3: a term was expected",
    "\ufeffp(x).": "1:1-1: the file begins with a UTF-8 byte order mark",
    "p(\u201cx\u201d).": "1:3-3: a typographic quotation mark (U+201C)",
    "p(gr\xf6\xdfe).": "1:5-5: a character that is not ASCII (U+00F6)",
    "p(x).\u00a0": "1:6-6: a space that is no plain space (U+00A0)",
    "p(\0).": "1:3-3: a control character (0x00)",
}


@pytest.mark.parametrize("text", REFUSED)
def test_an_invalid_fact_is_refused_at_its_place(text: str) -> None:
    assert problems(text)[0].startswith(REFUSED[text])


def test_nesting_has_a_limit() -> None:
    assert len(facts_from_text("p(" * 64 + "x" + ")" * 64 + ".")) == 1
    assert "nested more than 64 deep" in problems("p(" * 66 + "x" + ")" * 66 + ".")[0]
    assert "nested more than 64 deep" in problems("p(" * 100_000)[0]


def test_one_bad_fact_does_not_hide_the_next() -> None:
    found = problems("a(X).\nb(1..2).\nc(x).\nd(Y). e(1. f(Z).\ng(1.5). h(U)")
    assert [p.partition("-")[0] for p in found] == ["1:3", "2:4", "4:3", "4:10", "4:14", "5:3", "5:11"]


def test_a_message_shows_line_caret_and_hint(tmp_path: Path) -> None:
    path = tmp_path / "start.lp"
    path.write_text("object(x).\nshape(x, Square).\n")
    with pytest.raises(BadInputError) as caught:
        read_facts(path)
    assert str(caught.value) == (
        f"{path}:2:10-15: error: Square is a variable; facts have none\n"
        "  shape(x, Square).\n"
        "           ^^^^^^\n"
        '  hint: write square, or "Square" for a text'
    )


def test_at_most_twenty_problems_are_shown() -> None:
    with pytest.raises(BadInputError) as caught:
        facts_from_text("p(X).\n" * 25)
    assert str(caught.value).count("error:") == 20
    assert str(caught.value).endswith("... and more")


@pytest.mark.long
@pytest.mark.parametrize("text", ["p(X).\n", "(", "\u00e9", "p(", '"', "a.", '"a\\\\"', "%*", "\n", "p(x,"])
def test_the_time_to_read_grows_linearly(text: str) -> None:
    start = time.process_time()
    with pytest.raises(BadInputError) as caught:
        facts_from_text(text * (1_000_000 // len(text)) + "X")
    assert len(caught.value.problems) <= 101
    assert time.process_time() - start < GIVEN_UP


def test_a_long_string_is_read_fast() -> None:
    start = time.process_time()
    (fact,) = facts_from_text('p("' + "1 2, " * 200_000 + '\\n").')
    assert isinstance(fact.args[0], Text)
    assert fact.args[0].value.endswith("2, \n")
    assert time.process_time() - start < GIVEN_UP


def test_a_utf16_file_is_refused_with_the_encoding_named(tmp_path: Path) -> None:
    path = tmp_path / "start.lp"
    path.write_bytes("object(x).".encode("utf-16"))
    with pytest.raises(BadInputError, match="begins with UTF-16"):
        read_facts(path)


def test_a_file_that_cannot_be_opened_is_refused(tmp_path: Path) -> None:
    fifo = tmp_path / "fifo.lp"
    os.mkfifo(fifo)
    for path, why in [(fifo, "no regular file"), (tmp_path, "directory"), (tmp_path / "none.lp", "No such file")]:
        with pytest.raises(CannotOpenError, match=why):
            read_facts(path)
    with pytest.raises(CannotOpenError):
        read_facts("a\0b")


def test_a_huge_file_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "huge.lp"
    with path.open("wb") as stream:
        stream.truncate(3_000_000_000)
    with pytest.raises(BadInputError, match="larger than"):
        read_facts(path)


names = st.from_regex(r"\A[a-z][A-Za-z0-9_]{0,6}\Z")
terms = st.recursive(
    st.integers(-(2**31), 2**31 - 1).map(str) | names | st.from_regex(r'\A"[ -!#-\[\]-~]{0,9}"\Z'),
    lambda inner: st.builds(lambda n, a: f"{n}({','.join(a)})", names, st.lists(inner, min_size=1, max_size=3)),
    max_leaves=8,
)


@given(st.lists(st.builds(lambda n, a: f"{n}({','.join(a)})", names, st.lists(terms, min_size=1, max_size=3))))
def test_written_facts_are_read_back_equal(facts: list[str]) -> None:
    text = "\n".join(f"{fact}." for fact in facts)
    assert [str(fact) for fact in facts_from_text(text)] == facts


@given(st.text())
def test_any_text_is_read_or_refused(text: str) -> None:
    try:
        facts_from_text(text)
    except BadInputError as bad:
        assert bad.problems
        assert all(p.span.line >= 1 and 1 <= p.span.start <= p.span.end for p in bad.problems)
