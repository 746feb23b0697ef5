"""Parser of users' rule files: statements, the predicates in each of them, and checked arithmetic.

It runs in the process of kb.reasoning.query_worker. Arithmetic is rewritten to calls of
kb.three_valued.functions, which compute exactly: where clingo would wrap a result to 32 bits without a message, the
rule has an error.
"""

from collections.abc import Collection, Iterator, Sequence
from typing import Any

import clingo
from clingo.ast import (
    AST,
    AggregateFunction,
    ASTType,
    ComparisonOperator,
    Function,
    Sign,
    SymbolicTerm,
    Transformer,
    parse_string,
)

from utak.kb.language.vocabulary import Signature
from utak.kb.three_valued.arithmetic import ClauseError, place_of
from utak.kb.tracing.syntax import BINARY_SIGNS, UNARY_SIGNS, global_variables_of, head_elements, parts_of

RENAMED_PREFIX = "own__"  # of the names of users' predicates where encodings have another predicate of that name
KEPT_STATEMENTS = (ASTType.Rule, ASTType.Minimize, ASTType.Defined)  # statements with an effect in an encoding
# Constants are substituted, and queries decide what is shown: these statements have no effect of their own.
IGNORED_STATEMENTS = ("Definition", "ShowSignature", "ShowTerm", "Program", "Comment")
REFUSED_STATEMENTS = {  # by clingo's name of the statement: the message
    "Script": "#script is not allowed: rules run no programs",
    "External": "#external is not known here",
    "Edge": "#edge is not known here",
    "Heuristic": "#heuristic is not known here",
    "ProjectAtom": "#project is not known here",
    "ProjectSignature": "#project is not known here",
    "TheoryDefinition": "theories are not known here",
}


class RuleSyntaxError(Exception):
    """A text is no file of rules; the message is clingo's, which begins with its place."""


def read_statements(text: str, renamed: Collection[Signature] = ()) -> list[dict[str, Any]]:
    """Return the statements of a rule file that have an effect, in order."""
    messages: list[str] = []
    found: list[AST] = []
    try:
        parse_string(text, found.append, logger=lambda _code, message: messages.append(message), message_limit=20)
    except RuntimeError as error:
        raise RuleSyntaxError(messages[0] if messages else str(error)) from None
    constants = _constants(found)
    names = _OwnNames(renamed)
    return [_entry(_ConstantSubstitution(constants).visit(node), names) for node in found if _kept(node)]


def _kept(node: AST) -> bool:
    """Return whether a statement has an effect in an encoding; raise ClauseError for one that is not allowed."""
    name = str(node.ast_type).rpartition(".")[2]
    if node.ast_type not in KEPT_STATEMENTS and name not in IGNORED_STATEMENTS:
        raise ClauseError(REFUSED_STATEMENTS.get(name, f"{name} is not known here"), place_of(node))
    if node.ast_type == ASTType.Program and (node.name != "base" or list(node.parameters)):
        raise ClauseError("#program is not known here", place_of(node))
    return node.ast_type in KEPT_STATEMENTS


def _entry(node: AST, names: "_OwnNames") -> dict[str, Any]:
    """Return a statement as the attributes of `Statement` but its source, with JSON values."""
    if node.ast_type == ASTType.Defined:
        entry = {"at": place_of(node), "heads": [], "body": [], "text": "", "written": "", "condition": ""}
        return entry | {"is_single_atom_rule": False, "variables": [], "declares": [node.name, node.arity]}
    chosen, conditions = _split_head(node.head) if node.ast_type == ASTType.Rule else ([], [])
    heads = [atom for part in chosen for atom in _atoms(part)]
    body = [atom for part in (*node.body, *conditions) for atom in _atoms(part)]
    checked = names.visit(_ArithmeticRewriter().visit(node))
    return {
        "at": place_of(node),
        "heads": heads,
        "body": body,
        "text": str(checked),
        "written": str(node),
        "condition": "; ".join(map(str, checked.body)),
        "is_single_atom_rule": _is_plain(node),
        "variables": list(global_variables_of(node)),
        "declares": None,
    }


