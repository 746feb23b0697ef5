"""Small cases for the encodings: facts, and the atoms that hold in every, in some, or in no optimal answer.

A file `cases/NAME.lp` beside the tests of a package belongs to the encoding `PACKAGE/asp/NAME.lp`, or to the folder
`PACKAGE/asp/NAME`. In it `%% TITLE` begins a case;
facts stand as they are; `%every`, `%some` and `%never` are followed by shown atoms, and `%none` says that there is no
answer.
"""

from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

import clingo
import clingo.ast

from utak.kb.reasoning.encodings import SHARED_PARTS, all_encodings, encoding_files

ROOT = Path(__file__).resolve().parent.parent
ENCODINGS = all_encodings()
CASE_PRIORS = ROOT / "tests" / "kb" / "case_priors.lp"  # in the place of the priors that were counted


class Case(NamedTuple):
    """One case: atoms, as clingo writes them, of every, some and no optimal answer; and whether there is an answer."""

    title: str
    facts: str
    every: frozenset[str]
    some: frozenset[str]
    never: frozenset[str]
    answers: bool


def case_file(encoding: Path) -> Path:
    """Return the file with the cases of an encoding."""
    return ROOT / "tests" / encoding.parent.parent.name / "cases" / f"{encoding.stem}.lp"


def case_files(encoding: Path) -> tuple[Path, ...]:
    """Return the files of an encoding, with the priors of its cases."""
    return tuple(CASE_PRIORS if path.stem in SHARED_PARTS else path for path in encoding_files(encoding))


def case_text(encoding: Path) -> str:
    """Return the text of an encoding, with the priors of its cases."""
    return "\n".join(path.read_text() for path in case_files(encoding))


def cases_of(encoding: Path) -> list[Case]:
    """Return the cases of an encoding."""
    parts = case_file(encoding).read_text().split("%% ")[1:]
    return [_case(*part.split("\n", 1)) for part in parts]


def _case(title: str, body: str) -> Case:
    lines = body.splitlines()
    told = {
        word: _atoms(line[len(word) :] for line in lines if line.startswith(word))
        for word in ("%every", "%some", "%never")
    }
    facts = "\n".join(line for line in lines if not line.startswith("%"))
    return Case(title, facts, told["%every"], told["%some"], told["%never"], "%none" not in lines)


def _atoms(texts: Iterable[str]) -> frozenset[str]:
    """Return atoms separated by full stops, as clingo writes them."""
    words = [word.strip() for text in texts for word in text.split(".")]
    return frozenset(str(clingo.parse_term(word)) for word in words if word)


def statements(encoding: Path) -> list[clingo.ast.AST]:
    """Return the rules and optimisation statements of an encoding, without the priors."""
    found: list[clingo.ast.AST] = []
    files = [path for path in case_files(encoding) if path != CASE_PRIORS]
    clingo.ast.parse_files(list(map(str, files)), found.append)
    return [s for s in found if s.ast_type in (clingo.ast.ASTType.Rule, clingo.ast.ASTType.Minimize)]


def without(encoding: Path, dropped: clingo.ast.AST) -> str:
    """Return the text of an encoding with one statement left out; what only it derived stays declared."""
    found: list[clingo.ast.AST] = []
    clingo.ast.parse_files(list(map(str, case_files(encoding))), found.append)
    return "\n".join(str(s) for s in found if s.location != dropped.location)


def optimal_answers(program: str, facts: str, strict: bool = True) -> list[frozenset[str]]:
    """Return the shown atoms of each optimal answer; with `strict` a message of clingo is an error."""
    messages: list[str] = []
    control = clingo.Control(["--opt-mode=optN", "0"], logger=lambda _code, text: messages.append(text))
    control.add("base", [], f"{program}\n{facts}")
    control.ground([("base", [])])
    assert not (strict and messages), messages
    answers: list[frozenset[str]] = []

    def keep(model: clingo.Model) -> None:
        if model.optimality_proven or not model.cost:
            answers.append(frozenset(map(str, model.symbols(shown=True))))

    control.solve(on_model=keep)
    return answers


def disagreement(case: Case, answers: list[frozenset[str]]) -> str:
    """Return what is wrong with the answers to a case; '' if nothing is."""
    if bool(answers) != case.answers:
        return f"{len(answers)} answers"
    if not answers:
        return ""
    all_, any_ = frozenset.intersection(*answers), frozenset.union(*answers)
    wrong = [
        ("not in every answer", case.every - all_),
        ("in no answer", case.some - any_),
        ("in an answer", case.never & any_),
    ]
    return "; ".join(f"{what}: {sorted(atoms)}" for what, atoms in wrong if atoms)
