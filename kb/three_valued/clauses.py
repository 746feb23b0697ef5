"""Bodies of rules as values: what clingo has read, turned into a few plain kinds of terms and literals.

Pools are multiplied out: a body with pools becomes several. An interval in an argument becomes a variable of its own.
"""

import itertools
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import clingo
from clingo.ast import AST, AggregateFunction, ASTType, BinaryOperator, ComparisonOperator, Sign, UnaryOperator

from kb.language.integers import MIN_INT32

SIGNS = {
    ComparisonOperator.GreaterThan: ">", ComparisonOperator.LessThan: "<", ComparisonOperator.LessEqual: "<=",
    ComparisonOperator.GreaterEqual: ">=", ComparisonOperator.NotEqual: "!=", ComparisonOperator.Equal: "=",
}  # fmt: skip
BINARY = {
    BinaryOperator.XOr: "^", BinaryOperator.Or: "?", BinaryOperator.And: "&", BinaryOperator.Plus: "+",
    BinaryOperator.Minus: "-", BinaryOperator.Multiplication: "*", BinaryOperator.Division: "/",
    BinaryOperator.Modulo: "\\", BinaryOperator.Power: "**",
}  # fmt: skip
UNARY = {UnaryOperator.Minus: "-", UnaryOperator.Negation: "~", UnaryOperator.Absolute: "|"}
FUNCTIONS = {
    AggregateFunction.Count: "#count", AggregateFunction.Sum: "#sum", AggregateFunction.SumPlus: "#sum+",
    AggregateFunction.Min: "#min", AggregateFunction.Max: "#max",
}  # fmt: skip


class ClauseError(Exception):
    """A text says something that is not known here: what, and at which place."""

    def __init__(self, what: str, at: tuple[int, int], hint: str = "") -> None:
        self.what, self.at, self.hint = what, at, hint
        super().__init__(what)


@dataclass(frozen=True)
class Constant:
    """A number, a name or another ground term."""

    value: Any
    at: tuple[int, int]


@dataclass(frozen=True)
class Variable:
    """A variable. Each `_` has a name of its own, such as `?1`; an interval in an argument has one such as `.1`."""

    name: str
    at: tuple[int, int]


@dataclass(frozen=True)
class Operation:
    """Arithmetic on one or two terms; `..` stands for an interval."""

    sign: str
    parts: tuple["Term", ...]
    at: tuple[int, int]


@dataclass(frozen=True)
class Compound:
    """A term with arguments; a tuple has the name ''."""

    name: str
    parts: tuple["Term", ...]
    at: tuple[int, int]


Term = Constant | Variable | Operation | Compound


@dataclass(frozen=True)
class Atom:
    """A predicate with arguments. negations : how many `not` stand before it, 0 to 2."""

    name: str
    parts: tuple[Term, ...]
    negations: int
    at: tuple[int, int]

    @property
    def signature(self) -> tuple[str, int]:
        """The name and the number of arguments."""
        return self.name, len(self.parts)


@dataclass(frozen=True)
class Comparison:
    """`first sign term sign term ...`, or that this does not hold."""

    first: Term
    rest: tuple[tuple[str, Term], ...]
    negated: bool
    at: tuple[int, int]


@dataclass(frozen=True)
class Element:
    """What an aggregate counts: the terms, where all literals hold."""

    terms: tuple[Term, ...]
    condition: tuple["Literal", ...]


@dataclass(frozen=True)
class Aggregate:
    """`term sign #function { elements }` for each of its guards, or that one of these does not hold."""

    function: str
    elements: tuple[Element, ...]
    guards: tuple[tuple[str, Term], ...]
    negated: bool
    at: tuple[int, int]


@dataclass(frozen=True)
class Every:
    """The literal holds wherever all literals of the condition do."""

    literal: "Literal"
    condition: tuple["Literal", ...]
    at: tuple[int, int]


@dataclass(frozen=True)
class Always:
    """`#true` or `#false`."""

    value: bool
    at: tuple[int, int]


Literal = Atom | Comparison | Aggregate | Every | Always


