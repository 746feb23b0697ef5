"""The values that the arguments of predicates may have: those that are known, and numbers that rules need.

Arguments that share a variable in some rule have the values of one *class*. Numbers are needed where a comparison or
an arithmetic head turns: from `N < 30` come 29 and 30; from the head `p(40 + 4*N)` and the wanted atom `p(72)` comes 8.
In the price of a weak constraint the numbers beside known ones are needed, and 0: with these something is cheaper.
"""

from collections.abc import Iterable, Iterator, Sequence
from itertools import islice, permutations, product

import clingo
from clingo.ast import AST, AggregateFunction, ASTType, ComparisonOperator, Sign

from utak.kb.tracing.calculations import Relation, calculation, turning_numbers
from utak.kb.tracing.syntax import ParsedProgram, Unit, head_elements, nodes_in, variables_in

MAX_NUMBERS = 30  # values of one class, beyond which no number is added; a convention
MAX_COMBINATIONS = 100  # values of the other variables of a comparison that are tried; a convention
MAX_NUMBER_ROUNDS = 3  # rounds in which needed numbers lead to other needed numbers; a convention
ArgumentPosition = tuple[str, int, int]  # the name of a predicate, its number of arguments, the index of the argument
Slot = ArgumentPosition | tuple[int, str]  # a position, or the number of a unit and one of its variables
ARITHMETIC = (ASTType.BinaryOperation, ASTType.UnaryOperation)


class Domains:
    """The values of arguments, by class."""

    def __init__(self, program: ParsedProgram, units: Sequence[int], atoms: Iterable[clingo.Symbol]) -> None:
        self.cut = False
        self._constants = _constant_values(program)
        self._parent: dict[Slot, Slot] = {}
        self._values: dict[Slot, dict[clingo.Symbol, None]] = {}
        self._tried: set[tuple[int, int, str, tuple[int, ...]]] = set()
        counted = [(number, program.units[number]) for number in units]
        relations = [(number, self._relations(number, unit)) for number, unit in counted]
        for atom in atoms:
            for index, value in enumerate(atom.arguments):
                self._add((atom.name, len(atom.arguments), index), value)
        for number, unit in counted:
            self._add_constants(number, unit)
        for number, unit in counted:
            self._add_prices(number, unit)
        for _ in range(MAX_NUMBER_ROUNDS):
            found = [
                pair
                for number, part in relations
                for index, one in enumerate(part)
                for pair in self._needed(number, index, one)
            ]
            if not sum(self._add(slot, clingo.Number(value)) for slot, value in found):
                break

    def values(self, position: ArgumentPosition) -> list[clingo.Symbol]:
        """Return the values of an argument, known ones before needed ones; [] when none is known."""
        return list(self._values.get(self._find(position), ()))

    def constant(self, term: AST) -> clingo.Symbol | None:
        """Return the value of a term without variables; None for a term with variables or without a value."""
        if term.ast_type == ASTType.SymbolicTerm:
            symbol: clingo.Symbol = term.symbol
            return self._constants.get(str(symbol), symbol)
        if term.ast_type in ARITHMETIC:
            number = calculation(term, self._constants)({})
            return None if number is None else clingo.Number(number)
        if term.ast_type == ASTType.Function and not term.external:
            parts = [self.constant(part) for part in term.arguments]
            if all(part is not None for part in parts):
                return clingo.Function(term.name, [part for part in parts if part is not None])
        return None

    # ---- classes ----

    def _find(self, slot: Slot) -> Slot:
        """Return the slot that stands for the class of a slot."""
        while slot in self._parent:
            slot = self._parent[slot]
        return slot

    def _join(self, one: Slot, other: Slot) -> None:
        """Make one class of the classes of two slots."""
        one, other = self._find(one), self._find(other)
        if one != other:
            self._parent[other] = one

    def _add(self, slot: Slot, value: clingo.Symbol) -> bool:
        """Add a value to the class of a slot; return whether it is new there."""
        known = self._values.setdefault(self._find(slot), {})
        if value in known:
            return False
        if value.type == clingo.SymbolType.Number and len(known) >= MAX_NUMBERS:
            self.cut = True
            return False
        known[value] = None
        return True

    def _relations(self, number: int, unit: Unit) -> list[Relation]:
        """Join the slots of a unit, and return what it compares."""
        found: list[Relation] = []
        heads = list(map(str, stated_by(unit)))
        for atom in atoms_in(unit):
            for index, term in enumerate(arguments_of(atom)):
                position = (atom_name(atom), len(arguments_of(atom)), index)
                if term.ast_type == ASTType.Variable:
                    self._join(position, (number, term.name))
                elif term.ast_type in ARITHMETIC:
                    name = "=" + "/".join(map(str, position))
                    self._join(position, (number, name))
                    fixed = frozenset({name}) if str(atom) in heads else frozenset()
                    found.append(self._relation((name,), term, ComparisonOperator.Equal, fixed))
        for comparison in _comparisons(unit):
            sides = [comparison.term, *(guard.term for guard in comparison.guards)]
            for left, right, guard in zip(sides, sides[1:], comparison.guards, strict=False):
                if self._are_equal_variables(number, left, right, guard.comparison):
                    continue
                if guard.comparison != ComparisonOperator.NotEqual:
                    found.append(self._relation(left, right, guard.comparison))
        for aggregate in _aggregates(unit):
            self._join_aggregate(number, aggregate)
        return found

    def _relation(self, left: AST | tuple[str], right: AST, sign: int, fixed: frozenset[str] = frozenset()) -> Relation:
        """Return two terms held against each other; the left one may be the name of a variable alone."""
        second = calculation(right, self._constants)
        if isinstance(left, tuple):
            (name,) = left
            names = tuple(dict.fromkeys((name, *variables_in(right))))
            return Relation(lambda values: values.get(name), second, names, sign, fixed)
        names = tuple(dict.fromkeys((*variables_in(left), *variables_in(right))))
        return Relation(calculation(left, self._constants), second, names, sign, fixed)

    def _are_equal_variables(self, number: int, left: AST, right: AST, sign: int) -> bool:
        """Join two variables that must be equal, and return whether that is what a comparison says."""
        both = left.ast_type == ASTType.Variable and right.ast_type == ASTType.Variable
        if both and sign == ComparisonOperator.Equal:
            self._join((number, left.name), (number, right.name))
            return True
        return False

    def _join_aggregate(self, number: int, aggregate: AST) -> None:
        """Join the bounds of a greatest or least value with the values of which it is one."""
        if aggregate.function not in (AggregateFunction.Max, AggregateFunction.Min):
            return
        bounds = [guard.term for guard in (aggregate.left_guard, aggregate.right_guard) if guard is not None]
        firsts = [element.terms[0] for element in aggregate.elements if len(element.terms)]
        names = [term.name for term in (*bounds, *firsts) if term.ast_type == ASTType.Variable]
        for name in names[1:]:
            self._join((number, names[0]), (number, name))

    # ---- values ----

    def _add_constants(self, number: int, unit: Unit) -> None:
        """Add the constants of a unit's atoms and comparisons to the classes of their positions and variables."""
        for comparison in _comparisons(unit):
            sides = [comparison.term, *(guard.term for guard in comparison.guards)]
            for one, other in permutations(sides, 2):
                value = self.constant(other)
                if one.ast_type == ASTType.Variable and value is not None:
                    self._add((number, one.name), value)
        for atom in atoms_in(unit):
            for index, term in enumerate(arguments_of(atom)):
                value = self.constant(term)
                if value is not None:
                    self._add((atom_name(atom), len(arguments_of(atom)), index), value)

    def _add_prices(self, number: int, unit: Unit) -> None:
        """Add to the numbers in the price of a weak constraint those beside them, and 0."""
        if unit.node.ast_type == ASTType.Minimize:
            for name in dict.fromkeys(variables_in(unit.node.weight)):
                near = [value for known in self._numbers((number, name)) for value in (known - 1, known + 1)]
                for value in (0, *near):
                    if value >= 0:
                        self._add((number, name), clingo.Number(value))

    def _needed(self, number: int, index: int, one: Relation) -> Iterator[tuple[Slot, int]]:
        """Yield (slot, number) of the numbers at which a relation turns, for each of its variables."""
        for target in one.names:
            if target in one.fixed:
                continue
            slot: Slot = (number, target)
            others = [name for name in one.names if name != target]
            options = [self._numbers((number, name)) for name in others]
            for values in islice(product(*options), MAX_COMBINATIONS):
                key = (number, index, target, values)
                if key in self._tried:
                    continue
                self._tried.add(key)
                for value in turning_numbers(one, target, dict(zip(others, values, strict=True))):
                    if value >= 0 or any(other < 0 for other in self._numbers(slot)):
                        yield slot, value

    def _numbers(self, slot: Slot) -> list[int]:
        """Return the numbers of the class of a slot."""
        known = self._values.get(self._find(slot), ())
        return [value.number for value in known if value.type == clingo.SymbolType.Number]


