"""Users' rules (`--kb FILE`) together with our encodings, solved in a separate process (kb.reasoning.worker).

clingo cannot be stopped while it grounds, and some bytes crash it. In a separate process, a rule that never ends, needs
too much memory or is no rule at all is only an error of its file. The rules are checked when they are read
(kb.reasoning.rulebook); the atoms that they derive are checked at each solving.
"""

import atexit
import re
import time
from collections.abc import Callable, Container, Iterable, Iterator, Sequence
from functools import cache, lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import clingo

from utak.kb.language.diagnostics import BadInputError, Problem, SourceSpan
from utak.kb.language.integers import integers_beyond_32_bits
from utak.kb.language.reader import MAX_TERM_DEPTH, facts_from_text
from utak.kb.language.source_text import Source, read_source
from utak.kb.language.terms import Fact
from utak.kb.language.tokens import Token, tokenize
from utak.kb.language.vocabulary import BELIEF_PREDICATES, Signature
from utak.kb.reasoning.encodings import BoundedAnswer, encoding_path, encoding_text
from utak.kb.reasoning.interfaces import ASKED_ENCODINGS, USER_RULE_INTERFACES
from utak.kb.reasoning.rulebook import INTERFACE_PREDICATES, Rulebook, Statement, statement_of, why_not_in_domain
from utak.kb.reasoning.sentences import RuleWords, read_sentences
from utak.kb.reasoning.worker import Worker

MAX_RULE_SECONDS = 10.0  # seconds of wall-clock time to read rules, or to solve one encoding with them; a convention
TOKENS_BETWEEN_CLOCKS = 1000  # tokens read between two looks at the clock: some milliseconds
MAX_CONFLICTS = 100_000  # conflicts of clingo's search for the best answer; bounds it on every machine alike


class RuleLimits(NamedTuple):
    """The limits of the work with users' rules."""

    seconds: float = MAX_RULE_SECONDS  # of wall-clock time, to read rules, or to solve one encoding with them
    conflicts: int = MAX_CONFLICTS  # of clingo's search for the best answer


RULE_LIMITS = RuleLimits()
# clingo's messages: line, first column, column after the last one, text.
CLINGO_MESSAGE = re.compile(r"<\w+>:(\d+):(\d+)(?:-(?:\d+:)?(\d+))?: (?:error|info|warning): (.*)", re.DOTALL)


def read_rules(paths: Sequence[Path | str], limits: RuleLimits = RULE_LIMITS) -> Rulebook:
    """Return the rules of some files, parsed and checked against the vocabulary."""
    return _rulebook(sources_of(paths), limits.seconds)


def sources_of(paths: Sequence[Path | str]) -> tuple[Source, ...]:
    """Return the texts of some files, in order; raise CannotOpenError or BadInputError where one cannot be read."""
    return tuple(read_source(path) for path in paths)


def read_tested_rules(paths: Sequence[Path | str], limits: RuleLimits = RULE_LIMITS) -> Rulebook:
    """Return the rules of some files after a test with every encoding that they reach."""
    return read_tested_sources(sources_of(paths), limits)


def read_tested_sources(sources: Sequence[Source], limits: RuleLimits = RULE_LIMITS) -> Rulebook:
    """Return the rules of some texts after the test of `read_tested_rules`, with the same limits and errors."""
    rules = _rulebook(tuple(sources), limits.seconds)
    if rules.self_contained:
        _solved_by_worker("", "", rules.self_contained, limits)
    for name in USER_RULE_INTERFACES:
        if reaching := rules.rules_reaching(name):
            encoding = encoding_path(name)
            _solved_by_worker(encoding.name, encoding_text(encoding), reaching, limits._replace(conflicts=0))
    if rules.query_rules:
        asked = {"facts": [], "query": "#true", "rules": [one.written for one in rules.query_rules], "number": 0}
        found = rules_worker().exchange(asked, limits.seconds)
        if "rule" in found:
            raise BadInputError([rules.query_rules[found["rule"]].problem(found["error"], hint=found["hint"])])
        if "limit" in found:
            raise _error_at_first_rule(rules.query_rules, f"these rules were given up: {found['limit']}, in queries")
    return rules


