"""The user's own rules (`--kb FILE`) beside our encodings, worked on in a process that can be killed
(kb.reasoning.worker).

Clingo cannot be stopped while it grounds, and some bytes kill it. So a rule that never ends, needs too much memory or
is no rule at all is an error of its file, and nothing worse. What rules say is checked when they are read
(kb.reasoning.rulebook), and what they derive each time that they are asked.
"""

import atexit
import re
from collections.abc import Iterator, Sequence
from functools import cache, lru_cache
from pathlib import Path
from typing import Any

import clingo

from kb.language.diagnostics import BadInputError, Problem, Span
from kb.language.integers import integers_beyond_32_bits
from kb.language.reader import MAX_TERM_DEPTH, facts_of
from kb.language.source_text import Source, read_source
from kb.language.terms import Fact
from kb.language.tokens import tokenize
from kb.reasoning.interfaces import REACHED, Signature
from kb.reasoning.rulebook import DECLARED, Rulebook, Statement, misfit, statement_of
from kb.reasoning.worker import Worker

KB = Path(__file__).resolve().parent.parent / "asp"
SECONDS = 10.0  # of work on one question with the user's rules
CONFLICTS = 100_000  # of the search, after which it is cut off
PLACE = re.compile(r"<\w+>:(\d+):(\d+)(?:-(?:\d+:)?(\d+))?: (?:error|info|warning): (.*)", re.DOTALL)


def read_rules(paths: Sequence[Path | str]) -> Rulebook:
    """Return the rules of some files; raises CannotOpenError, or BadInputError with what is wrong with them."""
    return _rulebook(tuple(read_source(path) for path in paths))


def checked_rules(paths: Sequence[Path | str]) -> Rulebook:
    """Return the rules of some files once they were tried out: as `read_rules`, and raises for more.

    What contradicts or never ends whatever is given, and what can be worked out in no case, is found here.
    """
    rules = read_rules(paths)
    if rules.alone:
        _answered("", "", rules.alone)
    for name in REACHED:
        if counting := rules.counting(name):
            _answered(f"{name}.lp", (KB / f"{name}.lp").read_text(), counting, search=False)
    if rules.queried:
        asked = {"facts": [], "query": "#true", "rules": [one.written for one in rules.queried]}
        found = _worker().exchange(asked, SECONDS)
        if "rule" in found:
            raise BadInputError([rules.queried[found["rule"]].problem(found["error"], hint=found["hint"])])
    return rules


@lru_cache(maxsize=16)
def _rulebook(sources: tuple[Source, ...]) -> Rulebook:
    problems: list[Problem] = []
    statements: list[Statement] = []
    for source in sources:
        try:
            statements += _statements(source)
        except BadInputError as bad:
            problems += bad.problems
    if problems:
        raise BadInputError(problems)
    return Rulebook(statements)


def _statements(source: Source) -> list[Statement]:
    problems = [*integers_beyond_32_bits(source), *_not_taken(source)]
    if problems:
        raise BadInputError(problems)
    found = _worker().exchange({"read": source.text}, SECONDS)
    if "limit" in found:
        raise BadInputError([source.problem(source.start(), f"these rules were given up: {found['limit']}")])
    if "message" in found:
        raise _located(source, found["message"])
    if "error" in found:
        raise BadInputError([source.problem(_span(found["at"]), found["error"], found["hint"])])
    if not found["statements"]:
        raise BadInputError([source.problem(source.start(), "there is no rule in this file")])
    return [statement_of(source, entry) for entry in found["statements"]]


def _not_taken(source: Source) -> Iterator[Problem]:
    """What clingo must not see: other files, and brackets so deep that it would break down."""
    depth = 0
    for token in tokenize(source, []):
        if token.text == "#include":
            yield source.problem(token.span, "#include is not allowed", "give each file with a --kb of its own")
        depth += (token.text == "(") - (token.text == ")")
        if depth > MAX_TERM_DEPTH:
            yield source.problem(token.span, f"brackets are nested more than {MAX_TERM_DEPTH} deep")
            return


