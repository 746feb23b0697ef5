"""The check of queries and rules for unknown predicates, and for constants that cannot stand where they do."""

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence

import clingo

from utak.kb.language.arguments import ArgumentType, abbreviated
from utak.kb.language.diagnostics import SourceSpan, did_you_mean
from utak.kb.language.terms import Number, Symbol, Term, Text
from utak.kb.language.vocabulary import BELIEF_PREDICATES, Signature, hint_for
from utak.kb.three_valued.clauses import (
    Aggregate,
    Atom,
    ClauseError,
    ClauseTerm,
    Comparison,
    ConditionalLiteral,
    Constant,
    Literal,
    Variable,
    atoms_of,
)
from utak.kb.three_valued.uncertain_values import Value

ConstantNames = Mapping[str, frozenset[str]]  # constants as text, by the name of the argument type
NO_PLACE = SourceSpan(1, 1, 1)  # the place of values that stand in no file


def names_in_facts(rows: Mapping[Signature, Iterable[Sequence[Value]]]) -> ConstantNames:
    """Return the constants that facts have in each type of argument; all of them are accepted in queries."""
    found: dict[str, set[str]] = {}
    for signature, stated in rows.items():
        slots = BELIEF_PREDICATES[signature].arguments if signature in BELIEF_PREDICATES else ()
        for row in stated:
            for slot, value in zip(slots, row, strict=False):
                if not isinstance(value, int):
                    found.setdefault(slot.name, set()).add(str(value))
    return {name: frozenset(words) for name, words in found.items()}


def check_body(body: Sequence[Literal], known: Collection[Signature], names: ConstantNames) -> None:
    """Raise ClauseError for an unknown predicate, or for a constant that cannot stand where it does."""
    for atom in atoms_of(tuple(body)):
        check_predicate(atom, known)
        if atom.signature in BELIEF_PREDICATES:
            for slot, part in zip(BELIEF_PREDICATES[atom.signature].arguments, atom.parts, strict=True):
                check_constant(slot, part, names)
    for literals in _conjunctions(body):
        slots = {name: slot for name, slot in types_of_variables(literals) if slot.limits is None}
        for name, other in _equated(literals):
            if name in slots:
                check_constant(slots[name], other, names)


def check_predicate(atom: Atom, known: Collection[Signature]) -> None:
    """Raise ClauseError unless the predicate of an atom is in `known`: pairs (name, number of arguments)."""
    if atom.signature in known:
        return
    name, arity = atom.signature
    raise ClauseError(f"unknown predicate {name}/{arity}", atom.at, hint_for(name, known))


def check_constant(slot: ArgumentType, term: ClauseTerm, names: ConstantNames) -> None:
    """Raise ClauseError when a term is a constant that an argument type does not accept."""
    if not isinstance(term, Constant) or str(term.value) in names.get(slot.name, ()):
        return
    complaint = slot.check(as_fact_term(term.value))
    if complaint is not None:
        hint = did_you_mean(str(term.value), names.get(slot.name, ())) or complaint.hint
        if complaint.what.startswith("unknown"):
            what = f"unknown constant {abbreviated(as_fact_term(term.value))}, which is no {slot.name}"
            raise ClauseError(what, term.at, hint.replace("one of ", "did you mean one of ") + "?" * ("one of" in hint))
        raise ClauseError(complaint.what, term.at, hint)


def as_fact_term(value: Value) -> Term:
    """Return a known value, an integer or a clingo symbol, as a term of a fact file, which argument types can check."""
    if isinstance(value, int):
        return Number(value, NO_PLACE)
    if value.type == clingo.SymbolType.String:
        return Text(value.string, NO_PLACE)
    if value.type == clingo.SymbolType.Function:
        inner = tuple(
            as_fact_term(part.number if part.type == clingo.SymbolType.Number else part) for part in value.arguments
        )
        return Symbol(value.name if value.positive else f"-{value.name}", inner, NO_PLACE)
    return Symbol(str(value), (), NO_PLACE)


def _conjunctions(body: Sequence[Literal]) -> Iterator[tuple[Literal, ...]]:
    """Yield a body, and each conjunction inside it together with the atoms around it; the body itself first."""
    yield tuple(body)
    for literal in body:
        inner = [element.condition for element in literal.elements] if isinstance(literal, Aggregate) else []
        inner += [(literal.literal, *literal.condition)] if isinstance(literal, ConditionalLiteral) else []
        for part in inner:
            yield from _conjunctions((*part, *(one for one in body if isinstance(one, Atom))))


def types_of_variables(body: Sequence[Literal]) -> Iterator[tuple[str, ArgumentType]]:
    """Yield the name of each variable that stands in an atom of the world model, with the type of that argument."""
    # A variable comes once for each place in which it stands, the places in order.
    for atom in body:
        if isinstance(atom, Atom) and atom.signature in BELIEF_PREDICATES:
            for slot, part in zip(BELIEF_PREDICATES[atom.signature].arguments, atom.parts, strict=True):
                if isinstance(part, Variable):
                    yield part.name, slot


def _equated(literals: Iterable[Literal]) -> Iterator[tuple[str, Constant]]:
    """Yield the name of each variable that is compared with a constant by `=` or `!=`, and the constant."""
    for literal in literals:
        if not isinstance(literal, Comparison):
            continue
        terms = [literal.first, *(term for _, term in literal.rest)]
        for (sign, right), left in zip(literal.rest, terms, strict=False):
            if sign in ("=", "!="):
                for one, other in ((left, right), (right, left)):
                    if isinstance(one, Variable) and isinstance(other, Constant):
                        yield one.name, other