@lru_cache(maxsize=16)
def _rulebook(sources: tuple[Source, ...], seconds: float) -> Rulebook:
    """Return the checked rules of some sources together; raise BadInputError with the problems of all of them."""
    problems: list[Problem] = []
    statements: list[Statement] = []
    for source in sources:
        try:
            statements += _statements(source, seconds)
        except BadInputError as bad:
            problems += bad.problems
    if problems:
        raise BadInputError(problems)
    rules = Rulebook(statements)
    names = internal_names()
    if clashing := sorted(own for own in rules.own_predicates if own[0] in names):
        return Rulebook([one for source in sources for one in _statements(source, seconds, clashing)])
    return rules


@cache
def internal_names() -> frozenset[str]:
    """Return the names of all predicates and functions in the encodings that users' rules reach."""
    texts = (encoding_text(encoding_path(name)) for name in USER_RULE_INTERFACES)
    return frozenset(name for text in texts for name in re.findall(r"\b[a-z]\w*", text))


def _statements(source: Source, seconds: float, renamed: Sequence[Signature] = ()) -> list[Statement]:
    """Return the statements of one source, in order; at least one."""
    # Raises BadInputError when it is no file of rules, has no rule, or takes too much time or memory.
    end = time.monotonic() + seconds
    try:
        problems = list(_not_allowed(source, _until(end, tokenize(source, []))))
        if not problems:
            problems = list(integers_beyond_32_bits(source, _until(end, tokenize(source, []))))
    except TimeoutError:
        what = f"these rules were given up: it took more than {seconds:g} seconds to read them"
        raise BadInputError([source.problem(source.start(), what)]) from None
    if problems:
        raise BadInputError(problems)
    found = rules_worker().exchange({"read": source.text, "renamed": renamed}, max(0.0, end - time.monotonic()))
    if "limit" in found:
        raise BadInputError([source.problem(source.start(), f"these rules were given up: {found['limit']}")])
    if "message" in found:
        raise _error_at_place(source, found["message"])
    if "error" in found:
        raise BadInputError([source.problem(_span(found["at"]), found["error"], found["hint"])])
    if not found["statements"]:
        raise BadInputError([source.problem(source.start(), "there is no rule in this file")])
    statements = [statement_of(source, entry) for entry in found["statements"]]
    _, wrong = words_of_rules(source, statements)
    if wrong:
        raise BadInputError(wrong)
    return statements


def words_of_rules(source: Source, statements: Sequence[Statement]) -> tuple[RuleWords, tuple[Problem, ...]]:
    """Return the sentences of a user's rules (kb.reasoning.sentences), and the problems of its annotations."""
    rules = [(one.at, one.variables) for one in statements if one.declares is None]
    return read_sentences(source, rules)


def _until(end: float, tokens: Iterable[Token]) -> Iterator[Token]:
    """Yield tokens; raise TimeoutError after the moment `end`, in seconds of the monotonic clock."""
    for number, token in enumerate(tokens):
        if number % TOKENS_BETWEEN_CLOCKS == 0 and time.monotonic() > end:
            raise TimeoutError
        yield token


def _not_allowed(source: Source, tokens: Iterable[Token]) -> Iterator[Problem]:
    """Yield the problems of what must not reach clingo: `#include`, and brackets nested so deep that it would crash."""
    depth = 0
    for token in tokens:
        if token.text == "#include":
            yield source.problem(token.span, "#include is not allowed", "give each file with a --kb of its own")
        depth += (token.text == "(") - (token.text == ")")
        if depth > MAX_TERM_DEPTH:
            yield source.problem(token.span, f"brackets are nested more than {MAX_TERM_DEPTH} deep")
            return


def solve_with_user_rules(
    ours: Sequence[Path],
    users: Sequence[Path],
    facts: Sequence[str],
    conflicts: int | None = None,
    limits: RuleLimits = RULE_LIMITS,
    without: Container[str] = (),
) -> BoundedAnswer | None:
    """Return the best answer set of an encoding with users' rules."""
    rules = read_rules(users, limits)
    (encoding,) = ours
    reaching = [one for one in rules.rules_reaching(encoding.stem) if one.line not in without]
    if not reaching:
        return None
    if conflicts is not None:
        limits = limits._replace(conflicts=conflicts)
    return _solved(encoding, reaching, facts, limits, may_fail=conflicts is not None)


def rules_never_applied(users: Sequence[Path], applied: Container[str]) -> tuple[str, ...]:
    """Return the rules with a body that had no instance in any decision, in words, in the order of the files."""
    rules = read_rules(users) if users else Rulebook(())
    encodings = USER_RULE_INTERFACES.keys() - ASKED_ENCODINGS
    deciding = {one for name in encodings for one in rules.rules_reaching(name) if one.condition}
    what = "this rule never applied, for nothing was as it says"
    return tuple(
        f"{one.line}: {what}: {one.written.removeprefix('#false ')}{_said_of_short_forms(one)}"
        for one in rules.statements
        if one in deciding and one.place not in applied
    )


