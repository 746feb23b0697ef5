"""Input facts that might be given besides, so that a wanted atom holds: only those on which it may rest.

Rules are followed backwards from the wanted atom. What a rule's head fixes is fixed in the atoms of its body; a
variable that stands nowhere else in the rule may have any value, so one is enough; all other arguments have the values
of kb.tracing.domains.
"""

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from itertools import combinations, islice, product
from math import prod
from typing import NamedTuple

import clingo
from clingo.ast import AST, AggregateFunction, ASTType

from utak.kb.language.vocabulary import Signature
from utak.kb.tracing.domains import Domains, arguments_of, atom_name, atoms_in, stated_by
from utak.kb.tracing.syntax import ParsedProgram, Unit, global_variables_of, variables_in

MAX_FACTS_OF_ATOM = 200  # candidates for one atom of a rule; a convention
MAX_CANDIDATES = 3_000  # candidates in all; a convention
MAX_CANDIDATES_OF_CHOICE = 300  # candidates in all where costs decide, which is dear to check; a convention
MAX_CANDIDATES_OF_SUM = 8  # candidates in all where facts are summed up: a sum of n has up to 2**n values; a convention
MAX_COMPARED = 40  # given facts of a predicate with which a candidate is compared; a convention
FREE_ARGUMENT, ANY_ARGUMENT = "free", "any"  # what a pattern says of an open argument: it matters, or it does not
PatternPart = clingo.Symbol | str  # a value, FREE_ARGUMENT or ANY_ARGUMENT


class AtomPattern(NamedTuple):
    """Atoms of one predicate."""

    name: str  # the name of the predicate
    # Of each argument its value, FREE_ARGUMENT (any value, which matters) or ANY_ARGUMENT (whatever its value)
    parts: tuple[PatternPart, ...]


class CandidateFacts(NamedTuple):
    """Facts that might be given besides."""

    facts: tuple[str, ...]  # the facts, those first that differ least from given ones
    removable: tuple[str, ...]  # the given facts on which the wanted atom may rest
    by_choice: bool  # whether it may rest on a choice, so that costs matter
    cut: bool  # whether some facts were left out


def candidate_facts(
    program: ParsedProgram, facts: Sequence[clingo.Symbol], atoms: Iterable[clingo.Symbol], wanted: clingo.Symbol
) -> CandidateFacts:
    """Return the input facts that might be given besides."""
    units, by_choice = _relevant_units(program, wanted)
    domains = Domains(program, units, [wanted, *facts, *atoms])
    patterns = _needed_patterns(program, units, domains, wanted)
    given = set(facts)
    found: dict[clingo.Symbol, None] = {}
    cut = domains.cut
    for pattern in patterns:
        if (pattern.name, len(pattern.parts)) not in program.defined:
            continue
        instances, shortened = _instances(pattern, domains, facts)
        cut |= shortened
        for symbol in instances:
            if len(found) >= MAX_CANDIDATES:
                cut = True
                break
            if symbol not in given:
                found[symbol] = None
    ordered = _nearest_first(list(found), facts)
    most = (
        MAX_CANDIDATES_OF_SUM if any(_sums_up(program.units[number]) for number in units) else MAX_CANDIDATES_OF_CHOICE
    )
    if by_choice and len(ordered) > most:
        about = set(wanted.arguments)
        ordered.sort(key=lambda fact: bool(fact.arguments) and not about.intersection(fact.arguments))
        ordered, cut = ordered[:most], True
    removable = tuple(str(fact) for fact in facts if any(_matches(fact, one) for one in patterns))
    return CandidateFacts(tuple(map(str, ordered)), removable, by_choice, cut)


def _sums_up(unit: Unit) -> bool:
    """Return whether a unit has a sum of facts in its body."""
    body = getattr(unit.node, "body", ())
    sums = (AggregateFunction.Sum, AggregateFunction.SumPlus)
    atoms = [part.atom for part in body if part.ast_type == ASTType.Literal]
    return any(atom.ast_type == ASTType.BodyAggregate and atom.function in sums for atom in atoms)


def _matches(fact: clingo.Symbol, pattern: AtomPattern) -> bool:
    """Return whether a fact has the values that a pattern fixes."""
    if (fact.name, len(fact.arguments)) != (pattern.name, len(pattern.parts)):
        return False
    return all(
        isinstance(part, str) or part == value for part, value in zip(pattern.parts, fact.arguments, strict=True)
    )


def _nearest_first(found: Sequence[clingo.Symbol], facts: Sequence[clingo.Symbol]) -> list[clingo.Symbol]:
    """Return facts sorted by how little they differ from a given fact, else in their order."""
    given: dict[Signature, list[clingo.Symbol]] = {}
    for fact in facts:
        given.setdefault((fact.name, len(fact.arguments)), []).append(fact)

    def distance(one: clingo.Symbol) -> tuple[int, int]:
        """Return in how many arguments a fact differs from the most similar given one, and by how much."""
        others = given.get((one.name, len(one.arguments)), [])[:MAX_COMPARED]
        return min((_difference(one, other) for other in others), default=(len(one.arguments), 0))

    return sorted(found, key=distance)


def _difference(one: clingo.Symbol, other: clingo.Symbol) -> tuple[int, int]:
    """Return in how many arguments two atoms differ, and the sum of the differences of numbers."""
    pairs = [(a, b) for a, b in zip(one.arguments, other.arguments, strict=True) if a != b]
    number = clingo.SymbolType.Number
    return len(pairs), sum(abs(a.number - b.number) for a, b in pairs if a.type == b.type == number)


