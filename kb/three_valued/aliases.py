"""The robot has two names: users call it `utak`, the knowledge base `org`. `utak` is a kind of region there, too."""

from collections.abc import Set
from dataclasses import fields, is_dataclass, replace
from typing import Any

import clingo

from kb.language.vocabulary import BELIEF, KIND_ARGUMENT
from kb.three_valued.clauses import Atom, Clause, Comparison, Constant, Variable, atoms_of

UTAK, ORG = clingo.Function("utak"), clingo.Function("org")


def with_org(clause: Clause) -> Clause:
    """Return a clause in which the robot is called as in the facts, wherever `utak` does not stand for a kind."""
    kinds = {
        part.name
        for atom in atoms_of(clause.body)
        for part in (atom.parts[at] for at in _kinds(atom))
        if isinstance(part, Variable)
    }
    return replace(clause, body=_renamed(clause.body, kinds))


def _kinds(atom: Atom) -> list[int]:
    """Which arguments of an atom are kinds."""
    slots = BELIEF[atom.signature].arguments if atom.signature in BELIEF else ()
    return [at for at, slot in enumerate(slots) if slot is KIND_ARGUMENT]


def _renamed(part: Any, kinds: Set[str]) -> Any:
    """A part of a clause. kinds : variables that stand for kinds; what they are compared with is one."""
    if isinstance(part, Constant):
        return replace(part, value=ORG) if part.value == UTAK else part
    if isinstance(part, Comparison) and any(
        isinstance(term, Variable) and term.name in kinds for term in (part.first, *(term for _, term in part.rest))
    ):
        return part
    if isinstance(part, Atom):
        kept = _kinds(part)
        return replace(
            part, parts=tuple(term if at in kept else _renamed(term, kinds) for at, term in enumerate(part.parts))
        )
    if isinstance(part, tuple):
        return tuple(_renamed(inner, kinds) for inner in part)
    if is_dataclass(part) and not isinstance(part, type):
        return replace(part, **{field.name: _renamed(getattr(part, field.name), kinds) for field in fields(part)})
    return part
