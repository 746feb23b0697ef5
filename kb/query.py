"""Questions to the world model: the body of a rule, answered over its facts in a process that can be killed.

A query without variables is answered yes, no or don't know; one with variables by the rows of their values, or, when
there is none, by no or don't know. Beside the facts there is `object(N)`, which stands for `kind(N, object, C)`.

The answer is *don't know* when nothing makes the query hold and

- some confidence in it would do if it could be any between 0 and 100 (`shape(o1,square,100)`, believed with 80), or
- part of the world is unseen (`unseen(R, N)` with N above 0) and the query asks for things that may be there: it has
  variables, or names something that no fact names.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from types import TracebackType
from typing import Any

from kb.factfile import parse_facts
from kb.facts import Fact, Number, Symbol
from kb.problems import BadInputError, Problem, Span, did_you_mean
from kb.source import decode
from kb.worker import Worker

SECONDS = 5.0  # after which a query is given up
LONGEST = 10_000  # characters of a query
MOST_ROWS = 10_000  # of an answer, unless more are asked for
VOCABULARY = (
    ("node", 1), ("kind", 3), ("child", 2), ("offset", 3), ("rect", 5), ("segment", 7), ("shape", 3), ("colour", 3),
    ("movable", 2), ("held", 1), ("room", 1), ("door", 1), ("connects", 3), ("width", 2), ("in", 2), ("corner", 3),
    ("adjacent", 2), ("unseen", 2), ("object", 1),
)  # fmt: skip


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
    """Answers queries one after another; use it in a `with` statement, which ends its process."""

    def __init__(self, seconds: float = SECONDS) -> None:
        self.seconds = seconds
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
        known = {*VOCABULARY, *(fact.signature for fact in world)}
        request = {
            "facts": "\n".join(f"{fact}." for fact in world),
            "query": text,
            "known": sorted(known),
            "most": most,
        }
        found = self._worker.exchange(request, self.seconds)
        if "limit" in found:
            raise QueryLimitError(f"the query was given up: {found['limit']}")
        _check_atoms(text, found, known)
        return _answer(found, world, text)


def _problem(text: str, what: str, at: int = 0, hint: str = "") -> BadInputError:
    line = text.split("\n")[0]
    span = Span(1, at, at) if 1 <= at <= len(line) else Span(1, 1, max(1, len(line)))
    return BadInputError([Problem("query", span, what, line, hint)])


def _check(text: str) -> None:
    """Whether a text may be handed to the worker."""
    if not text:
        raise _problem(text, "the query is empty", hint="such as object(X), shape(X, square, C)")
    if len(text) > LONGEST:
        raise _problem(text[:100], f"a query has at most {LONGEST} characters")
    if "\n" in text or "%" in text:
        raise _problem(text, "a query is one line without comments")
    decode("query", text.encode("utf-8", errors="surrogateescape"))


def _check_atoms(text: str, found: dict[str, Any], known: set[tuple[str, int]]) -> None:
    """Whether the query is well formed and asks for predicates that exist."""
    if "error" in found:
        raise _problem(text, found["error"], found["at"])
    for name, arity, at in found["atoms"]:
        if (name, arity) in known:
            continue
        forms = sorted(f"{other}/{n}" for other, n in known if other == name)
        hint = f"there is {', '.join(forms)}" if forms else did_you_mean(name, {other for other, _ in known})
        raise _problem(text, f"unknown predicate {name}/{arity}", at, hint)


def _answer(found: dict[str, Any], world: Sequence[Fact], text: str) -> Answer:
    variables, rows = tuple(found["variables"]), tuple(tuple(row) for row in found["rows"])
    if rows:
        return Answer("bindings", variables, rows, found["more"]) if variables else Answer("yes")
    unsure = found["open"] or (_unseen(world) and (bool(variables) or _names_news(text, world)))
    return Answer("don't know" if unsure else "no", variables)


def _unseen(world: Sequence[Fact]) -> bool:
    """Whether part of the world is unseen."""
    counts = [fact.args[1] for fact in world if fact.signature == ("unseen", 2)]
    return any(isinstance(count, Number) and count.value > 0 for count in counts)


def _names_news(text: str, world: Sequence[Fact]) -> bool:
    """Whether a query without variables names something that no fact names as its first argument."""
    named = {str(fact.args[0]) for fact in world if fact.args}
    try:
        atoms = parse_facts(decode("query", f"q({text}).".encode()))[0].args
    except BadInputError:
        return False  # aggregates, comparisons, negations: they ask about what is there
    firsts = [atom.args[0] for atom in atoms if isinstance(atom, Symbol) and atom.args]
    return any(str(term) not in named for term in firsts)
