"""The process in which queries are answered: it reads one JSON line a query and writes one JSON line an answer.

Run by `kb.worker`, which kills it when it takes too long. It has little memory, can open no file, and clingo's death
is its own alone. A query is the body of one rule; its answers are the values of the variables in it.
"""

import json
import re
from collections.abc import Iterable
from typing import Any

import clingo
from clingo.ast import AST, ASTType, Sign, Transformer, parse_string

from kb import machine

MEMORY = 1_500_000_000  # bytes of address space
PROCESSOR_TIME = 60  # seconds on one request: far more than anybody waits for, should nobody be there to end it
MOST_ROWS = 10_000
CONFIDENT = {
    ("kind", 3),
    ("segment", 7),
    ("shape", 3),
    ("colour", 3),
    ("movable", 2),
}  # the last argument is a confidence
UNSAFE = re.compile(r"'(\w+)' is unsafe")
DERIVED = "object(N) :- kind(N, object, _)."
HEAD = "q__ :- "
LOCAL = ("BodyAggregateElement", "ConditionalLiteral")  # variables in these are their own

Answer = dict[str, Any]


class QueryError(Exception):
    """A query is not one: what, and at which of its characters (from 1, 0 when unknown)."""

    def __init__(self, what: str, at: int = 0) -> None:
        self.what, self.at = what, at
        super().__init__(what)


class _Reader(Transformer):
    """Collects the global variables of a rule's body and its atoms as (name, arity)."""

    def __init__(self) -> None:
        self.variables: list[str] = []
        self.atoms: list[tuple[str, int, int]] = []
        self.local = 0

    def visit(self, ast: AST, *args: Any, **kwargs: Any) -> AST:
        """Visit a node, knowing whether its variables are local."""
        local = str(ast.ast_type).rpartition(".")[2] in LOCAL
        self.local += local
        super().visit(ast, *args, **kwargs)
        self.local -= local
        return ast

    def visit_Variable(self, node: AST) -> AST:  # noqa: N802 (clingo's name)
        if not self.local and node.name != "_" and node.name not in self.variables:
            self.variables.append(node.name)
        return node

    def visit_SymbolicAtom(self, node: AST) -> AST:  # noqa: N802 (clingo's name)
        symbol = node.symbol
        if symbol.ast_type == ASTType.Function:
            at = symbol.location.begin.column - len(HEAD)
            self.atoms.append((symbol.name, len(symbol.arguments), at))
        self.visit_children(node)
        return node


def answer(facts: str, query: str, known: Iterable[tuple[str, int]], most: int = MOST_ROWS) -> Answer:
    """Return the answer to a query over facts: its variables, the rows of their values, and whether it is open.

    most : how many rows are kept.
    """
    rule = _rule(query)
    reader = _Reader()
    reader.visit_sequence(rule.body)
    declared = {(name, arity) for name, arity in known}
    if any(atom[:2] not in declared for atom in reader.atoms):
        return {"atoms": reader.atoms, "variables": [], "rows": [], "more": False, "open": False}
    program = [facts, DERIVED, *(f"#defined {name}/{arity}." for name, arity in sorted(declared))]
    rows, more = _rows(program, reader.variables, query, most)
    found = {"variables": reader.variables, "rows": rows, "more": more, "atoms": reader.atoms}
    return found | {"open": not rows and _open(program, rule)}


def _rule(query: str) -> Any:
    """The rule of which a query is the body; exactly one, or it is no query."""
    parts: list[Any] = []
    parse_string(f"{HEAD}{query}\n.", parts.append, logger=_raise, message_limit=20)
    if len(parts) != 2 or parts[1].ast_type != ASTType.Rule:
        raise QueryError("one query at a time, without a full stop in it")
    if str(parts[1].head) != "q__":
        raise QueryError("a query has no head")
    return parts[1]


