"""Users' rules: their effect, and that every error in them is reported as an error of their file."""

import random
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.encoding_cases import ENCODINGS, case_file
from utak.kb.language.diagnostics import BadInputError
from utak.kb.reasoning.encodings import KB_ENCODINGS, encoding_path, encoding_text
from utak.kb.reasoning.interfaces import USER_RULE_INTERFACES
from utak.kb.reasoning.query import QueryEngine
from utak.kb.reasoning.rule_solver import solve_with_rules
from utak.kb.reasoning.rulebook import INTERNAL_PREDICATES
from utak.kb.reasoning.solver import solve
from utak.kb.reasoning.user_rules import RULE_LIMITS, RuleLimits, read_rules, read_tested_rules, solve_with_user_rules

FACTS = ["region(a,zero,100)"]


def written(tmp_path: Path, *rules: str) -> list[Path]:
    files = []
    for number, text in enumerate(rules):
        files.append(tmp_path / f"rules{number}.lp")
        files[-1].write_bytes(text.encode("utf-8"))
    return files


def answered(tmp_path: Path, *rules: str) -> list[str] | None:
    found = solve([KB_ENCODINGS / "interpretation.lp", *written(tmp_path, *rules)], FACTS)
    return None if found is None else [str(atom) for atom in found]


def complaint(tmp_path: Path, *rules: str) -> str:
    with pytest.raises(BadInputError) as caught:
        answered(tmp_path, *rules)
    return str(caught.value)


def refusal(tmp_path: Path, *rules: str, limits: RuleLimits = RULE_LIMITS) -> str:
    """Return the message about files of rules that are refused before solving."""
    with pytest.raises(BadInputError) as caught:
        read_tested_rules(written(tmp_path, *rules), limits)
    return str(caught.value)


def test_rules_are_added_to_ours(tmp_path: Path) -> None:
    assert answered(tmp_path, "kind(a, verge, 7).") == ["kind(a,floor,100)", "kind(a,verge,7)"]


def test_own_predicates_connect_rules(tmp_path: Path) -> None:
    rules = (
        "pair((1,(2,3))). strange(R) :- region(R, zero, _), not even(R). even(b).",
        "kind(R, verge, 7) :- strange(R).\n#show.",
    )
    assert answered(tmp_path, *rules) == ["kind(a,floor,100)", "kind(a,verge,7)"]


def test_predicates_of_ones_own_are_no_internal_ones_of_that_name(tmp_path: Path) -> None:
    """`left` belongs to the task plan, `odd` to an encoding that rules do not reach, the others to shapes.lp."""
    facts = ["fit(o1,square,0,1)", "open_squares(o1,0)", "full_squares(o1,9)"]
    own = written(tmp_path, "left(X, Y) :- fit(X, Y, _, _). odd(X) :- left(X, _). first(X, square, 9) :- odd(X).")
    usual = solve([KB_ENCODINGS / "shapes.lp"], facts)
    assert solve([KB_ENCODINGS / "shapes.lp", *own], facts) == usual
    stated = written(tmp_path, "sure(X) :- fit(X, square, _, _). shape(X, disc, 7) :- sure(X).")
    assert "shape(o1,disc,7)" in map(str, solve([KB_ENCODINGS / "shapes.lp", *stated], facts) or ())


def test_a_rule_that_has_an_instance_applied_also_where_it_lets_nothing_of_it_hold() -> None:
    """Of three rules the first forbids what the second says, whether there is an answer or none; the third is idle."""
    rules, conditions = [":- a.", "b :- a.", "c :- d."], ["a", "a", "d"]
    for program in ("{ a }.", "a."):
        assert solve_with_rules(program, rules, [], 100, conditions)["applied"] == [0, 1]


def test_constants_hold_in_their_file_only(tmp_path: Path) -> None:
    rules = ("#const zero = 7. kind(a, verge, zero).", "kind(R, verge, 9) :- region(R, zero, _).")
    assert answered(tmp_path, *rules) == ["kind(a,floor,100)", "kind(a,verge,7)", "kind(a,verge,9)"]


CONTRADICTIONS = {
    ":- kind(_, floor, _).": "rules0.lp:1:1-1: error: this rule contradicts what must hold: interpretation.lp",
    "p :- region(_, zero, _).\n:- p.": "rules0.lp:2:1-1: error: this rule contradicts what must hold",
    ":- #true.": "rules0.lp:1:1-1: error: this rule contradicts what must hold: interpretation.lp",
    "kind(a, verge, 7).\n  a :- not a.": "rules0.lp:2:3-3: error: this rule contradicts",
}


