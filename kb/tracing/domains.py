"""The values that the arguments of predicates may have: those that are known, and numbers that rules need.

Arguments that share a variable in some rule have the values of one *class*. Numbers are needed where a comparison or
an arithmetic head turns: from `N < 30` come 29 and 30; from the head `p(40 + 4*N)` and the wanted atom `p(72)`
comes 8.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from itertools import islice, product
from typing import NamedTuple

import clingo
from clingo.ast import (
    AST,
    AggregateFunction,
    ASTType,
    BinaryOperator,
    ComparisonOperator,
    Sign,
    Transformer,
    UnaryOperator,
)

from kb.tracing.syntax import HIDDEN_PREFIX, ParsedProgram, Unit, head_elements

MAX_NUMBERS = 40  # numbers of one class; a convention
MAX_COMBINATIONS = 100  # values of the other variables of a comparison that are tried; a convention
MAX_NUMBER_ROUNDS = 3  # rounds in which needed numbers lead to other needed numbers; a convention
GREATEST_NUMBER = 1_000_000  # the greatest number that is looked for, as in kb.reasoning.interfaces
ArgumentPosition = tuple[str, int, int]  # the name of a predicate, its number of arguments, the index of the argument
Slot = ArgumentPosition | tuple[int, str]  # a position, or the number of a unit and a variable that stands in no atom


class Relation(NamedTuple):
    """Two terms of a unit that are held against each other.

    Attributes
    ----------
    left, right : the terms; the left one is a slot where the head or an atom of the unit has arithmetic.
    sign : how clingo compares them.
    is_head : whether the slot on the left is one of the head; then its numbers are wanted, and none are added to them.
    """

    left: "AST | Slot"
    right: AST
    sign: int
    is_head: bool = False


class Domains:
    """The values of arguments, by class.

    Parameters
    ----------
    program : the program taken apart.
    units : the indices of its units that count.
    atoms : the wanted atom, the input facts, and all other atoms that are known to hold.

    Attributes
    ----------
    cut : whether numbers were left out.
    """

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
        for _, unit in counted:
            self._add_constants(unit)
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
        number = self._evaluate(term, {})
        if number is not None:
            return clingo.Number(number)
        if term.ast_type == ASTType.Function and not term.external:
            parts = [self.constant(part) for part in term.arguments]
            if all(part is not None for part in parts):
                return clingo.Function(term.name, [part for part in parts if part is not None])
        return None

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
                elif term.ast_type in (ASTType.BinaryOperation, ASTType.UnaryOperation):
                    found.append(Relation(position, term, ComparisonOperator.Equal, str(atom) in heads))
        for comparison in _comparisons(unit):
            left = comparison.term
            for guard in comparison.guards:
                found.append(Relation(left, guard.term, guard.comparison))
                left = guard.term
        for aggregate in _aggregates(unit):
            self._join_aggregate(number, aggregate)
        return [one for one in found if not self._joins_variables(number, one)]

    def _joins_variables(self, number: int, one: Relation) -> bool:
        """Join two variables that must be equal, and return whether that is all that a relation says."""
        terms = (one.left, one.right)
        if one.sign == ComparisonOperator.Equal and all(
            isinstance(term, AST) and term.ast_type == ASTType.Variable for term in terms
        ):
            first, second = ((number, term.name) for term in terms if isinstance(term, AST))
            self._join(first, second)
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

    def _add_constants(self, unit: Unit) -> None:
        """Add the constants of a unit's atoms to the classes of their positions."""
        for atom in atoms_in(unit):
            for index, term in enumerate(arguments_of(atom)):
                value = self.constant(term)
                if value is not None:
                    self._add((atom_name(atom), len(arguments_of(atom)), index), value)

    # ---- needed numbers ----

    def _needed(self, number: int, index: int, one: Relation) -> Iterator[tuple[Slot, int]]:
        """Yield (slot, number) of the numbers at which a relation turns, for each of its variables.

        number : the number of the unit. index : that of the relation in it.
        """
        if one.sign == ComparisonOperator.NotEqual:
            return
        left = _names(one.left) if isinstance(one.left, AST) else []
        slots: dict[str, Slot] = {name: (number, name) for name in (*left, *_names(one.right))}
        if not isinstance(one.left, AST):
            slots["="] = one.left
        for target, slot in slots.items():
            if target == "=" and one.is_head:
                continue
            others = [name for name in slots if name != target]
            options = [self._numbers(slots[name]) for name in others]
            for values in islice(product(*options), MAX_COMBINATIONS):
                key = (number, index, target, values)
                if key in self._tried:
                    continue
                self._tried.add(key)
                for value in self._turns(one, target, dict(zip(others, values, strict=True))):
                    if value >= 0 or any(other < 0 for other in self._numbers(slot)):
                        yield slot, value

    def _numbers(self, slot: Slot) -> list[int]:
        """Return the numbers of the class of a slot."""
        known = self._values.get(self._find(slot), ())
        return [value.number for value in known if value.type == clingo.SymbolType.Number]

    def _turns(self, one: Relation, target: str, env: Mapping[str, int]) -> list[int]:
        """Return the values of one variable on both sides of where a relation turns, given those of the others.

        For an equation the value with which it holds. [] when it turns nowhere.
        """

        def difference(value: int) -> int | None:
            """Return by how much the left side exceeds the right one."""
            whole = {**env, target: value}
            left = self._evaluate(one.left, whole) if isinstance(one.left, AST) else whole["="]
            right = self._evaluate(one.right, whole)
            return None if left is None or right is None else left - right

        strict = one.sign in (ComparisonOperator.LessEqual, ComparisonOperator.GreaterThan)
        edge = _edge(difference, 1 if strict else 0)
        if edge is None:
            return []
        near = [edge - 1, edge]
        if one.sign == ComparisonOperator.Equal:
            return [value for value in near if difference(value) == 0][:1]
        return near

    def _evaluate(self, term: AST, env: Mapping[str, int]) -> int | None:
        """Return the number that a term denotes with values for its variables; None when it denotes none."""
        if term.ast_type == ASTType.SymbolicTerm:
            value = self._constants.get(str(term.symbol), term.symbol)
            return value.number if value.type == clingo.SymbolType.Number else None
        if term.ast_type == ASTType.Variable:
            return env.get(term.name)
        if term.ast_type == ASTType.UnaryOperation:
            inner = self._evaluate(term.argument, env)
            if inner is None:
                return None
            if term.operator_type == UnaryOperator.Minus:
                return -inner
            return abs(inner) if term.operator_type == UnaryOperator.Absolute else None
        if term.ast_type != ASTType.BinaryOperation:
            return None
        left, right = (self._evaluate(part, env) for part in (term.left, term.right))
        return None if left is None or right is None else _calculated(term.operator_type, left, right)