@dataclass(frozen=True)
class Clause:
    """A rule without pools. head : None for a constraint or a query."""

    head: Atom | None
    body: tuple[Literal, ...]
    at: tuple[int, int]


def clauses_of(rule: AST) -> list[Clause]:
    """Return a rule with one plain atom as its head, or none, as clauses; raises ClauseError for any other."""
    return [_Translator().clause(part) for part in rule.unpool()]


def place_of(node: AST) -> tuple[int, int]:
    """Return the place at which a part begins."""
    begin = node.location.begin
    return begin.line, begin.column


class _Translator:
    """Translates one rule; intervals that it meets in arguments wait in `intervals` for their conjunction."""

    def __init__(self) -> None:
        self._numbers = itertools.count()
        self._intervals: list[Literal] = []

    def clause(self, rule: AST) -> Clause:
        head = self._head(rule.head)
        waiting, self._intervals = self._intervals, []
        return Clause(head, (*self._conjunction(rule.body), *waiting), place_of(rule))

    def _head(self, node: AST) -> Atom | None:
        if node.ast_type == ASTType.Literal and node.sign == Sign.NoSign:
            if node.atom.ast_type == ASTType.BooleanConstant and not node.atom.value:
                return None
            if node.atom.ast_type == ASTType.SymbolicAtom:
                return self._atom(node)
        raise ClauseError("a rule has one plain atom as its head here", place_of(node))

    def _conjunction(self, nodes: Iterable[AST]) -> tuple[Literal, ...]:
        outer, self._intervals = self._intervals, []
        found = [self._literal(node) for node in nodes]
        found += self._intervals
        self._intervals = outer
        return tuple(found)

    def _literal(self, node: AST) -> Literal:
        if node.ast_type == ASTType.ConditionalLiteral:
            condition = self._conjunction(node.condition)
            (literal, *intervals) = self._conjunction([node.literal])
            if intervals:
                raise ClauseError("no interval stands here", place_of(node))
            return Every(literal, condition, place_of(node))
        atom, at = node.atom, place_of(node)
        if atom.ast_type == ASTType.BooleanConstant:
            return Always(bool(atom.value) != (node.sign == Sign.Negation), at)
        if atom.ast_type == ASTType.SymbolicAtom:
            return self._atom(node)
        if atom.ast_type == ASTType.Comparison:
            rest = tuple((SIGNS[guard.comparison], self._term(guard.term, True)) for guard in atom.guards)
            return Comparison(self._term(atom.term, True), rest, node.sign == Sign.Negation, at)
        if atom.ast_type in (ASTType.BodyAggregate, ASTType.Aggregate):
            return self._aggregate(atom, node.sign == Sign.Negation, at)
        raise ClauseError("theory atoms are not known here", at)

    def _atom(self, node: AST) -> Atom:
        found, at = node.atom.symbol, place_of(node.atom.symbol)
        if found.ast_type == ASTType.UnaryOperation:
            raise ClauseError("classical negation is not known here", at, "write not, for what is not believed")
        if found.ast_type == ASTType.SymbolicTerm:  # an atom without arguments
            return Atom(found.symbol.name, (), int(node.sign), at)
        return Atom(found.name, tuple(map(self._term, found.arguments)), int(node.sign), at)

    def _aggregate(self, node: AST, negated: bool, at: tuple[int, int]) -> Aggregate:
        sides = ((node.left_guard, 0), (node.right_guard, 1))
        guards = [
            (SIGNS[guard.comparison] if left == 0 else _TURNED[SIGNS[guard.comparison]], self._term(guard.term))
            for guard, left in sides
            if guard is not None
        ]
        if node.ast_type == ASTType.Aggregate:
            elements = [self._choice(number, element) for number, element in enumerate(node.elements)]
            return Aggregate("#count", tuple(elements), tuple(guards), negated, at)
        elements = [self._element(element.terms, element.condition) for element in node.elements]
        return Aggregate(FUNCTIONS[node.function], tuple(elements), tuple(guards), negated, at)

    def _element(self, terms: Iterable[AST], condition: Iterable[AST]) -> Element:
        outer, self._intervals = self._intervals, []
        found = tuple(map(self._term, terms))
        waiting, self._intervals = self._intervals, outer
        return Element(found, (*self._conjunction(condition), *waiting))

    def _choice(self, number: int, node: AST) -> Element:
        """An element of `{ literal : condition }`: its instances are counted."""
        literals = self._conjunction([node.literal, *node.condition])
        at = place_of(node)
        first = literals[0]
        parts: tuple[Term, ...] = first.parts if isinstance(first, Atom) and first.negations == 0 else ()
        name = f"{first.name}/{len(parts)}" if isinstance(first, Atom) else str(number)
        return Element((Constant(clingo.String(name), at), *parts), literals)

    def _term(self, node: AST, whole: bool = False) -> Term:
        """A term. whole : it may be an interval, for it stands in a comparison by itself."""
        at = place_of(node)
        if node.ast_type == ASTType.SymbolicTerm:
            value = node.symbol
            return Constant(value.number if value.type == clingo.SymbolType.Number else value, at)
        if node.ast_type == ASTType.Variable:
            return Variable(f"?{next(self._numbers)}" if node.name == "_" else node.name, at)
        if node.ast_type == ASTType.Interval:
            interval = Operation("..", (self._term(node.left), self._term(node.right)), at)
            if whole:
                return interval
            variable = Variable(f".{next(self._numbers)}", at)
            self._intervals.append(Comparison(variable, (("=", interval),), False, at))
            return variable
        if node.ast_type == ASTType.UnaryOperation:
            inner, sign = self._term(node.argument), UNARY[node.operator_type]
            plain = sign == "-" and node.argument.ast_type == ASTType.SymbolicTerm
            if plain and isinstance(inner, Constant) and isinstance(inner.value, int):
                # clingo has wrapped the literal 2147483648 to -2147483648.
                return Constant(inner.value if inner.value == MIN_INT32 else -inner.value, at)
            return Operation(sign, (inner,), at)
        if node.ast_type == ASTType.BinaryOperation:
            return Operation(BINARY[node.operator_type], (self._term(node.left), self._term(node.right)), at)
        if node.ast_type == ASTType.Function and not node.external:
            return Compound(node.name, tuple(map(self._term, node.arguments)), at)
        raise ClauseError("operation undefined: there are no functions from outside", at)