@pytest.mark.parametrize("rules", CONTRADICTIONS)
def test_a_contradicting_rule_is_refused_at_its_place(tmp_path: Path, rules: str) -> None:
    assert CONTRADICTIONS[rules] in complaint(tmp_path, rules)


def test_rules_may_read_what_was_counted_and_not_change_it(tmp_path: Path) -> None:
    read = "kind(R, object, W/10) :- region(R, zero, _), counted_solid(felt_verge, _, _, W)."
    assert any(atom.startswith("kind(a,object,") for atom in answered(tmp_path, read) or ())
    assert "counted_none" in refusal(tmp_path, "counted_none(0, 3, 500).")
    assert "unknown case" in complaint(tmp_path, "kind(R, object, 7) :- region(R, _, _), counted_solid(tall, _, _, _).")


def test_a_rule_that_contradicts_itself_is_refused_when_read(tmp_path: Path) -> None:
    for rules in (":- #true.", "a :- not a.", "n(1..3). :- n(3)."):
        assert "leaves no answer, whatever is given" in refusal(tmp_path, rules)


def test_a_search_that_is_cut_off_is_refused(tmp_path: Path) -> None:
    birds = "bird(1..9). hole(1..8). :- sits(B,H), sits(C,H), B < C. "
    for rules in (
        "1 { sits(B,H) : hole(H) } 1 :- bird(B).",  # there is no answer, but that is hard to prove
        "{ sits(B,H) : hole(H) } 1 :- bird(B). :~ bird(B), not sits(B,_). [1,B]",  # the best one is hard to prove
    ):
        assert "rules0.lp:1:1-1: error: the search for the best answer of these rules was cut off" in refusal(
            tmp_path, birds + rules, limits=RuleLimits(conflicts=50)
        )


WRONG = {
    "colour(X,r,90) :- shape(X,disc,C).": "rules0.lp:1:1-1: error: this changes nothing",
    "in(X,r1) :- held(X).": "this changes nothing",
    "door(99,100).": "rules0.lp:1:6-6: error: there is no neck 99",
    'kind("x",object,"90").': 'rules0.lp:1:6-6: error: a name was expected, not "x"',
    "shape(o1,square,high).": "rules0.lp:1:17-17: error: a confidence must be an integer, not high",
    "touched(R,green) :- region(R,zero,_).": "a colour is a single lower-case letter, not green",
    "shape(o1,sqare,90).": "unknown shape sqare",
    "kind(R,verge,101) :- region(R,zero,_).": "a confidence must be from 0 to 100, not 101",
    "region(a,zero,100).": "region/3 says what there is, and rules add nothing to it",
    "kind(R,verge) :- region(R,zero,_).": "rules0.lp:1:1-1: error: this changes nothing",
    "p(X) :- knid(X,verge,1).": "did you mean kind?",
    "p(5000000000).": "rules0.lp:1:3-12: error: a number beyond 32 bits",
    "p(0x80000000).": "rules0.lp:1:3-12: error: a number beyond 32 bits",
    "p(65536*65536).": "rules0.lp:1:3-3: error: a number beyond 32 bits (-2147483648 to 2147483647), in 65536 * 65536",
    "#const n = 65536.\np(n*n).": "rules0.lp:2:3-3: error: a number beyond 32 bits",
    "p(a+1).": "operation undefined: a is no number",
    "p(X) :- X = @f(1).": "there are no functions from outside",
    "p(X) :- kind(Y,verge,C).": "nothing says what X can be",
    "p(X) :- X = #sum{C,R : kind(R,verge,C)}.": "a sum is not given to a variable in rules",
    "-p(1).": "classical negation is not known here",
    "p :- &diff{a} > 3.": "theory atoms are not known here",
    ":- do(resume(nonsense)).": "unknown begun activity nonsense",
    ":- do(resume(feel(nonsense))).": "unknown begun activity feel(nonsense)",
    ":- odd(_).": "odd/1 belongs to accommodation.lp, which rules of users do not reach",
    ":- chosen(E), explanation(E, slipped, _, _).": "chosen/1 belongs to accommodation.lp",
    "p(X) :- kind(X,verge,C), fit(X,S,M,R).": "this rule counts nowhere: no encoding knows all of fit/4, kind/3",
    "p(X) :- object(X), not q(X). q(X) :- object(X), not p(X).": "is defined through its own negation",
    '#include "/etc/passwd".': "#include is not allowed",
    "#script (python)\nimport os\n#end.": "#script is not allowed",
    "#external p(1).": "#external is not known here",
    "#program step(t).": "#program is not known here",
    "p(" + "(" * 30_000 + "1" + ")" * 30_000 + ").": "rules0.lp:1:66-66: error: brackets are nested more than 64 deep",
    "p(" + "-" * 30_000 + "1).": "rules0.lp:1:",
    "% nothing": "there is no rule in this file",
}


