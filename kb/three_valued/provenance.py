"""Which rule instances derive the certain atoms of users' rules: what an explanation of a query is made of.

The form is that of kb.tracing.requests: units (here clauses), and the instances of each that certainly hold.
"""

from collections.abc import Iterator, Sequence
from typing import Any

from utak.kb.three_valued.clauses import (
    Aggregate,
    Atom,
    BooleanLiteral,
    Clause,
    ClauseTerm,
    Comparison,
    Compound,
    ConditionalLiteral,
    Constant,
    Literal,
    Operation,
    Variable,
    global_variables,
    variables_of,
)
from utak.kb.three_valued.evaluation import find_bindings, fixed_confidence_variables
from utak.kb.three_valued.open_world import Beliefs
from utak.kb.three_valued.term_values import Bindings, is_interval, value_of
from utak.kb.three_valued.uncertain_values import MIRRORED_SIGNS, Unknown
from utak.kb.tracing.syntax import ANY_NAME, JsonValues


def certain_instances(clauses: Sequence[Clause], beliefs: Beliefs) -> JsonValues:
    """Return the rule instances that certainly hold, as JSON values."""
    found: JsonValues = {"units": [], "on": [], "heads": [], "elements": []}
    for number, clause in enumerate(clauses):
        assert clause.head is not None
        names = list(global_variables(clause.body))
        infos = [_info(one) for one in clause.body]
        found["units"].append({"statement": clause.at[0] - 1, "names": names, "literals": infos, "conditions": [[]]})
        fixed = fixed_confidence_variables(clause.body, ())
        seen: set[tuple[Any, ...]] = set()
        for given in find_bindings(clause.body, {}, beliefs, False, fixed):
            values = [_text(given.get(name, Unknown())) for name in names]
            literals = [_value(one, given) for one in clause.body]
            head = _atom(clause.head, given)
            key = (*values, head, *map(str, literals))
            if key not in seen:
                seen.add(key)
                found["on"].append([number, values, literals])
                found["heads"].append([number, 0, values, head, []])
                found["elements"] += _elements(number, values, clause, given, beliefs)
    rows = beliefs.signatures().items()
    found["atoms"] = [_applied(name, [_text(value) for value in row]) for (name, _), known in rows for row in known]
    return found


def _elements(
    number: int, values: Sequence[str], clause: Clause, given: Bindings, beliefs: Beliefs
) -> Iterator[list[Any]]:
    """Yield the elements of aggregates and conditional literals of an instance whose conditions certainly hold."""
    for at, literal in enumerate(clause.body):
        if isinstance(literal, Aggregate):
            parts = [(element.terms, element.condition) for element in literal.elements]
        elif isinstance(literal, ConditionalLiteral):
            parts = [((), literal.condition)]
        else:
            continue
        for index, (terms, condition) in enumerate(parts):
            passed: Any = terms or (literal.literal if isinstance(literal, ConditionalLiteral) else ())
            fixed = fixed_confidence_variables(condition, passed)
            for found in find_bindings(condition, given, beliefs, False, fixed):
                if isinstance(literal, ConditionalLiteral):
                    shown: list[Any] = [_value(literal.literal, found)]
                else:
                    shown = [_text(value_of(term, found)) for term in terms]
                yield [number, at, index, list(values), shown, [_value(one, found) for one in condition]]


def _info(literal: Literal) -> JsonValues:
    """Return what an explanation needs to know of a literal: see kb.tracing.instrument.literal_info."""
    text = _literal_text(literal)
    if isinstance(literal, Atom):
        return {"kind": ("atom", "not", "notnot")[literal.negations], "text": text, "negated": literal.negations == 1}
    if isinstance(literal, Comparison):
        sides = [_term_text(part) for part in (literal.first, *(term for _, term in literal.rest))]
        signs = [sign for sign, _ in literal.rest]
        return {"kind": "comparison", "text": text, "negated": literal.negated, "signs": signs, "sides": sides}
    if isinstance(literal, Aggregate):
        signs = [sign for sign, _ in literal.guards]
        both = [signs[0] if signs else "", MIRRORED_SIGNS[signs[1]] if len(signs) > 1 else ""]
        conditions = [[_info(one) for one in element.condition] for element in literal.elements]
        info = {"kind": "aggregate", "text": text, "negated": literal.negated, "function": literal.function}
        return info | {"signs": both, "conditions": conditions}
    if isinstance(literal, ConditionalLiteral):
        conditions = [[_info(one) for one in literal.condition]]
        info = {"kind": "conditional", "text": text, "negated": False, "literal": _info(literal.literal)}
        return info | {"conditions": conditions}
    return {"kind": "truth", "text": text, "negated": False}


def _value(literal: Literal, given: Bindings) -> Any:
    """Return a literal with values: an atom as text, the sides of a comparison or the bounds of an aggregate."""
    if isinstance(literal, Atom):
        return _atom(literal, given)
    if isinstance(literal, Comparison):
        return [_side(part, given) for part in (literal.first, *(term for _, term in literal.rest))]
    if isinstance(literal, Aggregate):
        return [_text(value_of(term, given)) for _, term in literal.guards]
    return []


def _atom(atom: Atom, given: Bindings) -> str:
    """Return an atom with values as text; `ANY_NAME` in the place of an argument with an unbound variable."""
    parts = [
        _text(value_of(part, given)) if set(variables_of(part)) <= given.keys() else ANY_NAME for part in atom.parts
    ]
    return _applied(atom.name, parts)


def _side(term: ClauseTerm, given: Bindings) -> str:
    """Return one side of a comparison: its value, or for an interval its text as a string."""
    return f'"{_term_text(term)}"' if is_interval(term) else _text(value_of(term, given))


def _text(value: Any) -> str:
    """Return a value as text; `unknown` for one that is not known."""
    return "unknown" if isinstance(value, Unknown) else str(value)


def _applied(name: str, parts: Sequence[str]) -> str:
    """Return the text of an atom or a compound term."""
    return f"{name}({','.join(parts)})" if parts else name


def _term_text(term: ClauseTerm) -> str:
    """Return a term as rules write it."""
    if isinstance(term, Constant):
        return str(term.value)
    if isinstance(term, Variable):
        return "_" if term.name.startswith("?") else term.name
    if isinstance(term, Compound):
        return _applied(term.name, [_term_text(part) for part in term.parts])
    assert isinstance(term, Operation)
    parts = [f"({_term_text(part)})" if isinstance(part, Operation) else _term_text(part) for part in term.parts]
    if len(parts) == 1:
        return f"|{parts[0]}|" if term.sign == "|" else f"{term.sign}{parts[0]}"
    return f"{parts[0]}{term.sign}{parts[1]}"


def _literal_text(literal: Literal) -> str:
    """Return a literal as rules write it."""
    if isinstance(literal, Atom):
        return "not " * literal.negations + _applied(literal.name, [_term_text(part) for part in literal.parts])
    if isinstance(literal, Comparison):
        parts = [_term_text(literal.first), *(f"{sign} {_term_text(term)}" for sign, term in literal.rest)]
        return ("not " if literal.negated else "") + " ".join(parts)
    if isinstance(literal, ConditionalLiteral):
        return f"{_literal_text(literal.literal)}: {', '.join(map(_literal_text, literal.condition))}"
    if isinstance(literal, Aggregate):
        guards = " ".join(f"{_term_text(term)} {sign}" for sign, term in literal.guards)
        return f"{'not ' if literal.negated else ''}{guards} {literal.function} {{ ... }}".strip()
    assert isinstance(literal, BooleanLiteral)
    return "#true" if literal.value else "#false"
