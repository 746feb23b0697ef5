"""The check of queries and rules for unknown predicates, and for constants that cannot stand where they do."""

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from typing import Any

import clingo
from clingo.ast import ASTType

from utak.kb.language.arguments import ArgumentType, abbreviated
from utak.kb.language.diagnostics import SourceSpan, did_you_mean
from utak.kb.language.terms import Number, Symbol, Term, Text
from utak.kb.language.vocabulary import BELIEF_PREDICATES, Signature, hint_for
from utak.kb.three_valued.arithmetic import ClauseError, place_of
from utak.kb.three_valued.compilation import arguments_of, pairs_of, signature_of
from utak.kb.tracing.syntax import nodes_in

ConstantNames = Mapping[str, frozenset[str]]  # constants as text, by the name of the argument type
NO_PLACE = SourceSpan(1, 1, 1)  # the place of values that stand in no file


def names_in_facts(rows: Mapping[Signature, Iterable[Sequence[clingo.Symbol]]]) -> ConstantNames:
    """Return the constants that facts have in each type of argument; all of them are accepted in queries."""
    found: dict[str, set[str]] = {}
    for signature, stated in rows.items():
        slots = BELIEF_PREDICATES[signature].arguments if signature in BELIEF_PREDICATES else ()
        for row in stated:
            for slot, value in zip(slots, row, strict=False):
                if value.type != clingo.SymbolType.Number:
                    found.setdefault(slot.name, set()).add(str(value))
    return {name: frozenset(words) for name, words in found.items()}


def check_body(body: Sequence[Any], known: Collection[Signature], names: ConstantNames) -> None:
    """Raise ClauseError for an unknown predicate, or for a constant that cannot stand where it does."""
    for atom in _atoms(body):
        name, arity = signature = signature_of(atom)
        if signature not in known:
            raise ClauseError(f"unknown predicate {name}/{arity}", place_of(atom.symbol), hint_for(name, known))
        for slot, part in _slots(atom):
            check_constant(slot, part, names)
    for literals in _conjunctions(body):
        slots = {name: slot for name, slot in types_of_variables(literals) if slot.limits is None}
        for name, other in _equated(literals):
            if name in slots:
                check_constant(slots[name], other, names)


def check_constant(slot: ArgumentType, term: Any, names: ConstantNames) -> None:
    """Raise ClauseError when a term is a constant that an argument type does not accept."""
    if term.ast_type != ASTType.SymbolicTerm or str(term.symbol) in names.get(slot.name, ()):
        return
    constant = as_fact_term(term.symbol)
    complaint = slot.check(constant)
    if complaint is not None:
        hint = did_you_mean(str(term.symbol), names.get(slot.name, ())) or complaint.hint
        if complaint.what.startswith("unknown"):
            what = f"unknown constant {abbreviated(constant)}, which is no {slot.name}"
            raise ClauseError(
                what, place_of(term), hint.replace("one of ", "did you mean one of ") + "?" * ("one of" in hint)
            )
        raise ClauseError(complaint.what, place_of(term), hint)


def as_fact_term(value: clingo.Symbol) -> Term:
    """Return a clingo symbol as a term of a fact file, which argument types can check."""
    if value.type == clingo.SymbolType.Number:
        return Number(value.number, NO_PLACE)
    if value.type == clingo.SymbolType.String:
        return Text(value.string, NO_PLACE)
    if value.type == clingo.SymbolType.Function:
        name = value.name if value.positive else f"-{value.name}"
        return Symbol(name, tuple(map(as_fact_term, value.arguments)), NO_PLACE)
    return Symbol(str(value), (), NO_PLACE)


def _atoms(nodes: Iterable[Any]) -> Iterator[Any]:
    """Yield the atoms in parts of a syntax tree, those in aggregates and conditions included, in order."""
    return (one for node in nodes for one in nodes_in(node) if one.ast_type == ASTType.SymbolicAtom)


def _slots(atom: Any) -> Iterator[tuple[ArgumentType, Any]]:
    """Yield the arguments of an atom of the world model, each with its type; nothing for another atom."""
    if declared := BELIEF_PREDICATES.get(signature_of(atom)):
        yield from zip(declared.arguments, arguments_of(atom), strict=True)


def _conjunctions(body: Sequence[Any]) -> Iterator[list[Any]]:
    """Yield a body, and each conjunction inside it together with the atoms around it; the body itself first."""
    yield [*body]
    outer = [one for one in body if one.ast_type == ASTType.Literal and one.atom.ast_type == ASTType.SymbolicAtom]
    for literal in body:
        inner = [literal] if literal.ast_type == ASTType.ConditionalLiteral else getattr(literal.atom, "elements", ())
        for one in inner:
            before = [one.literal] if one.ast_type == ASTType.ConditionalLiteral else []
            yield [*before, *one.condition, *outer]


def types_of_variables(body: Iterable[Any]) -> Iterator[tuple[str, ArgumentType]]:
    """Yield the name of each variable that stands in an atom of the world model, with the type of that argument."""
    # A variable comes once for each place in which it stands, the places in order.
    for literal in body:
        if literal.ast_type == ASTType.Literal and literal.atom.ast_type == ASTType.SymbolicAtom:
            for slot, part in _slots(literal.atom):
                if part.ast_type == ASTType.Variable and part.name != "_":
                    yield part.name, slot


def _equated(literals: Iterable[Any]) -> Iterator[tuple[str, Any]]:
    """Yield the name of each variable that is compared with a constant by `=` or `!=`, and the constant."""
    for literal in literals:
        if literal.ast_type == ASTType.Literal and literal.atom.ast_type == ASTType.Comparison:
            for left, sign, right in pairs_of(literal.atom):
                for one, other in ((left, right), (right, left)):
                    if sign in ("=", "!=") and one.ast_type == ASTType.Variable:
                        yield one.name, other
