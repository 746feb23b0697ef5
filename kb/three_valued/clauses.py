"""Rules as values: clingo's syntax trees translated to a few kinds of terms and literals.

A rule with pools becomes several clauses, one for each choice. An interval in an argument becomes a variable of its own
that is compared with the interval. In every class, `at` is (line, column) of the part in its text, from 1.
"""

import itertools
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import clingo
from clingo.ast import AST, ASTType, BinaryOperator, Sign, UnaryOperator

from utak.kb.language.integers import MIN_INT32
from utak.kb.three_valued.uncertain_values import MIRRORED_SIGNS
from utak.kb.tracing.syntax import FUNCTIONS, SIGNS

# clingo's operators as written in programs.
BINARY_SIGNS = {
    BinaryOperator.XOr: "^", BinaryOperator.Or: "?", BinaryOperator.And: "&", BinaryOperator.Plus: "+",
    BinaryOperator.Minus: "-", BinaryOperator.Multiplication: "*", BinaryOperator.Division: "/",
    BinaryOperator.Modulo: "\\", BinaryOperator.Power: "**",
}  # fmt: skip
UNARY_SIGNS = {UnaryOperator.Minus: "-", UnaryOperator.Negation: "~", UnaryOperator.Absolute: "|"}


class ClauseError(Exception):
    """A rule or a query uses an unknown word or a construct that is not supported."""

    def __init__(self, what: str, at: tuple[int, int], hint: str = "") -> None:
        self.what, self.at, self.hint = what, at, hint
        super().__init__(what)


@dataclass(frozen=True)
class Constant:
    """A term without variables."""

    value: Any  # an integer, or a clingo symbol (a name, a string, a compound term)
    at: tuple[int, int]  # line and column, from 1


@dataclass(frozen=True)
class Variable:
    """A variable."""

    # Its name. Each `_` has a unique name such as `?1`; the variable for an interval in an argument has a name such as
    # `.1`.
    name: str
    at: tuple[int, int]  # line and column, from 1


@dataclass(frozen=True)
class Operation:
    """Arithmetic on one or two terms."""

    sign: str  # the operator in ASP syntax; `..` denotes an interval, `|` the absolute value, `?` bitwise or.
    parts: tuple["ClauseTerm", ...]  # the operands, the left one first
    at: tuple[int, int]  # line and column, from 1


@dataclass(frozen=True)
class Compound:
    """A term with arguments."""

    name: str  # its name; '' for a tuple
    parts: tuple["ClauseTerm", ...]  # the arguments in order
    at: tuple[int, int]  # line and column, from 1


ClauseTerm = Constant | Variable | Operation | Compound  # an argument of an atom, or a side of a comparison


@dataclass(frozen=True)
class Atom:
    """A predicate with arguments."""

    name: str  # the predicate
    parts: tuple[ClauseTerm, ...]  # the arguments
    negations: int  # the number of `not` before the atom, 0 to 2
    at: tuple[int, int]  # line and column, from 1

    @property
    def signature(self) -> tuple[str, int]:
        """The name of the predicate and its number of arguments."""
        return self.name, len(self.parts)


@dataclass(frozen=True)
class Comparison:
    """A chain of comparisons `first sign term sign term ...`; when `negated`, that the chain does not hold."""

    first: ClauseTerm  # the first term
    # Pairs (sign, term); each sign, in ASP syntax, compares its term with the one before
    rest: tuple[tuple[str, ClauseTerm], ...]
    negated: bool  # whether `not` stands before the chain
    at: tuple[int, int]  # line and column, from 1


@dataclass(frozen=True)
class AggregateElement:
    """An element of an aggregate: the tuple of terms counts where all literals of the condition hold."""

    terms: tuple[ClauseTerm, ...]  # the tuple; its first term is the weight
    condition: tuple["Literal", ...]  # the literals; () for none


@dataclass(frozen=True)
class Aggregate:
    """An aggregate `term sign #function { elements }` with its guards."""

    # When `negated`, that one of them does not hold.

    function: str  # `#count`, `#sum`, `#sum+`, `#min` or `#max`
    elements: tuple[AggregateElement, ...]  # what is counted, summed or compared
    guards: tuple[tuple[str, ClauseTerm], ...]  # pairs (sign, term) such that `term sign value` must hold
    negated: bool  # whether `not` stands before it
    at: tuple[int, int]  # line and column, from 1


