"""A user's own rules: they count, and whatever is wrong with them is an error of their file and nothing worse."""

import time
from pathlib import Path

import pytest

from kb import userrules
from kb.encodings import KB, solve
from kb.problems import BadInputError

FACTS = ["region(a,zero,100)"]


def answered(tmp_path: Path, *rules: str) -> list[str] | None:
    files = []
    for number, text in enumerate(rules):
        files.append(tmp_path / f"rules{number}.lp")
        files[-1].write_bytes(text.encode("utf-8"))
    found = solve([KB / "interpretation.lp", *files], FACTS)
    return None if found is None else [str(atom) for atom in found]


def complaint(tmp_path: Path, *rules: str) -> str:
    with pytest.raises(BadInputError) as caught:
        answered(tmp_path, *rules)
    return str(caught.value)


def test_rules_are_added_to_ours(tmp_path: Path) -> None:
    assert answered(tmp_path, "kind(a, verge, 7).") == ["kind(a,floor,100)", "kind(a,verge,7)"]


def test_a_rule_that_contradicts_leaves_no_answer(tmp_path: Path) -> None:
    assert answered(tmp_path, ":- kind(_, floor, _).") is None


def test_a_runaway_rule_is_given_up(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(userrules, "SECONDS", 1.0)
    before = time.monotonic()
    said = complaint(tmp_path, "n(0). n(X+1) :- n(X), X < 2000000000.")
    assert "rules0.lp:1:1-1: error: these rules were given up" in said
    assert time.monotonic() - before < 20
    assert answered(tmp_path, "kind(a, verge, 8).")  # and the next question is answered


@pytest.mark.parametrize("char", ["\u00df", "\u201c", "\ufeff", "\u00a0"])
def test_what_is_not_ascii_is_refused_before_clingo_sees_it(tmp_path: Path, char: str) -> None:
    assert "rules0.lp:1:" in complaint(tmp_path, f"{char}kind(a, verge, 7).")


def test_an_error_is_told_where_it_is(tmp_path: Path) -> None:
    said = complaint(tmp_path, "% fine\n", "kind(a, verge, 7).\nkind(b, verge, 7.\n")
    assert "rules1.lp:2:" in said
    assert "kind(b, verge, 7." in said


def test_an_unknown_predicate_is_told_with_a_hint(tmp_path: Path) -> None:
    said = complaint(tmp_path, "lost(X) :- knid(X, verge, 99).\n#show lost/1.\n")
    assert "knid" in said
    assert "#defined" in said


@pytest.mark.parametrize("rule", ['#include "/etc/passwd".', "#script (python)\nimport os\n#end."])
def test_nothing_of_the_machine_can_be_reached(tmp_path: Path, rule: str) -> None:
    assert "rules0.lp:" in complaint(tmp_path, rule)
