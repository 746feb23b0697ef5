"""Queries over the world model: the body of a rule, answered in a separate process that can be killed.

A query without variables has the answer yes, no or don't know. A query with variables has the rows of values for which
it certainly holds; when there is none, no or don't know. Besides the facts, queries can use `object(N)`, which stands
for `kind(N, object, C)`. `utak.kb.three_valued.evaluation` decides what is certain, possible or false, by the table
`BELIEF_PREDICATES` of kb.language.vocabulary; docs/files.md describes the rules.
"""

import math
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from types import TracebackType
from typing import Any, NamedTuple

from utak.kb.language.atoms import atom_parts
from utak.kb.language.diagnostics import BadInputError, Problem, SourceSpan
from utak.kb.language.integers import integers_beyond_32_bits
from utak.kb.language.reader import parse_facts
from utak.kb.language.source_text import source_from_bytes
from utak.kb.language.terms import Fact, Number
from utak.kb.language.vocabulary import BELIEF_PREDICATES, may_be_otherwise
from utak.kb.reasoning.encodings import KB_ENCODINGS, encoding_text
from utak.kb.reasoning.rulebook import Statement
from utak.kb.reasoning.worker import Worker
from utak.kb.tracing.possible_worlds import NATS

SHOW_STATEMENT = re.compile(r"^#show .*\.$", re.MULTILINE)
ALTERNATIVES = KB_ENCODINGS / "alternatives.lp"
MAX_QUERY_SECONDS = 5.0  # seconds of wall-clock time for one query, by default; a convention
MAX_QUERY_CHARACTERS = 10_000  # characters of a query; a convention
MAX_QUERIES_PER_WORKER = 20_000  # queries after which a new process answers, 0.1 s once; a convention
MAX_ANSWER_ROWS = 10_000  # rows of an answer, by default; a convention


class QueryLimitError(Exception):
    """A query took too much time or memory."""


@dataclass(frozen=True)
class QueryAnswer:
    """The answer to a query."""

    kind: str  # "bindings", "yes", "no" or "don't know"; "bindings" only for a query with variables
    variables: tuple[str, ...] = ()  # the names of the query's variables, in the order in which they appear
    # The values of the variables in each binding with which the query certainly holds, in the order of `variables`:
    # integers or terms as text. Sorted; empty unless kind is "bindings".
    rows: tuple[tuple[int | str, ...], ...] = ()
    more: bool = False  # whether there are more rows than `rows` holds
    # For each variable the name of the type of the argument in which it stands, such as `a confidence`; '' for none
    types: tuple[str, ...] = ()

    def __str__(self) -> str:
        """Return a table of the rows under the names of the variables, or the kind of the answer in words."""
        if self.kind != "bindings":
            return self.kind
        more = f"\n... and more than these {len(self.rows)} rows" if self.more else ""
        return plain_table(self.variables, self.rows) + more


def plain_table(columns: Sequence[str], rows: Sequence[Sequence[int | str]]) -> str:
    """Return a table as text, columns parted by two blanks, without a line end at the end.

    >>> print(plain_table(["X", "C"], [["o1", 90], ["o12", 5]]))
    X    C
    o1   90
    o12  5
    """
    cells = [list(columns), *([str(value) for value in row] for row in rows)]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    return "\n".join("  ".join(map(str.ljust, row, widths)).rstrip() for row in cells)


class PossibleWorld(NamedTuple):
    """One possible world: of the facts that are not settled, those that hold."""

    chance: float  # from 0 to 1
    facts: tuple[str, ...]


class Alternatives(NamedTuple):
    """The likeliest possible worlds of a step, and what is open in them."""

    worlds: tuple[PossibleWorld, ...]  # the likeliest ones, the likeliest first
    # (fact, its least and greatest chance, the acts that would decide it) of each fact that is not settled
    open: tuple[tuple[str, float, float, tuple[str, ...]], ...]