@dataclass(frozen=True)
class ConditionalLiteral:
    """A conditional literal `literal : condition`: the literal holds wherever all literals of the condition hold."""

    literal: "Literal"  # the literal before the colon
    condition: tuple["Literal", ...]  # the literals after it
    at: tuple[int, int]  # line and column, from 1


@dataclass(frozen=True)
class BooleanLiteral:
    """The literal `#true` or `#false`."""

    value: bool  # whether it is true, a `not` before it included
    at: tuple[int, int]  # line and column, from 1


Literal = Atom | Comparison | Aggregate | ConditionalLiteral | BooleanLiteral  # a part of a body


@dataclass(frozen=True)
class Clause:
    """A rule without pools."""

    head: Atom | None  # the atom that it states; None for a constraint or a query
    body: tuple[Literal, ...]  # its literals
    at: tuple[int, int]  # line and column, from 1


def translate_rule(rule: AST) -> list[Clause]:
    """Return a rule as clauses, one for each choice of values in its pools."""
    return [_Translator().clause(part) for part in rule.unpool()]


def place_of(node: AST) -> tuple[int, int]:
    """Return the line and the column, both from 1, at which a part of clingo's syntax tree begins."""
    begin = node.location.begin
    return begin.line, begin.column


class _Translator:
    """Translates one rule of clingo's syntax tree, without pools."""

    def __init__(self) -> None:
        self._numbers = itertools.count()
        self._intervals: list[Literal] = []

    def clause(self, rule: AST) -> Clause:
        """Return a rule without pools as a clause; raise ClauseError for what is not supported."""
        head = self._head(rule.head)
        waiting, self._intervals = self._intervals, []
        return Clause(head, (*self._conjunction(rule.body), *waiting), place_of(rule))

    def _head(self, node: AST) -> Atom | None:
        """Return the head atom, or None for a constraint; raise ClauseError for any other head."""
        if node.ast_type == ASTType.Literal and node.sign == Sign.NoSign:
            if node.atom.ast_type == ASTType.BooleanConstant and not node.atom.value:
                return None
            if node.atom.ast_type == ASTType.SymbolicAtom:
                return self._atom(node)
        raise ClauseError("a rule has one plain atom as its head here", place_of(node))

    def _conjunction(self, nodes: Iterable[AST]) -> tuple[Literal, ...]:
        """Return the literals of a conjunction, followed by the comparisons for the intervals in their arguments."""
        outer, self._intervals = self._intervals, []
        found = [self._literal(node) for node in nodes]
        found += self._intervals
        self._intervals = outer
        return tuple(found)

    def _literal(self, node: AST) -> Literal:
        """Return one literal; raise ClauseError for a theory atom."""
        if node.ast_type == ASTType.ConditionalLiteral:
            condition = self._conjunction(node.condition)
            (literal, *intervals) = self._conjunction([node.literal])
            if intervals:
                raise ClauseError("no interval stands here", place_of(node))
            return ConditionalLiteral(literal, condition, place_of(node))
        atom, at = node.atom, place_of(node)
        if atom.ast_type == ASTType.BooleanConstant:
            return BooleanLiteral(bool(atom.value) != (node.sign == Sign.Negation), at)
        if atom.ast_type == ASTType.SymbolicAtom:
            return self._atom(node)
        if atom.ast_type == ASTType.Comparison:
            rest = tuple((SIGNS[guard.comparison], self._term(guard.term, True)) for guard in atom.guards)
            return Comparison(self._term(atom.term, True), rest, node.sign == Sign.Negation, at)
        if atom.ast_type in (ASTType.BodyAggregate, ASTType.Aggregate):
            return self._aggregate(atom, node.sign == Sign.Negation, at)
        raise ClauseError("theory atoms are not known here", at)

    def _atom(self, node: AST) -> Atom:
        """Return an atom with its negations; raise ClauseError for classical negation, `-atom`."""
        found, at = node.atom.symbol, place_of(node.atom.symbol)
        if found.ast_type == ASTType.UnaryOperation:
            raise ClauseError("classical negation is not known here", at, "write not, for what is not believed")
        if found.ast_type == ASTType.SymbolicTerm:  # an atom without arguments
            return Atom(found.symbol.name, (), int(node.sign), at)
        return Atom(found.name, tuple(map(self._term, found.arguments)), int(node.sign), at)

    def _aggregate(self, node: AST, negated: bool, at: tuple[int, int]) -> Aggregate:
        """Return an aggregate; signs of right guards are mirrored, so that `term sign value` holds for every guard."""
        sides = ((node.left_guard, 0), (node.right_guard, 1))
        guards = [
            (
                SIGNS[guard.comparison] if left == 0 else MIRRORED_SIGNS[SIGNS[guard.comparison]],
                self._term(guard.term),
            )
            for guard, left in sides
            if guard is not None
        ]
        if node.ast_type == ASTType.Aggregate:
            elements = [self._choice(number, element) for number, element in enumerate(node.elements)]
            return Aggregate("#count", tuple(elements), tuple(guards), negated, at)
        elements = [self._element(element.terms, element.condition) for element in node.elements]
        return Aggregate(FUNCTIONS[node.function], tuple(elements), tuple(guards), negated, at)

    def _element(self, terms: Iterable[AST], condition: Iterable[AST]) -> AggregateElement:
        """Return an element of an aggregate: its tuple of terms, and its condition."""
        # The condition is the literals in order, followed by the comparisons for intervals in them and in the terms.
        outer, self._intervals = self._intervals, []
        found = tuple(map(self._term, terms))
        waiting, self._intervals = self._intervals, outer
        return AggregateElement(found, (*self._conjunction(condition), *waiting))

    def _choice(self, number: int, node: AST) -> AggregateElement:
        """Return an element of `{ literal : condition }`; the tuple holds the literal's name and arguments."""
        literals = self._conjunction([node.literal, *node.condition])
        at = place_of(node)
        first = literals[0]
        parts: tuple[ClauseTerm, ...] = first.parts if isinstance(first, Atom) and first.negations == 0 else ()
        name = f"{first.name}/{len(parts)}" if isinstance(first, Atom) else str(number)
        return AggregateElement((Constant(clingo.String(name), at), *parts), literals)

    def _term(self, node: AST, whole: bool = False) -> ClauseTerm:
        """Return a term; raise ClauseError for a function of Python (@name)."""
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
            inner, sign = self._term(node.argument), UNARY_SIGNS[node.operator_type]
            is_literal_number = sign == "-" and node.argument.ast_type == ASTType.SymbolicTerm
            if is_literal_number and isinstance(inner, Constant) and isinstance(inner.value, int):
                # clingo has wrapped the literal 2147483648 to -2147483648.
                return Constant(inner.value if inner.value == MIN_INT32 else -inner.value, at)
            return Operation(sign, (inner,), at)
        if node.ast_type == ASTType.BinaryOperation:
            return Operation(BINARY_SIGNS[node.operator_type], (self._term(node.left), self._term(node.right)), at)
        if node.ast_type == ASTType.Function and not node.external:
            return Compound(node.name, tuple(map(self._term, node.arguments)), at)
        raise ClauseError("operation undefined: there are no functions from outside", at)