def _said_of_short_forms(one: Statement) -> str:
    """Return a hint for a rule that reads facts without their confidence; "" for any other."""
    short = sorted(
        {atom.signature for atom in one.body if (declared := BELIEF_PREDICATES.get(atom.signature)) and declared.long}
    )
    told = (
        f"{name}/{arity} holds where it is certain; {name}/{arity + 1} tells how likely it is" for name, arity in short
    )
    return "".join(f" ({hint})" for hint in told)


def predicates_read(encoding: str, users: Sequence[Path], lines: Container[str] | None = None) -> frozenset[Signature]:
    """Return the predicates in the bodies of users' rules, or of those at some lines, in an encoding."""
    # Raises CannotOpenError or BadInputError when the files are not valid.
    rules = read_rules(users).rules_reaching(encoding) if users else ()
    return frozenset(atom.signature for one in rules if lines is None or one.line in lines for atom in one.body)


def rules_reach(encoding: str, users: Sequence[Path]) -> bool:
    """Return whether any of some users' rules takes part in an encoding; its name is given without `.lp`."""
    # Raises CannotOpenError or BadInputError when the files are not valid.
    return bool(users) and bool(read_rules(users).rules_reaching(encoding))


def rules_speak_of(encoding: str, users: Sequence[Path], predicates: Iterable[Signature]) -> bool:
    """Return whether any of some users' rules that takes part in an encoding names one of some predicates."""
    meant, rules = frozenset(predicates), read_rules(users).rules_reaching(encoding) if users else ()
    return any(atom.signature in meant for one in rules for atom in (*one.heads, *one.body))


def rules_to_blame(
    encoding: Path,
    users: Sequence[Path],
    facts: Sequence[str],
    is_bad: Callable[[Sequence[clingo.Symbol]], bool],
    without: Container[str] = (),
) -> tuple[str, ...]:
    """Return the places of the rules because of which an answer is bad, such as `rules.lp:3`; () without such rules."""
    # Without any one of them the answer would not be bad.
    left = [one for one in read_rules(users).rules_reaching(encoding.stem) if one.line not in without]
    for one in reversed(left):
        fewer = [other for other in left if other is not one]
        atoms = _solved(encoding, fewer, facts, RULE_LIMITS, may_fail=True).atoms
        if atoms is None or is_bad(atoms):
            left = fewer
    return tuple(dict.fromkeys(one.line for one in left))


def _solved(
    encoding: Path, reaching: Sequence[Statement], facts: Sequence[str], limits: RuleLimits, may_fail: bool
) -> BoundedAnswer:
    """Return the best answer set of an encoding with some rules; arguments and errors as for solve_with_user_rules."""
    program = "\n".join([encoding_text(encoding), *(f"{fact}." for fact in facts)])
    found = _solved_by_worker(encoding.name, program, reaching, limits, may_fail)
    applied = tuple(reaching[number].place for number in found.get("applied", ()))
    if "atoms" not in found:
        return BoundedAnswer(None, "against" in found, applied=applied)
    given: dict[Signature, list[Fact]] = {}
    for fact in facts_from_text("".join(f"{fact}.\n" for fact in facts)):
        given.setdefault(fact.signature, []).append(fact)
    for text in found["derived"]:
        atom = _as_fact(text)
        why = "it is no fact" if atom is None else why_not_in_domain(encoding.stem, atom, given)
        if why:
            raise _error_at_source_rule(reaching, text, atom, f"these rules derive {text}, in {encoding.name}: {why}")
    atoms = sorted((clingo.parse_term(text) for text in found["atoms"]), key=str)
    return BoundedAnswer(tuple(atoms), found["proved"], tuple(map(tuple, found["cost"])), applied)