def _is_plain(node: AST) -> bool:
    """Return whether a statement is a rule with one atom, not negated, as its head."""
    if node.ast_type != ASTType.Rule or node.head.ast_type != ASTType.Literal:
        return False
    return bool(node.head.sign == Sign.NoSign and node.head.atom.ast_type == ASTType.SymbolicAtom)


def _split_head(head: AST) -> tuple[list[AST], list[AST]]:
    """Return the literals that a head states or chooses, and the literals (conditions) on which they depend."""
    # Raises ClauseError for a theory atom.
    if head.ast_type not in (ASTType.Literal, ASTType.Aggregate, ASTType.Disjunction, ASTType.HeadAggregate):
        raise ClauseError("theory atoms are not known here", place_of(head))
    elements = head_elements(head)
    return [literal for literal, _ in elements], [one for _, conditions in elements for one in conditions]


def _atoms(node: AST, negative: bool = False) -> Iterator[dict[str, Any]]:
    """Yield the atoms in a part of a statement, as the attributes of `RuleAtom`, in the order of the text."""
    # One for each choice of a pool. An atom in an aggregate or in a condition counts as negated.
    if node.ast_type == ASTType.TheoryAtom:
        raise ClauseError("theory atoms are not known here", place_of(node))
    if node.ast_type != ASTType.SymbolicAtom:
        negative |= node.ast_type in (ASTType.BodyAggregate, ASTType.ConditionalLiteral)
        negative |= node.ast_type == ASTType.Literal and node.sign != Sign.NoSign
        for part in parts_of(node):
            yield from _atoms(part, negative)
        return
    for option in getattr(node.symbol, "arguments", ()) if node.symbol.ast_type == ASTType.Pool else (node.symbol,):
        if option.ast_type == ASTType.UnaryOperation:
            raise ClauseError("classical negation is not known here", place_of(option))
        arguments = list(getattr(option, "arguments", ()))
        yield {
            "name": option.name if option.ast_type == ASTType.Function else option.symbol.name,
            "at": place_of(option),
            "constants": _constants_among(arguments),
            "places": [place_of(part) for part in arguments],
            "forms": [_form(part) for part in arguments],
            "negative": negative,
        }


def _form(term: AST) -> tuple[str, list[str | None]] | None:
    """Return the name of a compound term and the text of each argument without variables; None for others."""
    compound = term.ast_type == ASTType.Function and bool(term.name)
    return (term.name, [str(part) if _is_ground(part) else None for part in term.arguments]) if compound else None


def _is_ground(term: AST) -> bool:
    """Return whether a term is a constant, or a compound term of such."""
    compound = term.ast_type == ASTType.Function and bool(term.name)
    return term.ast_type == ASTType.SymbolicTerm or (compound and all(map(_is_ground, term.arguments)))


def _constants_among(arguments: Sequence[AST]) -> list[str | None]:
    """Return the text of each argument that is a constant, None for any other."""
    return [str(part) if part.ast_type == ASTType.SymbolicTerm else None for part in arguments]


def _constants(nodes: list[AST]) -> dict[str, clingo.Symbol]:
    """Return the values of `#const` definitions, numbers and names, by name; raise ClauseError for any other value."""
    found = {}
    for node in nodes:
        if node.ast_type == ASTType.Definition:
            if node.value.ast_type != ASTType.SymbolicTerm:
                raise ClauseError("a constant is a number or a name here", place_of(node))
            found[node.name] = node.value.symbol
    return found


