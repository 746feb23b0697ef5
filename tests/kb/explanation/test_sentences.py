"""The sentences of the shipped encodings: every rule has one, and every predicate reads in two ways."""

import re
import time
from pathlib import Path

import clingo
import clingo.ast
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.encoding_cases import ENCODINGS, ROOT, statements
from utak.kb.explanation.programs import decision_program, encoding_names
from utak.kb.language.diagnostics import MAX_PROBLEMS_PER_FILE, format_problems
from utak.kb.language.source_text import source_from_bytes
from utak.kb.language.vocabulary import BELIEF_PREDICATES
from utak.kb.reasoning.encodings import encoding_files
from utak.kb.reasoning.sentences import fill, placeholders, read_sentences

GIVEN_UP = 30.0  # seconds of processor time: many times what linear reading takes, far less than quadratic one
NAMES = [encoding.stem for encoding in ENCODINGS]


def predicates(encoding: Path) -> set[tuple[str, int]]:
    """Return the predicates of an encoding, read from its text by clingo."""
    found: set[tuple[str, int]] = set()

    class Collector(clingo.ast.Transformer):
        def visit_SymbolicAtom(self, node: clingo.ast.AST) -> clingo.ast.AST:  # noqa: N802
            pooled = node.symbol.ast_type == clingo.ast.ASTType.Pool
            for symbol in node.symbol.arguments if pooled else [node.symbol]:
                found.add((symbol.name, len(symbol.arguments)))
            return node

    parts: list[clingo.ast.AST] = []
    clingo.ast.parse_files(list(map(str, encoding_files(encoding))), parts.append)
    for part in parts:
        if part.ast_type in (clingo.ast.ASTType.Rule, clingo.ast.ASTType.Minimize):
            Collector().visit(part)
        elif part.ast_type == clingo.ast.ASTType.Defined:
            found.add((part.name, part.arity))
    return {one for one in found if not one[0].startswith("#")}


def test_there_are_fourteen_encodings() -> None:
    assert encoding_names() == tuple(sorted(NAMES)) and len(NAMES) == 14


def place_of(statement: clingo.ast.AST) -> tuple[str, int, int]:
    """Return file, line and column at which a statement of an encoding begins."""
    begin = statement.location.begin
    return Path(begin.filename).relative_to(ROOT).as_posix(), begin.line, begin.column


@pytest.mark.parametrize("encoding", ENCODINGS, ids=lambda path: path.stem)
def test_every_rule_has_a_sentence_about_its_own_variables(encoding: Path) -> None:
    shipped = {place_of(s): s for s in statements(encoding)}
    files = {file for file, _, _ in shipped}
    own = (unit.rule for unit in decision_program(encoding.stem).units if unit.rule.file in files)
    rules = {(rule.file, rule.line, rule.column): rule for rule in own}
    written = {at: s for at, s in shipped.items() if str(s) != "#false."}
    assert rules.keys() == written.keys()
    for at, rule in rules.items():
        assert rule.sentence.endswith("."), (at, rule.sentence)
        assert rule.sentence[0].isupper() or rule.sentence[0] == "{", (at, rule.sentence)
        assert set(placeholders(rule.sentence)) <= set(re.findall(r"\b[A-Z]\w*", str(written[at]))), at
        line = (ROOT / rule.file).read_text().splitlines()[rule.line - 2]
        assert line.startswith("%!"), f"{rule.file}:{rule.line}: the sentence stands directly before the rule"


@pytest.mark.parametrize("encoding", ENCODINGS, ids=lambda path: path.stem)
def test_every_predicate_reads_in_two_ways(encoding: Path) -> None:
    words = decision_program(encoding.stem).words
    known = predicates(encoding)
    if encoding.stem == "belief":  # with the short forms
        known |= {(name, arity - 1) for name, arity in known if BELIEF_PREDICATES[name, arity].short}
    assert set(words) == known
    for one in words.values():
        assert one.holds and one.absent and one.holds != one.absent
        assert not re.search(r"\bfalse\b", one.absent)


@pytest.mark.parametrize(
    ("template", "values", "text"),
    [
        ("{N/10} squares", {"N": "25"}, "2.5 squares"),
        ("{N/10} squares", {"N": "10"}, "1 square"),
        ("{N/100} squares", {"N": "-5"}, "-0.05 squares"),
        ("{N/100}", {"N": "300"}, "3"),
        ("{N/10}", {"N": "any"}, "any"),
        ("{N} squares of {R}", {"N": "1", "R": "a"}, "1 square of a"),
        ("{N} squares", {"N": "21"}, "21 squares"),
        ("{N}", {}, "some"),
        ("{X}", {"X": "{Y}"}, "{Y}"),
    ],
)
def test_placeholders_are_filled(template: str, values: dict[str, str], text: str) -> None:
    assert fill(template, values) == text


@given(st.integers(-(10**6), 10**6), st.sampled_from([10, 100]))
def test_decimal_numbers_are_exact(number: int, divisor: int) -> None:
    shown = fill(f"{{N/{divisor}}}", {"N": str(number)})
    assert round(float(shown) * divisor) == number
    assert not shown.endswith(".") and not re.search(r"\.\d*0$", shown)


@given(st.text(alphabet='%!becaus {}"\\XR.:-~[]@1\n*_(),', max_size=60))
def test_whatever_stands_in_annotations_is_read_or_located(text: str) -> None:
    source = source_from_bytes("some.lp", text.encode())
    _, problems = read_sentences(source, [((1, 1), ["X", "R"])])
    for problem in problems:
        assert 1 <= problem.span.line <= len(source.lines) and 1 <= problem.span.start <= problem.span.end
        assert problem.span.start <= len(source.lines[problem.span.line - 1]) + 1


@pytest.mark.parametrize(
    ("text", "problems"),
    [
        ('%! because "' + '\\"' * 300_000, 1),  # a quote that nothing closes, with a quote in each place within
        ('%! because "' + "".join(f"{{A{n}}}" for n in range(100_000)) + '"', MAX_PROBLEMS_PER_FILE),
    ],
)
def test_the_time_to_read_annotations_grows_linearly(text: str, problems: int) -> None:
    source = source_from_bytes("some.lp", f"{text}\np(X).".encode())
    began = time.process_time()
    _, found = read_sentences(source, [((2, 1), ["X"])])
    assert len(found) == problems
    assert len(format_problems(found)) < 100_000
    assert time.process_time() - began < GIVEN_UP