def _solved_by_worker(
    name: str, program: str, reaching: Sequence[Statement], limits: RuleLimits, may_fail: bool = False
) -> dict[str, Any]:
    """Return the worker's response to a program with users' rules; raise BadInputError when it has no answer."""
    heads = sorted({atom.signature for one in reaching for atom in one.heads if atom.signature in INTERFACE_PREDICATES})
    conditions = [one.condition for one in reaching]
    request = {"program": program, "rules": [one.text for one in reaching], "conditions": conditions, "heads": heads}
    found = rules_worker().exchange(request | {"conflicts": limits.conflicts}, limits.seconds)
    if "limit" in found:
        where = f", in {name}" if name else ""
        raise _error_at_first_rule(reaching, f"these rules were given up: {found['limit']}{where}")
    if "message" in found:
        message, place = found["message"], CLINGO_MESSAGE.search(found["message"])
        one = reaching[min(int(place[1]) if place else 1, len(reaching)) - 1]
        raise BadInputError([one.problem(_unsafe_variable_message(place[4] if place else message))])
    if "error" in found:
        line, column = found["at"]
        raise BadInputError([reaching[found["rule"]].problem(found["error"], (line, column))])
    if may_fail:
        return found
    if "cut" in found or (found.get("cost") and not found["proved"]):
        what = (
            f"the search for the best answer of {name or 'these rules'} was cut off: after {limits.conflicts} conflicts"
        )
        raise _error_at_first_rule(reaching, what)
    if "against" in found:
        blamed = [reaching[number] for number in found["against"]]
        first, *rest = sorted(blamed, key=lambda one: len(one.heads) > 0)  # a constraint before what it forbids
        what = "this rule leaves no answer, whatever is given: it contradicts itself"
        if name:
            what = f"this rule contradicts what must hold: {name} has no answer with it"
        others = ", ".join(one.line for one in rest)
        raise BadInputError([first.problem(what, hint=f"together with {others}" if others else "")])
    return found


def _as_fact(text: str) -> Fact | None:
    """Return the fact (name and arguments) that the text of a derived atom denotes; None when it is no valid fact."""
    try:
        (fact,) = facts_from_text(f"{text}.")
    except (BadInputError, ValueError):
        return None
    return fact


def _error_at_source_rule(reaching: Sequence[Statement], text: str, atom: Fact | None, what: str) -> BadInputError:
    """Return the error at the first rule that may have derived an atom; at the first rule when none may."""
    name = text.partition("(")[0]
    for one in reaching:
        for head in one.heads:
            if head.name == name and (atom is None or _may_have_derived(head.constants, atom)):
                return BadInputError([one.problem(what, head.at)])
    return _error_at_first_rule(reaching, what)


def _may_have_derived(constants: Sequence[str | None], atom: Fact) -> bool:
    """Return whether the constants of a head agree with an atom; None, for a variable, agrees with everything."""
    return len(constants) == len(atom.args) and all(
        constant is None or constant == str(term) for constant, term in zip(constants, atom.args, strict=True)
    )


def _error_at_first_rule(reaching: Sequence[Statement], what: str) -> BadInputError:
    """Return, not raise, the error with the message `what` at the first of the rules, which are at least one."""
    return BadInputError([reaching[0].problem(what)])


@cache
def rules_worker() -> Worker:
    """Return the handle of the separate process that all users' rules of this process share; it is ended at exit."""
    worker = Worker()
    atexit.register(worker.close)
    return worker


def _error_at_place(source: Source, message: str) -> BadInputError:
    """Return the error for a message of clingo's, at its place in the user's file."""
    place = CLINGO_MESSAGE.search(message)
    if place is None:
        return BadInputError([source.problem(source.start(), _one_line(message))])
    line, start, end = int(place[1]), int(place[2]), int(place[3] or place[2])
    if line > len(source.lines):  # the end of the file
        line, start = len(source.lines), len(source.lines[-1])
    return BadInputError([source.problem(SourceSpan(line, max(1, start), max(1, start, end - 1)), _one_line(place[4]))])


def _span(at: Sequence[int]) -> SourceSpan:
    """Return the span of one column: at is [line, column], both from 1."""
    return SourceSpan(at[0], at[1], at[1])


def _one_line(message: str) -> str:
    """Return the first line of a message of clingo's, with single blanks and without a colon at its end."""
    return " ".join(message.split("\n")[0].split()).rstrip(":")


def _unsafe_variable_message(message: str) -> str:
    """Return a message of clingo's in one line; a message of our own for an unsafe variable."""
    # clingo's own message would show the rewritten arithmetic.
    unsafe = re.findall(r"'(\w+)' is unsafe", message)
    if not unsafe:
        return _one_line(message)
    names = ", ".join(dict.fromkeys(unsafe))
    return f"nothing says what {names} can be: it must be in an atom that holds, not in a calculation alone"