_TURNED = {"<": ">", "<=": ">=", ">": "<", ">=": "<=", "=": "=", "!=": "!="}


def variables_of(part: Any) -> Iterator[str]:
    """Yield the names of the variables in a term, in a literal, or in several; those of elements are among them."""
    if isinstance(part, Variable):
        yield part.name
    elif isinstance(part, tuple):
        for inner in part:
            yield from variables_of(inner)
    elif isinstance(part, Operation | Compound | Atom):
        yield from variables_of(part.parts)
    elif isinstance(part, Comparison):
        yield from variables_of((part.first, *(term for _, term in part.rest)))
    elif isinstance(part, Aggregate):
        yield from variables_of((*(term for _, term in part.guards), *part.elements))
    elif isinstance(part, Element):
        yield from variables_of((part.terms, part.condition))
    elif isinstance(part, Every):
        yield from variables_of((part.literal, part.condition))


def global_variables(body: Sequence[Literal]) -> dict[str, None]:
    """Return the named variables of a body that are its own, in the order in which they appear.

    What stands only in elements of aggregates and in conditional literals is theirs.
    """
    found: dict[str, None] = {}
    for literal in body:
        if isinstance(literal, Aggregate):
            outer: Any = tuple(term for _, term in literal.guards)
        else:
            outer = () if isinstance(literal, Every) else literal
        found |= dict.fromkeys(name for name in variables_of(outer) if not name.startswith(("?", ".")))
    return found


def atoms_of(part: Any) -> Iterator[Atom]:
    """Yield the atoms in literals, also those in aggregates and conditions."""
    if isinstance(part, Atom):
        yield part
    elif isinstance(part, tuple):
        for inner in part:
            yield from atoms_of(inner)
    elif isinstance(part, Aggregate):
        for element in part.elements:
            yield from atoms_of(element.condition)
    elif isinstance(part, Every):
        yield from atoms_of((part.literal, part.condition))
