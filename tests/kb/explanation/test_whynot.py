"""Changes that make an atom hold: each is tried, each part of it, and on small models each smaller one."""

import re
from itertools import combinations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.kb.explanation.proof_checker import best_decisions, faults, holds_somewhere, nodes
from tests.kb.explanation.random_facts import ANSWERS, INPUTS, atoms_over, encoding_path, random_facts
from utak.kb.explanation.programs import DecisionProgram, ExplanationError
from utak.kb.explanation.values import Absence
from utak.kb.explanation.whynot import explain_absence
from utak.kb.reasoning.encodings import encoding_text


def text_of(facts: list[str] | set[str]) -> str:
    return "\n".join(f"{fact}." for fact in sorted(facts))


def absence(name: str, facts: list[str], atom: str) -> Absence:
    """Return why an atom does not hold in a best answer, after a check that the change works and none of it is idle."""
    path = encoding_path(name)
    decisions = best_decisions(path, text_of(facts))
    found = explain_absence(name, facts, sorted(decisions[0].shown) if decisions else None, atom)
    if found.found:
        assert set(found.in_way) <= set(facts) and not set(found.missing) & set(facts)
        change = [*found.missing, *found.in_way]
        assert holds_somewhere(path, text_of(changed(facts, change)), atom)
        for size in range(len(change)):
            for fewer in combinations(change, size):
                assert not holds_somewhere(path, text_of(changed(facts, list(fewer))), atom), fewer
    if found.proof is not None and not found.missing:
        rest = text_of(changed(facts, list(found.in_way)))
        decision = next(one for one in best_decisions(path, rest) if atom in one.atoms)
        assert faults(decision, found.proof.root) == []
    return found


def arguments_of(atom: str) -> list[str]:
    return atom.partition("(")[2].removesuffix(")").split(",") if "(" in atom else []


def changed(facts: list[str], change: list[str]) -> set[str]:
    """Return the facts after a change: those in it that are given are taken away, the others are added."""
    return set(facts) ^ set(change)


def smaller_changes(name: str, facts: list[str], atom: str, size: int) -> list[tuple[str, ...]]:
    """Return the changes of fewer facts with which an atom holds, over constants that are known.

    Names may stand in the facts, the atom or the encoding; numbers at the same place of a fact, or first in the atom.
    """
    names = set(re.findall(r"[a-z]\w*", " ".join([*facts, atom, encoding_text(encoding_path(name))])))
    numbers = {(fact.split("(")[0], at, one) for fact in facts for at, one in enumerate(arguments_of(fact))}

    def is_known(fact: str) -> bool:
        predicate, parts = fact.split("(")[0], arguments_of(fact)
        first = arguments_of(atom)[:1]
        return all(
            one in names or (predicate, at, one) in numbers or (at == 0 and [one] == first)
            for at, one in enumerate(parts)
        )

    universe = [fact for fact in atoms_over(INPUTS[name]) if is_known(fact)]
    options = sorted({*facts, *universe})
    return [
        change
        for fewer in range(size)
        for change in combinations(options, fewer)
        if holds_somewhere(encoding_path(name), text_of(changed(facts, list(change))), atom)
    ]


@pytest.mark.long
@pytest.mark.parametrize("name", sorted(INPUTS))
@given(data=st.data())
@settings(max_examples=3, deadline=None)
def test_changes_of_random_facts_are_least(name: str, data: st.DataObject) -> None:
    facts = data.draw(random_facts(name, 7))
    decisions = best_decisions(encoding_path(name), text_of(facts))
    holding = decisions[0].shown if decisions else frozenset()
    atom = data.draw(st.sampled_from([one for one in atoms_over(ANSWERS[name]) if one not in holding]))
    found = absence(name, facts, atom)
    if found.found and not found.partial:
        size = min(2, len(found.missing) + len(found.in_way))
        assert smaller_changes(name, facts, atom, size) == []


def test_a_search_for_a_change_that_does_not_end_is_given_up() -> None:
    facts = ["aim(1,feel,20)", "aim(2,feel,50)", "halt(1,20,1)", "halt(2,50,1)"]
    facts += ["tells(1,thing,doorway,1)", "tells(2,plain,square,3)"]
    program = DecisionProgram("deciding", seconds=1.0)
    request = {"facts": facts, "atom": "choose(2)"}
    candidates = program.ask({**request, "task": "candidates", "known": facts})
    many = {**candidates, "facts": [f"tells(1,plain,square,{2**n})" for n in range(26)]}  # 2**26 sums
    with pytest.raises(ExplanationError, match="the explanation was given up"):
        program.ask({**request, "task": "change", "candidates": many})
    again = program.ask({**request, "task": "candidates", "known": facts})  # the next request is answered as before
    assert again == candidates


LINKS = ("begins(j1)", "ends(j2)", "link(l1,j1,j2,500,100)", "link(l2,j1,j2,300,100)")


