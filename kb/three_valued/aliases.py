"""The two names of the robot: queries call it `utak`, facts call it `org`.

In facts, `utak` is also a kind of node, and the robot's name in goals and in what the plan says of them.
"""

from collections.abc import Set
from dataclasses import fields, is_dataclass, replace
from typing import Any

import clingo

from utak.kb.language.vocabulary import BELIEF_PREDICATES, CIRCUMSTANCE_ARGUMENT, KIND_ARGUMENT, TASK_GOAL_ARGUMENT
from utak.kb.three_valued.clauses import Atom, Clause, Comparison, Constant, Variable, atoms_of

UTAK_TERM, ORG_TERM = clingo.Function("utak"), clingo.Function("org")
# The types of arguments in which facts say `utak`
UTAK_TYPES = (KIND_ARGUMENT, TASK_GOAL_ARGUMENT, CIRCUMSTANCE_ARGUMENT)


def rename_utak_to_org(clause: Clause) -> Clause:
    """Return a clause with the constant `org` in the place of `utak`, except where facts say `utak`, too."""
    kinds = {
        part.name
        for atom in atoms_of(clause.body)
        for part in (atom.parts[at] for at in _utak_arguments(atom))
        if isinstance(part, Variable)
    }
    head = None if clause.head is None else _renamed(clause.head, kinds)
    return replace(clause, head=head, body=_renamed(clause.body, kinds))


def _utak_arguments(atom: Atom) -> list[int]:
    """Return the indices, from 0, of the arguments in which facts say `utak`; [] for an unknown predicate."""
    slots = BELIEF_PREDICATES[atom.signature].arguments if atom.signature in BELIEF_PREDICATES else ()
    return [at for at, slot in enumerate(slots) if slot in UTAK_TYPES]


def _renamed(part: Any, kinds: Set[str]) -> Any:
    """Return a part of a clause (term, literal, element or tuple of them) with `org` in the place of `utak`."""
    if isinstance(part, Constant):
        return replace(part, value=ORG_TERM) if part.value == UTAK_TERM else part
    if isinstance(part, Comparison) and any(
        isinstance(term, Variable) and term.name in kinds for term in (part.first, *(term for _, term in part.rest))
    ):
        return part
    if isinstance(part, Atom):
        kept = _utak_arguments(part)
        return replace(
            part, parts=tuple(term if at in kept else _renamed(term, kinds) for at, term in enumerate(part.parts))
        )
    if isinstance(part, tuple):
        return tuple(_renamed(inner, kinds) for inner in part)
    if is_dataclass(part) and not isinstance(part, type):
        return replace(part, **{field.name: _renamed(getattr(part, field.name), kinds) for field in fields(part)})
    return part
