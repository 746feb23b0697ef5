"""Short forms of facts with a confidence, and the two names of the robot, in queries and in users' rules."""

from pathlib import Path

import pytest

from utak.kb.language.vocabulary import BELIEF_PREDICATES
from utak.kb.reasoning.query import QueryEngine

FACTS = [
    "node(org).", "node(verge).", "kind(org,utak,100).", "kind(org,utak).",
    "kind(o1,object,100).", "kind(o1,object).", "kind(o2,object,80).",
    "shape(o1,square,90).", "shape(o1,disc,0).", "movable(o1,99).", "room(r1).", "room(r2).",
    "in(org,r1,100).", "in(org,r1).",
    "in(o1,r1,60).", "in(o1,r2,40).", "in(o2,r1,90).",
    "door(d1,100).", "door(d1).", "door(d2,30).", "connects(d1,r1,r2,100).",
    "connects(d1,r1,r2).", "width(d1,400).", "width(d1,400,608).", "corner(northeast,500,700,80).",
    "adjacent(org,o1,100).", "adjacent(org,o1).", "adjacent(o1,org,100).", "adjacent(o1,org).", "adjacent(o1,o2,40).",
    "adjacent(o2,o1,40).", "region(part1,zero,70).", "part_of(part1,floor).",
]  # fmt: skip
ANSWERS = {  # with something unseen, and with nothing
    "kind(o1, object)": ("yes", "yes"),
    "kind(o2, object)": ("don't know", "don't know"),
    "kind(o2, verge)": ("no", "no"),
    "shape(o1, square)": ("don't know", "don't know"),
    "shape(o1, disc)": ("no", "no"),
    "shape(o2, square)": ("don't know", "don't know"),  # nothing is said of its shape
    "colour(o1, g)": ("don't know", "don't know"),
    "movable(o1)": ("don't know", "don't know"),
    "movable(utak)": ("no", "no"),
    "door(d1)": ("yes", "yes"),
    "door(d2)": ("don't know", "don't know"),
    "door(d3)": ("don't know", "no"),
    "not door(d2)": ("don't know", "don't know"),
    "not door(d3)": ("don't know", "yes"),
    "connects(d1, r1, r2)": ("yes", "yes"),
    "connects(d2, r1, r2)": ("no", "no"),  # of a door that is known all is stated
    "in(utak, r1)": ("yes", "yes"),
    "in(org, r1)": ("yes", "yes"),
    "in(utak, r1, 100)": ("yes", "yes"),
    "in(utak, r2)": ("no", "no"),
    "in(o1, r1)": ("don't know", "don't know"),
    "in(o1, r2, 40)": ("yes", "yes"),
    "in(o1, r3)": ("no", "no"),  # 60 and 40 percent leave nothing for another room
    "in(o2, r1)": ("don't know", "don't know"),
    "in(o2, r2)": ("don't know", "don't know"),  # what is left of 100 percent
    "corner(northeast, 500, 700)": ("don't know", "don't know"),
    "corner(northwest, E, N)": ("no", "no"),
    "adjacent(utak, o1)": ("yes", "yes"),
    "adjacent(o1, utak)": ("yes", "yes"),
    "adjacent(o1, o2)": ("don't know", "don't know"),
    "adjacent(o2, o1)": ("don't know", "don't know"),
    "adjacent(utak, o2)": ("no", "no"),
    "adjacent(o2, utak)": ("no", "no"),
    "adjacent(o2, verge)": ("no", "no"),
    "adjacent(o9, o2)": ("don't know", "no"),
    "adjacent(o2, o9)": ("don't know", "no"),
    "adjacent(utak, o9)": ("no", "no"),
    "width(d1, L, M), M < 700": ("bindings", "bindings"),
    "width(d1, 400)": ("yes", "yes"),
    "region(part1, zero)": ("don't know", "don't know"),
    "part_of(P, floor)": ("bindings", "bindings"),
    "#count{D : door(D)} >= 1": ("yes", "yes"),
    "#count{D : door(D)} >= 2": ("don't know", "don't know"),
}


@pytest.mark.parametrize("query", ANSWERS)
def test_both_forms_are_answered(query: str) -> None:
    with QueryEngine() as engine:
        found = [engine.ask([*FACTS, f"unseen(r1,{unseen})."], query).kind for unseen in (9, 0)]
    assert found == list(ANSWERS[query])


def test_what_is_stated_in_one_form_holds_in_the_other_one() -> None:
    """Facts of older episodes, and what is assumed, state one form alone; a symmetric fact counts both ways."""
    with QueryEngine() as engine:
        facts = ["door(d1).", "in(org,r1).", "shape(o1,square,100).", "adjacent(o1,o2)."]
        for query in ("door(d1, 100)", "in(utak, r1, 100)", "shape(o1, square)", "adjacent(o2, o1, 100)"):
            assert engine.ask(facts, query).kind == "yes", query


def test_the_two_names_of_the_robot_are_one_in_rules_for_queries(tmp_path: Path) -> None:
    rules = tmp_path / "rules.lp"
    rules.write_text("felt(X) :- adjacent(utak, X).\nhere(utak, R) :- in(utak, R).\nkinds(K) :- kind(utak, K).\n")
    with QueryEngine(rules=[str(rules)]) as engine:
        assert engine.ask(FACTS, "felt(X)").rows == (("o1",),)
        assert engine.ask(FACTS, "here(utak, R)").rows == engine.ask(FACTS, "here(org, R)").rows == (("r1",),)
        assert engine.ask(FACTS, "kinds(utak)").kind == "no"  # org is meant, and the kind is called utak
        assert engine.ask(FACTS, "kinds(K)").rows == (("utak",),)


def test_each_predicate_with_a_confidence_has_a_short_form_but_outlines() -> None:
    long = {signature for signature, one in BELIEF_PREDICATES.items() if one.confident}
    short = {one.long for one in BELIEF_PREDICATES.values() if one.long is not None}
    assert long - short == {("segment", 7)}
    for (name, arity), one in BELIEF_PREDICATES.items():
        if one.long is not None:
            assert one.long == (name, arity + 1) and not one.confident
            assert one.arguments == BELIEF_PREDICATES[one.long].arguments[:-1]