class QueryEngine:
    """Answers queries one after another in one separate process; leaving a `with` statement ends the process."""

    def __init__(self, seconds: float = MAX_QUERY_SECONDS, rules: Sequence[str] = ()) -> None:
        self.seconds = seconds
        self._files: tuple[str, ...] = ()
        self._rules: Sequence[Statement] = ()
        self._weighing: Sequence[Statement] = ()  # those about possible worlds
        self._worker = Worker()
        self._facts: tuple[str, ...] | None = None  # the facts of the last query
        self._entries: list[list[int | str]] = []  # the same as the worker takes them
        self._number = 0  # of these facts; the worker holds the facts of one number
        self._asked = 0  # queries since the worker was started
        self.use_rules(rules)

    def __enter__(self) -> "QueryEngine":
        """Return the engine itself."""
        return self

    def __exit__(self, kind: type[BaseException] | None, value: BaseException | None, at: TracebackType | None) -> None:
        """End the separate process; an exception is not suppressed."""
        self.close()

    @property
    def process_id(self) -> int | None:
        """The number of the separate process; None while none runs."""
        return self._worker.process_id

    def use_rules(self, rules: Sequence[str]) -> None:
        """Use the rules of these files, and no others, in all further queries."""
        files = tuple(map(str, rules))
        if files == self._files:
            return
        from utak.kb.reasoning.user_rules import read_rules  # imported only when there are users' rules: it takes time

        read = read_rules(files) if files else None
        self._rules = read.query_rules if read is not None else ()
        self._weighing = read.rules_reaching(ALTERNATIVES.stem) if read is not None else ()
        self._files, self._facts = files, None

    def close(self) -> None:
        """End the separate process, if it runs; the next query starts another one."""
        self._asked = 0
        self._worker.close()

    def ask(self, facts: Sequence[str], query: str, max_rows: int = MAX_ANSWER_ROWS) -> QueryAnswer:
        """Return the answer to a query."""
        text = query.strip().removeprefix("?-").strip().removesuffix(".").strip()
        _check_query(text)
        found = self._exchange(facts, {"query": text, "max_rows": max_rows})
        if "limit" in found:
            raise QueryLimitError(f"the query was given up: {found['limit']}")
        if "rule" in found:
            raise BadInputError([self._rules[found["rule"]].problem(found["error"], hint=found["hint"])])
        if "error" in found:
            raise _query_error(text, found["error"], found["at"], found["hint"])
        return QueryAnswer(
            found["answer"],
            tuple(found["variables"]),
            tuple(map(tuple, found["rows"])),
            found["more"],
            tuple(found["types"]),
        )

    def worlds(self, facts: Sequence[str], number: int) -> Alternatives:
        """Return the likeliest possible worlds over facts, and what is not settled in them."""
        asked = worlds_request(facts, (one.text for one in self._weighing), number)
        found = self._worker.exchange({"worlds": asked}, self.seconds)
        if "limit" in found:
            raise QueryLimitError(f"the worlds were given up: {found['limit']}")
        if "failed" in found:
            raise _query_error("worlds", found["failed"], hint="users' rules may forbid all")
        return Alternatives(
            tuple(PossibleWorld(chance, tuple(facts)) for chance, facts in found["worlds"]),
            tuple((fact, least, greatest, tuple(acts)) for fact, least, greatest, acts in found["open"]),
        )

    def _exchange(self, facts: Sequence[str], request: dict[str, Any]) -> dict[str, Any]:
        """Return the worker's response to a query over facts; the facts are sent only when it does not hold them."""
        # The worker is ended after MAX_QUERIES_PER_WORKER queries: clingo never forgets a name, so it would grow.
        # Raises BadInputError for facts with syntax errors.
        if self._asked >= MAX_QUERIES_PER_WORKER:
            self.close()
        if self._facts != (asked := tuple(facts)):
            self._facts, self._entries = asked, request_entries(facts)
            self._number += 1
        self._asked += 1
        request = request | {"number": self._number}
        found = self._worker.exchange(request, self.seconds)
        if "unknown" in found:
            whole = request | {"facts": self._entries, "rules": [one.written for one in self._rules]}
            found = self._worker.exchange(whole, self.seconds)
        return found


def request_entries(facts: Sequence[str]) -> list[list[int | str]]:
    """Return the facts of a world model as the worker takes them; BadInputError when a text is no fact."""
    text = "\n".join(fact if fact.rstrip().endswith(".") else f"{fact}." for fact in facts)
    world = parse_facts(source_from_bytes("belief", text.encode("utf-8")))
    return [_request_entry(fact) for fact in world]


def _request_entry(fact: Fact) -> list[int | str]:
    """Return a fact as the worker takes it: [name, argument, ...], arguments as integers or as the text of terms."""
    return [fact.name, *(term.value if isinstance(term, Number) else str(term) for term in fact.args)]


def _alternatives_facts(facts: Iterable[str]) -> list[str]:
    """Return what kb/asp/alternatives.lp is given about the facts of a step, all without their full stops."""
    stated: dict[str, int] = {}
    for fact in facts:
        name, arguments = atom_parts(fact.removesuffix("."))
        declared = BELIEF_PREDICATES.get((name, len(arguments)))
        if declared is not None and declared.confident and may_be_otherwise(name, arguments[0]):
            stated[f"{name}({','.join(arguments[:-1])})"] = int(arguments[-1])
    weights = (f"weight({percent},{round(-NATS * math.log(percent / 100))})" for percent in range(1, 101))
    return [*(f"stated({fact},{confidence})" for fact, confidence in stated.items()), *weights]


def worlds_request(facts: Iterable[str], rules: Iterable[str], number: int) -> dict[str, Any]:
    """Return the arguments of `likeliest_worlds` for the facts of a step: the process that solves opens no file."""
    # Without #show: what holds in all worlds, or in some, is asked of every atom.
    encoding = SHOW_STATEMENT.sub("", encoding_text(ALTERNATIVES))
    program = [*rules, encoding, *(f"{fact}." for fact in _alternatives_facts(facts))]
    return {"program": "\n".join(program), "number": number}


def _query_error(text: str, what: str, at: Sequence[int] = (1, 0), hint: str = "") -> BadInputError:
    """Return the error with the message `what` at a line and column of the query, from 1."""
    lines = text.split("\n")
    number, column = at if at[0] <= len(lines) else (len(lines), 0)  # beyond the end: something is missing at the end
    line = lines[number - 1]
    span = SourceSpan(number, column, column) if 1 <= column <= len(line) else SourceSpan(number, 1, max(1, len(line)))
    return BadInputError([Problem("query", span, what, line, hint)])


def _check_query(text: str) -> None:
    """Raise BadInputError when a text cannot be a query: empty, too long, with comments or with too great integers."""
    if not text:
        raise _query_error(text, "the query is empty", hint="such as object(X), shape(X, square, C)")
    if len(text) > MAX_QUERY_CHARACTERS:
        raise _query_error(text[:100], f"a query has at most {MAX_QUERY_CHARACTERS} characters")
    if "%" in re.sub(r'"(?:[^"\\]|\\.)*"', "", text):
        raise _query_error(text, "a query has no comments")
    problems = list(integers_beyond_32_bits(source_from_bytes("query", text.encode("utf-8", errors="surrogateescape"))))
    if problems:
        raise BadInputError(problems)
