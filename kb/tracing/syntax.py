"""Statements of logic programs, prepared for tracing: named places for anonymous variables, one alternative of a pool.

A *unit* is a statement with one alternative of each of its pools. Its anonymous variables and intervals, as far as they
stand in literals without negation, have names of their own, so that an instance of it says which atoms it used.
"""

from collections.abc import Iterable, Iterator, Sequence
from copy import copy
from functools import lru_cache
from typing import Any, NamedTuple

import clingo
from clingo.ast import (
    AST,
    ASTSequence,
    ASTType,
    BinaryOperator,
    Comparison,
    ComparisonOperator,
    Guard,
    Literal,
    Sign,
    SymbolicTerm,
    Transformer,
    UnaryOperator,
    Variable,
    parse_string,
)

JsonValues = dict[str, Any]  # values by key, ready for JSON
ANY_NAME = "any__"  # stands for an anonymous variable of a negated atom, which may have any value
HIDDEN_PREFIX = "Some__"  # begins the names that anonymous variables and intervals get
KEPT_NODES = (ASTType.Rule, ASTType.Minimize)  # the statements that are traced
SIGNS = {
    ComparisonOperator.Equal: "=",
    ComparisonOperator.NotEqual: "!=",
    ComparisonOperator.LessThan: "<",
    ComparisonOperator.LessEqual: "<=",
    ComparisonOperator.GreaterThan: ">",
    ComparisonOperator.GreaterEqual: ">=",
}
# clingo's operators as written in programs.
BINARY_SIGNS = {
    BinaryOperator.XOr: "^", BinaryOperator.Or: "?", BinaryOperator.And: "&", BinaryOperator.Plus: "+",
    BinaryOperator.Minus: "-", BinaryOperator.Multiplication: "*", BinaryOperator.Division: "/",
    BinaryOperator.Modulo: "\\", BinaryOperator.Power: "**",
}  # fmt: skip
UNARY_SIGNS = {UnaryOperator.Minus: "-", UnaryOperator.Negation: "~", UnaryOperator.Absolute: "|"}
FUNCTIONS = ("#count", "#sum", "#sum+", "#min", "#max")  # in the order of clingo's numbers of aggregate functions


class ProgramPart(NamedTuple):
    """A piece of a logic program."""

    file: str  # the name of the file that it comes from
    line: int  # the line of that file with which it begins, from 1
    text: str  # the piece itself, statements of the ASP language


class TracedStatement(NamedTuple):
    """A rule, a constraint or a weak constraint of a program."""

    file: str  # where it begins; line and column from 1
    line: int
    column: int
    text: str  # the statement as written, on one line
    kind: str  # fact, rule, choice, disjunction, constraint or weak (a weak constraint)
    variables: tuple[str, ...]  # the names of its global variables, in the order of the text
    node: AST  # its syntax tree


class Unit(NamedTuple):
    """A statement with one alternative of each of its pools."""

    statement: int  # the index of its statement
    node: AST  # its syntax tree, in which hidden variables have names
    names: tuple[str, ...]  # the names of its global variables, hidden ones included


class ParsedProgram(NamedTuple):
    """A program taken apart."""

    statements: tuple[TracedStatement, ...]  # the rules, constraints and weak constraints, in order
    units: tuple[Unit, ...]  # the same with one alternative of each pool
    constants: tuple[str, ...]  # the `#const` definitions as text
    defined: frozenset[tuple[str, int]]  # the predicates that `#defined` declares, (name, number of arguments)
    shown: frozenset[tuple[str, int]]  # the predicates of the answer, likewise; empty when everything is shown


_attributes: dict[Any, tuple[Any, list[str]]] = {}  # the keys of the parts of a node, and of all it has, by its type


class SyntaxPart:
    """A part of clingo's syntax tree, read once: clingo's own takes microseconds for each attribute."""

    def __init__(self, node: AST) -> None:
        self.ast_type, self._node = node.ast_type, node
        if self.ast_type not in _attributes:
            _attributes[self.ast_type] = node.child_keys, [key for key in dict(node.items()) if key != "location"]
        self.child_keys, keys = _attributes[self.ast_type]
        for key in keys:
            setattr(self, key, _read(getattr(node, key)))

    def __getattr__(self, name: str) -> Any:
        """Return the location, which is seldom asked for; raise AttributeError for any other name."""
        if name != "location":
            raise AttributeError(name)
        return self._node.location

    def updated(self, **values: Any) -> "SyntaxPart":
        """Return the part with other values of some attributes."""
        found = copy(self)
        found.__dict__.update(values)
        return found


def _read(value: Any) -> Any:
    """Return an attribute of clingo's syntax tree: parts and sequences of them are read, too."""
    if isinstance(value, AST):
        return SyntaxPart(value)
    return (
        [SyntaxPart(one) if isinstance(one, AST) else one for one in value] if isinstance(value, ASTSequence) else value
    )