def solve_apart(ours: Sequence[Path], users: Sequence[Path], facts: Sequence[str]) -> list[clingo.Symbol] | None:
    """The shown atoms of the best answer set, found in another process; None when no rule counts in this encoding.

    Raises CannotOpenError, and BadInputError when the users' rules are none, contradict what is given, derive what
    cannot be, or take too long or too much memory.
    """
    rules = read_rules(users)
    (encoding,) = ours
    counting = rules.counting(encoding.stem)
    if not counting:
        return None
    program = "\n".join([encoding.read_text(), *(f"{fact}." for fact in facts)])
    found = _answered(encoding.name, program, counting)
    given: dict[Signature, list[Fact]] = {}
    for fact in facts_of("".join(f"{fact}.\n" for fact in facts)):
        given.setdefault(fact.signature, []).append(fact)
    for text in found["derived"]:
        atom = _fact(text)
        why = "it is no fact" if atom is None else misfit(encoding.stem, atom, given)
        if why:
            raise _blamed(counting, text, atom, f"these rules derive {text}, in {encoding.name}: {why}")
    return [clingo.parse_term(text) for text in found["atoms"]]


def _answered(name: str, program: str, counting: Sequence[Statement], search: bool = True) -> dict[str, Any]:
    """What the worker answers to a program of ours with rules; raises BadInputError when it has no answer.

    name : of the program, for messages. search : for the best answer; else rules are only tried out.
    """
    heads = sorted({atom.signature for one in counting for atom in one.heads if atom.signature in DECLARED})
    request = {"program": program, "rules": [one.text for one in counting], "heads": heads}
    found = _worker().exchange(request | {"conflicts": CONFLICTS if search else 0}, SECONDS)
    if "limit" in found:
        where = f", in {name}" if name else ""
        raise _together(counting, f"these rules were given up: {found['limit']}{where}")
    if "message" in found:
        message, place = found["message"], PLACE.search(found["message"])
        one = counting[min(int(place[1]) if place else 1, len(counting)) - 1]
        raise BadInputError([one.problem(_said(place[4] if place else message))])
    if "error" in found:
        line, column = found["at"]
        raise BadInputError([counting[found["rule"]].problem(found["error"], (line, column))])
    if "cut" in found:
        what = f"the search for the best answer of {name or 'these rules'} was cut off: {found['cut']}"
        raise _together(counting, what)
    if "against" in found:
        blamed = [counting[number] for number in found["against"]]
        first, *rest = sorted(blamed, key=lambda one: len(one.heads) > 0)  # a constraint before what it forbids
        what = "this rule leaves no answer, whatever is given: it contradicts itself"
        if name:
            what = f"this rule contradicts what must hold: {name} has no answer with it"
        others = ", ".join(f"{one.source.file}:{one.at[0]}" for one in rest)
        raise BadInputError([first.problem(what, hint=f"together with {others}" if others else "")])
    return found


def _fact(text: str) -> Fact | None:
    try:
        (fact,) = facts_of(f"{text}.")
    except (BadInputError, ValueError):
        return None
    return fact


def _blamed(counting: Sequence[Statement], text: str, atom: Fact | None, what: str) -> BadInputError:
    """The error at the first rule that may have derived an atom."""
    name = text.partition("(")[0]
    for one in counting:
        for head in one.heads:
            if head.name == name and (atom is None or _may_be(head.constants, atom)):
                return BadInputError([one.problem(what, head.at)])
    return _together(counting, what)


def _may_be(constants: Sequence[str | None], atom: Fact) -> bool:
    return len(constants) == len(atom.args) and all(
        constant is None or constant == str(term) for constant, term in zip(constants, atom.args, strict=True)
    )


def _together(counting: Sequence[Statement], what: str) -> BadInputError:
    return BadInputError([counting[0].problem(what)])


@cache
def _worker() -> Worker:
    worker = Worker()
    atexit.register(worker.close)
    return worker


def _located(source: Source, message: str) -> BadInputError:
    """The error at the place in the user's file of which clingo speaks."""
    place = PLACE.search(message)
    if place is None:
        return BadInputError([source.problem(source.start(), _plain(message))])
    line, start, end = int(place[1]), int(place[2]), int(place[3] or place[2])
    if line > len(source.lines):  # the end of the file
        line, start = len(source.lines), len(source.lines[-1])
    return BadInputError([source.problem(Span(line, max(1, start), max(1, start, end - 1)), _plain(place[4]))])


def _span(at: Sequence[int]) -> Span:
    return Span(at[0], at[1], at[1])


def _plain(message: str) -> str:
    """A message of clingo's in one line, without the program's text as it was rewritten."""
    return " ".join(message.split("\n")[0].split()).rstrip(":")


def _said(message: str) -> str:
    """A message of clingo's on a rule whose arithmetic was rewritten."""
    unsafe = re.findall(r"'(\w+)' is unsafe", message)
    if not unsafe:
        return _plain(message)
    names = ", ".join(dict.fromkeys(unsafe))
    return f"nothing says what {names} can be: it must be in an atom that holds, not in a calculation alone"
