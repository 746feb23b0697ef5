"""The separate process that answers queries: it reads one JSON line a request and writes one JSON line a response.

`utak.kb.reasoning.worker` starts it, and kills it when a request takes too long. The process has little memory and can
open no file; a crash of clingo ends this process only. A query is the body of one rule; its answer holds the values of
its variables.
"""

import json
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import clingo
from clingo.ast import AST, ASTType, parse_string

from utak.kb.language import operating_system
from utak.kb.language.diagnostics import did_you_mean
from utak.kb.language.vocabulary import BELIEF_PREDICATES, Signature
from utak.kb.reasoning.rule_solver import Response, read_rule_text, solve_with_rules
from utak.kb.three_valued.aliases import rename_utak_to_org
from utak.kb.three_valued.arithmetic import ClauseError
from utak.kb.three_valued.compilation import names_in
from utak.kb.three_valued.evaluation import Evaluation
from utak.kb.three_valued.known_words import ConstantNames, check_body, names_in_facts, types_of_variables
from utak.kb.three_valued.open_world import Beliefs, FactRow
from utak.kb.tracing.possible_worlds import likeliest_worlds
from utak.kb.tracing.requests import respond
from utak.kb.tracing.syntax import SyntaxPart, outer_parts

MAX_MEMORY_BYTES = 1_500_000_000  # bytes of address space; a convention
# Seconds of processor time for one request; a convention, well above every limit at which the parent ends the process.
MAX_PROCESSOR_SECONDS = 60
QUERY_HEAD = "q__ :- "  # put before a query, to make it a rule
NO_PLACE_IN_QUERY = (1, 0)  # line and column of an error that concerns the whole query


class RuleError(Exception):
    """A user's rule cannot be evaluated."""

    def __init__(self, error: ClauseError) -> None:
        self.error = error
        super().__init__(error.what)


class QueryError(Exception):
    """A text is no query."""

    def __init__(self, what: str, at: tuple[int, int] = NO_PLACE_IN_QUERY) -> None:
        self.what, self.at = what, at
        super().__init__(what)


@dataclass(frozen=True)
class BelievedFacts:
    """Facts and users' rules, ready for any number of queries."""

    evaluation: Evaluation  # the facts, and the atoms that the rules derive from them
    known: frozenset[Signature]  # the predicates (name, number of arguments) of which queries can be made
    names: ConstantNames  # the constants in the facts as text, by the name of the argument type


def believed_facts(facts: Iterable[Sequence[int | str]], rules: Sequence[str] = ()) -> BelievedFacts:
    """Return facts together with what users' rules derive from them."""
    beliefs = Beliefs(_facts(facts))
    signatures = beliefs.signatures
    try:
        evaluation = Evaluation(beliefs, _parsed_rules(rules))
    except ClauseError as error:
        raise RuleError(error) from None
    known = frozenset({*BELIEF_PREDICATES, *signatures, *evaluation.derived})
    return BelievedFacts(evaluation, known, names_in_facts(signatures))


def answer_query(
    facts: Iterable[Sequence[int | str]], query: str, rules: Sequence[str] = (), max_rows: int | None = None
) -> Response:
    """Return the answer to a query over facts; the parameters are those of `believed_facts` and `answer_over`."""
    return answer_over(believed_facts(facts, rules), query, max_rows)


def answer_over(believed: BelievedFacts, query: str, max_rows: int | None = None) -> Response:
    """Return the answer to a query over facts and the atoms that rules derive from them."""
    clauses = [SyntaxPart(one) for one in _query_as_rule(query).unpool()]
    for clause in clauses:
        rename_utak_to_org(clause)
    bodies = [clause.body for clause in clauses]
    for body in bodies:
        check_body(body, believed.known, believed.names)
    outer = names_in(part for body in bodies for literal in body for part in outer_parts(literal))
    variables = [name for name in outer if name != "_"]
    rows = {tuple(row) for body in bodies for row in believed.evaluation.rows(body, variables)}
    types = {name: slot.name for body in bodies for name, slot in types_of_variables(body)}
    found = {"variables": variables, "types": [types.get(name, "") for name in variables], "rows": [], "more": False}
    if rows:
        sorted_rows = sorted(([_json_value(value) for value in row] for row in rows), key=_sort_key)
        return (
            found
            | {"answer": "bindings" if variables else "yes", "rows": sorted_rows[:max_rows] if variables else []}
            | {"more": max_rows is not None and len(sorted_rows) > max_rows}
        )
    return found | {"answer": "don't know" if any(map(believed.evaluation.may_hold, bodies)) else "no"}


def _parsed_rules(rules: Sequence[str]) -> list[AST]:
    """Return rules without pools; the line of each is the number of its rule, from 1."""
    parts: list[AST] = []
    parse_string("\n".join(rules), parts.append, logger=_record_message, message_limit=20)
    found = [one for part in parts if part.ast_type == ASTType.Rule for one in part.unpool()]
    for one in found:
        rename_utak_to_org(one)
    return found


def _sort_key(row: list[Any]) -> list[tuple[bool, Any]]:
    """Return a key that sorts rows: integers before texts, column by column, both ascending."""
    return [(isinstance(value, str), value) for value in row]


