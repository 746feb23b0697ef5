"""Why atoms of users' rules do not hold in queries: the changes that are named do what is said of them."""

from collections.abc import Iterator
from itertools import combinations
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from utak.kb.explanation.programs import DecisionProgram, ExplanationError
from utak.kb.explanation.query_absence import explain_query_absence
from utak.kb.language.diagnostics import BadInputError
from utak.kb.reasoning.query import QueryEngine

RULES = """\
near(X, Y) :- object(X), object(Y), X != Y, offset(X, E1, N1), offset(Y, E2, N2), |E1-E2| + |N1-N2| < 900.
near_thing(X) :- near(X, _), not held(X).
lonely(X) :- object(X), not near_thing(X).
square_in_hand(X) :- held(X), shape(X, square, C), C > 80.
pair :- 2 <= #count { X : object(X) }.
linked(X, Y) :- near(X, Y).
linked(X, Z) :- linked(X, Y), near(Y, Z).
beyond(D) :- door(D), connects(D, r1, R), R != r1.
"""
WANTED = ["near_thing(o1)", "lonely(o1)", "square_in_hand(o1)", "pair", "linked(o1,o2)", "beyond(d1)", "near(o1,o2)"]
POOL = [
    "kind(o1,object,95)", "kind(o2,object,90)", "kind(o3,verge,99)", "offset(o1,100,200)", "offset(o2,300,400)",
    "held(o1)", "shape(o1,square,90)", "shape(o1,square,60)", "door(d1)", "connects(d1,r1,r2)", "room(r1)",
]  # fmt: skip


@pytest.fixture(autouse=True, scope="module")
def time_enough() -> Iterator[None]:
    """Give explanations so much time that none is given up on a busy machine."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(DecisionProgram.__init__, "__defaults__", ((), 120.0))
        yield


@pytest.fixture(scope="module")
def rules(tmp_path_factory: pytest.TempPathFactory) -> str:
    path = tmp_path_factory.mktemp("rules") / "rules.lp"
    path.write_text(RULES)
    return str(path)


@pytest.fixture(scope="module")
def engine(rules: str) -> Iterator[QueryEngine]:
    with QueryEngine(rules=[rules]) as engine:
        yield engine


def answered(engine: QueryEngine, facts: set[str], atom: str) -> str:
    """Return what queries answer to an atom."""
    return engine.ask([f"{fact}." for fact in sorted(facts)], atom).kind


@pytest.mark.long
@settings(max_examples=30, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.sets(st.sampled_from(POOL)), st.sampled_from(WANTED))
def test_a_change_makes_the_query_hold_and_no_smaller_part_of_it_does(
    rules: str, engine: QueryEngine, facts: set[str], atom: str
) -> None:
    """The oracle is the engine of queries: yes after the change, and not after any proper part of it."""
    before = answered(engine, facts, atom)
    if before == "yes":
        with pytest.raises(ExplanationError, match="certainly holds"):
            explain_query_absence(sorted(facts), atom, [rules])
        return
    found = explain_query_absence(sorted(facts), atom, [rules])
    said = "does not hold" if before == "no" else "is not known"
    assert said in found.sentence
    assert set(found.in_way) <= facts
    assert not facts & set(found.missing)
    change = [(fact, True) for fact in found.missing] + [(fact, False) for fact in found.in_way]
    for size in range(len(change) + 1):
        for part in combinations(change, size):
            added, gone = {fact for fact, new in part if new}, {fact for fact, new in part if not new}
            holds = answered(engine, (facts - gone) | added, atom) == "yes"
            assert holds == (found.found and size == len(change))
    if found.found:
        assert found.proof is not None
        assert found.proof.root.claim == atom
        assert all(fact in found.sentence for fact in (*found.missing, *found.in_way))


def test_what_is_believed_otherwise_is_named(rules: str) -> None:
    """A fact that would have to be another one is told with the one that is believed."""
    facts = ["held(o1)", "shape(o1,square,60)", "kind(o1,object,95)"]
    found = explain_query_absence(facts, "square_in_hand(o1)", [rules])
    assert found.in_way == ()
    (missing,) = found.missing
    assert missing.startswith("shape(o1,square,")
    assert "(believed is shape(o1,square,60))" in found.sentence


def test_what_is_in_the_way_is_named(rules: str) -> None:
    """A believed fact under a negation is in the way."""
    facts = ["kind(o1,object,95)", "kind(o2,object,90)", "offset(o1,100,200)", "offset(o2,300,400)", "held(o1)"]
    found = explain_query_absence(facts, "near_thing(o1)", [rules])
    assert (found.missing, found.in_way, found.partial) == ((), ("held(o1)",), False)


def test_rules_with_errors_and_texts_that_are_no_facts_are_refused(rules: str, tmp_path: Path) -> None:
    """Bad texts raise BadInputError."""
    with pytest.raises(BadInputError):
        explain_query_absence(["kind(o1"], "pair", [rules])
    wrong = tmp_path / "wrong.lp"
    wrong.write_text("near(X) :- objekt(X).\n")
    with pytest.raises(BadInputError):
        explain_query_absence(["kind(o1,object,95)"], "near(o1)", [str(wrong)])


def test_what_nothing_is_believed_of_yet_is_a_candidate(tmp_path: Path) -> None:
    rules = tmp_path / "rules.lp"
    rules.write_text("has_door :- door(D).\nround :- shape(X, disc, C), C > 50.\n")
    facts = ["node(o1)", "kind(o1,object,95)", "shape(o1,square,62)"]
    assert explain_query_absence(facts, "has_door", [str(rules)]).missing == ("door(d1)",)
    assert explain_query_absence(facts, "round", [str(rules)]).missing[0].startswith("shape(o1,disc,")