def atoms_in(unit: Unit) -> list[AST]:
    """Return all atoms of a unit, as literals without sign or with one, those in aggregates and conditions included."""
    return [one for one in _literals_in(unit) if one.atom.ast_type == ASTType.SymbolicAtom]


def atom_name(literal: AST) -> str:
    """Return the name of the predicate of a literal."""
    symbol = literal.atom.symbol
    return str(symbol.name if symbol.ast_type == ASTType.Function else symbol.symbol.name)


def arguments_of(literal: AST) -> list[AST]:
    """Return the arguments of the atom of a literal."""
    return list(getattr(literal.atom.symbol, "arguments", ()))


def stated_by(unit: Unit) -> list[AST]:
    """Return the atoms that a unit states or may choose, as literals; [] for a constraint or a weak constraint."""
    if unit.node.ast_type == ASTType.Minimize:
        return []
    return [literal for literal, _ in head_elements(unit.node.head) if literal.sign == Sign.NoSign]


def _constant_values(program: ParsedProgram) -> dict[str, clingo.Symbol]:
    """Return the values of `#const` definitions by name."""
    control = clingo.Control()
    control.add("base", [], "\n".join(program.constants))
    found = {}
    for text in program.constants:
        name = text.split()[1]
        value = control.get_const(name)
        if value is not None:
            found[name] = value
    return found


def _comparisons(unit: Unit) -> Iterator[AST]:
    """Yield the comparisons of a unit, at whatever depth."""
    for literal in _literals_in(unit):
        if literal.atom.ast_type == ASTType.Comparison:
            yield literal.atom


def _aggregates(unit: Unit) -> Iterator[AST]:
    """Yield the aggregates in the body of a unit."""
    for literal in unit.node.body:
        if literal.ast_type == ASTType.Literal and literal.atom.ast_type == ASTType.BodyAggregate:
            yield literal.atom


def _literals_in(unit: Unit) -> list[AST]:
    """Return the literals of a unit, at whatever depth."""
    return [part for part in nodes_in(unit.node) if part.ast_type == ASTType.Literal]