@pytest.mark.parametrize(
    ("name", "facts", "atom", "missing", "in_way"),
    [
        ("interpretation", ["region(a,zero,100)", "region(b,nonzero,90)", "surrounds(a,b)", "extent(b,3)"],
         "case(b,island)", ("touched(b,b)",), ()),
        ("interpretation", ["region(a,zero,100)", "region(b,nonzero,90)"], "isolated(b)", ("surrounds(a,b)",), ()),
        ("interpretation", ["region(a,zero,80)"], "kind(a,floor,90)", ("region(a,zero,90)",), ()),
        ("rooms", ["neck(1,100,150,300,90)"], "door(1,90)", ("neck(1,75,150,300,90)",), ()),
        ("corners", ["convex(1,10,10)", "convex(2,20,5)"], "furthest(northeast,1)", (), ("convex(2,20,5)",)),
        ("deciding", [*LINKS, "crosses(l2,d1)", "not_through(d1)"], "step(l2,j1,j2)", (), ("crosses(l2,d1)",)),
        ("deciding", ["aim(1,explore,50)", "aim(2,pass,10)", "aim(3,attain,9)"], "choose(1)", (),
         ("aim(2,pass,10)", "aim(3,attain,9)")),
        ("accommodation", ["explanation(1,blocked,0,1)", "explanation(2,slipped,0,2)"], "chosen(2)", (),
         ("explanation(1,blocked,0,1)",)),
        ("interpretation", ["region(a,nonzero,100)"], "rim(a)", ("rim(a)",), ()),
    ],
)  # fmt: skip
def test_changes_are_as_expected(name, facts, atom, missing, in_way) -> None:
    found = absence(name, facts, atom)
    assert found.found and (not found.partial or atom == "choose(1)")  # too many costs of aims are candidates
    assert (len(found.missing), len(found.in_way)) == (len(missing), len(in_way))
    assert (found.missing, found.in_way) == (missing, in_way) or atom == "step(l2,j1,j2)"


def test_a_number_that_a_comparison_needs_is_found_although_it_is_not_known() -> None:
    found = absence("interpretation", ["region(a,nonzero,100)", "extent(a,3)"], "long(a)")
    assert found.missing == ("extent(a,25)",)
    assert "given is extent(a,3)" in found.sentence


def test_a_choice_is_held_against_the_answer() -> None:
    found = absence("deciding", ["aim(1,explore,50)", "aim(2,explore,90)"], "choose(2)")
    assert found.rival is not None
    assert (found.rival.level, found.rival.difference) == (-13, 40)
    assert found.in_way == ("aim(1,explore,50)",)


def test_what_no_rule_derives_has_no_change() -> None:
    found = absence("interpretation", ["region(a,zero,100)"], "kind(a,nonsense,3)")
    assert not found.found and (found.missing, found.in_way) == ((), ())
    assert "no change" in found.sentence
    assert not explain_absence("interpretation", [], [], "unheard(of)").found


def test_where_there_was_no_answer_the_cause_is_found() -> None:
    facts = [*LINKS[:3], "crosses(l1,d1)", "not_through(d1)"]
    assert best_decisions(encoding_path("deciding"), text_of(facts)) == []
    found = explain_absence("deciding", facts, None, "step(l1,j1,j2)")
    assert found.found and len(found.in_way) == 1 and not found.missing


def test_another_answer_of_the_same_cost_needs_no_change() -> None:
    facts = ["wanted(x)", "candidate(n1,95)", "candidate(n2,95)"]
    decisions = best_decisions(encoding_path("reconciliation"), text_of(facts))
    assert len(decisions) > 1
    other = next(iter(decisions[1].shown - decisions[0].shown))
    found = explain_absence("reconciliation", facts, sorted(decisions[0].shown), other)
    assert found.found and (found.missing, found.in_way) == ((), ())
    assert "costs the same" in found.sentence


def test_an_atom_that_holds_is_not_absent() -> None:
    with pytest.raises(ExplanationError, match="holds in this answer"):
        explain_absence("interpretation", ["region(a,zero,100)"], ["kind(a,floor,100)"], "kind(a,floor,100)")


def test_facts_of_the_change_are_marked_as_assumed() -> None:
    found = absence("interpretation", ["region(a,zero,100)", "region(b,nonzero,90)"], "isolated(b)")
    assert found.proof is not None
    assert {node.claim: node.kind for node in nodes(found.proof.root)}["surrounds(a,b)"] == "assumed"
    assert (found.missing, found.in_way, found.partial) == (("surrounds(a,b)",), (), False)


@pytest.mark.long
def test_a_weaker_belief_is_not_denied() -> None:
    """No square is surely covered; with nothing open the best class is likelier."""
    classes = ["brick", "triangle", "l_shape", "t_shape", "u_shape"]
    fits = [f"fit(o1,{name},0,{rank})" for rank, name in enumerate(classes, 1)]

    def brick(open_: int) -> str:
        facts = [*fits, f"open_squares(o1,{open_})", "full_squares(o1,9)"]
        (decision,) = best_decisions(encoding_path("shapes"), text_of(facts))
        return next(atom for atom in decision.shown if atom.startswith("shape(o1,brick,"))

    found = absence("shapes", [*fits, "open_squares(o1,45)", "full_squares(o1,9)"], brick(0))
    assert found.sentence.startswith(f"{brick(0)} does not hold: {brick(45)} does; it would if ")
    assert len(found.missing) == 1 and found.in_way == ()


def test_what_is_missing_for_a_step_of_the_plan_is_nothing_of_the_past() -> None:
    """That a step was done before makes no plan have it."""
    found = explain_absence("task", ["horizon(1)", "goal(g1)"], ["unmet(g1)"], "occurs(feel(g1),0)")
    assert "stuck(g1,impossible)" in found.missing
    assert not any(one.startswith("done(") for one in found.missing)