def _rows(program: list[str], variables: list[str], body: str, most: int = MOST_ROWS) -> tuple[list[list[Any]], bool]:
    """The distinct values of the variables for which the body holds, and whether there are more of them."""
    control = clingo.Control(["--warn=all"], logger=_raise, message_limit=20)
    head = f"q__({','.join(variables)})" if variables else "q__"
    control.add("base", [], "\n".join([*program, f"{head} :- {body}\n."]))
    control.ground([("base", [])])
    atoms = control.symbolic_atoms.by_signature("q__", len(variables))
    rows = [[_value(term) for term in atom.symbol.arguments] for atom in atoms]
    rows.sort(key=lambda row: [(isinstance(value, str), value) for value in row])
    return rows[:most], len(rows) > most


def _open(program: list[str], rule: Any) -> bool:
    """Whether the query would hold if it asked for any confidence between 0 and 100 where it asks for a certain one."""
    literals, changed = [], False
    for number, literal in enumerate(rule.body):
        text = str(literal)
        if literal.ast_type == ASTType.Literal and literal.sign == Sign.NoSign:
            symbol = getattr(literal.atom, "symbol", None)
            if symbol is not None and (symbol.name, len(symbol.arguments)) in CONFIDENT:
                terms = [*map(str, list(symbol.arguments)[:-1]), f"C__{number}"]
                text = f"{symbol.name}({','.join(terms)}), 0 < C__{number} < 100"
                changed = True
        literals.append(text)
    return changed and bool(_rows(program, [], "; ".join(literals))[0])


def _value(term: clingo.Symbol) -> int | str:
    return term.number if term.type == clingo.SymbolType.Number else str(term)


def solved(program: str, rules: str, seconds: float) -> Answer:
    """The shown atoms of the best answer set of a program of ours with rules of a user: {"atoms": texts or None}.

    Or {"error": clingo's first message}, whose lines are those of the rules.
    """
    messages: list[str] = []
    control = clingo.Control([], logger=lambda _code, text: messages.append(text), message_limit=20)
    try:
        control.add("base", [], program)
        control.add("base", [], rules)
        control.ground([("base", [])])
    except RuntimeError as error:
        messages.append(str(error))
    if messages:
        return {"error": messages[0]}
    best: list[list[str] | None] = [None]

    def keep(model: clingo.Model) -> None:
        best[0] = [str(atom) for atom in model.symbols(shown=True)]

    with control.solve(on_model=keep, async_=True) as handle:
        if not handle.wait(seconds):
            handle.cancel()
        handle.get()
    return {"atoms": best[0]}


def _raise(code: clingo.MessageCode, message: str) -> None:
    """Turn clingo's first message into an error; columns count from the start of the query."""
    if unsafe := UNSAFE.search(message):
        _messages.append(QueryError(f"nothing says what {unsafe[1]} can be: it must be in an atom that holds"))
        return
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
        if "rules" in request:
            return solved(request["program"], request["rules"], request["seconds"])
        found = answer(request["facts"], request["query"], request["known"], request.get("most", MOST_ROWS))
    except QueryError as error:
        return {"error": error.what, "at": error.at}
    except MemoryError:
        return {"limit": "it needs too much memory"}
    except RuntimeError as error:
        _messages.append(QueryError(str(error)))
    if _messages:
        return {"error": _messages[0].what, "at": _messages[0].at}
    return found


def main() -> None:
    """Answer queries until the input ends, and end then at once."""
    machine.end_with_parent()
    machine.limit("AS", MEMORY)
    machine.limit("CORE", 0)
    json.loads('{"a": [1.5, "b"]}')  # everything that is imported late is imported now
    answer("p(1).", "p(X), not p(2)", [])
    requests = machine.lines_of_parent()
    machine.limit("NOFILE", 3)
    print("ready", flush=True)
    for line in requests:
        machine.limit_processor_time(PROCESSOR_TIME)
        print(json.dumps(_respond(line)), flush=True)


if __name__ == "__main__":
    main()
