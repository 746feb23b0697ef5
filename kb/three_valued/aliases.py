"""The two names of the robot: queries call it `utak`, facts call it `org`.

In facts, `utak` is also a kind of node, and the robot's name in goals and in what the plan says of them.
"""

from collections.abc import Set
from typing import Any

import clingo
from clingo.ast import ASTType

from utak.kb.language.vocabulary import BELIEF_PREDICATES, CIRCUMSTANCE_ARGUMENT, KIND_ARGUMENT, TASK_GOAL_ARGUMENT
from utak.kb.three_valued.compilation import arguments_of, signature_of
from utak.kb.tracing.syntax import nodes_in, parts_of, variables_in

# The types of arguments in which facts say `utak`
UTAK_TYPES = (KIND_ARGUMENT, TASK_GOAL_ARGUMENT, CIRCUMSTANCE_ARGUMENT)


def rename_utak_to_org(rule: Any) -> None:
    """Put the constant `org` in the place of `utak` in a rule, except where facts say `utak`, too."""
    atoms = [node for literal in rule.body for node in nodes_in(literal) if node.ast_type == ASTType.SymbolicAtom]
    kept = [part for atom in atoms for part, said in _arguments(atom) if said]
    _rename(rule, {part.name for part in kept if part.ast_type == ASTType.Variable})


def _arguments(atom: Any) -> list[tuple[Any, bool]]:
    """Return the arguments of an atom, each with whether facts say `utak` in it."""
    parts, declared = arguments_of(atom), BELIEF_PREDICATES.get(signature_of(atom))
    return [(part, declared is not None and declared.arguments[at] in UTAK_TYPES) for at, part in enumerate(parts)]


def _rename(node: Any, kinds: Set[str]) -> None:
    """Put `org` in the place of `utak` in a part of a rule; kinds: the variables of which facts say `utak`."""
    if node.ast_type == ASTType.SymbolicTerm and str(node.symbol) == "utak":
        node.symbol = clingo.Function("org")
    elif node.ast_type == ASTType.SymbolicAtom:
        for part, kept in _arguments(node):
            if not kept:
                _rename(part, kinds)
    elif node.ast_type != ASTType.Comparison or not kinds & set(variables_in(node)):
        for part in parts_of(node):
            _rename(part, kinds)
