"""Explanations with users' rules: in decisions, in queries, and what is wrong with their sentences."""

from pathlib import Path

import pytest

from tests.kb.explanation.proof_checker import nodes
from utak.kb.explanation.belief import explain_query_atom
from utak.kb.explanation.programs import DecisionProgram, ExplanationError
from utak.kb.explanation.proof import explain_decision
from utak.kb.explanation.whynot import explain_absence
from utak.kb.language.diagnostics import BadInputError
from utak.kb.reasoning.encodings import KB_ENCODINGS
from utak.kb.reasoning.query import QueryEngine
from utak.kb.reasoning.solver import solve
from utak.kb.reasoning.user_rules import read_rules

HEAVY = """\
%! because "Region {R} is heavy: {N/10} squares of it are expected to be occupied."
heavy(R) :- mass(R, N), N > 50.
%! says heavy(R) "region {R} is heavy" else "nothing seen so far shows that region {R} is heavy"

kind(R, object, 96) :- heavy(R), not touched(R, b).
"""
FACTS = ["region(a,nonzero,100)", "extent(a,3)", "mass(a,72)"]


def written(tmp_path: Path, text: str, name: str = "mine.lp") -> str:
    path = tmp_path / name
    path.write_text(text)
    return str(path)


def answer(rules: str, facts: list[str]) -> list[str]:
    return [str(atom) for atom in solve([KB_ENCODINGS / "interpretation.lp", Path(rules)], facts) or ()]


def test_a_users_rule_stands_in_the_proof_with_its_sentence(tmp_path: Path) -> None:
    rules = written(tmp_path, HEAVY)
    proof = explain_decision("interpretation", FACTS, answer(rules, FACTS), "kind(a,object,96)", [rules])
    assert proof.root.instance is not None
    assert (proof.root.instance.rule.file, proof.root.instance.rule.line) == (rules, 5)
    assert proof.root.sentence == proof.root.instance.rule.text  # a rule without a sentence stands for itself
    heavy = next(node for node in nodes(proof.root) if node.claim == "heavy(a)")
    assert heavy.sentence == "Region a is heavy: 7.2 squares of it are expected to be occupied."
    assert heavy.words == "region a is heavy"
    assert {"mass(a,72)", "72 > 50", "not touched(a,b)"} <= {node.claim for node in nodes(proof.root)}


def test_what_a_users_rule_lacks_is_found(tmp_path: Path) -> None:
    rules = written(tmp_path, HEAVY)
    facts = ["region(a,nonzero,100)", "extent(a,3)"]
    found = explain_absence("interpretation", facts, answer(rules, facts), "kind(a,object,96)", [rules])
    assert (found.missing, found.in_way) == (("mass(a,51)",), ())
    assert found.proof is not None
    assert any(node.sentence.startswith("Region a is heavy: 5.1 squares") for node in nodes(found.proof.root))


def test_rules_that_do_not_reach_an_encoding_change_nothing(tmp_path: Path) -> None:
    rules = written(tmp_path, HEAVY)
    facts = ["neck(1,100,300,300,90)"]
    proof = explain_decision("rooms", facts, ["door(1,90)"], "door(1,90)", [rules])
    assert proof == explain_decision("rooms", facts, ["door(1,90)"], "door(1,90)")


def test_recursive_rules_rest_on_nothing_but_facts(tmp_path: Path) -> None:
    rules = written(tmp_path, "within(R, S) :- surrounds(S, R).\nwithin(R, T) :- within(R, S), within(S, T).\n")
    facts = [f"region({one},nonzero,90)" for one in "abc"]
    facts += [f"surrounds({one},{other})" for one, other in ("ab", "bc", "ca")]
    proof = explain_decision("interpretation", facts, answer(rules, facts), "within(a,a)", [rules])
    claims = [node.claim for node in nodes(proof.root)]
    assert len(claims) == len(set(claims))
    assert {"surrounds(a,b)", "surrounds(b,c)", "surrounds(c,a)"} <= set(claims)


