"""Comparisons in words: brackets stay where they are needed, and strings stay as they are."""

import pytest
from clingo.ast import ASTType, parse_string

from utak.kb.explanation.wording import absent_words, comparison_claim, comparison_words
from utak.kb.reasoning.sentences import PredicateWords
from utak.kb.tracing.instrument import literal_info

VALUES = {"D": "-286", "E": "1650", "N": "-950", "X": "a", "K": "3"}


def info_of(comparison: str) -> dict[str, object]:
    """What an explanation knows of a comparison."""
    found: list[object] = []
    parse_string(f"a :- {comparison}.", lambda node: found.append(node) if node.ast_type == ASTType.Rule else None)
    return literal_info(found[0].body[0])  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("comparison", "claim"),
    [
        ("D = (E*E)/(N*10)", "-286 = (1650*1650)/(-950*10)"),
        ("D = E/(K*2)", "-286 = 1650/(3*2)"),
        ("D = E*(K/2)", "-286 = 1650*(3/2)"),
        ("D = E+K*2", "-286 = 1650+3*2"),
        ("D = E-N", "-286 = 1650-(-950)"),
        ("D = N**2", "-286 = (-950)**2"),
        ("D = -(E/K)", "-286 = -(1650/3)"),
        ('X != "X"', 'a != "X"'),
    ],
)
def test_values_stand_where_variables_stood(comparison: str, claim: str) -> None:
    info = info_of(comparison)
    assert comparison_claim(info, ["-286", "-286"], VALUES) == claim


def test_words_leave_strings_alone() -> None:
    assert comparison_words(info_of('X != "X"'), ["a", '"X"'], VALUES) == 'a is not "X"'


def test_an_interval_is_told_by_its_ends() -> None:
    info = info_of("T = 0..(K-1)")
    assert comparison_words(info, ["0", "0..(3-1)"], {"T": "0", "K": "3"}) == "0 is one of 0 to 3-1"


def test_what_holds_for_nothing_is_told_of_all() -> None:
    words = {("came", 2): PredicateWords("came", ("A", "R"), "{A} came to {R}", "{A} is not known to have come to {R}")}
    assert absent_words("came(feel,any__)", words) == "for no R is it known that feel came to R"
    assert absent_words("came(feel,idle)", words) == "feel is not known to have come to idle"