@pytest.mark.parametrize("rules", WRONG)
def test_invalid_rules_are_refused_before_solving(tmp_path: Path, rules: str) -> None:
    said = refusal(tmp_path, rules)
    assert WRONG[rules] in said
    assert said.startswith(f"{tmp_path}/rules0.lp:")


DERIVED = {
    "kind(R,verge,C+100) :- region(R,zero,C).": "derive kind(a,verge,200), in interpretation.lp: a confidence must be",
    "kind(R,S,7) :- region(R,S,_).": "derive kind(a,zero,7), in interpretation.lp: unknown kind zero",
    "kind(b,verge,7).": "derive kind(b,verge,7), in interpretation.lp: there is no region b",
    "kind(f(R),verge,7) :- region(R,_,_).": "a name was expected, not f(a)",
    "kind((R,R),verge,7) :- region(R,_,_).": "it is no fact",
    "kind(R,verge,C*C*C*C*C*C) :- region(R,_,C).": "rules0.lp:1:14-14: error: a number beyond 32 bits",
    "touched(R,S) :- region(R,S,_).": "a colour is a single lower-case letter, not zero",
}


@pytest.mark.parametrize("rules", DERIVED)
def test_derived_atoms_are_checked_against_the_vocabulary(tmp_path: Path, rules: str) -> None:
    read_tested_rules(written(tmp_path, rules))
    said = complaint(tmp_path, rules)
    assert DERIVED[rules] in said
    assert said.startswith(f"{tmp_path}/rules0.lp:1:")


def test_the_error_names_the_rule_that_derives_an_invalid_atom(tmp_path: Path) -> None:
    rules = "kind(R,object,7) :- region(R,zero,_).\nkind(R,verge,C) :- region(R,zero,D), C = D+1."
    assert "rules0.lp:2:1-1: error: these rules derive kind(a,verge,101)" in complaint(tmp_path, rules)


def test_a_rule_reaches_the_encodings_that_know_all_its_predicates(tmp_path: Path) -> None:
    rules = read_rules(
        written(tmp_path, "p(X) :- kind(X, verge, _). q(X) :- p(X), not r(X). r(o9). s :- neck(_,W,_,_,_).")
    )
    assert [len(rules.rules_reaching(name)) for name in ("interpretation", "shapes", "rooms", "belief")] == [3, 1, 2, 3]


def test_queries_can_use_own_predicates(tmp_path: Path) -> None:
    rules = (
        "wide(X) :- rect(X, W, _, E, _), E-W > 500.\nsmall(X) :- object(X), not wide(X).\n"
        "near(X, Y) :- adjacent(X, Y). near(X, Z) :- near(X, Y), adjacent(Y, Z).\nsquare(X, C) :- shape(X, square, C)."
    )
    facts = [f"kind(o{n},object,95)." for n in (1, 2)] + ["rect(o1,0,0,600,9).", "rect(o2,0,0,300,9)."]
    facts += ["adjacent(org,o1).", "adjacent(o1,o2).", "shape(o1,square,80).", "shape(o2,brick,99)."]
    with QueryEngine(rules=[str(path) for path in written(tmp_path, rules)]) as engine:

        def ask(query: str, unseen: int) -> object:
            answer = engine.ask([*facts, f"unseen(r1,{unseen})."], query)
            return list(answer.rows) if answer.rows else answer.kind

        assert ask("wide(X)", 9) == [("o1",)]
        assert ask("small(X)", 9) == [("o2",)]
        assert ask("near(org, X)", 0) == [("o1",), ("o2",), ("org",)]
        assert ask("near(utak, o2)", 0) == ask("near(o2, utak)", 0) == "yes"
        assert ask("wide(o3)", 9) == "don't know"
        assert ask("wide(o3)", 0) == "no"
        assert ask("not wide(o3)", 9) == "don't know"
        assert ask("square(o1, 100)", 0) == "don't know"
        assert ask("square(o2, C)", 0) == "no"
        with pytest.raises(BadInputError, match="unknown predicate"):
            ask("tiny(X)", 0)