def test_a_recursive_aggregate_counts_what_is_founded(tmp_path: Path) -> None:
    rules = written(
        tmp_path,
        "big(R) :- mass(R, N), N > 50.\nbig(R) :- region(R, _, _), 1 <= #count { S : big(S), surrounds(R, S) }.\n",
    )
    facts = ["region(a,nonzero,90)", "region(b,nonzero,90)", "mass(a,60)", "surrounds(b,a)", "surrounds(b,b)"]
    proof = explain_decision("interpretation", facts, answer(rules, facts), "big(b)", [rules])

    def visit(node, above) -> None:
        assert node.claim not in above
        for child in node.children:
            visit(child, (*above, node.claim))

    visit(proof.root, ())
    assert "mass(a,60)" in {node.claim for node in nodes(proof.root)}


def test_pools_and_intervals_name_the_value_that_held(tmp_path: Path) -> None:
    text = "some_size(R, N) :- extent(R, N), N = 1..5.\npair(R, K) :- touched(R, (b; g)), K = 1..2.\n"
    rules = written(tmp_path, text)
    facts = [*FACTS, "touched(a,g)"]
    proof = explain_decision("interpretation", facts, answer(rules, facts), "pair(a,2)", [rules])
    assert "touched(a,g)" in {child.claim for child in proof.root.children}
    assert explain_decision("interpretation", facts, answer(rules, facts), "some_size(a,3)", [rules]).root.children


def test_a_rule_that_never_ends_is_given_up_in_its_own_process(tmp_path: Path) -> None:
    rules = written(tmp_path, "count_up(0).\ncount_up(N+1) :- count_up(N), region(_, _, _).\n")
    program = DecisionProgram("interpretation", [rules], seconds=0.5)
    with pytest.raises(ExplanationError, match="given up"):
        program.ask({"task": "trace", "facts": FACTS, "answer": ["kind(a,object,96)"]})


BELIEF = [
    "kind(o1,object,95).", "kind(o2,object,90).", "kind(o3,verge,99).", "offset(o1,100,200).", "offset(o2,300,400).",
]  # fmt: skip
NEAR = """\
%! because "{X} and {Y} lie {D/100} squares apart."
near(X, Y, D) :- object(X), object(Y), X != Y, offset(X, E1, N1), offset(Y, E2, N2), D = |E1-E2| + |N1-N2|, D < 900.
%! because "{X} is near {Y}."
near_thing(X) :- near(X, Y, _), not held(X).
crowd(N) :- N = #count { X : near_thing(X) }.
all_near :- near_thing(X) : object(X).
linked(X, Y) :- near(X, Y, _).
linked(X, Z) :- linked(X, Y), linked(Y, Z).
"""


def test_a_query_predicate_is_explained_by_rule_instances_and_beliefs(tmp_path: Path) -> None:
    rules = written(tmp_path, NEAR)
    root = explain_query_atom(BELIEF, "near_thing(o1)", [rules]).root
    assert root.sentence == "o1 is near o2."
    assert root.instance is not None and dict(root.instance.values)["X"] == "o1"
    near, absent = root.children
    assert near.sentence == "o1 and o2 lie 4 squares apart."
    assert (absent.kind, absent.claim) == ("absent", "not held(o1)")
    given = {node.claim for node in nodes(root) if node.kind == "given"}
    assert given == {"kind(o1,object,95)", "kind(o2,object,90)", "offset(o1,100,200)", "offset(o2,300,400)"}


@pytest.mark.parametrize("atom", ["crowd(2)", "all_near", "linked(o1,o1)", "object(o2)", "kind(o3,verge,99)"])
def test_explained_query_atoms_are_those_that_queries_answer(tmp_path: Path, atom: str) -> None:
    rules = written(tmp_path, NEAR)
    root = explain_query_atom(BELIEF, atom, [rules]).root
    given = sorted(node.claim for node in nodes(root) if node.kind == "given")
    with QueryEngine(rules=[rules]) as engine:
        assert engine.ask(BELIEF, atom).kind == "yes"
        assert set(given) <= {fact.removesuffix(".") for fact in BELIEF} and given
        if "crowd" not in atom and "all_near" not in atom:  # of these another answer would not be certain
            assert engine.ask([f"{fact}." for fact in given] + ["unseen(r1,0)."], atom).kind == "yes"


def test_a_query_atom_that_is_not_certain_is_not_explained(tmp_path: Path) -> None:
    rules = written(tmp_path, NEAR)
    for atom in ("near_thing(o3)", "crowd(3)", "object(o3)", "unheard(of)"):
        with pytest.raises(ExplanationError, match="does not certainly hold"):
            explain_query_atom(BELIEF, atom, [rules])


