"""Are the words of a query or a rule those that the robot knows: its predicates, and constants where they can stand?"""

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence

import clingo

from kb.language.arguments import ArgumentType, abbreviated
from kb.language.diagnostics import Span, did_you_mean
from kb.language.terms import Number, Symbol, Text
from kb.language.terms import Term as Word
from kb.language.vocabulary import BELIEF
from kb.three_valued.clauses import (
    Aggregate,
    Atom,
    ClauseError,
    Comparison,
    Constant,
    Every,
    Literal,
    Term,
    Variable,
    atoms_of,
)
from kb.three_valued.uncertain_values import Value

Signature = tuple[str, int]
Names = Mapping[str, frozenset[str]]
NOWHERE = Span(1, 1, 1)


def stated_names(rows: Mapping[Signature, Iterable[Sequence[Value]]]) -> Names:
    """Return, by the name of a slot, the constants that facts have there: they are known, whatever they are."""
    found: dict[str, set[str]] = {}
    for signature, stated in rows.items():
        slots = BELIEF[signature].arguments if signature in BELIEF else ()
        for row in stated:
            for slot, value in zip(slots, row, strict=False):
                if not isinstance(value, int):
                    found.setdefault(slot.name, set()).add(str(value))
    return {name: frozenset(words) for name, words in found.items()}


def check_body(body: Sequence[Literal], known: Collection[Signature], names: Names) -> None:
    """Raise ClauseError for a predicate that does not exist, or a constant that cannot stand where it does.

    known : the predicates that there are. names : as `stated_names` returns them.
    """
    for atom in atoms_of(tuple(body)):
        check_predicate(atom, known)
        if atom.signature in BELIEF:
            for slot, part in zip(BELIEF[atom.signature].arguments, atom.parts, strict=True):
                check_constant(slot, part, names)
    for literals in _conjunctions(body):
        slots = {name: slot for atom in literals if isinstance(atom, Atom) for name, slot in _slots_of(atom)}
        for name, other in _equated(literals):
            if name in slots:
                check_constant(slots[name], other, names)


def check_predicate(atom: Atom, known: Collection[Signature]) -> None:
    """Raise ClauseError when there is no such predicate."""
    if atom.signature in known:
        return
    name, arity = atom.signature
    forms = sorted(f"{other}/{n}" for other, n in known if other == name)
    hint = f"there is {', '.join(forms)}" if forms else did_you_mean(name, {other for other, _ in known})
    raise ClauseError(f"unknown predicate {name}/{arity}", atom.at, hint)


def check_constant(slot: ArgumentType, term: Term, names: Names) -> None:
    """Raise ClauseError when a constant cannot stand in a slot."""
    if not isinstance(term, Constant) or str(term.value) in names.get(slot.name, ()):
        return
    complaint = slot.check(as_word(term.value))
    if complaint is not None:
        hint = did_you_mean(str(term.value), names.get(slot.name, ())) or complaint.hint
        if complaint.what.startswith("unknown"):
            what = f"unknown constant {abbreviated(as_word(term.value))}, which is no {slot.name}"
            raise ClauseError(what, term.at, hint.replace("one of ", "did you mean one of ") + "?" * ("one of" in hint))
        raise ClauseError(complaint.what, term.at, hint)


def as_word(value: Value) -> Word:
    """Return a known value as the vocabulary's checks take it."""
    if isinstance(value, int):
        return Number(value, NOWHERE)
    if value.type == clingo.SymbolType.String:
        return Text(value.string, NOWHERE)
    if value.type == clingo.SymbolType.Function:
        inner = tuple(
            as_word(part.number if part.type == clingo.SymbolType.Number else part) for part in value.arguments
        )
        return Symbol(value.name if value.positive else f"-{value.name}", inner, NOWHERE)
    return Symbol(str(value), (), NOWHERE)


def _conjunctions(body: Sequence[Literal]) -> Iterator[tuple[Literal, ...]]:
    """A body, and each body in it, with the literals about it."""
    yield tuple(body)
    for literal in body:
        inner = [element.condition for element in literal.elements] if isinstance(literal, Aggregate) else []
        inner += [(literal.literal, *literal.condition)] if isinstance(literal, Every) else []
        for part in inner:
            yield from _conjunctions((*part, *(one for one in body if isinstance(one, Atom))))


def _slots_of(atom: Atom) -> Iterator[tuple[str, ArgumentType]]:
    slots = BELIEF[atom.signature].arguments if atom.signature in BELIEF else ()
    for slot, part in zip(slots, atom.parts, strict=False):
        if isinstance(part, Variable) and slot.limits is None:
            yield part.name, slot


def _equated(literals: Iterable[Literal]) -> Iterator[tuple[str, Constant]]:
    """Variables and the constants with which they are compared for being the same."""
    for literal in literals:
        if not isinstance(literal, Comparison):
            continue
        terms = [literal.first, *(term for _, term in literal.rest)]
        for (sign, right), left in zip(literal.rest, terms, strict=False):
            if sign in ("=", "!="):
                for one, other in ((left, right), (right, left)):
                    if isinstance(one, Variable) and isinstance(other, Constant):
                        yield one.name, other