def variables_of(part: Any) -> Iterator[str]:
    """Yield the names of all variables in a term, a literal or a tuple of them, those inside aggregates included."""
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
    elif isinstance(part, AggregateElement):
        yield from variables_of((part.terms, part.condition))
    elif isinstance(part, ConditionalLiteral):
        yield from variables_of((part.literal, part.condition))


def global_variables(body: Sequence[Literal]) -> dict[str, None]:
    """Return the named variables of a body, in the order in which they appear."""
    found: dict[str, None] = {}
    for literal in body:
        if isinstance(literal, Aggregate):
            outer: Any = tuple(term for _, term in literal.guards)
        else:
            outer = () if isinstance(literal, ConditionalLiteral) else literal
        found |= dict.fromkeys(name for name in variables_of(outer) if not name.startswith(("?", ".")))
    return found


def atoms_of(part: Any) -> Iterator[Atom]:
    """Yield the atoms in a literal or a tuple of them, those in aggregates and conditions included, in order."""
    if isinstance(part, Atom):
        yield part
    elif isinstance(part, tuple):
        for inner in part:
            yield from atoms_of(inner)
    elif isinstance(part, Aggregate):
        for element in part.elements:
            yield from atoms_of(element.condition)
    elif isinstance(part, ConditionalLiteral):
        yield from atoms_of((part.literal, part.condition))