@pytest.mark.parametrize(
    ("text", "place", "message"),
    [
        ('%! because "Region {Q} is lost."\nlost(R) :- rim(R).\n', "1:20-22", "no variable Q"),
        (
            '%! because "Region {N} is lost."\nlost(R) :- rim(R), 1 < #count { N : mass(R, N) }.\n',
            "1:20-22",
            "no variable N",
        ),
        ('%! because "Region {R} is lost.\nlost(R) :- rim(R).\n', "1:12-12", "not closed"),
        ('lost(R) :- rim(R).\n%! because "It is lost."\n', "2:3-24", "no rule stands behind"),
        ('%! because "It is lost."\n#const n = 3.\nlost(R) :- rim(R).\n', "1:3-24", "no rule stands behind"),
        ('%! becuase "It is lost."\nlost(R) :- rim(R).\n', "1:3-24", "begins with becuase"),
        ('%! because "One."\n%! because "Two."\nlost(R) :- rim(R).\n', "2:3-17", "second sentence"),
        ('%! because "A brace { alone."\nlost(R) :- rim(R).\n', "1:21-21", "brace"),
        ('%! because "Two "\n%!   "lines {Q}"\nlost(R) :- rim(R).\n', "2:13-15", "no variable Q"),
        ("%! because lost\nlost(R) :- rim(R).\n", "1:3-15", "one string"),
        ('lost(R) :-\n%! because "Within."\n  rim(R).\n', "2:1-20", "within a rule"),
        ('%! says lost(R) "{Q} is lost"\nlost(R) :- rim(R).\n', "1:18-20", "no argument Q"),
        ("%! says lost(R)\nlost(R) :- rim(R).\n", "1:3-15", "words of a predicate"),
    ],
)
def test_wrong_sentences_are_located_errors(tmp_path: Path, text: str, place: str, message: str) -> None:
    rules = written(tmp_path, text)
    with pytest.raises(BadInputError, match=message) as raised:
        read_rules([rules])
    assert f"{rules}:{place}: error:" in str(raised.value)


def test_sentences_in_block_comments_and_strings_are_none(tmp_path: Path) -> None:
    text = '%*\n%! because "{Q}"\n*%\nlost(R, "%! because") :- rim(R).\n:~ lost(R, _). [1@2, R]\n'
    assert len(read_rules([written(tmp_path, text)]).statements) == 2


def test_a_changed_file_of_rules_is_read_again(tmp_path: Path) -> None:
    rules = written(tmp_path, HEAVY)
    before = explain_decision("interpretation", FACTS, answer(rules, FACTS), "heavy(a)", [rules])
    written(tmp_path, HEAVY.replace("is heavy:", "weighs much:"))
    after = explain_decision("interpretation", FACTS, answer(rules, FACTS), "heavy(a)", [rules])
    assert "is heavy:" in before.root.sentence and "weighs much:" in after.root.sentence
    first = explain_query_atom(BELIEF, "near_thing(o1)", [written(tmp_path, NEAR)]).root.sentence
    second = explain_query_atom(BELIEF, "near_thing(o1)", [written(tmp_path, NEAR.replace("is near", "is by"))])
    assert (first, second.root.sentence) == ("o1 is near o2.", "o1 is by o2.")


def test_a_very_high_proof_is_whole(tmp_path: Path) -> None:
    rules = written(tmp_path, "up(0) :- rim(_).\nup(N + 1) :- up(N), N < 1500.\n")
    facts = [*FACTS, "rim(a)"]
    proof = explain_decision("interpretation", facts, answer(rules, facts), "up(1500)", [rules])
    assert sum(1 for _ in nodes(proof.root)) > 1500


def test_names_of_helping_rules_are_refused(tmp_path: Path) -> None:
    rules = written(tmp_path, "trace__on(R) :- rim(R).\n")
    with pytest.raises(ExplanationError, match="trace__on"):
        explain_decision("interpretation", FACTS, ["kind(a,object,48)"], "kind(a,object,48)", [rules])
    with pytest.raises(ExplanationError, match="trace__weight"):
        explain_decision("interpretation", [*FACTS, "trace__weight(1,2,3,4,5)"], ["kind(a,object,48)"], "own(a)")