def _facts(entries: Iterable[Sequence[int | str]]) -> Iterator[tuple[str, FactRow]]:
    """Yield the name and the values of each fact of a request: its arguments as clingo symbols."""
    # Raises RuntimeError for a text that is no term.
    for name, *arguments in entries:
        yield str(name), tuple(clingo.Number(one) if isinstance(one, int) else _parse_term(one) for one in arguments)


@lru_cache(maxsize=65536)
def _parse_term(term: str) -> clingo.Symbol:
    """Return the clingo symbol that a text denotes, such as `corner(northeast)`; RuntimeError when it denotes none."""
    return clingo.parse_term(term)


def _query_as_rule(query: str) -> AST:
    """Return the syntax tree of a rule with the query as its body."""
    # Raises QueryError unless the text is exactly one body, and RuntimeError where clingo cannot parse it.
    parts: list[AST] = []
    parse_string(f"{QUERY_HEAD}{query}\n.", parts.append, logger=_record_message, message_limit=20)
    if len(parts) != 2 or parts[1].ast_type != ASTType.Rule:
        raise QueryError("one query at a time, without a full stop in it")
    if str(parts[1].head) != "q__":
        raise QueryError("a query has no head")
    return parts[1]


def _json_value(term: clingo.Symbol) -> int | str:
    """Return a value as JSON takes it: an integer, or the text of a term."""
    return term.number if term.type == clingo.SymbolType.Number else str(term)


def _record_message(code: clingo.MessageCode, message: str) -> None:
    """Append a message of clingo's to `_messages`, as a QueryError whose place counts from the start of the query."""
    place, _, what = message.partition(": error: ")
    if not what:
        place, _, what = message.partition(": info: ")
    line, column = (place.split(":")[1], place.split(":")[2]) if place.count(":") >= 2 else ("1", "0")
    column = column.split("-")[0]
    at = _place_in_query((int(line), int(column))) if line.isdigit() and column.isdigit() else NO_PLACE_IN_QUERY
    _messages.append(QueryError(" ".join(what.split()) or message.strip(), at))


def _place_in_query(at: tuple[int, int]) -> tuple[int, int]:
    """Return a place (line, column, from 1) in the rule that a query was made, as a place in the query."""
    line, column = at
    return (1, max(0, column - len(QUERY_HEAD))) if line == 1 else (line, column)


_messages: list[QueryError] = []
_held: list[tuple[int, BelievedFacts]] = []  # the facts of the last request, with their number; at most one entry


def _held_facts(request: dict[str, Any]) -> BelievedFacts | None:
    """Return the facts of a request, or those with its number that are held; None when these are not held."""
    number = request.get("number", 0)
    if "facts" in request:
        _held.clear()
        _held.append((number, believed_facts(request["facts"], request["rules"])))
    return next((believed for held, believed in _held if held == number), None)


def _respond(line: bytes) -> Response:
    """Return the response to one request, a line of JSON: JSON values by key, never an exception."""
    _messages.clear()
    try:
        request = json.loads(line)
        if "read" in request:
            return read_rule_text(request["read"], request["renamed"])
        if "justify" in request:
            return believed_facts(request["facts"], request["rules"]).evaluation.instances()
        if "trace" in request:
            return respond(request["trace"])
        if "worlds" in request:
            return likeliest_worlds(**request["worlds"])
        if "program" in request:
            return solve_with_rules(**request)
        believed = _held_facts(request)
        if believed is None:
            return {"unknown": request["number"]}
        found = answer_over(believed, request["query"], request.get("max_rows"))
    except QueryError as error:
        return {"error": error.what, "at": error.at, "hint": ""}
    except RuleError as bad:
        return {"error": bad.error.what, "rule": bad.error.at[0] - 1, "hint": bad.error.hint}
    except ClauseError as error:
        return {"error": error.what, "at": _place_in_query(error.at), "hint": error.hint}
    except RecursionError:
        return {"error": "it is nested too deep", "at": NO_PLACE_IN_QUERY, "hint": ""}
    except MemoryError:
        return {"limit": "it needs too much memory"}
    except RuntimeError as error:
        _messages.append(QueryError(str(error)))
    if _messages:
        return {"error": _messages[0].what, "at": _messages[0].at, "hint": ""}
    return found


def main() -> None:
    """Answer requests until the standard input ends; then end at once."""
    operating_system.end_with_parent()
    operating_system.limit_resource("AS", MAX_MEMORY_BYTES)
    operating_system.limit_resource("CORE", 0)
    # One request of each kind, so that all modules are imported before the limit on open files.
    json.loads('{"a": [1.5, "b"]}')
    answer_query([["room", "r1"]], "room(X), not room(r2)")
    did_you_mean("room", ["door"])
    requests = operating_system.read_lines_from_parent()
    operating_system.limit_resource("NOFILE", 3)
    print("ready", flush=True)
    for line in requests:
        operating_system.limit_processor_time(MAX_PROCESSOR_SECONDS)
        print(json.dumps(_respond(line)), flush=True)


if __name__ == "__main__":
    main()