def atoms_in(unit: Unit) -> list[AST]:
    """Return all atoms of a unit, as literals without sign or with one, those in aggregates and conditions included."""
    collector = _LiteralCollector()
    collector.visit(unit.node)
    return [one for one in collector.found if one.atom.ast_type == ASTType.SymbolicAtom]


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


def is_hidden(variable: str) -> bool:
    """Return whether a variable was anonymous."""
    return variable == "_" or variable.startswith(HIDDEN_PREFIX)


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
    collector = _LiteralCollector()
    collector.visit(unit.node)
    for literal in collector.found:
        if literal.atom.ast_type == ASTType.Comparison:
            yield literal.atom


def _aggregates(unit: Unit) -> Iterator[AST]:
    """Yield the aggregates in the body of a unit."""
    for literal in unit.node.body:
        if literal.ast_type == ASTType.Literal and literal.atom.ast_type == ASTType.BodyAggregate:
            yield literal.atom


def _names(term: AST) -> Sequence[str]:
    """Return the names of the variables of a term, each once."""
    collector = _LiteralCollector()
    collector.visit(term)
    return list(dict.fromkeys(collector.names))


def _calculated(operator: int, left: int, right: int) -> int | None:
    """Return the result of an operation on two integers as clingo computes it; None when it has none."""
    if operator == BinaryOperator.Plus:
        return left + right
    if operator == BinaryOperator.Minus:
        return left - right
    if operator == BinaryOperator.Multiplication:
        return left * right
    if operator in (BinaryOperator.Division, BinaryOperator.Modulo) and right != 0:
        quotient = abs(left) // abs(right) * (1 if (left < 0) == (right < 0) else -1)
        return quotient if operator == BinaryOperator.Division else left - quotient * right
    return None


def _edge(difference: Callable[[int], int | None], least: int) -> int | None:
    """Return the least number from which on a monotone function is at least `least`, or no longer at least that.

    None when there is none up to GREATEST_NUMBER, or when the function has no value.
    """
    low, high = -GREATEST_NUMBER, GREATEST_NUMBER
    first, last = difference(low), difference(high)
    if first is None or last is None:
        return None
    if (first >= least) == (last >= least):  # a quotient turns at 0 besides
        low, first = 1, difference(1)
        if first is None or (first >= least) == (last >= least):
            return None
    slope, rest = divmod(last - first, high - low)
    if slope and not rest and difference(low + 1) == first + slope:  # likely a straight line
        guess = low - (first - least) // slope
        for edge in (guess - 1, guess, guess + 1):
            before, after = difference(edge - 1), difference(edge)
            if before is not None and after is not None and (before >= least) != (after >= least):
                return edge
    rising = last >= least
    while high - low > 1:
        middle = (low + high) // 2
        found = difference(middle)
        if found is None:
            return None
        low, high = (low, middle) if (found >= least) == rising else (middle, high)
    return high


class _LiteralCollector(Transformer):
    """Collects literals in `found` and names of variables in `names`; clingo calls the `visit` methods."""

    def __init__(self) -> None:
        self.found: list[AST] = []
        self.names: list[str] = []

    def visit_Literal(self, node: AST) -> AST:  # noqa: N802 (clingo's name)
        """Append a literal to `found`, and visit its parts; return the node."""
        self.found.append(node)
        self.visit_children(node)
        return node

    def visit_Variable(self, node: AST) -> AST:  # noqa: N802 (clingo's name)
        """Append the name of a variable to `names`; return the node."""
        self.names.append(node.name)
        return node
