"""The truth table of docs/asking.md is that of the queries."""

import re
from pathlib import Path

import pytest

from utak.kb.reasoning.query_worker import answer_query

PAGE = Path(__file__).resolve().parents[3] / "docs" / "asking.md"
ROWS = re.findall(r"^\| ([YN?]) \| ([YN?]) \| ([YN?]) \| ([YN?]) \| ([YN?]) \|$", PAGE.read_text(), re.MULTILINE)
# One statement of each truth value, of two things each: the second is of another predicate.
STATEMENTS = {"Y": ("room(r1)", "node(o1)"), "N": ("held(o1)", "room(r1), held(o1)"), "?": ("door(d1)", "bound(x,o1)")}
FACTS = [["room", "r1"], ["node", "o1"], ["unseen", "r1", 5], ["parameter", "x"]]
SIGNS = {"yes": "Y", "no": "N", "don't know": "?"}


def truth(query: str, *rules: str) -> str:
    return SIGNS[answer_query(FACTS, query, rules)["answer"]]


def test_the_table_is_whole() -> None:
    assert len(ROWS) == 9
    assert len({row[:2] for row in ROWS}) == 9


@pytest.mark.parametrize("row", ROWS, ids="".join)
def test_a_row_of_the_table(row: tuple[str, ...]) -> None:
    a, b = STATEMENTS[row[0]][0], STATEMENTS[row[1]][1]
    assert (truth(a), truth(b)) == row[:2]
    assert truth(f"{a}, {b}") == row[2]
    assert truth("either(1)", f"either(1) :- {a}.", f"either(1) :- {b}.") == row[3]
    assert truth(f"not {a}") == row[4]