@lru_cache(maxsize=64)
def parsed(parts: tuple[ProgramPart, ...]) -> ParsedProgram:
    """Return a program taken apart; the last ones are kept. RuntimeError when clingo cannot parse it."""
    statements: list[TracedStatement] = []
    constants: list[str] = []
    defined: set[tuple[str, int]] = set()
    shown: set[tuple[str, int]] = set()
    for part in parts:
        nodes: list[AST] = []
        parse_string(part.text, nodes.append, logger=_ignore_message, message_limit=1)
        lines = part.text.split("\n")
        for node in nodes:
            if node.ast_type in KEPT_NODES and str(node.location.begin.filename) == "<string>":
                statements.append(_statement(part, lines, node))
            elif node.ast_type == ASTType.Definition:
                constants.append(str(node))
            elif node.ast_type == ASTType.Defined:
                defined.add((node.name, node.arity))
            elif node.ast_type == ASTType.ShowSignature and node.name:
                shown.add((node.name, node.arity))
    units = tuple(unit for number, one in enumerate(statements) for unit in _units(number, one.node))
    return ParsedProgram(tuple(statements), units, tuple(constants), frozenset(defined), frozenset(shown))


def global_variables_of(node: AST) -> tuple[str, ...]:
    """Return the names of the global variables of a statement, in the order of its text; `_` is none of them."""
    found: dict[str, None] = {}
    if node.ast_type == ASTType.Minimize:
        outer: list[AST] = [*node.body, node.weight, node.priority, *node.terms]
    else:
        head = [node.head] if node.head.ast_type == ASTType.Literal else _guards(node.head)
        outer = [*head, *node.body]
    for part in outer:
        for inner in outer_parts(part):
            found |= dict.fromkeys(variables_in(inner))
    found.pop("_", None)
    return tuple(found)


def is_choice_head(head: AST) -> bool:
    """Return whether a head is a choice, `{ ... }` or an aggregate with conditions, rather than an atom or atoms."""
    return head.ast_type in (ASTType.Aggregate, ASTType.HeadAggregate)


def head_elements(head: AST) -> list[tuple[AST, list[AST]]]:
    """Return (literal, conditions) of each atom that a head may state; [] for the head of a constraint."""
    if head.ast_type == ASTType.Literal:
        return [] if head.atom.ast_type == ASTType.BooleanConstant else [(head, [])]
    found = []
    for element in head.elements:
        inner = element.condition if head.ast_type == ASTType.HeadAggregate else element
        found.append((inner.literal, list(inner.condition)))
    return found


def atom_text(literal: AST) -> str:
    """Return the atom of a literal as a term of clingo, its anonymous variables replaced by `ANY_NAME`."""
    return str(_AnyNamer().visit(literal.atom.symbol))


def _statement(part: ProgramPart, lines: Sequence[str], node: AST) -> TracedStatement:
    """Return a statement with its place, text, kind and variables; lines are those of its part."""
    begin, end = node.location.begin, node.location.end
    if begin.line == end.line:
        text = lines[begin.line - 1][begin.column - 1 : end.column - 1]
    else:
        rows = [lines[begin.line - 1][begin.column - 1 :], *lines[begin.line : end.line - 1]]
        text = " ".join(row.strip() for row in [*rows, lines[end.line - 1][: end.column - 1]])
    kind = _kind(node)
    return TracedStatement(
        part.file, part.line + begin.line - 1, begin.column, text, kind, global_variables_of(node), node
    )


def _kind(node: AST) -> str:
    """Return what a statement is: fact, rule, choice, disjunction, constraint or weak."""
    if node.ast_type == ASTType.Minimize:
        return "weak"
    if is_choice_head(node.head):
        return "choice"
    if node.head.ast_type == ASTType.Disjunction:
        return "disjunction"
    if not head_elements(node.head):
        return "constraint"
    return "rule" if len(node.body) else "fact"


def _units(number: int, node: AST) -> Iterator[Unit]:
    """Yield the units of a statement, one for each combination of the alternatives of its pools."""
    for one in node.unpool():
        named = _HiddenNamer().statement(one)
        yield Unit(number, named, global_variables_of(named))


def _guards(head: AST) -> list[AST]:
    """Return the terms that bound the number of atoms of a choice; [] for any other head."""
    if not is_choice_head(head):
        return []
    return [guard.term for guard in (head.left_guard, head.right_guard) if guard is not None]


