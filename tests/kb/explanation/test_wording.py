"""Comparisons in words: brackets stay where they are needed, and strings stay as they are."""

import pytest
from clingo.ast import ASTType, parse_string

from kb.explanation.wording import comparison_claim, comparison_words
from kb.tracing.instrument import literal_info

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