def _signature(literal: AST) -> Signature:
    """Return the predicate of a literal."""
    return atom_name(literal), len(arguments_of(literal))


def _relevant_units(program: ParsedProgram, wanted: clingo.Symbol) -> tuple[list[int], bool]:
    """Return the indices of the units on which an atom may rest, and whether a choice is among them."""
    # When it is, the constraints and weak constraints are among them, too, for they decide what is chosen.
    reached = {(wanted.name, len(wanted.arguments))}
    found: set[int] = set()
    by_choice = False
    while True:
        new = {
            number
            for number, unit in enumerate(program.units)
            if number not in found
            and (
                reached.intersection(map(_signature, stated_by(unit)))
                or (by_choice and program.statements[unit.statement].kind in ("constraint", "weak"))
            )
        }
        if not new:
            return sorted(found), by_choice
        found |= new
        for number in new:
            reached |= set(map(_signature, atoms_in(program.units[number])))
            by_choice |= program.statements[program.units[number].statement].kind in ("choice", "disjunction")


def _needed_patterns(
    program: ParsedProgram, units: Sequence[int], domains: Domains, wanted: clingo.Symbol
) -> list[AtomPattern]:
    """Return patterns of the atoms on which a wanted atom may rest, itself the first."""
    counted = [program.units[number] for number in units]
    found: dict[AtomPattern, None] = {AtomPattern(wanted.name, tuple(wanted.arguments)): None}
    for unit in counted:
        if program.statements[unit.statement].kind in ("constraint", "weak"):
            found |= dict.fromkeys(_body_patterns(unit, {}, domains))
    waiting = list(found)
    while waiting:
        pattern = waiting.pop(0)
        for unit in counted:
            for head in stated_by(unit):
                bound = _unified(head, pattern, domains)
                new = () if bound is None else _body_patterns(unit, bound, domains)
                for one in new:
                    if one not in found:
                        found[one] = None
                        waiting.append(one)
    return list(found)


def _unified(head: AST, pattern: AtomPattern, domains: Domains) -> dict[str, PatternPart] | None:
    """Return what a pattern fixes of the variables of a head; None when the head cannot state such an atom."""
    terms = arguments_of(head)
    if atom_name(head) != pattern.name or len(terms) != len(pattern.parts):
        return None
    bound: dict[str, PatternPart] = {}
    for term, part in zip(terms, pattern.parts, strict=True):
        if isinstance(part, str):
            continue
        value = domains.constant(term)
        if value is not None and value != part:
            return None
        if term.ast_type == ASTType.Variable and bound.setdefault(term.name, part) != part:
            return None
    return bound


def _body_patterns(unit: Unit, bound: dict[str, PatternPart], domains: Domains) -> Iterator[AtomPattern]:
    """Yield the patterns of the atoms in the body and in the conditions of a unit, with what is fixed."""
    counts = Counter(variables_in(unit.node))
    local = set(counts) - set(global_variables_of(unit.node))
    heads = list(map(str, stated_by(unit)))
    for literal in atoms_in(unit):
        if str(literal) in heads:
            continue
        parts: list[PatternPart] = []
        for term in arguments_of(literal):
            value = domains.constant(term)
            if value is not None:
                parts.append(value)
            elif term.ast_type == ASTType.Variable:
                name = term.name
                fixed = bound.get(name) if name not in local or name in bound else None
                parts.append(
                    fixed if fixed is not None else ANY_ARGUMENT if counts[name] < 2 or name == "_" else FREE_ARGUMENT
                )
            else:
                parts.append(FREE_ARGUMENT)
        yield AtomPattern(atom_name(literal), tuple(parts))


def _instances(
    pattern: AtomPattern, domains: Domains, facts: Sequence[clingo.Symbol]
) -> tuple[Iterable[clingo.Symbol], bool]:
    """Return the facts of a pattern, and whether some were left out because they are too many."""
    options: list[Sequence[clingo.Symbol]] = []
    for index, part in enumerate(pattern.parts):
        known = domains.values((pattern.name, len(pattern.parts), index))
        options.append([part] if isinstance(part, clingo.Symbol) else known[:1] if part == ANY_ARGUMENT else known)
    if prod(map(len, options)) <= MAX_FACTS_OF_ATOM:
        return (clingo.Function(pattern.name, list(values)) for values in product(*options)), False
    similar = [fact for fact in facts if fact.name == pattern.name and len(fact.arguments) == len(options)]
    return islice(_variations(similar, pattern, options), MAX_FACTS_OF_ATOM), True


def _variations(
    facts: Sequence[clingo.Symbol], pattern: AtomPattern, options: Sequence[Sequence[clingo.Symbol]]
) -> Iterator[clingo.Symbol]:
    """Yield facts of a pattern that differ from a given fact in one of the arguments that matter, then those in two."""
    matter = [index for index, part in enumerate(pattern.parts) if part == FREE_ARGUMENT]
    fixed = {index: part for index, part in enumerate(pattern.parts) if isinstance(part, clingo.Symbol)}
    for count in (1, 2):
        for fact in facts:
            base = [fixed.get(index, value) for index, value in enumerate(fact.arguments)]
            for places in combinations(matter, count):
                for values in product(*(options[index] for index in places)):
                    changed = dict(zip(places, values, strict=True))
                    yield clingo.Function(pattern.name, [changed.get(i, value) for i, value in enumerate(base)])
