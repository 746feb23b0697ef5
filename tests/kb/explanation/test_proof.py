"""Proofs of what encodings decide: each is checked by clingo, node by node."""

import json
import re
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.encoding_cases import ENCODINGS, Case, cases_of
from tests.kb.explanation.proof_checker import Decision, best_decisions, faults, faults_of_rivals, nodes
from tests.kb.explanation.random_facts import INPUTS, encoding_path, random_facts
from tests.tables import few
from utak.kb.explanation.programs import ExplanationError
from utak.kb.explanation.proof import explain_decision
from utak.kb.explanation.values import ProofNode
from utak.kb.language.diagnostics import BadInputError
from utak.kb.language.reader import facts_from_text
from utak.kb.reasoning.encodings import SHARED_FILES, encoding_text
from utak.kb.reasoning.solver import solve

# Cases with rules of users, or ranges, are left out: a decision is recorded with its facts.
CASES = [
    (encoding, case)
    for encoding in ENCODINGS
    for case in cases_of(encoding)
    if not re.search(r":[-~]|\.\.", case.facts)
]

# Decisions of real runs: [encoding, facts, answer], from `solved` of episodes of examples/go_northeast_rooms,
# go_to_square_unseen, go_next_room_hidden_door, push_square_blocked_door, and push_square_next_room with noise 0.1.
# What rests on counted priors is answered anew.
RECORDED = json.loads((Path(__file__).parent / "recorded.json").read_text())


def answered(name: str, facts: list[str]) -> list[str]:
    """Return the answer of an encoding to some facts."""
    return [str(atom) for atom in solve([encoding_path(name)], facts) or ()]


def checked(decision: Decision, atom: str) -> ProofNode:
    """Return the proof of an atom after a check of all that it says."""
    facts = [str(fact) for fact in facts_from_text(decision.facts)]
    root = explain_decision(decision.encoding.stem, facts, sorted(decision.shown), atom).root
    assert root.claim == atom
    assert faults(decision, root) == []
    for node in nodes(root):
        assert faults_of_rivals(decision, node) == []
    return root


@pytest.mark.parametrize(("encoding", "case"), few(CASES, 40), ids=lambda part: getattr(part, "stem", "") or part.title)
def test_proofs_of_the_cases_are_right(encoding, case: Case) -> None:
    for decision in best_decisions(encoding, case.facts)[:1]:
        for atom in sorted(decision.shown)[:2]:
            checked(decision, atom)


@pytest.mark.long
@pytest.mark.parametrize("number", range(len(RECORDED)), ids=lambda number: f"{number}-{RECORDED[number][0]}")
def test_proofs_of_recorded_decisions_are_right(number: int) -> None:
    name, facts, answer = RECORDED[number]
    answer = answered(name, facts) if name in SHARED_FILES else answer
    best = best_decisions(encoding_path(name), "\n".join(f"{fact}." for fact in facts))
    (decision,) = (one for one in best if one.shown == set(answer))
    for atom in answer[:2]:
        checked(decision, atom)


@pytest.mark.long
@pytest.mark.parametrize("name", sorted(INPUTS))
@given(data=st.data())
@settings(max_examples=8, deadline=None)
def test_proofs_of_random_answers_are_right(name: str, data: st.DataObject) -> None:
    facts = data.draw(random_facts(name, 12))
    decisions = best_decisions(encoding_path(name), "\n".join(f"{fact}." for fact in facts))
    for decision in decisions[:1]:
        if decision.atoms:
            checked(decision, data.draw(st.sampled_from(sorted(decision.atoms))))


FACTS = ["region(a,zero,100)", "region(b,nonzero,90)", "surrounds(a,b)", "mass(b,20)", "extent(b,2)"]
ANSWER = answered("interpretation", FACTS)
(OBJECT,) = (atom for atom in ANSWER if atom.startswith("kind(b,object,"))


def test_a_proof_tells_rule_values_and_facts() -> None:
    root = explain_decision("interpretation", FACTS, ANSWER, OBJECT).root
    assert root.instance is not None
    assert dict(root.instance.values) == {"R": "b", "K": "object", "C": OBJECT[len("kind(b,object,") : -1]}
    assert root.instance.rule.file == "kb/asp/interpretation.lp"
    solid = next(node for node in nodes(root) if node.claim.startswith("solid(b,"))
    assert "Of regions like b with 2 squares expected to be occupied" in solid.sentence
    assert any(node.claim.startswith("counted_solid(isolated,") for node in nodes(root))
    assert {node.claim for node in nodes(root) if node.kind == "given"} == set(FACTS)
    assert {node.words for node in nodes(root) if node.claim == "not island(b)"} == {
        "nothing felt so far makes region b an island of the verge"
    }


def test_an_atom_that_is_not_shown_has_a_proof_too() -> None:
    assert explain_decision("interpretation", FACTS, ANSWER, "isolated(b)").root.kind == "derived"


def test_facts_may_have_full_stops() -> None:
    dotted = [f"{fact}." for fact in FACTS]
    plain = explain_decision("interpretation", FACTS, ANSWER, "isolated(b)")
    assert explain_decision("interpretation", dotted, [f"{a}." for a in ANSWER], "isolated(b).") == plain


