"""Queries over the world model: the body of a rule, answered in a separate process that can be killed.

A query without variables has the answer yes, no or don't know. A query with variables has the rows of values for which
it certainly holds; when there is none, no or don't know. Besides the facts, queries can use `object(N)`, which stands
for `kind(N, object, C)`. `kb.three_valued.evaluation` decides what is certain, possible or false, by the table
`BELIEF_PREDICATES`
of kb.language.vocabulary; docs/files.md describes the rules.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from types import TracebackType

from kb.language.diagnostics import BadInputError, Problem, SourceSpan
from kb.language.integers import integers_beyond_32_bits
from kb.language.reader import parse_facts
from kb.language.source_text import source_from_bytes
from kb.language.terms import Fact, Number
from kb.language.vocabulary import BELIEF_PREDICATES
from kb.reasoning.rulebook import Statement
from kb.reasoning.worker import Worker

MAX_QUERY_SECONDS = 5.0  # seconds of wall-clock time for one query, by default; a convention
MAX_QUERY_CHARACTERS = 10_000  # characters of a query; a convention
MAX_ANSWER_ROWS = 10_000  # rows of an answer, by default; a convention
QUERY_PREDICATES = tuple(
    BELIEF_PREDICATES
)  # the predicates of which queries can be made, by name and number of arguments


class QueryLimitError(Exception):
    """A query took too much time or memory."""


@dataclass(frozen=True)
class QueryAnswer:
    """The answer to a query.

    Attributes
    ----------
    kind : "bindings", "yes", "no" or "don't know"; "bindings" only for a query with variables.
    variables : the names of the query's variables, in the order in which they appear.
    rows : the values of the variables in each binding with which the query certainly holds, in the order of
        `variables`: integers or terms as text. Sorted; empty unless kind is "bindings".
    more : whether there are more rows than `rows` holds.
    """

    kind: str
    variables: tuple[str, ...] = ()
    rows: tuple[tuple[int | str, ...], ...] = ()
    more: bool = False

    def __str__(self) -> str:
        """Return a table of the rows under the names of the variables, or the kind of the answer in words.

        Without a line end at the end; a last line says so when there are more rows.
        """
        if self.kind != "bindings":
            return self.kind
        cells = [list(self.variables), *([str(value) for value in row] for row in self.rows)]
        widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
        lines = ["  ".join(map(str.ljust, row, widths)).rstrip() for row in cells]
        return "\n".join([*lines, f"... and more than these {len(self.rows)} rows"] if self.more else lines)


class QueryEngine:
    """Answers queries one after another in one separate process; leaving a `with` statement ends the process.

    Parameters
    ----------
    seconds : the limit of wall-clock time for each query.
    rules : the paths of files with users' rules; () for none. Queries can use the predicates that these rules define.

    Attributes
    ----------
    seconds : the limit of wall-clock time for each query.
    """

    def __init__(self, seconds: float = MAX_QUERY_SECONDS, rules: Sequence[str] = ()) -> None:
        self.seconds = seconds
        self._rules: Sequence[Statement] = ()
        if rules:
            from kb.reasoning.user_rules import read_rules  # imported only when there are users' rules: it takes time

            self._rules = read_rules(rules).query_rules
        self._worker = Worker()

    def __enter__(self) -> "QueryEngine":
        """Return the engine itself."""
        return self

    def __exit__(self, kind: type[BaseException] | None, value: BaseException | None, at: TracebackType | None) -> None:
        """End the separate process; an exception is not suppressed."""
        self.close()

    def close(self) -> None:
        """End the separate process, if it runs; the next query starts another one."""
        self._worker.close()

    def ask(self, facts: Sequence[str], query: str, max_rows: int = MAX_ANSWER_ROWS) -> QueryAnswer:
        """Return the answer to a query.

        Parameters
        ----------
        facts : the world model, such as `kind(o1,object,95).`, one fact a text, with full stops.
        query : the body of a rule on one line; `?-` before it and a full stop after it are ignored.
        max_rows : the greatest number of rows of the answer; further rows are left out.

        Returns
        -------
        The answer: its kind ("yes", "no", "don't know", or "bindings" for rows), the names of the query's variables in
        the order in which they appear, the sorted rows of values (integers, or terms as text) for which the query
        certainly holds, and whether rows were left out.

        Raises
        ------
        BadInputError : the query, a fact or one of the rules has an error.
        QueryLimitError : the query takes too much time or memory.
        """
        text = query.strip().removeprefix("?-").strip().removesuffix(".").strip()
        _check_query(text)
        request = {
            "facts": request_entries(facts),
            "query": text,
            "rules": [one.written for one in self._rules],
            "max_rows": max_rows,
        }
        found = self._worker.exchange(request, self.seconds)
        if "limit" in found:
            raise QueryLimitError(f"the query was given up: {found['limit']}")
        if "rule" in found:
            raise BadInputError([self._rules[found["rule"]].problem(found["error"], hint=found["hint"])])
        if "error" in found:
            raise _query_error(text, found["error"], found["at"], found["hint"])
        return QueryAnswer(found["answer"], tuple(found["variables"]), tuple(map(tuple, found["rows"])), found["more"])


def request_entries(facts: Sequence[str]) -> list[list[int | str]]:
    """Return the facts of a world model as the worker takes them; BadInputError when a text is no fact.

    facts : one fact a text, with or without full stops.
    """
    text = "\n".join(fact if fact.rstrip().endswith(".") else f"{fact}." for fact in facts)
    world = parse_facts(source_from_bytes("belief", text.encode("utf-8")))
    return [_request_entry(fact) for fact in world]


def _request_entry(fact: Fact) -> list[int | str]:
    """Return a fact as the worker takes it: [name, argument, ...], arguments as integers or as the text of terms."""
    return [fact.name, *(term.value if isinstance(term, Number) else str(term) for term in fact.args)]


def _query_error(text: str, what: str, at: int = 0, hint: str = "") -> BadInputError:
    """Return the error with the message `what` at a character of the query, from 1; at the whole query for 0.

    The error is returned, not raised; it carries one problem, in a file named "query", line 1.

    text : the query. hint : a remedy, or '' for none.
    """
    line = text.split("\n")[0]
    span = SourceSpan(1, at, at) if 1 <= at <= len(line) else SourceSpan(1, 1, max(1, len(line)))
    return BadInputError([Problem("query", span, what, line, hint)])


def _check_query(text: str) -> None:
    """Raise BadInputError when a text cannot be a query: empty, too long, of several lines, with too great integers.

    Its syntax is checked by the worker.
    """
    if not text:
        raise _query_error(text, "the query is empty", hint="such as object(X), shape(X, square, C)")
    if len(text) > MAX_QUERY_CHARACTERS:
        raise _query_error(text[:100], f"a query has at most {MAX_QUERY_CHARACTERS} characters")
    if "\n" in text or "%" in text:
        raise _query_error(text, "a query is one line without comments")
    problems = list(integers_beyond_32_bits(source_from_bytes("query", text.encode("utf-8", errors="surrogateescape"))))
    if problems:
        raise BadInputError(problems)