def outer_parts(part: Any) -> Iterator[Any]:
    """Yield the parts of a literal in which its global variables stand."""
    if part.ast_type == ASTType.ConditionalLiteral:
        return
    atom = part.atom if part.ast_type == ASTType.Literal else part
    if atom.ast_type in (ASTType.BodyAggregate, ASTType.Aggregate):
        yield from (guard.term for guard in (atom.left_guard, atom.right_guard) if guard is not None)
    else:
        yield part


def nodes_in(node: Any) -> Iterator[Any]:
    """Yield a syntax tree and all its parts, each before its own parts, in order."""
    yield node
    for part in parts_of(node):
        yield from nodes_in(part)


def parts_of(node: Any) -> Iterator[Any]:
    """Yield the direct parts of a syntax tree, in order."""
    for key in node.child_keys:
        inner = getattr(node, key)
        yield from [inner] if isinstance(inner, AST | SyntaxPart) else inner or ()


def variables_in(node: Any) -> list[str]:
    """Return the names of the variables in a syntax tree, in order."""
    return [part.name for part in nodes_in(node) if part.ast_type == ASTType.Variable]


def _ignore_message(_code: clingo.MessageCode, _message: str) -> None:
    """Do nothing with a message of clingo's: a program that cannot be parsed raises RuntimeError besides."""


class _AnyNamer(Transformer):
    """Replaces anonymous variables by the name `ANY_NAME`; clingo calls the `visit` methods."""

    def visit_Variable(self, node: AST) -> AST:  # noqa: N802 (clingo's name)
        """Return `ANY_NAME` for an anonymous variable, any other variable as it is."""
        if node.name == "_":
            return SymbolicTerm(node.location, clingo.Function(ANY_NAME))
        return node


class _HiddenNamer(Transformer):
    """Gives names to anonymous variables and to intervals of body literals; clingo calls the `visit` methods."""

    def __init__(self) -> None:
        self._count = 0
        self._comparisons: list[AST] = []

    def statement(self, node: AST) -> AST:
        """Return a statement whose hidden variables have names."""
        body = self._conjunction(node.body)
        if node.ast_type == ASTType.Minimize:
            return node.update(body=body)
        head = node.head
        if head.ast_type in (ASTType.Aggregate, ASTType.Disjunction):
            elements = [one.update(condition=self._conjunction(one.condition)) for one in head.elements]
            head = head.update(elements=elements)
        elif head.ast_type == ASTType.HeadAggregate:
            elements = [
                one.update(condition=one.condition.update(condition=self._conjunction(one.condition.condition)))
                for one in head.elements
            ]
            head = head.update(elements=elements)
        return node.update(head=head, body=body)

    def visit_Literal(self, node: AST) -> AST:  # noqa: N802 (clingo's name)
        """Return a literal with named hidden variables; a negated atom keeps its anonymous variables."""
        if node.atom.ast_type == ASTType.Comparison:
            return node
        if node.atom.ast_type == ASTType.SymbolicAtom and node.sign != Sign.NoSign:
            return node
        return node.update(**self.visit_children(node))

    def visit_BodyAggregate(self, node: AST) -> AST:  # noqa: N802 (clingo's name)
        """Return an aggregate with named hidden variables in the conditions of its elements."""
        return node.update(elements=[one.update(condition=self._conjunction(one.condition)) for one in node.elements])

    def visit_Aggregate(self, node: AST) -> AST:  # noqa: N802 (clingo's name)
        """Return a set of conditional literals with named hidden variables in its literals and conditions."""
        return node.update(elements=[self.visit(one) for one in node.elements])

    def visit_ConditionalLiteral(self, node: AST) -> AST:  # noqa: N802 (clingo's name)
        """Return a conditional literal with named hidden variables in its condition; its literal stays."""
        return node.update(condition=self._conjunction(node.condition))

    def visit_Variable(self, node: AST) -> AST:  # noqa: N802 (clingo's name)
        """Return a variable with a new name for an anonymous one, any other one as it is."""
        return self._new_variable(node) if node.name == "_" else node

    def visit_Interval(self, node: AST) -> AST:  # noqa: N802 (clingo's name)
        """Return a variable in the place of an interval, and note the comparison that gives it its values."""
        variable = self._new_variable(node)
        atom = Comparison(variable, [Guard(ComparisonOperator.Equal, node)])
        self._comparisons.append(Literal(node.location, Sign.NoSign, atom))
        return variable

    def _conjunction(self, nodes: Iterable[AST]) -> list[AST]:
        """Return the literals of a conjunction with named hidden variables, and comparisons for their intervals."""
        outer, self._comparisons = self._comparisons, []
        found = [self.visit(node) for node in nodes]
        found += self._comparisons
        self._comparisons = outer
        return found

    def _new_variable(self, node: AST) -> AST:
        """Return a variable with a name that no other variable of the statement has, at the place of a node."""
        self._count += 1
        return Variable(node.location, f"{HIDDEN_PREFIX}{self._count}")
