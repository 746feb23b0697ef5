"""Questions to the world model: the body of a rule, answered over its facts in a process that can be killed.

A query without variables is answered yes, no or don't know; one with variables by the rows of their values that hold
for certain, or, when there is none, by no or don't know. Beside the facts there is `object(N)`, which stands for
`kind(N, object, C)`. What is certain, what may be and what is not: kb.three_valued.evaluation, over the table
`BELIEF` of
kb.language.vocabulary; docs/files.md describes it.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from types import TracebackType

from kb.language.diagnostics import BadInputError, Problem, Span
from kb.language.integers import integers_beyond_32_bits
from kb.language.reader import parse_facts
from kb.language.source_text import decode
from kb.language.terms import Fact, Number
from kb.language.vocabulary import BELIEF
from kb.reasoning.rulebook import Statement
from kb.reasoning.worker import Worker

SECONDS = 5.0  # after which a query is given up
MAX_QUERY_CHARACTERS = 10_000  # characters of a query
MOST_ROWS = 10_000  # of an answer, unless more are asked for
VOCABULARY = tuple(BELIEF)


class QueryLimitError(Exception):
    """A query was given up: it took too long or too much memory."""


@dataclass(frozen=True)
class Answer:
    """What the world model says.

    Attributes
    ----------
    kind : "bindings", "yes", "no" or "don't know".
    variables : the names of the query's variables, in the order in which they appear.
    rows : the values of the variables, integers or terms as text, sorted; empty unless kind is "bindings".
    more : there are more rows than are kept.
    """

    kind: str
    variables: tuple[str, ...] = ()
    rows: tuple[tuple[int | str, ...], ...] = ()
    more: bool = False

    def __str__(self) -> str:
        """The answer as text: a table of the bindings, or a word."""
        if self.kind != "bindings":
            return self.kind
        cells = [list(self.variables), *([str(value) for value in row] for row in self.rows)]
        widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
        lines = ["  ".join(map(str.ljust, row, widths)).rstrip() for row in cells]
        return "\n".join([*lines, f"... and more than these {len(self.rows)} rows"] if self.more else lines)


class QueryEngine:
    """Answers queries one after another; use it in a `with` statement, which ends its process.

    rules : files with rules of a user; predicates that they define over what is believed can be asked for, too.
    """

    def __init__(self, seconds: float = SECONDS, rules: Sequence[str] = ()) -> None:
        self.seconds = seconds
        self._rules: Sequence[Statement] = ()
        if rules:
            from kb.reasoning.user_rules import read_rules  # only who has rules of his own waits for it

            self._rules = read_rules(rules).queried
        self._worker = Worker()

    def __enter__(self) -> "QueryEngine":
        return self

    def __exit__(self, kind: type[BaseException] | None, value: BaseException | None, at: TracebackType | None) -> None:
        self.close()

    def close(self) -> None:
        """End the process."""
        self._worker.close()

    def ask(self, facts: Sequence[str], query: str, most: int = MOST_ROWS) -> Answer:
        """Answer a query over facts such as `kind(o1,object,95).`, with so many rows at most.

        Raises BadInputError when it is no query or one of the facts is none, QueryLimitError when it takes too long.
        """
        text = query.strip().removeprefix("?-").strip().removesuffix(".").strip()
        _check(text)
        world = parse_facts(decode("belief", "\n".join(facts).encode("utf-8")))
        request = {
            "facts": [_entry(fact) for fact in world],
            "query": text,
            "rules": [one.written for one in self._rules],
            "most": most,
        }
        found = self._worker.exchange(request, self.seconds)
        if "limit" in found:
            raise QueryLimitError(f"the query was given up: {found['limit']}")
        if "rule" in found:
            raise BadInputError([self._rules[found["rule"]].problem(found["error"], hint=found["hint"])])
        if "error" in found:
            raise _problem(text, found["error"], found["at"], found["hint"])
        return Answer(found["answer"], tuple(found["variables"]), tuple(map(tuple, found["rows"])), found["more"])


def _entry(fact: Fact) -> list[int | str]:
    """A fact as the worker takes it: its name and its arguments, integers or terms as text."""
    return [fact.name, *(term.value if isinstance(term, Number) else str(term) for term in fact.args)]


def _problem(text: str, what: str, at: int = 0, hint: str = "") -> BadInputError:
    line = text.split("\n")[0]
    span = Span(1, at, at) if 1 <= at <= len(line) else Span(1, 1, max(1, len(line)))
    return BadInputError([Problem("query", span, what, line, hint)])


def _check(text: str) -> None:
    """Whether a text may be handed to the worker."""
    if not text:
        raise _problem(text, "the query is empty", hint="such as object(X), shape(X, square, C)")
    if len(text) > MAX_QUERY_CHARACTERS:
        raise _problem(text[:100], f"a query has at most {MAX_QUERY_CHARACTERS} characters")
    if "\n" in text or "%" in text:
        raise _problem(text, "a query is one line without comments")
    problems = list(integers_beyond_32_bits(decode("query", text.encode("utf-8", errors="surrogateescape"))))
    if problems:
        raise BadInputError(problems)
