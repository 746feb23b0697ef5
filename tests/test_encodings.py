"""Every encoding answers its cases, and every statement of it is needed by one of them."""

from pathlib import Path

import pytest

from tests.encoding_cases import (
    ENCODINGS,
    Case,
    case_text,
    cases_of,
    disagreement,
    optimal_answers,
    statements,
    without,
)
from utak.kb.language.diagnostics import BadInputError
from utak.kb.reasoning.solver import solve


def name(encoding: Path) -> str:
    return f"{encoding.parent.parent.name}-{encoding.stem}"


CASES = [pytest.param(e, case, id=f"{name(e)}: {case.title}") for e in ENCODINGS for case in cases_of(e)]
STATEMENTS = [
    (e, s) for e in ENCODINGS for s in statements(e) if not str(s).startswith("#false.") and str(s) != "#program base."
]


def place(part) -> str:  # type: ignore[no-untyped-def]
    """The name of an encoding, or the file and line of a statement."""
    if isinstance(part, Path):
        return name(part)
    return f"{Path(part.location.begin.filename).stem}:{part.location.begin.line}"


@pytest.mark.parametrize(("encoding", "case"), CASES)
def test_case(encoding: Path, case: Case) -> None:
    assert not disagreement(case, optimal_answers(case_text(encoding), case.facts))


@pytest.mark.long
@pytest.mark.parametrize(("encoding", "statement"), STATEMENTS, ids=place)
def test_every_statement_matters(encoding: Path, statement) -> None:
    rest = without(encoding, statement)
    assert any(disagreement(case, optimal_answers(rest, case.facts, strict=False)) for case in cases_of(encoding)), (
        f"no case tells whether this is there: {statement}"
    )


def test_there_are_encodings() -> None:
    assert {"interpretation", "rooms", "shapes", "deciding", "task"} <= {e.stem for e in ENCODINGS}


def test_a_misspelt_predicate_is_an_error(tmp_path: Path) -> None:
    rules = tmp_path / "rules.lp"
    rules.write_text("lost(X) :- knid(X, verge, 99).\n#show lost/1.\n")
    interpretation = next(e for e in ENCODINGS if e.stem == "interpretation")
    with pytest.raises(BadInputError, match="knid"):
        solve([interpretation, rules], ["region(a,zero,100)"])


@pytest.mark.parametrize("rule", ["lost(X) :- rim(X, verge).", "lost(X) :- kind(X, verge, 99)", "lost(X) :- ."])
def test_a_wrong_arity_and_a_syntax_error_are_errors(tmp_path: Path, rule: str) -> None:
    rules = tmp_path / "rules.lp"
    rules.write_text(f"{rule}\n#show lost/1.\n")
    interpretation = next(e for e in ENCODINGS if e.stem == "interpretation")
    with pytest.raises(BadInputError):
        solve([interpretation, rules], ["region(a,zero,100)"])


def test_a_rule_that_contradicts_is_an_error_of_its_file(tmp_path: Path) -> None:
    rules = tmp_path / "rules.lp"
    rules.write_text(":- kind(_, floor, _).\n")
    interpretation = next(e for e in ENCODINGS if e.stem == "interpretation")
    with pytest.raises(BadInputError, match=r"rules\.lp:1:1-1: error: this rule contradicts"):
        solve([interpretation, rules], ["region(a,zero,100)", "extent(a,3)"])
    assert solve([interpretation], ["region(a,zero,100)", "extent(a,3)"])