def test_a_conditional_literal_shows_all_its_cases() -> None:
    facts = ["fit(o1,square,0,1)", "fit(o1,brick,1,2)", "fit(o1,disc,2,3)", "open_squares(o1,0)", "full_squares(o1,9)"]
    (decision,) = best_decisions(encoding_path("shapes"), "\n".join(f"{fact}." for fact in facts))
    (node,) = (
        node for node in nodes(checked(decision, "lead(o1,1)")) if node.kind == "each" and "behind" in node.claim
    )
    assert [child.claim for child in node.children] == ["1 <= 1", "1 <= 2"]
    assert node.words == "behind(o1,K) holds in 2 cases, and in each 1 <= K"


def test_a_conditional_literal_without_a_case_says_that_nothing_had_to_hold() -> None:
    root = explain_decision("deciding", ["tight(0,300,0,0)"], ["do(errand)", "walked(0)"], "walked(0)").root
    assert "there is no part(0,L), so nothing had to hold" in {node.words for node in nodes(root)}


def test_a_greatest_value_shows_what_it_is_the_greatest_of() -> None:
    facts = "convex(1,0,0). convex(2,100,50). convex(3,50,50)."
    (decision,) = best_decisions(encoding_path("corners"), facts)
    root = checked(decision, "furthest(northeast,2)")
    assert "the greatest of 0, 100, 150 is 150" in {node.words for node in nodes(root)}


def test_a_choice_tells_what_others_would_cost() -> None:
    facts = ["begins(j1)", "ends(j2)", *(f"link(l{n},j1,j2,{far},100)" for n, far in enumerate((500, 300, 700), 1))]
    facts += ["crosses(l2,d1)", "not_through(d1)"]
    root = explain_decision("deciding", facts, ["do(errand)", "step(l1,j1,j2)"], "step(l1,j1,j2)").root
    dearer, forbidden = root.rivals
    assert (dearer.atom, dearer.verdict, dearer.level, dearer.difference) == ("step(l3,j1,j2)", "dearer", -22, 200)
    assert (forbidden.atom, forbidden.verdict) == ("step(l2,j1,j2)", "forbidden")
    (constraint,) = forbidden.forbidden_by
    assert constraint.rule.kind == "constraint" and constraint.sentence in forbidden.sentence
    assert "Link l3 is 7 squares long" in dearer.sentence


def test_a_choice_of_none_is_a_rival_too() -> None:
    root = explain_decision("deciding", ["offered(0,go(1,2))"], ["begun", "do(errand)"], "begun").root
    (none,) = root.rivals
    assert (none.atom, none.level, none.difference) == ("", -31, 1)


def test_an_atom_that_does_not_hold_has_no_proof() -> None:
    with pytest.raises(ExplanationError, match=r"kind\(b,floor,100\) does not hold"):
        explain_decision("interpretation", FACTS, ANSWER, "kind(b,floor,100)")


def test_an_answer_that_is_none_is_an_error() -> None:
    with pytest.raises(ExplanationError, match="no answer of this program"):
        explain_decision("interpretation", FACTS, ["kind(b,object,100)"], "kind(b,object,100)")
    with pytest.raises(ExplanationError, match="no answer of this program"):
        explain_decision("interpretation", FACTS, ["kind(a,floor,100)"], "kind(a,floor,100)")


def test_an_unknown_encoding_is_an_error() -> None:
    for name in ("nonsense", "../asp/rooms", ""):
        with pytest.raises(ExplanationError, match="there is no encoding"):
            explain_decision(name, [], [], "p")


@pytest.mark.parametrize("text", ["p(X)", "p :- q", "größe(a)", "p(99999999999)", "", '#include "x"', "p. q"])
def test_what_is_no_fact_never_reaches_clingo(text: str) -> None:
    with pytest.raises((BadInputError, ValueError)):
        explain_decision("rooms", [], [], text)
    with pytest.raises((BadInputError, ExplanationError)):
        explain_decision("rooms", [text], ["door(1,9)"], "door(1,9)")


def test_the_checker_finds_a_wrong_leaf_and_a_wrong_child() -> None:
    (decision,) = best_decisions(encoding_path("interpretation"), " ".join(f"{fact}." for fact in FACTS))
    root = explain_decision("interpretation", FACTS, ANSWER, OBJECT).root
    assert faults(decision, ProofNode("given", "mass(b,21)", "x"))
    assert faults(decision, ProofNode("absent", "not region(b,_,_)", "x"))
    assert faults(decision, ProofNode("comparison", "31 < 30", "x"))
    fewer = ProofNode("derived", root.claim, root.words, root.instance, root.children[1:])
    assert any("does not follow" in fault for fault in faults(decision, fewer))
    inner = ProofNode("derived", root.claim, root.words, root.instance, (root, *root.children))
    assert any("rests on itself" in fault for fault in faults(decision, inner))


def test_the_checker_finds_a_wrong_cost() -> None:
    facts = ["aim(1,explore,50)", "aim(2,explore,60)"]
    (decision,) = best_decisions(encoding_path("deciding"), " ".join(f"{fact}." for fact in facts))
    root = explain_decision("deciding", facts, ["choose(1)", "do(errand)"], "choose(1)").root
    (rival,) = (one for one in root.rivals if one.atom)

    for wrong in (replace(rival, difference=9), replace(rival, verdict="forbidden"), replace(rival, prices=())):
        assert faults_of_rivals(decision, replace(root, rivals=(wrong,)))


def test_no_proof_says_false() -> None:
    for encoding in ENCODINGS:
        assert not re.search(r'%! .*"[^"]*\bfalse\b', encoding_text(encoding))
