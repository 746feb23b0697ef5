"""Assumptions are facts or rules that count where an encoding knows them, else for queries alone."""

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from utak.kb.language.diagnostics import BadInputError
from utak.kb.reasoning.assumptions import canonical_facts, read_assumptions
from utak.kb.reasoning.user_rules import read_tested_rules

# By the fact: the rule that states it, the facts that queries see besides, and the encodings that it reaches.
REACH = {
    "shape(o1, square, 90)": ("shape(o1,square,90).", (), ("shapes",)),
    "bound(x, o2).": ("bind(x,o2) :- wanted(x), candidate(o2,_).", (), ("reconciliation",)),
    "colour(o1, r, 99).": ("has(o1,colour,r,99) :- candidate(o1,_).", ("colour(o1,r,99).",), ("reconciliation",)),
    "shape(o1, square)": ("shape(o1,square,100).", (), ("shapes",)),
    "colour(o1, r).": ("has(o1,colour,r,100) :- candidate(o1,_).", ("colour(o1,r,100).",), ("reconciliation",)),
    "movable(o1, 0).": ("movable(o1,0).", (), ("movable",)),
    "movable(o1, 90).": ("movable(o1,90).", (), ("movable",)),
    "door(d9).": ("", ("door(d9).",), ()),
    "door(d9, 80).": ("", ("door(d9,80).",), ()),
    "in(utak, r2).": ("", ("in(org,r2).",), ()),
    "adjacent(utak, o1, 40).": ("", ("adjacent(org,o1,40).",), ()),
    "adjacent(o1, utak).": ("", ("adjacent(o1,org).",), ()),
    "kind(utak, utak, 100).": ("", ("kind(org,utak,100).",), ()),
    "kind(o1, verge, 90).": ("", ("kind(o1,verge,90).",), ()),
    "kind(part3, verge, 90).": ("kind(part3,verge,90) :- region(part3,_,_).", (), ("interpretation",)),
}


@pytest.mark.parametrize("text", REACH)
def test_where_a_fact_counts(text: str) -> None:
    (one,) = read_assumptions(text)
    assert (one.rule, one.facts, one.reaches) == REACH[text]


def test_rules_and_facts_of_own_predicates(tmp_path: Path) -> None:
    (one,) = read_assumptions("kind(R, verge, 60) :- region(R, nonzero, _),\n extent(R, N), N > 20.")
    assert one.written == "kind(R, verge, 60) :- region(R, nonzero, _), extent(R, N), N > 20."
    assert one.reaches == ("interpretation",)
    rules = tmp_path / "rules.lp"
    rules.write_text("#defined strange/1.\nkind(R, verge, 60) :- region(R, _, _), strange(R).\n")
    with pytest.raises(BadInputError, match="unknown predicate strange/1"):
        read_assumptions("strange(part3).")
    (one,) = read_assumptions("strange(part3).", [str(rules)])
    assert (one.rule, one.reaches) == ("strange(part3).", ("interpretation",))
    assert len(read_assumptions("door(d1). shape(o1, square, 90).")) == 2


def test_the_place_is_that_of_the_text() -> None:
    for text, place in {
        "door(d1). shape(o1, sqare, 90).": "assume:1:21-25",
        "door(d1).\n  in(o1, here).": "assume:2:10-13",
        "shape(o1, square, 5000000000).": "assume:1:19-28",
    }.items():
        with pytest.raises(BadInputError, match=f"^{place}: error: "):
            read_assumptions(text)


def test_rules_that_never_end_in_queries_are_refused(tmp_path: Path) -> None:
    from utak.kb.reasoning.user_rules import RuleLimits

    path = tmp_path / "rules.lp"
    path.write_text("p :- X = 1..100000000, X < 0.\n")
    with pytest.raises(BadInputError, match=r"given up: it took more than 0\.3 seconds"):
        read_tested_rules([path], RuleLimits(seconds=0.3))


def test_reading_a_large_file_keeps_to_the_limit_of_time(tmp_path: Path) -> None:
    from utak.kb.reasoning.user_rules import RuleLimits

    path = tmp_path / "rules.lp"
    path.write_text("p(" + "1," * 300_000 + "1).\n")
    with pytest.raises(BadInputError, match=r"given up: it took more than 0\.1 seconds to read them"):
        read_tested_rules([path], RuleLimits(seconds=0.1))


def test_facts_are_written_as_the_world_model_writes_them() -> None:
    assert canonical_facts("in( utak , r1 ). node(o1)", "since") == ("in(org,r1).", "node(o1).")


@settings(max_examples=60, deadline=None)
@given(st.text(alphabet='abXo1rd(),.:-#{} "%\n_u', max_size=25))
def test_any_text_is_read_or_refused(text: str) -> None:
    try:
        assert read_assumptions(text)
    except BadInputError as bad:
        assert all(problem.file == "assume" for problem in bad.problems)
