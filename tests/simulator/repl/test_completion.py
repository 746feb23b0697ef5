"""Completion offers what can stand at the cursor."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from utak.kb.language.vocabulary import BELIEF_PREDICATES, SHAPE_CLASSES
from utak.simulator.repl.completion import completions

COMMANDS = ["?-", ";", "assume", "back", "diff", "facts", "goal", "goto", "help", "quit", "run", "since", "step", "why"]
FACTS = ["kind(o1,object,90).", "kind(o12,object,30).", "in(org,r1).", "in(o1,r2).", "door(d1).", "bound(x,o1)."]
FACTS += ["plan(0,carry(o1,g1_r2)).", "serves(0,g1).", "price(5,5,proved)."]
OFFERED = {
    "st": {"step", "step(", "stretch("},
    "g": {"given(", "goal", "goal(", "goto"},
    "sha": {"shape("},
    "?- sha": {"shape("},
    "?- shape(o1": {"o12"},
    "?- shape(X, squ": {"square"},
    "?- shape(X, ": set(SHAPE_CLASSES),
    "?- kind(X, ": {"floor", "object", "utak", "verge"},
    "?- object(X), in(X, ": {"r1", "r2"},
    "?- in(": {"floor", "o1", "o12", "org", "utak", "verge"},
    "?- bound(": {"x", "y"},
    "?- bound(x, ": {"floor", "o1", "o12", "org", "utak", "verge"} - {"floor", "utak", "verge"},
    "?- door(": {"d1"},
    "?- plan(0, c": {"carry(", "carry(o1,g1_r2)", "clear(", "confirm("},
    "?- serves(I, ": {"g1"},
    "?- price(K, L, p": {"proved"},
    "?- means(G, in": {"in("},
    "pl": {"plan(", "plug("},
    "object(X),\n  shape(X, di": {"disc"},
    "goal at(": {"x", "y", "utak"},
    "goal at(utak, c": {"corner("},
    "goal at(utak, corner(north": {"northeast", "northwest"},
    "goal in(utak, ro": {"room(next)"},
    "facts o1": {"o12"},
    "facts wid": {"width"},
    "since adj": {"adjacent("},
    "assume bin": {"bind("},
    "assume bind(": {"x", "y"},
    "help ba": {"back"},
    "step ": set(),
    "goto 1": set(),
    "?- shape(o1, square, ": set(),
}


@pytest.mark.parametrize("text", OFFERED)
def test_what_fits_is_offered(text: str) -> None:
    word, found = completions(text, COMMANDS, FACTS, ["x", "y"])
    assert text.endswith(word)
    assert {one.text for one in found} == OFFERED[text]


def test_every_predicate_of_the_vocabulary_can_be_completed() -> None:
    for name, _ in BELIEF_PREDICATES:
        assert f"{name}(" in {one.text for one in completions(f"?- {name[:2]}", COMMANDS)[1]}


@given(st.text(max_size=40), st.lists(st.text(max_size=12), max_size=3))
def test_any_text_and_any_facts_have_completions(text: str, facts: list[str]) -> None:
    word, found = completions(text, COMMANDS, facts, ["x"])
    assert text.endswith(word)
    assert all(one.text.startswith(word) for one in found)
