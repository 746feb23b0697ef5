"""The costs of other choices, or the constraints that forbid them."""

from collections.abc import Sequence

import clingo

from utak.kb.tracing.answers import Assumptions, GroundedProgram, PricedAnswer
from utak.kb.tracing.syntax import JsonValues


def weigh(grounded: GroundedProgram, answer: Sequence[str], heads: Sequence[str], with_none: bool) -> JsonValues:
    """Return the costs of an answer, and those of the best answers with another one of the atoms of a choice."""
    given = [clingo.parse_term(atom) for atom in answer]
    whole = grounded.priced_answer(given)
    symbols = [clingo.parse_term(atom) for atom in heads]
    held = set(grounded.whole_answer(answer))
    others = [_alternative(grounded, str(one), [(one, True)]) for one in symbols if one not in held]
    if with_none and held.intersection(symbols):
        none = grounded.best_answer([(one, False) for one in symbols])
        others += [] if none is None else [_entry("", none)]
    return {"chosen": _entry("", whole), "others": others}


def _alternative(grounded: GroundedProgram, atom: str, assumptions: Assumptions) -> JsonValues:
    """Return the entry of the best answer under assumptions, or of what forbids them."""
    found = grounded.best_answer(assumptions)
    if found is not None:
        return _entry(atom, found)
    broken = grounded.broken_constraints(assumptions)
    return {"atom": atom, "broken": [[unit, list(values)] for unit, values in broken or ()], "proved": True}


def _entry(atom: str, found: PricedAnswer) -> JsonValues:
    """Return an answer with its costs as JSON values."""
    return {
        "atom": atom,
        "costs": [list(cost) for cost in found.costs],
        "prices": [[unit, list(values), weight, level] for unit, values, weight, level in found.prices],
        "proved": found.proved,
    }