class _ConstantSubstitution(Transformer):
    """Replaces the constants of a file, names as of `#const`, by their values; clingo calls the `visit` methods."""

    def __init__(self, values: dict[str, clingo.Symbol]) -> None:
        self._values = values

    def visit_SymbolicAtom(self, node: AST) -> AST:  # noqa: N802 (clingo's name)
        """Return the atom with the constants in its arguments replaced; its own name is no constant."""
        if node.symbol.ast_type == ASTType.SymbolicTerm:
            return node  # an atom without arguments is no constant
        return node.update(**self.visit_children(node))

    def visit_SymbolicTerm(self, node: AST) -> AST:  # noqa: N802 (clingo's name)
        """Return the value of a constant, which stands in its place, as a term; any other term as it is."""
        value = self._values.get(str(node))
        return node if value is None else SymbolicTerm(node.location, value)


class _OwnNames(Transformer):
    """Gives some predicates, each a name and its number of arguments, a name that no encoding has."""

    def __init__(self, renamed: Collection[Signature]) -> None:
        self._renamed = frozenset(renamed)

    def visit_SymbolicAtom(self, node: AST) -> AST:  # noqa: N802 (clingo's name)
        """Return the atom, under its other name where it has one."""
        symbol = node.symbol
        if symbol.ast_type != ASTType.Function or (symbol.name, len(symbol.arguments)) not in self._renamed:
            return node
        return node.update(symbol=symbol.update(name=f"{RENAMED_PREFIX}{symbol.name}"))


class _ArithmeticRewriter(Transformer):
    """Replaces arithmetic by calls of a function, `@calculate(place, sign, operands)`."""

    def visit_BinaryOperation(self, node: AST) -> AST:  # noqa: N802 (clingo's name)
        """Return the call that computes an operation on two terms: a term `@calculate(place, sign, left, right)`."""
        return self._call(node, BINARY_SIGNS[node.operator_type], [self.visit(node.left), self.visit(node.right)])

    def visit_UnaryOperation(self, node: AST) -> AST:  # noqa: N802 (clingo's name)
        """Return the call that computes an operation on one term, `@calculate(place, sign, operand)`."""
        if node.argument.ast_type == ASTType.SymbolicTerm:
            number = node.argument.symbol
            if UNARY_SIGNS[node.operator_type] == "-" and number.type == clingo.SymbolType.Number:
                return node  # a negative number
        return self._call(node, UNARY_SIGNS[node.operator_type], [self.visit(node.argument)])

    def visit_Function(self, node: AST) -> AST:  # noqa: N802 (clingo's name)
        """Return a term whose arguments have calls of the function in the places of their arithmetic."""
        # Raises ClauseError for a function of Python (@name).
        if node.external:
            raise ClauseError("operation undefined: there are no functions from outside", place_of(node))
        return node.update(**self.visit_children(node))

    def visit_BodyAggregate(self, node: AST) -> AST:  # noqa: N802 (clingo's name)
        """Return an aggregate whose arithmetic is replaced by calls of the function, in the same places."""
        # Raises ClauseError for a sum that is given to a variable, `X = #sum{...}`.
        summed = node.function in (AggregateFunction.Sum, AggregateFunction.SumPlus)
        guards = [guard for guard in (node.left_guard, node.right_guard) if guard is not None]
        given = [guard.term for guard in guards if guard.comparison == ComparisonOperator.Equal]
        if summed and any(map(_has_variable, given)):
            what = "a sum is not given to a variable in rules, for it may go beyond 32 bits"
            raise ClauseError(what, place_of(node), "hold it against numbers, such as #sum{...} >= 50")
        return node.update(**self.visit_children(node))

    def _call(self, node: AST, sign: str, parts: list[AST]) -> AST:
        """Return the call that computes an operation; it carries the place of the operation."""
        line, column = place_of(node)
        call_site = [SymbolicTerm(node.location, value) for value in (_place_term(line, column), clingo.String(sign))]
        return Function(node.location, "calculate", [*call_site, *parts], 1)


def _has_variable(node: AST) -> bool:
    """Return whether a term has a variable: a capital letter before the first quote of its text."""
    return any(char.isupper() for char in str(node).split('"')[0])


def _place_term(line: int, column: int) -> clingo.Symbol:
    """Return a place as the clingo term (line, column), both from 1."""
    return clingo.Function("", [clingo.Number(line), clingo.Number(column)])