def test_an_error_of_a_rule_during_a_query_has_its_place(tmp_path: Path) -> None:
    paths = [str(path) for path in written(tmp_path, "% one\np(X*X*X) :- offset(_, X, _).")]
    with QueryEngine(rules=paths) as engine, pytest.raises(BadInputError) as caught:
        engine.ask(["offset(o1,5000,0)."], "p(X)")
    assert f"{paths[0]}:2:1-1: error: a number beyond 32 bits" in str(caught.value)


@pytest.mark.long
def test_a_runaway_rule_is_given_up(tmp_path: Path) -> None:
    limits = RuleLimits(seconds=0.5)
    endless = written(tmp_path, "n(0). n(X+1) :- n(X), X < 2000000000. kind(a, verge, 8) :- n(1).")
    for run in (
        lambda: read_tested_rules(endless, limits),
        lambda: solve_with_user_rules([KB_ENCODINGS / "interpretation.lp"], endless, FACTS, limits),
    ):
        with pytest.raises(BadInputError, match=r"rules0\.lp:1:1-1: error: these rules were given up"):
            run()
    assert answered(tmp_path, "kind(a, verge, 8).")  # and the next question is answered


@pytest.mark.parametrize("char", ["\u00df", "\u201c", "\ufeff", "\u00a0"])
def test_text_that_is_not_ascii_never_reaches_clingo(tmp_path: Path, char: str) -> None:
    assert "rules0.lp:1:" in complaint(tmp_path, f"{char}kind(a, verge, 7).")


def test_every_error_has_its_place(tmp_path: Path) -> None:
    said = complaint(tmp_path, "% fine\nkind(a, verge, 7).\n", "kind(a, verge, 7).\nkind(b, verge, 7.\n")
    assert "rules1.lp:2:" in said
    assert "kind(b, verge, 7." in said


def test_the_interface_tables_agree_with_the_encodings() -> None:
    """All inputs and outputs of an encoding are in the tables, and nothing that is not documented."""
    import importlib.util

    script = Path(__file__).resolve().parents[3] / "docs" / "build_vocabulary.py"
    spec = importlib.util.spec_from_file_location("build_vocabulary", script)
    assert spec is not None
    assert spec.loader is not None
    build = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(build)
    unreached: dict[tuple[str, int], set[str]] = {}
    for path in ENCODINGS:
        entries = build.entries(encoding_text(path))
        interface = {entry.signature for entry in entries if entry.role}
        if path.stem in USER_RULE_INTERFACES:
            table = set(USER_RULE_INTERFACES[path.stem])
            assert interface <= table <= {entry.signature for entry in entries}, path
        elif path.stem != "belief":
            for signature in interface:
                unreached.setdefault(signature, set()).add(path.stem)
    assert {signature: set(names) for signature, names in INTERNAL_PREDICATES.items()} == unreached


@pytest.mark.parametrize("name", USER_RULE_INTERFACES)
def test_rules_that_derive_nothing_change_no_answer(tmp_path: Path, name: str) -> None:
    """With a rule that only reads, solved in another process, every case has the same answer as without it."""
    paths = written(tmp_path, "seen(1) :- #true.")
    facts = [
        fact.strip()
        for line in case_file(encoding_path(name)).read_text().split("%% ")[1].splitlines()[1:]
        if not line.startswith("%")
        for fact in line.split(". ")
        if fact.strip(" .")
    ]
    facts = [fact.removesuffix(".") for fact in facts]
    assert solve([encoding_path(name), *paths], facts) == solve([encoding_path(name)], facts)


PIECES = """
kind(R,verge,C) region(R,zero,C) kind(R,object,_) p(X) q(R) shape(o1,square,C) door(P,C) :- :- :- . . . . , ; C+1 X*X
2147483648 - #count{X:p(X)} > = { } | "#const n=3." " % %* @f(1) n R 1..9 (1;2) not #true #false choose(1) _ #show.
~ #sum{C,R:kind(R,verge,C)} [C@1] :~ bind(x,o1) (((( #inf p
"""


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10**9).map(random.Random))
def test_any_rule_file_is_accepted_or_refused_with_a_place(
    tmp_path_factory: pytest.TempPathFactory, draw: random.Random
) -> None:
    text = " ".join(draw.choice(PIECES.split(" ")) for _ in range(draw.randint(1, 14)))
    path = tmp_path_factory.mktemp("rules") / "rules.lp"
    path.write_text(text)
    try:
        read_tested_rules([path])
        solve([KB_ENCODINGS / "interpretation.lp", path], FACTS)
    except BadInputError as bad:
        for problem in bad.problems:
            assert problem.file == str(path)
            assert 1 <= problem.span.line <= text.count("\n") + 1
            assert 1 <= problem.span.start <= problem.span.end
            assert "ended the process" not in problem.what
