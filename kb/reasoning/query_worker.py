"""The process in which queries are answered: it reads one JSON line a query and writes one JSON line an answer.

Run by `kb.reasoning.worker`, which kills it when it takes too long. It has little memory, can open no file, and
clingo's death
is its own alone. A query is the body of one rule; its answers are the values of the variables in it.
"""

import json
from collections.abc import Iterable, Iterator, Sequence
from functools import lru_cache
from typing import Any

import clingo
from clingo.ast import AST, ASTType, parse_string

from kb.language import operating_system
from kb.language.diagnostics import did_you_mean
from kb.language.vocabulary import BELIEF
from kb.reasoning.rule_solver import read, solved
from kb.three_valued.aliases import with_org
from kb.three_valued.clauses import Clause, ClauseError, clauses_of, global_variables
from kb.three_valued.derivation import derive
from kb.three_valued.evaluation import Bindings, bindings
from kb.three_valued.join_order import unsafe
from kb.three_valued.known_words import check_body, stated_names
from kb.three_valued.open_world import Beliefs, Row
from kb.three_valued.uncertain_values import Value

MEMORY = 1_500_000_000  # bytes of address space
PROCESSOR_TIME = 60  # seconds on one request: far more than anybody waits for, should nobody be there to end it
MOST_ROWS = 10_000
HEAD = "q__ :- "

Answer = dict[str, Any]


class RuleError(Exception):
    """A rule cannot be worked out; carries the ClauseError, whose line is the rule's number."""

    def __init__(self, error: ClauseError) -> None:
        self.error = error
        super().__init__(error.what)


class QueryError(Exception):
    """A query is not one: what, and at which of its characters (from 1, 0 when unknown)."""

    def __init__(self, what: str, at: int = 0) -> None:
        self.what, self.at = what, at
        super().__init__(what)


def answer(
    facts: Iterable[Sequence[int | str]], query: str, rules: Sequence[str] = (), most: int = MOST_ROWS
) -> Answer:
    """Return the answer to a query over facts: its kind, its variables, and the rows of their values.

    facts : of each the name and the arguments, integers or terms as text. rules : plain rules of a user, which define
    predicates that can be asked for, too. most : how many rows are kept.
    """
    clauses = [with_org(clause) for clause in clauses_of(_rule(query))]
    beliefs = Beliefs(_facts(facts))
    names = stated_names(beliefs.signatures())
    defining = _defining(rules)
    defined = {clause.head.signature for clause in defining if clause.head is not None}
    for clause in clauses:
        check_body(clause.body, {*BELIEF, *beliefs.signatures(), *defined}, names)
    try:
        derive(defining, beliefs)
    except ClauseError as error:
        raise RuleError(error) from None
    variables = list(dict.fromkeys(name for clause in clauses for name in global_variables(clause.body)))
    rows: dict[Row, None] = {}
    for clause in clauses:
        rows |= dict.fromkeys(_row(found, variables, clause) for found in bindings(clause.body, {}, beliefs, False))
    found = {"variables": variables, "rows": [], "more": False}
    if rows:
        told = sorted(([_value(value) for value in row] for row in rows), key=_order)
        return (
            found
            | {"answer": "bindings" if variables else "yes", "rows": told[:most] if variables else []}
            | {"more": len(told) > most}
        )
    perhaps = any(True for clause in clauses for _ in bindings(clause.body, {}, beliefs, True))
    return found | {"answer": "don't know" if perhaps else "no"}


def _defining(rules: Sequence[str]) -> list[Clause]:
    """The clauses of rules; the line of each is its number among them, from 1."""
    parts: list[AST] = []
    parse_string("\n".join(rules), parts.append, logger=_raise, message_limit=20)
    try:
        return [clause for part in parts if part.ast_type == ASTType.Rule for clause in clauses_of(part)]
    except ClauseError as error:
        raise RuleError(error) from None


def _row(found: Bindings, variables: list[str], clause: Clause) -> Row:
    missing = [name for name in variables if name not in found]
    if missing:
        raise unsafe(missing[0], clause.at)
    return tuple(found[name] for name in variables)


def _order(row: list[Any]) -> list[tuple[bool, Any]]:
    return [(isinstance(value, str), value) for value in row]


def _facts(entries: Iterable[Sequence[int | str]]) -> Iterator[tuple[str, Row]]:
    for name, *arguments in entries:
        yield str(name), tuple(term if isinstance(term, int) else _parsed(term) for term in arguments)


@lru_cache(maxsize=65536)
def _parsed(term: str) -> clingo.Symbol:
    return clingo.parse_term(term)


def _rule(query: str) -> AST:
    """The rule of which a query is the body; exactly one, or it is no query."""
    parts: list[AST] = []
    parse_string(f"{HEAD}{query}\n.", parts.append, logger=_raise, message_limit=20)
    if len(parts) != 2 or parts[1].ast_type != ASTType.Rule:
        raise QueryError("one query at a time, without a full stop in it")
    if str(parts[1].head) != "q__":
        raise QueryError("a query has no head")
    return parts[1]


def _value(term: Value) -> int | str:
    return term if isinstance(term, int) else str(term)


def _raise(code: clingo.MessageCode, message: str) -> None:
    """Turn clingo's first message into an error; columns count from the start of the query."""
    place, _, what = message.partition(": error: ")
    if not what:
        place, _, what = message.partition(": info: ")
    column = place.split(":")[2].split("-")[0] if place.count(":") >= 2 else "0"
    at = max(0, int(column) - len(HEAD)) if column.isdigit() else 0
    _messages.append(QueryError(" ".join(what.split()) or message.strip(), at))


_messages: list[QueryError] = []


def _respond(line: bytes) -> Answer:
    _messages.clear()
    try:
        request = json.loads(line)
        if "read" in request:
            return read(request["read"])
        if "program" in request:
            return solved(request["program"], request["rules"], request["heads"], request["conflicts"])
        found = answer(request["facts"], request["query"], request["rules"], request.get("most", MOST_ROWS))
    except QueryError as error:
        return {"error": error.what, "at": error.at, "hint": ""}
    except RuleError as bad:
        return {"error": bad.error.what, "rule": bad.error.at[0] - 1, "hint": bad.error.hint}
    except ClauseError as error:
        return {"error": error.what, "at": max(0, error.at[1] - len(HEAD)), "hint": error.hint}
    except RecursionError:
        return {"error": "it is nested too deep", "at": 0, "hint": ""}
    except MemoryError:
        return {"limit": "it needs too much memory"}
    except RuntimeError as error:
        _messages.append(QueryError(str(error)))
    if _messages:
        return {"error": _messages[0].what, "at": _messages[0].at, "hint": ""}
    return found


def main() -> None:
    """Answer queries until the input ends, and end then at once."""
    operating_system.end_with_parent()
    operating_system.limit_resource("AS", MEMORY)
    operating_system.limit_resource("CORE", 0)
    json.loads('{"a": [1.5, "b"]}')  # everything that is imported late is imported now
    answer([["room", "r1"]], "room(X), not room(r2)")
    did_you_mean("room", ["door"])
    requests = operating_system.read_lines_from_parent()
    operating_system.limit_resource("NOFILE", 3)
    print("ready", flush=True)
    for line in requests:
        operating_system.limit_processor_time(PROCESSOR_TIME)
        print(json.dumps(_respond(line)), flush=True)


if __name__ == "__main__":
    main()
