"""Helping rules that make clingo say which instances of a program's statements hold, with the values of variables.

For a unit of a program (kb.tracing.syntax) with the body B, global variables V and the head H, the rules are

    trace__on(Unit, (V), (body literals as terms)) :- B.
    trace__head(Unit, Element, (V), H, (condition literals)) :- trace__on(Unit, (V), _), condition.
    trace__element(Unit, Literal, Element, (V), (tuple), (condition literals)) :- trace__on(Unit, (V), _), condition.
    trace__weight(Unit, (V), Weight, Level, (tuple)) :- B.                                  (weak constraints)
    trace__broken(Unit, (V)) :- B.                                                          (constraints)

Literals become terms: `p(X)` for an atom, a tuple of the compared terms for a comparison, a tuple of bounds for an
aggregate.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Any

from clingo.ast import AST, ASTType, Sign

from utak.kb.tracing.syntax import FUNCTIONS, SIGNS, ParsedProgram, Unit, atom_text, head_elements, is_choice_head

# Returns a body as clingo joins it, from its literals and the names of the variables that have values already.
Joined = Callable[[Sequence[AST], Sequence[str]], Sequence[AST | str]]


def instance_rules(program: ParsedProgram, joined: Joined = lambda body, _names: body) -> Iterator[str]:
    """Yield the helping rules for all units of a program, to be grounded over the atoms of an answer."""
    for number, unit in enumerate(program.units):
        node, names = unit.node, _tuple(unit.names)
        yield _rule(f"trace__on({number},{names},{_tuple(literal_terms(node.body))})", joined(node.body, ()))
        holds = f"trace__on({number},{names},_)"
        for element, (literal, condition) in enumerate(() if _is_weak(node) else head_elements(node.head)):
            head = f"trace__head({number},{element},{names},{atom_text(literal)},{_tuple(literal_terms(condition))})"
            if literal.sign == Sign.NoSign and literal.atom.ast_type == ASTType.SymbolicAtom:
                yield _rule(head, [holds, *joined(condition, unit.names)])
        for at, literal in enumerate(node.body):
            for element, (terms, condition) in enumerate(_elements(literal)):
                place = f"{number},{at},{element},{names}"
                head = f"trace__element({place},{_tuple(terms)},{_tuple(literal_terms(condition))})"
                yield _rule(head, [holds, *joined(condition, unit.names)])


def weight_rules(program: ParsedProgram) -> Iterator[str]:
    """Yield the helping rules for the weak constraints of a program, to be added to the program itself."""
    for number, unit in enumerate(program.units):
        node = program.statements[unit.statement].node if _single(program, unit) else unit.node
        if _is_weak(node):
            names = _tuple(program.statements[unit.statement].variables)
            price = f"{node.weight},{node.priority},{_tuple(node.terms)}"
            yield _rule(f"trace__weight({number},{names},{price})", node.body)


def relaxed_rules(program: ParsedProgram) -> Iterator[str]:
    """Yield a program whose constraints may be broken, at a cost of one each; weak constraints are left out."""
    for number, unit in enumerate(program.units):
        statement = program.statements[unit.statement]
        if statement.kind == "constraint":
            names = _tuple(unit.names)
            yield _rule(f"trace__broken({number},{names})", unit.node.body)
            yield (
                f":~ trace__broken({number},{names}). [1@1,{number},{names}]"
                if unit.names
                else (f":~ trace__broken({number},()). [1@1,{number}]")
            )
        elif statement.kind != "weak" and _is_first(program, number):
            yield str(statement.node)
    yield from program.constants


def literal_info(literal: AST) -> dict[str, Any]:
    """Return what an explanation needs to know of a body literal, whatever its instance; JSON values."""
    text = str(literal)
    if literal.ast_type == ASTType.ConditionalLiteral:
        info = {"kind": "conditional", "text": text, "negated": False}
        return info | {
            "literal": literal_info(literal.literal),
            "conditions": [list(map(literal_info, literal.condition))],
        }
    atom, negated = literal.atom, literal.sign == Sign.Negation
    if atom.ast_type == ASTType.SymbolicAtom:
        kind = {Sign.NoSign: "atom", Sign.Negation: "not", Sign.DoubleNegation: "notnot"}[Sign(literal.sign)]
        return {"kind": kind, "text": text, "negated": negated}
    if atom.ast_type == ASTType.Comparison:
        signs = [SIGNS[guard.comparison] for guard in atom.guards]
        sides = [str(part) for part in (atom.term, *(guard.term for guard in atom.guards))]
        return {"kind": "comparison", "text": text, "negated": negated, "signs": signs, "sides": sides}
    if atom.ast_type in (ASTType.BodyAggregate, ASTType.Aggregate):
        function = FUNCTIONS[atom.function] if atom.ast_type == ASTType.BodyAggregate else "#count"
        info = {"kind": "aggregate", "text": text, "negated": negated, "function": function}
        return info | {
            "signs": [SIGNS[guard.comparison] if guard else "" for guard in (atom.left_guard, atom.right_guard)],
            "conditions": [[literal_info(one) for one in condition] for _, condition in _elements(literal)],
        }
    return {"kind": "truth", "text": text, "negated": negated}


def condition_infos(node: AST) -> list[list[dict[str, Any]]]:
    """Return `literal_info` of the condition literals of each element of a head; [] for a head without elements."""
    return [[literal_info(one) for one in condition] for _, condition in head_elements(node.head)]


def literal_terms(literals: Iterable[AST]) -> list[str]:
    """Return each literal as a term that clingo evaluates: see the docstring of this module."""
    return [_term(one) for one in literals]


def _term(literal: AST) -> str:
    """Return one literal as a term; a conditional literal and a constant truth as an empty tuple."""
    if literal.ast_type == ASTType.ConditionalLiteral:
        return "()"
    atom = literal.atom
    if atom.ast_type == ASTType.SymbolicAtom:
        return atom_text(literal)
    if atom.ast_type == ASTType.Comparison:
        return _tuple(_compared(part) for part in (atom.term, *(guard.term for guard in atom.guards)))
    if atom.ast_type in (ASTType.BodyAggregate, ASTType.Aggregate):
        return _tuple(str(g.term) for g in (atom.left_guard, atom.right_guard) if g is not None)
    return "()"


def _compared(term: AST) -> str:
    """Return one side of a comparison as text; an interval, which has many values, as a string."""
    return f'"{term}"' if term.ast_type == ASTType.Interval else str(term)


def _elements(literal: AST) -> Iterator[tuple[list[str], list[AST]]]:
    """Yield (tuple of terms, condition) of each element of an aggregate or of a conditional literal."""
    if literal.ast_type == ASTType.ConditionalLiteral:
        yield [_term(literal.literal)], list(literal.condition)
    elif literal.ast_type == ASTType.Literal and literal.atom.ast_type == ASTType.BodyAggregate:
        for element in literal.atom.elements:
            yield [str(term) for term in element.terms], list(element.condition)
    elif literal.ast_type == ASTType.Literal and literal.atom.ast_type == ASTType.Aggregate:
        for element in literal.atom.elements:
            yield [_term(element.literal)], [element.literal, *element.condition]


def _is_weak(node: AST) -> bool:
    """Return whether a statement is a weak constraint."""
    return bool(node.ast_type == ASTType.Minimize)


def _single(program: ParsedProgram, unit: Unit) -> bool:
    """Return whether a statement has one unit only: then its own text can be used, with anonymous variables."""
    return sum(other.statement == unit.statement for other in program.units) == 1


def _is_first(program: ParsedProgram, number: int) -> bool:
    """Return whether a unit is the first one of its statement."""
    return number == 0 or program.units[number - 1].statement != program.units[number].statement


def _tuple(parts: Iterable[Any]) -> str:
    """Return a tuple of clingo: `()`, `(a,)`, `(a,b)`."""
    texts = [str(part) for part in parts]
    return f"({texts[0]},)" if len(texts) == 1 else f"({','.join(texts)})"


def _rule(head: str, body: Sequence[AST | str]) -> str:
    """Return a rule as text. A conditional literal is followed by a semicolon, so all literals are."""
    return f"{head} :- {'; '.join(map(str, body))}." if len(body) else f"{head}."


def is_choice(unit: Unit) -> bool:
    """Return whether a unit chooses its atoms."""
    return not _is_weak(unit.node) and is_choice_head(unit.node.head)
